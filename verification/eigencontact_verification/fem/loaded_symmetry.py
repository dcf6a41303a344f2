"""Planes of symmetry of a loaded body, and the body moved so that they pass through the origin.

A plane counts if tractions, cells and regions all have it: stored fields to `TOLERANCE` of their largest value, after
which both halves are averaged; regions at `PROBES` points.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.assembly import point_state
from eigencontact_verification.fem.loaded_body import LoadedBody
from eigencontact_verification.fem.model import Model, Region

__all__ = ["PROBES", "TOLERANCE", "Centred", "boxes_of", "centred", "moved", "reflected"]

FloatArray = NDArray[np.float64]

TOLERANCE = 1e-5
PROBES = 4000
_KINDS = ("even", "odd")
#: A cell whose value is below this part of the largest does not decide where the middle is.
_NOTHING = 1e-3


@dataclass(frozen=True, kw_only=True, eq=False)
class Centred:
    """A loaded body whose planes of symmetry are x = 0 and y = 0.

    Attributes
    ----------
    body : LoadedBody
        Moved, its fields averaged over symmetric halves.
    origin : (3,) array
        Where its origin is in the body as given.
    symmetry : (str, str)
        ``"none"``, ``"even"`` or ``"odd"`` for each plane.
    """

    body: LoadedBody
    origin: FloatArray
    symmetry: tuple[str, str]


def _moved_region(region: Region, origin: FloatArray) -> Region:
    x0, y0, _ = origin

    def contains(x: FloatArray, y: FloatArray, z: FloatArray) -> Any:
        return region.contains(x + x0, y + y0, z)

    low, high = (tuple(np.asarray(corner) - origin) for corner in region.bounds)
    return replace(region, contains=contains, bounds=(low, high))


def moved(body: LoadedBody, origin: FloatArray) -> LoadedBody:
    """The body in coordinates with another origin."""
    x0, y0, _ = origin
    loads = body.tractions
    return replace(
        body,
        regions=tuple(_moved_region(region, origin) for region in body.regions),
        tractions=None if loads is None else replace(loads, x=loads.x - x0, y=loads.y - y0),
        cells=tuple(replace(cells, x=cells.x - x0, y=cells.y - y0) for cells in body.cells),
    )


def _span(edges: FloatArray, filled: NDArray[np.bool_]) -> tuple[float, float]:
    hit = np.flatnonzero(filled)
    return float(edges[hit[0]]), float(edges[hit[-1] + 1])


def boxes_of(body: LoadedBody, least: float = 0.0) -> Iterator[tuple[str, FloatArray]]:
    """Kind and box (2, 3) of everything that loads or disturbs the body; cells count above a part of the largest."""
    if body.tractions is not None and body.tractions.values.any():
        size = np.abs(body.tractions.values).max(axis=0)
        size = size > least * size.max()
        x, y = _span(body.tractions.x, size.any(axis=0)), _span(body.tractions.y, size.any(axis=1))
        yield "tractions", np.array([(x[0], y[0], 0.0), (x[1], y[1], 0.0)])
    for region in body.regions:
        yield "region", np.array(region.bounds, dtype=float)
    for cells in body.cells:
        size = np.abs(cells.eigenstrain).max(axis=(0, 1))
        size = size / max(float(size.max()), 1e-300)
        if cells.stiffness_factor is not None:
            damage = np.abs(1 - cells.stiffness_factor)
            size = np.maximum(size, damage / max(float(damage.max()), 1e-300))
        size = size > least
        if size.any():
            spans = [_span(e, size.any(axis=a)) for e, a in ((cells.x, (0, 1)), (cells.y, (0, 2)), (cells.z, (1, 2)))]
            yield "cells", np.array(spans).T


def reflected(values: FloatArray, edges: FloatArray, middle: float, axis: int) -> FloatArray | None:
    """Values on the cells reflected at a place along one axis; zero beyond the edges; None if cells do not match."""
    centre = (edges[1:] + edges[:-1]) / 2
    images = 2 * middle - centre
    at = np.clip(np.searchsorted(edges, images, side="right") - 1, 0, centre.size - 1)
    inside = (images > edges[0]) & (images < edges[-1])
    if not np.allclose(centre[at][inside], images[inside], rtol=0, atol=1e-4 * float(np.diff(edges).min())):
        return None
    shape = [1] * values.ndim
    shape[axis] = -1
    return np.asarray(np.take(values, at, axis=axis) * inside.reshape(shape))


def _signs(plane: int, kind: str) -> FloatArray:
    turn = np.where(np.arange(3) == plane, -1.0, 1.0)
    return turn if kind == "even" else -turn


def _symmetric(values: FloatArray, image: FloatArray | None) -> FloatArray | None:
    if image is None or np.abs(values - image).max() > TOLERANCE * np.abs(values).max():
        return None
    return np.asarray((values + image) / 2)


def _folded(body: LoadedBody, plane: int, kind: str, middle: float) -> LoadedBody | None:
    """The body with its fields averaged over both sides of a plane, or None without that symmetry."""
    turn = _signs(plane, kind)
    tensor = np.multiply.outer(turn, turn) * (1.0 if kind == "even" else -1.0)
    loads, boxes = body.tractions, []
    if loads is not None:
        image = reflected(loads.values, (loads.x, loads.y)[plane], middle, 2 - plane)
        values = None if image is None else _symmetric(loads.values, turn[:, None, None] * image)
        if values is None:
            return None
        loads = replace(loads, values=values)
    for cells in body.cells:
        edges = (cells.x, cells.y)[plane]
        image = reflected(cells.eigenstrain, edges, middle, 4 - plane)
        strain = None if image is None else _symmetric(cells.eigenstrain, tensor[:, :, None, None, None] * image)
        if strain is None:
            return None
        stiffness = cells.stiffness_factor
        if stiffness is not None:
            damage = reflected(1 - stiffness, edges, middle, 2 - plane)
            damage = None if damage is None else _symmetric(1 - stiffness, damage)
            if damage is None:
                return None
            stiffness = 1 - damage
        boxes.append(replace(cells, eigenstrain=strain, stiffness_factor=stiffness))
    if body.regions and not _regions_fold(body, plane, tensor, middle):
        return None
    return replace(body, tractions=loads, cells=tuple(boxes))


def _regions_fold(body: LoadedBody, plane: int, tensor: FloatArray, middle: float) -> bool:
    corners = np.array([region.bounds for region in body.regions])
    low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
    reach = max(middle - low[plane], high[plane] - middle)
    low[plane], high[plane] = middle - reach, middle + reach
    spread = np.random.default_rng(0).random((PROBES, 3))
    uniform = low + spread * (high - low)
    near = corners[:, 0, None] + spread[: PROBES // len(corners) + 1] * (corners[:, 1] - corners[:, 0])[:, None]
    points = np.concatenate([uniform, near.reshape(-1, 3)])
    mirror = points.copy()
    mirror[:, plane] = 2 * middle - mirror[:, plane]
    model = _stand_in(body)
    state, mirrored = point_state(model, points), point_state(model, mirror)
    equal = all(np.array_equal(a, b) for a, b in zip(state[:2], mirrored[:2], strict=True))
    return equal and bool(np.allclose(state[2], tensor * mirrored[2], rtol=1e-9, atol=1e-300))


def _stand_in(body: LoadedBody) -> Model:
    """A model with the material of the body, for `assembly.point_state`."""
    reach = 2 * max((float(np.abs(box).max()) for _, box in boxes_of(body)), default=1.0)
    reach += sum(layer.thickness for layer in body.layers)
    return Model(
        young_modulus=body.young_modulus, poisson_ratio=body.poisson_ratio, layers=body.layers, regions=body.regions,
        reach=reach, fine=reach / 2,
    )  # fmt: skip


def centred(body: LoadedBody, *, use: bool = True) -> Centred:
    """Find the planes of symmetry, or else the middle of what loads the body.

    Parameters
    ----------
    body : LoadedBody
    use : bool
        False: take no plane, for tests of the same body without symmetry.
    """
    boxes = [box for _, box in boxes_of(body, _NOTHING)]
    if not boxes:
        raise ValueError("body must have tractions, regions or cells (got none of them); give what loads it")
    whole = np.array([np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)])
    origin, symmetry = np.zeros(3), ["none", "none"]
    for plane in (0, 1):
        origin[plane] = whole[:, plane].mean()
        if not use:
            continue
        middles = np.unique([box[:, plane].mean() for box in [whole, *boxes]])
        for middle, kind in ((m, k) for m in middles for k in _KINDS):
            folded = _folded(body, plane, kind, float(middle))
            if folded is not None:
                body, symmetry[plane], origin[plane] = folded, kind, middle
                break
    return Centred(body=moved(body, origin), origin=origin, symmetry=(symmetry[0], symmetry[1]))
