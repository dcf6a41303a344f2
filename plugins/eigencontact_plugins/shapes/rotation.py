"""Orientation of a shape: matrix or angles, and derivatives along turned axes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import Order, require

__all__ = ["Matrix", "Row", "as_tuple", "rotation_matrix", "turned_derivatives"]

FloatArray = NDArray[np.float64]
Row = tuple[float, float, float]
Matrix = tuple[Row, Row, Row]

RULE = (
    "a rotation matrix (3 x 3, columns = directions of the semi-axes, orthogonal to 1e-9, determinant +1) or three"
    " finite angles yaw, pitch, roll [rad]"
)


def as_tuple(value: Any) -> Any:
    """Nested tuples of floats from arrays and lists, so that a component stays hashable; anything else as it is."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return tuple(as_tuple(part) for part in value) if isinstance(value, list | tuple) else value


def rotation_matrix(where: str, rotation: Any) -> FloatArray:
    """Matrix whose columns are the turned axes, from a matrix, three angles or None.

    Examples
    --------
    A quarter turn about z brings the first axis to y:

    >>> rotation_matrix("ellipsoid", (np.pi / 2, 0.0, 0.0)).round(12)[:, 0] + 0.0
    array([0., 1., 0.])
    """
    if rotation is None:
        return np.eye(3)
    try:
        given = np.array(rotation, dtype=float)
    except (TypeError, ValueError):
        given = np.full(1, np.nan)
    require(given.shape in ((3,), (3, 3)) and bool(np.isfinite(given).all()), where, "rotation", rotation, RULE)
    if given.shape == (3,):
        (cz, cy, cx), (sz, sy, sx) = np.cos(given), np.sin(given)
        about_z = np.array([[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]])
        about_y = np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
        about_x = np.array([[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]])
        return np.asarray(about_z @ about_y @ about_x)
    error = float(np.abs(given.T @ given - np.eye(3)).max())
    require(error <= 1e-9 and np.linalg.det(given) > 0, where, "rotation", rotation, RULE)
    return np.asarray(given @ (1.5 * np.eye(3) - 0.5 * given.T @ given))  # the nearest rotation, to round-off


@lru_cache(maxsize=64)
def _turn(rotation: tuple[float, ...], orders: tuple[Order, ...]) -> tuple[tuple[Order, ...], FloatArray]:
    R = np.array(rotation).reshape(3, 3)
    degrees = sorted({sum(order) for order in orders})
    own = tuple(
        (i, j, degree - i - j) for degree in degrees for i in range(degree + 1) for j in range(degree - i + 1)
    )  # fmt: skip
    places = {order: place for place, order in enumerate(own)}
    matrix = np.zeros((len(orders), len(own)))
    for row, order in enumerate(orders):
        # the product of (R_i1 d_1 + R_i2 d_2 + R_i3 d_3)^order_i, multiplied out
        terms: dict[Order, float] = {(0, 0, 0): 1.0}
        for axis, count in enumerate(order):
            for _ in range(count):
                raised: dict[Order, float] = {}
                for (i, j, k), along in product(terms, range(3)):
                    key = (i + (along == 0), j + (along == 1), k + (along == 2))
                    raised[key] = raised.get(key, 0.0) + terms[i, j, k] * float(R[axis, along])
                terms = raised
        for key, value in terms.items():
            matrix[row, places[key]] = value
    return own, matrix


def turned_derivatives(rotation: FloatArray, orders: Sequence[Order]) -> tuple[tuple[Order, ...], FloatArray]:
    """Derivatives along the shape's own axes that are needed, and the matrix that makes those wanted of them."""
    return _turn(tuple(rotation.ravel().tolist()), tuple(orders))
