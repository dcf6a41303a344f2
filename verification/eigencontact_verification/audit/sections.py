"""Pictures of the stored planes of stress: what is stored, what the elements say, and their difference."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.lines import Middle, judged_points, spread
from eigencontact_verification.crosscheck.lines import STRESSES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eigencontact_verification.audit.bodies import AuditedBody
    from eigencontact_verification.audit.stored import StoredStep

__all__ = ["Section", "draw_section", "sections_of"]

FloatArray = NDArray[np.float64]

#: Most points of a section along an axis.
_MOST = 48
_MAP, _LEFT_OUT = "RdBu_r", "0.85"


@dataclass(frozen=True, kw_only=True, eq=False)
class Section:
    """Stored stress in a plane.

    Attributes
    ----------
    name : str
        Of the region.
    body : int
        1 or 2.
    axes : (str, str)
        Directions of the first and second axis of the arrays below: ``("z", "x")``.
    points : (m, n, 3) float64
        Places [m].
    values : (m, n, 6) float64
        xx, yy, zz, yz, xz, xy [Pa]; nan where the audit does not judge.
    """

    name: str
    body: int
    axes: tuple[str, str]
    points: FloatArray
    values: FloatArray


def sections_of(stored: StoredStep, bodies: Sequence[AuditedBody], middle: Middle) -> tuple[Section, ...]:
    """Every stored plane of stress, thinned."""
    numbers, sections = {body.number: body for body in bodies}, []
    for region in stored.regions:
        if region.shape != "plane" or region.body not in numbers or len(region.axes) != 2:
            continue
        fit, _ = judged_points(stored, region, numbers[region.body], middle)
        values = np.where(fit[..., None], region.stress, np.nan)
        picked = np.ix_(*(spread(np.arange(n), _MOST) for n in fit.shape))
        if np.isfinite(values[picked]).any():
            axes = (region.axes[0], region.axes[1])
            sections.append(
                Section(
                    name=region.name, body=region.body, axes=axes, points=region.points[picked], values=values[picked]
                )
            )  # fmt: skip
    return tuple(sections)


def draw_section(section: Section, elements: FloatArray, words: str, file: Path) -> Path:
    """Draw the component that is largest in three panels of one scale.

    Parameters
    ----------
    section : Section
    elements : (m, n, 6) float64
        Stress by finite elements at its points [Pa].
    words : str
        Above the figure.
    file : Path
        PNG.
    """
    from eigencontact.viz.style import box_size, label_plane, new_figure, paper_style, scale_for

    sizes = np.nanmax(np.abs(section.values), axis=(0, 1))
    place = int(np.argmax(sizes))
    stored = section.values[..., place]
    reference = np.where(np.isfinite(stored), elements[..., place], np.nan)
    difference = reference - stored
    down, across = section.axes
    lines = {
        name: np.moveaxis(section.points, axis, 0)[:, 0, "xyz".index(name)] for axis, name in enumerate(section.axes)
    }
    fixed = next(name for name in "xyz" if name not in section.axes)
    length, stress = scale_for(np.concatenate(list(lines.values())), "m"), scale_for(sizes[place], "Pa")
    edges = {name: length(_edges(line)) for name, line in lines.items()}
    width, height = box_size(np.ptp(edges[across]), np.ptp(edges[down]), largest=(3.2, 3.2))
    top, worst = stress(sizes[place]), 100.0 * np.nanmax(np.abs(difference)) / sizes[place]
    with paper_style():
        figure = new_figure(3 * width + 2.2, height + 1.3)
        panels = figure.subplots(1, 3, sharey=True)
        shown = []
        titles = ("stored", "finite elements", f"difference, at most {worst:.2g} %")
        for axes, values, title in zip(panels, (stored, reference, difference), titles, strict=True):
            axes.set_facecolor(_LEFT_OUT)
            looks = {"cmap": _MAP, "vmin": -top, "vmax": top, "rasterized": True}
            shown.append(axes.pcolormesh(edges[across], edges[down], stress(values), **looks))
            axes.set_aspect("equal")
            if down == "z":
                axes.set_ylim(edges[down][-1], edges[down][0])
            label_plane(axes, f"{across} [{length.unit}]", f"{down} [{length.unit}]" if axes is panels[0] else "")
            axes.set_title(title)
        component = STRESSES[place].removeprefix("s_")
        figure.colorbar(shown[0], ax=list(panels), label=rf"$\sigma_{{{component}}}$ [{stress.unit}]", fraction=0.03)
        at = length(section.points[0, 0, "xyz".index(fixed)])
        figure.suptitle(
            f"{words}\n'{section.name}' in body {section.body}, {fixed} = {at:.3g} {length.unit}; "
            "grey: not judged or not stored",
            fontsize=9,
        )
        file.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(file, dpi=140)
    return file


def _edges(middles: FloatArray) -> FloatArray:
    """Edges of cells around points of a line that rises; the first and the last cell are as wide as their neighbours.

    Examples
    --------
    >>> _edges(np.array([0.0, 1.0, 3.0])).tolist()
    [-0.5, 0.5, 2.0, 4.0]
    """
    between = 0.5 * (middles[1:] + middles[:-1])
    return np.concatenate([[2 * middles[0] - between[0]], between, [2 * middles[-1] - between[-1]]])
