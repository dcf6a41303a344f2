"""One body of a line contact for the solver: the unknowns that it keeps, and its inner forces by them.

A body with a law keeps all of its unknowns. An elastic one keeps those of the surface where contact is looked for: its
stiffness is condensed onto them once, ``S = K_ss - K_si K_ii^-1 K_is``, and in each increment what the far field, the
remote stress and the eigenstrain do. The rest follows from the surface where stress is read.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import splu
from skfem import FacetBasis, LinearForm

from eigencontact_verification.fem.line_contact_model import LineBody, LineContact, LineStep
from eigencontact_verification.fem.plane_strain import (
    PlaneBody,
    line_force_displacement,
    line_force_stress,
    stretched_displacement,
)
from eigencontact_verification.fem.yielding_law import State

__all__ = ["HalfPlane", "Inner"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
#: Force by the kept unknowns, its derivative, the states that follow, and stress where it is known without more work.
Inner = tuple[FloatArray, Any, tuple[State, ...], FloatArray | None]

#: Columns that are condensed at a time.
_AT_ONCE = 100


@dataclass(frozen=True, kw_only=True, eq=False)
class HalfPlane:
    """Body of a number from 0; body 1 lies above, mirrored.

    Attributes
    ----------
    model : LineContact
    number : int
    body : PlaneBody
    """

    model: LineContact
    number: int
    body: PlaneBody

    @property
    def material(self) -> LineBody:
        """What it is made of."""
        return self.model.bodies[self.number]

    @cached_property
    def facets(self) -> tuple[FloatArray, IntArray, IntArray]:
        """Weights (n,) of the surface nodes by rising x; numbers of their u_z and u_x among all unknowns."""
        basis = self.body.basis
        mesh, (low, high) = basis.mesh, self.model.window
        edges = mesh.boundary_facets()
        ends = mesh.p[:, mesh.facets[:, edges]]
        tiny = 1e-9 * (high - low)
        kept = np.all(ends[1] == 0, axis=0) & np.all((ends[0] > low - tiny) & (ends[0] < high + tiny), axis=0)
        edges, length = edges[kept], np.abs(np.diff(ends[0][:, kept], axis=0))[0]
        corners = mesh.facets[:, edges]
        across = np.concatenate((*basis.nodal_dofs[1][corners], basis.facet_dofs[1][edges]))
        along = np.concatenate((*basis.nodal_dofs[0][corners], basis.facet_dofs[0][edges]))
        weight = np.bincount(across, np.concatenate((length / 6, length / 6, length * 4 / 6)), minlength=basis.N)
        across, first = np.unique(across, return_index=True)
        order = np.argsort(basis.doflocs[0, across])
        across = across[order]
        return weight[across], across, np.asarray(along[first][order], dtype=np.int64)

    @property
    def x(self) -> FloatArray:
        """Surface nodes."""
        return np.asarray(self.body.basis.doflocs[0, self.facets[1]])

    @cached_property
    def kept(self) -> IntArray:
        """Numbers of the unknowns that it keeps."""
        _, across, along = self.facets
        return np.concatenate((across, along)) if self.material.elastic else np.arange(self.body.basis.N)

    @cached_property
    def surface(self) -> tuple[IntArray, IntArray]:
        """Places of u_z and u_x of the surface nodes among the kept unknowns."""
        _, across, along = self.facets
        return (
            (np.arange(len(across)), np.arange(len(across)) + len(across)) if self.material.elastic else (across, along)
        )

    @cached_property
    def held(self) -> NDArray[np.bool_]:
        """Unknowns that the far field moves: all of the outer boundary, or three that stop rigid motion."""
        x, z = self.body.basis.doflocs
        reach = self.model.reach
        if self.model.outer == "fixed":
            return np.asarray((np.abs(x) == reach) | (z == reach))
        corner = (z == reach) & (np.abs(x) == reach)
        return np.asarray(corner & ~(self.body.first_component & (x > 0)))

    @property
    def free(self) -> NDArray[np.bool_]:
        """Which kept unknowns are not held."""
        return np.asarray(~self.held[self.kept])

    def _loads(self, step: LineStep) -> tuple[float, float, float]:
        """Normal force, shear and remote stress of this body."""
        return step.normal, (step.shear, -step.shear)[self.number], step.bulk[self.number]

    def far(self, step: LineStep) -> FloatArray:
        """Displacement (unknowns,) of what is held, zero elsewhere."""
        found = np.zeros(self.body.basis.N)
        here = np.flatnonzero(self.held)
        x, z = self.body.basis.doflocs[:, here]
        moduli = self.material.young_modulus, self.material.poisson_ratio
        normal, shear, bulk = self._loads(step)
        both = line_force_displacement(normal, shear, *moduli, x - step.place, z)
        both += stretched_displacement(bulk, *moduli, x, z)
        found[here] = np.where(self.body.first_component[here], *both)
        return found

    @cached_property
    def _rim(self) -> FacetBasis:
        """Sides and base."""
        basis, reach = self.body.basis, self.model.reach
        outer = basis.mesh.facets_satisfying(lambda x: (np.abs(x[0]) == reach) | (x[1] == reach), boundaries_only=True)
        return FacetBasis(basis.mesh, basis.elem, facets=outer, intorder=9)

    def _pull(self, step: LineStep) -> FloatArray:
        """Forces (unknowns,) on free sides and base."""
        if self.model.outer == "fixed":
            return np.zeros(self.body.basis.N)

        def work(v: object, w: object) -> object:
            return w.t_x * v[0] + w.t_z * v[1]  # type: ignore[attr-defined, index]

        (n_x, n_z), (x, z) = np.asarray(self._rim.normals), np.asarray(self._rim.global_coordinates())
        normal, shear, bulk = self._loads(step)
        s_xx, s_zz, s_xz = line_force_stress(normal, shear, x - step.place, z)
        remote = bulk * self.material.stretched(z)
        loads = {"t_x": (s_xx + remote) * n_x + s_xz * n_z, "t_z": s_xz * n_x + s_zz * n_z}
        return np.asarray(LinearForm(work).assemble(self._rim, **loads))

    @cached_property
    def _condensed(self) -> tuple[Any, IntArray, Any, Any, Any, FloatArray, FloatArray]:
        """Factors of K_ii, the inner unknowns, K, K_si, K_is, S, and the forces of the eigenstrain."""
        body = self.body
        force, matrix, _, _ = body.forces(np.zeros(body.basis.N), body.rest())
        kept = self.kept
        loose = np.setdiff1d(np.flatnonzero(~self.held), kept).astype(np.int64)
        rows = matrix.tocsr()
        inner, between = rows[loose], rows[kept]
        factors = splu(
            inner[:, loose].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
        coupling = inner[:, kept].tocsc()
        stiffness = between[:, kept].toarray()
        between = between[:, loose]
        for k in range(0, len(kept), _AT_ONCE):
            part = np.s_[:, k : k + _AT_ONCE]
            stiffness[part] -= between @ factors.solve(coupling[part].toarray())
        return factors, loose, rows, between, coupling, (stiffness + stiffness.T) / 2, force

    def moved(self, before: LineStep, after: LineStep) -> FloatArray:
        """Change (kept,) of what is held from one step to another."""
        return (self.far(after) - self.far(before))[self.kept]

    def _right(self, step: LineStep) -> FloatArray:
        """Forces (unknowns,) of the far field and of the eigenstrain on an elastic body that does not move."""
        _, _, matrix, _, _, _, force = self._condensed
        return np.asarray(self._pull(step) - matrix @ self.far(step) - force)

    def load(self, step: LineStep) -> FloatArray:
        """Forces (kept,) of the far field, and of the eigenstrain on an elastic body."""
        if not self.material.elastic:
            return self._pull(step)
        factors, loose, _, between, _, _, _ = self._condensed
        right = self._right(step)
        return np.asarray(right[self.kept] - between @ factors.solve(right[loose]))

    def answer(self, kept: FloatArray, before: tuple[State, ...], load: FloatArray) -> Inner:
        """Inner forces by the kept unknowns, less those of `load`."""
        if self.material.elastic:
            stiffness = self._condensed[5]
            return stiffness @ kept - load, stiffness, before, None
        force, matrix, after, stress = self.body.forces(kept, before)
        return force - load, matrix, after, stress

    def stress(self, kept: FloatArray, step: LineStep) -> FloatArray:
        """Stress (4, elements, 9) of an elastic body: xx, yy, zz, sqrt2 xz at the integration points."""
        factors, loose, _, _, coupling, _, _ = self._condensed
        found = self.far(step)
        found[self.kept] = kept
        found[loose] = factors.solve(self._right(step)[loose] - coupling @ kept)
        return self.body.answer(found, self.body.rest())[0]
