"""Closeness to an expected value with no absolute part of its own."""

import pytest

__all__ = ["close"]


def close(expected, rel=None, abs=None):  # noqa: A002
    """What compares equal to `expected` within `rel` of it, or within `abs`, or either where both are given.

    ``pytest.approx`` also accepts whatever is within 1e-12, which is most of a test of displacements in metres. Here a
    value of 0 is expected exactly, unless `abs` says how small is small enough. Without both, `rel` is 1e-6.
    """
    if rel is None and abs is None:
        rel = 1e-6
    return pytest.approx(expected, rel=rel, abs=0.0 if abs is None else abs)  # noqa: TID251
