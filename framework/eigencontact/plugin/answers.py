"""Checks of the results of friction and wear laws before a solver uses them."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.arrays import FloatArray, real_answer
from eigencontact.errors import PluginError
from eigencontact.plugin.component import Component

__all__ = ["checked_answer"]

State = TypeVar("State")


def checked_answer(
    law: Component, method: str, unit: str, state: Any, cells: NDArray[np.bool_], cells_are: str
) -> FloatArray:
    """Result ``(ny, nx)`` [`unit`] of a method of a law for a read-only state, checked.

    The result must be finite and not negative in `cells` ``(ny, nx)``; the message names these cells by `cells_are`.

    Raises
    ------
    PluginError
        Another shape; values that are not finite, or negative.
    """
    where = f"{method} of {law.kind.replace('-', ' ')} {law.key!r}"
    answer = real_answer(getattr(law, method)(_read_only(state)), where)
    shape = state.pressure.shape
    if answer.shape != shape:
        raise PluginError(f"{where} must be of shape {shape}, that of the pressure (got shape {answer.shape})")
    wrong = cells & ~(np.isfinite(answer) & (answer >= 0))
    if wrong.any():
        row, column = (int(index) for index in np.argwhere(wrong)[0])
        raise PluginError(
            f"{where} must be zero or positive, and finite [{unit}] (got {float(answer[row, column])!r} at x = "
            f"{float(state.x[0, column]):.6g} m, y = {float(state.y[row, 0]):.6g} m, and at {int(wrong.sum())} of "
            f"{int(cells.sum())} {cells_are})"
        )
    return answer


def _read_only(state: State) -> State:
    views = {}
    for item in fields(state):  # type: ignore[arg-type]
        value = getattr(state, item.name)
        if isinstance(value, np.ndarray):
            views[item.name] = value.view()
            views[item.name].flags.writeable = False
    return replace(state, **views)  # type: ignore[type-var]
