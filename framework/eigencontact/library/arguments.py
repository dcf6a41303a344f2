"""Checks of the arguments of library functions, by their names."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.core.arrays import is_real, is_whole, real_array
from eigencontact.core.units import LARGEST, SMALLEST, parse_quantity
from eigencontact.errors import SceneError, require
from eigencontact.scene.plain import plain

__all__ = ["counts", "length", "lengths", "plane"]

FloatArray = NDArray[np.float64]


def length(value: Any, where: str, name: str, *, positive: bool = True) -> float:
    """Length [m] of a number, of text with a unit or of a quantity."""
    value = plain(value, f"{where}.{name}")
    try:
        converted = parse_quantity(value, "m", "a length")
    except ValueError as problem:
        raise SceneError(f"{where}.{name} must be {problem} (got {value!r})") from None
    require(is_real(converted), where, name, value, "a length [m]")
    number = float(converted)
    if positive:
        require(SMALLEST <= number <= LARGEST, where, name, value, "positive and finite [m]")
    require(abs(number) <= LARGEST, where, name, value, "finite [m]")
    return number


def lengths(value: Any, count: int, where: str, name: str, *, positive: bool = True) -> tuple[float, ...]:
    """Several lengths [m]; a single length applies to all."""
    value = plain(value, f"{where}.{name}")
    if not isinstance(value, list | tuple):
        return (length(value, where, name, positive=positive),) * count
    require(len(value) == count, where, name, value, f"one length or {count} [m]")
    return tuple(length(item, where, name, positive=positive) for item in value)


def counts(value: Any, where: str, name: str) -> tuple[int, int]:
    """Numbers of cells along x and y; a single number means both."""
    value = plain(value, f"{where}.{name}")
    pair: Sequence[Any] = value if isinstance(value, list | tuple) else (value, value)
    good = len(pair) == 2 and all(is_whole(count) and count >= 1 for count in pair)
    require(good, where, name, value, "one whole number of cells, or two (along x, y)")
    return int(pair[0]), int(pair[1])


def plane(value: ArrayLike, where: str, name: str, unit: str, leading: tuple[int, ...] = ()) -> FloatArray:
    """Finite numbers on the cells of a window, rows along y."""
    shape = ", ".join([*map(str, leading), "ny", "nx"])
    rule = f"an array ({shape}) [{unit}]"
    array = real_array(value, where, name, rule, unit)
    good = array.ndim == 2 + len(leading) and array.shape[: len(leading)] == leading and array.size > 0
    require(good, where, name, array.shape, rule)
    finite = np.abs(array) <= LARGEST
    if not finite.all():
        require(False, where, name, float(array[~finite][0]), f"finite everywhere [{unit}]")
    return array
