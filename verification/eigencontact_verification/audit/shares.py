"""Shares of cells that a boundary cuts: a run stores what each part of such a cell remembers, not its mean."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.loaded_body import Cells

if TYPE_CHECKING:
    from eigencontact.model.sources import Inhomogeneity

__all__ = ["mean_of_parts"]

FloatArray = NDArray[np.float64]

#: Shares up to this one are merged with the rest of their cell by the program.
_SLIVER = 0.05
#: Points along each edge of a cut cell by which shares are counted.
_POINTS = 6


def mean_of_parts(block: Cells, beside: FloatArray | None, sources: Sequence[Inhomogeneity], *, own_law: bool) -> Cells:
    """Cells with the mean of the strain and of the damage of their parts.

    The larger part that remembers is stored in `block`, the other one in `beside`, ``(3, 3, nz, ny, nx)``; what
    remembers nothing is elastic. Where a law averages over a neighbourhood, cells are whole and stay as they are.
    """
    if any(source.law.averaged for source in sources):
        return block
    number = np.array([own_law, *(bool(source.law.variables) for source in sources)])
    cut = _mixed(_labels(sources, *np.meshgrid(block.z, block.y, block.x, indexing="ij")))
    shares = np.zeros((number.size, int(cut.sum())))
    within = (np.arange(_POINTS) + 0.5) / _POINTS
    steps = [np.diff(edges) for edges in (block.z, block.y, block.x)]
    k, j, i = np.nonzero(cut)
    for c in within:
        for b in within:
            for a in within:
                places = block.z[k] + c * steps[0][k], block.y[j] + b * steps[1][j], block.x[i] + a * steps[2][i]
                shares[_labels(sources, *places), np.arange(k.size)] += 1.0 / _POINTS**3
    remembering = np.sort(shares[number], axis=0)
    total, larger = remembering.sum(axis=0), remembering[-1]
    whole = (larger < _SLIVER) | (larger > 1.0 - _SLIVER)
    larger, smaller = np.where(whole, 1.0, larger), np.where(whole, 0.0, total - larger)
    strain = block.eigenstrain.copy()
    strain[..., cut] *= larger
    if beside is not None:
        strain[..., cut] += smaller * beside[..., cut]
    stiffness = None if block.stiffness_factor is None else block.stiffness_factor.copy()
    if stiffness is not None:
        stiffness[cut] = 1.0 - larger * (1.0 - stiffness[cut])
    return replace(block, eigenstrain=strain, stiffness_factor=stiffness)


def _labels(sources: Sequence[Inhomogeneity], z: FloatArray, y: FloatArray, x: FloatArray) -> NDArray[np.intp]:
    """Number of the last source that holds each point, from 1; 0 is the body."""
    out = np.zeros(np.shape(z), dtype=int)
    for number, source in enumerate(sources, 1):
        out[source.shape.contains(x, y, z)] = number
    return out


def _mixed(labels: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Cells whose corners ``(nz + 1, ny + 1, nx + 1)`` differ."""
    corners = np.lib.stride_tricks.sliding_window_view(labels, (2, 2, 2))
    return np.asarray(corners.min(axis=(3, 4, 5)) != corners.max(axis=(3, 4, 5)))
