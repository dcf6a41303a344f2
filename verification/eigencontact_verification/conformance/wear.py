"""Checks of wear laws: a finite depth of the shape of the pressure, and true statements of the law about itself."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import WearState
from eigencontact_verification.conformance.report import check, ensure, ensure_array, ensure_pure

FloatArray = NDArray[np.float64]

_SHAPES = ((1, 1), (1, 4), (5, 1), (3, 4), (6, 5))
_PRESSURES = (0.0, 1.0, 1e6, 1e10)
_SLIPS = (0.0, 1e-12, 1e-6, 1e3)
_COEFFICIENT = 0.3
#: Part of an increment that is cut, and by how much its halves may differ from it.
_FACTOR, _CUT = 1e-9, 1e-3
#: Round-off of laws that are proportions.
_EXACT = 1e-9


def _state(shape: tuple[int, int], pressure: float, slip: float, time: float = 1.5) -> WearState:
    """Contact in most of some cells, which slipped, by a little more from one to the next; the second has opened."""
    ny, nx = shape
    steps = np.arange(ny * nx, dtype=float).reshape(shape)
    share = (1.0 + steps) / steps.size
    pressed, path = pressure * share, slip * share[::-1, ::-1]
    energy = _COEFFICIENT * pressed * path
    if steps.size > 2:
        pressed[0, 0] = path[0, 0] = energy[0, 0] = 0.0
        pressed.flat[1] = 0.0
    return WearState(
        pressure=pressed,
        shear=_COEFFICIENT * pressed,
        slip=path,
        slip_amplitude=0.25 * path,
        energy=energy,
        worn_depth=1e-6 * share,
        total_energy=30.0 * energy,
        material=np.zeros(shape, dtype=np.intp),
        x=1e-6 * np.linspace(0.5 - 0.5 * nx, 0.5 * nx - 0.5, nx)[None, :],
        y=1e-6 * np.linspace(0.5 - 0.5 * ny, 0.5 * ny - 0.5, ny)[:, None],
        time=time,
    )


def _states(slips: Iterable[float] = _SLIPS) -> Iterator[WearState]:
    for slip in slips:
        for shape in _SHAPES:
            for pressure in _PRESSURES:
                yield _state(shape, pressure, slip)


def _case(state: WearState) -> str:
    return f"depth at pressures up to {state.pressure.max():.0e} Pa and slip up to {state.slip.max():.0e} m"


@check
def check_worn_depth(law: Any) -> None:
    """One number for each cell, whatever the grid: finite, and zero or positive."""
    for state in _states():
        depth, shape = np.asarray(law.depth(state)), state.pressure.shape
        ensure_array(depth, shape, _case(state), "compute with the arrays (ny, nx), x (1, nx) and y (ny, 1)")
        ensure(
            np.all(np.isfinite(depth)) and np.all(depth >= 0), _case(state), "finite, and zero or positive",
            f"{depth.min():.3g} to {depth.max():.3g}", "look at no pressure, no slip and much of both",
        )  # fmt: skip


@check
def check_worn_depth_pure(law: Any) -> None:
    """Same answer twice, another state asked in between; the state stays as it was, and may be read-only."""
    state, second = _state((4, 3), 1e8, 1e-6), _state((4, 3), 2e8, 2e-6, time=3.0)
    arrays = [value for item in fields(state) if isinstance(value := getattr(state, item.name), np.ndarray)]
    ensure_pure(
        "depth", lambda: law.depth(state), arrays,
        arguments="the arrays of the state", between=lambda: law.depth(second),
        advice="keep no memory of what was asked: worn_depth, total_energy and time of the state are the history",
    )  # fmt: skip


@check
def check_no_slip_no_wear(law: Any) -> None:
    """Nothing wears where nothing slips and no work is done, whatever presses and pulls there."""
    for state in _states(slips=(1e-6,)):
        zero = np.zeros_like(state.pressure)
        still = replace(state, slip=zero, slip_amplitude=zero, energy=zero)
        depth = np.asarray(law.depth(still))
        ensure(
            not depth.any(), f"depth without slip at pressures up to {state.pressure.max():.0e} Pa", "zero",
            f"up to {depth.max():.3g} m", "multiply by slip or energy of the state",
        )  # fmt: skip


@check
def check_pressed_in_proportion(law: Any) -> None:
    """A law with ``linear_in_pressure``: pressure, shear and energy times a factor is the depth times this factor."""
    if not law.linear_in_pressure:
        return
    for state in _states():
        for factor in (0.0, 0.3, 7.0):
            scaled = replace(
                state, pressure=factor * state.pressure, shear=factor * state.shear, energy=factor * state.energy
            )
            expected, depth = factor * np.asarray(law.depth(state)), np.asarray(law.depth(scaled))
            _ensure_equal(
                depth, expected, f"{_case(state)}, all of it times {factor:g}", f"{factor:g} times the depth",
                "say linear_in_pressure = False: its derivative is then found by a small change",
            )  # fmt: skip


@check
def check_volume_by_energy(law: Any) -> None:
    """A law with ``volume_per_energy``: the sum of the depth is that number times the work of friction."""
    alpha = law.volume_per_energy
    if alpha is None:
        return
    for state in _states():
        worn, spent = float(np.sum(law.depth(state))), float(np.sum(state.energy))
        _ensure_equal(
            np.array([worn]), np.array([alpha * spent]), f"the sum of the {_case(state)}",
            f"volume_per_energy, {alpha:g} m^3/J, times that of the energy", "leave volume_per_energy out",
        )  # fmt: skip


@check
def check_says_what_it_needs(law: Any) -> None:
    """``needs_friction`` says whether shear or energy matter, ``needs_cycles`` whether the slip amplitude does."""
    wears = any(np.any(law.depth(state)) for state in _states())
    for ability, names in (
        ("needs_friction", ("shear", "energy", "total_energy")),
        ("needs_cycles", ("slip_amplitude",)),
    ):
        looked = any(_differs(law, state, names) for state in _states())
        says, listed = getattr(law, ability), " or ".join(names)
        ensure(
            says or not looked, ability, "True", f"{says}, and the depth changes with {listed}",
            f"say {ability}: ClassVar[bool] = True; scenes without it are then refused in words",
        )  # fmt: skip
        ensure(
            looked or not says or not wears, ability, "False", f"{says}, and nothing changes with {listed}",
            f"leave {ability} out: it refuses scenes that this law could wear",
        )  # fmt: skip


def _differs(law: Any, state: WearState, names: Iterable[str]) -> bool:
    depth = np.asarray(law.depth(state))
    for factor in (0.0, 0.5):
        changed_state = replace(state, **{name: factor * getattr(state, name) for name in names})
        if not np.array_equal(depth, np.asarray(law.depth(changed_state))):
            return True
    return False


@check
def check_cut_increments(law: Any) -> None:
    """A small increment wears what its two halves wear: the number of increments of a path does not matter.

    Laws that look at the slip amplitude are asked for whole cycles only, and are left out.
    """
    if law.needs_cycles:
        return
    whole = _state((4, 3), 1e9, 1e-6)
    small = replace(whole, slip=_FACTOR * whole.slip, energy=_FACTOR * whole.energy)
    half = replace(small, slip=0.5 * small.slip, energy=0.5 * small.energy)
    first = np.asarray(law.depth(half))
    later = replace(half, worn_depth=half.worn_depth + first, total_energy=half.total_energy + half.energy)
    depth, halves = np.asarray(law.depth(small)), first + np.asarray(law.depth(later))
    largest = float(depth.max())
    missed = float(np.abs(depth - halves).max())
    ensure(
        missed <= _CUT * largest, f"depth of an increment of {float(small.slip.max()):.0e} m",
        f"that of its two halves, {float(halves.max()):.6g} m", f"{largest:.6g} m",
        "take slip and energy once, and look at worn_depth and total_energy for what came before; a law of the "
        "amplitude of a cycle looks at slip_amplitude, and says needs_cycles = True",
    )  # fmt: skip


@check
def check_reversed_cells(law: Any) -> None:
    """Cells in reversed order, their places with them, wear as before, in reversed order."""
    for state in _states(slips=(1e-6,)):
        arrays = {item.name: getattr(state, item.name) for item in fields(state)}
        turned: dict[str, Any] = {
            name: np.ascontiguousarray(value[::-1, ::-1])
            for name, value in arrays.items()
            if isinstance(value, np.ndarray)
        }
        depth, reversed_depth = np.asarray(law.depth(state)), np.asarray(law.depth(replace(state, **turned)))
        _ensure_equal(
            reversed_depth[::-1, ::-1], depth, f"{_case(state)}, cells in reversed order", "the same at the same place",
            "take places from state.x and state.y, not from indices",
        )  # fmt: skip


def _ensure_equal(got: FloatArray, expected: FloatArray, subject: str, rule: str, advice: str) -> None:
    """Equal to round-off of the largest."""
    missed, largest = float(np.abs(got - expected).max()), float(np.abs(expected).max())
    shown = f"{float(got.max()):.10g} where {float(expected.max()):.10g} was expected"
    ensure(missed <= _EXACT * largest, subject, rule, shown, advice)
