"""Estimated errors in pictures: bands along curves, and words above maps; nothing where none are stored."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.field_error import FieldError, error_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.cut import Shown
    from eigencontact.viz.style import Scale

__all__ = ["BAND", "draw_band", "error_line", "errors_of", "with_error"]

#: Name of a band in a legend.
BAND = "estimated error"
#: How much of the colour of its curve a band has.
_FAINT = 0.25


def errors_of(dataset: Results, variable: str, step: int) -> NDArray[np.float64] | None:
    """Errors of a field at every point in one step; None where none are stored."""
    name = error_name(variable)
    return np.asarray(dataset[name][step].values, dtype=float) if name in dataset else None


def with_error(title: str, dataset: Results, variable: str, step: int) -> str:
    """Title of a map of the surface with the error of its field in a line of its own."""
    errors = errors_of(dataset, variable, step)
    values = np.asarray(dataset[variable][step].values, dtype=float)
    line = _line(values, errors, 2)
    return f"{title}\n{line}" if line else title


def error_line(numbers: Shown, edged: int = 0) -> str:
    """Error of what a picture shows, in words; along `edged` of its dimensions it has edges."""
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
    """Band of a curve of `values` over places `at`, or across the places where these lie along the vertical axis."""
    fill = axes.fill_betweenx if across else axes.fill_between
    fill(at, scale(values - errors), scale(values + errors), color=colour, alpha=_FAINT, linewidth=0, label=BAND)
