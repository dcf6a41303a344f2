"""Variables of a results file, and stored borders of inclusions for pictures: on planes, and along lines."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

__all__ = ["LineBorders", "Section", "Variable", "border_variables", "line_variables"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, slots=True)
class Section:
    """Border of one inclusion on one plane.

    Attributes
    ----------
    inclusion : int
        Position in `eigencontact.results.records.RunInfo.inclusions`.
    normal, place : str, float
        Axis normal to the plane, and where the plane cuts it [m].
    origin : (float, float)
        Horizontal and vertical place [m] from which the segments count.
    segments : (n, 2, 2) array
        Segments [m], places in the order horizontal, vertical of a picture.
    """

    inclusion: int
    normal: str
    place: float
    origin: tuple[float, float]
    segments: FloatArray


@dataclass(frozen=True, kw_only=True, slots=True)
class LineBorders:
    """Inclusions at the points of a line region.

    Attributes
    ----------
    inclusion : (n,) int
        Number of the inclusion that holds each point, 0 outside of all.
    border : (n,)
        Distance of a border between each point and the next, in parts of their distance; NaN where there is none.
    uncut : (n,) bool
        Points on no border and in no cell that a border cuts.
    """

    inclusion: NDArray[np.intp]
    border: FloatArray
    uncut: NDArray[np.bool_]


def border_variables(sections: Sequence[Section]) -> Iterator[Variable]:
    """Variables for all sections: a table of sections, and the segments, which copies of one inclusion share."""
    if not sections:
        return
    first, count, shared = dict[int, int](), 0, list[FloatArray]()
    for section in sections:
        if id(section.segments) not in first:
            first[id(section.segments)] = count
            shared.append(section.segments)
            count += len(section.segments)
    rows = [
        (s.inclusion, "xyz".index(s.normal), s.place, *s.origin, first[id(s.segments)], len(s.segments))
        for s in sections
    ]
    columns = "inclusion, normal axis, place along it, origin of the segments, first segment, number of segments"
    yield Variable(
        name="section_table",
        dims=("section", "section_column"),
        values=np.array(rows, dtype=float),
        attrs={"role": "outline", "units": "1", "long_name": f"borders of inclusions on planes, SI: {columns}"},
    )
    yield Variable(
        name="section_segments",
        dims=("section_segment", "end", "place"),
        values=np.concatenate(shared),
        attrs={"role": "outline", "units": "m", "long_name": "borders of inclusions on planes, from their origin"},
    )


def line_variables(lines: Mapping[str, LineBorders]) -> Iterator[Variable]:
    """Variables for the points of lines."""
    for region, line in lines.items():
        columns = {
            "inclusion": (line.inclusion, "number of the inclusion that holds the point, 0 outside of all"),
            "border": (line.border, "distance of a border in parts of the distance to the next point"),
            "uncut": (line.uncut.astype(int), "1 at points on no border and in no cell that a border cuts"),
        }
        for name, (values, meaning) in columns.items():
            attrs: dict[str, str | int] = {"role": "outline", "units": "1", "long_name": meaning, "region": region}
            yield Variable(name=f"{region}_{name}", dims=(f"{region}_point",), values=values, attrs=attrs)


@dataclass(kw_only=True, slots=True)
class Variable:
    """Array of a results file: its dimensions (``step`` first if it changes), values and attributes."""

    name: str
    dims: tuple[str, ...]
    values: NDArray[Any]
    attrs: dict[str, str | int] = field(default_factory=dict)
