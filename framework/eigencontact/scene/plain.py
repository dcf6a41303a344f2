"""Values from Python in the form of tables of a file: numbers, texts, arrays, tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import is_dataclass
from datetime import date, time
from numbers import Number, Real
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from eigencontact.core.units import number_and_unit, quantity_text
from eigencontact.errors import SceneError, shown

__all__ = ["plain"]

#: Values that stay as they are; the field refuses those that it cannot hold.
_PLAIN_TYPES = (str, bytes, bool, int, float, date, time, type(None), type)


def plain(value: Any, where: str = "") -> Any:
    """Value in the form of a table of a file.

    Arrays of NumPy become arrays of numbers, and quantities with a unit become text: ``"105.0 um"``. The field that
    holds the text then checks the dimension. Components stay.

    Parameters
    ----------
    value : object
        Tables, arrays and single values, nested.
    where : str
        Dotted key of the value, for messages.

    Raises
    ------
    SceneError
        Keys that are not text, masked values, objects that no table can hold.

    Examples
    --------
    >>> plain({"radius": np.float64(2.0), "center": np.zeros(2), "files": (Path("a.npz"),)})
    {'radius': 2.0, 'center': [0.0, 0.0], 'files': ('a.npz',)}
    """
    if isinstance(value, _PLAIN_TYPES) and not isinstance(value, np.generic):
        return value
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str):
                raise SceneError(f"{where or 'scene'} must have keys that are text (got {shown(key)})")
        return {key: plain(item, f"{where}.{key}".strip(".")) for key, item in value.items()}
    if isinstance(value, list | tuple):
        items = [plain(item, f"{where}.{number}".strip(".")) for number, item in enumerate(value)]
        return items if isinstance(value, list) else tuple(items)
    if isinstance(value, Path):
        return str(value)
    if (carried := number_and_unit(value)) is not None:
        return _texts(plain(np.asanyarray(carried[0]), where), carried[1])
    if np.ma.is_masked(value):
        count = int(np.ma.getmaskarray(value).sum())
        raise SceneError(f"{where or 'value'} must be given without masked values (got {count} masked)")
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Real):
        return float(value)
    if isinstance(value, Number | BaseModel) or is_dataclass(value):
        return value
    if hasattr(value, "__array__"):
        return plain(np.asarray(value), where)
    raise SceneError(f"{where or 'value'} must be a number, a text, an array or a table (got {shown(value)})")


def _texts(numbers: Any, unit: str) -> Any:
    """Quantities as text, in arrays as deep as the numbers."""
    return [_texts(item, unit) for item in numbers] if isinstance(numbers, list) else quantity_text(numbers, unit)
