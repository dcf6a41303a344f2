"""Checks of line contacts, and of contacts that are periodic along y only."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from eigencontact.scene.steps import named_ramps

if TYPE_CHECKING:
    from eigencontact.core.grid import Grid
    from eigencontact.scene.schema import Scene

__all__ = ["check_line", "check_repeating", "window_keys"]

#: Loads and motions that turn the body out of its plane, or move it along its length.
_ACROSS = frozenset({"moment-x", "tilt-x", "torsion-moment", "twist", "travel-y"})
#: Motions against the inside of the bodies.
_AGAINST_DEPTH = frozenset({"approach", "shift-x", "shift-y"})


def window_keys(grid: Grid, datum_depth: float | None) -> dict[str, Any]:
    """Keys of the table ``[grid]`` for these cells, with the datum depth [m] of displacements.

    Examples
    --------
    >>> from eigencontact.core.grid import Grid
    >>> window_keys(Grid(nx=4, ny=2, dx=0.5, dy=0.5), None)
    {'cells': [4, 2], 'size': [2.0, 1.0], 'center': [0.0, 0.0]}
    """
    pairs: dict[str, list[Any]] = {"cells": list(grid.counts), "size": list(grid.sides)}
    keys: dict[str, Any] = {**pairs, "center": list(grid.center)}
    if grid.line:
        keys |= {name: pair[0] for name, pair in pairs.items()}
        keys["length"] = "infinite"
    return keys | ({} if datum_depth is None else {"datum-depth": datum_depth})


def check_line(scene: Scene) -> None:
    """Raise ValueError, with a complete sentence after ``!``, for parts that a line contact cannot have."""
    if scene.grid.datum_depth is not None and not (scene.grid.line or scene.numerics.repeats_y):
        raise ValueError(
            f"!grid.datum-depth must be left out unless length = 'infinite' or numerics.boundary = 'periodic-y' (got "
            f"{scene.grid.datum_depth:g}), because the displacement of other contacts vanishes at infinity; remove it"
        )
    if not scene.grid.line:
        return
    if scene.inclusions and not scene.numerics.in_cells:
        raise ValueError(
            "!numerics.inclusion-resolution must be 'cells' in a line contact (got 'wholes'), because whole "
            "inhomogeneities have no plane-strain solution; remove it"
        )
    if scene.numerics.half_space not in ("exact", "full-space") and (scene.inclusions or scene.eigenstrain):
        raise ValueError(
            "!numerics.half-space must be 'exact' or 'full-space' for eigenstrain below a line contact "
            f"(got {scene.numerics.half_space!r})"
        )
    across_bulk = [name for name in scene.bulk_at_rest if not name.endswith("_xx")]
    if across_bulk:
        raise ValueError(
            f"!{across_bulk[0].replace('_', '-')} must be left out in a line contact (got grid.length = 'infinite'), "
            "because in plane strain yy follows from xx and xy is zero; remove it"
        )
    _check_motions(
        scene, "a line contact", "(got grid.length = 'infinite'), because plane strain excludes rotations about x and "
        "z and motion along y", "in plane strain",
    )  # fmt: skip


def check_repeating(scene: Scene) -> None:
    """Raise ValueError, with a complete sentence after ``!``, for parts that a contact periodic along y cannot have."""
    if not scene.numerics.repeats_y:
        return
    where = "with numerics.boundary = 'periodic-y'"
    if scene.grid.line:
        raise ValueError(f"!grid.length must be left out {where} (got 'infinite'), because strips are infinite along y")
    parts = {
        "inclusions": scene.inclusions, "eigenstrain": scene.eigenstrain, "body1.law": scene.body1.law,
        "body2.law": scene.body2.law, "body1.medium": scene.body1.medium, "body2.medium": scene.body2.medium,
        "bulk-stress": scene.bulk_at_rest,
    }  # fmt: skip
    present = next((name for name, is_present in parts.items() if is_present), None)
    if present is not None:
        raise ValueError(
            f"!{present} must be left out {where} (got both): only homogeneous elastic bodies can repeat along y"
        )
    _check_motions(
        scene, "a contact that repeats along y", "(got numerics.boundary = 'periodic-y'), because a rotation about "
        "x or z, or a motion along y, moves the geometry out of its period", "under loads that repeat along y",
    )  # fmt: skip


def _check_motions(scene: Scene, contact: str, reason: str, condition: str) -> None:
    """Refuse turns about x and z and travel along y, and motions against the inside without a depth."""
    for where, step in named_ramps(scene.steps):
        across = [name for name in step.prescribed if name in _ACROSS]
        if across:
            raise ValueError(f"!{where} must not prescribe {across[0]} in {contact} {reason}; leave it out")
        moved = [name for name in step.prescribed if name in _AGAINST_DEPTH]
        if moved and scene.grid.datum_depth is None:
            raise ValueError(
                f"!{where} must not prescribe {moved[0]} in {contact} without grid.datum-depth (got none): {condition} "
                "the displacement of distant points has no limit; set the depth of the reference points, or prescribe "
                "the load"
            )
