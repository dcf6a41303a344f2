"""Picture of a crack: ranges of the stress intensity factors over its length, threshold, and arrest."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.units import readable
from eigencontact.viz.style import COLOURS, new_figure, paper_style, save, scale_for

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import xarray

__all__ = ["draw_crack"]

_CURVES = (
    ("mode_1_range", r"$\Delta K_\mathrm{I}$", COLOURS[0], "--"),
    ("mode_2_range", r"$\Delta K_\mathrm{II}$", COLOURS[2], "--"),
    ("effective_range", r"$\Delta K_\mathrm{eff}$", COLOURS[1], "-"),
    ("threshold", r"threshold $\Delta K_\mathrm{th}$", "black", "-"),
)


def draw_crack(answer: xarray.Dataset, summary: Mapping[str, Any], path: Path) -> str:
    """Store the picture of `eigencontact.crack`; returns its description."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    lengths = answer["length"].values
    scale = scale_for(lengths, "m")
    stop = summary["arrest_length"]
    with paper_style():
        figure = new_figure(4.6, 3.4)
        axes = figure.add_subplot()
        floor = 0.02 * float(max(answer["effective_range"].max(), answer["threshold"].max()))
        for name, label, colour, line in _CURVES:
            values = np.where(answer[name].values > floor, answer[name].values, np.nan)
            axes.loglog(scale(lengths), values / 1e6, line, color=colour, label=label)
        if stop:
            axes.axvline(scale(stop), color="grey", linewidth=1, linestyle=":")
            size = float(np.interp(stop, lengths, answer["threshold"].values)) / 1e6
            axes.plot(scale(stop), size, "o", color="black", label=f"stops at {readable(stop, 'm')}")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())
        axes.set_xlabel(f"length of the crack [{scale.unit}]")
        axes.set_ylabel(r"range of stress intensity [MPa$\sqrt{\mathrm{m}}$]")
        axes.legend()
        angle = np.degrees(summary["angle"])
        axes.set_title(
            f"Crack from x = {readable(summary['place'][0], 'm')}, {angle:.3g}° to the normal: {summary['outcome']}"
            + (", opening alone" if summary["mode"] == "opening" else "")
        )
        sentence = "ranges of stress intensity over the length of the crack, threshold and arrest"
        save(figure, path, caption=sentence)
    return sentence
