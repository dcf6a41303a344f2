"""Estimated errors in pictures: bands along curves, and text above maps, if errors are stored."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.field_error import FieldError, error_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.cut import StepValues
    from eigencontact.viz.style import Scale

__all__ = ["BAND", "draw_band", "error_line", "errors_of", "history_errors", "with_error"]

#: Name of a band in a legend.
BAND = "estimated error"
#: How much of the colour of its curve a band has.
_FAINT = 0.25


def errors_of(dataset: Results, variable: str, step: int) -> NDArray[np.float64] | None:
    """Errors of a field at every point in one step; None if none are stored."""
    return _values(dataset, error_name(variable), step)


def history_errors(dataset: Results, number: str) -> NDArray[np.float64] | None:
    """Errors of a number in all steps; None if none are stored."""
    name = error_name(number)
    return np.asarray(dataset[name].values, dtype=float) if name in dataset else None


def _values(dataset: Results, name: str, step: int) -> NDArray[np.float64] | None:
    """Values of a variable after a step; None if they are not stored, as for cells of earlier steps."""
    if name not in dataset:
        return None
    variable = dataset[name]
    if variable.dims[0] == "history_step":
        places = np.flatnonzero(dataset["history_step"].values == int(dataset["step"][step]))
        return np.asarray(variable[int(places[0])].values, dtype=float) if places.size else None
    return np.asarray(variable[step].values, dtype=float)


def with_error(title: str, dataset: Results, variable: str, step: int) -> str:
    """Title of a map of the surface, or of cells of a body, with the error of its field on a separate line."""
    values, errors = _values(dataset, variable, step), errors_of(dataset, variable, step)
    line = "" if values is None else _line(values, errors, values.ndim)
    return f"{title}\n{line}" if line else title


def error_line(numbers: StepValues, edged: int = 0) -> str:
    """Text about the error of the displayed field, which has edges along `edged` of its dimensions."""
    return _line(numbers.values, numbers.errors, edged)


def _line(values: NDArray[Any], errors: NDArray[Any] | None, edged: int) -> str:
    words = "" if errors is None else FieldError.of(values, errors, edged).words()
    return f"estimated error {words}" if words else ""


def draw_band(
    axes: Axes,
    at: Any,
    values: NDArray[Any],
    errors: NDArray[Any],
    scale: Scale,
    colour: str,
    *,
    across: bool = False,
) -> None:
    """Error band of a curve of `values` over coordinates `at`, also along the vertical axis."""
    fill = axes.fill_betweenx if across else axes.fill_between
    fill(at, scale(values - errors), scale(values + errors), color=colour, alpha=_FAINT, linewidth=0, label=BAND)
