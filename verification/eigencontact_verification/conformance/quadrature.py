"""Integrals over a region known by `contains` alone: nested lines, each cut where the region begins and ends.

The first axis runs through the bounds; on each of its planes the second runs over where the region is met at all; on
each of those lines, along the longest edge, the region begins and ends where bisection finds it. Between the cuts
Gauss's rule is used, across the lines in the angle t of ``sin t``: sections of a round region begin like a square root.
Two rules of different fineness tell how far the integrals are to be trusted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
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
    return _rule(shape, 18, 6, 40), _rule(shape, 32, 8, 80)


def _rule(shape: Any, across: int, along: int, looks: int) -> Rule:
    """Rule of so many lines across, nodes along a line, and places of a line where the region is looked for."""
    box = region(shape)
    third = int(np.argmax(box.half))
    first, second = (axis for axis in range(3) if axis != third)
    scan = box.low[third] + 2 * box.half[third] * (np.arange(looks) + 0.5) / looks

    def met(lines: FloatArray) -> NDArray[np.bool_]:
        """Whether lines along the third axis through points ``(..., 3)`` meet the region at the places scanned."""
        probes = np.repeat(lines[..., None, :], looks, axis=-2)
        probes[..., third] = scan
        return np.asarray(np.any(inside(shape, probes), axis=-1))

    lines = box.center[None, :].copy()
    weights = np.ones(1)
    lines, weights = _spread(lines, weights, first, box.low[first][None], box.high[first][None], _arc(across))
    which, begin, end = _cuts(met, lines, second, (box.low[second], box.high[second]), looks, steps=26)
    lines, weights = _spread(lines[which], weights[which], second, begin, end, _arc(across))
    which, begin, end = _cuts(partial(inside, shape), lines, third, (box.low[third], box.high[third]), looks, steps=46)
    gauss = np.polynomial.legendre.leggauss(along)
    return Rule(*_spread(lines[which], weights[which], third, begin, end, gauss))


def _arc(count: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights on (-1, 1), Gauss's rule in the angle whose sine is the place."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    angle = np.pi / 2 * nodes
    return np.sin(angle), np.pi / 2 * weights * np.cos(angle)


def _spread(
    lines: FloatArray,
    weights: FloatArray,
    axis: int,
    begin: FloatArray,
    end: FloatArray,
    rule: tuple[FloatArray, FloatArray],
) -> tuple[FloatArray, FloatArray]:
    """Replace each point by those of a rule from `begin` to `end` along an axis."""
    nodes, gauss = rule
    points = np.repeat(lines[:, None, :], nodes.size, axis=1)
    points[..., axis] = ((begin + end)[:, None] + (end - begin)[:, None] * nodes) / 2
    return points.reshape(-1, 3), (weights[:, None] * (end - begin)[:, None] / 2 * gauss).ravel()


def _cuts(
    holds: Callable[[FloatArray], NDArray[np.bool_]],
    lines: FloatArray,
    axis: int,
    ends: tuple[float, float],
    looks: int,
    *,
    steps: int,
) -> tuple[NDArray[np.intp], FloatArray, FloatArray]:
    """Stretches along an axis where a predicate of points holds: number of the line, begin, end.

    The first and the last place looked at lie a hair beyond the bounds and count as outside: ends come in pairs.
    """
    shares = np.concatenate([[-1e-9], (np.arange(looks) + 0.5) / looks, [1 + 1e-9]])
    places = ends[0] + (ends[1] - ends[0]) * shares
    points = np.repeat(lines[:, None, :], places.size, axis=1)
    points[..., axis] = places
    held = holds(points)
    held[:, [0, -1]] = False
    which, place = np.nonzero(held[:, 1:] != held[:, :-1])
    entering = held[which, place + 1]
    lower, upper = places[place], places[place + 1]
    probe = lines[which]
    for _ in range(steps):
        probe[:, axis] = (lower + upper) / 2
        beyond = holds(probe) == entering
        lower, upper = np.where(beyond, lower, probe[:, axis]), np.where(beyond, probe[:, axis], upper)
    begin, end = ((lower + upper) / 2).reshape(-1, 2).T
    return which[::2], begin, end
