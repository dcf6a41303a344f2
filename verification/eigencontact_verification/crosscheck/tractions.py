"""Cases of the surface tractions: pressure and shears on one rectangle of the surface."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.case import Fields, Level, Outer, Quantity
from eigencontact_verification.crosscheck.lines import (
    FieldCase,
    growth_to,
    in_units,
    inner_lines,
    planes_of,
    read_solid,
    surface_lines,
)
from eigencontact_verification.fem.model import Model, Patch

__all__ = ["TRACTIONS", "RectangleCase", "rectangle_case"]

FloatArray = NDArray[np.float64]

#: Key of each kernel, and the direction of its traction.
TRACTIONS = {"pressure": "z", "shear-x": "x", "shear-y": "y"}
_AXES = "xyz"
#: Code that decides what the finite elements of a case compute.
_CODE = (
    *(f"{__name__}:RectangleCase.{name}" for name in ("traction", "model", "reference")),
    *(f"eigencontact_verification.crosscheck.{name}" for name in ("lines:read_solid", "lines:chosen", "lines:columns")),
)
_MODULUS = 1.0
#: Parts of every element of the coarse mesh at the three levels, and its elements from the rectangle outwards.
_REFINE = (4, 6, 9)
_OUTER_ELEMENTS = 2


@dataclass(frozen=True, kw_only=True, eq=False)
class RectangleCase(FieldCase):
    """Uniform traction on the rectangle |x| <= a, |y| <= b.

    Truncation falls with the inverse of the reach R, and a body loaded by a force is in no equilibrium when its outer
    faces are free. So it is bracketed by two reaches: with the difference D = u(R) - u(R/2) the law 1/R gives
    u(R) + D for the half-space. As the cross-check takes the middle of ``"fixed"`` and ``"free"`` and half their
    distance, ``"free"`` returns u(R) + 2 D: the value is then the extrapolated one, its uncertainty all of D.
    """

    code: ClassVar[tuple[str, ...]] = _CODE

    @property
    def traction(self) -> tuple[float, float, float]:
        """Unit traction that acts on the body."""
        x, y, z = (float(axis == TRACTIONS[self.subject]) for axis in _AXES)
        return x, y, z

    def model(self, level: Level, *, reach: float) -> Model:
        """Finite-element model of one level, its outer faces fixed at `reach`."""
        parameters = self.parameters
        a, b = parameters["half_widths"]
        return Model(
            young_modulus=_MODULUS,
            poisson_ratio=parameters["poisson_ratio"],
            patches=(Patch(low=(-a, -b), high=(a, b), traction=self.traction),),
            reach=reach,
            symmetry=planes_of([TRACTIONS[self.subject]]),
            fine=parameters["fine"],
            growth=parameters["growth"],
            refine=parameters["refine"][level],
        )

    def reference(self, level: Level, outer: Outer) -> Fields:
        """Values of the finite-element model; see above for what ``"free"`` means."""
        from eigencontact_verification.fem.solve import solve

        reach = self.parameters["reach"]
        values = read_solid(solve(self.model(level, reach=reach)), self.profiles)
        if outer == "fixed":
            return values
        nearer = read_solid(solve(self.model(level, reach=reach / 2)), self.profiles)
        return {name: 3 * values[name] - 2 * nearer[name] for name in values}

    def field(self, points: FloatArray, quantity: Quantity) -> FloatArray:
        """Displacement ``(n, 3)`` or stress ``(n, 3, 3)`` of the closed forms at points ``(n, 3)``."""
        from eigencontact import rectangle_field

        return np.asarray(
            rectangle_field(
                self.traction,
                self.parameters["half_widths"],
                points,
                young_modulus=_MODULUS,
                poisson_ratio=self.parameters["poisson_ratio"],
                quantity="stress" if quantity == "stress" else "displacement",
            )
        )

    @property
    def words(self) -> str:
        """Title of the figures: the problem in words."""
        a, b = self.parameters["half_widths"]
        load = "pressure p" if self.subject == "pressure" else f"traction q along {TRACTIONS[self.subject]}"
        return f"uniform {load} on |x| ≤ a, |y| ≤ {b / a:g} a, ν = {self.parameters['poisson_ratio']:g}"

    def pictures(self, folder: Path) -> tuple[Path, ...]:
        """Mesh and field of the coarse model (VTU, PNG)."""
        from eigencontact_verification.crosscheck.pictures.fields import rectangle_pictures

        return rectangle_pictures(self, folder)


def rectangle_case(
    kernel: str, poisson_ratio: float, *, half_widths: tuple[float, float] = (1.0, 0.6), quick: bool = False
) -> RectangleCase:
    """Case of one traction and one Poisson's ratio.

    Parameters
    ----------
    kernel : str
        A key of `TRACTIONS`.
    poisson_ratio : float
        Of the body.
    half_widths : (float, float)
        a and b; everything else is in proportion.
    quick : bool
        Whether the case belongs to the quick cross-check.
    """
    a, b = half_widths
    size = min(a, b)
    reach = 120.0 * max(a, b)
    parameters: dict[str, Any] = {
        "half_widths": [a, b],
        "poisson_ratio": poisson_ratio,
        "reach": reach,
        "fine": size,
        "growth": growth_to((reach - size) / size, _OUTER_ELEMENTS),
        "refine": list(_REFINE),
    }

    def loaded(x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        return np.asarray((np.abs(x) <= a) & (np.abs(y) <= b) & (np.abs(z) <= 1e-3 * size))

    lines = surface_lines(
        4.0 * a,
        planes_of([TRACTIONS[kernel]]),
        source=lambda x, y, _: loaded(x, y, np.zeros(1)),
        margin=0.15 * size,
    )
    inner = inner_lines(
        loaded,
        ((-a, -b, 0.0), (a, b, 1e-3 * size)),
        (0.23 * a, 0.17 * b, 0.5 * size),
        margin=0.1 * size,
    )
    load = "p" if kernel == "pressure" else "q"
    return RectangleCase(
        subject=kernel,
        name=f"rectangle-nu-{round(100 * poisson_ratio):02d}",
        parameters=parameters,
        quick=quick,
        profiles=in_units((*lines, *inner), length="a", displacement=f"{load} a / E", stress=load),
        ratio=1.5,
    )
