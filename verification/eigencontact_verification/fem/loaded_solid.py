"""Finite elements of a half-space as a stored step leaves it: layers, regions, tractions, eigenstrain, damage.

Triquadratic hexahedra on a graded tensor-product mesh (`loaded_mesh`), half or a quarter of it where body and loads are
symmetric (`loaded_symmetry`), loads of cells integrated exactly (`cell_loads`), outer faces that know the point forces
of the tractions (`far_field`). Stress is Hooke's law of the total strain that `recovery` finds at Gauss points of
each side of interfaces, with the eigenstrain of the very point. Of cells smaller than elements that eigenstrain is a
stair of which the strain knows the mean: read stress in the middle of such cells.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.fem import assembly, planes
from eigencontact_verification.fem.cell_loads import cell_state, cells_load, damaged, traction_cells_load
from eigencontact_verification.fem.far_field import PointForces, far_field, outer_loads, unit_loads
from eigencontact_verification.fem.followed_cells import jumps_on_lines
from eigencontact_verification.fem.loaded_body import LoadedBody
from eigencontact_verification.fem.loaded_mesh import RATIO, breaks_of, family_grid, is_box, reach_of
from eigencontact_verification.fem.loaded_symmetry import centred
from eigencontact_verification.fem.mesh import Grid
from eigencontact_verification.fem.model import Model
from eigencontact_verification.fem.recovery import recovered
from eigencontact_verification.fem.solve import Solution, peak_memory, solve_system

__all__ = ["QUICK_BUDGET", "RATIO", "LoadedSolution", "solve_loaded"]

FloatArray = NDArray[np.float64]

#: Unknowns of the fine mesh in a quick audit.
QUICK_BUDGET = 510_000
#: Size of the block in sizes of the loaded patch.
REACHES = 8.0
_TOLERANCE = 1e-8


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadedSolution:
    """Displacement and stress of a loaded body, in its own coordinates.

    Attributes
    ----------
    body : LoadedBody
        Moved so that planes of symmetry pass through the origin.
    origin : (3,) array
        Place of that origin.
    solution : Solution
        Of the finite elements.
    """

    body: LoadedBody
    origin: FloatArray
    solution: Solution

    @property
    def unknowns(self) -> int:
        """Components of displacement that are not constrained."""
        return self.solution.unknowns

    @property
    def seconds(self) -> float:
        """Wall time of symmetry, mesh, assembly and solution."""
        return self.solution.seconds

    @property
    def iterations(self) -> int:
        """Iterations of the solver."""
        return self.solution.iterations

    @property
    def peak_memory(self) -> int:
        """Largest resident memory of the process up to the end of the solution [bytes]."""
        return self.solution.peak_memory

    def displacement(self, points: ArrayLike) -> FloatArray:
        """Displacement (n, 3) at points (n, 3)."""
        return self.solution.displacement(np.atleast_2d(np.asarray(points, dtype=float)) - self.origin)

    def stress(self, points: ArrayLike) -> FloatArray:
        """Stress (n, 3, 3) at points (n, 3); on an interface that of the deeper side."""
        at = np.atleast_2d(np.asarray(points, dtype=float)) - self.origin
        breaks = breaks_of(self.body)
        for interface in breaks[2]:
            at[np.abs(at[:, 2] - interface) < 1e-9 * self.solution.model.reach, 2] = interface * (1 + 1e-7)
        curved = [region for region in self.body.regions if not is_box(region)]

        # sums of random numbers tell apart what regions a point lies in, however many there are
        marks = np.random.default_rng(0).integers(1, 1 << 62, size=len(curved))

        def side(x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.int64]:
            return sum(
                (np.where(r.contains(x, y, z), mark, 0) for mark, r in zip(marks, curved, strict=True)),
                start=np.zeros(np.shape(x), dtype=np.int64),
            )

        jumps = jumps_on_lines(self.body, self.solution.grid)
        kinks = [np.union1d(*places) for places in zip(breaks, jumps, strict=True)]
        strain = recovered(
            self.solution.strain, self.solution.grid, self.solution.model.symmetry, at, breaks=kinks, side=side
        )
        lam, mu, region_strain = assembly.point_state(self.solution.model, at)
        stiffness, plastic = cell_state(self.body.cells, at)
        return assembly.hooke(stiffness * lam, stiffness * mu, strain - region_strain - plastic)


def solve_loaded(
    body: LoadedBody,
    *,
    level: int,
    outer: str,
    watched: ArrayLike,
    budget: int = QUICK_BUDGET,
    reaches: float = REACHES,
    symmetric: bool = True,
    ratio: float = RATIO,
    read: ArrayLike | None = None,
) -> LoadedSolution:
    """Solve a loaded body.

    Parameters
    ----------
    body : LoadedBody
        What to solve.
    level : {0, 1, 2}
        Mesh of a family with the ratio `ratio` of element sizes.
    outer : {"fixed", "free"}
        What sides and bottom get of the half-space beyond: displacement or traction of the point forces.
    watched : (n, 3) array
        Points where fields will be read; the block reaches beyond them.
    budget : int
        Unknowns of the fine mesh; 10^6 take about 4 GB.
    reaches : float
        Size of the block in sizes of the loaded patch. Outer faces know the far field of a homogeneous body; layers,
        regions and cells need more.
    symmetric : bool
        Whether planes of symmetry are looked for.
    ratio : {1.5, 2.0}
        As in `family_grid`; by default `RATIO`.
    read : (m, 3) array, optional
        Those of them where stress will be read; by default it may be read everywhere.

    Raises
    ------
    ValueError
        If the budget is too small for the interfaces of the body.
    NotConverged
        If the iteration does not reach its tolerance.
    """
    start = time.perf_counter()
    centre = centred(body, use=symmetric)
    shifted = centre.body
    near = None if read is None else np.asarray(read, dtype=float).reshape(-1, 3) - centre.origin
    far = np.abs(np.asarray(watched, dtype=float).reshape(-1, 3) - centre.origin).max(initial=0.0)
    reach = max(reach_of(shifted, reaches), 1.25 * float(far))
    grid, fine = family_grid(shifted, centre.symmetry, reach, level=level, budget=budget, ratio=ratio, near=near)
    model = Model(
        young_modulus=shifted.young_modulus, poisson_ratio=shifted.poisson_ratio,
        layers=shifted.layers, regions=shifted.regions,
        reach=reach, symmetry=centre.symmetry, outer=outer, fine=fine,
    )  # fmt: skip
    stuff = damaged(grid, assembly.material(model, grid), shifted.cells)
    load = assembly.eigenstrain_load(grid, stuff) + cells_load(grid, stuff, shifted.cells)
    if shifted.tractions is not None:
        load += traction_cells_load(grid, shifted.tractions)
    field = far_field(shifted.tractions, shifted.young_modulus, shifted.poisson_ratio)
    fixed = planes.constrained(model, grid)
    solve = _fixed if outer == "fixed" else _free
    nodal, iterations, history = solve(model, grid, stuff, load, fixed, field)
    return LoadedSolution(
        body=shifted,
        origin=centre.origin,
        solution=Solution(
            model=model, grid=grid, nodal=nodal, unknowns=int((~fixed).sum()), seconds=time.perf_counter() - start,
            iterations=iterations, peak_memory=peak_memory(), history=tuple(history),
        ),
    )  # fmt: skip


def _fixed(
    model: Model, grid: Grid, stuff: assembly.Material, load: FloatArray, fixed: NDArray[np.bool_], field: PointForces
) -> tuple[FloatArray, int, Sequence[float]]:
    values = np.zeros_like(load)
    outer = np.flatnonzero(planes.outer_nodes(model, grid))
    values[outer] = field.displacement(grid.nodes[outer])
    for axis, kind in enumerate(model.symmetry):
        if kind != "none":  # round-off of the point forces on both sides
            plane = grid.nodes[:, axis] == 0.0
            normal = np.arange(3) == axis
            values[np.ix_(plane, normal if kind == "even" else ~normal)] = 0.0
    nodal, history = solve_system(grid, stuff, load, fixed, values=values, tolerance=_TOLERANCE)
    return nodal, len(history) - 1, history


def _free(
    model: Model, grid: Grid, stuff: assembly.Material, load: FloatArray, fixed: NDArray[np.bool_], field: PointForces
) -> tuple[FloatArray, int, Sequence[float]]:
    tests = unit_loads(model)
    pulls = outer_loads(model, grid, [field, *tests])
    motions = planes.free_motions(planes.rigid_motions(grid.nodes), fixed)
    load = load + np.where(fixed, 0.0, pulls[0])
    if motions.shape[2]:
        # what quadrature leaves of the balance goes to the outer faces, as in `solve`
        weights = planes.outer_weights(model, grid)
        gram = np.einsum("nac,n,nad->cd", motions, weights, motions)
        works = np.einsum("nac,na->c", motions, load)
        load = load - weights[:, None] * (motions @ np.linalg.solve(gram, works))
    nodal, history = solve_system(grid, stuff, load, fixed, tolerance=_TOLERANCE)
    if motions.shape[2]:
        outer = np.flatnonzero(planes.outer_nodes(model, grid))
        away = np.zeros_like(nodal)
        away[outer] = nodal[outer] - field.displacement(grid.nodes[outer])
        works = np.einsum("kna,na->k", pulls[1:], away)
        turned = np.einsum("kna,nac->kc", pulls[1:], motions)
        nodal = nodal - motions @ np.linalg.solve(turned, works)
    return nodal, len(history) - 1, history
