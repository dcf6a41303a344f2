"""Is a loaded body of revolution about a vertical axis, and how nearly.

Layers always are. A region is if a turn about the axis leaves it alone (tested at points, `contains`) and its
eigenstrain is transversely isotropic about z. Fields on a square grid can be of revolution only within the steps of
their cells: a cell passes if its value lies between the smallest and the largest mean over the angle that rings within
one cell of it have, give or take 2 % of the largest value, and the rms of all that is beyond stays below 0.5 %. The
shear of the surface must stay below 1 % of the largest pressure; of the parts of a tensor that turn with the angle
(e_rt, e_tz) no more is left than the angle under which the axis sees the cell explains.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.loaded_body import Cells, LoadedBody, Tractions
from eigencontact_verification.fem.model import Region

__all__ = ["Revolution", "of_revolution"]

FloatArray = NDArray[np.float64]
Point = tuple[float, float]

#: What a cell may lie beyond the means of the rings nearby, and the rms of that, as parts of the largest value.
_BEYOND, _RMS = 0.02, 0.005
#: Shear of the surface that is left out, as a part of the largest pressure.
_SHEAR = 0.01
#: Part of a cell by which centres of pressure and of stored cells may differ from the axis.
_OFF_AXIS = 0.05
#: Points of a region's bounds that are turned, and by how many angles; part of them that may differ by rounding.
_POINTS, _ANGLES, _ROUNDING = 40, 12, 2e-3


class Revolution(NamedTuple):
    """Axis (x, y) of a body of revolution, and the rms distance of its cells' fields from their mean over the angle.

    ``scatter`` is a part of the field's rms, the largest of pressure, eigenstrain and damage; most of it is the step
    from cell to cell, whose effect dies out within a cell or two.
    """

    axis: Point
    scatter: float


def of_revolution(body: LoadedBody) -> Revolution | None:
    """Axis and scatter of a body of revolution; None if it is not one."""
    axes = _axes(body)
    if axes is None:
        return None
    (x, y), scatter = axes, 0.0
    if not all(_turns(region, (x, y)) for region in body.regions):
        return None
    fields: list[tuple[FloatArray, FloatArray, list[FloatArray], list[FloatArray]]] = []
    if body.tractions is not None and np.any(body.tractions.values):
        t = body.tractions
        if np.abs(t.values[:2]).max() > _SHEAR * np.abs(t.values[2]).max():
            return None
        fields.append((t.x, t.y, [t.values[2]], []))
    fields += [(cells.x, cells.y, *_components(cells, (x, y))) for cells in body.cells]
    for edges_x, edges_y, alike, zero_fields in fields:
        r = np.hypot((edges_x[1:] + edges_x[:-1]) / 2 - x, ((edges_y[1:] + edges_y[:-1]) / 2 - y)[:, None])
        width = float(max(np.diff(edges_x).max(), np.diff(edges_y).max()))
        for values, zeros in ((alike[:4], zero_fields), (alike[4:], [])):
            spread = _scatter(r, width, values, zeros)
            if spread is None:
                return None
            scatter = max(scatter, spread)
    return Revolution((x, y), scatter)


def _axes(body: LoadedBody) -> Point | None:
    """The one vertical axis that regions, pressure and cells can share."""
    axes: list[tuple[FloatArray, float]] = []
    for region in body.regions:
        low, high = (np.asarray(corner)[:2] for corner in region.bounds)
        axes.append(((low + high) / 2, 1e-6 * float((high - low).max())))
    sheets: list[tuple[FloatArray, FloatArray, FloatArray]] = []
    if body.tractions is not None:
        sheets.append((body.tractions.x, body.tractions.y, np.abs(body.tractions.values).sum(axis=0)))
    for cells in body.cells:
        weight = np.abs(cells.eigenstrain).sum(axis=(0, 1, 2))
        damage = 0.0 if cells.stiffness_factor is None else np.abs(1 - cells.stiffness_factor).sum(axis=0)
        sheets += [(cells.x, cells.y, weight), (cells.x, cells.y, damage + 0 * weight)]
    for edges_x, edges_y, weight in sheets:
        if np.any(weight):
            area = weight * np.diff(edges_x) * np.diff(edges_y)[:, None]
            mids = [(edges[1:] + edges[:-1]) / 2 for edges in (edges_x, edges_y)]
            centre = np.array([area.sum(axis=0) @ mids[0], area.sum(axis=1) @ mids[1]]) / area.sum()
            axes.append((centre, _OFF_AXIS * float(np.diff(edges_x).max())))
    if not axes:
        return (0.0, 0.0)
    axis = axes[0][0] if body.regions else _centred(axes[0][0], body)
    if any(np.abs(centre - axis).max() > within for centre, within in axes):
        return None
    return float(axis[0]), float(axis[1])


def _centred(centre: FloatArray, body: LoadedBody) -> FloatArray:
    """The middle of a cell or of an edge if the centre lies as near to it as the centre is known."""
    sheet: Tractions | Cells = body.tractions if body.tractions is not None else body.cells[0]
    out = np.array(centre, dtype=float)
    for k, edges in enumerate((sheet.x, sheet.y)):
        places = np.concatenate([edges, (edges[1:] + edges[:-1]) / 2])
        nearest = places[np.abs(places - centre[k]).argmin()]
        if abs(nearest - centre[k]) <= _OFF_AXIS * np.diff(edges).max():
            out[k] = nearest
    return out


def _turns(region: Region, axis: Point) -> bool:
    """Whether a turn about the axis leaves the region alone."""
    e = region.eigenstrain
    sideways = [e[0, 0] - e[1, 1], e[0, 1], e[0, 2], e[1, 2]]
    if np.abs(sideways).max() > 1e-9 * np.abs(e).max():
        return False
    low, high = (np.asarray(corner, dtype=float) for corner in region.bounds)
    if not np.all(np.isfinite([low, high])):
        return False
    share = (np.arange(_POINTS) + 0.5) / _POINTS
    r = (share * np.hypot(*(high - low)[:2] / 2))[:, None, None]
    z = (low[2] + share * (high[2] - low[2]))[:, None]
    turn = 0.1 + 2 * np.pi * np.arange(_ANGLES) / _ANGLES + 0.4 * np.arange(_ANGLES) / _ANGLES
    places = np.broadcast_arrays(axis[0] + r * np.cos(turn), axis[1] + r * np.sin(turn), z)
    inside = np.asarray(region.contains(*(np.ascontiguousarray(x) for x in places)), dtype=bool)
    return float(np.mean(inside != inside[..., :1])) <= _ROUNDING


def _components(cells: Cells, axis: Point) -> tuple[list[FloatArray], list[FloatArray]]:
    """Parts of the cells' fields that are the same all around, and those that are zero; each (nz, ny, nx)."""
    dx = (cells.x[1:] + cells.x[:-1]) / 2 - axis[0]
    dy = ((cells.y[1:] + cells.y[:-1]) / 2 - axis[1])[:, None]
    r = np.hypot(dx, dy)
    middle = r < 1e-9 * float(cells.x[-1] - cells.x[0])
    safe = np.where(middle, 1.0, r)
    c, s = np.where(middle, 1.0, dx / safe), np.where(middle, 0.0, dy / safe)
    e = cells.eigenstrain
    rr = c * c * e[0, 0] + s * s * e[1, 1] + 2 * c * s * e[0, 1]
    tt = s * s * e[0, 0] + c * c * e[1, 1] - 2 * c * s * e[0, 1]
    rt = c * s * (e[1, 1] - e[0, 0]) + (c * c - s * s) * e[0, 1]
    alike = [rr, tt, e[2, 2], c * e[0, 2] + s * e[1, 2]]
    if cells.stiffness_factor is not None:
        alike.append(1 - cells.stiffness_factor)
    return alike, [rt, c * e[1, 2] - s * e[0, 2]]


def _scatter(r: FloatArray, width: float, alike: list[FloatArray], zero_fields: list[FloatArray]) -> float | None:
    """Rms distance from the mean over the angle, as a part of the rms; None where it is more than steps of cells."""
    largest = max((float(np.abs(values).max()) for values in (*alike, *zero_fields)), default=0.0)
    if largest == 0.0:
        return 0.0
    ring = np.rint(2 * r / width).astype(int).ravel()
    count = np.bincount(ring)
    around, size, beyond = 0.0, 0.0, []
    for values, vanishes in [(v, False) for v in alike] + [(v, True) for v in zero_fields]:
        flat = values.reshape(-1, r.size)
        mean = np.stack([np.bincount(ring, weights=row) for row in flat]) / np.maximum(count, 1)
        if vanishes:  # what is zero all around turns by the angle under which the axis sees a cell
            mean[:] = 0.0
        high, low = (_nearby(np.where(count > 0, mean, sign * -np.inf), sign)[:, ring] for sign in (1, -1))
        steps = np.zeros_like(flat)
        if vanishes:
            steps += np.minimum(1.0, width / np.maximum(r.ravel(), width)) * largest
        over = np.maximum(0.0, np.maximum(flat - high, low - flat) - steps)
        beyond.append(over / largest)
        around += float(np.sum((flat - mean[:, ring]) ** 2))
        size += float(np.sum(flat**2))
    worst, rms = max(float(x.max()) for x in beyond), max(float(np.sqrt(np.mean(x**2))) for x in beyond)
    if worst > _BEYOND or rms > _RMS:
        return None
    return float(np.sqrt(around / size)) if size else 0.0


def _nearby(mean: FloatArray, sign: int) -> FloatArray:
    """Largest (sign 1) or smallest (-1) mean of the rings, half a cell wide each, within one cell."""
    padded = np.pad(mean, ((0, 0), (2, 2)), constant_values=-sign * np.inf)
    shifted = np.stack([padded[:, k : k + mean.shape[1]] for k in range(5)])
    return np.asarray(shifted.max(axis=0) if sign > 0 else shifted.min(axis=0))
