"""Loads without planes of symmetry as a sum of even and odd ones, each of which a quarter of a mesh carries.

A body of layers has every vertical plane of symmetry; only its tractions and eigenstrain may lack them. Its response is
linear, so that the sum of the responses to the parts is that to the whole. A quarter of the block has elements half as
long along x and y for the same number of unknowns.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.loaded_body import LoadedBody
from eigencontact_verification.fem.loaded_symmetry import PROBES, TOLERANCE, centred, moved, reflected
from eigencontact_verification.fem.model import Region

__all__ = ["parities"]

FloatArray = NDArray[np.float64]


def parities(body: LoadedBody) -> tuple[LoadedBody, ...]:
    """Bodies whose loads add up to those of a body, each even or odd about planes across x and y.

    Parameters
    ----------
    body : LoadedBody
        With tractions or eigenstrain. With both, with regions or cells of other moduli, and where no plane reflects
        the cells or each of the regions onto themselves, it is returned as it is.

    Examples
    --------
    >>> from eigencontact_verification.fem.loaded_body import Tractions
    >>> edges = np.arange(4.0)
    >>> push = np.zeros((3, 3, 3))
    >>> push[2, 0, 0] = 1.0
    >>> body = LoadedBody(young_modulus=1.0, poisson_ratio=0.3, tractions=Tractions(x=edges, y=edges, values=push))
    >>> parts = parities(replace(body, tractions=Tractions(x=edges, y=edges, values=push + push[:, ::-1, ::-1])))
    >>> [part.tractions.values[2, 0].tolist() for part in parts]
    [[0.5, 0.0, 0.5], [0.5, 0.0, -0.5]]
    """
    strained = bool(body.regions or body.cells)
    if strained == (body.tractions is not None) or _size(body) == 0.0 or _varies(body):
        return (body,)
    centre = centred(body)
    pieces, least = [centre.body], TOLERANCE * _size(body)
    for plane in (axis for axis, kind in enumerate(centre.symmetry) if kind == "none"):
        halves = []
        for component in pieces:
            mirror = _mirrored(component, plane)
            if mirror is None:
                return (body,)
            halves += [_half(component, mirror, 1.0), _half(component, mirror, -1.0)]
        pieces = halves
    return tuple(moved(component, -centre.origin) for component in pieces if _size(component) > least)


def _varies(body: LoadedBody) -> bool:
    """Whether moduli are others than those of the layers, which every plane reflects onto themselves."""
    varied = any(region.young_modulus is not None or region.poisson_ratio is not None for region in body.regions)
    return varied or any(cells.stiffness_factor is not None for cells in body.cells)


def _size(body: LoadedBody) -> float:
    """Largest traction or eigenstrain."""
    loads = [] if body.tractions is None else [body.tractions.values]
    loads += [region.eigenstrain for region in body.regions] + [cells.eigenstrain for cells in body.cells]
    return max((float(np.abs(values).max()) for values in loads), default=0.0)


def _mirrored(body: LoadedBody, plane: int) -> LoadedBody | None:
    """The body behind a mirror across x or y, on the same cells and regions, or None where these do not match."""
    turn = np.where(np.arange(3) == plane, -1.0, 1.0)
    tensor = np.multiply.outer(turn, turn)
    lines = [] if body.tractions is None else [(body.tractions.x, body.tractions.y)[plane]]
    lines += [(cells.x, cells.y)[plane] for cells in body.cells]
    middles = [0.5 * float(line[0] + line[-1]) for line in lines]
    middles += [0.5 * float(region.bounds[0][plane] + region.bounds[1][plane]) for region in body.regions]
    middle, size = middles[0], min([float(np.diff(line).min()) for line in lines], default=np.inf)
    size = min([size, *(float(region.bounds[1][plane] - region.bounds[0][plane]) for region in body.regions)])
    if np.ptp(middles) > 1e-6 * size or not all(_reflects(region, plane, middle) for region in body.regions):
        return None
    tractions, boxes = body.tractions, []
    if tractions is not None:
        values = reflected(tractions.values, lines[0], middle, 2 - plane)
        if values is None:
            return None
        tractions = replace(tractions, values=turn[:, None, None] * values)
    for cells in body.cells:
        strain = reflected(cells.eigenstrain, (cells.x, cells.y)[plane], middle, 4 - plane)
        if strain is None:
            return None
        boxes.append(replace(cells, eigenstrain=tensor[:, :, None, None, None] * strain))
    regions = tuple(replace(region, eigenstrain=tensor * region.eigenstrain) for region in body.regions)
    return replace(body, tractions=tractions, cells=tuple(boxes), regions=regions)


def _reflects(region: Region, plane: int, middle: float) -> bool:
    """Whether a plane reflects a region onto itself."""
    low, high = np.asarray(region.bounds, dtype=float)
    points = low + np.random.default_rng(0).random((PROBES, 3)) * (high - low)
    mirror = points.copy()
    mirror[:, plane] = 2.0 * middle - mirror[:, plane]
    return bool(np.array_equal(region.contains(*points.T), region.contains(*mirror.T)))


def _half(body: LoadedBody, mirror: LoadedBody, sign: float) -> LoadedBody:
    """Half the sum, or the difference, of a body's loads and those behind a mirror."""
    tractions = body.tractions
    if tractions is not None and mirror.tractions is not None:
        tractions = replace(tractions, values=0.5 * (tractions.values + sign * mirror.tractions.values))
    boxes = zip(body.cells, mirror.cells, strict=True)
    pairs = zip(body.regions, mirror.regions, strict=True)
    return replace(
        body, tractions=tractions,
        cells=tuple(replace(a, eigenstrain=0.5 * (a.eigenstrain + sign * b.eigenstrain)) for a, b in boxes),
        regions=tuple(replace(a, eigenstrain=0.5 * (a.eigenstrain + sign * b.eigenstrain)) for a, b in pairs),
    )  # fmt: skip
