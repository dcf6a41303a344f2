"""Self-affine random surface with a prescribed spectrum, independent of the grid.

Every wave of the period has the amplitude of the spectrum and a random phase. The phase belongs to the wave, not to a
cell of a grid. A finer grid therefore has the same surface, and a smaller cutoff adds waves without a change of the
others.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, Geometry, Grid, Length, Lengths, hook_for, require
from eigencontact_plugins.geometries.frame import body_axes, check_center

__all__ = ["RandomRough", "phases"]


#: Cells of the native grid per shortest wave.
_CELLS_PER_WAVE = 8
#: Largest number of waves along a side: there are twice its square phases, and 64 times its square cells of the native
#: grid.
_MOST = 1000
#: Numbers per block for points that are not a product of axes.
_PIECE = 4_000_000


class _Waves(NamedTuple):
    """Waves of the period; one of q and -q represents both: 0 <= n, and 0 < m if n = 0."""

    along_y: NDArray[np.intp]  #: n, periods along y, (ny,)
    along_x: NDArray[np.intp]  #: m, periods along x, (nx,)
    present: NDArray[np.bool_]  #: whether the surface has the wave, (ny, nx)
    q: FloatArray  #: wavenumber [1/m], (ny, nx)


@dataclass(frozen=True, kw_only=True)
class RandomRough(Geometry):
    """Random surface, self-affine and periodic, with a given spectrum: separation max(height) - height.

    Parameters
    ----------
    size : (float, float)
        Period along x and y [m]: the window of a periodic contact.
    rms_height : float, optional
        Root of the mean square height over the period [m]; this or ``rms_slope``.
    rms_slope : float, optional
        Root of the mean square slope over the period, of both directions together [-].
    hurst : float
        Hurst exponent H, above 0 and up to 1; the fractal dimension of the surface is 3 - H.
    roll_off : float, optional
        Wavelength λ_r [m] above which the spectrum is constant; by default the longer period, so that no part is
        constant.
    short_cutoff : float
        Shortest wavelength λ_s [m].
    long_cutoff : float, optional
        Longest wavelength [m]; by default that of the period.
    seed : int
        Seed of the phases; surfaces of different seeds have the same spectrum.
    center : (float, float)
        Position of the centre of the window (x, y) [m].

    Notes
    -----
    Wavevectors are q = 2π (m/Lx, n/Ly), and the spectrum is C(q) = C0 (max(q, q_r) / q_r)^(-2 - 2H) up to q_s, with q_r
    = 2π/λ_r and q_s = 2π/λ_s. The height is h = Σ √(C(q) / (Lx Ly)) cos(q·x + φ_q) over all q. Phases φ_q are uniformly
    distributed and amplitudes are those of the spectrum. The root mean square is therefore exact for every seed, not
    only in the mean over many seeds. With many waves the heights are normally distributed.

    The surface is smooth and independent of the grid. Its native grid is one period with 8 cells per shortest wave; the
    datum 0 is the highest point on this grid. Geometries are added: together with a sphere the surface is the roughness
    of a ball.

    Examples
    --------
    >>> surface = RandomRough(size=(1e-4, 1e-4), rms_height=1e-7, short_cutoff=1e-5, seed=7)
    >>> y, x = surface.native_grid().axes()
    >>> f"{surface.separation(x, y).std():.6g} m"
    '1e-07 m'
    """

    key: ClassVar[str] = "random-rough"
    example: ClassVar[dict[str, Any]] = {"size": "100 um", "short_cutoff": "10 um", "rms_slope": 0.1}
    larger_window: ClassVar[str] = "give the geometry 'random-rough' a larger size"
    references: ClassVar[tuple[str, ...]] = (
        "B. N. J. Persson et al. 2005, doi:10.1088/0953-8984/17/1/R01",
        "T. D. B. Jacobs, T. Junge, L. Pastewka 2017, doi:10.1088/2051-672X/aa51f8",
    )

    size: Lengths
    short_cutoff: Length
    rms_height: Length | None = None
    rms_slope: float | None = None
    hurst: float = 0.8
    roll_off: Length | None = None
    long_cutoff: Length | None = None
    seed: int = 1
    center: tuple[Length, Length] = (0.0, 0.0)

    def __post_init__(self) -> None:
        usable = len(self.size) == 2 and all(0 < side < np.inf for side in self.size)
        require(usable, self.key, "size", self.size, "two positive and finite lengths (x, y)")
        names = [name for name in ("rms_height", "rms_slope") if getattr(self, name) is not None]
        rule = "given where rms_slope is not, one of the two"
        require(len(names) == 1, self.key, "rms_height", self.rms_height, rule)
        value = getattr(self, names[0])
        require(0 < value < np.inf, self.key, names[0], value, "positive and finite")
        require(0 < self.hurst <= 1, self.key, "hurst", self.hurst, "above 0 and up to 1 [-]")
        period = max(self.size)
        rule = f"from {period / _MOST:.4g} m, a {_MOST}th of the period, to {period:.4g} m, the period"
        require(period / _MOST <= self.short_cutoff <= period, self.key, "short_cutoff", self.short_cutoff, rule)
        for name in ("roll_off", "long_cutoff"):
            value = getattr(self, name)
            good = value is None or self.short_cutoff <= value <= period * (1 + 1e-9)
            rule = f"from {self.short_cutoff:.4g} m, the short cutoff, to {period:.4g} m, the period"
            require(good, self.key, name, value, rule)
        rule = "longer: no wave of the period lies between it and the short cutoff"
        require(self._waves.present.any(), self.key, "long_cutoff", self.long_cutoff, rule)
        require(self.seed >= 0, self.key, "seed", self.seed, "0 or a positive whole number")
        check_center(self.key, self.center)

    def native_grid(self) -> Grid:
        """One period, with cells of at most an eighth of the shortest wave."""
        from scipy.fft import next_fast_len

        nx, ny = (
            2 * next_fast_len(int(np.ceil(0.5 * _CELLS_PER_WAVE * side / self.short_cutoff - 1e-6)), real=True)
            for side in self.size
        )
        center = (float(self.center[0]), float(self.center[1]))
        return Grid(nx=nx, ny=ny, dx=self.size[0] / nx, dy=self.size[1] / ny, center=center)

    def separation(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Separation [m]; 0 at the highest point of the native grid."""
        return np.asarray(self._highest - self._height(x, y))

    @cached_property
    def _highest(self) -> float:
        y, x = self.native_grid().axes()
        return float(self._height(x, y).max())

    def _height(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Height above the mean plane [m]: the waves along x first, then those along y."""
        along, across = body_axes(x, y, self.center)
        shape = np.broadcast_shapes(along.shape, across.shape)
        columns, rows = _axis(along, shape, -1), _axis(across, shape, -2)
        if columns is not None and rows is not None:
            half = self._coefficients @ _turns(self._waves.along_x, columns / self.size[0])
            turn = _turns(self._waves.along_y, rows / self.size[1])
            # Only the real part, as one product of real matrices.
            height = np.concatenate([turn.real, -turn.imag]).T @ np.concatenate([half.real, half.imag])
            return np.asarray(height).reshape(shape)
        points = np.stack(
            [coordinates.ravel() for coordinates in np.broadcast_arrays(along / self.size[0], across / self.size[1])]
        )
        pieces = -(-points.shape[1] * sum(self._coefficients.shape) // _PIECE) or 1
        heights = []
        for coordinates in np.array_split(points, pieces, axis=1):
            half = self._coefficients @ _turns(self._waves.along_x, coordinates[0])
            heights.append(np.einsum("np,np->p", half, _turns(self._waves.along_y, coordinates[1])).real)
        return np.concatenate(heights).reshape(shape)

    @cached_property
    def _waves(self) -> _Waves:
        most_x, most_y = (int(side / self.short_cutoff * (1 + 1e-9)) for side in self.size)
        n, m = np.arange(most_y + 1), np.arange(-most_x, most_x + 1)
        q = 2 * np.pi * np.hypot(n[:, None] / self.size[1], m[None, :] / self.size[0])
        present = (q <= 2 * np.pi / self.short_cutoff * (1 + 1e-9)) & ((n[:, None] > 0) | (m[None, :] > 0))
        if self.long_cutoff is not None:
            present &= q >= 2 * np.pi / self.long_cutoff * (1 - 1e-9)
        return _Waves(along_y=n, along_x=m, present=present, q=q)

    @cached_property
    def _coefficients(self) -> NDArray[np.complex128]:
        """Complex amplitude of every wave [m]; 0 for waves outside the spectrum."""
        present, q = self._waves.present, self._waves.q
        roll_off = 2 * np.pi / (max(self.size) if self.roll_off is None else self.roll_off)
        amplitude = np.where(present, (np.maximum(q, roll_off) / roll_off) ** -(1 + self.hurst), 0.0)
        if self.rms_height is not None:
            amplitude *= self.rms_height / np.sqrt(0.5 * np.sum(amplitude**2))
        else:
            amplitude *= (self.rms_slope or 0.0) / np.sqrt(0.5 * np.sum((q * amplitude) ** 2))
        phase = phases(self._waves.along_y[:, None], self._waves.along_x, self.seed)
        coefficients: NDArray[np.complex128] = amplitude * np.exp(1j * phase)
        return coefficients


def phases(n: NDArray[np.intp], m: NDArray[np.intp], seed: int) -> FloatArray:
    """Phases of the waves with n periods along y and m along x, which broadcast; n is not negative.

    The numbers are drawn square by square around the wave 0, so that the phases of long waves do not depend on the
    number of short waves. They are made from raw bits, which NumPy guarantees to be constant for a seed.

    Examples
    --------
    >>> few = phases(np.arange(3)[:, None], np.arange(-2, 3), seed=4)
    >>> many = phases(np.arange(9)[:, None], np.arange(-8, 9), seed=4)
    >>> bool((few == many[:3, 6:11]).all())
    True
    """
    ring = np.maximum(np.abs(m), n)
    side = np.where(n == 0, 0, 2 * n - 1 + (m < 0))
    place = 2 * ring * (ring - 1) + np.where(n == ring, 2 * ring - 1 + m + ring, side)
    place = np.maximum(place, 0)  # the wave 0, which is not part of any surface
    random_numbers = np.random.PCG64(seed).random_raw(int(place.max()) + 1)
    return np.asarray(2 * np.pi * 2.0**-53 * (random_numbers >> np.uint64(11))[place], dtype=float)


def _turns(numbers: NDArray[np.intp], periods: FloatArray) -> NDArray[np.complex128]:
    """``exp(2πi n t)`` for waves with n periods at positions t in periods, (waves, positions)."""
    turned: NDArray[np.complex128] = np.exp(2j * np.pi * numbers[:, None] * (periods - np.rint(periods))[None, :])
    return turned


def _axis(values: FloatArray, shape: tuple[int, ...], axis: int) -> FloatArray | None:
    """Values along one of the last two axes of `shape`, if they vary only along it; otherwise None."""
    if len(shape) != 2:
        return None
    full = np.broadcast_to(values, shape)
    line = full[0] if axis == -1 else full[:, 0]
    constant = np.array_equal(full, np.broadcast_to(line if axis == -1 else line[:, None], shape))
    return np.ascontiguousarray(line) if constant else None


eigencontact_register = hook_for(RandomRough)
