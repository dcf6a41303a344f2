"""Picture of a fatigue criterion in a region: utilisation, hot spot, and the trace of its plane."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.units import readable
from eigencontact.viz.cut import Shown
from eigencontact.viz.looks import figure_look
from eigencontact.viz.section import kind_of, stress_section
from eigencontact.viz.style import draw_cross, save, scale_for

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import xarray
    from matplotlib.axes import Axes

    from eigencontact.results.stored import Results

__all__ = ["draw_fatigue"]

#: Length of the trace of a plane, in parts of the shorter side of the picture.
_TRACE = 0.25


def draw_fatigue(results: Results, answer: xarray.Dataset, summary: Mapping[str, Any], path: Path) -> str:
    """Store a picture of utilisation; returns what it shows, nothing where the region is no section.

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
    words = f"{summary['criterion']['type']}, value over limit"
    values = np.asarray(answer["utilisation"].values, dtype=float)
    with figure_look():
        figure = stress_section(results, region, -1, numbers=Shown(words, "1", values))
        axes = figure.axes[0]
        _mark_hot_spot(axes, summary)
        steps = summary["steps"]
        place = ", ".join(readable(at, "m") for at in summary["place"])
        axes.set_title(
            f"{words}, steps {steps[0]} to {steps[1]}\nhot spot {summary['utilisation']:.3g} at ({place})"
            + (", plane drawn" if summary["normal"] else "")
        )
        sentence = f"{words}, over steps {steps[0]} to {steps[1]} in {region!r}; hot spot and the trace of its plane"
        save(figure, path, caption=sentence)
    return sentence


def _mark_hot_spot(axes: Axes, summary: Mapping[str, Any]) -> None:
    """Cross at the hot spot, and the line in which the plane of the criterion cuts the section."""
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
