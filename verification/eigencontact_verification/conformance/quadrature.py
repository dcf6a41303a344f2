"""Integrals over a region known by `contains` alone: nested lines, cut where the region begins, ends or branches.

Along a line the region is a number of stretches; across the lines of a plane that number changes at some places, and
from plane to plane the sequence of such numbers does. Each axis is cut at those changes, found by bisection: between
them integrands are smooth but for ends like a square root, where sections of a round region close. Gauss's rule in the
angle t of ``sin t`` takes those. Two rules of different fineness tell how far the integrals are to be trusted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.conformance.sampling import inside, principal_axes, region, remembered

__all__ = ["Rule", "depth_rule", "quadrature_rules", "ray_rules"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


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
    return _rule(shape, 18, 6, 36), _rule(shape, 32, 8, 72)


def ray_rules(shape: Any, places: FloatArray) -> tuple[list[Rule], list[Rule]]:
    """A coarse and a fine rule for each point inside, along rays from it: they integrate polynomials over R or R².

    Nodes may lie outside: a stretch that begins away from the point is the difference of two that begin at it, with
    negative weights.
    """
    coarse, fine = ([_rays(shape, place, count) for place in places] for count in (24, 36))
    return coarse, fine


def _rays(shape: Any, place: FloatArray, count: int) -> Rule:
    box = region(shape)
    cosines, gauss = np.polynomial.legendre.leggauss(count)
    angles = np.pi * (np.arange(2 * count) + 0.5) / count
    sine = np.sqrt(1 - cosines**2)[:, None]
    rays = np.stack([sine * np.cos(angles), sine * np.sin(angles), cosines[:, None] + 0 * angles], axis=-1)
    # Directions of a slender region: half way between even ones and those of the region stretched to a ball, as 1/R
    # varies fast with the ones, the length of rays with the others.
    _, axes, spread = principal_axes(shape)
    rays = rays.reshape(-1, 3) * np.sqrt(spread) @ axes.T
    steps = np.linspace(0.0, 2 * box.radius / np.sqrt(spread.min()), 257)
    contained = inside(shape, place + steps[:, None, None] * rays)
    step, ray = np.nonzero(contained[1:] != contained[:-1])
    leaves = contained[step, ray]
    low, high = steps[step], steps[step + 1]
    for _ in range(46):
        middle = (low + high) / 2
        still = inside(shape, place + middle[:, None] * rays[ray]) == leaves
        low, high = np.where(still, middle, low), np.where(still, high, middle)
    nodes, along = np.polynomial.legendre.leggauss(6)
    distance = low[:, None] * (nodes + 1) / 2
    weight = np.repeat(gauss, angles.size)[ray] * np.pi / count * np.sqrt(np.prod(spread)) * np.where(leaves, 1.0, -1.0)
    weights = weight[:, None] * along * low[:, None] / 2 * distance**2
    points: FloatArray = place + distance[..., None] * rays[ray][:, None, :]
    return Rule(points.reshape(-1, 3), weights.ravel())


def _rule(shape: Any, across: int, along: int, looks: int) -> Rule:
    """Rule of so many lines across (fewer in each of many pieces), nodes along, places where changes are looked for."""
    box = region(shape)
    third = int(np.argmax(box.half))
    first, second = (axis for axis in range(3) if axis != third)
    looks_along = [
        low + (high - low) * (np.arange(looks) + 0.5) / looks for low, high in zip(box.low, box.high, strict=True)
    ]
    ends = [(float(low), float(high)) for low, high in zip(box.low, box.high, strict=True)]

    def swept(points: FloatArray, axis: int) -> FloatArray:
        """Lines along an axis through points ``(..., 3)``: ``(..., looks, 3)``."""
        lines = np.repeat(points[..., None, :], looks, axis=-2)
        lines[..., axis] = looks_along[axis]
        return lines

    def stretches(points: FloatArray) -> IntArray:
        """How many stretches of the region lie on lines along the third axis."""
        contained = inside(shape, swept(points, third))
        return np.asarray(contained[..., 0] + np.sum(contained[..., 1:] & ~contained[..., :-1], axis=-1))

    def branches(points: FloatArray) -> IntArray:
        """A number for the sequence of `stretches` along the second axis, repetitions left out; 0 if all are 0."""
        counts = stretches(swept(points, second))
        code, before = np.zeros(counts.shape[:-1], np.int64), np.zeros(counts.shape[:-1], np.int64)
        for count in np.moveaxis(counts, -1, 0):
            code = np.where(count != before, (31 * code + count + 1) % 1_000_003, code)
            before = count
        return code

    def containment(points: FloatArray) -> IntArray:
        return inside(shape, points).astype(np.int64)

    lines, weights = box.center[None, :].copy(), np.ones(1)
    for axis, signature, steps in ((first, branches, 22), (second, stretches, 30), (third, containment, 46)):
        which, begin, end = _pieces(signature, lines, axis, ends[axis], looks, steps)
        count = max(across // 3, round(across * len(lines) / len(which)))
        rule = np.polynomial.legendre.leggauss(along) if axis == third else _arc(count)
        lines, weights = _spread(lines[which], weights[which], axis, begin, end, rule)
    return Rule(lines, weights)


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


def _pieces(
    signature: Callable[[FloatArray], IntArray],
    lines: FloatArray,
    axis: int,
    ends: tuple[float, float],
    looks: int,
    steps: int,
) -> tuple[NDArray[np.intp], FloatArray, FloatArray]:
    """Pieces along an axis on which a whole number is constant and not 0: number of the line, begin, end.

    The first and the last place looked at lie a hair beyond the bounds, where the number counts as 0.
    """
    places = ends[0] + (ends[1] - ends[0]) * np.concatenate([[-1e-9], (np.arange(looks) + 0.5) / looks, [1 + 1e-9]])
    points = np.repeat(lines[:, None, :], places.size, axis=1)
    points[..., axis] = places
    values = signature(points)
    values[:, [0, -1]] = 0
    which, place = np.nonzero(values[:, 1:] != values[:, :-1])
    before, after = values[which, place], values[which, place + 1]
    low, high = places[place], places[place + 1]
    probe = lines[which]
    for _ in range(steps):
        probe[:, axis] = (low + high) / 2
        still = signature(probe) == before
        low, high = np.where(still, probe[:, axis], low), np.where(still, high, probe[:, axis])
    cut = (low + high) / 2
    opens = np.flatnonzero(after[:-1] != 0)
    return which[opens], cut[opens], cut[opens + 1]


def depth_rule(size: float, places: FloatArray, count: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauss's rule for integrals from the images of places upwards, by the distance ``size * s / (1 - s)``.

    Parameters
    ----------
    size : float
        Length of the region [m].
    places : (n, 3) float64
    count : int

    Returns
    -------
    distances, weights : (count,) float64
    points : (n, count, 3) float64
    """
    abscissae, gauss = np.polynomial.legendre.leggauss(count)
    share = (abscissae + 1) / 2
    distances = size * share / (1 - share)
    points = np.repeat(places[:, None, :], count, axis=1)
    points[..., 2] = -(places[:, 2:] + distances)
    return distances, gauss / 2 * size / (1 - share) ** 2, points
