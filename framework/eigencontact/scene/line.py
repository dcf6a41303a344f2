"""What a line contact cannot have, or needs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from eigencontact.scene.steps import named_ramps

if TYPE_CHECKING:
    from eigencontact.core.grid import Grid
    from eigencontact.scene.schema import Scene

__all__ = ["check_line", "window_keys"]

#: Loads and motions that turn the body out of its plane, or move it along its length.
_ACROSS = frozenset({"moment-x", "tilt-x", "torsion-moment", "twist", "travel-y"})
#: Motions against the inside of the bodies.
_AGAINST_DEPTH = frozenset({"approach", "shift-x", "shift-y"})


def window_keys(grid: Grid, datum_depth: float | None) -> dict[str, Any]:
    """Keys of the table ``[grid]`` that give these cells; those of strips count displacements against a depth [m].

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
        keys |= {"length": "infinite"} | ({} if datum_depth is None else {"datum-depth": datum_depth})
    return keys


def check_line(scene: Scene) -> None:
    """Raise ValueError, with a whole sentence after ``!``, for parts that a line contact cannot have."""
    if not scene.grid.line:
        return
    if scene.inclusions and not scene.numerics.in_cells:
        raise ValueError(
            "!numerics.inclusion-resolution must be 'cells' in a line contact (got wholes): no plane strain of wholes "
            "is known"
        )
    if scene.numerics.half_space not in ("exact", "full-space") and (scene.inclusions or scene.eigenstrain):
        raise ValueError(
            "!numerics.half-space must be 'exact' or 'full-space' for eigenstrain below a line contact "
            f"(got {scene.numerics.half_space!r})"
        )
    across_bulk = [name for name in scene.bulk_at_rest if not name.endswith("_xx")]
    if across_bulk:
        raise ValueError(
            f"!{across_bulk[0].replace('_', '-')} must be left out in a line contact (got grid.length = 'infinite'): "
            "in plane strain the bulk stress yy follows from xx, and xy has nothing to do with the plane"
        )
    for where, step in named_ramps(scene.steps):
        across = [name for name in step.prescribed if name in _ACROSS]
        if across:
            raise ValueError(
                f"!{where} must not prescribe {across[0]} in a line contact (got grid.length = 'infinite'): plane "
                "strain has no turn about x or z and no motion of the geometry along y; leave it out"
            )
        moved = [name for name in step.prescribed if name in _AGAINST_DEPTH]
        if moved and scene.grid.datum_depth is None:
            raise ValueError(
                f"!{where} must not prescribe {moved[0]} in a line contact without grid.datum-depth (got none): in "
                "plane strain displacements have no limit far away, so name the depth of the points that move "
                "by it, or give the load"
            )
