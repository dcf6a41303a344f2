"""Cases of inclusions: one shape, one eigenstrain, one Poisson's ratio, by solid or axisymmetric elements.

Everything a case needs is in its `parameters`; the shape is built from them with `eigencontact.make`, and the elements
see nothing of it but `contains` and `bounds`.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.case import Case, Curve, Fields, Level, Outer, Profile, Quantity, error_key
from eigencontact_verification.crosscheck.cell_errors import from_coarser, widened
from eigencontact_verification.crosscheck.lines import (
    STRESSES,
    chosen,
    growth_to,
    in_units,
    inner_lines,
    planes_of,
    read_section,
    read_solid,
    surface_lines,
)
from eigencontact_verification.fem.axisymmetric_model import AxisymmetricModel, AxisymmetricRegion
from eigencontact_verification.fem.model import Model, Region
from eigencontact_verification.fem.uncertainty import SAFETY

__all__ = ["EIGENSTRAINS", "InclusionCase", "inclusion_case", "shape_of", "tensor_of"]

FloatArray = NDArray[np.float64]

_AXES = "xyz"
#: Code that decides what the finite elements of a case compute.
_GEOMETRY = ("shape_of", "section_bounds", "tensor_of", "InclusionCase.solid_model", "InclusionCase.axisymmetric_model")
_READING = ("lines:read_section", "lines:read_solid", "lines:chosen", "lines:columns")
_CODE = (
    *(f"{__name__}:{name}" for name in (*_GEOMETRY, "InclusionCase.reference")),
    *(f"eigencontact_verification.crosscheck.{name}" for name in _READING),
)
_MODULUS = 1.0
#: Eigenstrains by name: components and their values. Those of Table 2.3 of the thesis are xx-yy, xx-zz and the shears.
EIGENSTRAINS: dict[str, dict[str, float]] = {
    "xx": {"xx": 1.0},
    "yy": {"yy": 1.0},
    "zz": {"zz": 1.0},
    "xy": {"xy": 1.0},
    "xz": {"xz": 1.0},
    "yz": {"yz": 1.0},
    "xx-yy": {"xx": 1.0, "yy": -1.0},
    "xx-zz": {"xx": 1.0, "zz": -1.0},
    "uniform": {"xx": 1.0, "yy": 1.0, "zz": 1.0},
}
#: Parts of every element of the undivided mesh at the three levels, where the boundary is near and where it is far.
_REFINE, _REFINE_FAR = (5, 7, 10), (4, 6, 9)
_GROWTH_ROUND = 2.5
#: Cells across a shape without potentials over those of the coarser cuttings that give the error. The error falls
#: with the square of the cell size, unsteadily: cells may hold too much of a thin region in two cuttings alike (a torus
#: of 12 and of 18 cells). So two cuttings are compared with the finest, as if the error fell with the cell size, and
#: the safety factor of the grid convergence index applies.
_CELL_RATIOS = (3 / 2, 9 / 7)
#: Reach of the body in depths or extents. Displacement of the surface by a strain in its plane decays slowest.
_REACH, _REACH_IN_PLANE = 12.0, 40.0


def tensor_of(name: str) -> FloatArray:
    """Unit eigenstrain of a name in `EIGENSTRAINS`, ``(3, 3)``; a shear has both entries 1."""
    tensor = np.zeros((3, 3))
    for component, value in EIGENSTRAINS[name].items():
        i, j = (_AXES.index(axis) for axis in component)
        tensor[i, j] = tensor[j, i] = value
    return tensor


def shape_of(table: Mapping[str, Any]) -> Any:
    """Shape from ``{"key": ..., parameters}``; ``mesh`` (vertices and faces) is written to a file for the shape."""
    from eigencontact import make

    parameters = {name: value for name, value in table.items() if name not in ("key", "mesh")}
    if "mesh" not in table:
        return make(table["key"], kind="inclusion-shape", **parameters)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "surface.off"
        vertices, faces = table["mesh"]["vertices"], table["mesh"]["faces"]
        rows = [f"OFF\n{len(vertices)} {len(faces)} 0"]
        rows += [" ".join(map(str, vertex)) for vertex in vertices]
        rows += [" ".join(map(str, (len(face), *face))) for face in faces]
        file.write_text("\n".join(rows) + "\n", encoding="utf-8")
        return make(table["key"], kind="inclusion-shape", file=str(file), **parameters)


def section_bounds(shape: Any) -> tuple[tuple[float, float], tuple[float, float]]:
    """Bounds ((r, z), (r, z)) of the half section of a shape of revolution; r starts at 0 where it meets the axis."""
    (_, _, top), (radius, _, bottom) = shape.bounds
    r, z = np.linspace(0.0, radius, 801), np.linspace(top, bottom, 801)[1:-1]
    inside = np.asarray(shape.contains(r[:, None], np.zeros((1, 1)), z[None, :])).any(axis=1)
    first = int(np.argmax(inside))
    return (float(r[max(first - 1, 0)]), float(top)), (float(radius), float(bottom))


def _is_a_box(shape: Any) -> bool:
    """Whether the shape fills its bounds."""
    low, high = (np.asarray(corner, dtype=float) for corner in shape.bounds)
    along = (np.arange(24) + 0.5) / 24
    x, y, z = (low[axis] + (high[axis] - low[axis]) * along for axis in range(3))
    return bool(np.all(shape.contains(x[None, None, :], y[None, :, None], z[:, None, None])))


def _fills_its_section(shape: Any) -> bool:
    """Whether the half section is the rectangle of its bounds."""
    (inner, top), (outer, bottom) = section_bounds(shape)
    r, z = (low + (high - low) * (np.arange(60) + 0.5) / 60 for low, high in ((inner, outer), (top, bottom)))
    return bool(np.all(shape.contains(r[:, None], np.zeros((1, 1)), z[None, :])))


@dataclass(frozen=True, kw_only=True, eq=False)
class InclusionCase(Case):
    """A region with uniform eigenstrain below a free surface.

    Parameters
    ----------
    component : inclusion shape, optional
        The region itself, where it is at hand and need not be installed; by default it is made from the parameters.
    """

    component: Any = None

    code: ClassVar[tuple[str, ...]] = _CODE

    @property
    def shape(self) -> Any:
        """The region."""
        return shape_of(self.parameters["shape"]) if self.component is None else self.component

    @property
    def eigenstrain(self) -> FloatArray:
        """Tensor ``(3, 3)``."""
        return tensor_of(self.parameters["eigenstrain"])

    def solid_model(self, level: Level, outer: Outer) -> Model:
        """Model of hexahedra."""
        parameters, shape = self.parameters, self.shape
        return Model(
            young_modulus=_MODULUS,
            poisson_ratio=parameters["poisson_ratio"],
            regions=(Region(contains=shape.contains, bounds=shape.bounds, eigenstrain=self.eigenstrain),),
            reach=parameters["reach"],
            symmetry=tuple(parameters["symmetry"]),
            outer=outer,
            fine=parameters["fine"],
            growth=parameters["growth"],
            refine=parameters["refine"][level],
        )

    def axisymmetric_model(self, level: Level, outer: Outer) -> AxisymmetricModel:
        """Model of quadrilaterals in the half plane (r, z)."""
        parameters, shape = self.parameters, self.shape
        low, high = section_bounds(shape)
        strain = self.eigenstrain
        region = AxisymmetricRegion(
            contains=lambda r, z: np.asarray(shape.contains(r, np.zeros_like(r), z)),
            bounds=(low, high),
            eigenstrain=(float(strain[0, 0]), float(strain[2, 2])),
            fitted=parameters["fitted"],
        )
        return AxisymmetricModel(
            young_modulus=_MODULUS,
            poisson_ratio=parameters["poisson_ratio"],
            regions=(region,),
            reach=parameters["reach"],
            outer=outer,
            fine=parameters["fine"],
            growth=parameters["growth"],
            divisions=parameters["refine"][level],
            lines=((), (0.0,)),
        )

    def reference(self, level: Level, outer: Outer) -> Fields:
        """Values of the finite-element model."""
        contains = self.shape.contains
        if self.parameters["elements"] == "axisymmetric":
            from eigencontact_verification.fem.axisymmetric import solve_axisymmetric

            return read_section(solve_axisymmetric(self.axisymmetric_model(level, outer)), self.profiles, contains)
        from eigencontact_verification.fem.solve import solve

        return read_solid(solve(self.solid_model(level, outer)), self.profiles, [contains])

    def judged(self) -> Fields:
        """Values of the half-space theorem."""
        cells, fields = self.parameters["cells"], {}
        for profile in self.profiles:
            counts = (cells, *(round(cells / ratio) for ratio in _CELL_RATIOS)) if self.parameters["cut"] else (cells,)
            tries = [chosen(self.field(profile.points, profile.quantity, cells=count), profile) for count in counts]
            fields[profile.name] = tries[0]
            if len(tries) > 1:
                fields[error_key(profile.name)] = widened(SAFETY * from_coarser(tries[0], tries[1:], _CELL_RATIOS))
        return fields

    def field(self, points: FloatArray, quantity: Quantity, *, cells: int | None = None) -> FloatArray:
        """Displacement ``(n, 3)`` or stress ``(n, 3, 3)`` of the half-space theorem at points ``(n, 3)``."""
        from eigencontact import inclusion_field

        return np.asarray(
            inclusion_field(
                self.shape,
                self.eigenstrain,
                points,
                young_modulus=_MODULUS,
                poisson_ratio=self.parameters["poisson_ratio"],
                quantity=quantity,
                cells=cells or self.parameters["cells"],
            )
        )

    @property
    def words(self) -> str:
        """Title of the figures: the problem in words."""
        low, high = (np.asarray(corner) for corner in self.shape.bounds)
        extents = " × ".join(f"{extent:.3g}" for extent in high - low)
        return (
            f"{self.subject}, extents {extents}, centre at depth {(low[2] + high[2]) / 2:.3g}, eigenstrain "
            f"{self.parameters['eigenstrain']}, ν = {self.parameters['poisson_ratio']:g}"
        )

    def curve(self, profile: Profile) -> Curve | None:
        """Field on the line of a profile, closely; not of a shape that has to be cut into cells."""
        from eigencontact_verification.crosscheck.pictures.fields import curve

        contains = self.shape.contains
        return None if self.parameters["cut"] else curve(profile, self.field, contains)

    def pictures(self, folder: Path) -> tuple[Path, ...]:
        """Mesh and field of the coarse model (VTU, PNG)."""
        from eigencontact_verification.crosscheck.pictures.fields import inclusion_pictures

        return inclusion_pictures(self, folder)


def unit_length(key: str, extents: tuple[float, float, float]) -> str:
    """Name of the length that is 1 in a case, for the figures.

    Examples
    --------
    >>> unit_length("sphere", (1.0, 1.0, 1.0)), unit_length("cuboid", (1.6, 1.0, 0.6))
    ('diameter', 'width')
    """
    x, y, z = (bool(np.isclose(extent, 1.0, atol=0)) for extent in extents)
    if x and y:
        return "edge" if key == "cuboid" else "diameter" if key in ("sphere", "ellipsoid", "cylinder") else "width"
    return "length" if x else "width" if y else "height" if z else "length unit"


def inclusion_case(
    shape: Mapping[str, Any],
    eigenstrain: str,
    poisson_ratio: float,
    *,
    name: str,
    revolved: bool = False,
    mirrored: tuple[bool, bool] = (True, True),
    anchor: tuple[float, float, float] | None = None,
    cells: int = 18,
    exact_cells: bool = False,
    quick: bool = False,
    refine: float = 1.0,
    outer_elements: int | None = None,
    divisions: tuple[int, int, int] | None = None,
    component: Any = None,
) -> InclusionCase:
    """Case of one shape.

    Parameters
    ----------
    shape : mapping
        ``{"key": ..., parameters of make}``.
    eigenstrain : str
        A name in `EIGENSTRAINS`.
    poisson_ratio : float
        Of the body.
    name : str
        First part of the case's name.
    revolved : bool
        Whether shape and eigenstrain are of revolution about the axis z, so that axisymmetric elements do.
    mirrored : (bool, bool)
        Whether the shape is its own mirror image in x = 0 and in y = 0.
    anchor : (x, y, z), optional
        Point inside, through which the lines go; by default a little off the middle.
    cells : int
        Cells across a shape without potentials.
    exact_cells : bool
        Whether cells make up the shape exactly.
    quick : bool
        Whether the case belongs to the quick cross-check.
    refine : float
        Elements of the undivided mesh along the shortest extent (along half of it in axisymmetric models).
    outer_elements : int, optional
        Elements of the undivided mesh from the source outwards; by default 2, or 3 to a far boundary.
    divisions : (int, int, int), optional
        Parts of every element of the undivided mesh at the three levels; by default by the distance of the boundary.
    component : inclusion shape, optional
        The shape itself, where it need not be installed; `shape` then only names it.
    """
    region = shape_of(shape) if component is None else component
    low, high = (np.asarray(corner, dtype=float) for corner in region.bounds)
    size, thinnest = float(np.max(high - low)), float(np.min(high - low))
    middle = (low + high) / 2
    if anchor is None:
        x, y, z = (middle + np.array([0.21, 0.13, -0.17]) * (high - low) / 2).tolist()
        anchor = (x, y, z)
    planes = ("none", "none")
    if not revolved:
        kinds = planes_of(EIGENSTRAINS[eigenstrain])
        planes = (kinds[0] if mirrored[0] else "none", kinds[1] if mirrored[1] else "none")
    cut = not exact_cells and not (hasattr(region, "phi") and hasattr(region, "psi"))
    in_plane = set(EIGENSTRAINS[eigenstrain]) & {"xx", "yy", "xy"} and eigenstrain != "uniform"
    reach = (_REACH_IN_PLANE if in_plane or revolved else _REACH) * max(size, float(middle[2]))
    far = reach * (1.0 if revolved else refine) > 30 * thinnest
    fine = thinnest / (2 * refine if revolved else refine)
    refine_by = divisions or (_REFINE_FAR if revolved or far else _REFINE)
    parameters: dict[str, Any] = {
        "shape": dict(shape),
        "eigenstrain": eigenstrain,
        "components": EIGENSTRAINS[eigenstrain],
        "poisson_ratio": poisson_ratio,
        "elements": "axisymmetric" if revolved else "solid",
        "fitted": revolved and not _fills_its_section(region),
        "symmetry": list(planes),
        "reach": reach,
        "fine": fine,
        "growth": _GROWTH_ROUND if revolved else growth_to(reach / fine, outer_elements or (3 if far else 2)),
        "refine": list(refine_by),
        "cells": cells,
        "cut": cut,
    }
    lines = surface_lines(
        max(2.0 * size, 2.0 * float(middle[2])),
        ("even", "even") if revolved else planes,
        paths=("x",) if revolved else ("x", "y", "diagonal"),
        # mirrored in the surface, which is no boundary of a source that touches it: points above its middle are kept
        source=(lambda x, y, z: region.contains(x, y, np.abs(z))) if low[2] <= 0.05 * size else None,
        margin=0.25 * thinnest,
        both_sides=not revolved and "none" in planes,
    )
    stresses = tuple(name for name in STRESSES if name.count("y") != 1) if revolved else STRESSES
    if revolved:
        anchor = (anchor[0], 0.0, anchor[2])
    # hexahedra that a curved boundary cuts say little of the stress beside it, and less of that inside
    resolved = revolved or _is_a_box(region)
    margin = min(0.12 * size, 0.35 * thinnest) if resolved else 0.25 * size
    if revolved:
        margin = 0.08 * thinnest
    inner = inner_lines(
        region.contains,
        region.bounds,
        anchor,
        margin=max(margin, 1.5 * size / cells if cut else 0.0),
        inside=resolved,
        components=stresses,
        formal_order=2.0 if revolved else 3.0,  # curved elements are not promised to be more exact anywhere
    )
    length = unit_length(str(shape["key"]), tuple((high - low).tolist()))
    return InclusionCase(
        subject=str(shape["key"]),
        name=f"{name}-{eigenstrain}-nu-{round(100 * poisson_ratio):02d}",
        parameters=parameters,
        component=component,
        quick=quick,
        profiles=in_units((*lines, *inner), length=length, displacement=f"ε* {length}", stress="E ε*"),
        ratio=(refine_by[2] / refine_by[0]) ** 0.5,
    )
