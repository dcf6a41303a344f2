"""Closeness to an expected value with no absolute part of its own."""

import numpy as np
import pytest

__all__ = ["close"]


class _CloseArray(type(pytest.approx(np.zeros(2)))):  # noqa: TID251
    """`pytest.approx` of an array; it compares all elements at once and looks at each only where this fails."""

    def __eq__(self, actual):
        values, expected = np.asarray(actual), self.expected
        if values.shape == expected.shape and values.dtype.kind == expected.dtype.kind == "f":
            values, expected = values.astype(float), expected.astype(float)
            if np.isfinite(values).all() and np.isfinite(expected).all():
                bound = np.maximum((self.rel or 0.0) * np.abs(expected), self.abs)
                if np.all(np.abs(values - expected) <= bound):
                    return True
        return super().__eq__(actual)

    __hash__ = None


def close(expected, rel=None, abs=None):  # noqa: A002
    """What compares equal to `expected` within `rel` of it, or within `abs`, or either where both are given.

    ``pytest.approx`` also accepts whatever is within 1e-12, which is most of a test of displacements in metres. Here a
    value of 0 is expected exactly, unless `abs` says how small is small enough. Without both, `rel` is 1e-6.
    """
    if rel is None and abs is None:
        rel = 1e-6
    abs = 0.0 if abs is None else abs  # noqa: A001
    result = pytest.approx(expected, rel=rel, abs=abs)  # noqa: TID251
    if isinstance(expected, np.ndarray) and expected.size > 1:
        result.__class__ = _CloseArray
    return result
