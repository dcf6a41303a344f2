"""Contact of a few hundred cells by dense linear algebra and an active set: no FFT, no tolerance to speak of.

Solves ``p >= 0, g >= 0, p g = 0`` for ``g = h + K p - Σ d_m w_m``, where the amplitudes d of some rigid modes w are
unknown and their forces ``Σ_cells w_m p`` are prescribed. This is the convex quadratic programme "least ½ p K p + h p
with p >= 0 and W p = F". Block pivoting first: every cell on the wrong side of an inequality changes sides, which
mostly ends in ten passes but may cycle. Then the primal active set: from a pressure that carries the forces, release
the first cell that would pull, take in the cell that overlaps most; every pass lowers the energy, so there are
finitely many. Cost O(n³) a pass.

References
----------
J. J. Júdice, F. M. Pires 1994, Comput. Oper. Res. 21, 587 (block pivoting);
J. Nocedal, S. J. Wright 2006, Numerical Optimization, algorithm 16.3 (primal active set).
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
        Rigid modes w of unknown amplitude; the first is that of the load, all ones.
    forces : (m,), optional
        ``w @ p`` of each [Pa or Pa m]; must be within what contact can carry, the load positive.

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
    small = 1e-13 * float(np.ptp(separation))

    def closed(inside: NDArray[np.bool_]) -> tuple[FloatArray, FloatArray, FloatArray, NDArray[np.bool_]]:
        pressure, rigid = _closed(compliance, separation, modes, forces, inside, unit, scale)
        pulls = inside & (pressure < -1e-13 * pressure.max())  # a cell may just touch, with no pressure
        gap = separation + compliance @ pressure - rigid @ modes
        gap[inside] = 0.0
        return pressure, gap, rigid, pulls

    inside = np.ones(n, dtype=bool) if len(modes) else separation < 0
    for _ in range(30):
        traction, gap, rigid, pulls = closed(inside)
        wrong = pulls | (gap < -small)
        if not wrong.any():
            return np.maximum(0.0, traction), np.maximum(0.0, gap), rigid
        inside ^= wrong
        if np.linalg.matrix_rank(modes[:, inside]) < len(modes):
            break  # cells on one line, or too few: they may not be able to carry the forces

    pressure = _carrying(modes / scale[:, None], forces / scale)
    inside = pressure > 0
    for _ in range(100 * n):
        traction, gap, rigid, pulls = closed(inside)
        if pulls.any():
            step = pressure[pulls] / (pressure[pulls] - traction[pulls])
            pressure = np.maximum(0.0, pressure + step.min() * (traction - pressure))
            blocking = np.flatnonzero(pulls)[np.argmin(step)]
            inside[blocking], pressure[blocking] = False, 0.0
            continue
        pressure = np.maximum(0.0, traction)
        if gap.min() >= -small:
            return pressure, np.maximum(0.0, gap), rigid
        inside[np.argmin(gap)] = True
    raise RuntimeError(f"no contact state found for {n} cells under the forces {forces.tolist()}")


def _carrying(modes: FloatArray, forces: FloatArray) -> FloatArray:
    """Positive pressure on every cell that carries the forces: ``exp(c . w)``, of greatest entropy, by Newton."""
    n = modes.shape[1]
    if not len(forces):
        return np.zeros(n)
    pressure = np.full(n, forces[0] / n)
    for _ in range(100):
        error = forces - modes @ pressure
        if np.abs(error).max() < 1e-14 * forces[0]:
            return pressure
        change = np.linalg.lstsq((modes * pressure) @ modes.T, error, rcond=1e-14)[0] @ modes
        pressure = pressure * np.exp(change / max(1.0, float(np.abs(change).max())))
    raise RuntimeError(f"the forces {forces.tolist()} cannot be carried by any pressure on these cells")


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
    # Separations may be far larger than deflections: take their rigid part out first, lest its round-off remain.
    amplitudes = np.linalg.lstsq(W.T, separation[cells], rcond=None)[0]
    right = np.concatenate([W.T @ amplitudes - separation[cells], forces / (scale * unit)])
    # Cells on one line, or fewer than modes, leave some motion free: least squares then chooses the smallest.
    regular = m == 0 or (k >= m and np.linalg.matrix_rank(W) == m)
    solved = np.linalg.solve(matrix, right) if regular else np.linalg.lstsq(matrix, right, rcond=None)[0]
    pressure = np.zeros(separation.size)
    pressure[cells] = solved[:k] * unit
    return pressure, (solved[k:] + amplitudes) / scale
