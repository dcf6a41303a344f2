"""Two preconditioners of elasticity on tensor-product meshes: smoothed aggregation, and separated Laplacians.

*Multigrid* is smoothed aggregation with the six rigid motions as near null space; it takes any contrast of moduli, but
it slows down where grading stretches the elements.

*Separable*: elasticity is equivalent to three scalar problems ``sum_b c_b d²u_a/dx_b²``, c = lambda + 2 mu for b = a
and mu otherwise (Korn's inequality), whatever the mesh. On a tensor-product mesh of a body that varies with z alone
each of them is diagonal in the products of one-dimensional eigenvectors, which are dense matrices of the size of one
mesh line (fast diagonalisation). The number of iterations does not depend on mesh size or grading; contrasts of moduli
inside one plane z = const raise it.

References
----------
P. Vanek, J. Mandel, M. Brezina 1996, Computing 56, 179 (smoothed aggregation); R. E. Lynch, J. R. Rice, D. H. Thomas
1964, Numer. Math. 6, 185 (tensor-product solution of difference equations).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from eigencontact_verification.fem import planes
from eigencontact_verification.fem.assembly import Material
from eigencontact_verification.fem.mesh import Grid

__all__ = ["contrast", "multigrid", "separable"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Operator = Callable[[FloatArray], FloatArray]


def _profile(grid: Grid, values: FloatArray) -> FloatArray:
    """Median over the elements of each slab, (elements along z,)."""
    return np.asarray(np.median(values.reshape(grid.shape[2], -1), axis=1))


def contrast(grid: Grid, stuff: Material) -> float:
    """Largest ratio of a shear modulus to the median between the same two planes z = const, or the reverse."""
    ratio = stuff.mu.reshape(grid.shape[2], -1) / _profile(grid, stuff.mu)[:, None]
    worst = float(max(ratio.max(), 1 / ratio.min()))
    if stuff.cut.size:
        relative = stuff.cut_mu / _profile(grid, stuff.mu)[stuff.cut // (grid.shape[0] * grid.shape[1])][:, None]
        worst = float(max(worst, relative.max(), 1 / relative.min()))
    return worst


def multigrid(matrix: sp.bsr_matrix, grid: Grid, fixed: BoolArray) -> Operator:
    """Smoothed aggregation on the stiffness without its constrained rows.

    Parameters
    ----------
    matrix : (3 n, 3 n) matrix in 3 x 3 blocks
        Stiffness of all unknowns.
    grid : Grid
        Mesh.
    fixed : (n, 3) bool array
        Constrained unknowns.
    """
    import pyamg

    keep = np.flatnonzero(~fixed.all(axis=1))
    free = ~fixed[keep]
    number = sp.csr_matrix((np.arange(1, len(matrix.data) + 1), matrix.indices, matrix.indptr))[keep][:, keep]
    number.sort_indices()
    data = matrix.data[number.data - 1]
    rows = np.repeat(np.arange(keep.size), np.diff(number.indptr))
    diagonal = rows == number.indices
    # a node that is partly constrained stays a whole block, its constrained rows replaced by the diagonal
    data *= free[rows][:, :, None] & free[number.indices][:, None, :] | (
        diagonal[:, None, None] & np.eye(3, dtype=bool)
    )
    identity = sp.bsr_matrix((data, number.indices, number.indptr), shape=(3 * keep.size, 3 * keep.size))
    near_null = np.where(free[:, :, None], planes.rigid_motions(grid.nodes[keep]), 0.0).reshape(-1, 6)
    smoother = "block_gauss_seidel"
    hierarchy = pyamg.smoothed_aggregation_solver(
        identity,
        B=near_null,
        strength=("symmetric", {"theta": 0.0}),
        presmoother=(smoother, {"sweep": "forward", "blocksize": 3}),
        postsmoother=(smoother, {"sweep": "backward", "blocksize": 3}),
        improve_candidates=None,
        max_coarse=500,
    )
    cycle = hierarchy.aspreconditioner(cycle="V")

    def apply(residual: FloatArray) -> FloatArray:
        out = np.zeros(fixed.shape)
        out[keep] = np.where(free, (cycle @ residual.reshape(-1, 3)[keep].ravel()).reshape(-1, 3), 0.0)
        return out.ravel()

    return apply


def _line_matrices(line: FloatArray, order: int, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Stiffness and mass of one mesh line whose elements carry weights."""
    if order == 1:
        k, m = np.array([[1, -1], [-1, 1]]), np.array([[2, 1], [1, 2]]) / 6
    else:
        k = np.array([[7, -8, 1], [-8, 16, -8], [1, -8, 7]]) / 3
        m = np.array([[4, 2, -1], [2, 16, 2], [-1, 2, 4]]) / 30
    size = order * (line.size - 1) + 1
    stiff, mass = np.zeros((size, size)), np.zeros((size, size))
    for e, h in enumerate(np.diff(line)):
        nodes = slice(order * e, order * e + order + 1)
        stiff[nodes, nodes] += weights[e] * k / h
        mass[nodes, nodes] += weights[e] * h * m
    return stiff, mass


def separable(grid: Grid, stuff: Material, fixed: BoolArray) -> Operator:
    """Inverse of the three scalar problems, with the moduli of each slab between planes z = const.

    Parameters
    ----------
    grid : Grid
        Mesh.
    stuff : Material
        Moduli.
    fixed : (n, 3) bool array
        Constrained unknowns; of each component, whole faces of the block.
    """
    lam, mu = _profile(grid, stuff.lam), _profile(grid, stuff.mu)
    bulk = float(np.median((lam + 2 * mu) / mu))
    solvers = []
    for component in range(3):
        constrained = fixed[:, component].reshape([axis.size for axis in grid.axes[::-1]])
        remaining = constrained.copy()
        vectors, values = [], []
        for axis in range(3):
            across = np.moveaxis(constrained, 2 - axis, 0)
            free = np.ones(len(across), dtype=bool)
            for end in (0, -1):
                if across[end].all():
                    free[end] = False
                    np.moveaxis(remaining, 2 - axis, 0)[end] = False
            ratio = bulk if axis == component else 1.0
            stiff, mass = _line_matrices(grid.lines[axis], grid.order, mu if axis == 2 else np.ones(grid.shape[axis]))
            eigenvalues, columns = scipy.linalg.eigh(stiff[np.ix_(free, free)], mass[np.ix_(free, free)])
            full = np.zeros((free.size, eigenvalues.size))
            full[free] = columns
            vectors.append(full)
            values.append(ratio * np.maximum(eigenvalues, 0.0))
        if remaining.any():
            raise ValueError(
                f"constraints must be whole faces of the block (got {int(remaining.sum())} others); use the multigrid"
            )
        total = values[2][:, None, None] + values[1][:, None] + values[0]
        # a translation that nothing constrains: any positive number will do
        total = np.maximum(total, np.partition(total.ravel(), 1)[1] if total.size > 1 else 1.0)
        solvers.append((vectors, 1 / total))
    shape = tuple(axis.size for axis in grid.axes[::-1])

    def apply(residual: FloatArray) -> FloatArray:
        out = np.empty(fixed.shape)
        for component, ((x, y, z), inverse) in enumerate(solvers):
            field = residual.reshape(-1, 3)[:, component].reshape(shape)
            field = np.tensordot(z.T, np.matmul(y.T, field @ x), axes=1) * inverse
            out[:, component] = (np.matmul(y, np.tensordot(z, field, axes=1)) @ x.T).ravel()
        return out.ravel()

    return apply
