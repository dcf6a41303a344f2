"""Contact of a few hundred cells by dense linear algebra and an active set: no FFT, no tolerance to speak of.

Solves ``p >= 0, g >= 0, p g = 0`` for ``g = h + K p - Σ d_m w_m``, where the amplitudes d of some rigid modes w are
unknown and their forces ``Σ_cells w_m p`` are prescribed. This is the convex quadratic programme "least ½ p K p + h p
with p >= 0 and W p = F", by the primal active-set method: from a pressure that carries the forces, release the first
cell that would pull, take in the cell that overlaps most. Every pass lowers the energy, so there are finitely many,
each of cost O(n³).

References
----------
J. Nocedal, S. J. Wright 2006, Numerical Optimization, algorithm 16.3; C. L. Lawson, R. J. Hanson 1974 (NNLS).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.oracles.boussinesq import rectangle

__all__ = ["compliance_matrix", "solve_contact"]

FloatArray = NDArray[np.float64]


def compliance_matrix(shape: tuple[int, int], spacing: tuple[float, float], contact_modulus: float) -> FloatArray:
    """Normal displacement of every cell centre under unit pressure on every cell, ``(n, n)`` [m/Pa].

    Parameters
    ----------
    shape : (int, int)
        Cells along (y, x), n = ny nx; cell (j, i) is row ``j nx + i``.
    spacing : (float, float)
        Cell edges (dy, dx) [m].
    contact_modulus : float
        E* [Pa].

    Notes
    -----
    By quadrature of the point force, one rectangle for each pair of offsets. With ν = 0 and G = E*/2 the half-space
    has the modulus E*.
    """
    (ny, nx), (dy, dx) = shape, spacing
    table = np.array(
        [
            [
                rectangle("p", (i * dx, j * dy, 0.0), (0.5 * dx, 0.5 * dy), 0.0, 0.5 * contact_modulus)[2]
                for i in range(nx)
            ]
            for j in range(ny)
        ]
    )
    rows, columns = np.divmod(np.arange(ny * nx), nx)
    offset_y, offset_x = np.abs(rows[:, None] - rows), np.abs(columns[:, None] - columns)
    return np.asarray(table[offset_y, offset_x])


def solve_contact(
    compliance: FloatArray,
    separation: FloatArray,
    modes: FloatArray | None = None,
    forces: FloatArray | None = None,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Exact solution on the cells.

    Parameters
    ----------
    compliance : (n, n)
        Symmetric positive definite K [m/Pa].
    separation : (n,)
        h less the prescribed rigid displacements [m].
    modes : (m, n), optional
        Rigid modes w of unknown amplitude.
    forces : (m,), optional
        ``w @ p`` of each [Pa or Pa m]; must be within what contact can carry.

    Returns
    -------
    pressure, gap : (n,)
        p [Pa] and g [m]; exactly zero off and in contact.
    rigid : (m,)
        Amplitudes d.

    Raises
    ------
    RuntimeError
        No solution found: the forces cannot be carried.
    """
    n = separation.size
    modes = np.zeros((0, n)) if modes is None else modes
    forces = np.zeros(0) if forces is None else forces
    unit = 1.0 / float(compliance[0, 0])
    scale = np.abs(modes).max(axis=1, initial=0.0)
    pressure = _carrying(modes / scale[:, None], forces / scale)
    inside = pressure > 0
    small = 1e-13 * float(np.ptp(separation))
    for _ in range(100 * n):
        wanted, rigid = _closed(compliance, separation, modes, forces, inside, unit, scale)
        pulls = inside & (wanted < 0)
        if pulls.any():
            step = pressure[pulls] / (pressure[pulls] - wanted[pulls])
            pressure = np.maximum(0.0, pressure + step.min() * (wanted - pressure))
            blocking = np.flatnonzero(pulls)[np.argmin(step)]
            inside[blocking], pressure[blocking] = False, 0.0
            continue
        pressure = wanted
        gap = separation + compliance @ pressure - rigid @ modes
        gap[inside] = 0.0
        if gap.min() >= -small:
            return pressure, np.maximum(0.0, gap), rigid
        inside[np.argmin(gap)] = True
    raise RuntimeError(f"no contact state found for {n} cells under the forces {forces.tolist()}")


def _carrying(modes: FloatArray, forces: FloatArray) -> FloatArray:
    """Some pressure >= 0 that carries the forces, on as many cells as there are forces."""
    from scipy.optimize import nnls

    if not len(forces):
        return np.zeros(modes.shape[1])
    pressure, missing = nnls(modes, forces)
    if missing > 1e-10 * np.abs(forces).max():
        raise RuntimeError(f"the forces {forces.tolist()} cannot be carried by any pressure on these cells")
    return np.asarray(pressure)


def _closed(
    K: FloatArray,
    separation: FloatArray,
    modes: FloatArray,
    forces: FloatArray,
    inside: NDArray[np.bool_],
    unit: float,
    scale: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Pressure that closes the gap on the cells `inside` and carries the forces, and the rigid amplitudes."""
    cells = np.flatnonzero(inside)
    k, m = cells.size, len(modes)
    W = modes[:, cells] / scale[:, None]
    matrix = np.block([[K[np.ix_(cells, cells)] * unit, -W.T], [W, np.zeros((m, m))]])
    right = np.concatenate([-separation[cells], forces / (scale * unit)])
    # With fewer cells than modes some motion is free: least squares then chooses the smallest.
    solved = np.linalg.solve(matrix, right) if k > m else np.linalg.lstsq(matrix, right, rcond=None)[0]
    pressure = np.zeros(separation.size)
    pressure[cells] = solved[:k] * unit
    return pressure, solved[k:] / scale
