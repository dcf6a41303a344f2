"""How a check says no: its name, what was expected, what was found and where, and what to do."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from functools import wraps
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from eigencontact.errors import PluginError

__all__ = ["Check", "ConformanceError", "agree", "check", "ensure", "ensure_array", "ensure_pure", "fail", "place_of"]

FloatArray = NDArray[np.float64]
Check = Callable[[Any], None]


class ConformanceError(AssertionError):
    """A component that breaks a promise of its kind."""


def check(function: Check) -> Check:
    """Turn a function of one component into a check.

    Its name goes in front of every message; what the component itself raises, warnings of numpy included, becomes a
    `ConformanceError` too.
    """

    @wraps(function)
    def run(component: Any) -> None:
        where = f"{function.__name__} of {component.kind} {component.key!r}"
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", RuntimeWarning)
                function(component)
        except ConformanceError as problem:
            raise ConformanceError(f"{where}: {problem}") from None
        except PluginError as problem:  # it names the method and the fault already
            raise ConformanceError(f"{where}: {problem}; the traceback above shows the line") from problem
        except Exception as problem:
            raise ConformanceError(
                f"{where}: it must answer without an error or warning (got {type(problem).__name__}: {problem}); "
                f"the traceback above shows the line"
            ) from problem

    return run


def ensure(condition: object, subject: str, rule: str, got: object, advice: str) -> None:
    """Raise `ConformanceError` worded ``<subject> must be <rule> (got <value>); <advice>`` unless `condition`."""
    if not condition:
        fail(subject, rule, got, advice)


def ensure_array(
    values: NDArray[Any],
    shape: tuple[int, ...],
    subject: str,
    advice: str,
    *,
    rule: str = "float64 of shape {shape}",
    dtype: type = np.float64,
) -> None:
    """Raise `ConformanceError` unless values have a shape and a type."""
    good = values.shape == shape and values.dtype == dtype
    ensure(good, subject, rule.format(shape=shape), f"{values.dtype} of shape {values.shape}", advice)


def fail(subject: str, rule: str, got: object, advice: str) -> NoReturn:
    """Raise `ConformanceError` in the words of `ensure`."""
    raise ConformanceError(f"{subject} must be {rule} (got {got}); {advice}")


def ensure_pure(
    subject: str,
    ask: Callable[[], Any],
    arrays: Sequence[NDArray[Any]],
    *,
    arguments: str = "the arrays given",
    between: Callable[[], object] = lambda: None,
    advice: str = "keep no state",
) -> None:
    """Same answer twice, with another question in between; `arrays` stay as they were, and are then read-only."""
    copies = [array.copy() for array in arrays]
    first = np.array(ask())
    ensure(all(map(np.array_equal, arrays, copies)), arguments, "unchanged", "changed", "write to copies only")
    between()
    for array in arrays:
        array.flags.writeable = False
    again = np.asarray(ask())
    ensure(np.array_equal(first, again, equal_nan=True), f"{subject} asked twice", "the same", "different", advice)


def place_of(points: FloatArray) -> str:
    """Words for the first of some points ``(n, 3)``."""
    return ", ".join(f"({x:.6g}, {y:.6g}, {z:.6g})" for x, y, z in points[:1]) or "nowhere"


def agree(
    names: Sequence[str],
    got: FloatArray,
    expected: FloatArray,
    *,
    scale: FloatArray | float,
    tolerance: FloatArray | float,
    points: FloatArray,
    rule: str,
    advice: str,
) -> None:
    """Compare rows `got` and `expected`, ``(len(names), n)``, at `points` ``(n, 3)``; the worst is reported.

    `tolerance` is relative to `scale`; both broadcast to the rows. NaN never agrees.
    """
    error = np.abs(got - expected) / np.broadcast_to(scale, got.shape)
    excess = error / np.broadcast_to(tolerance, got.shape)
    excess = np.where(np.isnan(excess), np.inf, excess)
    row, column = divmod(int(np.argmax(excess)), got.shape[1])
    limit = np.broadcast_to(tolerance, got.shape)[row, column]
    ensure(
        excess[row, column] <= 1.0,
        f"{names[row]} at {place_of(points[column:])}",
        f"{rule}, {expected[row, column]:.10g}",
        f"{got[row, column]:.10g}, relative error {error[row, column]:.1e}, allowed {limit:.1e}",
        advice,
    )
