"""Worn depth of a surface over many cycles under its own pressure: implicit sub-steps, doubled and extrapolated.

A sub-step of n cycles that ends with the pressure p wears ``n rate p``. As long as p is unknown that is a layer of
springs n rate on the surface, so that each sub-step is one solve of the contact (backward Euler): stable for any n, and
no pressure goes below zero. The whole interval is done with 1, 2, 4, 8, … sub-steps until two answers agree; one is
enough where the pressure hardly changes.

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

#: Contact pressure [Pa] from the worn depth [m], springs on the surface [m/Pa] and a pressure near by.
Pressed = Callable[[FloatArray, FloatArray, FloatArray], FloatArray]

# Depth added and pressure.
_State = tuple[FloatArray, FloatArray]

# Sub-steps of the finest try.
_FINEST = 512
# Ends of sub-steps at ``1 - (1 - s)^q``, s uniform in 0..1. The surface forgets how it came to its shape, but not the
# last sub-step: over decades of worn depth q = 1.5 takes half the solves of q = 1, over a fraction of one as many.
_GRADING = 1.5
# Error of the pressure at the end that goes with an error of one of the depth: smaller ones cost many solves over
# decades of depth, larger ones leave the edge of contact on a surface that has not come to rest.
_OF_PRESSURE = 5.0


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Moved:
    """Change of a surface over many cycles.

    Attributes
    ----------
    depth : (ny, nx) float64
        Worn depth added [m], nowhere below zero.
    pressure : (ny, nx) float64
        At the end [Pa]; where it is extrapolated it is that of a contact to the error alone.
    error, pressure_error : float
        Estimated errors of the two, sums of magnitudes over all cells, relative to the sum of each [-].
    solves : int
        Contacts solved.
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
    """Integrate ``d depth / d cycles = rate p(depth) + steady``, rate and steady frozen.

    Parameters
    ----------
    pressed : callable
        ``pressed(depth, springs, start)``: contact pressure of the surface worn by `depth` under a layer of `springs`;
        see `NormalSolver.solve`.
    depth, pressure : (ny, nx) float64
        Worn depth [m] and contact pressure [Pa] at the start.
    rate : (ny, nx) float64
        Depth per pressure and cycle [m/(Pa cycle)], zero or positive.
    cycles : float
        Number of cycles; need not be whole.
    steady : (ny, nx) float64, optional
        Depth per cycle whatever the pressure [m/cycle], zero or positive; none by default.
    tolerance : float
        Bound on the estimated relative error of the depth added [-]; the pressure at the end may be off by five times
        as much.
    least : float
        The error is relative to this sum of the depth over all cells [m] where less is added.

    Raises
    ------
    NotConverged
        The tolerance is not met with the finest sub-steps: it is below that of the contact solves, or nearly.
    SceneError
        A rate below zero, no tolerance.

    Notes ----- T(m) from m sub-steps has an error of first order, ``2 T(2m) - T(m)`` of second order. A cell is
    extrapolated only so far that its pressure stays at zero or more; on a bed of springs the depth then stays below its
    limit. Depth does not decrease: where it would, it is clipped. Errors are differences between the last two tries,
    too large by a factor of two to four. Where the pressure changes many times over and edges of contact cross many
    cells, extrapolation does harm: T(2m) is the result where its estimate is the smaller.

    Steps with small local errors cost far more: a local error counts as if the surface kept it, but wear levels it. A
    sphere worn to 100 times the volume of its first contact takes 15 solves here at 1e-2 (depth off by .1 %, pressure
    by 2 %), and there 277 for an estimate that is too large by a factor of 700.

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
    # The error of one sub-step: the trapezoidal rule would take the mean of the first and the last pressure.
    trapezoidal = coarse[0] - 0.5 * cycles * rate * (coarse[1] - pressure), 0.5 * (coarse[1] + pressure)
    state, errors = coarse, _difference(trapezoidal, coarse, least)
    while _worst(errors) > tolerance and count < _FINEST:
        count *= 2
        fine = stepped(count)
        solves += count
        errors, plain = _difference(coarse, fine, least), _extrapolated(coarse, fine, count, bounded=False)
        # Of the first extrapolation nothing is known but that it is better than what it is made of.
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
    """Depth added and pressure after implicit sub-steps."""
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
    """Extrapolation to zero sub-step size; if bounded, at each cell only until its pressure is zero.

    The error is as the sum of the squares of the sub-steps, hence the factor; near one for equal or many of them. What
    is bounded twice agrees with itself too well to tell an error.
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
    """Differences of depth and of pressure, relative to the second; sums over cells."""

    def relative(a: FloatArray, b: FloatArray, least: float = 0.0) -> float:
        size, off = max(float(np.sum(np.abs(b))), least), float(np.sum(np.abs(a - b)))
        return off / size if size > 0 else (inf if off > 0 else 0.0)

    return relative(state[0], reference[0], least), relative(state[1], reference[1])


def _worst(errors: tuple[float, float]) -> float:
    """Errors of depth and of pressure as one."""
    return max(errors[0], errors[1] / _OF_PRESSURE)
