"""Profiles of a case: the semi-analytical line, finite-element symbols and their error bars."""

from __future__ import annotations

from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.viz.style import COLOURS, paper_style
from eigencontact_verification.crosscheck.case import Profile
from eigencontact_verification.crosscheck.judge import JudgedCase
from eigencontact_verification.crosscheck.lines import STRESSES, VECTORS
from eigencontact_verification.reporting.files import GENERATOR

if TYPE_CHECKING:
    from eigencontact_verification.crosscheck.case import Curve

__all__ = ["draw", "gaps_of"]

FloatArray = NDArray[np.float64]

#: With the colour-blind-safe colours of all figures; symbols and dashes differ too.
_SYMBOLS = ("o", "s", "^", "D", "v", "P")
_DASHES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)))
_WIDTH, _HEIGHT = 5.2, 3.2
#: Symbols of a curve at most, so that error bars stay apart.
_DENSEST = 25
#: Points farther apart than this multiple of the median have others left out between them.
_GAP = 1.6
_GREY = "0.92"
#: A line may leave the range of what is compared by this part of it: at corners of the source it is infinite.
_BEYOND = 0.4


def draw(judged: JudgedCase, file: Path) -> Path:
    """Write one picture with a panel for each profile; what was not solved is left out.

    Parameters
    ----------
    judged : JudgedCase
        A case with its verdicts.
    file : Path
        PNG or SVG by its ending.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with paper_style():
        profiles = judged.case.profiles
        columns = min(2, len(profiles))
        rows = ceil(len(profiles) / columns)
        figure = Figure(figsize=(_WIDTH * columns, _HEIGHT * rows + 0.7), layout="constrained")
        FigureCanvasAgg(figure)
        panels = figure.subplots(rows, columns, squeeze=False).ravel()
        shaded = [_panel(axes, profile, judged) for axes, profile in zip(panels, profiles, strict=False)]
        for axes in panels[len(profiles) :]:
            axes.set_axis_off()
        figure.suptitle("\n".join(filter(None, (judged.case.words, judged.case.key))), fontsize=10)
        _key(figure, panels[0], judged.case.method, shaded=any(shaded))
        file.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(file, dpi=110, metadata={"Software": GENERATOR})
    return file


def gaps_of(along: FloatArray) -> list[tuple[float, float]]:
    """Ends of the intervals of an ascending abscissa where points are left out.

    Examples
    --------
    >>> gaps_of(np.array([0.0, 1.0, 2.0, 6.0, 7.0]))
    [(2.0, 6.0)]
    """
    steps = np.diff(along)
    if steps.size < 3:
        return []
    wide = np.flatnonzero(steps > _GAP * np.median(steps))
    return [(float(along[k]), float(along[k + 1])) for k in wide]


def _drawn(profile: Profile, judged_case: JudgedCase) -> Curve | None:
    """The semi-analytical line: close points where the case has a curve, else the profile, broken at its gaps."""
    judged = judged_case.judged.get(profile.name)
    if judged is None:
        return None
    closely = judged_case.case.curve(profile)
    if closely is not None:
        return closely
    order = np.argsort(profile.along, kind="stable")
    along, values = profile.along[order], judged[order]
    breaks = [int(np.searchsorted(along, end)) for _, end in gaps_of(along)]
    return np.insert(along, breaks, np.nan), np.insert(values, breaks, np.nan, axis=0)


def _look(component: str, place: int) -> int:
    """Number of colour, symbol and dashes: a component looks the same in every panel."""
    for names in (VECTORS, STRESSES):
        if component in names:
            return names.index(component)
    return place % len(COLOURS)


def _panel(axes: Any, profile: Profile, judged: JudgedCase) -> bool:
    """Draw a profile; whether points were left out."""
    line, reference = _drawn(profile, judged), judged.estimates.get(profile.name)
    order = np.argsort(profile.along, kind="stable")
    step = max(1, ceil(len(order) / _DENSEST))
    for k, component in enumerate(profile.components):
        look = _look(component, k)
        style: dict[str, Any] = {"color": COLOURS[look], "label": component}
        if line is not None:
            axes.plot(line[0], line[1][:, k], linestyle=_DASHES[look], linewidth=1.3, **style)
            style["label"] = None
        if reference is not None:
            shown = order[(look % step) :: step]
            axes.errorbar(
                profile.along[shown], reference.value[shown, k], yerr=reference.uncertainty[shown, k],
                fmt=_SYMBOLS[look], markersize=4, markerfacecolor="none", markeredgewidth=0.8, capsize=2, linewidth=0.9,
                **style,
            )  # fmt: skip
    gaps = gaps_of(profile.along[order])
    for low, high in gaps:
        edge = 0.25 * float(np.median(np.diff(profile.along[order])))
        axes.axvspan(low + edge, high - edge, color=_GREY, linewidth=0, zorder=0)
    axes.axhline(0.0, color="0.8", linewidth=0.6, zorder=0.5)
    axes.set_title(profile.name, fontsize=9)
    axes.set_xlabel(profile.label)
    axes.set_ylabel(f"{profile.quantity} [{profile.unit or '1'}]")
    if line is not None or reference is not None:
        _limit(axes, profile, judged)
        axes.legend(fontsize=8, frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5), borderaxespad=0.2)
    return bool(gaps)


def _limit(axes: Any, profile: Profile, judged: JudgedCase) -> None:
    """Keep what is compared in sight of a line that goes far beyond it."""
    compared = [np.zeros((1, 1))]
    if profile.name in judged.judged:
        compared.append(judged.judged[profile.name])
    if profile.name in judged.estimates:
        reference = judged.estimates[profile.name]
        compared += [reference.value - reference.uncertainty, reference.value + reference.uncertainty]
    values = np.concatenate([array.ravel() for array in compared])
    values = values[np.isfinite(values)]
    low, high = float(values.min()), float(values.max())
    shown = axes.get_ylim()
    margin = _BEYOND * (high - low)
    if margin:
        axes.set_ylim(max(shown[0], low - margin), min(shown[1], high + margin))


def _key(figure: Any, axes: Any, method: str, *, shaded: bool) -> None:
    """Legend of line, symbols and shade, below all panels."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    line = Line2D([], [], color="0.2", linewidth=1.3)
    symbol = axes.errorbar(
        [], [], yerr=[], color="0.2", fmt="o", markersize=4, markerfacecolor="none", capsize=2, linewidth=0.9
    )
    entries = [(line, "semi-analytical"), (symbol, f"{method}, bars: $u_{{FE}}$")]
    if shaded:
        entries.append((Patch(color=_GREY), "source or its boundary: not compared"))
    handles, words = zip(*entries, strict=True)
    figure.legend(handles, words, loc="outside lower center", ncols=len(entries), fontsize=8.5, frameon=False)
