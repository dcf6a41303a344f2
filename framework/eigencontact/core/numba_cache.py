"""Compiled loops with a cache on disk where possible.

Numba keeps them beside the module, else in a folder of the user, else in that of the environment variable
``NUMBA_CACHE_DIR``; where it may write to none of them it refuses to compile at all. Then they are compiled anew by
each process, which takes seconds but works.

This module imports numba; nothing imports it before a loop is compiled.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba

__all__ = ["compiled"]


def compiled(**options: Any) -> Callable[[Any], Any]:
    """Return the decorator `numba.njit` with these options, and with a cache on disk where one can be written."""

    def decorate(function: Any) -> Any:
        try:
            return numba.njit(cache=True, **options)(function)
        except RuntimeError:  # "cannot cache function ...: no locator available for file ..."
            return numba.njit(**options)(function)

    return decorate
