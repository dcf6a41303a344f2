"""Orientation of a shape: matrix or angles, and derivatives along turned axes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.quantities import Angle
from eigencontact.errors import require

__all__ = ["Rotation", "Row", "as_tuple", "rotation_matrix", "turned_derivatives"]

Row = tuple[float, float, float]
_Order = tuple[int, int, int]

#: Annotation of a field that turns a thing: three angles yaw, pitch, roll [rad], or a rotation matrix whose columns are
#: the directions of the thing's own axes in the scene.
Rotation = tuple[Angle, Angle, Angle] | tuple[Row, Row, Row]

_RULE = (
    "a rotation matrix (3 x 3, columns = directions of the own axes, orthogonal to 1e-9, determinant +1) or three"
    " finite angles yaw, pitch, roll [rad]"
)


def as_tuple(value: Any) -> Any:
    """Nested tuples of floats from arrays and lists, so that a component is hashable; other values unchanged.

    Examples
    --------
    >>> as_tuple([[1.0, 2.0], [3.0, 4.0]])
    ((1.0, 2.0), (3.0, 4.0))
    """
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return tuple(as_tuple(item) for item in value) if isinstance(value, list | tuple) else value


def rotation_matrix(where: str, rotation: Any) -> FloatArray:
    """Matrix whose columns are the rotated axes, from a matrix, three angles or None.

    Angles yaw, pitch, roll [rad] turn by ``Rz(yaw) Ry(pitch) Rx(roll)``: about z, then the turned y, then the twice
    turned x; positive from x to y, z to x, y to z.

    Raises
    ------
    SceneError
        Something else; `where` is the key of the component in the message.

    Examples
    --------
    A quarter turn about z brings the first axis to y:

    >>> rotation_matrix("ellipsoid", (np.pi / 2, 0.0, 0.0)).round(12)[:, 0] + 0.0
    array([0., 1., 0.])
    """
    if rotation is None:
        return np.eye(3)
    try:
        numbers = np.array(rotation, dtype=float)
    except (TypeError, ValueError):
        numbers = np.full(1, np.nan)
    require(numbers.shape in ((3,), (3, 3)) and bool(np.isfinite(numbers).all()), where, "rotation", rotation, _RULE)
    if numbers.shape == (3,):
        (cz, cy, cx), (sz, sy, sx) = np.cos(numbers), np.sin(numbers)
        about_z = np.array([[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]])
        about_y = np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
        about_x = np.array([[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]])
        return np.asarray(about_z @ about_y @ about_x)
    error = float(np.abs(numbers.T @ numbers - np.eye(3)).max())
    require(error <= 1e-9 and np.linalg.det(numbers) > 0, where, "rotation", rotation, _RULE)
    return np.asarray(numbers @ (1.5 * np.eye(3) - 0.5 * numbers.T @ numbers))  # the nearest rotation, to round-off


@lru_cache(maxsize=64)
def _turn(rotation: tuple[float, ...], orders: tuple[_Order, ...]) -> tuple[tuple[_Order, ...], FloatArray]:
    R = np.array(rotation).reshape(3, 3)
    degrees = sorted({sum(order) for order in orders})
    turned_orders = tuple(
        (i, j, degree - i - j) for degree in degrees for i in range(degree + 1) for j in range(degree - i + 1)
    )  # fmt: skip
    places = {order: place for place, order in enumerate(turned_orders)}
    matrix = np.zeros((len(orders), len(turned_orders)))
    for row, order in enumerate(orders):
        # the product of (R_i1 d_1 + R_i2 d_2 + R_i3 d_3)^order_i, multiplied out
        terms: dict[_Order, float] = {(0, 0, 0): 1.0}
        for axis, count in enumerate(order):
            for _ in range(count):
                raised: dict[_Order, float] = {}
                for (i, j, k), along in product(terms, range(3)):
                    key = (i + (along == 0), j + (along == 1), k + (along == 2))
                    raised[key] = raised.get(key, 0.0) + terms[i, j, k] * float(R[axis, along])
                terms = raised
        for key, value in terms.items():
            matrix[row, places[key]] = value
    return turned_orders, matrix


def turned_derivatives(rotation: FloatArray, orders: Sequence[_Order]) -> tuple[tuple[_Order, ...], FloatArray]:
    """Derivatives of a scalar along rotated axes from those along the axes of the scene.

    Parameters
    ----------
    rotation : (3, 3)
        Columns are the turned axes.
    orders : sequence of (int, int, int)
        How often along x, y and z, as the framework asks for the potentials of a shape.

    Returns
    -------
    own : tuple of (int, int, int)
        How often along the turned axes: all derivatives of these degrees.
    matrix : (len(orders), len(own))
        ``matrix @ derivatives(own)`` are those asked for.
    """
    return _turn(tuple(rotation.ravel().tolist()), tuple(orders))
