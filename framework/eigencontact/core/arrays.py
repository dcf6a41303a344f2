"""Checks of array arguments: real numbers of one shape."""

from __future__ import annotations

from numbers import Integral, Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.units import LARGEST, number_and_unit, parse_quantity
from eigencontact.errors import PluginError, SceneError

__all__ = ["FloatArray", "is_real", "is_whole", "real_answer", "real_array", "real_points", "whole_array"]


def is_real(value: object) -> bool:
    """Whether a value is a real number; booleans, texts, complex numbers and arrays are not.

    Examples
    --------
    >>> [is_real(value) for value in (1, 2.5, np.float32(1), True, "1", 1j, [1.0])]
    [True, True, True, False, False, False, False]
    """
    return isinstance(value, Real) and not isinstance(value, bool | np.bool_)


def is_whole(value: object) -> bool:
    """Whether a value is a whole number; booleans are not."""
    return isinstance(value, Integral) and is_real(value)


def real_array(value: Any, where: str, field: str, rule: str, unit: str = "") -> FloatArray:
    """Convert to an array of real numbers, which may be infinite or NaN; refuse all other values.

    Parameters
    ----------
    value : array_like
        Numbers, nested as deep as they like.
    where, field, rule : str
        For the message: the call, its argument, and what it must be.
    unit : str
        SI unit into which quantities with a unit are converted; without it they are refused.

    Raises
    ------
    SceneError
        Complex numbers, booleans, texts, masked values, rows of different length, quantities of another dimension.

    Examples
    --------
    >>> real_array([[1, 2], [3, 4]], "call", "heights", "an array (ny, nx) [m]").dtype
    dtype('float64')
    """
    try:
        return _real_numbers(value, unit)
    except ValueError as problem:
        raise SceneError(f"{where}.{field} must be {rule}{problem}") from None


def real_answer(value: Any, quantity: str, shape: tuple[int, ...] | None = None) -> FloatArray:
    """Array of real numbers returned by a plugin.

    Parameters
    ----------
    value : object
        The answer.
    quantity : str
        For the message: ``"separation of geometry 'bowl'"``.
    shape : tuple of int, optional
        Shape to which the answer must broadcast.

    Raises
    ------
    PluginError
        Anything but real numbers, masked values, another shape.

    Examples
    --------
    >>> real_answer(2, "separation of geometry 'bowl'", (1, 2)).tolist()
    [[2.0, 2.0]]
    """
    rule = "an array" if shape is None else f"an array that broadcasts to shape {shape}"
    try:
        array = _real_numbers(value, "")
        return array if shape is None else np.broadcast_to(array, shape)
    except ValueError as problem:
        reason = str(problem) if str(problem)[:1] in " ," else f" (got shape {np.shape(value)})"
        raise PluginError(f"{quantity} must be {rule}{reason}") from None


def whole_array(value: Any, where: str, field: str, rule: str) -> NDArray[np.int32]:
    """Array of whole numbers, also of booleans; refuses all other values like `real_array`."""
    try:
        array = _array(value, "")
    except ValueError as problem:
        raise SceneError(f"{where}.{field} must be {rule}{problem}") from None
    if array.dtype.kind not in "biu":
        raise SceneError(f"{where}.{field} must be {rule} (got {_type_and_shape(array)})")
    return array.astype(np.int32)


def _real_numbers(value: Any, unit: str) -> FloatArray:
    """Array of real numbers, or ValueError with the end of a message."""
    array = _array(value, unit)
    if array.dtype.kind == "O" and all(is_real(item) and abs(item) <= LARGEST for item in array.ravel()):
        array = array.astype(float)  # whole numbers of Python, fractions
    if array.dtype.kind not in "fiu":
        raise ValueError(f", real numbers (got {_type_and_shape(array)})")
    return np.asarray(array, dtype=float)


def _array(value: Any, unit: str) -> NDArray[Any]:
    bare = _bare(value, unit)
    try:
        return np.asarray(bare)
    except (ValueError, TypeError, OverflowError):
        raise ValueError(f" (got {type(value).__name__} with no one shape)") from None


def _bare(value: Any, unit: str) -> Any:
    """Numbers without masks and units, which NumPy would drop silently, also in items of a list."""
    if isinstance(value, float | int):
        return value
    if isinstance(value, list | tuple):
        return [_bare(item, unit) for item in value]
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise ValueError(f", none of them masked (got {int(np.ma.getmaskarray(value).sum())} masked)")
    if (carried := number_and_unit(value)) is None:
        return value
    if not unit:
        raise ValueError(f", plain numbers (got a quantity in {carried[1] or 'no unit'})")
    _bare(carried[0], unit)  # a mask below the unit
    try:
        return parse_quantity(value, unit, "a quantity")
    except ValueError:
        raise ValueError(f", in a unit like {unit} (got a quantity in {carried[1] or 'no unit'})") from None


def real_points(where: str, *coordinates: Any) -> tuple[FloatArray, ...]:
    """Coordinates x, y or x, y, z [m] as arrays of real numbers whose shapes broadcast against each other.

    Examples
    --------
    >>> [t.shape for t in real_points("here", 1.0, [0.0, 1.0])]
    [(), (2,)]
    """
    arrays = tuple(
        real_array(values, where, axis, "coordinates [m]") for axis, values in zip("xyz", coordinates, strict=False)
    )
    try:
        np.broadcast_shapes(*(values.shape for values in arrays))
    except ValueError:
        shapes = ", ".join(str(values.shape) for values in arrays)
        raise SceneError(f"{where}: coordinates must be of shapes that broadcast (got {shapes})") from None
    return arrays


def _type_and_shape(array: NDArray[Any]) -> str:
    names = {"b": "booleans", "c": "complex numbers", "U": "text", "S": "bytes", "O": "objects"}
    return f"{names.get(array.dtype.kind, str(array.dtype))} of shape {array.shape}"
