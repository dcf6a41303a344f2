"""Plugins of which exactly one is used: the influence of each traction, and the shape of cells."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from eigencontact.errors import PlanError
from eigencontact.hooks.registry import Entry, Registry
from eigencontact.plugin import HasCornerPotentials, SurfaceInfluence

__all__ = ["CellMaker", "installed_cell", "installed_influence"]

Point = tuple[float, float, float]
CellMaker = Callable[[Point, Point], Any]


def installed_influence(registry: Registry, traction: str) -> SurfaceInfluence:
    """Return the installed influence of one traction component.

    That of a plugin file takes the place of the bundled one, for the scene names the file; a package does not.

    Raises
    ------
    PlanError
        None is installed, or more than one; broken plugins are named.
    """
    entries = [entry for entry in registry.of_kind("surface-influence") if entry.component.traction == traction]  # type: ignore[attr-defined]
    entries = [entry for entry in entries if entry.of_file] or entries
    rule = f"traction {traction!r} must have one installed surface influence"
    component: SurfaceInfluence = _only(registry, entries, rule)()
    return component


def installed_cell(registry: Registry) -> CellMaker:
    """Maker of cells, ``cell(centre, edges)``, from the only installed shape with ``corner``.

    Raises
    ------
    PlanError
        None is installed, or more than one; broken plugins are named.
    """
    entries = [entry for entry in registry.of_kind("inclusion-shape") if hasattr(entry.component, "corner")]
    component = _only(registry, entries, "one installed inclusion shape must offer corner potentials, for cells")
    assert issubclass(component, HasCornerPotentials)
    make: Any = component

    def cell(centre: Point, edges: Point) -> Any:
        return make(center=centre, edges=edges)

    return cell


def _only(registry: Registry, offered: Sequence[Entry], rule: str) -> Any:
    """Component of the only entry; an installed third-party entry does not replace a bundled one."""
    entries = [entry for entry in offered if entry.bundled] or offered
    if len(entries) != 1:
        names = ", ".join(f"{entry.key!r} ({entry.origin})" for entry in entries) or "none"
        broken = "".join(f"; {item}" for item in registry.broken)
        raise PlanError(f"{rule} (got {names}){broken}")
    return entries[0].component
