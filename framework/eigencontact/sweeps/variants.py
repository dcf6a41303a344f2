"""Variants of a scene: one for each combination of values, their names, and a common grid."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, replace
from hashlib import sha256
from itertools import product
from math import ceil, isclose
from typing import TYPE_CHECKING, Any

from eigencontact.core.grid import Grid
from eigencontact.errors import EigencontactError, PlanError, SceneError
from eigencontact.scene.loader import put_values

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eigencontact.scene.schema import Scene
    from eigencontact.sweeps.axes import Axis

__all__ = ["Variant", "on_one_grid", "refuse_different_cells", "variants_of"]

_LONGEST = 100
#: Cells of the shared window beyond which a sweep is refused rather than run for days unasked.
_MOST = 2**24


@dataclass(frozen=True)
class Variant:
    """One scene of a sweep.

    Attributes
    ----------
    label : str
        Name of its folder, made of its values.
    place : tuple of int
        Number of its value on each axis; of paired axes one number.
    values : dict
        Value of each key.
    scene : Scene or None
        What is run; None where the values make no scene.
    refused : str
        Why the variant is not run: values that make no scene, or a scene that no plan can be made of.
    """

    label: str
    place: tuple[int, ...]
    values: dict[str, Any]
    scene: Scene | None
    refused: str = ""


def variants_of(scene: Scene, axes: Sequence[Axis], *, pairs: bool, pictures: bool) -> list[Variant]:
    """All combinations, the last axis fastest; or the values of all axes paired.

    Raises
    ------
    SceneError
        Pairs of axes of different length; every variant refused (the first reason).
    """
    if pairs:
        counts = {axis.key: len(axis.values) for axis in axes}
        if len(set(counts.values())) > 1:
            raise SceneError(f"pairs must have as many values of each key (got {json.dumps(counts)})")
        places = [(k,) * len(axes) for k in range(len(axes[0].values))]
    else:
        places = list(product(*(range(len(axis.values)) for axis in axes)))
    variants = [_variant(scene, axes, place, pairs=pairs, pictures=pictures) for place in places]
    if all(variant.scene is None for variant in variants):
        raise SceneError(f"every variant of the sweep is refused; the first: {variants[0].refused}")
    return variants


def _variant(scene: Scene, axes: Sequence[Axis], place: tuple[int, ...], *, pairs: bool, pictures: bool) -> Variant:
    from eigencontact.scene.schema import Scene as Made

    values = {axis.key: axis.values[k] for axis, k in zip(axes, place, strict=True)}
    more = {} if pictures else {"output.pictures": False, "output.vtk": False, "output.animation": False}
    label, at = _label(values), place[:1] if pairs else place
    try:
        variant_scene = Made(**put_values(scene.resolved(), {**more, **values}))
    except EigencontactError as problem:
        return Variant(label, at, values, None, str(problem))
    return Variant(label, at, values, variant_scene.within(scene.folder))


def _label(values: dict[str, Any]) -> str:
    """Name of a folder from the values of a variant; a hash replaces values that do not fit."""
    text = "_".join(f"{key.rpartition('.')[2]}={value}" for key, value in values.items())
    plain = re.sub(r"[^\w.=+-]", "", text.replace(" ", ""), flags=re.ASCII)
    full = sha256(json.dumps(values, sort_keys=True, default=str).encode()).hexdigest()[:8]
    return plain if len(plain) <= _LONGEST and plain == text.replace(" ", "") else f"{plain[:_LONGEST]}-{full}"


def on_one_grid(variants: Sequence[Variant]) -> list[Variant]:
    """Variants on a common window that contains all their windows, in the finest of their cells.

    Raises
    ------
    PlanError
        No variant can be planned, the window would have too many cells, or a period would change.
    """
    from eigencontact.scene.line import window_keys
    from eigencontact.scene.schema import GridSpec

    out, grids = _planned(variants)
    if not grids:
        raise PlanError(f"every variant of the sweep is refused; the first: {out[0].refused}")
    edges = [min(getattr(grid, name) for grid in grids) for name in ("dx", "dy")]
    spans = []
    for axis, cells, edge in ((0, "nx", "dx"), (1, "ny", "dy")):
        half = [0.5 * getattr(grid, cells) * getattr(grid, edge) for grid in grids]
        middles = [grid.center[axis] for grid in grids]
        low = min(middle - span for middle, span in zip(middles, half, strict=True))
        high = max(middle + span for middle, span in zip(middles, half, strict=True))
        spans.append((low, high))
    counts = [ceil((high - low) / edge * (1 - 1e-9)) for (low, high), edge in zip(spans, edges, strict=True)]
    rectangles = max(grids, key=lambda grid: len(grid.counts))  # strips only where all variants are line contacts
    shared = rectangles.with_cells(counts[0], counts[1], edges[0], edges[1], (0.5 * sum(spans[0]), 0.5 * sum(spans[1])))
    if shared.nx * shared.ny > _MOST:
        raise PlanError(
            f"a shared grid must have at most {_MOST} cells (got {shared.nx} x {shared.ny}: the largest window in the "
            "finest cells); give grid.cells and grid.size in the scene, or vary less"
        )
    _refuse_changed_periods(out, grids, shared)
    endless = all(grid.ended_axes == (0,) for grid in grids)  # displacements count against a depth
    spec = GridSpec.model_validate(window_keys(shared, max(grid.size[0] for grid in grids) if endless else None))
    return [variant if variant.scene is None or variant.refused else replace(variant, scene=variant.scene.model_copy(
        update={"grid": spec}).within(variant.scene.folder)) for variant in out]  # fmt: skip


def _refuse_changed_periods(variants: Sequence[Variant], grids: Sequence[Grid], shared: Grid) -> None:
    """Refuse a shared window that changes the period of a variant whose window repeats."""
    planned = (variant for variant in variants if not variant.refused)
    for variant, grid in zip(planned, grids, strict=True):
        for axis in variant.scene.numerics.repeated_axes if variant.scene else ():
            if not isclose(grid.size[axis], shared.size[axis], rel_tol=1e-9):
                raise PlanError(
                    f"a shared grid must keep the period of each variant (got {grid.size[axis]:.3g} m along "
                    f"{'xy'[axis]} in {variant.label!r}, {shared.size[axis]:.3g} m in the shared grid); give "
                    "grid.size and grid.cells in the scene"
                )


def refuse_different_cells(variants: Sequence[Variant]) -> None:
    """Refuse variants on different cells before any run, because their fields do not fit in one dataset.

    Raises
    ------
    PlanError
        Two variants have different cells.
    """
    if _plainly_alike(variants):
        return
    planned, grids = _planned(variants)
    able = [item for item in planned if not item.refused]
    for variant, grid in zip(able, grids, strict=True):
        if not _equal_cells(grid, grids[0]):
            raise PlanError(
                f"fields must lie on the same cells in all variants (got {_cells_of(grids[0])} in {able[0].label!r} "
                f'and {_cells_of(grid)} in {variant.label!r}); give grid = "shared" (--shared-grid), or grid.cells '
                "and grid.size"
            )


def _plainly_alike(variants: Sequence[Variant]) -> bool:
    """Whether all scenes specify the same window by numbers, so that no plan is needed."""
    specs = [variant.scene.grid for variant in variants if variant.scene is not None]
    numeric = all(spec.cells is not None and (spec.size is not None or spec.spacing is not None) for spec in specs)
    return numeric and all(spec == specs[0] for spec in specs)


def _planned(variants: Sequence[Variant]) -> tuple[list[Variant], list[Grid]]:
    """Variants, with the reason for each that cannot be planned, and the windows of the planned variants."""
    from eigencontact.app import plan

    grids, out = list[Grid](), list[Variant]()
    for variant in variants:
        refused = variant.refused
        if variant.scene is not None and not refused:
            try:
                grids.append(plan(variant.scene).grid)
            except EigencontactError as problem:
                refused = str(problem)
        out.append(replace(variant, refused=refused))
    return out, grids


def _equal_cells(first: Grid, second: Grid) -> bool:
    """Whether cells are the same but for round-off."""
    moved = max(abs(a - b) for a, b in zip(first.center, second.center, strict=True))
    alike = isclose(first.dx, second.dx, rel_tol=1e-9) and isclose(first.dy, second.dy, rel_tol=1e-9)
    return first.shape == second.shape and alike and moved < 1e-6 * min(first.dx, first.dy)


def _cells_of(grid: Grid) -> str:
    return f"{grid.nx} x {grid.ny} of {grid.dx:.3g} m"
