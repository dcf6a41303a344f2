"""Arrays of the running process, with names that replace data files in scenes.

A component with a data file reads held arrays as those of an archive (`core.gridded`), so that a library call can pass
arrays and nothing is written to disk. The name is a hash of the content: a scene with other arrays is another scene.
Arrays are held as long as somebody keeps the result of `hold`.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from typing import Any
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["PREFIX", "HeldArrays", "arrays_of", "hold"]

#: What the name of held arrays begins with.
PREFIX = "memory:"


class HeldArrays(Mapping[str, "NDArray[Any]"]):
    """Read-only copies of arrays by name.

    Attributes
    ----------
    name : str
        Stands for them where a file may stand.
    """

    def __init__(self, arrays: Mapping[str, ArrayLike]) -> None:
        self._arrays = {name: np.array(values, order="C") for name, values in arrays.items()}
        digest = hashlib.sha256()
        for name, values in sorted(self._arrays.items()):
            values.flags.writeable = False
            digest.update(f"{name} {values.dtype.str} {values.shape} ".encode())
            digest.update(values.data)
        self.name = f"{PREFIX}{digest.hexdigest()[:24]}"

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, HeldArrays) and self.name == other.name

    def __hash__(self) -> int:
        return hash(self.name)


_STORED_ARRAYS: WeakValueDictionary[str, HeldArrays] = WeakValueDictionary()


def hold(**arrays: ArrayLike) -> HeldArrays:
    """Store copies of arrays while the returned object exists; equal arrays are stored once.

    Examples
    --------
    >>> gap = hold(gap=np.zeros((2, 2)))
    >>> arrays_of(gap.name) is gap
    True
    """
    new = HeldArrays(arrays)
    return _STORED_ARRAYS.setdefault(new.name, new)


def arrays_of(name: str) -> HeldArrays | None:
    """Arrays stored under a name, or None."""
    return _STORED_ARRAYS.get(name)
