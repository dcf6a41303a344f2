"""Picture of a fatigue criterion in a region: utilisation, hot spot, and the trace of its plane."""

from __future__ import annotations

import json
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.cut import StepValues
from eigencontact.viz.looks import figure_look
from eigencontact.viz.section import kind_of, stress_section
from eigencontact.viz.style import draw_cross, place, save, scale_for

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from eigencontact.results.stored import Results

__all__ = ["draw_fatigue", "fatigue_pictures", "fatigue_section"]

#: Length of the trace of a plane, in parts of the shorter side of the picture.
_TRACE = 0.25
#: In results: the region before, the name of the criterion after it.
_NAME = "_fatigue_"


def draw_fatigue(results: Results, answer: xarray.Dataset, summary: Mapping[str, Any], path: Path) -> str:
    """Store a picture of the utilisation; returns its description, empty for a region that is not a section.

    Parameters
    ----------
    results : Results
        With the region, whose last step gives the contact above the section.
    answer, summary : Dataset, mapping
        Of `eigencontact.fatigue`.
    """
    region = str(summary["region"])
    if f"{region}_stress" not in results or kind_of(results, region) != "section":
        return ""
    sentence = _sentence(summary)
    with figure_look():
        save(fatigue_section(results, np.asarray(answer["utilisation"].values), summary), path, caption=sentence)
    return sentence


def fatigue_pictures(results: Results) -> Iterator[tuple[str, str, Callable[[], Figure]]]:
    """File name, sentence and function of the picture of each criterion that a run evaluated in a section."""
    for variable in results:
        region, _, label = str(variable).partition(_NAME)
        if label and kind_of(results, region) == "section":
            summary = json.loads(str(results[variable].attrs["fatigue"]))
            values = np.asarray(results[variable].values, dtype=float)
            yield f"fatigue-{label}.png", _sentence(summary), partial(fatigue_section, results, values, summary)


def fatigue_section(results: Results, values: np.ndarray[Any, Any], summary: Mapping[str, Any]) -> Figure:
    """Draw utilisation with its hot spot and the trace of its plane; compression counts as no damage.

    Parameters
    ----------
    values : array
        Damage parameter over its limit, on the dimensions of the region.
    """
    words = f"{summary['criterion']['type']}, value over limit"
    shown = StepValues(words, "1", np.maximum(np.asarray(values, dtype=float), 0.0))
    figure = stress_section(results, str(summary["region"]), -1, numbers=shown)
    axes = figure.axes[0]
    names = _mark_hot_spot(axes, summary)
    spot = ", ".join(place(name, summary["place"]["xyz".index(name)]) for name in names)
    steps = summary["steps"]
    lines = [f"{words}, steps {steps[0]} to {steps[1]}", f"hot spot {summary['utilisation']:.3g} at {spot}"]
    lines += ["line: its plane"] if summary["normal"] else []
    axes.set_title("\n".join([lines[0], "; ".join(lines[1:])]))
    return figure


def _sentence(summary: Mapping[str, Any]) -> str:
    steps = summary["steps"]
    sentence = (
        f"{summary['criterion']['type']}: damage parameter over its limit, over steps {steps[0]} to {steps[1]} in "
        f"{summary['region']!r}; the cross is the hot spot"
    )
    if summary["normal"]:
        sentence += ", the line the trace of its plane, of normal ({:.3f}, {:.3f}, {:.3f})".format(*summary["normal"])
    return f"{sentence}."


def _mark_hot_spot(axes: Axes, summary: Mapping[str, Any]) -> list[str]:
    """Mark the hot spot by a cross and its plane by a line in the section; returns the two axes."""
    names = [axes.get_xlabel()[0], axes.get_ylabel()[0]]
    horizontal, vertical = (np.ptp(limits) for limits in (axes.get_xlim(), axes.get_ylim()))
    unit = axes.get_xlabel().partition("[")[2].rstrip("]")
    factor = {"m": 1.0, "mm": 1e3, "µm": 1e6, "nm": 1e9}.get(unit) or scale_for([1.0], "m").factor
    at = [factor * summary["place"]["xyz".index(name)] for name in names]
    normal = summary["normal"]
    if normal:
        across = np.array([normal["xyz".index(name)] for name in names])
        size = float(np.linalg.norm(across))
        if size > 0.05:  # a plane of the section has no trace
            along = np.array([-across[1], across[0]]) / size * 0.5 * _TRACE * min(horizontal, vertical)
            line = [(at[k] - along[k], at[k] + along[k]) for k in (0, 1)]
            for colour, width in (("black", 3.0), ("white", 1.4)):
                axes.plot(*line, color=colour, linewidth=width, zorder=9, solid_capstyle="round")
    draw_cross(axes, (at[0], at[1]), zorder=10, clip_on=False)
    return names
