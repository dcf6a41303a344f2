r"""Compatible stress in an elastic region by virtual work, from a stress with correct tractions on its boundary.

The cells of a stiff region have small strains. Small errors of the strain at the boundary therefore cause a
self-balanced stress in the whole region, larger by the ratio of the stiffnesses. The moments of the stress are correct,
because the tractions on the region are those of the soft surrounding body. The projection keeps only these moments of
the stress σ of the cells,

    ∫ e(v) : C (e(u)) dV = ∫ e(v) : σ dV    for every displacement v,

with u and v linear between the corners of cells, and fractions of cells as weights. The result is C e(u). It contains
no self-balanced stress without tractions of σ. A uniform prestrain is compatible, and therefore part of e(u).

References
----------
J. Parvizian, A. Düster and E. Rank 2007, Comput. Mech. 41, 121 (cells cut by a boundary: weights in the integral);
T. J. R. Hughes 1980, Int. J. Numer. Methods Eng. 15, 1413 (mean change of volume in a cell, against locking).
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.tensors import INDICES, SQRT2
from eigencontact.errors import NotConverged, require

__all__ = ["CompatibleStress"]

_CORNERS = tuple(product((0, 1), repeat=3))
_GAUSS = tuple(0.5 + sign / np.sqrt(12.0) for sign in (-1.0, 1.0))
#: Residual of the virtual work, relative to the virtual work of the stress.
_TOLERANCE = 1e-5
_MOST_ITERATIONS = 5000


class CompatibleStress:
    """Projection of stress fields in the cells of one region.

    Parameters
    ----------
    share : (nz, ny, nx)
        Fraction of each cell inside the region, 0 to 1.
    stiffness : (6, 6)
        Mandel stiffness of the region, in any unit.
    pitch : (float, float, float)
        Edges (dx, dy, dz) of a cell [m].
    """

    def __init__(self, share: FloatArray, stiffness: FloatArray, pitch: tuple[float, float, float]) -> None:
        require(share.ndim == 3, "compatible stress", "share", share.shape, "of three axes")
        self._share, scale = share[..., None], float(np.abs(stiffness).max())
        edges = np.array(pitch) / min(pitch)
        strains = [_strain(edges, place) for place in product(_GAUSS, repeat=3)]
        self._mean = np.mean(strains, axis=0)
        volume = np.zeros((6, 6))
        volume[:3, :3] = 1.0 / 3.0
        strains = [strain + volume @ (self._mean - strain) for strain in strains]
        self._matrix = np.mean([strain.T @ (stiffness / scale) @ strain for strain in strains], axis=0)
        self._of_mean = (stiffness / scale) @ self._mean
        diagonal = self._spread(self._share * np.diag(self._matrix))
        self._inverse = np.where(diagonal > 0.0, 1.0 / np.where(diagonal > 0.0, diagonal, 1.0), 0.0)
        self._displacement = np.zeros_like(diagonal)

    def of(self, stress: FloatArray) -> FloatArray:
        """Stress of the region, mean over each cell ``(6, nz, ny, nx)``; zero in cells with fraction zero.

        Parameters
        ----------
        stress : (6, nz, ny, nx)
            Mandel stress of the region's material in its cells; ignored in cells with fraction zero.

        Raises
        ------
        NotConverged
            The iteration for the displacement does not converge.
        """
        work = np.where(self._share > 0.0, np.moveaxis(stress, 0, -1), 0.0)
        load = self._spread(self._share * (work @ self._mean))
        self._displacement = self._displacement_of(load, self._displacement)
        means = self._gathered(self._displacement) @ self._of_mean.T
        return np.moveaxis(np.where(self._share > 0.0, means, 0.0), -1, 0)

    def _displacement_of(self, load: FloatArray, start: FloatArray) -> FloatArray:
        """Displacement of the corners of cells, by conjugate gradients; rigid motions are free."""
        size, answer = float(np.linalg.norm(load)), start.copy()
        residual = load - self._force(answer)
        if np.linalg.norm(residual) >= size:  # the start gives no advantage: perhaps the region was unloaded
            answer, residual = np.zeros_like(load), load.copy()
        bound = _TOLERANCE * size
        direction = scaled = self._inverse * residual
        energy = float(np.vdot(residual, scaled))
        for _ in range(_MOST_ITERATIONS):
            if np.linalg.norm(residual) <= bound:
                return answer
            force = self._force(direction)
            step = energy / float(np.vdot(direction, force))
            answer += step * direction
            residual -= step * force
            scaled = self._inverse * residual
            previous, energy = energy, float(np.vdot(residual, scaled))
            direction = scaled + energy / previous * direction
        raise NotConverged(f"compatible stress: not within {_TOLERANCE:.0e} after {_MOST_ITERATIONS} iterations")

    def _force(self, displacement: FloatArray) -> FloatArray:
        return self._spread(self._share * (self._gathered(displacement) @ self._matrix))

    def _places(self) -> Iterator[tuple[slice, tuple[slice, slice, slice]]]:
        """Position of each corner in the 24 numbers of a cell, and position of the cells in the lattice of corners."""
        nz, ny, nx = self._share.shape[:3]
        for number, (k, j, i) in enumerate(_CORNERS):
            yield slice(3 * number, 3 * number + 3), (slice(k, k + nz), slice(j, j + ny), slice(i, i + nx))

    def _gathered(self, displacement: FloatArray) -> FloatArray:
        """Displacement of the corners of each cell, ``(nz, ny, nx, 24)``."""
        return np.concatenate([displacement[place] for _, place in self._places()], axis=-1)

    def _spread(self, forces: FloatArray) -> FloatArray:
        """Sum of the forces ``(nz, ny, nx, 24)`` of all cells at each corner, ``(nz + 1, ny + 1, nx + 1, 3)``."""
        out = np.zeros((*(n + 1 for n in forces.shape[:3]), 3))
        for columns, place in self._places():
            out[place] += forces[..., columns]
        return out


def _strain(edges: FloatArray, place: tuple[float, ...]) -> FloatArray:
    """Mandel strain ``(6, 24)`` at a position (0 to 1 along x, y, z) in a cell, by the displacement of its corners."""
    out = np.zeros((6, 24))
    for number, (k, j, i) in enumerate(_CORNERS):
        bits = (i, j, k)
        weights = [fraction if bit else 1.0 - fraction for fraction, bit in zip(place, bits, strict=True)]
        for axis in range(3):
            shape = np.prod([weight for n, weight in enumerate(weights) if n != axis])
            slope = (1.0 if bits[axis] else -1.0) / edges[axis] * shape
            for row, (first, second) in enumerate(INDICES):
                if first == second == axis:
                    out[row, 3 * number + axis] += slope
                elif axis in (first, second):
                    out[row, 3 * number + (second if axis == first else first)] += slope / SQRT2
    return out
