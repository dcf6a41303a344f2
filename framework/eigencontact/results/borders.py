"""Borders of inclusions that results store for pictures: on planes through them, and along line regions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.results.variable import Variable

__all__ = ["LineBorders", "Section", "border_variables", "line_variables"]

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
    segments : (n, 2, 2) array
        Segments [m], places in the order horizontal, vertical of a picture.
    """

    inclusion: int
    normal: str
    place: float
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
    """Variables for all sections: their segments, and inclusion, normal and place of each segment."""
    if not sections:
        return
    counts = [len(section.segments) for section in sections]
    columns: dict[str, tuple[Any, str, str]] = {
        "inclusion": ([section.inclusion for section in sections], "1", "position among the inclusions"),
        "normal": (["xyz".index(section.normal) for section in sections], "1", "axis normal to the plane, 0 is x"),
        "place": ([section.place for section in sections], "m", "place of the plane along its normal"),
    }
    yield Variable(
        name="section_segments",
        dims=("section_segment", "end", "place"),
        values=np.concatenate([section.segments for section in sections]),
        attrs={"role": "outline", "units": "m", "long_name": "borders of inclusions on planes"},
    )
    for name, (values, unit, meaning) in columns.items():
        attrs: dict[str, str | int] = {"role": "outline", "units": unit, "long_name": f"{meaning}, of each segment"}
        yield Variable(
            name=f"section_segments_{name}", dims=("section_segment",), values=np.repeat(values, counts), attrs=attrs
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
