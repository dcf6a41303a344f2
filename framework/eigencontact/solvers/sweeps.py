"""Loops over a field in blocks of rows that fit into the cache, distributed to threads."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.parallel import in_parallel

__all__ = ["Sweeps"]

T = TypeVar("T")

# Cells per block: about six fields of it stay in a second-level cache.
_CELLS = 32_768
# Cells per block with several threads: they wait for the interpreter between any two operations.
_CELLS_IN_THREADS = 131_072
# Cells of a field from which on threads save time.
_WORTH_THREADS = 1_000_000


class Sweeps:
    """Blocks of rows of fields of one shape.

    The blocks do not depend on the number of threads, and their results keep the order of the blocks, so that sums do
    not depend on the number of threads either.
    """

    def __init__(self, shape: tuple[int, ...], threads: int, dtype: Any) -> None:
        large = shape[0] * shape[1] >= _WORTH_THREADS
        step = min(max(1, (_CELLS_IN_THREADS if large else _CELLS) // shape[1]), shape[0])
        self.blocks = [slice(first, min(first + step, shape[0])) for first in range(0, shape[0], step)]
        self._threads = min(threads, len(self.blocks)) if large else 1
        # Memory allocated inside threads needs new pages each time, which costs time.
        self._scratch = [np.empty((2, step, shape[1]), dtype) for _ in range(self._threads)]

    def scratch(self, number: int) -> NDArray[Any]:
        """Two scratch fields of the shape of a block."""
        rows = self.blocks[number]
        return self._scratch[number % self._threads][:, : rows.stop - rows.start]

    def __call__(self, work: Callable[[int, slice], T]) -> list[T]:
        """Call ``work(number, rows)`` for every block; returns the results in order."""
        if self._threads == 1:
            return [work(k, rows) for k, rows in enumerate(self.blocks)]
        results: list[Any] = [None] * len(self.blocks)

        def fill_block(first: int) -> None:
            for k in range(first, len(self.blocks), self._threads):
                results[k] = work(k, self.blocks[k])

        in_parallel(self._threads, [partial(fill_block, first) for first in range(self._threads)])
        return results
