"""Stored cells of a square grid in an axisymmetric model: means over the angle about the axis.

The mean over the angle of the load on a body of revolution gives the mean over the angle of its displacement and
stress, exactly: turning is a symmetry of the equations. So nothing is smoothed here. A pressure is handed over by Gauss
points in its cells; an eigenstrain is turned into cylindrical components and averaged on rings an eighth of a cell
wide, row by row of cells in z. Only what damage keeps of the stiffness is no load: its mean is a model of the body.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

__all__ = ["CellField", "CellPressure"]

FloatArray = NDArray[np.float64]
Pair = tuple[float, float]

#: Samples along each edge of the grid, at least so many a cell and at most; rings over the width of a cell.
_SAMPLES, _LEAST, _MOST, _RINGS = 2000, 12, 48, 8
#: Rows of cells whose faces become lines of the mesh; with more of them only every second, third ... does.
_ROWS = 24


@dataclass(frozen=True, kw_only=True, eq=False)
class CellPressure:
    """Pressure, uniform on each cell of the surface; edges (nx + 1,), (ny + 1,) from the axis on, values (ny, nx)."""

    x: FloatArray
    y: FloatArray
    values: FloatArray

    @property
    def load(self) -> float:
        """Resultant force, positive into the body."""
        return float(np.diff(self.y) @ self.values @ np.diff(self.x))

    @property
    def radius(self) -> float:
        """Distance of the farthest loaded corner."""
        corners = np.hypot(np.maximum(*np.abs((self.x[:-1], self.x[1:])))[None, :],
                           np.maximum(*np.abs((self.y[:-1], self.y[1:])))[:, None])  # fmt: skip
        return float(corners[self.values != 0].max())

    @property
    def widest(self) -> float:
        """Longest edge of a cell."""
        return float(max(np.diff(self.x).max(), np.diff(self.y).max()))

    def points(self, count: int, *, beyond: float = 0.0, within: float = np.inf) -> tuple[FloatArray, FloatArray]:
        """Distances from the axis and forces (n,) of ``count`` x ``count`` Gauss points in loaded cells.

        In those with a middle from ``beyond`` up to ``within`` from the axis.
        """
        places, weights = np.polynomial.legendre.leggauss(count)
        away = np.hypot((self.x[1:] + self.x[:-1]) / 2, ((self.y[1:] + self.y[:-1]) / 2)[:, None])
        rows, columns = np.nonzero((self.values != 0) & (away >= beyond) & (away < within))
        x, y = (
            edges[k, None] + (places + 1) / 2 * np.diff(edges)[k, None]
            for edges, k in ((self.x, columns), (self.y, rows))
        )
        force = self.values[rows, columns] * np.diff(self.x)[columns] * np.diff(self.y)[rows] / 4
        r = np.hypot(x[:, None, :], y[:, :, None])
        return r.ravel(), (force[:, None, None] * np.outer(weights, weights)).ravel()


@dataclass(frozen=True, kw_only=True, eq=False)
class CellField:
    """Eigenstrain and factor of the stiffness, averaged over the angle.

    Attributes
    ----------
    r : (n,)
        Middles of the rings.
    z : (nz + 1,)
        Faces of the rows.
    eigenstrain : (4, nz, n)
        e_rr, e_tt, e_zz, e_rz.
    stiffness_factor : (nz, n)
        Factor of Young's modulus.
    """

    r: FloatArray
    z: FloatArray
    eigenstrain: FloatArray
    stiffness_factor: FloatArray

    @property
    def bounds(self) -> tuple[Pair, Pair]:
        """Low and high corner (r, z)."""
        return (0.0, float(self.z[0])), (float(self.r[-1]), float(self.z[-1]))

    @property
    def lines(self) -> FloatArray:
        """Faces of rows that are lines of the mesh."""
        step = -(-(self.z.size - 1) // _ROWS)
        return np.unique(np.append(self.z[::step], self.z[-1]))

    def at(self, r: FloatArray, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Eigenstrain (4, ...) and the factor of the stiffness (...) at points; none and 1 outside of the cells."""
        row = np.clip(np.searchsorted(self.z, z, side="right") - 1, 0, self.z.size - 2)
        inside = (z > self.z[0]) & (z < self.z[-1]) & (r < self.r[-1])
        k = np.clip(np.searchsorted(self.r, r) - 1, 0, self.r.size - 2)
        s = np.clip((r - self.r[k]) / (self.r[k + 1] - self.r[k]), 0.0, 1.0)
        strain = (1 - s) * self.eigenstrain[:, row, k] + s * self.eigenstrain[:, row, k + 1]
        stiffness = (1 - s) * self.stiffness_factor[row, k] + s * self.stiffness_factor[row, k + 1]
        return np.where(inside, strain, 0.0), np.where(inside, stiffness, 1.0)

    @classmethod
    def averaged(
        cls, x: FloatArray, y: FloatArray, z: FloatArray, eigenstrain: FloatArray, stiffness: FloatArray | None
    ) -> CellField:
        """Mean over the angle of cells with edges x, y from the axis on and z, eigenstrain (3, 3, nz, ny, nx)."""
        samples = int(np.clip(_SAMPLES // max(x.size, y.size), _LEAST, _MOST))
        share = (np.arange(samples) + 0.5) / samples
        px, py = ((e[:-1, None] + np.diff(e)[:, None] * share).ravel() for e in (x, y))
        columns = (np.repeat(np.arange(y.size - 1), samples)[:, None] * (x.size - 1)
                   + np.repeat(np.arange(x.size - 1), samples)).ravel()  # fmt: skip
        distance = np.hypot(px, py[:, None])
        width = min(np.diff(x).min(), np.diff(y).min()) / _RINGS
        area = (np.repeat(np.diff(y), samples)[:, None] * np.repeat(np.diff(x), samples)).ravel() / samples**2
        ring = (distance / width).astype(int).ravel()
        cosine, sine = (px / distance).ravel(), (py[:, None] / distance).ravel()
        shape = (int(ring.max()) + 1, (x.size - 1) * (y.size - 1))

        # beyond the cells the ring is empty space without eigenstrain: its mean is over the whole ring
        edges = width * np.arange(shape[0] + 1)
        whole = np.pi * np.diff(edges**2)
        reached = np.bincount(ring, weights=area, minlength=shape[0])
        full = edges[1:] <= min(-x[0], x[-1], -y[0], y[-1])
        whole = np.where(full, reached, np.maximum(whole, reached))

        def mean(values: FloatArray, weight: FloatArray) -> FloatArray:
            matrix = csr_matrix((weight * area, (ring, columns)), shape=shape)
            flat = values.reshape(len(values), -1)
            return np.asarray((matrix @ flat.T / whole[:, None]).T)

        e, unit = eigenstrain, np.ones_like(cosine)
        xx, yy, xy = e[0, 0], e[1, 1], e[0, 1]
        cc, ss, cs = cosine**2, sine**2, cosine * sine
        tensor = np.stack((
            mean(xx, cc) + mean(yy, ss) + 2 * mean(xy, cs),
            mean(xx, ss) + mean(yy, cc) - 2 * mean(xy, cs),
            mean(e[2, 2], unit),
            mean(e[0, 2], cosine) + mean(e[1, 2], sine),
        ))  # fmt: skip
        damage = mean(1 - stiffness, unit) if stiffness is not None else np.zeros(tensor.shape[1:])
        middles = np.append((edges[:-1] + edges[1:]) / 2, edges[-1] + width / 2)
        last = np.flatnonzero(np.any(tensor != 0, axis=(0, 1)) | np.any(damage != 0, axis=0))
        stop = int(last[-1]) + 1 if last.size else 1
        tensor = np.concatenate([tensor[..., :stop], np.zeros((4, z.size - 1, 1))], axis=2)
        damage = np.concatenate([damage[:, :stop], np.zeros((z.size - 1, 1))], axis=1)
        return cls(r=middles[: stop + 1], z=z, eigenstrain=tensor, stiffness_factor=1 - damage)
