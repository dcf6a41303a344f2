"""Stored borders of inclusions, and outlines of inclusions and interfaces over a picture."""

from __future__ import annotations

import json
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.results.stored import widest_edge

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.style import Scale

    FloatArray = NDArray[np.float64]

__all__ = [
    "Coating",
    "coatings",
    "draw_interfaces",
    "draw_outline",
    "draw_outline_below",
    "draw_segments",
    "inclusion_segments",
    "paths_of",
]

#: Ends of segments closer than this part of the whole picture are one point.
POINT_TOLERANCE = 1e-7
#: A plane is drawn with the borders of the nearest stored one, no farther away than this part of a cell.
NEAR = 0.5001


def draw_outline(axes: Axes, dataset: Results, name: str, length: Scale) -> None:
    """Draw stored outlines, if any, dark on a light ground for contrast on every colour."""
    if name in dataset:
        draw_segments(axes, np.asarray(dataset[name].values, dtype=float), length)


def draw_segments(axes: Axes, segments: NDArray[Any], length: Scale) -> None:
    """Draw borders (n, 2, 2) [m], dark on a light ground."""
    _draw(axes, segments, length, ((1.8, "1.0", "-", 1.0), (0.8, "0.1", "-", 1.0)))


def draw_outline_below(axes: Axes, dataset: Results, length: Scale) -> None:
    """Draw the outlines from above of inclusions below the displayed surface, faint and dashed.

    Segments along the rim of the surface are left out.
    """
    if "outline" not in dataset:
        return
    segments = _without_rim(np.asarray(dataset["outline"].values, dtype=float), dataset)
    _draw(axes, segments, length, ((1.2, "1.0", "-", 0.35), (0.7, "0.15", (0, (4, 2.5)), 0.75)))


def _without_rim(segments: NDArray[Any], dataset: Results) -> NDArray[Any]:
    """Segments without those along the rim of the surface, where only the model of a layer ends."""
    cells = np.minimum(np.resize(np.atleast_1d(dataset.attrs["cell_size"]), 2), widest_edge(dataset))
    along_rim = np.zeros(len(segments), dtype=bool)
    for axis, cell in enumerate(cells):
        for rim in np.asarray(dataset["xy"[axis]].values, dtype=float)[[0, -1]]:
            along_rim |= (np.abs(segments[:, :, axis] - rim) <= 1.5 * cell).all(axis=1)
    return np.asarray(segments[~along_rim])


def draw_interfaces(axes: Axes, depths: tuple[float, ...], length: Scale) -> None:
    """Draw interfaces of layers at their depths [m] across a picture with z along its vertical."""
    for depth in depths:
        for width, colour in ((1.8, "1.0"), (0.8, "0.1")):
            line = axes.axhline(float(length(depth)), color=colour, linewidth=width, zorder=3, label="_interface")
            line.set_solid_capstyle("butt")


def _draw(axes: Axes, segments: NDArray[Any], length: Scale, strokes: tuple[Any, ...]) -> None:
    from matplotlib.collections import LineCollection

    paths = paths_of(length(segments))
    for width, colour, style, opacity in strokes:
        lines = LineCollection(
            paths, colors=colour, linewidths=width, linestyles=[style], alpha=opacity, capstyle="butt", zorder=3
        )
        axes.add_collection(lines, autolim=False)


def paths_of(segments: NDArray[Any]) -> list[NDArray[Any]]:
    """Join segments (number, end, coordinate), (n, 2, 2), at their ends to lines (m, 2), without duplicates.

    Closed lines end where they began.
    """
    if not len(segments):
        return []
    places = segments.reshape(-1, 2)
    unit = POINT_TOLERANCE * float(np.ptp(places, axis=0).max())
    _, first, number = np.unique(np.round(places / unit) + 0.0, axis=0, return_index=True, return_inverse=True)
    pairs = np.unique(np.sort(number.reshape(-1, 2), axis=1), axis=0)
    neighbours: dict[int, list[int]] = defaultdict(list)
    for a, b in pairs[pairs[:, 0] != pairs[:, 1]].tolist():
        neighbours[a].append(b)
        neighbours[b].append(a)
    # Ends of open lines come first; what is left then are closed ones.
    paths = []
    for start in sorted(neighbours, key=lambda point: len(neighbours[point]) % 2 == 0):
        while neighbours[start]:
            path = [start]
            while neighbours[path[-1]]:
                ahead = neighbours[path[-1]].pop()
                neighbours[ahead].remove(path[-1])
                path.append(ahead)
            paths.append(places[first[path]])
    return paths


@dataclass(frozen=True)
class Coating:
    """Inclusion at the surface of body 1 or 2: its index in the results, and its largest depth [m]."""

    number: int
    body: int
    bottom: float


def inclusion_segments(dataset: Results, body: int, normal: str, at: float, number: int | None = None) -> FloatArray:
    """Borders (n, 2, 2) [m] on a plane, of all inclusions of a body or of one, by its stored index.

    `normal` is the axis normal to the plane, `at` where the plane cuts it [m].
    """
    empty = np.empty((0, 2, 2))
    if "section_segments" not in dataset:
        return empty
    table = np.asarray(dataset["section_table"].values, dtype=float)
    numbers = [n for n, item in enumerate(_inclusions(dataset)) if item["body"] == body and number in (None, n)]
    table = table[np.isin(table[:, 0], numbers) & (table[:, 1] == "xyz".index(normal))]
    away = np.abs(table[:, 2] - at)
    if not away.size or away.min() > NEAR * widest_edge(dataset):
        return empty
    segments = np.asarray(dataset["section_segments"].values, dtype=float)
    sections = table[table[:, 2] == table[away.argmin(), 2]]
    return np.concatenate([segments[int(row[5]) : int(row[5] + row[6])] + row[3:5] for row in sections])


def coatings(dataset: Results) -> tuple[Coating, ...]:
    """Inclusions with stored borders that reach the surface of their body."""
    if "section_segments" not in dataset:
        return ()
    described = _inclusions(dataset)
    stored = [(int(n), described[int(n)]) for n in np.unique(dataset["section_table"].values[:, 0])]
    return tuple(Coating(n, item["body"], item["bounds"][1][2]) for n, item in stored if item["bounds"][0][2] <= 0.0)


def _inclusions(dataset: Results) -> list[dict[str, Any]]:
    return list(json.loads(dataset.attrs.get("inclusions", "[]")))
