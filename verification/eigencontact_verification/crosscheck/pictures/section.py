"""Section through source and body: finite elements on one side, closed forms on the other."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.pictures.subject import (
    MAP,
    MAP_ERROR,
    OUTLINE_COLOUR,
    OUTLINE_SAMPLES,
    Subject,
    elements_in_words,
    outline,
)
from eigencontact_verification.fem.model import von_mises

__all__ = ["CELLS", "SAMPLES", "SAMPLES_CUT", "draw_section"]

FloatArray = NDArray[np.float64]

#: Samples across the shown part: by closed forms, and by so many cells.
SAMPLES, SAMPLES_CUT, CELLS = 120, 40, 8
#: Colours end where this part of the section is below: stress is infinite at edges.
_BRIGHTEST = 0.995


def draw_section(subject: Subject, solution: Any, file: Path) -> None:
    """Von Mises stress in the plane y = 0: elements at x < 0, closed forms at x > 0; and their difference at x > 0."""
    from eigencontact.viz.style import label_plane, new_figure, paper_style

    _, (wide, _, deep) = subject.window
    cell = wide / subject.samples
    x, z = (np.arange(subject.samples) + 0.5) * cell, (np.arange(int(np.ceil(deep / cell))) + 0.5) * cell
    points = np.stack([np.tile(x, z.size), np.zeros(x.size * z.size), np.repeat(z, x.size)], axis=1)
    with np.errstate(all="ignore"):
        closed = von_mises(subject.field(points, "stress")).reshape(z.size, x.size)
    elements, right = (von_mises(solution.stress(points * [s, 1, 1])).reshape(closed.shape) for s in (-1.0, 1.0))
    top = float(np.nanquantile(closed, _BRIGHTEST))
    error = 100 * np.abs(right - closed) / top
    worst = max(1.0, float(np.nanquantile(error, 0.98)))
    across, down = cell * np.arange(x.size + 1), cell * np.arange(z.size + 1)
    scale = min(3.0 / deep, 2.2 / wide)  # inch a unit of length
    with paper_style():
        figure = new_figure(3 * wide * scale + 2.9, deep * scale + 1.35)
        largest, half = figure.subplots(1, 2, width_ratios=(2, 1.05))
        looks = {"cmap": MAP, "vmin": 0.0, "vmax": top, "rasterized": True}
        largest.pcolormesh(-across[::-1], down, elements[:, ::-1], **looks)
        stress = largest.pcolormesh(across, down, closed, **looks)
        wrong = half.pcolormesh(across, down, error, cmap=MAP_ERROR, vmin=0.0, vmax=worst, rasterized=True)
        largest.axvline(0.0, color="white", linewidth=1.0)
        for axes, low in ((largest, -wide), (half, 0.0)):
            sides = [np.linspace(low, wide, 2 * OUTLINE_SAMPLES), np.linspace(0.0, deep, 2 * OUTLINE_SAMPLES)]
            for line in outline(subject.contains, 1, 0.0, sides):
                axes.plot(line[:, 0], line[:, 2], color=OUTLINE_COLOUR, linewidth=1.2)
            if subject.high[2] - subject.low[2] < 0.1 * cell:  # a traction
                ends = [max(low, float(subject.low[0])), float(subject.high[0])]
                axes.plot(ends, [0.0, 0.0], color=OUTLINE_COLOUR, linewidth=4.0, clip_on=False)
            axes.set_aspect("equal")
            axes.set_xlim(low, wide)
            axes.set_ylim(deep, 0.0)
            label_plane(axes, f"x [{subject.length}]", f"z [{subject.length}]")
        cells = f", {CELLS} cells across" if subject.samples == SAMPLES_CUT else ""
        largest.set_title(f"finite elements   |   semi-analytical{cells}")
        half.set_title("their difference")
        for axes, shown, inches, words in (
            (largest, stress, 2 * wide * scale, f"von Mises stress [{subject.stress}]"),
            (half, wrong, wide * scale, f"[% of {top:.3g} {subject.stress}]"),
        ):
            beside = axes.inset_axes((1 + 0.1 / inches, 0.0, 0.12 / inches, 1.0))
            figure.colorbar(shown, cax=beside, label=words, extend="max")
        figure.suptitle(f"{subject.case.words}\n{elements_in_words(solution)}, plane y = 0", fontsize=8.5)
        figure.savefig(file, dpi=200)
