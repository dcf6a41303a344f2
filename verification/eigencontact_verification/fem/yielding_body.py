"""Body of revolution whose points answer by laws that remember: inner forces and their derivative.

Nine-node quadrilaterals with nine integration points. The volumetric strain is replaced by its projection on the linear
functions of an element (mean dilatation of the second order: the pair Q2/P1), so that flow that keeps its volume does
not lock. All integrals carry the weight r; the factor 2 pi is left out.

References
----------
T. J. R. Hughes, Int. J. Numer. Methods Eng. 15 (1980) 1413 (the projection); F. Brezzi, M. Fortin, Mixed and Hybrid
Finite Element Methods, 1991, section VI.3 (the pair).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_matrix
from skfem import CellBasis, ElementQuad2, ElementVector

from eigencontact_verification.fem.axisymmetric_mesh import Grid
from eigencontact_verification.fem.yielding_law import PointLaw, State

__all__ = ["YieldingBody"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Places of the integration points along an edge of the unit element, and their weights.
_PLACES = (np.polynomial.legendre.leggauss(3)[0] + 1) / 2
_WEIGHTS = np.polynomial.legendre.leggauss(3)[1] / 2


@dataclass(frozen=True, kw_only=True, eq=False)
class YieldingBody:
    """Mesh, and the material of every integration point.

    Attributes
    ----------
    grid : Grid
        Nine-node quadrilaterals in (r, z).
    laws : tuple of PointLaw
        Materials.
    material : (elements, 9) int64
        Number of the law of each integration point.
    prestrain : (4, elements, 9) float64
        Strain (rr, tt, zz, sqrt2 rz) that causes no stress.
    """

    grid: Grid
    laws: Sequence[PointLaw]
    material: IntArray
    prestrain: FloatArray

    @staticmethod
    def points_of(grid: Grid) -> FloatArray:
        """Integration points (2, elements, 9) of a mesh."""
        return np.asarray(_basis(grid).global_coordinates())

    @cached_property
    def basis(self) -> CellBasis:
        """Shape functions; unknown 2 k of an element is u_r of its node k, 2 k + 1 is u_z."""
        return _basis(self.grid)

    @cached_property
    def first_component(self) -> NDArray[np.bool_]:
        """Whether an unknown is the displacement along the first coordinate, r or x; the others are along z."""
        out = np.zeros(self.basis.N, dtype=bool)
        for dofs in (self.basis.nodal_dofs, self.basis.facet_dofs, self.basis.interior_dofs):
            out[dofs[0]] = True
        return out

    @cached_property
    def weight(self) -> FloatArray:
        """Weight r dA of each integration point, (elements, 9)."""
        return np.asarray(self.basis.dx * np.asarray(self.basis.global_coordinates())[0])

    def hoop(self, value: FloatArray) -> FloatArray:
        """Strain tt of each unknown, from the values of its u_r at the integration points, (18, elements, 9)."""
        return np.asarray(value / np.asarray(self.basis.global_coordinates())[0])

    @cached_property
    def strains(self) -> FloatArray:
        """Strain (rr, tt, zz, sqrt2 rz) of each unknown, (elements, 9, 4, 18)."""
        basis = self.basis
        value = np.array([np.asarray(shape)[0] for (shape,) in basis.basis])
        grad = np.array([shape.grad for (shape,) in basis.basis])
        sheared = (grad[:, 0, 1] + grad[:, 1, 0]) / np.sqrt(2.0)
        strains = np.stack((grad[:, 0, 0], self.hoop(value), grad[:, 1, 1], sheared)).transpose(2, 3, 0, 1)
        volume = strains[:, :, :3].sum(axis=2)
        local = np.stack(np.meshgrid(_PLACES, _PLACES)).reshape(2, -1)
        linear = np.vstack((np.ones(9), local))
        weighted = self.weight[:, None] * linear
        gram = weighted @ linear.T
        smooth = linear.T @ np.linalg.solve(gram, weighted @ volume)
        strains[:, :, :3] += ((smooth - volume) / 3)[:, :, None]
        return np.ascontiguousarray(strains)

    def state_at_rest(self) -> tuple[State, ...]:
        """State of every law's points before any load."""
        return tuple(law.state_at_rest(4, int((self.material == k).sum())) for k, law in enumerate(self.laws))

    def strain(self, u: FloatArray) -> FloatArray:
        """Strain (4, elements, 9) of a displacement, prestrain included."""
        dofs = np.asarray(self.basis.element_dofs).T
        return np.asarray(np.moveaxis(self.strains @ u[dofs][:, None, :, None], 2, 0)[..., 0])

    def answer(self, u: FloatArray, before: tuple[State, ...]) -> tuple[FloatArray, FloatArray, tuple[State, ...]]:
        """Stress (4, elements, 9), its derivative by the strain (4, 4, elements, 9), and the states that follow."""
        strain = self.strain(u) - self.prestrain
        stress, tangent = np.empty_like(strain), np.empty((4, *strain.shape))
        after = []
        for k, (law, state) in enumerate(zip(self.laws, before, strict=True)):
            of_law = self.material == k
            stress[:, of_law], tangent[:, :, of_law], new_state = law.answer(strain[:, of_law], state)
            after.append(new_state)
        return stress, tangent, tuple(after)

    def forces(
        self, u: FloatArray, before: tuple[State, ...]
    ) -> tuple[FloatArray, csc_matrix, tuple[State, ...], FloatArray]:
        """Inner forces (unknowns,), their derivative, the states that follow, and stress (4, elements, 9)."""
        stress, tangent, after = self.answer(u, before)
        B, w = self.strains, self.weight
        dofs = np.asarray(self.basis.element_dofs).T
        loads = np.einsum("eqia,ieq->ea", B, w * stress)
        force = np.bincount(dofs.ravel(), loads.ravel(), minlength=self.basis.N).astype(np.float64)
        turned = np.moveaxis(w * tangent, (0, 1), (2, 3)) @ B
        count = dofs.shape[1]
        flat = (len(dofs), 36, count)
        matrices = np.swapaxes(B.reshape(flat), 1, 2) @ turned.reshape(flat)
        rows, columns = (np.broadcast_to(x, matrices.shape).ravel() for x in (dofs[:, :, None], dofs[:, None]))
        matrix = csc_matrix((matrices.ravel(), (rows, columns)), shape=(self.basis.N, self.basis.N))
        return force, matrix, after, stress

    def of_state(self, states: tuple[State, ...], name: str = "p") -> FloatArray:
        """One number of the state at every integration point, (elements, 9)."""
        numbers = np.zeros(self.material.shape)
        for k, state in enumerate(states):
            numbers[self.material == k] = np.reshape(state[name], -1)
        return numbers

    def read(self, field: FloatArray, points: ArrayLike) -> FloatArray:
        """Values at points (n, 2) of a field (..., elements, 9) given at the integration points, (..., n).

        Each element continues its own nine values as a polynomial.
        """
        r, z = np.asarray(points, dtype=float).T
        element, local = self.grid.find(r, z)
        along = [_lagrange(local[k]) for k in (0, 1)]
        weights = (along[1][:, :, None] * along[0][:, None]).reshape(len(r), 9)
        return np.asarray((field[..., element, :] * weights).sum(axis=-1))

    def displacement(self, u: FloatArray, points: ArrayLike) -> FloatArray:
        """u_r and u_z (2, n) at points (n, 2)."""
        r, z = np.asarray(points, dtype=float).T
        element, local = self.grid.find(r, z)
        dofs = np.asarray(self.basis.element_dofs)[:, element]
        displacement = np.zeros((2, len(r)))
        for k in range(len(dofs)):
            (shape,) = self.basis.elem.gbasis(self.basis.mapping, local[:, :, None], k, tind=element)
            displacement += u[dofs[k]] * np.asarray(shape)[..., 0]
        return displacement


def _basis(grid: Grid) -> CellBasis:
    places = np.stack(np.meshgrid(_PLACES, _PLACES)).reshape(2, -1)
    rule = (places, np.outer(_WEIGHTS, _WEIGHTS).ravel())
    return CellBasis(grid.mesh, ElementVector(ElementQuad2()), quadrature=rule)


def _lagrange(x: FloatArray) -> FloatArray:
    """Polynomials (n, 3) through the integration points of an edge."""
    a, b, c = _PLACES
    return np.stack(
        (
            (x - b) * (x - c) / ((a - b) * (a - c)),
            (x - a) * (x - c) / ((b - a) * (b - c)),
            (x - a) * (x - b) / ((c - a) * (c - b)),
        ),
        axis=1,
    )
