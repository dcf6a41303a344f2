"""Regions of a scene at whose points fields below the surface are computed."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from eigencontact.scene.checks import at_least, in_range, non_negative
from eigencontact.scene.table import Depth, FiniteLength, PositiveLength, Table

__all__ = ["StressRequest"]


class StressRequest(Table):
    """Region of points with stored fields below the surface.

    z is the depth into `body`. In a body that yields the points lie by default at the centres of its cells, because
    eigenstrain is uniform in each cell.

    A point at an interface of a layered body belongs to the deeper layer; a point 1e-9 of the depth above it belongs to
    the upper layer. At depths of less than a quarter of a cell below a surface that is not periodic, the stress by
    tractions is the mean over each surface cell, interpolated linearly between their centres
    (`eigencontact.solvers.surface_means`).

    A region with finer points needs no new solution: its fields follow from the tractions and eigenstrains of the
    cells.

    Parameters
    ----------
    name : str, optional
        Name of the region in results and pictures; by default made of its shape and body.
    shape : {"plane", "volume", "line", "points"}
        ``plane`` is normal to x, y or z through `position`; ``volume`` is the window down to the depths; ``line`` runs
        from `start` to `end`; ``points`` are listed.
    body : {1, 2}
        Half-space that contains the region.
    normal : {"x", "y", "z"}
        Normal of a plane.
    position : float, optional
        Coordinate of a plane along its normal [m]; 0 by default, or the centre of the inclusion `around`.
    depths : list of float, optional
        Depths of the points of a volume or upright plane [m].
    depth_max : float, optional
        Largest depth [m] of equally spaced depths from the surface.
    depth_cells : int, optional
        Number of steps down to `depth_max`; 48 by default.
    start : (float, float, float), optional
        First point (x, y, depth) of a line [m]; corner that restricts a plane or volume in x and y.
    end : (float, float, float), optional
        Last point of a line [m]; opposite corner.
    count : int
        Number of points of a line.
    points : list of (float, float, float), optional
        Points (x, y, depth) [m].
    around : str, optional
        Name of an inclusion: restricts a plane or volume to the box around the inclusion with a margin of `room`.
    room : float
        Margin around the inclusion, in sizes of the inclusion.
    refinement : int, optional
        Points per cell edge in x and y; 8 by default around an inclusion, else 1.
    fields : list of {"stress", "strain", "displacement"}
        Stored fields. The displacement is relative to distant points of the body; in a periodic window it is relative
        to the mean of the surface.
    quantities : list of {"von_mises", "tresca", "principal", "hydrostatic"}
        Stored scalars of the stress.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")] = ""
    shape: Literal["plane", "volume", "line", "points"]
    body: Literal[1, 2] = 1
    normal: Literal["x", "y", "z"] = "y"
    position: FiniteLength | None = None
    depths: list[Depth] | None = None
    depth_max: PositiveLength | None = None
    depth_cells: Annotated[int, AfterValidator(at_least(1))] | None = None
    start: tuple[FiniteLength, FiniteLength, Depth] | None = None
    end: tuple[FiniteLength, FiniteLength, Depth] | None = None
    count: Annotated[int, AfterValidator(in_range(2, 1e7, "points"))] = 64
    points: list[tuple[FiniteLength, FiniteLength, Depth]] | None = None
    around: str | None = None
    room: Annotated[float, AfterValidator(non_negative("sizes of the inclusion"))] = 0.5
    refinement: Annotated[int, AfterValidator(at_least(1))] | None = None
    fields: list[Literal["stress", "strain", "displacement"]] = Field(["stress"], min_length=1)
    quantities: list[Literal["von_mises", "tresca", "principal", "hydrostatic"]] = Field(["von_mises"])

    @model_validator(mode="after")
    def _determined(self) -> StressRequest:
        deep = self.shape == "volume" or (self.shape == "plane" and self.normal != "z")
        if self.shape not in ("plane", "volume") and (self.around or self.refinement):
            raise ValueError(f"a plane or volume with around or refinement (a {self.shape} has points of its own)")
        if self.around is not None:
            conflicting = [name for name in ("depths", "depth_max", "start", "end") if getattr(self, name) is not None]
            if conflicting:
                raise ValueError(f"given around alone: leave out {', '.join(conflicting)}".replace("_", "-"))
            return self
        if self.shape in ("plane", "volume") and (self.start is None) != (self.end is None):
            raise ValueError("given both start and end, or neither")
        if deep and (self.depths is None) == (self.depth_max is None):
            raise ValueError(f"given depths or depth-max (a {self.shape} needs one of them)")
        if deep and self.depths is not None and not self.depths:
            raise ValueError("given at least one depth")
        if self.depths is not None and not all(low < high for low, high in pairwise(self.depths)):
            raise ValueError("given depths that ascend, each once")
        if self.shape == "plane" and self.normal == "z" and self.at < 0:
            raise ValueError("at a depth (position) of 0 or more")
        if self.shape == "line" and (self.start is None or self.end is None):
            raise ValueError("given start and end (a line needs both)")
        if self.shape == "points" and not self.points:
            raise ValueError("given points")
        return self

    @property
    def depth_steps(self) -> int:
        """Steps down to ``depth_max``."""
        return 48 if self.depth_cells is None else self.depth_cells

    @property
    def at(self) -> float:
        """Position of a plane along its normal [m]; 0 by default."""
        return 0.0 if self.position is None else self.position

    @property
    def label(self) -> str:
        """Name of the region in the results."""
        return self.name or f"{self.shape}_{self.normal if self.shape == 'plane' else 'body'}{self.body}"
