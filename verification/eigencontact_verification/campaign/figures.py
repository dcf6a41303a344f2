"""Profiles of a case: the semi-analytical line, finite-element symbols and their error bars."""

from __future__ import annotations

from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

from eigencontact.viz.style import COLOURS, paper_style
from eigencontact_verification.campaign.case import Profile
from eigencontact_verification.campaign.judge import JudgedCase

__all__ = ["draw"]

#: With the colour-blind-safe colours of all figures; symbols and dashes differ too.
_SYMBOLS = ("o", "s", "^", "D", "v", "P")
_DASHES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)))
_WIDTH, _HEIGHT = 5.2, 3.4
#: Symbols of a curve at most, so that error bars stay apart.
_DENSEST = 25


def draw(found: JudgedCase, file: Path) -> Path:
    """Write one picture with a panel for each profile; what was not solved is left out.

    Parameters
    ----------
    found : JudgedCase
        A case with its verdicts.
    file : Path
        PNG or SVG by its ending.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with paper_style():
        profiles = found.case.profiles
        columns = min(2, len(profiles))
        rows = ceil(len(profiles) / columns)
        figure = Figure(figsize=(_WIDTH * columns, _HEIGHT * rows + 0.3), layout="constrained")
        FigureCanvasAgg(figure)
        panels = figure.subplots(rows, columns, squeeze=False).ravel()
        for axes, profile in zip(panels, profiles, strict=False):
            _panel(axes, profile, found)
        for axes in panels[len(profiles) :]:
            axes.set_axis_off()
        figure.suptitle(f"{found.case.key}: line semi-analytical, symbols finite elements with $u_{{FE}}$", fontsize=10)
        file.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(file, dpi=110)
    return file


def _panel(axes: Any, profile: Profile, found: JudgedCase) -> None:
    judged, reference = found.judged.get(profile.name), found.estimates.get(profile.name)
    order = np.argsort(profile.along, kind="stable")
    step = max(1, ceil(len(order) / _DENSEST))
    for k, component in enumerate(profile.components):
        look = k % len(COLOURS)
        if judged is not None:
            axes.plot(
                profile.along[order], judged[order, k], color=COLOURS[look], linestyle=_DASHES[look], linewidth=1.3,
                label=component,
            )  # fmt: skip
        if reference is not None:
            some = order[(look % step) :: step]
            axes.errorbar(
                profile.along[some], reference.value[some, k], yerr=reference.uncertainty[some, k], fmt=_SYMBOLS[look],
                color=COLOURS[look], markersize=4, markerfacecolor="none", capsize=2, linewidth=0.9,
                label=None if judged is not None else component,
            )  # fmt: skip
    axes.axhline(0.0, color="0.8", linewidth=0.6, zorder=0)
    axes.set_title(profile.name, fontsize=9)
    axes.set_xlabel(profile.label)
    axes.set_ylabel(f"{profile.quantity} [{profile.unit or '1'}]")
    if judged is not None or reference is not None:
        axes.legend(fontsize=8, frameon=False)
