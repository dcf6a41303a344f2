"""Cache of expensive objects that successive runs of one process share, such as the variants of a sweep.

Outside of `ObjectCache.offered` nothing is kept: a run by itself gives up its memory.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Protocol, TypeVar

__all__ = ["ObjectCache", "cached_object"]


class Sized(Protocol):
    """Object with a memory size."""

    @property
    def nbytes(self) -> int:
        """Memory [bytes]."""


Item = TypeVar("Item", bound=Sized)


class ObjectCache:
    """Objects by their keys; the least recently used objects are removed first.

    Parameters
    ----------
    limit : float
        Memory that they may hold together [bytes].
    """

    def __init__(self, limit: float) -> None:
        self.limit = limit
        self._items: OrderedDict[Hashable, Sized] = OrderedDict()
        #: Times that a stored object was returned.
        self.hits = 0

    @property
    def nbytes(self) -> int:
        """Memory of all stored objects [bytes]."""
        return sum(item.nbytes for item in self._items.values())

    @contextmanager
    def offered(self) -> Iterator[None]:
        """Context in which `cached_object` uses this cache."""
        token = _OFFERED.set(self)
        try:
            yield
        finally:
            _OFFERED.reset(token)

    def get(self, key: Hashable) -> Sized | None:
        """Return the stored object of a key, or None."""
        item = self._items.get(key)
        if item is not None:
            self._items.move_to_end(key)
            self.hits += 1
        return item

    def put(self, key: Hashable, item: Sized) -> None:
        """Store an object unless its size exceeds the limit."""
        if item.nbytes > self.limit:
            return
        self._items[key] = item
        while self.nbytes > self.limit:
            self._items.popitem(last=False)


_OFFERED: ContextVar[ObjectCache | None] = ContextVar("eigencontact_kept", default=None)


def cached_object(key: Callable[[], Hashable], make: Callable[[], Item]) -> Item:
    """Object of a key from an earlier run of a sweep, or a new object.

    Parameters
    ----------
    key : callable
        Returns all that determines the object, to the last bit; called only where objects are kept.
    make : callable
        Makes it.

    Examples
    --------
    >>> import numpy as np
    >>> store = ObjectCache(limit=1e6)
    >>> with store.offered():
    ...     first = cached_object(lambda: "table", lambda: np.zeros(3))
    >>> with store.offered():
    ...     cached_object(lambda: "table", lambda: np.ones(3)) is first
    True
    >>> cached_object(lambda: "table", lambda: np.ones(3))
    array([1., 1., 1.])
    """
    store = _OFFERED.get()
    if store is None:
        return make()
    name = key()
    earlier = store.get(name)
    if earlier is not None:
        return earlier  # type: ignore[return-value]  # what a key determines is of one kind
    item = make()
    store.put(name, item)
    return item
