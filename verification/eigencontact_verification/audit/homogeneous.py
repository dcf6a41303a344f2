"""A homogeneous half-space under stored tractions, by point forces: what inclusions and damage are a change to.

The forces are K. L. Johnson 1985, eqs. 3.18-3.19 and 3.75-3.76 (`oracles.boussinesq`), nine to a cell by Gauss' rule.
Cells near a point of the surface are integrated as a whole (`oracles.boussinesq.rectangle`). Stress is not asked for
nearer to the surface than one cell and a half: there it is exact to a part in ten thousand.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.loaded_body import Tractions
from eigencontact_verification.oracles.boussinesq import point_force, rectangle

__all__ = ["homogeneous_displacement", "homogeneous_stress"]

FloatArray = NDArray[np.float64]

_LOADS = ("q_x", "q_y", "p")
#: Pairs of point and force at a time.
_CHUNK = 400_000
#: Distance in cells within which a cell is integrated as a whole.
_NEAR = 3.0


def _forces(tractions: Tractions) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Points, forces and the cells that they belong to: x, y (9 n,), forces (3, 9 n), middles (2, n), sizes (2, n)."""
    rows, columns = np.nonzero(np.any(tractions.values != 0.0, axis=0))
    sizes = np.array([np.diff(tractions.x)[columns], np.diff(tractions.y)[rows]])
    middles = np.array([tractions.x[:-1][columns], tractions.y[:-1][rows]]) + 0.5 * sizes
    nodes, weights = np.polynomial.legendre.leggauss(3)
    total = tractions.values[:, rows, columns] * sizes[0] * sizes[1]
    x = np.concatenate([middles[0] + 0.5 * a * sizes[0] for a in nodes for _ in nodes])
    y = np.concatenate([middles[1] + 0.5 * b * sizes[1] for _ in nodes for b in nodes])
    forces = np.concatenate([0.25 * v * w * total for v in weights for w in weights], axis=1)
    return x, y, forces, middles, sizes


def homogeneous_stress(tractions: Tractions | None, points: FloatArray, poisson_ratio: float) -> FloatArray:
    """Stress ``(n, 6)`` (xx, yy, zz, yz, xz, xy) [Pa] at points ``(n, 3)`` below the surface."""
    stress = np.zeros((len(points), 6))
    if tractions is None:
        return stress
    x, y, forces, *_ = _forces(tractions)
    step = max(1, _CHUNK // max(x.size, 1))
    for start in range(0, len(points), step):
        at = points[start : start + step]
        place = at[:, :1] - x, at[:, 1:2] - y, np.broadcast_to(at[:, 2:], (len(at), x.size))
        for load, force in zip(_LOADS, forces, strict=True):
            if np.any(force):
                stress[start : start + step] += (point_force(load, *place, poisson_ratio)[3:] @ force).T
    return stress


def homogeneous_displacement(
    tractions: Tractions | None, points: FloatArray, young_modulus: float, poisson_ratio: float
) -> FloatArray:
    """Displacement ``(n, 3)`` [m] at points ``(n, 3)`` of the surface, against distant ones."""
    displacement = np.zeros((len(points), 3))
    if tractions is None:
        return displacement
    x, y, forces, middles, sizes = _forces(tractions)
    rows, columns = np.nonzero(np.any(tractions.values != 0.0, axis=0))
    tractions_of_cells = tractions.values[:, rows, columns]
    for k, at in enumerate(points):
        off = np.abs(at[:2, None] - middles)
        near = np.all(off <= _NEAR * sizes, axis=0)
        far = np.tile(~near, 9)
        place = at[0] - x[far], at[1] - y[far], np.zeros(int(far.sum()))
        for load, force, traction in zip(_LOADS, forces, tractions_of_cells, strict=True):
            if not np.any(force):
                continue
            displacement[k] += point_force(load, *place, poisson_ratio)[:3] @ force[far]
            for cell in np.flatnonzero(near & (traction != 0.0)):
                offset = (float(at[0] - middles[0, cell]), float(at[1] - middles[1, cell]), 0.0)
                half = (0.5 * float(sizes[0, cell]), 0.5 * float(sizes[1, cell]))
                displacement[k] += traction[cell] * rectangle(load, offset, half, poisson_ratio)[:3]
    return displacement * 2.0 * (1.0 + poisson_ratio) / young_modulus
