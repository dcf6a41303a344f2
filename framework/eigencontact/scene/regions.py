"""Regions of a scene at whose points fields below the surface are computed."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from eigencontact.scene.checks import at_least, in_range, non_negative
from eigencontact.scene.table import Depth, FiniteLength, PositiveLength, Table

__all__ = ["StressRequest"]


class StressRequest(Table):
    """Points at which sub-surface fields are wanted.

    z is the depth into `body`. In a body that yields the points lie by default in the middles of its cells, as
    eigenstrain is uniform in each of them.

    At the depth of an interface of a layered body the deeper layer counts; a part in 1e9 above it is the upper one.
    Less than a quarter of a cell below a surface that is not periodic, stress by tractions is a mean over each cell,
    linear between their centres (`eigencontact.solvers.surface_means`).

    Close up nothing is solved again: the fields are those of the tractions and eigenstrains found on the cells.

    Parameters
    ----------
    name : str, optional
        Name of the region in results and pictures; by default made of its shape and body.
    shape : {"plane", "volume", "line", "points"}
        ``plane`` is normal to x, y or z through `position`; ``volume`` is the window down to the depths; ``line`` runs
        from `start` to `end`; ``points`` are listed.
    body : {1, 2}
        The half-space that the region lies in.
    normal : {"x", "y", "z"}
        Normal of a plane.
    position : float, optional
        Place of a plane along its normal [m]; 0 by default, around an inclusion its middle.
    depths : list of float, optional
        Depths of the points of a volume or upright plane [m].
    depth_max : float, optional
        Largest of them [m], in steps from the surface on.
    depth_cells : int, optional
        Steps down to `depth_max`; 48 by default.
    start : (float, float, float), optional
        Point (x, y, depth) where a line begins [m]; corner to which a plane or volume is cut in x and y.
    end : (float, float, float), optional
        Point where a line ends [m]; the other corner.
    count : int
        Points of a line.
    points : list of (float, float, float), optional
        Points (x, y, depth) [m].
    around : str, optional
        Name of an inclusion: a plane or volume is cut to the box around the inclusion and some `room`.
    room : float
        Room around that inclusion, in its sizes.
    refinement : int, optional
        Points to an edge of a cell in x and y; 8 by default around an inclusion, else 1.
    fields : list of {"stress", "strain", "displacement"}
        What is stored; the displacement is that against distant points of the body, in a periodic window against the
        mean of its surface.
    quantities : list of {"von_mises", "tresca", "principal", "hydrostatic"}
        What is read off the stress and stored beside it.
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
            beside = [name for name in ("depths", "depth_max", "start", "end") if getattr(self, name) is not None]
            if beside:
                raise ValueError(f"given around alone: leave out {', '.join(beside)}".replace("_", "-"))
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
        """Place of a plane along its normal [m]; 0 where it is not given."""
        return 0.0 if self.position is None else self.position

    @property
    def label(self) -> str:
        """Name of the region in the results."""
        return self.name or f"{self.shape}_{self.normal if self.shape == 'plane' else 'body'}{self.body}"
