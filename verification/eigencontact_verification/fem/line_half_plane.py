"""One body of a line contact for the solver: its unknowns after condensation, and its inner forces by them.

A body with a law has all unknowns of its mesh. An elastic body has those of the surface of possible contact: its
stiffness is condensed onto them once, ``S = K_ss - K_si K_ii^-1 K_is``, and the loads by the far field, the remote
stress and the eigenstrain in each increment. The interior follows from the surface where stress is read.
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
#: Force at the unknowns, its derivative, the new states, and stress where it needs no further work.
Inner = tuple[FloatArray, Any, tuple[State, ...], FloatArray | None]

#: Number of columns that are condensed together.
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
        """Material and layers of the body."""
        return self.model.bodies[self.number]

    @cached_property
    def facets(self) -> tuple[FloatArray, IntArray, IntArray]:
        """Weights (n,) of the surface nodes by rising x; numbers of their u_z and u_x among all unknowns."""
        basis = self.body.basis
        mesh, (low, high) = basis.mesh, self.model.window
        edges = mesh.boundary_facets()
        ends = mesh.p[:, mesh.facets[:, edges]]
        tiny = 1e-9 * (high - low)
        facing = np.all(ends[1] == 0, axis=0) & np.all((ends[0] > low - tiny) & (ends[0] < high + tiny), axis=0)
        edges, length = edges[facing], np.abs(np.diff(ends[0][:, facing], axis=0))[0]
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
    def unknowns(self) -> IntArray:
        """Numbers of the unknowns of the solver among all unknowns of the mesh."""
        _, across, along = self.facets
        return np.concatenate((across, along)) if self.material.elastic else np.arange(self.body.basis.N)

    @cached_property
    def surface(self) -> tuple[IntArray, IntArray]:
        """Places of u_z and u_x of the surface nodes among `unknowns`."""
        _, across, along = self.facets
        return (
            (np.arange(len(across)), np.arange(len(across)) + len(across)) if self.material.elastic else (across, along)
        )

    @cached_property
    def prescribed(self) -> NDArray[np.bool_]:
        """Displacements that the far field prescribes: the whole outer boundary, or three that stop rigid motion."""
        x, z = self.body.basis.doflocs
        reach = self.model.reach
        if self.model.outer == "fixed":
            return np.asarray((np.abs(x) == reach) | (z == reach))
        corner = (z == reach) & (np.abs(x) == reach)
        return np.asarray(corner & ~(self.body.first_component & (x > 0)))

    @property
    def free(self) -> NDArray[np.bool_]:
        """Unknowns without a prescribed displacement."""
        return np.asarray(~self.prescribed[self.unknowns])

    def _loads(self, step: LineStep) -> tuple[float, float, float]:
        """Normal force, shear and remote stress of this body."""
        return step.normal, (step.shear, -step.shear)[self.number], step.bulk[self.number]

    def far(self, step: LineStep) -> FloatArray:
        """Prescribed displacement (all unknowns,), zero elsewhere."""
        displacement = np.zeros(self.body.basis.N)
        prescribed = np.flatnonzero(self.prescribed)
        x, z = self.body.basis.doflocs[:, prescribed]
        moduli = self.material.young_modulus, self.material.poisson_ratio
        normal, shear, bulk = self._loads(step)
        components = line_force_displacement(normal, shear, *moduli, x - step.place, z)
        components += stretched_displacement(bulk, *moduli, x, z)
        displacement[prescribed] = np.where(self.body.first_component[prescribed], *components)
        return displacement

    @cached_property
    def _rim(self) -> FacetBasis:
        """Sides and base."""
        basis, reach = self.body.basis, self.model.reach
        outer = basis.mesh.facets_satisfying(lambda x: (np.abs(x[0]) == reach) | (x[1] == reach), boundaries_only=True)
        return FacetBasis(basis.mesh, basis.elem, facets=outer, intorder=9)

    def _pull(self, step: LineStep) -> FloatArray:
        """Forces (all unknowns,) on free sides and base."""
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
        force, matrix, _, _ = body.forces(np.zeros(body.basis.N), body.state_at_rest())
        unknowns = self.unknowns
        interior = np.setdiff1d(np.flatnonzero(~self.prescribed), unknowns).astype(np.int64)
        rows = matrix.tocsr()
        inner, between = rows[interior], rows[unknowns]
        factors = splu(
            inner[:, interior].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        coupling = inner[:, unknowns].tocsc()
        stiffness = between[:, unknowns].toarray()
        between = between[:, interior]
        for k in range(0, len(unknowns), _AT_ONCE):
            columns = np.s_[:, k : k + _AT_ONCE]
            stiffness[columns] -= between @ factors.solve(coupling[columns].toarray())
        return factors, interior, rows, between, coupling, (stiffness + stiffness.T) / 2, force

    def boundary_change(self, before: LineStep, after: LineStep) -> FloatArray:
        """Change (unknowns,) of the prescribed displacement from one step to another."""
        return (self.far(after) - self.far(before))[self.unknowns]

    def _right_hand_side(self, step: LineStep) -> FloatArray:
        """Forces (all unknowns,) of the far field and of the eigenstrain on an elastic body without displacement."""
        _, _, matrix, _, _, _, force = self._condensed
        return np.asarray(self._pull(step) - matrix @ self.far(step) - force)

    def load(self, step: LineStep) -> FloatArray:
        """Forces (unknowns,) of the far field; on an elastic body also those of the eigenstrain."""
        if not self.material.elastic:
            return self._pull(step)
        factors, interior, _, between, _, _, _ = self._condensed
        forces = self._right_hand_side(step)
        return np.asarray(forces[self.unknowns] - between @ factors.solve(forces[interior]))

    def answer(self, displacement: FloatArray, before: tuple[State, ...], load: FloatArray) -> Inner:
        """Inner forces by the displacement of the unknowns, less those of `load`."""
        if self.material.elastic:
            stiffness = self._condensed[5]
            return stiffness @ displacement - load, stiffness, before, None
        force, matrix, after, stress = self.body.forces(displacement, before)
        return force - load, matrix, after, stress

    def stress(self, condensed: FloatArray, step: LineStep) -> FloatArray:
        """Stress (4, elements, 9) of an elastic body: xx, yy, zz, sqrt2 xz at the integration points."""
        factors, interior, _, _, coupling, _, _ = self._condensed
        displacement = self.far(step)
        displacement[self.unknowns] = condensed
        displacement[interior] = factors.solve(self._right_hand_side(step)[interior] - coupling @ condensed)
        return self.body.answer(displacement, self.body.state_at_rest())[0]
