"""Solve a model by preconditioned conjugate gradients, and evaluate it at points."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.fem import assembly, planes
from eigencontact_verification.fem.mesh import Grid, build_grid
from eigencontact_verification.fem.model import Model, von_mises
from eigencontact_verification.fem.preconditioners import contrast, multigrid, separable

__all__ = ["NotConverged", "Solution", "peak_memory", "solve", "solve_system"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

TOLERANCE = 1e-9
PRECONDITIONERS = ("auto", "multigrid", "separable")
CONTRAST = 100.0
_ITERATIONS = 1000


class NotConverged(RuntimeError):
    """The solver stopped above its tolerance.

    Attributes
    ----------
    history : list of float
        Relative residual after every iteration.
    """

    def __init__(self, history: list[float], tolerance: float) -> None:
        super().__init__(
            f"residual of the FE solution must be below {tolerance:g} (got {history[-1]:.3g} after {len(history) - 1} "
            f"iterations); raise fine or growth, or look at contrasts of moduli"
        )
        self.history = history


def peak_memory() -> int:
    """Largest resident memory of this process so far [bytes]; 0 where the system does not tell."""
    try:
        import resource
    except ImportError:
        return 0
    import sys

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def _conjugate_gradients(
    matrix: Callable[[FloatArray], FloatArray],
    load: FloatArray,
    precondition: Callable[[FloatArray], FloatArray],
    project: Callable[[FloatArray], FloatArray],
    tolerance: float,
) -> tuple[FloatArray, list[float]]:
    x, r = np.zeros_like(load), project(load)
    size = float(np.linalg.norm(r))
    history = [1.0 if size else 0.0]
    if not size:
        return x, history
    z = project(precondition(r))
    p, rz = z.copy(), float(r @ z)
    while history[-1] > tolerance:
        if len(history) > _ITERATIONS or not rz > 0:
            raise NotConverged(history, tolerance)
        q = matrix(p)
        step = rz / float(p @ q)
        x += step * p
        r -= step * q
        history.append(float(np.linalg.norm(r)) / size)
        z = project(precondition(r))
        rz, old = float(r @ z), rz
        p = z + rz / old * p
    return x, history


def solve_system(
    grid: Grid,
    stuff: assembly.Material,
    load: FloatArray,
    fixed: BoolArray,
    *,
    values: FloatArray | None = None,
    preconditioner: str = "auto",
    tolerance: float = TOLERANCE,
) -> tuple[FloatArray, list[float]]:
    """Displacement of the nodes under a load.

    Parameters
    ----------
    grid, stuff : Grid, Material
        Mesh and moduli.
    load : (n, 3) array
        Nodal forces.
    fixed : (n, 3) bool array
        Constrained unknowns.
    values : (n, 3) array or None
        Their values; None = zero.
    preconditioner : str
        ``"multigrid"``, ``"separable"``, or ``"auto"``: separable below a contrast of moduli of `CONTRAST`.
    tolerance : float
        Relative residual to reach.

    Returns
    -------
    displacement : (n, 3) array
        Without a part in rigid motions that the constraints allow; a load that works on these is not balanced here.
    history : list of float
        Relative residuals.

    Raises
    ------
    NotConverged
        If the tolerance is not reached.
    """
    if preconditioner not in PRECONDITIONERS:
        raise ValueError(
            f"preconditioner must be one of {PRECONDITIONERS} (got {preconditioner!r}); choose one of them"
        )
    stiffness = assembly.stiffness(grid, stuff)
    full = np.zeros(load.shape) if values is None else np.where(fixed, values, 0.0)
    residual = load.ravel() if values is None else load.ravel() - stiffness @ full.ravel()
    free = (~fixed).ravel().astype(float)
    if preconditioner == "auto":
        preconditioner = "separable" if contrast(grid, stuff) <= CONTRAST else "multigrid"
    is_separable = preconditioner == "separable"
    precondition = separable(grid, stuff, fixed) if is_separable else multigrid(stiffness, grid, fixed)
    motions = planes.free_motions(planes.rigid_motions(grid.nodes), fixed)
    null = np.linalg.qr(motions.reshape(free.size, -1))[0]
    solution, history = _conjugate_gradients(
        lambda x: free * (stiffness @ x),
        free * residual,
        precondition,
        lambda v: v - null @ (null.T @ v),
        tolerance,
    )
    return full + solution.reshape(-1, 3), history


@dataclass(frozen=True, kw_only=True)
class Solution:
    """Displacement and stress of a model.

    Attributes
    ----------
    model, grid : Model, Grid
        What was solved, and its mesh.
    nodal : (nodes, 3) array
        Displacement of the nodes.
    unknowns, iterations : int
        Components of displacement that are not constrained, and iterations of the solver.
    seconds : float
        Wall time of mesh, assembly and solution.
    peak_memory : int
        Largest resident memory of the process up to the end of the solution [bytes].
    history : tuple of float
        Relative residual after every iteration.
    """

    model: Model
    grid: Grid
    nodal: FloatArray
    unknowns: int
    seconds: float
    iterations: int
    peak_memory: int
    history: tuple[float, ...]

    def displacement(self, points: ArrayLike) -> FloatArray:
        """Displacement (n, 3) at points (n, 3) of the block; beyond a plane of symmetry by reflection."""
        inside, factor = self._inside(points)
        element, local, _ = self._locate(inside, (1, 1, 1))
        values, _ = self.grid.shapes(local)
        return np.asarray(factor * np.einsum("ni,nia->na", values, self.nodal[self.grid.element_nodes[element]]))

    def stress(self, points: ArrayLike) -> FloatArray:
        """Stress (n, 3, 3) at points (n, 3), remote stress included.

        On a face, edge or corner of elements the mean of the elements that meet there, each with the material on its
        own side. In an element that a region cuts, the moduli and the eigenstrain of the very point.
        """
        inside, factor = self._inside(points)
        total = np.zeros((len(inside), 3, 3))
        for side in np.ndindex(2, 2, 2):
            element, local, nudged = self._locate(inside, tuple(2 * s - 1 for s in side))
            _, slopes = self.grid.shapes(local)
            slopes = slopes / self.grid.size[element][:, None, :]
            slope = np.einsum("nib,nia->nab", slopes, self.nodal[self.grid.element_nodes[element]])
            lam, mu, eigenstress = assembly.state(self.model, nudged)
            total += assembly.hooke(lam, mu, (slope + slope.swapaxes(1, 2)) / 2) - eigenstress
        stress = np.einsum("na,nab,nb->nab", factor, total / 8, factor)
        # an odd plane turns the sign of the whole field, and the two factors of one stress component hide that
        stress *= self._odd_sign(points)[:, None, None]
        return np.asarray(stress + (0.0 if self.model.remote_stress is None else self.model.remote_stress))

    def strain(self, points: ArrayLike) -> FloatArray:
        """Strain of the displacement (n, 3, 3) at points (n, 3) inside elements."""
        inside, factor = self._inside(points)
        element, local, _ = self._locate(inside, (1, 1, 1))
        slopes = self.grid.shapes(local)[1] / self.grid.size[element][:, None, :]
        slope = np.einsum("nib,nia->nab", slopes, self.nodal[self.grid.element_nodes[element]])
        strain = np.einsum("na,nab,nb->nab", factor, (slope + slope.swapaxes(1, 2)) / 2, factor)
        return np.asarray(strain * self._odd_sign(points)[:, None, None])

    def write_vtu(self, path: str | Path) -> None:
        """Write mesh, nodal displacement, and what the elements have in their middle as a VTU file.

        Fields: ``displacement``; ``stress`` and ``eigenstrain`` (xx, xy, xz, yx, ...), ``von_mises``,
        ``young_modulus``, and ``region``: 0 in the body, n in the n-th region, the last where they overlap.
        """
        import meshio

        grid = self.grid
        base = np.array([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)])
        corners = np.concatenate([base, base + (0, 0, 2)])  # noqa: RUF005
        pairs = [(a, (a + 1) % 4) for a in range(4)]
        pairs = pairs + [(a + 4, b + 4) for a, b in pairs] + [(a, a + 4) for a in range(4)]
        edges = np.array([(corners[a] + corners[b]) // 2 for a, b in pairs])
        faces = np.array([(0, 1, 1), (2, 1, 1), (1, 0, 1), (1, 2, 1), (1, 1, 0), (1, 1, 2), (1, 1, 1)])
        places = corners // 2 if grid.order == 1 else np.concatenate([corners, edges, faces])
        place = [int(np.abs(grid.local - w).sum(axis=1).argmin()) for w in places]
        kind = "hexahedron" if grid.order == 1 else "hexahedron27"
        centres = grid.low + grid.size / 2
        lam, mu, eigenstrain = assembly.point_state(self.model, centres)
        stress = self.stress(centres)
        number = np.zeros(len(centres), dtype=np.int32)
        for count, region in enumerate(self.model.regions, start=1):
            number[np.asarray(region.contains(*centres.T))] = count
        meshio.Mesh(
            grid.nodes,
            [(kind, grid.element_nodes[:, place])],
            point_data={"displacement": self.nodal},
            cell_data={
                "stress": [stress.reshape(-1, 9)],
                "von_mises": [von_mises(stress)],
                "region": [number],
                "eigenstrain": [eigenstrain.reshape(-1, 9)],
                "young_modulus": [mu * (3 * lam + 2 * mu) / (lam + mu)],
            },
        ).write(path)

    def _inside(self, points: ArrayLike) -> tuple[FloatArray, FloatArray]:
        x = np.atleast_2d(np.asarray(points, dtype=float))
        inside, factor = planes.mirror(self.model, x)
        low = np.array([line[0] for line in self.grid.lines])
        high = np.array([line[-1] for line in self.grid.lines])
        if not ((inside >= low) & (inside <= high)).all():
            raise ValueError(
                f"points must be inside the block (got {x.min(axis=0)} to {x.max(axis=0)}); reach is {self.model.reach}"
            )
        return inside, factor

    def _odd_sign(self, points: ArrayLike) -> FloatArray:
        x = np.atleast_2d(np.asarray(points, dtype=float))
        sign = np.ones(len(x))
        for axis, kind in enumerate(self.model.symmetry):
            if kind == "odd":
                sign[x[:, axis] < 0] *= -1
        return sign

    def _locate(self, points: FloatArray, side: tuple[int, ...]) -> tuple[NDArray[np.int64], FloatArray, FloatArray]:
        """Element on one side of each point, reference coordinates in it, and the point moved into its interior."""
        number, local = [], []
        for axis, line in enumerate(self.grid.lines):
            tiny = 1e-9 * float(np.diff(line).min())
            at = np.searchsorted(line, points[:, axis] + side[axis] * tiny, side="right") - 1
            at = np.clip(at, 0, line.size - 2)
            number.append(at)
            local.append(np.clip((points[:, axis] - line[at]) / (line[at + 1] - line[at]), 0.0, 1.0))
        nx, ny, _ = self.grid.shape
        element = (number[2] * ny + number[1]) * nx + number[0]
        reference = np.stack(local, axis=1)
        nudged = self.grid.low[element] + np.clip(reference, 1e-6, 1 - 1e-6) * self.grid.size[element]
        return element, reference, nudged


def solve(model: Model, *, preconditioner: str = "auto", tolerance: float = TOLERANCE) -> Solution:
    """Displacement and stress of a model.

    Parameters
    ----------
    model : Model
        Body, sources, boundary and mesh.
    preconditioner : str
        As in `solve_system`.
    tolerance : float
        Relative residual of the linear system.

    Returns
    -------
    Solution
        Of a free outer boundary, with mean displacement and rotation zero on sides and bottom; loads that are not in
        equilibrium are carried by tractions on sides and bottom that vary like a rigid motion.

    Raises
    ------
    NotConverged
        If the tolerance is not reached.
    """
    start = time.perf_counter()
    grid = build_grid(model)
    stuff = assembly.material(model, grid)
    load = assembly.eigenstrain_load(grid, stuff) + assembly.traction_load(model, grid)
    fixed = planes.constrained(model, grid)
    motions = planes.free_motions(planes.rigid_motions(grid.nodes), fixed)
    weights = planes.outer_weights(model, grid)
    gram = np.einsum("nac,n,nad->cd", motions, weights, motions)
    if motions.shape[2]:
        works = np.einsum("nac,na->c", motions, load)
        load = load - weights[:, None] * (motions @ np.linalg.solve(gram, works))
    nodal, history = solve_system(grid, stuff, load, fixed, preconditioner=preconditioner, tolerance=tolerance)
    if motions.shape[2]:
        mean = np.einsum("nac,n,na->c", motions, weights, nodal)
        nodal = nodal - motions @ np.linalg.solve(gram, mean)
    return Solution(
        model=model,
        grid=grid,
        nodal=nodal,
        unknowns=int((~fixed).sum()),
        seconds=time.perf_counter() - start,
        iterations=len(history) - 1,
        peak_memory=peak_memory(),
        history=tuple(history),
    )
