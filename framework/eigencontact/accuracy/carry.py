"""Interpolation of fields from the points of one discretisation to the points of another."""

from __future__ import annotations

from functools import lru_cache, reduce
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

__all__ = ["Axes", "axes_of", "equal_places", "interpolated", "without_gaps"]

#: Places along each dimension of the points of a field [m].
Axes = tuple["FloatArray", ...]
#: Distance of two points, as a part of the extent of all, up to which their places are equal.
_COINCIDENT = 1e-9


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
        distances = np.linalg.norm(np.diff(points), axis=0)
        axes.append(np.concatenate([[0.0], np.cumsum(distances)]))
    return tuple(axes)


def interpolated(values: NDArray[Any], start: Axes, target: Axes, *, smooth: bool) -> NDArray[Any]:
    """Interpolate a field from the coordinates `start` to the coordinates `target`; its last dimensions are these axes.

    Beyond the first and last place it is constant. With `smooth` it is a polynomial through four places, for
    comparisons of fields with small differences. Without it the field is linear between places, and exceeds none of
    its values.

    Examples
    --------
    >>> x = np.linspace(0.0, 1.0, 6)
    >>> fine, coarse = (x,), (np.array([0.1, 0.5]),)
    >>> np.abs(interpolated(x**3, fine, coarse, smooth=True) - coarse[0] ** 3).max() < 1e-14
    np.True_
    """
    values = without_gaps(values)
    for axis, (places, new_places) in enumerate(zip(start, target, strict=True), values.ndim - len(start)):
        if equal_places(places, new_places):
            continue
        first, weights = _weights(places.tobytes(), new_places.tobytes(), 4 if smooth else 2)
        shape = [-1 if n == axis else 1 for n in range(values.ndim)]
        terms = (np.take(values, first + n, axis=axis) * weight.reshape(shape) for n, weight in enumerate(weights))
        values = reduce(np.add, terms)
    return values


def without_gaps(values: NDArray[Any]) -> NDArray[Any]:
    """Values with NaN replaced by zero; a copy only if there is a NaN."""
    return values if np.isfinite(values).all() else np.nan_to_num(values)


def equal_places(places: FloatArray, targets: FloatArray) -> bool:
    """Whether the coordinates of two sets of points are equal."""
    return places.size == targets.size and bool(
        np.abs(places - targets).max(initial=0.0) <= _COINCIDENT * np.ptp(places)
    )


@lru_cache(maxsize=64)  # all fields and steps of a run have the same places
def _weights(start: bytes, target: bytes, count: int) -> tuple[NDArray[np.intp], FloatArray]:
    """First of the `count` places around each target, and weights (count, targets) of Lagrange's polynomials."""
    places, targets = np.frombuffer(start), np.frombuffer(target)
    count = min(count, places.size)
    inner = np.clip(targets, places[0], places[-1])
    first = np.clip(np.searchsorted(places, inner) - count // 2, 0, places.size - count)
    nodes = [places[first + n] for n in range(count)]
    weights = np.ones((count, targets.size))
    for n in range(count):
        for m in range(count):
            if m != n:
                weights[n] *= (inner - nodes[m]) / (nodes[n] - nodes[m])
    return first, weights
