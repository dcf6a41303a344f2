"""One grid for all variants of a sweep, so that fields can be compared cell by cell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import ceil

from eigencontact.errors import EigencontactError, PlanError
from eigencontact.sweeps.variants import Variant

__all__ = ["on_one_grid"]

#: Cells of the shared window beyond which a sweep is refused rather than run for days unasked.
_MOST = 2**24


def on_one_grid(variants: Sequence[Variant]) -> list[Variant]:
    """Variants with the window that holds all their windows, in the finest of their cells.

    Raises
    ------
    PlanError
        No variant can be planned, or the window would have too many cells.
    """
    from eigencontact.app import plan
    from eigencontact.scene.schema import GridSpec

    grids, out = [], list[Variant]()
    for variant in variants:
        if variant.scene is None:
            out.append(variant)
            continue
        try:
            grids.append(plan(variant.scene).grid)
            out.append(variant)
        except EigencontactError as problem:
            out.append(replace(variant, scene=None, refused=str(problem)))
    if not grids:
        raise PlanError(f"every variant of the sweep is refused; the first: {out[0].refused}")
    edges = [min(getattr(grid, name) for grid in grids) for name in ("dx", "dy")]
    spans = []
    for axis, cells, edge in ((0, "nx", "dx"), (1, "ny", "dy")):
        half = [0.5 * getattr(grid, cells) * getattr(grid, edge) for grid in grids]
        middles = [grid.center[axis] for grid in grids]
        low = min(middle - one for middle, one in zip(middles, half, strict=True))
        high = max(middle + one for middle, one in zip(middles, half, strict=True))
        spans.append((low, high))
    counts = [2 * ceil(0.5 * (high - low) / edge * (1 - 1e-9)) for (low, high), edge in zip(spans, edges, strict=True)]
    if counts[0] * counts[1] > _MOST:
        raise PlanError(
            f"a shared grid must have at most {_MOST} cells (got {counts[0]} x {counts[1]}: the largest window in the "
            "finest cells); give grid.cells and grid.size in the scene, or vary less"
        )
    spec = GridSpec(
        cells=(counts[0], counts[1]),
        size=(counts[0] * edges[0], counts[1] * edges[1]),
        center=(0.5 * sum(spans[0]), 0.5 * sum(spans[1])),
    )
    return [one if one.scene is None else replace(one, scene=one.scene.model_copy(update={"grid": spec}).within(
        one.scene.folder)) for one in out]  # fmt: skip
