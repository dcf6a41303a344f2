"""Whole inhomogeneities with polynomial eigenstrain: one small symmetric system for all of them.

The eigenstrain of an inclusion is ``Σ y_a x_a``; it has the stress τ by the stiffness of the inclusion
(`inclusion_basis`). The stress of the body, σ_0 + A x, must equal τ in the mean over the inclusion, weighted by each
x_b::

    Σ_a y_a ∫ x_b : (τ_a - A x_a) dV = ∫ x_b : σ_0 dV

The matrix is symmetric, because A is reciprocal. The right-hand side for tractions is their work on the surface
displacement of x_b (Betti), so a load close to an inclusion needs no integration over it. The solution of a degree is
exact if the load's field has that degree. Otherwise the error falls by a constant factor per degree, which depends on
the distance to the surface and to other inclusions.

References
----------
J. D. Eshelby 1961, Progress in Solid Mechanics 2, 89; Z. A. Moschovidis and T. Mura 1975, J. Appl. Mech. 42, 847
(polynomial eigenstrain in interacting ellipsoids). The weak form and the reduced basis were derived for this project.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from eigencontact.core.array_types import FloatArray
from eigencontact.core.elasticity import Elasticity, ElasticityOfCells, factors_of_stiffness
from eigencontact.core.material import Material
from eigencontact.core.products import norm_of
from eigencontact.errors import NotConverged, require
from eigencontact.halfspace.cloud import likeness
from eigencontact.halfspace.moments import densities_up_to
from eigencontact.halfspace.potentials import HasMomentPotentials
from eigencontact.halfspace.uniform_density import with_densities
from eigencontact.solvers.gmres import gmres
from eigencontact.solvers.inclusion_basis import InclusionBasis, basis_of
from eigencontact.solvers.inclusion_pairs import ALIKE, InclusionPairs
from eigencontact.solvers.inclusion_system import InclusionReport
from eigencontact.solvers.report import Progress

__all__ = ["PolynomialAnswer", "PolynomialInclusions"]

#: Eigenvalue of an inclusion's own matrix, relative to its volume, that counts as round-off. Functions without
#: eigenstrain have it, for example a change of volume if both materials have equal bulk moduli.
_ROUNDING = 1e-12


@dataclass(frozen=True, slots=True)
class PolynomialAnswer:
    """Equivalent eigenstrain of whole inclusions.

    Attributes
    ----------
    eigenstrain : (6, densities, n)
        Mandel eigenstrain per density of each shape, prestrain included. The array has the highest degree of all
        inclusions, with zeros above the degree of an inclusion.
    amplitudes : (unknowns,)
        Amplitudes of the functions of all inclusions.
    report : InclusionReport
        Certificate and history.
    """

    eigenstrain: FloatArray
    amplitudes: FloatArray
    report: InclusionReport


class PolynomialInclusions:
    """Linear system of one set of inclusions.

    Parameters
    ----------
    shapes : sequence of HasMomentPotentials
        Inclusions without overlap; for degree 0 also shapes with potentials and point sources (`HasFarField`).
    matrix : Material
        Surrounding material; ν up to 0.5.
    materials : sequence of Elasticity or of (6, 6)
        Elastic constants of each, or Mandel stiffness [Pa]; one object for equal materials is evaluated once.
    degrees : sequence of int
        Degree of the eigenstrain of each.
    space : {"half", "full"}
        With or without the free surface z = 0.
    threads : int, optional
        Cores to use; by default all.

    Raises
    ------
    SceneError
        The stiffness varies within an inclusion, or the numbers of items do not match.
    """

    tolerance, max_iterations, restart = 1e-8, 200, 50

    def __init__(
        self,
        shapes: Sequence[HasMomentPotentials],
        matrix: Material,
        materials: Sequence[Elasticity | ArrayLike],
        degrees: Sequence[int],
        *,
        space: str = "half",
        threads: int | None = None,
    ) -> None:
        where, count = "inclusions", len(shapes)
        require(count > 0, where, "shapes", count, "at least one")
        require(len(materials) == count, where, "materials", len(materials), f"one for each of {count} inclusions")
        require(len(degrees) == count, where, "degrees", len(degrees), f"one for each of {count} inclusions")
        maps = any(isinstance(item, ElasticityOfCells) for item in materials)
        require(not maps, where, "materials", "a map", "uniform in each inclusion; resolve maps by cells")
        self.regions: list[Any] = list(shapes)
        self.matrix, self.degrees = matrix, list(degrees)
        self.shapes = [with_densities(shape) for shape in shapes]
        self.space, self.threads = space, threads
        bases: dict[Hashable, InclusionBasis] = {}
        self.kinds: list[Hashable] = []
        self.bases: list[InclusionBasis] = []
        for region, shape, material, degree in zip(shapes, self.shapes, materials, degrees, strict=True):
            kind = (likeness(region), _constants(material, matrix.shear_modulus), degree)
            if kind not in bases:
                bases[kind] = basis_of(shape, material, matrix, degree)
            self.kinds.append(kind)
            self.bases.append(bases[kind])
        self.starts = np.cumsum([0, *(basis.size for basis in self.bases)])
        bounds = np.array([shape.bounds for shape in shapes], dtype=float)
        self.centers, self.radii = bounds.mean(axis=1), 0.5 * (bounds[:, 1] - bounds[:, 0]).max(axis=1)
        self.halves = 0.5 * (bounds[:, 1, 2] - bounds[:, 0, 2])
        self._pairs = InclusionPairs(self)
        self._inverses: dict[tuple[Hashable, int], FloatArray] = {}

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return int(self.starts[-1])

    @cached_property
    def rules(self) -> list[tuple[FloatArray, FloatArray]]:
        """Points ``(m, 3)`` [m] and weights [m^3] of each inclusion for the stress of a load."""
        return self._rules(1.0)

    def refine_rules(self, factor: float) -> None:
        """Use rules with `factor` times the points in each direction."""
        self.rules = self._rules(factor)

    def _rules(self, factor: float) -> list[tuple[FloatArray, FloatArray]]:
        return [
            shape.density_rule(
                (round(factor * (degree + 3)), round(factor * (degree + 6)), round(factor * (2 * degree + 8)))
            )
            for shape, degree in zip(self.shapes, self.degrees, strict=True)
        ]

    @property
    def points(self) -> FloatArray:
        """Points ``(3, m)`` [m] for the stress of a load in `moments`."""
        return np.concatenate([points for points, _ in self.rules]).T

    def moments(self, stress: FloatArray) -> FloatArray:
        """Integrals ``(unknowns,)`` [J] of a stress ``(6, m)`` [Pa] at `points` with every function."""
        out, first = [], 0
        for shape, basis, (points, weights) in zip(self.shapes, self.bases, self.rules, strict=True):
            densities = shape.densities(basis.degree, *points.T)
            point_stress = stress[:, first : first + len(points)] * weights
            out.append(np.einsum("nid,dm,im->n", basis.unknowns, densities, point_stress, optimize=True))
            first += len(points)
        return np.concatenate(out)

    def solve(
        self,
        load: FloatArray,
        prestrain: FloatArray | None = None,
        *,
        start: FloatArray | None = None,
        lower: int = 0,
        tolerance: float | None = None,
        max_iterations: int | None = None,
        progress: Progress | None = None,
    ) -> PolynomialAnswer:
        """Solve for the eigenstrain under a load.

        Parameters
        ----------
        load : (unknowns,)
            Integrals [J] of the stress of the load with every function: `moments`, or the work of tractions.
        prestrain : (6, n), optional
            Uniform eigenstrain ε_p of each inclusion.
        start : (unknowns,), optional
            Amplitudes to start from.
        lower : int
            Number of degrees by which every inclusion stays below its own degree; below degree 0 there is no
            eigenstrain.
        tolerance : float, optional
            Bound of ``InclusionReport.residual``: root mean square of the correction of the eigenstrain that each
            inclusion would need by itself, relative to its solution without other inclusions.
        max_iterations : int, optional
            Largest number of iterations.
        progress : callable, optional
            Called after each iteration.

        Raises
        ------
        NotConverged
            The exception has the report.
        """
        began = perf_counter()
        bound = self.tolerance if tolerance is None else tolerance
        report = InclusionReport(tolerance=bound)
        used = self._used(lower)
        fixed = np.zeros((6, len(self.shapes))) if prestrain is None else np.asarray(prestrain, dtype=float)
        forcing = np.asarray(load, dtype=float) / self.matrix.shear_modulus
        if fixed.any():
            forcing = forcing - self._applied(np.zeros(self.size), fixed)
        uncoupled = self._inverted(forcing * used, lower)
        size = self._size_of(uncoupled)
        amplitudes = np.zeros(self.size) if start is None else start * used

        def watch(norm: float) -> None:
            report.history.append(norm / size)
            if progress is not None:
                progress("whole inclusions", norm / size, bound)

        def operator(y: FloatArray) -> FloatArray:
            report.applications += 1
            return self._inverted(self._applied(y) * used, lower)

        if size > 0.0:
            first = self._inverted((forcing - self._applied(amplitudes)) * used, lower)
            limit = self.max_iterations if max_iterations is None else max_iterations
            correction = gmres(
                operator, first, bound=0.5 * bound * size, max_iterations=limit, restart=self.restart,
                watch=watch,
            )  # fmt: skip
            amplitudes = amplitudes + correction
            left = self._inverted((forcing - self._applied(amplitudes)) * used, lower)
            report.residual = self._size_of(left) / size
        else:
            report.residual = 0.0
        report.seconds = perf_counter() - began
        if not report.holds:
            raise NotConverged(
                f"whole inclusions: residual {report.residual:.1e} after {report.iterations} iterations "
                f"(tolerance {bound:.1e}); allow more iterations or a larger tolerance",
                report,
            )
        return PolynomialAnswer(self.eigenstrain(amplitudes, fixed), amplitudes, report)

    def eigenstrain(self, amplitudes: FloatArray, prestrain: FloatArray) -> FloatArray:
        """Eigenstrain per density, ``(6, densities, n)``."""
        out = np.zeros((6, densities_up_to(max(self.degrees)), len(self.shapes)))
        for number, basis in enumerate(self.bases):
            coefficients = np.concatenate((self.of(amplitudes, number), prestrain[:, number]))
            values = np.tensordot(coefficients, basis.eigenstrain, 1)
            out[:, : values.shape[1], number] = values
        return out

    def amplitudes_of(self, eigenstrain: FloatArray, prestrain: FloatArray) -> FloatArray:
        """Amplitudes of an eigenstrain ``(6, densities, n)`` of these inclusions, minus the prestrain."""
        out = np.zeros(self.size)
        for number, basis in enumerate(self.bases):
            count = basis.eigenstrain.shape[2]
            values = eigenstrain[:, :count, number] - np.tensordot(prestrain[:, number], basis.eigenstrain[-6:], 1)
            out[self.starts[number] : self.starts[number + 1]] = basis.amplitudes @ values.ravel()
        return out

    def difference(self, first: FloatArray, second: FloatArray) -> FloatArray:
        """Root mean square over each inclusion of the difference of two eigenstrains, by amplitudes, ``(n,)``."""
        change = first - second
        return np.array([self._norm(self.of(change, number), number) for number in range(len(self.shapes))])

    def of(self, amplitudes: FloatArray, number: int) -> FloatArray:
        """Amplitudes of one inclusion."""
        return amplitudes[self.starts[number] : self.starts[number + 1]]

    def _norm(self, amplitudes: FloatArray, number: int) -> float:
        return float(np.sqrt(max(float(amplitudes @ self.bases[number].overlap @ amplitudes), 0.0)))

    def _size_of(self, amplitudes: FloatArray) -> float:
        return norm_of(self.difference(amplitudes, np.zeros_like(amplitudes)))

    def _used(self, lower: int) -> FloatArray:
        parts = [np.less_equal(basis.degrees, basis.degree - lower) for basis in self.bases]
        return np.concatenate(parts).astype(float)

    def _inverted(self, forces: FloatArray, lower: int) -> FloatArray:
        """Response of each inclusion to forces without the others."""
        out = np.zeros_like(forces)
        for number, basis in enumerate(self.bases):
            key = self.key_of(number), lower
            if key not in self._inverses:
                matrix = self._pairs.self_interaction[key[0]][:, : basis.size]
                count = int((basis.degrees <= basis.degree - lower).sum())
                self._inverses[key] = np.zeros_like(matrix)
                self._inverses[key][:count, :count] = _inverse(matrix[:count, :count], basis.volume)
            unknowns = slice(self.starts[number], self.starts[number + 1])
            out[unknowns] = self._inverses[key] @ forces[unknowns]
        return out

    def _applied(self, amplitudes: FloatArray, prestrain: FloatArray | None = None) -> FloatArray:
        """Left side of the system, ``(unknowns,)``, in units of the matrix's shear modulus."""
        return self._pairs.apply(amplitudes, np.zeros((6, len(self.shapes))) if prestrain is None else prestrain)

    def key_of(self, number: int) -> Hashable:
        """Key of inclusions with equal shape, constants, degree and depth."""
        depth = round(self.centers[number, 2] / (ALIKE * self.radii[number])) if self.space == "half" else 0
        return self.kinds[number], depth


def _constants(material: Any, shear_modulus: float) -> Hashable:
    """Key of equal stiffnesses."""
    pair = (
        material.factors(shear_modulus)
        if isinstance(material, Elasticity)
        else factors_of_stiffness(material, shear_modulus)
    )
    return tuple(
        (matrix * (2.0 * shear_modulus if number == 0 else 1.0)).tobytes() for number, matrix in enumerate(pair)
    )


def _inverse(matrix: FloatArray, volume: float) -> FloatArray:
    """Inverse of a symmetric matrix on the complement of its null space."""
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    regular = np.abs(values) > _ROUNDING * volume
    return np.asarray((vectors[:, regular] / values[regular]) @ vectors[:, regular].T)
