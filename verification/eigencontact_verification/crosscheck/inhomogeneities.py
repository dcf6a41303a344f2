"""Cases of inhomogeneities: a sphere of another material below Hertz's pressure, or one that misfits, without load.

Compared is what the sphere changes: the field with it less the field of the matrix alone under the same load. The
elements solve both on one mesh, so that the error of the load itself drops out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.case import Case, Fields, Level, Outer, error_key, in_name
from eigencontact_verification.crosscheck.cell_errors import from_coarser, widened
from eigencontact_verification.crosscheck.equivalent import Sphere, by_cells, by_one_eigenstrain
from eigencontact_verification.crosscheck.lines import (
    STRESSES,
    chosen,
    in_units,
    inner_lines,
    read_section,
    surface_lines,
)
from eigencontact_verification.fem.axisymmetric_model import AxisymmetricModel, AxisymmetricRegion, Disc
from eigencontact_verification.fem.uncertainty import CAUTIOUS

__all__ = ["KEY", "InhomogeneityCase", "inhomogeneity_case"]

FloatArray = NDArray[np.float64]

#: Name under which the solver is verified; it is no plugin's key.
KEY = "inhomogeneity"
#: Code that decides what the finite elements of a case compute.
_CODE = (
    *(f"{__name__}:InhomogeneityCase.{name}" for name in ("problem", "contains", "model", "reference")),
    f"{__name__}:_region",
    "eigencontact_verification.crosscheck.equivalent:Sphere",
    *(
        f"eigencontact_verification.crosscheck.{name}"
        for name in ("lines:read_section", "lines:chosen", "lines:columns")
    ),
)
#: Cells across the sphere: of the judged values, and of the coarser cuttings that give their error. The boundary lies
#: elsewhere in every cutting, so that points do not converge steadily: the order is assumed, with its safety factor.
_CELLS = (48, 24, 32)
_RATIOS = tuple(_CELLS[0] / count for count in _CELLS[1:])
#: Parts of every element of the undivided mesh at the three levels, and its growth.
_DIVISIONS, _GROWTH = (4, 6, 9), 2.5
#: Radius below which the elements are that of the sphere's diameter: there are enough of them under the load.
_SMALL = 0.2
#: Reach of the body in contact radii or depths.
_REACH = 40.0
#: Distance from the sphere's boundary, in its radii, where the steps of the cells are not felt any more; and where
#: what one eigenstrain leaves may be taken for points.
_MARGIN, _MARGIN_WHOLE = 0.4, 0.5


@dataclass(frozen=True, kw_only=True, eq=False)
class InhomogeneityCase(Case):
    """A sphere of other elastic constants on the axis of the load.

    Parameters
    ----------
    whole : bool
        Judge one eigenstrain for the whole sphere, not one in every cell. Its own error is the field of what that
        leaves unfulfilled, found once, times the factor that stands for the remainders; that of cells comes from
        coarser ones.
    """

    whole: bool = False

    code: ClassVar[tuple[str, ...]] = _CODE

    @property
    def problem(self) -> Sphere:
        """Parameters of the problem."""
        return Sphere(poisson_ratio=self.parameters["poisson_ratio"], **self.parameters["sphere"])

    def contains(self, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points are in the sphere."""
        sphere = self.problem
        return np.asarray(x * x + y * y + (z - sphere.depth) ** 2 < sphere.radius**2)

    def model(self, level: Level, outer: Outer, *, present: bool = True) -> AxisymmetricModel:
        """Finite-element model of one level, with the sphere or with the matrix in its place, on the same mesh."""
        parameters, sphere = self.parameters, self.problem
        return AxisymmetricModel(
            young_modulus=1.0,
            poisson_ratio=sphere.poisson_ratio,
            regions=(_region(sphere, present=present),),
            discs=(Disc(radius=1.0, pressure=sphere.pressure, profile="hertz"),) if sphere.pressure else (),
            reach=parameters["reach"],
            outer=outer,
            far_field=True,
            fine=parameters["fine"],
            growth=parameters["growth"],
            divisions=parameters["divisions"][level],
            lines=((), (0.0,)),
        )

    def reference(self, level: Level, outer: Outer) -> Fields:
        """Values of the finite-element models, with the sphere less without."""
        from eigencontact_verification.fem.axisymmetric import solve_axisymmetric

        present = read_section(solve_axisymmetric(self.model(level, outer)), self.profiles, self.contains)
        if not self.problem.pressure:
            return present
        matrix = solve_axisymmetric(self.model(level, outer, present=False))
        without = read_section(matrix, self.profiles, self.contains)
        return {name: present[name] - without[name] for name in present}

    def judged(self) -> Fields:
        """Values by equivalent inclusions, with their own error."""
        fields: Fields = {}
        uniform = by_one_eigenstrain(self.problem) if self.whole else None
        tries = [] if self.whole else [by_cells(self.problem, count) for count in _CELLS]
        for profile in self.profiles:
            at, quantity = profile.points, profile.quantity
            if uniform is not None:
                fields[profile.name] = chosen(uniform.field(at, quantity), profile)
                error = CAUTIOUS * np.abs(chosen(uniform.correction(at, quantity), profile))
            else:
                fields[profile.name], *coarser = (chosen(cells.field(at, quantity), profile) for cells in tries)
                error = CAUTIOUS * from_coarser(fields[profile.name], coarser, _RATIOS)
            fields[error_key(profile.name)] = widened(error)
        return fields

    @property
    def words(self) -> str:
        """Title of the figures: the problem in words."""
        sphere = self.problem
        young, nu = sphere.young_modulus_inside, sphere.poisson_ratio_inside
        inside = f"E = {young:g}, ν = {nu:g}" if young else "void"
        load = "Hertz's pressure" if sphere.pressure else "a misfit ε* of the sphere"
        way = "one eigenstrain" if self.whole else f"{_CELLS[0]} cells across"
        return (
            f"{KEY}: sphere of radius {sphere.radius:g} a, centre {sphere.depth:g} a deep, {inside} in E = 1, "
            f"ν = {sphere.poisson_ratio:g}, under {load}; {way}"
        )


def _region(sphere: Sphere, *, present: bool) -> AxisymmetricRegion:
    """The sphere for the elements."""
    depth, radius = sphere.depth, sphere.radius
    return AxisymmetricRegion(
        contains=lambda r, z: np.asarray(r * r + (z - depth) ** 2 < radius**2),
        bounds=((0.0, depth - radius), (radius, depth + radius)),
        eigenstrain=(sphere.prestrain, sphere.prestrain) if present else (0.0, 0.0),
        young_modulus=sphere.young_modulus_inside if present else None,
        poisson_ratio=sphere.poisson_ratio_inside if present else None,
        fitted=True,
    )


def inhomogeneity_case(
    ratio: float,
    depth: float,
    *,
    radius: float = 0.5,
    poisson_ratio: float = 0.3,
    inside: float = 0.3,
    pressure: float = 1.0,
    prestrain: float = 0.0,
    whole: bool = False,
    within: bool = False,
    quick: bool = False,
) -> InhomogeneityCase:
    """Case of one sphere.

    Parameters
    ----------
    ratio : float
        Young's modulus inside over that of the matrix; 0 is a void.
    depth : float
        Of the centre, in radii of the sphere.
    radius : float
        Of the sphere, in contact radii.
    poisson_ratio, inside : float
        Of the matrix, and of the sphere.
    pressure, prestrain : float
        Of the load, and the expansion of the sphere by itself.
    whole : bool
        One eigenstrain for the whole sphere.
    within : bool
        Compare the stress inside the sphere too, where the steps of cells are felt more.
    quick : bool
        Whether the case belongs to the quick cross-check.
    """
    size = 2.0 * radius
    sphere: dict[str, Any] = {
        "depth": depth * radius,
        "radius": radius,
        "young_modulus_inside": ratio,
        "poisson_ratio_inside": inside,
        "pressure": pressure,
        "prestrain": prestrain,
    }
    parameters: dict[str, Any] = {
        "poisson_ratio": poisson_ratio,
        "sphere": sphere,
        "reach": _REACH * max(1.0, depth * radius),
        "fine": 2.0 * radius if radius < _SMALL else radius,
        "growth": _GROWTH,
        "divisions": list(_DIVISIONS),
        "within": within,
    }

    def contains(x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        return np.asarray(x * x + y * y + (z - depth * radius) ** 2 < radius**2)

    lines = surface_lines(max(2.0 * size, 2.0 * depth * radius), ("even", "even"), paths=("x",))
    inner = inner_lines(
        contains,
        ((-radius, -radius, (depth - 1) * radius), (radius, radius, (depth + 1) * radius)),
        (0.21 * radius, 0.0, (depth - 0.17) * radius),
        margin=(_MARGIN_WHOLE if whole else _MARGIN) * radius,
        components=tuple(name for name in STRESSES if name.count("y") != 1),
        formal_order=2.0,
        inside=within,
    )
    units = ("p a / E", "p") if pressure else ("ε* a", "E ε*")
    name = f"ratio-{in_name(ratio)}" if ratio else "void"
    name += f"-depth-{in_name(depth)}-nu-{round(100 * poisson_ratio):02d}"
    if inside != poisson_ratio:
        name += f"-in-{round(100 * inside):02d}"
    if prestrain:
        name += "-misfit"
    if within:
        name += "-within"
    return InhomogeneityCase(
        subject=KEY,
        name=f"{name}-whole" if whole else name,
        parameters=parameters,
        whole=whole,
        quick=quick,
        profiles=in_units((*lines, *inner), length="a", displacement=units[0], stress=units[1]),
        ratio=(_DIVISIONS[2] / _DIVISIONS[0]) ** 0.5,
    )
