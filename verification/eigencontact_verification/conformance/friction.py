"""Checks of friction laws: a finite shear bound of the shape of the pressure, the same one each time."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from eigencontact.plugin import FrictionState
from eigencontact_verification.conformance.report import check, ensure, ensure_array, ensure_pure

_SHAPES = ((1, 1), (1, 4), (5, 1), (3, 4), (6, 5))
_PRESSURES = (0.0, 1.0, 1e6, 1e10)
_SPACINGS = (1e-9, 1e-6)


def _state(shape: tuple[int, int], pressure: float, spacing: float, time: float = 1.5) -> FrictionState:
    """Contact in most of some cells about the origin, slipped so far by a little more from one to the next."""
    ny, nx = shape
    steps = np.arange(ny * nx, dtype=float).reshape(shape)
    field = pressure * (1 + steps) / steps.size
    if steps.size > 1:
        field[0, 0] = 0.0
    return FrictionState(
        pressure=field,
        x=spacing * np.linspace(0.5 - 0.5 * nx, 0.5 * nx - 0.5, nx)[None, :],
        y=spacing * np.linspace(0.5 - 0.5 * ny, 0.5 * ny - 0.5, ny)[:, None],
        slip_distance=spacing * steps,
        time=time,
    )


def _states() -> Iterator[FrictionState]:
    for shape in _SHAPES:
        for pressure in _PRESSURES:
            for spacing in _SPACINGS:
                yield _state(shape, pressure, spacing)


@check
def check_shear_bound(law: Any) -> None:
    """One number for each cell, whatever the grid; in contact finite, and zero or positive."""
    for state in _states():
        bound = np.asarray(law.shear_bound(state))
        shape = state.pressure.shape
        case = f"shear_bound at pressures up to {state.pressure.max():.0e} Pa"
        ensure_array(bound, shape, case, "compute with state.pressure, (ny, nx), x (1, nx) and y (ny, 1)")
        borne = bound[state.pressure > 0]
        ensure(
            np.all(np.isfinite(borne)) and np.all(borne >= 0), case, "finite, and zero or positive, in contact",
            f"{borne.min(initial=0.0):.3g} to {borne.max(initial=0.0):.3g}", "look at low pressures and at no slip",
        )  # fmt: skip


@check
def check_shear_bound_pure(law: Any) -> None:
    """Same answer twice, another state asked in between; the state stays as it was, and may be read-only."""
    state, second = _state((4, 3), 1e8, 1e-6), _state((4, 3), 2e8, 2e-6, time=3.0)
    ensure_pure(
        "shear_bound", lambda: law.shear_bound(state), (state.pressure, state.x, state.y, state.slip_distance),
        arguments="the arrays of the state", between=lambda: law.shear_bound(second),
        advice="keep no memory of what was asked: state.slip_distance and state.time are the history",
    )  # fmt: skip
