"""Wall time by task."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

__all__ = ["Stopwatch"]


class Stopwatch:
    """Adds up wall time by name.

    Attributes
    ----------
    seconds : dict of str to float
        Wall time [s] by name, in the order in which the names first came up.

    Examples
    --------
    >>> watch = Stopwatch()
    >>> for _ in range(2):
    ...     with watch.on("storing"):
    ...         pass
    >>> list(watch.seconds)
    ['storing']
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def on(self, name: str) -> Iterator[None]:
        """Count the time of the block under a name, whether the block ends well or not."""
        began = perf_counter()
        try:
            yield
        finally:
            self.add(name, perf_counter() - began)

    def add(self, name: str, seconds: float) -> None:
        """Add a time [s] measured elsewhere."""
        self.seconds[name] = self.seconds.get(name, 0.0) + seconds
