"""Picture of a crack: ranges of the stress intensity factor over its length, and the threshold."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.looks import figure_look
from eigencontact.viz.style import new_figure, save, scale_for

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import xarray

__all__ = ["draw_crack"]

_CURVES = (
    ("effective_range", r"$\Delta K_{\mathrm{eff}}$", "C0", "-", 2.0),
    ("mode_1_range", r"$\Delta K_{\mathrm{I}}$ (open)", "C1", "--", 1.2),
    ("mode_2_range", r"$\Delta K_{\mathrm{II}}$", "C2", "-.", 1.2),
    ("threshold", "threshold", "black", ":", 1.6),
)


def draw_crack(answer: xarray.Dataset, summary: Mapping[str, Any], path: Path) -> str:
    """Store a picture of the ranges over the length; returns what it shows.

    Parameters
    ----------
    answer, summary : Dataset, mapping
        Of `eigencontact.crack`.
    """
    from matplotlib.ticker import LogLocator, NullFormatter

    lengths = np.asarray(answer["length"].values)
    scale = scale_for(lengths, "m")
    mouth = scale_for([summary["place"]], "m").text(summary["place"])
    place = f"{summary['axis']} = {mouth}, {np.degrees(summary['angle']):.3g}° from the normal"
    with figure_look():
        figure = new_figure(5.2, 3.6)
        axes = figure.add_subplot()
        for name, label, colour, dashes, width in _CURVES:
            if name in answer:
                values = np.asarray(answer[name].values) / 1e6
                axes.plot(scale.factor * lengths, values, dashes, color=colour, linewidth=width, label=label)
        arrest = summary["arrest_length"]
        if arrest is not None:
            end = (scale.factor * arrest, float(np.interp(arrest, lengths, answer["threshold"].values)) / 1e6)
            axes.plot(*end, "o", color="black", markerfacecolor="white", zorder=5)
            axes.annotate(f"stops at {scale.text(arrest)}", end, (6, -14), textcoords="offset points")
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_ylim(bottom=0.0)
        axes.set_xlabel(f"length of the crack [{scale.unit}]")
        axes.set_ylabel(r"range of $K$ [MPa m$^{0.5}$]")
        axes.set_title(f"Crack at {place}: {summary['fate']}")
        axes.legend(frameon=False)
        sentence = f"ranges of the stress intensity factor over the length of a crack at {place}"
        save(figure, path, caption=sentence)
    return sentence
