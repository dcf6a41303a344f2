"""Cases of a ball whose eigenstrain is a polynomial of revolution, by axisymmetric elements.

The eigenstrain is one component times a monomial ``r^(2 square) z^height`` of the coordinates from the centre, in
radii. Components that vary with the direction in the plane need powers of r of their own, so that the Cartesian
components are polynomials: ``radial`` is r² in e_rr alone, ``shear`` is r in e_rz. The judged field is that of
`eigencontact.halfspace.moments` with the coefficients of the shape's own densities, fitted to values of the polynomial.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.case import Level, Outer, Quantity, in_name
from eigencontact_verification.crosscheck.inclusions import InclusionCase, inclusion_case
from eigencontact_verification.fem.axisymmetric_model import AxisymmetricModel, AxisymmetricRegion

__all__ = ["KEY", "PolynomialCase", "VaryingRegion", "polynomial_case", "polynomial_strain"]

FloatArray = NDArray[np.float64]

KEY = "polynomial-eigenstrain"
#: e_rr, e_tt, e_zz, e_rz and the power of r that goes with them, by name.
COMPONENTS: dict[str, tuple[tuple[float, float, float, float], int]] = {
    "uniform": ((1.0, 1.0, 1.0, 0.0), 0),
    "zz": ((0.0, 0.0, 1.0, 0.0), 0),
    "plane": ((1.0, 1.0, 0.0, 0.0), 0),
    "radial": ((1.0, 0.0, 0.0, 0.0), 2),
    "shear": ((0.0, 0.0, 0.0, 1.0), 1),
}
_RADIUS = 0.5
#: Amount, component, and the powers of r² and z.
Term = tuple[float, str, int, int]


def polynomial_strain(term: Term, r: FloatArray, z: FloatArray) -> FloatArray:
    """Eigenstrain e_rr, e_tt, e_zz, e_rz ``(4, ...)`` of a term at places in radii from the centre."""
    amount, component, square, height = term
    shares, power = COMPONENTS[component]
    return np.asarray(np.multiply.outer(amount * np.array(shares), r ** (2 * square + power) * z**height))


@dataclass(frozen=True, kw_only=True)
class VaryingRegion(AxisymmetricRegion):
    """Region with a polynomial eigenstrain about the centre of its bounds.

    Attributes
    ----------
    terms : tuple of Term
        See `polynomial_strain`.
    """

    terms: tuple[Term, ...]

    def strain_at(self, r: FloatArray, z: FloatArray) -> FloatArray:
        """See `AxisymmetricRegion.strain_at`."""
        radius = self.bounds[1][0]
        depth = (self.bounds[0][1] + self.bounds[1][1]) / 2
        strains = [polynomial_strain(term, r / radius, (z - depth) / radius) for term in self.terms]
        return np.asarray(sum(strains))


@dataclass(frozen=True, kw_only=True, eq=False)
class PolynomialCase(InclusionCase):
    """Ball with the eigenstrain ``parameters["terms"]``, rows of amount, component, square, height."""

    code: ClassVar[tuple[str, ...]] = (
        *InclusionCase.code,
        f"{__name__}:polynomial_strain",
        f"{__name__}:VaryingRegion",
        f"{__name__}:PolynomialCase.terms",
        f"{__name__}:PolynomialCase.axisymmetric_model",
    )

    @property
    def eigenstrain(self) -> FloatArray:
        """Uniform part, ``(3, 3)``: none beside the terms."""
        return np.zeros((3, 3))

    @property
    def terms(self) -> tuple[Term, ...]:
        """Terms of the eigenstrain."""
        return tuple((float(amount), name, int(i), int(j)) for amount, name, i, j in self.parameters["terms"])

    @property
    def degree(self) -> int:
        """Degree of the Cartesian components."""
        return max(2 * square + height + COMPONENTS[name][1] for _, name, square, height in self.terms)

    def axisymmetric_model(self, level: Level, outer: Outer) -> AxisymmetricModel:
        """See `InclusionCase.axisymmetric_model`."""
        model = super().axisymmetric_model(level, outer)
        (region,) = model.regions
        varying = VaryingRegion(contains=region.contains, bounds=region.bounds, fitted=True, terms=self.terms)
        return replace(model, regions=(varying,))

    def tensor_at(self, points: FloatArray) -> FloatArray:
        """Eigenstrain as tensors ``(n, 3, 3)`` at points ``(n, 3)``, as a polynomial inside and outside alike."""
        offset = (points - np.array(self.parameters["shape"]["center"])) / self.parameters["shape"]["radius"]
        r = np.hypot(offset[:, 0], offset[:, 1])
        out, outward = np.zeros((len(points), 3, 3)), offset.copy()
        outward[:, 2] = 0.0
        outward /= np.where(r > 0, r, 1.0)[:, None]
        up = np.array([0.0, 0.0, 1.0])
        along = np.diag([1.0, 1.0, 0.0]) - outward[:, :, None] * outward[:, None, :]
        sheared = outward[:, :, None] * up + up[:, None] * outward[:, None, :]
        for term in self.terms:
            rr, tt, zz, rz = polynomial_strain(term, r, offset[:, 2])[..., None, None]
            out += rr * outward[:, :, None] * outward[:, None, :] + tt * along + zz * np.outer(up, up) + rz * sheared
        return out

    def field(self, points: FloatArray, quantity: Quantity, *, cells: int | None = None) -> FloatArray:  # noqa: ARG002
        """Displacement ``(n, 3)`` or stress ``(n, 3, 3)`` of the half-space theorem at points ``(n, 3)``."""
        from eigencontact.core.material import Material
        from eigencontact.core.tensors import to_matrix
        from eigencontact.halfspace.moments import moment_field

        material = Material(young_modulus=1.0, poisson_ratio=self.parameters["poisson_ratio"])
        field = moment_field(
            self.shape,
            self.coefficients,
            (points[:, 0], points[:, 1], points[:, 2]),
            degree=self.degree,
            poisson_ratio=material.poisson_ratio,
            quantity=quantity,
        )
        if quantity == "displacement":
            return np.ascontiguousarray(field.T)
        return np.asarray(to_matrix(field * material.shear_modulus if quantity == "stress" else field))

    @property
    def coefficients(self) -> FloatArray:
        """Mandel eigenstrain per density of the shape, ``(6, n)``."""
        from eigencontact.core.tensors import INDICES, to_mandel

        shape, count = self.shape, self.degree + 2
        places, _ = shape.density_rule((count, count, 2 * count))
        tensors = self.tensor_at(places)
        values = to_mandel([tensors[:, i, j] for i, j in INDICES])
        densities = shape.densities(self.degree, *places.T)
        coefficients, *_ = np.linalg.lstsq(densities.T, values.T, rcond=None)
        assert np.abs(coefficients.T @ densities - values).max() < 1e-12, "the densities do not span the polynomial"
        return np.asarray(coefficients.T)

    @property
    def words(self) -> str:
        """Title of the figures: the problem in words."""
        _, _, depth = self.parameters["shape"]["center"]
        nu, rows = (
            self.parameters["poisson_ratio"],
            [f"{amount:g} {name} r^{2 * i} z^{j}" for amount, name, i, j in self.terms],
        )
        return f"{KEY} of a ball, centre at depth {depth:g}: {' + '.join(rows)}, ν = {nu:g}"


def polynomial_case(
    terms: Sequence[Sequence[Any]], *, depth: float, poisson_ratio: float = 0.3, name: str = "", quick: bool = False
) -> PolynomialCase:
    """Case of a ball of diameter 1.

    Parameters
    ----------
    terms : sequence of (amount, component, square, height)
        Of the eigenstrain; see `polynomial_strain`.
    depth : float
        Of the centre, above the radius 0.5.
    poisson_ratio : float
        Of the body.
    name : str
        First part of the case's name; by default the terms.
    quick : bool
        Whether the case belongs to the quick cross-check.
    """
    shape = {"key": "sphere", "center": [0.0, 0.0, depth], "radius": _RADIUS}
    base = inclusion_case(shape, "uniform", poisson_ratio, name=name, revolved=True, quick=quick)
    parameters = {key: value for key, value in base.parameters.items() if key not in ("eigenstrain", "components")}
    name = name or "-".join(f"{component}-r{2 * square}-z{height}" for _, component, square, height in terms)
    return PolynomialCase(
        subject=KEY,
        name=f"{name}-depth-{in_name(depth)}-nu-{round(100 * poisson_ratio):02d}",
        parameters={
            **parameters,
            "terms": [list(term) for term in terms],
            "components": {component: COMPONENTS[component] for _, component, _, _ in terms},
        },
        component=base.component,
        quick=quick,
        profiles=base.profiles,
        ratio=base.ratio,
    )
