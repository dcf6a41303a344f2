"""Tables ``[grid]`` and ``[numerics]`` of a scene."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, model_validator

from eigencontact.core.grid import Grid
from eigencontact.core.units import LARGEST
from eigencontact.scene.checks import (
    at_least,
    both_alike,
    boundary_of_axes,
    in_range,
    non_negative,
)
from eigencontact.scene.table import FiniteLength, PositiveLength, Table
from eigencontact.scene.whole import Whole, uniform_or_given

__all__ = ["MOST_REFINED", "GridSpec", "Numerics"]

#: Finer cells along the edge of a cell at an inclusion, at most.
MOST_REFINED = 8


def _division(value: object) -> object:
    """Check a number of finer cells along the edge of a cell."""
    if value != "auto" and (type(value) is not int or not 1 <= value <= MOST_REFINED):
        raise ValueError(f'a whole number of finer cells along an edge from 1 to {MOST_REFINED}, or "auto"')
    return value


class GridSpec(Table):
    """Cells of the window: two of cells, size and spacing, or an automatic grid by the size of the contact.

    Without a contact an automatic grid follows the inclusions: see `eigencontact.model.regions`. ``grid = "auto"`` is
    the grid without any key.

    A grid of infinite length makes a line contact in plane strain: its cells are strips along y, geometries contribute
    their profile at y = 0, and loads, work and areas are per metre of the length.

    Parameters
    ----------
    cells : int or (int, int), optional
        Number of cells along x and y.
    size : float or (float, float), optional
        Extent of the window along x and y [m].
    spacing : float or (float, float), optional
        Edges of a cell along x and y [m].
    center : (float, float)
        Centre of the window [m].
    cells_per_contact_radius : float
        Automatic grid: cells from the centre of the largest contact to the nearest point of its edge.
    margin : float
        Automatic grid: extent of the window relative to the extent of the largest contact.
    length : "infinite", optional
        Length of the contact along y. ``"infinite"`` makes a line contact; `cells`, `size` and `spacing` are then those
        along x.
    datum_depth : float, optional
        Datum depth [m] of a line contact, and of a window that is periodic along y only: displacements are relative to
        the points of each body at this depth, by default the width of the window. Displacements grow without limit with
        the distance there, so a prescribed approach needs this depth.
    """

    cells: Annotated[tuple[int, int] | None, BeforeValidator(both_alike)] = None
    size: Annotated[tuple[PositiveLength, PositiveLength] | None, BeforeValidator(both_alike)] = None
    spacing: Annotated[tuple[PositiveLength, PositiveLength] | None, BeforeValidator(both_alike)] = None
    center: tuple[FiniteLength, FiniteLength] = (0.0, 0.0)
    cells_per_contact_radius: Annotated[float, AfterValidator(at_least(1.0))] = 32.0
    margin: Annotated[float, AfterValidator(at_least(1.0))] = 1.5
    length: Literal["infinite"] | None = None
    datum_depth: PositiveLength | None = None

    @model_validator(mode="before")
    @classmethod
    def _auto(cls, value: Any) -> Any:
        if value == "auto":
            return {}
        return value

    @model_validator(mode="after")
    def _determined(self) -> GridSpec:
        sizes = [name for name in ("cells", "size", "spacing") if getattr(self, name) is not None]
        if sizes and len(sizes) != 2:
            raise ValueError(f"two of cells, size, spacing, or none of them for an automatic grid; given: {sizes}")
        if self.cells is not None and min(self.cells) < 1:
            raise ValueError("of at least 1 cell each way")
        if self.cells is not None and max(self.cells) > LARGEST:
            raise ValueError(f"of at most {LARGEST:g} cells each way")
        if self.line:
            pairs = {name: getattr(self, name) for name in ("cells", "size", "spacing")}
            wrong = next((name for name, pair in pairs.items() if pair is not None and pair[0] != pair[1]), None)
            if wrong is not None:
                raise ValueError(f"of one value of {wrong}, that along x, with length = 'infinite'")
            if self.center[1] != 0.0:
                raise ValueError("centred at y = 0 with length = 'infinite'")
        return self

    @property
    def line(self) -> bool:
        """Whether the cells are strips without end along y."""
        return self.length is not None

    def with_cells(self, nx: int, ny: int, dx: float, dy: float, center: tuple[float, float]) -> Grid:
        """Grid of the kind that the table selects: see `Grid.of`."""
        return Grid.of(nx, ny, dx, dy, center, line=self.line)

    @property
    def automatic(self) -> bool:
        """Whether the planner chooses the grid."""
        return self.cells is None and self.size is None


class Numerics(Table):
    """Numerical settings: accuracy, time and memory. The defaults are accurate.

    Parameters
    ----------
    half_space : {"exact", "full-space", "image-pressure", "periodic"}
        Treatment of the free surface in the fields of eigenstrain. ``"exact"``: closed forms. ``"image-pressure"``:
        a pressure makes the centres of the surface cells free of normal stress. ``"periodic"``: the window repeats.
        ``"full-space"``: no surface.
    inclusion_cells : int
        Cells along z across a region that the program divides into cells: a shape without potentials, or an eigenstrain
        that is not uniform.
    inclusion_resolution : {"cells", "whole"} or Whole
        Discretisation of an inhomogeneity. ``"cells"``: one eigenstrain per cell. ``{ whole = 4 }`` or ``{ whole =
        "auto" }``: one polynomial eigenstrain for the whole region (spheres and ellipsoids; more accurate than cells,
        and cheaper). ``"whole"`` is ``{ whole = 0 }``, one uniform eigenstrain (also for cuboids; for regions far from
        the surface and from each other).
    inclusion_pitch : float, optional
        Height of the cells of inhomogeneities [m]; by default it follows the grid and the shapes.
    inclusion_refinement : int or "auto"
        Divides the cells of a body at its inclusions, and two cells around them, this many times along each edge. For
        bodies with a law that is not linear: strain in thin layers around a hard inclusion needs finer cells than the
        contact. ``"auto"`` takes the smallest number up to 4 for which the error by these cells is within 2 % of each
        main result of the contact, from two runs on coarse cells before the run; with an accuracy, what its targets
        need.
    law_room : float
        Margin of the box of cells around the part of a body that may exceed its elastic range, in sizes of this part.
        The program adds cells if the box is too small.
    boundary : {"non-periodic", "periodic", "periodic-y"}
        Boundary of the window: a single window on the half-space, periodic along x and y, or periodic along y only. A
        pair such as ``["non-periodic", "periodic"]`` sets the axes x and y.
    coupling : {"none", "partial", "one-way", "full"}
        Displacements by tractions in a contact with friction. ``"none"``: each displacement by the traction in its own
        direction (directions without load and motion are left out). ``"partial"``: also x by y and y by x.
        ``"one-way"``: also x and y by the pressure (Goodman's approximation: the shear has no effect on the pressure).
        ``"full"``: all. Every level includes the tangential displacement by prescribed and plastic eigenstrain.
    precision : {"double", "single", "auto"}
        Precision of transforms and their fields. ``"auto"`` uses single precision in each operator whose round-off,
        measured when the scene is planned, is below the tolerance; this saves half of the memory and up to half of the
        time, and `explain` lists the choice with the reason. ``"single"`` uses it in all operators; some tolerances are
        then out of reach.
    tolerance : float
        Residual at which a solver ends, relative to the deflection or the stress that drives it.
    max_iterations : int
        Largest number of iterations of a solver; the run fails if it exceeds this number.
    threads : int, optional
        Threads of transforms and loops; the number of processors by default.
    plastic_error : float, optional
        Largest difference in strain between a load step and its two halves. The program halves load steps in which
        cells yield until the difference is within this fraction (five times at most; ``plastic_error`` of a step is the
        remaining difference). The check costs three times the work of a step, and nothing in elastic steps. Without
        this key the steps are those of the scene.
    cloud_tolerance : float
        Error allowed in the field of many inclusions at many points, relative to its largest value: the program sums
        distant inclusions by expansions. 0 sums all inclusions one by one.
    allow_contact_at_edge : bool
        Accepts a contact that reaches the edge of the window; tractions outside the window are then missing.
    allow_coarse : bool
        Accepts cells that are too coarse for the contact or for a region inside a body; the results then have a
        warning.
    """

    half_space: Literal["exact", "full-space", "image-pressure", "periodic"] = "exact"
    inclusion_cells: Annotated[int, AfterValidator(at_least(1))] = 16
    inclusion_resolution: Annotated[Literal["cells"] | Whole, BeforeValidator(uniform_or_given)] = "cells"
    inclusion_pitch: PositiveLength | None = None
    inclusion_refinement: Annotated[
        Literal["auto"] | Annotated[int, AfterValidator(in_range(1, MOST_REFINED, "finer cells along an edge"))],
        BeforeValidator(_division),
    ] = 1
    law_room: Annotated[float, AfterValidator(non_negative("sizes of what yields"))] = 0.1
    boundary: Annotated[Literal["non-periodic", "periodic", "periodic-y"], BeforeValidator(boundary_of_axes)] = (
        "non-periodic"
    )
    coupling: Literal["none", "partial", "one-way", "full"] = "full"
    precision: Literal["double", "single", "auto"] = "double"
    tolerance: Annotated[float, AfterValidator(in_range(1e-13, 0.1, "[-]"))] = 1e-6
    max_iterations: Annotated[int, AfterValidator(at_least(1))] = 500
    threads: Annotated[int, AfterValidator(in_range(1, 1024, "threads"))] | None = None
    plastic_error: Annotated[float, AfterValidator(in_range(1e-6, 1.0, "[-]"))] | None = None
    cloud_tolerance: Annotated[float, AfterValidator(in_range(0.0, 0.01, "[-]"))] = 1e-6
    allow_contact_at_edge: bool = False
    allow_coarse: bool = False

    @property
    def refinement(self) -> int:
        """Division of cells at inclusions; 1 until the program has chosen it."""
        return 1 if self.inclusion_refinement == "auto" else self.inclusion_refinement

    @property
    def in_cells(self) -> bool:
        """Whether each cell of an inhomogeneity has its own eigenstrain."""
        return self.inclusion_resolution == "cells"

    @property
    def repeats_y(self) -> bool:
        """Whether the window is periodic along y only."""
        return self.boundary == "periodic-y"

    @property
    def repeated_axes(self) -> tuple[int, ...]:
        """Axes (0 for x, 1 for y) along which the window repeats."""
        return {"periodic": (0, 1), "periodic-y": (1,)}.get(self.boundary, ())
