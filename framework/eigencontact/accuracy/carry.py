"""Interpolation of fields from the points of one discretisation to the points of another."""

from __future__ import annotations

from functools import lru_cache, reduce
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

__all__ = ["Axes", "alike", "axes_of", "carried", "without_gaps"]

#: Places along each dimension of the points of a field [m].
Axes = tuple["FloatArray", ...]
#: Points closer than this part of the extent are one.
_SAME = 1e-9


def axes_of(results: Any, name: str) -> Axes:
    """Places of a field along the dimensions of its points.

    Along a line they are distances from its first point. Scattered points have a single dimension too.

    Raises
    ------
    LookupError
        There is no such field, or no places of its points are stored.
    """
    variable = results.variables[name]
    axes = []
    for dim in variable.dims[1:]:
        if dim in results.variables:
            places = results.variables[dim].values
            if places.dtype.kind == "f":
                axes.append(np.asarray(places, dtype=float))
            continue
        region = dim.removesuffix("_point")
        names = [f"{region}_{axis}" for axis in "xyz"]
        points = np.stack(np.broadcast_arrays(*(np.asarray(results.variables[place].values) for place in names)))
        moved = np.linalg.norm(np.diff(points), axis=0)
        axes.append(np.concatenate([[0.0], np.cumsum(moved)]))
    return tuple(axes)


def carried(values: NDArray[Any], start: Axes, target: Axes, *, smooth: bool) -> NDArray[Any]:
    """Interpolate a field from the coordinates `start` to the coordinates `target`; its last dimensions are these axes.

    Beyond the first and last place it is constant. `smooth` takes a polynomial through four places, which a field needs
    whose own small error is compared; without it the field is linear between places, and exceeds none of its values.

    Examples
    --------
    >>> x = np.linspace(0.0, 1.0, 6)
    >>> fine, coarse = (x,), (np.array([0.1, 0.5]),)
    >>> np.abs(carried(x**3, fine, coarse, smooth=True) - coarse[0] ** 3).max() < 1e-14
    np.True_
    """
    values = without_gaps(values)
    for axis, (places, others) in enumerate(zip(start, target, strict=True), values.ndim - len(start)):
        if alike(places, others):
            continue
        first, weights = _weights(places.tobytes(), others.tobytes(), 4 if smooth else 2)
        along = [-1 if n == axis else 1 for n in range(values.ndim)]
        near = (np.take(values, first + n, axis=axis) * weight.reshape(along) for n, weight in enumerate(weights))
        values = reduce(np.add, near)
    return values


def without_gaps(values: NDArray[Any]) -> NDArray[Any]:
    """Values with NaN replaced by zero; a copy only if there is a NaN."""
    return values if np.isfinite(values).all() else np.nan_to_num(values)


def alike(places: FloatArray, others: FloatArray) -> bool:
    """Whether the coordinates of two sets of points are equal."""
    return places.size == others.size and bool(np.abs(places - others).max(initial=0.0) <= _SAME * np.ptp(places))


@lru_cache(maxsize=64)  # all fields and steps of a run have the same places
def _weights(start: bytes, target: bytes, count: int) -> tuple[NDArray[np.intp], FloatArray]:
    """First of the `count` places around each of the others, and weights (count, others) of Lagrange's polynomials."""
    places, others = np.frombuffer(start), np.frombuffer(target)
    count = min(count, places.size)
    at = np.clip(others, places[0], places[-1])
    first = np.clip(np.searchsorted(places, at) - count // 2, 0, places.size - count)
    near = [places[first + n] for n in range(count)]
    weights = np.ones((count, others.size))
    for n in range(count):
        for m in range(count):
            if m != n:
                weights[n] *= (at - near[m]) / (near[n] - near[m])
    return first, weights
