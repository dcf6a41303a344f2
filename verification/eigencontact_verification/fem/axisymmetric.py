"""Axisymmetric linear elasticity with eigenstrain on nine-node quadrilaterals, solved directly.

Unknowns u_r, u_z in the half plane (r, z); strains ``e_rr = u_r,r``, ``e_tt = u_r / r``, ``e_zz = u_z,z`` and
``e_rz = (u_r,z + u_z,r)/2``; all integrals carry the weight r (the factor 2 pi is left out on both sides). Eigenstrain
enters as the load ``∫ C e* : e(v)``, as anisotropic thermal expansion does; a remote stress S as
``-∫ (C - C0) C0^-1 S : e(v)`` over the regions of other moduli, for the disturbance of the uniform state.

References
----------
O. C. Zienkiewicz and R. L. Taylor, The Finite Element Method, chapter on axisymmetric stress analysis;
K. L. Johnson 1985, Contact Mechanics, section 3.2 (quoted as J.).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu
from skfem import CellBasis, ElementQuad2, ElementVector, FacetBasis, LinearForm

from eigencontact_verification.fem.axisymmetric_loads import (
    point_force_displacement,
    point_force_stress,
    surface_load,
)
from eigencontact_verification.fem.axisymmetric_mesh import Grid
from eigencontact_verification.fem.axisymmetric_model import (
    AxisymmetricLayer,
    AxisymmetricModel,
    AxisymmetricRegion,
    Disc,
)
from eigencontact_verification.fem.model import lame, von_mises

__all__ = [
    "AxisymmetricLayer",
    "AxisymmetricModel",
    "AxisymmetricRegion",
    "AxisymmetricSolution",
    "Disc",
    "point_force_displacement",
    "point_force_stress",
    "solve_axisymmetric",
    "surface_load",
]

FloatArray = NDArray[np.float64]
Field = Callable[[FloatArray, FloatArray], ArrayLike]

#: Gauss points each way in an element, in a sub-cell, and sub-cells each way in an element that a boundary cuts.
_POINTS, _CUT_POINTS, _CELLS = 4, 2, 8
#: The same of elements that hold stored cells, whose fields bend at the cells' faces.
_STORED = (3, 3)
#: Integration points that are worked on at a time.
_CHUNK = 1 << 15


def _strains(basis: CellBasis, elements: slice) -> FloatArray:
    """Strains e_rr, e_tt, e_zz, 2 e_rz of the shape functions, (4, elements, functions, points)."""
    value = np.array([np.asarray(shape)[0, elements] for (shape,) in basis.basis])
    grad = np.array([shape.grad[:, :, elements] for (shape,) in basis.basis])
    r = np.asarray(basis.global_coordinates())[0, elements]
    strains = np.stack((grad[:, 0, 0], value / r, grad[:, 1, 1], grad[:, 0, 1] + grad[:, 1, 0]))
    return np.swapaxes(strains, 1, 2)


def _assemble(basis: CellBasis, lam: FloatArray, mu: FloatArray, initial: FloatArray) -> tuple[csc_matrix, FloatArray]:
    """Stiffness matrix, and load vector of an initial stress s_rr, s_tt, s_zz, s_rz, (4, elements, points)."""
    dofs = np.asarray(basis.element_dofs).T
    count = dofs.shape[1]
    matrices = np.empty((len(dofs), count, count))
    load = np.zeros(basis.N)
    weight = basis.dx * np.asarray(basis.global_coordinates())[0]
    step = max(1, _CHUNK // weight.shape[1])
    for elements in (slice(k, k + step) for k in range(0, len(dofs), step)):
        strains = _strains(basis, elements)
        w, first, second = (x[elements, None] for x in (weight, lam, mu))
        stresses = 2 * second * strains
        stresses[3] /= 2
        stresses[:3] += first * strains[:3].sum(axis=0)
        matrices[elements] = sum(np.matmul(w * stresses[k], np.swapaxes(strains[k], 1, 2)) for k in range(4))
        force = sum(initial[k, elements, None] * strains[k] for k in range(4))
        np.add.at(load, dofs[elements], (w * force).sum(axis=2))
    rows, columns = (np.broadcast_to(x, matrices.shape).ravel() for x in (dofs[:, :, None], dofs[:, None]))
    return csc_matrix((matrices.ravel(), (rows, columns)), shape=(basis.N, basis.N)), load


def _body(v: Any, w: Any) -> Any:
    return (w.f_r * v[0] + w.f_z * v[1]) * w.x[0]


def _traction(v: Any, w: Any) -> Any:
    return (w.t_r * v[0] + w.t_z * v[1]) * w.x[0]


def _square_rule(points: int, cells: int = 1) -> tuple[FloatArray, FloatArray]:
    """Gauss rule on the unit square cut into ``cells`` x ``cells``: places (2, n), weights (n,)."""
    x, w = np.polynomial.legendre.leggauss(points)
    places = ((np.arange(cells)[:, None] + (x + 1) / 2) / cells).ravel()
    weights = np.tile(w / 2 / cells, cells)
    return np.stack(np.meshgrid(places, places)).reshape(2, -1), np.outer(weights, weights).ravel()


def _stress(material: FloatArray, strain: FloatArray) -> FloatArray:
    """Stress s_rr, s_tt, s_zz, s_rz of strains e_rr, e_tt, e_zz, e_rz, (4, ...)."""
    lam, mu = lame(material[0], material[1])
    stress = 2 * mu * strain
    stress[:3] += lam * strain[:3].sum(axis=0)
    return np.asarray(stress)


def _remote_strain(model: AxisymmetricModel) -> FloatArray:
    """Strain e_rr, e_tt, e_zz, e_rz far away, (4,)."""
    if model.remote_stress is None:
        return np.zeros(4)
    s_r, s_z = model.remote_stress
    E, nu = model.young_modulus, model.poisson_ratio
    e_r = ((1 - nu) * s_r - nu * s_z) / E
    return np.array([e_r, e_r, (s_z - 2 * nu * s_r) / E, 0.0])


def _bases(model: AxisymmetricModel, grid: Grid) -> Iterator[tuple[CellBasis, FloatArray]]:
    """Bases over the whole and over the cut elements, each with the material at its points, (4, elements, points)."""
    mesh = grid.mesh
    cut = np.zeros(mesh.nelements, dtype=bool)
    fine = _square_rule(_CUT_POINTS, _CELLS)
    low, high = grid.nodes.min(axis=1), grid.nodes.max(axis=1)
    mapping = mesh.mapping()
    for region in model.regions:
        if region.fitted:
            continue
        near = np.all([(high[k] > region.bounds[0][k]) & (low[k] < region.bounds[1][k]) for k in (0, 1)], axis=0)
        ids = np.flatnonzero(near)
        places = mapping.F(fine[0], ids)
        inside = region.contains(places[0], places[1])
        cut[ids] |= inside.any(axis=1) & ~inside.all(axis=1)
    stored = np.zeros_like(cut)
    for cells in model.cells:
        stored |= np.all([(high[k] > cells.bounds[0][k]) & (low[k] < cells.bounds[1][k]) for k in (0, 1)], axis=0)
    plain, mixed = ~cut & ~stored, ~cut & stored
    rules = ((plain, _square_rule(_POINTS)), (mixed, _square_rule(*_STORED)), (cut, fine))
    for ids, rule in ((np.flatnonzero(chosen), rule) for chosen, rule in rules):
        if ids.size:
            basis = CellBasis(mesh, ElementVector(ElementQuad2()), elements=ids, quadrature=rule)
            places = np.asarray(basis.global_coordinates())
            yield basis, model.material(places[0], places[1], grid, ids)


def _prescribed(
    model: AxisymmetricModel, basis: CellBasis, *, everywhere: bool
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Unknowns with a given displacement, and which unknowns are radial.

    On the axis u_r; on the outer boundary both, or only u_z on its edge, the point farthest from the sources.
    """
    r, z = basis.doflocs
    radial = np.zeros(basis.N, dtype=bool)
    for dofs in (basis.nodal_dofs, basis.facet_dofs, basis.interior_dofs):
        radial[dofs[0]] = True
    axis, side, base = radial & (r == 0), r == model.reach, z == model.reach
    if everywhere:
        prescribed = axis | side | base | (z == 0)
    else:
        prescribed = axis | side | base if model.outer == "fixed" else axis | (side & base & ~radial)
    return np.flatnonzero(prescribed), radial


def _outer_traction(model: AxisymmetricModel, basis: CellBasis) -> FloatArray:
    """Load vector of the traction on side and base of a free model that balances the discs."""
    if model.far_field:
        return point_force_traction(basis, model.reach, model.load, model.poisson_ratio)
    rim = _rim(basis, model.reach)
    on_side = np.asarray(rim.normals)[0] > 0.5
    t_z = np.where(on_side, 0.0, -model.load / (np.pi * model.reach**2))
    return np.asarray(LinearForm(_traction).assemble(rim, t_r=np.zeros_like(t_z), t_z=t_z))


def _rim(basis: CellBasis, reach: float) -> FacetBasis:
    """Side and base of the mesh."""
    outer = basis.mesh.facets_satisfying(lambda x: (x[0] == reach) | (x[1] == reach), boundaries_only=True)
    return FacetBasis(basis.mesh, basis.elem, facets=outer, intorder=9)


def point_force_traction(basis: CellBasis, reach: float, load: float, poisson_ratio: float) -> FloatArray:
    """Load vector of the traction on side and base under a point force on the surface."""
    rim = _rim(basis, reach)
    on_side = np.asarray(rim.normals)[0] > 0.5
    s_rr, s_zz, s_rz = point_force_stress(load, poisson_ratio, *np.asarray(rim.global_coordinates()))
    t_r, t_z = np.where(on_side, s_rr, s_rz), np.where(on_side, s_rz, s_zz)
    return np.asarray(LinearForm(_traction).assemble(rim, t_r=t_r, t_z=t_z))


def solve_axisymmetric(
    model: AxisymmetricModel, *, body_force: Field | None = None, prescribed: Field | None = None
) -> AxisymmetricSolution:
    """Solve a model.

    Parameters
    ----------
    model : AxisymmetricModel
        What to solve.
    body_force : callable, optional
        ``body_force(r, z)`` -> (f_r, f_z), force per volume; for manufactured solutions.
    prescribed : callable, optional
        ``prescribed(r, z)`` -> (u_r, u_z) on the whole boundary, the surface too, instead of the model's condition.

    Returns
    -------
    AxisymmetricSolution
        Displacement and stress at any points of the body.

    Examples
    --------
    >>> disc = Disc(radius=1.0, pressure=1.0)  # in the middle u_z = 2 (1 - nu^2) p a / E
    >>> model = AxisymmetricModel(
    ...     young_modulus=1.0, poisson_ratio=0.0, reach=20.0, fine=0.1, discs=(disc,), far_field=True
    ... )
    >>> solution = solve_axisymmetric(model)
    >>> round(float(solution.displacement([[0.0, 0.0, 0.0]])[0, 2]), 3)
    2.0
    """
    start = time.perf_counter()
    grid = model.grid()
    remote = _remote_strain(model)
    uniform = _stress(np.array([model.young_modulus, model.poisson_ratio]), remote)[:, None, None]
    matrix: Any = 0.0
    load: Any = 0.0
    for basis, material in _bases(model, grid):
        lam, mu = lame(material[0], material[1])
        initial_stress = _stress(material, material[2:] - remote[:, None, None])
        contribution = _assemble(basis, lam, mu, initial_stress + uniform)
        matrix, load = matrix + contribution[0], load + contribution[1]
        if body_force is not None:
            f_r, f_z = np.asarray(body_force(*np.asarray(basis.global_coordinates())))
            load = load + LinearForm(_body).assemble(basis, f_r=f_r, f_z=f_z)
    for disc in model.discs:
        load = load + surface_load(disc, basis)
    prescribed_unknowns, radial = _prescribed(model, basis, everywhere=prescribed is not None)
    far = np.zeros(basis.N)  # what the resultant load would do to a half-space, on the outer boundary
    if model.far_field and prescribed is None:
        outer = np.flatnonzero((basis.doflocs == model.reach).any(axis=0))
        u_r, u_z = point_force_displacement(
            model.load, model.young_modulus, model.poisson_ratio, *basis.doflocs[:, outer]
        )
        far[outer] = np.where(radial[outer], u_r, u_z)
    u = np.zeros(basis.N)
    if prescribed is not None:
        values = np.asarray(prescribed(*basis.doflocs[:, prescribed_unknowns]))
        u[prescribed_unknowns] = np.where(radial[prescribed_unknowns], values[0], values[1])
    elif model.outer == "fixed":
        u[prescribed_unknowns] = far[prescribed_unknowns]
    pull = np.zeros(basis.N)
    if model.load and model.outer == "free" and prescribed is None:
        pull = _outer_traction(model, basis)
    free = np.setdiff1d(np.arange(basis.N), prescribed_unknowns)
    inner = matrix[free]
    residual = (load + pull)[free] - inner @ u
    factors = splu(inner[:, free], permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    u[free] = factors.solve(residual)
    if model.far_field and pull.any():  # the outer traction does the same work on both displacements
        u[~radial] -= pull @ (u - far) / pull[~radial].sum()
    return AxisymmetricSolution(
        model=model, grid=grid, basis=basis, vector=u, unknowns=int(free.size), seconds=time.perf_counter() - start
    )


@dataclass(frozen=True, kw_only=True)
class AxisymmetricSolution:
    """Displacement and stress of a model.

    Attributes
    ----------
    model : AxisymmetricModel
    unknowns : int
        Free unknowns of the linear system.
    seconds : float
        Time for mesh, assembly and factorisation.
    iterations : int
        0: the system is solved directly.
    """

    model: AxisymmetricModel
    grid: Grid
    basis: CellBasis
    vector: FloatArray
    unknowns: int
    seconds: float
    iterations: int = 0

    def _place(self, points: ArrayLike) -> tuple[FloatArray, FloatArray, NDArray[np.int64], FloatArray, FloatArray]:
        x = np.atleast_2d(np.asarray(points, dtype=float))
        r = np.hypot(x[:, 0], x[:, 1])
        element, local = self.grid.find(r, x[:, 2])
        on_axis = r < 1e-9 * self.model.fine  # u_r / r is noise; its limit is u_r,r
        safe = np.where(on_axis, 1.0, r)
        turn = np.stack((np.where(on_axis, 1.0, x[:, 0] / safe), np.where(on_axis, 0.0, x[:, 1] / safe)))
        return np.stack((r, x[:, 2])), turn, element, local, on_axis

    def _interpolate(self, element: NDArray[np.int64], local: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Displacement (2, n) and its gradient (2, 2, n) at local coordinates of elements."""
        mapping, elem = self.basis.mapping, self.basis.elem
        value, grad = np.zeros((2, element.size)), np.zeros((2, 2, element.size))
        dofs = self.basis.dofs.element_dofs[:, element]
        for k in range(dofs.shape[0]):
            (shape,) = elem.gbasis(mapping, local[:, :, None], k, tind=element)
            value += self.vector[dofs[k]] * np.asarray(shape)[..., 0]
            grad += self.vector[dofs[k]] * shape.grad[..., 0]
        return value, grad

    def displacement(self, points: ArrayLike) -> FloatArray:
        """Displacement (n, 3) at Cartesian points (n, 3)."""
        _, turn, element, local, _ = self._place(points)
        value, _ = self._interpolate(element, local)
        return np.stack((value[0] * turn[0], value[0] * turn[1], value[1]), axis=1)

    def strain(self, points: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Strain e_rr, e_tt, e_zz, e_rz (4, n) at Cartesian points (n, 3), material (6, n) there, and e_r (2, n).

        Sides as in `stress`.
        """
        place, turn, element, local, on_axis = self._place(points)
        value, grad = self._interpolate(element, local)
        hoop = np.where(on_axis, grad[0, 0], value[0] / np.where(on_axis, 1.0, place[0]))
        inward = place + 1e-9 * (self.grid.centres[:, element] - place)
        material = self.model.material(inward[0], inward[1], self.grid, element)
        shear = np.where(on_axis, 0.0, (grad[0, 1] + grad[1, 0]) / 2)
        strain = np.stack((grad[0, 0], hoop, grad[1, 1], shear)) + _remote_strain(self.model)[:, None]
        return strain, material, turn

    def stress(self, points: ArrayLike) -> FloatArray:
        """Stress (n, 3, 3) at Cartesian points (n, 3), from the strain inside the element that holds the point.

        On a line of the mesh, an interface among them, it is the side of larger r and z that counts.
        """
        strain, material, turn = self.strain(points)
        polar_stress = _stress(material, strain - material[2:])
        frame = np.zeros((3, 3, strain.shape[1]))  # columns: e_r, e_t, e_z
        frame[0, 0], frame[1, 0], frame[0, 1], frame[1, 1], frame[2, 2] = turn[0], turn[1], -turn[1], turn[0], 1.0
        polar = np.zeros_like(frame)
        polar[[0, 1, 2], [0, 1, 2]] = polar_stress[:3]
        polar[0, 2] = polar[2, 0] = polar_stress[3]
        return np.asarray(np.einsum("ian,abn,jbn->nij", frame, polar, frame))

    def write_vtu(self, path: str | Path) -> None:
        """Write the mesh in the plane y = 0, nodal displacement, and what the elements have in their middle, as VTU.

        Fields: ``displacement``; ``stress`` (xx, xy, xz, yx, ...), ``von_mises``, and ``region``, the mesh's mark.
        """
        import meshio

        mesh = self.basis.mesh
        nodes = np.zeros((mesh.doflocs.shape[1], 3))
        nodes[:, [0, 2]] = mesh.doflocs.T
        moved = np.zeros_like(nodes)
        scalar = mesh.dofs.element_dofs
        for axis, component in ((0, 0), (2, 1)):
            moved[scalar, axis] = self.vector[self.basis.dofs.element_dofs[component::2]]
        middle = np.stack((self.grid.centres[0], 0 * self.grid.centres[0], self.grid.centres[1]), axis=1)
        stress = self.stress(middle)
        meshio.Mesh(
            nodes,
            [("quad9", scalar.T)],
            point_data={"displacement": moved},
            cell_data={
                "stress": [stress.reshape(-1, 9)],
                "von_mises": [von_mises(stress)],
                "region": [self.grid.marks],
            },
        ).write(path)
