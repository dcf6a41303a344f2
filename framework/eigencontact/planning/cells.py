"""The shape that grids are made of: the installed inclusion shape with corner potentials."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from eigencontact.errors import PlanError
from eigencontact.hooks.registry import Registry
from eigencontact.plugin import HasCornerPotentials

__all__ = ["installed_cell"]

Point = tuple[float, float, float]


def installed_cell(registry: Registry) -> Callable[[Point, Point], Any]:
    """Maker of cells, ``cell(centre, edges)``, from the one installed shape that offers ``corner``, the bundled first.

    Raises
    ------
    PlanError
        None is installed, or more than one; broken plugins are named.
    """
    found = [entry for entry in registry.of_kind("inclusion-shape") if hasattr(entry.component, "corner")]
    found = [entry for entry in found if entry.bundled] or found  # a stranger's cuboid is a shape, not our cells
    if len(found) != 1:
        names = ", ".join(f"{entry.key!r} ({entry.origin})" for entry in found) or "none"
        broken = "".join(f"; {item}" for item in registry.broken)
        raise PlanError(f"one installed inclusion shape must offer corner potentials, for cells (got {names}){broken}")
    component = found[0].component

    def cell(centre: Point, edges: Point) -> Any:
        return component(center=centre, edges=edges)

    assert issubclass(component, HasCornerPotentials)
    return cell
