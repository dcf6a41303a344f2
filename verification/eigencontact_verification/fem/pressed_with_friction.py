"""A rigid sphere pressed with friction onto a coated half-space: rings of traction on axisymmetric finite elements.

Pressure and radial shear are linear between the ends of rings. The elements give the surface displacement of each hat
of traction, so that coating and substrate enter by them alone. Contact grows by one ring in a step; in each, the
unknown hats and the approach follow from one linear system:

* the surface follows the paraboloid r²/(2R) at all nodes up to the edge of contact, where the pressure ends;
* nodes that stick keep the radial displacement that they had when they came into contact;
* nodes that slip carry the friction times the pressure; which ones do is found by exchange.

Without coating the problem is Spence's, with the coupling of shear and pressure that his solution leaves out.

Conventions: z into the body; pressure positive in compression; shear acts on the body, positive outwards. Units:
Young's modulus of the substrate, thickness of the coating, radius of the sphere (stress is proportional to its
reciprocal).

References
----------
D. A. Spence 1975, J. Elasticity 5, 297 (self-similar stick circle); L. E. Goodman 1962, J. Appl. Mech. 29, 515.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse.linalg import splu
from skfem import FacetBasis, LinearForm

from eigencontact_verification.fem.axisymmetric import AxisymmetricSolution, _assemble, _bases, _prescribed, _traction
from eigencontact_verification.fem.axisymmetric_model import AxisymmetricLayer, AxisymmetricModel
from eigencontact_verification.fem.model import lame

__all__ = ["CoatedRings", "Pressed"]

FloatArray = NDArray[np.float64]
_REACH = 40.0
#: Exchanges of sticking and slipping nodes in a step.
_EXCHANGES = 200


@dataclass(frozen=True, kw_only=True, eq=False)
class Pressed:
    """A step of the contact.

    Attributes
    ----------
    radius, load : float
        Contact radius a; P.
    pressure, shear : (n,) arrays
        p and q at the nodes; zero from the edge of contact on.
    sticking : int
        Number of nodes that stick, that on the axis among them.
    """

    radius: float
    load: float
    pressure: FloatArray
    shear: FloatArray
    sticking: int

    def towards(self, end: Pressed, load: float) -> Pressed:
        """State at a load between two steps, linear between them."""
        t = (load - self.load) / (end.load - self.load)
        radius, pressure, shear = (
            (1 - t) * np.asarray(getattr(self, name)) + t * np.asarray(getattr(end, name))
            for name in ("radius", "pressure", "shear")
        )
        return Pressed(radius=float(radius), load=load, pressure=pressure, shear=shear, sticking=end.sticking)


@dataclass(frozen=True, kw_only=True, eq=False)
class CoatedRings:
    """Rings on a coated half-space.

    Attributes
    ----------
    ratio : float
        Young's modulus of the coating over that of the substrate; 1 is no coating.
    poisson_ratio : float
        Of both.
    largest : float
        Radius that contact may reach, in thicknesses.
    per_thickness : int
        Rings to a thickness.
    """

    ratio: float
    poisson_ratio: float
    largest: float
    per_thickness: int

    @property
    def nodes(self) -> FloatArray:
        """Ends of the rings (n + 1,), from 0."""
        return np.arange(round(self.largest * self.per_thickness) + 1) / self.per_thickness

    @cached_property
    def _system(self) -> tuple[AxisymmetricModel, Any, Any, NDArray[np.bool_], dict[str, FloatArray], FloatArray]:
        """Model, mesh, basis, radial unknowns; displacement of hats of pressure and of shear; force of the former."""
        nodes, n = self.nodes, self.per_thickness
        depths = np.union1d(np.linspace(0.0, 0.25, n // 4 + 1), np.linspace(0.25, 1.3, max(22, n // 2)))
        coating = AxisymmetricLayer(thickness=1.0, young_modulus=self.ratio, poisson_ratio=self.poisson_ratio)
        model = AxisymmetricModel(
            young_modulus=1.0, poisson_ratio=self.poisson_ratio, reach=_REACH, fine=1.0 / n, layers=(coating,),
            lines=((*nodes[1:], self.largest + 0.2), tuple(depths)),
        )  # fmt: skip
        grid = model.grid()
        stiffness: Any = 0.0
        for basis, material in _bases(model, grid):
            lam, mu = lame(material[0], material[1])
            stiffness = stiffness + _assemble(basis, lam, mu, np.zeros((4, *lam.shape)))[0]
        prescribed, radial = _prescribed(model, basis, everywhere=False)
        free = np.setdiff1d(np.arange(basis.N), prescribed)
        factors = splu(
            stiffness[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )  # fmt: skip
        loaded = basis.mesh.facets_satisfying(lambda x: (x[1] == 0) & (x[0] < nodes[-1] + 1e-9), boundaries_only=True)
        rim = FacetBasis(basis.mesh, basis.elem, facets=loaded, intorder=8)
        r = np.asarray(rim.global_coordinates())[0]
        displacement, force = {}, np.zeros(0)
        for kind in ("pressure", "shear"):
            loads = []
            for node in nodes[:-1]:
                hat = np.maximum(0.0, 1.0 - np.abs(r - node) * n)
                traction = {"t_r": 0.0 * hat, "t_z": hat} if kind == "pressure" else {"t_r": hat, "t_z": 0.0 * hat}
                loads.append(np.asarray(LinearForm(_traction).assemble(rim, **traction)))
            columns = np.stack(loads, axis=1)
            displacement[kind] = np.zeros_like(columns)
            displacement[kind][free] = factors.solve(np.ascontiguousarray(columns[free]))
            if kind == "pressure":
                force = 2 * np.pi * columns[~radial].sum(axis=0)
        return model, grid, basis, radial, displacement, force

    @cached_property
    def _influence(self) -> tuple[FloatArray, FloatArray]:
        """Displacement u_z and u_r at the nodes (rows) by hats of pressure and of shear (columns)."""
        _, _, basis, _, displacement, _ = self._system
        influence = np.hstack([displacement["pressure"], displacement["shear"]])
        r, z = basis.doflocs[:, basis.nodal_dofs[0]]
        top = np.flatnonzero((z == 0) & (r < self.nodes[-1] + 1e-9))
        top = top[np.argsort(r[top])]
        return influence[basis.nodal_dofs[1, top]], influence[basis.nodal_dofs[0, top]]

    def press(self, friction: float) -> Iterator[Pressed]:
        """Steps of a contact that grows ring by ring.

        Raises
        ------
        RuntimeError
            Sticking and slipping nodes that go on being exchanged.
        """
        normal, radial = self._influence
        n = len(self.nodes) - 1
        before = np.zeros(n + 1)
        for k in range(1, n + 1):
            columns = np.r_[0:k, n : n + k]
            stick, way = np.full(k, friction > 0), np.zeros(k)
            stick[0] = False  # on the axis there is no shear
            for _ in range(_EXCHANGES):
                matrix, right = np.zeros((2 * k + 1, 2 * k + 1)), np.zeros(2 * k + 1)
                matrix[: k + 1, :-1], matrix[: k + 1, -1] = normal[: k + 1, columns], -1.0
                right[: k + 1] = -(self.nodes[: k + 1] ** 2) / 2
                rows = np.arange(k)
                matrix[k + 1 + rows[stick], :-1] = radial[np.ix_(rows[stick], columns)]
                right[k + 1 + rows[stick]] = before[:k][stick]
                slip = rows[~stick]
                matrix[k + 1 + slip, k + slip], matrix[k + 1 + slip, slip] = 1.0, -friction * way[slip]
                p, q = np.split(np.linalg.solve(matrix, right)[:-1], 2)
                moved = radial[:, columns] @ np.r_[p, q]
                over = stick & (np.abs(q) > friction * p * (1 + 1e-9))
                back = ~stick & (way * (moved[:k] - before[:k]) > 1e-14)
                if not (over.any() or back.any()):
                    break
                way[over] = np.sign(q[over])
                stick = (stick & ~over) | back
            else:
                raise RuntimeError(f"contact of {k} rings must find its stick circle (got {_EXCHANGES} exchanges)")
            before = moved
            pressure, shear = np.zeros((2, n))
            pressure[:k], shear[:k] = p, q
            yield Pressed(
                radius=float(self.nodes[k]), load=float(self._system[-1] @ pressure), pressure=pressure, shear=shear,
                sticking=int(stick.sum() + 1),
            )  # fmt: skip

    def at_load(self, load: float, friction: float) -> Pressed:
        """State at a load.

        Raises
        ------
        ValueError
            A load that needs more rings.
        """
        last: Pressed | None = None
        for state in self.press(friction):
            if state.load >= load and last is not None:
                return last.towards(state, load)
            last = state
        raise ValueError(f"largest must hold the contact (got {self.largest}); raise it")

    def stress(self, state: Pressed, points: ArrayLike) -> FloatArray:
        """Stress (n, 3, 3) at points (n, 3)."""
        model, grid, basis, _, displacement, _ = self._system
        vector = displacement["pressure"] @ state.pressure + displacement["shear"] @ state.shear
        whole = AxisymmetricSolution(model=model, grid=grid, basis=basis, vector=vector, unknowns=0, seconds=0.0)
        return whole.stress(points)
