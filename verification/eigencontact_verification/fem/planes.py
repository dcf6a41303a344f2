"""Planes of symmetry, the outer boundary, and the rigid motions that they leave."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.assembly import face_weights
from eigencontact_verification.fem.mesh import Grid
from eigencontact_verification.fem.model import Model

__all__ = ["constrained", "free_motions", "mirror", "outer_nodes", "outer_weights", "rigid_motions"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


def outer_nodes(model: Model, grid: Grid) -> BoolArray:
    """Nodes on sides and bottom, (nodes,)."""
    x, tiny = grid.nodes, 1e-9 * model.reach
    out = x[:, 2] > model.reach - tiny
    for axis, kind in enumerate(model.symmetry):
        out |= (np.abs(x[:, axis]) if kind == "none" else x[:, axis]) > model.reach - tiny
    return np.asarray(out)


def constrained(model: Model, grid: Grid) -> BoolArray:
    """Unknowns that are zero, (nodes, 3): on planes of symmetry and on a fixed outer boundary."""
    fixed = np.zeros((len(grid.nodes), 3), dtype=bool)
    for axis, kind in enumerate(model.symmetry):
        if kind != "none":
            on_plane = np.abs(grid.nodes[:, axis]) < 1e-9 * model.reach
            normal = np.arange(3) == axis
            fixed[np.ix_(on_plane, normal if kind == "even" else ~normal)] = True
    if model.outer == "fixed":
        fixed[outer_nodes(model, grid)] = True
    return fixed


def rigid_motions(points: FloatArray) -> FloatArray:
    """Translations and rotations about the middle, (points, 3, 6), scaled to about one."""
    x = points - points.mean(axis=0)
    x = x / max(float(np.abs(x).max()), 1e-300)
    out = np.zeros((len(points), 3, 6))
    for a, (b, c) in enumerate(((1, 2), (2, 0), (0, 1))):
        out[:, a, a] = 1.0
        out[:, b, 3 + a], out[:, c, 3 + a] = -x[:, c], x[:, b]
    return out


def free_motions(motions: FloatArray, fixed: BoolArray) -> FloatArray:
    """Combinations of rigid motions that vanish in all constrained unknowns, (points, 3, count)."""
    constrained = motions[fixed]
    if not len(constrained):
        return motions
    _, values, rows = np.linalg.svd(constrained, full_matrices=False)
    rank = int((values > 1e-9 * values[0]).sum())
    _, _, basis = np.linalg.svd(rows[:rank], full_matrices=True)
    out = motions @ basis[rank:].T
    out[fixed] = 0.0
    return np.asarray(out)


def outer_weights(model: Model, grid: Grid) -> FloatArray:
    """Integral of each node's shape function over the sides and the bottom, (nodes,)."""
    weights = np.zeros(len(grid.nodes))
    faces = [(axis, -1) for axis in range(3)]
    faces += [(axis, 0) for axis, kind in enumerate(model.symmetry) if kind == "none"]
    for axis, end in faces:
        elements, share = face_weights(grid, axis, end)
        weights += np.bincount(grid.element_nodes[elements].ravel(), share.ravel(), minlength=weights.size)
    return weights


def mirror(model: Model, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points moved into the part that is meshed, (n, 3), and the factor of each displacement component there.

    By ``u(x) = Q u(Q x)`` across an even plane and minus that across an odd one, Q the reflection.
    """
    inside, factor = points.copy(), np.ones_like(points)
    for axis, kind in enumerate(model.symmetry):
        beyond = points[:, axis] < 0
        if kind == "none" or not beyond.any():
            continue
        inside[beyond, axis] *= -1
        turn = np.where(np.arange(3) == axis, -1.0, 1.0) * (1.0 if kind == "even" else -1.0)
        factor[beyond] *= turn
    return inside, factor
