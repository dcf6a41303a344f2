"""Integrals over a region known by `contains` alone: lines along its longest edge, cut where it begins and ends.

The lines stand in the middle of a regular grid of the two other axes; along each the boundary is found by bisection and
Gauss's rule is exact to round-off for smooth integrands. What remains is the error of the middle-point rule across the
lines, second order; it is measured by comparing two grids.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.conformance.sampling import inside, region, remembered

__all__ = ["Rule", "quadrature_rules"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Rule:
    """Nodes ``(m, 3)`` [m] and weights ``(m,)`` [m^3]; the weights add up to the volume."""

    nodes: FloatArray
    weights: FloatArray

    @property
    def volume(self) -> float:
        """Volume of the region [m^3]."""
        return float(np.sum(self.weights))

    @property
    def centroid(self) -> FloatArray:
        """Centre of mass ``(3,)`` [m]."""
        center: FloatArray = self.weights @ self.nodes / self.volume
        return center


@remembered
def quadrature_rules(shape: Any) -> tuple[Rule, Rule]:
    """A coarse and a fine rule; integrals are known to about their difference."""
    return _rule(shape, 40, 6), _rule(shape, 64, 8)


def _rule(shape: Any, lines: int, along_line: int) -> Rule:
    box = region(shape)
    axis = int(np.argmax(box.half))
    first, second = (i for i in range(3) if i != axis)
    across = (np.arange(lines) + 0.5) / lines
    base = np.zeros((lines * lines, 3))
    grid = np.meshgrid(across, across, indexing="ij")
    for other, part in zip((first, second), grid, strict=True):
        base[:, other] = box.low[other] + 2 * box.half[other] * part.ravel()
    area = 4 * box.half[first] * box.half[second] / lines**2

    # the first and last place lie outside, a hair beyond bounds, so that boundaries come in pairs
    along = box.low[axis] + 2 * box.half[axis] * np.concatenate([[-1e-9], (np.arange(48) + 0.5) / 48, [1 + 1e-9]])
    scan = np.repeat(base[:, None, :], along.size, axis=1)
    scan[..., axis] = along
    held = inside(shape, scan)
    held[:, [0, -1]] = False
    line, place = np.nonzero(held[:, 1:] != held[:, :-1])
    entering = held[line, place + 1]
    low, high = along[place], along[place + 1]
    probe = base[line]
    for _ in range(48):
        probe[:, axis] = (low + high) / 2
        upper = inside(shape, probe) == entering
        low, high = np.where(upper, low, probe[:, axis]), np.where(upper, probe[:, axis], high)
    begin, end = ((low + high) / 2).reshape(-1, 2).T
    abscissae, gauss = np.polynomial.legendre.leggauss(along_line)
    nodes = np.repeat(base[line[::2], None, :], along_line, axis=1)
    nodes[..., axis] = ((begin + end)[:, None] + (end - begin)[:, None] * abscissae) / 2
    weights = area * (end - begin)[:, None] / 2 * gauss
    return Rule(nodes.reshape(-1, 3), weights.ravel())
