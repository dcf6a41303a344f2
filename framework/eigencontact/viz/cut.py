"""Section for pictures: its points and values, their sides, and the visible part."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.lines import contact_runs
from eigencontact.viz.sides import Plane, sides_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from eigencontact.results.stored import Results

    FloatArray = NDArray[np.float64]
    Range = tuple[float, float]

__all__ = ["WHOLE", "Cut", "StepValues", "View", "VisiblePart"]

#: A section is framed around the contact and what reaches this part of the largest value,
MATTERS = 0.1
#: with this room around it,
ROOM = 0.15
#: unless so much of the section would be left out or more than this part of it stays anyway.
WORTH_IT = 0.6
#: A largest value is a plateau where more than this part of the points reach it.
PLATEAU = 0.05
#: Points reach the largest value within this part of it.
LEVEL = 0.02
#: A first row of points this many spacings below the surface is the middle of the first layer of cells.
FIRST_CELL = 0.75


@dataclass(frozen=True)
class StepValues:
    """Values at all points of a region, or all cells of the surface, in one step.

    Attributes
    ----------
    words, unit : str
        Name for titles and colour bars, and SI unit.
    values : array
        On the dimensions of the region.
    variable : str
        Variable of the results that holds it in all steps; empty where it is derived.
    errors : array, optional
        Estimated errors of the values.
    """

    words: str
    unit: str
    values: NDArray[Any]
    variable: str = ""
    errors: NDArray[Any] | None = None

    @property
    def text_of_zeros(self) -> str:
        """Text of a picture of zeros."""
        return "no stress" if self.unit == "Pa" else "zero everywhere"


@dataclass(frozen=True)
class View:
    """Options of a picture: visible range [m] and colour map; None by default."""

    horizontal: Range | None = None
    vertical: Range | None = None
    cmap: str | None = None


#: Nothing chosen.
WHOLE = View()


class Cut:
    """Values of a region of shape plane, or of a volume cut normal to y through its largest value.

    It is made of values on the dimensions of the region, which the results describe, after a step.

    Attributes
    ----------
    dims : (str, str)
        Vertical and horizontal axis.
    v, h : (m,), (n,)
        Places along them [m].
    values : (m, n)
        There; where the first row is the middle of a layer of cells, it is continued up to the surface.
    cut : dict
        Place [m] of the plane along its normal.
    sides : Sides
        Of the points.
    """

    def __init__(
        self, dataset: Results, region: str, described: Mapping[str, Any], values: NDArray[Any], step: int
    ) -> None:
        dims = list(described["dims"])
        places = {axis: f"{region}_{axis}" for axis in "xyz" if f"{region}_{axis}" in dataset.variables}
        self.cut = {axis: float(dataset[name]) for axis, name in places.items() if dataset[name].ndim == 0}
        if len(dims) == 3:
            largest = np.unravel_index(int(np.argmax(np.abs(np.nan_to_num(values)))), values.shape)
            at = int(largest[dims.index("y")])
            values = np.take(values, at, axis=dims.index("y"))
            self.cut["y"] = float(dataset[f"{region}_y"][at])
            dims.remove("y")
        self.dims: tuple[str, str] = (dims[0], dims[1])
        self.v, self.h = (np.asarray(dataset[f"{region}_{axis}"].values, dtype=float) for axis in self.dims)
        self.values = np.asarray(values, dtype=float)
        if self.dims[0] == "z" and self.v.size > 1 and 0 < self.v[0] <= FIRST_CELL * (self.v[1] - self.v[0]):
            self.v, self.values = np.append(0.0, self.v), np.concatenate([self.values[:1], self.values])
        name = f"{region}_outline"
        has_outline = len(described["dims"]) == 2 and name in dataset
        segments = np.asarray(dataset[name].values, dtype=float) if has_outline else np.empty((0, 2, 2))
        plane = Plane(int(described["body"]), self.dims, self.v, self.h)
        self.sides = sides_of(dataset, plane, segments, step)
        self.outlined = len(segments) > 0

    @property
    def normal(self) -> str:
        """Normal axis of the plane; empty if the results lack it."""
        return next((axis for axis in "xyz" if axis in self.cut), "")

    def largest(self, points: tuple[slice, slice]) -> tuple[int, int]:
        """Row and column of the largest magnitude among some points."""
        visible = np.full(self.values.shape, np.nan)
        visible[points] = self.values[points]
        return self.sides.largest(visible)

    def flat(self, points: tuple[slice, slice]) -> bool:
        """Whether the largest magnitude among some points belongs to a plateau."""
        size = np.abs(np.where(self.sides.trusted, self.values, np.nan)[points])
        share = np.mean(size >= (1.0 - LEVEL) * np.nanmax(size)) if np.isfinite(size).any() else 0.0
        return bool(share > PLATEAU)


@dataclass(frozen=True)
class VisiblePart:
    """Visible part of a section: its limits [m], the smaller first, and rows and columns of its points."""

    horizontal: Range
    vertical: Range
    points: tuple[slice, slice]

    @property
    def size(self) -> Range:
        """Width and height [m]."""
        return self.horizontal[1] - self.horizontal[0], self.vertical[1] - self.vertical[0]

    def clipped(self, runs: FloatArray) -> FloatArray:
        """Visible parts of runs along the horizontal."""
        clipped_runs = np.clip(runs, *self.horizontal)
        return np.asarray(clipped_runs[clipped_runs[:, 1] > clipped_runs[:, 0]])

    @staticmethod
    def of(dataset: Results, section: Cut, view: View, step: int, *, framed: bool) -> VisiblePart:
        """Limits of a section: those of the user, else those of its large values or of the whole section."""
        h, v = section.h, section.v
        limits = ((float(h[0]), float(h[-1])), (float(v[0]), float(v[-1])))
        if view.horizontal is None and view.vertical is None:
            ends = _framed(dataset, section, step, limits) if framed else limits
        else:
            ends = (view.horizontal or limits[0], view.vertical or limits[1])
        return VisiblePart(*ends, (_within(v, ends[1]), _within(h, ends[0])))


def _framed(dataset: Results, section: Cut, step: int, limits: tuple[Range, Range]) -> tuple[Range, Range]:
    """Frame of the contact and large values with some room; the whole section where the frame saves little."""
    size = np.where(section.sides.whole, np.abs(np.nan_to_num(section.values)), 0.0)
    matters = size >= MATTERS * size.max()
    if not size.any():
        return limits
    rows, columns = (np.flatnonzero(matters.any(axis=axis)) for axis in (1, 0))
    left, right = float(section.h[columns[0]]), float(section.h[columns[-1]])
    top, bottom = float(section.v[rows[0]]), float(section.v[rows[-1]])
    runs = contact_runs(dataset, step, section.normal, section.cut.get(section.normal, 0.0))
    if section.dims[0] == "z":
        if len(runs):
            left, right = min(left, float(runs.min())), max(right, float(runs.max()))
        top = limits[1][0]
    room = ROOM * max(right - left, bottom - top)
    across = (max(limits[0][0], left - room), min(limits[0][1], right + room))
    down = (max(limits[1][0], top - room), min(limits[1][1], bottom + room))
    framed_area = (across[1] - across[0]) * (down[1] - down[0])
    whole_area = (limits[0][1] - limits[0][0]) * (limits[1][1] - limits[1][0])
    return (across, down) if 0 < framed_area <= WORTH_IT * whole_area else limits


def _within(places: FloatArray, ends: Range) -> slice:
    """Points between two limits; the nearest point if there is none."""
    slack = 1e-9 * float(np.ptp(places))
    inside = np.flatnonzero((places >= ends[0] - slack) & (places <= ends[1] + slack))
    if not inside.size:
        inside = np.array([np.abs(places - 0.5 * sum(ends)).argmin()])
    return slice(int(inside[0]), int(inside[-1]) + 1)
