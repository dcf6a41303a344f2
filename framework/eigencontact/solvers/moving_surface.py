"""Worn depth of a surface over many cycles, with its pressure: implicit sub-steps, doubled and extrapolated.

A sub-step of n cycles with the final pressure p wears ``n rate p``. For the unknown p this is a layer of springs n rate
on the surface, so that each sub-step is one solve of the contact (backward Euler). It is stable for any n, and the
pressure stays nonnegative. The interval is repeated with 1, 2, 4, 8, … sub-steps until two results agree; a single
sub-step is enough if the pressure hardly changes.

References
----------
E. Hairer, G. Wanner 1996, Solving Ordinary Differential Equations II, sections IV.3 and IV.9 (extrapolated Euler).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.errors import NotConverged, require

__all__ = ["Moved", "Pressed", "moved"]

#: Contact pressure [Pa] from the worn depth [m], springs on the surface [m/Pa] and a similar pressure.
Pressed = Callable[[FloatArray, FloatArray, FloatArray], FloatArray]

# Depth added and pressure.
_State = tuple[FloatArray, FloatArray]

# Largest number of sub-steps.
_FINEST = 512
# Sub-steps end at ``1 - (1 - s)^q``, s uniform in 0..1. The final surface depends little on earlier sub-steps, but on
# the last one. If the worn depth grows by decades, q = 1.5 takes half the solves of q = 1; otherwise as many.
_GRADING = 1.5
# Ratio of the allowed errors of pressure and depth. Smaller ones cost many solves over decades of depth; larger ones
# leave the edge of the contact on a surface that has not converged.
_OF_PRESSURE = 5.0


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Moved:
    """Change of a surface over many cycles.

    Attributes
    ----------
    depth : (ny, nx) float64
        Added worn depth [m], nonnegative.
    pressure : (ny, nx) float64
        Pressure at the end [Pa]; if extrapolated, it is a contact pressure only within the error.
    error, pressure_error : float
        Estimated errors of depth and pressure: sums of magnitudes over all cells, relative to the sum of each [-].
    solves : int
        Number of contact solves.
    """

    depth: FloatArray
    pressure: FloatArray
    error: float
    pressure_error: float
    solves: int


def moved(
    pressed: Pressed,
    depth: FloatArray,
    pressure: FloatArray,
    rate: FloatArray,
    cycles: float,
    *,
    steady: FloatArray | None = None,
    tolerance: float,
    least: float = 0.0,
) -> Moved:
    """Integrate ``d depth / d cycles = rate p(depth) + steady`` with constant rate and steady.

    Parameters
    ----------
    pressed : callable
        ``pressed(depth, springs, start)``: contact pressure of the surface worn by `depth` under a layer of `springs`;
        see `NormalSolver.solve`.
    depth, pressure : (ny, nx) float64
        Worn depth [m] and contact pressure [Pa] at the start.
    rate : (ny, nx) float64
        Depth per pressure and cycle [m/(Pa cycle)], nonnegative.
    cycles : float
        Number of cycles; any positive number.
    steady : (ny, nx) float64, optional
        Depth per cycle independent of the pressure [m/cycle], nonnegative; zero by default.
    tolerance : float
        Bound of the estimated relative error of the added depth [-]; the error of the final pressure may be five times
        as large.
    least : float
        Smallest reference of the error: sum of a depth over all cells [m].

    Raises
    ------
    NotConverged
        The finest sub-steps do not meet the tolerance, because it is close to that of the contact solves.
    SceneError
        The rate is negative, or the tolerance is not positive.

    Notes
    -----
    T(m) from m sub-steps has an error of first order, ``2 T(2m) - T(m)`` of second order. The extrapolation of a cell
    stops at pressure zero; on a bed of springs the depth then stays below its limit. Depth does not decrease: negative
    changes are set to zero. Error estimates are differences between the last two results, too large by a factor of two
    to four. If the pressure changes many times over and the edge of the contact crosses many cells, extrapolation
    increases the error; T(2m) is the result if its estimate is smaller.

    Steps with small local errors cost far more, because a local error is counted as permanent, although wear levels it.
    A sphere worn to 100 times the volume of its first contact takes 15 solves here at 1e-2 (error of depth .1 %, of
    pressure 2 %), and 277 solves with local errors, for an estimate that is too large by a factor of 700.

    Examples
    --------
    >>> def pressed(depth, springs, start):  # a bed of springs of 2 m/Pa pressed by 1 m
    ...     return (1.0 - depth) / (2.0 + springs)
    >>> start, rate = np.zeros((1, 1)), np.full((1, 1), 0.1)
    >>> done = moved(pressed, start, start + 0.5, rate, 10.0, tolerance=1e-3)
    >>> round(float(done.depth[0, 0]), 3), round(float(1 - np.exp(-0.5)), 3)
    (0.393, 0.393)
    """
    steady = np.zeros_like(depth) if steady is None else steady
    for name, values, unit in (("rate", rate, "[m/(Pa cycle)]"), ("steady", steady, "[m/cycle]")):
        require(bool(np.all(values >= 0)), "moved", name, float(np.min(values)), f"zero or positive {unit}")
    require(tolerance > 0, "moved", "tolerance", tolerance, "positive")
    if not np.any((rate + steady) * cycles > 0):
        return Moved(depth=np.zeros_like(depth), pressure=pressure, error=0.0, pressure_error=0.0, solves=0)

    def stepped(count: int) -> _State:
        return _stepped(pressed, depth, pressure, (rate, steady), cycles * _lengths(count))

    coarse, before, solves, count = stepped(1), None, 1, 1
    # Error of a single sub-step: the trapezoidal rule would use the mean of the first and the last pressure.
    trapezoidal = coarse[0] - 0.5 * cycles * rate * (coarse[1] - pressure), 0.5 * (coarse[1] + pressure)
    state, errors = coarse, _difference(trapezoidal, coarse, least)
    while _worst(errors) > tolerance and count < _FINEST:
        count *= 2
        fine = stepped(count)
        solves += count
        errors, plain = _difference(coarse, fine, least), _extrapolated(coarse, fine, count, bounded=False)
        # For the first extrapolation only the difference from its inputs is known as an error bound.
        finer = errors if before is None else _difference(before, plain, least)
        if _worst(finer) <= _worst(errors):
            state, errors = _extrapolated(coarse, fine, count, bounded=True), finer
        else:
            state = fine
        coarse, before = fine, plain
    if _worst(errors) <= tolerance:
        return Moved(depth=state[0], pressure=state[1], error=errors[0], pressure_error=errors[1], solves=solves)
    raise NotConverged(
        f"worn depth over {cycles:.6g} cycles must come within the tolerance {tolerance:.1e} with {_FINEST} sub-steps "
        f"(got {errors[0]:.1e}, its pressure {errors[1]:.1e}); loosen the tolerance, solve contacts more closely, or "
        "take fewer cycles at once"
    )


def _stepped(
    pressed: Pressed, depth: FloatArray, pressure: FloatArray, rates: tuple[FloatArray, FloatArray], lengths: FloatArray
) -> _State:
    """Added depth and pressure after implicit sub-steps."""
    rate, steady = rates
    growth = np.zeros_like(depth)
    for length in lengths:
        springs = rate * length
        growth = growth + steady * length
        pressure = pressed(depth + growth, springs, pressure)
        growth = growth + springs * pressure
    return growth, pressure


def _lengths(count: int) -> FloatArray:
    """Sub-steps of an interval of length one."""
    return np.diff(1.0 - (1.0 - np.arange(count + 1) / count) ** _GRADING)


def _extrapolated(coarse: _State, fine: _State, count: int, *, bounded: bool) -> _State:
    """Extrapolation to zero sub-step size; if bounded, in each cell only to zero pressure.

    The error is proportional to the sum of squares of the sub-steps, hence the factor; it is near one for equal or many
    sub-steps. Two bounded results agree too well for an error estimate.
    """
    squares = [float(np.sum(_lengths(number) ** 2)) for number in (count // 2, count)]
    factor = squares[1] / (squares[0] - squares[1])
    (first, high), (second, low) = coarse, fine
    share = np.full_like(low, factor)
    if bounded:
        fall = high - low
        np.divide(low, fall, out=share, where=low < factor * fall)
    depth, pressure = second + share * (second - first), low + share * (low - high)
    return (np.maximum(depth, 0.0), np.maximum(pressure, 0.0)) if bounded else (depth, pressure)


def _difference(state: _State, reference: _State, least: float) -> tuple[float, float]:
    """Differences of depth and of pressure, relative to the second state; sums over cells."""

    def relative(a: FloatArray, b: FloatArray, least: float = 0.0) -> float:
        size, off = max(float(np.sum(np.abs(b))), least), float(np.sum(np.abs(a - b)))
        return off / size if size > 0 else (inf if off > 0 else 0.0)

    return relative(state[0], reference[0], least), relative(state[1], reference[1])


def _worst(errors: tuple[float, float]) -> float:
    """Largest of the errors of depth and pressure, with their allowed ratio."""
    return max(errors[0], errors[1] / _OF_PRESSURE)
