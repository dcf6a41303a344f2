"""Periodic half-space: eigenstrain in layers of cells, by Fourier series in the plane and exponentials in depth.

For one wave ``exp(i k.x)`` in the plane the potentials of a source layer are exponentials of depth,

    Phi -> (2 pi/k) e^-t    Chi -> (2 pi/k^3) e^-t    Psi -> -(2 pi/k^3) (1 + t) e^-t,    t = k |z - z'| or k (z + z'),

so a field at depth z needs only four sums over the layers: of e^-t and t e^-t over the layers above and over those
below. They are updated from layer to layer and never grow. The image uses the sums at the surface. In axes along and
across the wave the coefficients are equal for all waves: the linear forms of the theorem at the wave vector (1, 0). The
cost is N^3 log N for N^3 cells, without padding in depth, for layers of any thickness.

References
----------
R. D. Mindlin and D. H. Cheng 1950, J. Appl. Phys. 21, 926 (the half-space); S. Liu and Q. Wang 2005,
J. Appl. Mech. 72, 871 (eigenstrain and Fourier transforms); W. W. Chen, S. Liu and Q. Wang 2008, doi:10.1115/1.2755165
(periodic surfaces by convolution).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution.layout import fast_even
from eigencontact.core.array_types import ComplexArray, FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.core.tensors import SQRT2
from eigencontact.errors import require
from eigencontact.halfspace.theorem import QUANTITIES
from eigencontact.solvers.wave_layers import ALONG_WAVE, LayerSums, Plane, coefficients, plane_at

__all__ = ["PeriodicHalfSpace"]

_SUBJECT = "periodic half-space"
#: Waves per batch: the sums of all layers of a batch fit into the second-level cache.
_BATCH = 2048


@dataclass(frozen=True, kw_only=True)
class PeriodicHalfSpace:
    """Fields of eigenstrain that repeats in the plane, below a free surface.

    Parameters
    ----------
    grid : Grid
        Columns of cells; the window is periodic along x and y.
    interfaces : (nz + 1,) [m]
        Depths of the layers' boundaries, ascending and nonnegative.
    poisson_ratio : float
        In (-1, 0.5], 0.5 included.
    padding : float
        Ratio of period to window, at least 1. Empty columns increase the distance of the periodic images if a single
        window is meant: their influence falls with the third power of the period.
    aliases : int
        0: the eigenstrain is sampled from a smooth field (exact if no wave is shorter than two cells). M > 0: it is
        uniform in each cell, and (2M + 1)² waves are summed for each wave of the grid, at as many times the cost.
    threads : int, optional
        Cores to use; by default all cores available to this process.

    Notes
    -----
    The mean of the plane (k = 0) is a laterally uniform layer in a body with zero mean strain in the plane: ``sigma_xx
    = -E/(1-nu²) (e_xx + nu e_yy)`` in the layer, zero outside. Displacement is relative to the body at great depth,
    ``u_z = -∫ (e_zz + nu/(1-nu) (e_xx + e_yy)) dz`` over the layers below. A single inclusion and one of many periodic
    images differ by a constant displacement, which does not decrease with the padding, unlike all other differences.

    Examples
    --------
    A heated film of thickness 1, free on top, rises by (1+ν)/(1-ν) ε:

    >>> space = PeriodicHalfSpace(grid=Grid(nx=4, ny=4, dx=1.0, dy=1.0), interfaces=np.array([0.0, 1.0]),
    ...                           poisson_ratio=0.25)
    >>> film = np.zeros((6, 1, 4, 4))
    >>> film[:3] = 3e-3
    >>> float(space.apply(film, "displacement", depths=np.zeros(1))[2, 0, 0, 0].round(12))
    -0.005
    """

    grid: Grid
    interfaces: FloatArray
    poisson_ratio: float
    padding: float = 1.0
    aliases: int = 0
    threads: int | None = None

    def __post_init__(self) -> None:
        edges = np.asarray(self.interfaces, dtype=float)
        rule = "two or more ascending depths of 0 or more [m]"
        good = edges.ndim == 1 and edges.size >= 2 and edges[0] >= 0 and bool((np.diff(edges) > 0).all())
        require(good, _SUBJECT, "interfaces", self.interfaces, rule)
        require(1 <= self.padding < np.inf, _SUBJECT, "padding", self.padding, "1 or more")
        require(self.aliases >= 0, _SUBJECT, "aliases", self.aliases, "0 or more")
        require(-1 < self.poisson_ratio <= 0.5, _SUBJECT, "poisson_ratio", self.poisson_ratio, "in (-1, 0.5]")
        object.__setattr__(self, "interfaces", edges)

    @property
    def shape(self) -> tuple[int, int]:
        """Cells (ny, nx) of a period."""
        if self.padding == 1:
            return self.grid.shape
        return fast_even(round(self.padding * self.grid.ny)), fast_even(round(self.padding * self.grid.nx))

    def apply(
        self,
        eigenstrain: FloatArray,
        quantity: str,
        *,
        depths: FloatArray,
        target: tuple[int, int] | None = None,
        origin: tuple[float, float] = (0.0, 0.0),
    ) -> FloatArray:
        """Field of an eigenstrain on planes.

        Parameters
        ----------
        eigenstrain : (6, nz, ny, nx) [-]
            Mandel eigenstrain of the cells.
        quantity : {"displacement", "strain", "stress"}
            Displacement [m], total strain, or stress in units of the shear modulus; tensors are Mandel vectors.
        depths : (nd,) [m]
            Nonnegative, otherwise arbitrary. Strain and stress between two layers are the means of both sides, in the
            surface the limit from inside.
        target : (int, int), optional
            Number of points along (y, x), with the pitch of the grid; by default the size of the grid.
        origin : (float, float)
            First point relative to the first cell of the grid, in cells along (y, x); any real numbers.

        Returns
        -------
        (3 or 6, nd) + target
        """
        require(quantity in QUANTITIES, _SUBJECT, "quantity", quantity, f"one of {', '.join(map(repr, QUANTITIES))}")
        values, at = np.asarray(eigenstrain, dtype=float), np.asarray(depths, dtype=float)
        expected = (6, self.interfaces.size - 1, *self.grid.shape)
        require(values.shape == expected, _SUBJECT, "eigenstrain", values.shape, f"of shape {expected}")
        require(at.ndim == 1 and bool((at >= 0).all()), _SUBJECT, "depths", depths, "0 or more [m]")
        from scipy import fft

        workers = self.threads or available_threads()
        ny, nx = self.shape
        waves = fft.rfft2(values, s=(ny, nx), workers=workers)
        out = np.zeros((QUANTITIES[quantity], at.size, *waves.shape[2:]), dtype=complex)
        planes = [plane_at(self.interfaces, float(depth)) for depth in at]
        fractions = (origin[0] - float(np.floor(origin[0])), origin[1] - float(np.floor(origin[1])))
        count = max(1, _BATCH // waves.shape[3])

        def fill(first: int) -> None:
            batch = slice(first, first + count)
            for rows, columns, ky, kx, weight in self._waves(np.arange(ny)[batch], fractions):
                waves_sum = self._sum(waves[:, :, batch][:, :, rows[:, None], columns], quantity, planes, ky, kx)
                out[:, :, batch][:, :, rows[:, None], columns] += weight * waves_sum

        in_parallel(workers, [partial(fill, first) for first in range(0, ny, count)])
        out[:, :, 0, 0] += _uniform(waves[:, :, 0, 0].real, quantity, planes, self.interfaces, self.poisson_ratio)
        fields = fft.irfft2(out, s=(ny, nx), workers=workers)
        wanted_y, wanted_x = target or self.grid.shape
        rows = (int(np.floor(origin[0])) + np.arange(wanted_y)) % ny
        columns = (int(np.floor(origin[1])) + np.arange(wanted_x)) % nx
        return np.asarray(fields[:, :, rows[:, None], columns])

    def _waves(
        self, rows: NDArray[np.intp], fractions: tuple[float, float]
    ) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp], FloatArray, FloatArray, ComplexArray]]:
        """Aliases of `rows` on the grid: their rows and columns, ky, kx and weights."""
        ny, nx = self.shape
        for shift_y in self._shifts:
            kept_rows, ky, weight_y = self._axis(rows, shift_y, ny, self.grid.dy, fractions[0])
            for shift_x in self._shifts if kept_rows.size else ():
                columns, kx, weight_x = self._axis(np.arange(nx // 2 + 1), shift_x, nx, self.grid.dx, fractions[1])
                if columns.size:
                    yield kept_rows, columns, ky[:, None], kx[None, :], weight_y[:, None] * weight_x

    @property
    def _shifts(self) -> range:
        return range(-self.aliases - 1, self.aliases + 2)

    def _axis(
        self, numbers: NDArray[np.intp], shift: int, n: int, pitch: float, fraction: float
    ) -> tuple[NDArray[np.intp], FloatArray, ComplexArray]:
        """Waves of one axis shifted by multiples of the sampling rate: remaining `numbers`, wavenumbers, weights.

        The set of waves is symmetric: the two shortest waves, which are equal at the samples, have half the weight
        each.
        """
        moved = np.where(numbers > n // 2, numbers - n, numbers) + shift * n
        most = (2 * self.aliases + 1) * n
        resolved = np.flatnonzero(2 * np.abs(moved) <= most)
        moved = moved[resolved]
        weight = np.where(2 * np.abs(moved) == most, 0.5, 1.0) * np.exp(2j * np.pi * fraction / n * moved)
        if self.aliases:
            weight = weight * np.sinc(moved / n)
        return resolved, 2.0 * np.pi / (n * pitch) * moved, weight

    def _sum(
        self, eigenstrain: ComplexArray, quantity: str, planes: list[Plane], ky: FloatArray, kx: FloatArray
    ) -> ComplexArray:
        """Amplitudes ``(3 or 6, nd, rows, columns)`` of waves by those of the eigenstrain; 0 at k = 0."""
        k = np.hypot(ky, kx).ravel()
        mean = k == 0.0
        k[mean] = 1.0
        cos, sin = (kx + 0.0 * ky).ravel() / k, (ky + 0.0 * kx).ravel() / k
        source = _turned(eigenstrain.reshape(*eigenstrain.shape[:2], -1), cos, sin)
        source[[4, 5]] *= 1j
        out = LayerSums(self.interfaces, k, source, planes, coefficients(quantity, self.poisson_ratio)).field()
        out[[row for row, along in enumerate(ALONG_WAVE[quantity]) if along]] *= -1j
        if quantity == "displacement":
            across, along = out[1].copy(), out[0].copy()
            out[0], out[1] = cos * along - sin * across, sin * along + cos * across
            out /= k
        else:
            out = _turned(out, cos, -sin)
        out[..., mean] = 0.0
        return out.reshape(*out.shape[:2], ky.shape[0], kx.shape[1])


def _turned(tensor: ComplexArray, cos: FloatArray, sin: FloatArray) -> ComplexArray:
    """Mandel components ``(6, n, waves)`` in axes turned about z by the angle of each wave."""
    xx, yy, zz, yz, xz, xy = tensor
    out = np.empty_like(tensor)
    cc, ss, cs = cos * cos, sin * sin, cos * sin
    out[0] = cc * xx + ss * yy + SQRT2 * cs * xy
    out[1] = ss * xx + cc * yy - SQRT2 * cs * xy
    out[2] = zz
    out[3] = cos * yz - sin * xz
    out[4] = cos * xz + sin * yz
    out[5] = (cc - ss) * xy + SQRT2 * cs * (yy - xx)
    return out


def _uniform(
    eigenstrain: FloatArray, quantity: str, planes: list[Plane], interfaces: FloatArray, nu: float
) -> FloatArray:
    """Field of laterally uniform layers ``(6, nz)`` in a body with zero mean strain in the plane, ``(3 or 6, nd)``."""
    xx, yy, zz, yz, xz, xy = eigenstrain
    stretch = zz + nu / (1.0 - nu) * (xx + yy)  # zero normal and shear tractions
    zeros = np.zeros_like(xx)
    if quantity == "displacement":
        slopes = np.array([SQRT2 * xz, SQRT2 * yz, stretch])
        depths = np.array([plane.depth for plane in planes])
        thickness = interfaces[1:] - np.clip(depths[:, None], interfaces[:-1], interfaces[1:])
        return np.asarray(-slopes @ thickness.T)
    if quantity == "strain":
        values = np.array([zeros, zeros, stretch, yz, xz, zeros])
    else:
        plane_stress = 2.0 / (1.0 - nu)
        values = np.array(
            [-plane_stress * (xx + nu * yy), -plane_stress * (yy + nu * xx), zeros, zeros, zeros, -2.0 * xy]
        )
    shares = np.zeros((len(planes), xx.size))
    for number, plane in enumerate(planes):
        for layer, share in plane.inside:
            shares[number, layer] = share
    return np.asarray(values @ shares.T)
