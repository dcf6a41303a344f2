"""Where a shape is asked: points inside, outside and on its boundary, found with `bounds` and `contains` alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.places import place_field
from eigencontact.halfspace.potentials import derivatives
from eigencontact_verification.conformance.orders import Order, of_total
from eigencontact_verification.conformance.report import ensure
from eigencontact_verification.crosscheck import strangers
from eigencontact_verification.crosscheck.lines import DIRECTIONS

__all__ = [
    "Points",
    "Region",
    "derivative_along",
    "evenly",
    "inside",
    "natural_scale",
    "on_boundary",
    "potential",
    "principal_axes",
    "region",
    "remembered",
    "row_scales",
    "sample",
    "within",
]

FloatArray = NDArray[np.float64]
T = TypeVar("T")


def remembered(function: Callable[[Any], T]) -> Callable[[Any], T]:
    """Keep the answers for the last components asked about (by identity: fields need not be hashable)."""
    answers: list[tuple[Any, T]] = []

    @wraps(function)
    def ask(component: Any) -> T:
        for arguments_before, answer in answers:
            if arguments_before is component:
                return answer
        answers.append((component, function(component)))
        del answers[:-16]
        return answers[-1][1]

    return ask


@dataclass(frozen=True, slots=True)
class Region:
    """The bounds of a shape as arrays ``(3,)``: corners, centre, half edges; `size`, the longest edge [m]."""

    low: FloatArray
    high: FloatArray
    center: FloatArray
    half: FloatArray
    size: float

    @property
    def step(self) -> float:
        """A step that is small for the shape and far above rounding [m]."""
        return 1e-7 * float(np.min(self.half))

    @property
    def radius(self) -> float:
        """Radius of the ball around the bounds [m]."""
        return float(np.linalg.norm(self.half))


@dataclass(frozen=True, slots=True)
class Points:
    """Points ``(n, 3)``, and how far each is from the boundary at least, roughly ``(n,)`` [m]."""

    places: FloatArray
    clearance: FloatArray


def region(shape: Any) -> Region:
    """Read the bounds of a shape, and its centre."""
    low, high = np.asarray(shape.bounds, dtype=float)
    center, size = (low + high) / 2, float(np.max(high - low))
    place = place_field(type(shape))
    place_of_shape = np.asarray(getattr(shape, place) if place else (), dtype=object)
    if place_of_shape.shape == (3,) and np.all(np.abs(place_of_shape - center) < 1e-9 * size):
        center = place_of_shape.astype(float)  # to the last bit, where 0/0 lurks
    return Region(low, high, center, (high - low) / 2, size)


def inside(shape: Any, places: FloatArray) -> NDArray[np.bool_]:
    """``contains`` at points ``(..., 3)``."""
    x, y, z = np.moveaxis(np.asarray(places), -1, 0)
    return np.asarray(shape.contains(x, y, z))


def potential(shape: Any, which: str, orders: Sequence[Order], places: FloatArray) -> FloatArray:
    """Derivatives of ``"phi"``, ``"psi"`` or ``"chi"`` at points ``(..., 3)``."""
    x, y, z = (np.array(coordinate) for coordinate in np.moveaxis(np.asarray(places), -1, 0))
    return np.asarray(shape.chi(orders, x, y, z) if which == "chi" else derivatives(shape, which, orders, x, y, z))


def row_scales(size: float, orders: Sequence[Order], values: FloatArray) -> FloatArray:
    """Size of each row of `values` ``(len(orders), n)``, never zero.

    The largest derivative of the same total order at the point, or of a lower one over powers of the length `size`.
    `orders` begin with the lowest that the framework asks for: those do not vanish together.
    """
    totals = np.array([sum(order) for order in orders])
    scales: dict[int, FloatArray] = {}
    for total in range(int(totals.min()), int(totals.max()) + 1):
        largest = np.max(np.abs(values[totals == total]), axis=0)
        scales[total] = np.maximum(largest, scales[total - 1] / size) if scales else largest
    return np.array([scales[total] for total in totals])


def natural_scale(shape: Any, which: str, total: int, places: FloatArray) -> FloatArray:
    """Size of derivatives of this total order at points ``(n, 3)``; see `row_scales`."""
    orders = [order for degree in range(1 if which == "phi" else 3, total + 1) for order in of_total(degree)]
    return np.asarray(row_scales(region(shape).size, orders, potential(shape, which, orders, places))[-1])


def evenly(count: int) -> FloatArray:
    """Evenly spread points of the cube (-1, 1)³, ``(count, 3)``, always the same ones."""
    return 2.0 * strangers.evenly(count) - 1.0


@remembered
def within(shape: Any) -> FloatArray:
    """Up to a thousand points inside, ``(m, 3)``."""
    box = region(shape)
    places = box.center + box.half * evenly(1 << 14)
    return places[inside(shape, places)][:1000]


@remembered
def principal_axes(shape: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Middle of the region ``(3,)``, principal axes as columns, root mean squares along them ``(3,)`` [m]."""
    points = within(shape)
    middle = points.mean(axis=0)
    squares, axes = np.linalg.eigh(np.cov((points - middle).T))
    return middle, axes, np.sqrt(squares)


@remembered
def sample(shape: Any) -> tuple[Points, Points]:
    """A few points well inside, and a few around the shape and above the surface, away from the boundary."""
    box = region(shape)
    near = box.center + box.half * evenly(4096)
    interior = near[inside(shape, near)][:256]
    ensure(
        len(interior),
        "contains",
        "true somewhere between the corners of bounds",
        "false at 4096 points spread there",
        "compare the two: both are in scene coordinates, z into the body",
    )
    around = box.center + (box.half + box.size / 2) * evenly(256)
    above = np.concatenate([around[:, :2], -np.abs(around[:, 2:])], axis=1)  # where the image of the body is asked
    without = [_clearest(shape, points[~inside(shape, points)], box.size) for points in (around, above)]
    return _clearest(shape, interior, box.size), Points(
        np.concatenate([points.places for points in without]), np.concatenate([points.clearance for points in without])
    )


def _clearest(shape: Any, places: FloatArray, size: float) -> Points:
    """Six of the points that are not close to the boundary."""
    state = inside(shape, places)
    clearance = np.zeros(len(places))
    free = np.ones(len(places), bool)
    for radius in size * 2.0 ** -np.arange(18, 0, -1.0):
        probes = places[:, None, :] + radius * DIRECTIONS
        free &= np.all(inside(shape, probes) == state[:, None], axis=1)
        clearance[free] = radius
    chosen = np.flatnonzero(clearance >= np.max(clearance) / 4)[:6]
    return Points(places[chosen], clearance[chosen])


def derivative_along(
    axis: Order, places: FloatArray, reach: FloatArray, function: Callable[[FloatArray], FloatArray]
) -> FloatArray:
    """Derivative of `function` at `places` ``(n, 3)`` through 17 Chebyshev points, `reach` ``(n,)`` to both sides.

    Exact to some 1e-13 where the function is smooth within four times the reach. `function` takes points
    ``(n, 17, 3)`` and returns ``(..., n, 17)``.
    """
    nodes, signs = np.cos(np.pi * np.arange(17) / 16), (-1.0) ** np.arange(17)
    signs[[0, -1]] /= 2
    weights = np.zeros(17)
    off_centre = np.arange(17) != 8
    weights[off_centre] = -signs[off_centre] / nodes[off_centre]
    line = places[:, None, :] + reach[:, None, None] * nodes[:, None] * np.array(axis)
    return np.asarray(function(line) @ weights / reach)


@remembered
def on_boundary(shape: Any) -> tuple[FloatArray, FloatArray]:
    """Points on the boundary ``(n, 3)``, found by bisection, and unit directions ``(n, 3)`` that leave the shape."""
    within, without = sample(shape)
    start = np.repeat(within.places, 4, axis=0)
    stop = np.tile(without.places, (len(start) // len(without.places) + 1, 1))[: len(start)]
    direction = stop - start
    low, high = np.zeros(len(start)), np.ones(len(start))
    for _ in range(52):
        middle = (low + high) / 2
        contained = inside(shape, start + middle[:, None] * direction)
        low, high = np.where(contained, middle, low), np.where(contained, high, middle)
    crossing = start + ((low + high) / 2)[:, None] * direction
    return crossing, direction / np.linalg.norm(direction, axis=1, keepdims=True)
