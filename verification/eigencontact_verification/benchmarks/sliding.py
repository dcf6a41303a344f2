"""The Cattaneo-Mindlin problem of the benchmarks, and one measure of any code's answer, taken from outside.

A code's own residual may mean anything. Here every pair of pressure and shear, whoever computed it, is judged by the
same few lines: the tangential displacement of piecewise constant shear by the exact coefficients of a rectangle, in
double precision, by a plain zero-padded convolution. Nothing of eigencontact is imported.

Units: lengths in contact radii, tractions in contact moduli, as in `measure`.

References
----------
.. [1] K. L. Johnson, Contact Mechanics (Cambridge, 1985), section 7.2 (eqs. 7.21-7.31): the closed form.
.. [2] J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (Kluwer, 1990), section 5.3: the coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.fft

from eigencontact_verification.benchmarks.measure import FloatArray, HertzProblem, corners, wrapped_lags

__all__ = ["ShearConvolution", "SlidingJudgement", "SlidingProblem", "judge_sliding"]

#: A cell slips where its shear is this close to its bound, relative.
_AT_BOUND = 1e-4
#: Cells whose shear is below this part of the bound stick beyond doubt: they tell the shift.
_DEEP = 0.9


@dataclass(frozen=True, kw_only=True, slots=True)
class SlidingProblem:
    """A rigid paraboloid pressed by Hertz's load, then sheared along x by half of what friction can carry.

    Normal displacement by shear and tangential displacement by pressure are left out, as between like bodies.
    """

    n: int  #: cells along each side of a window of four contact radii
    poisson_ratio: float  #: Poisson's ratio of the elastic body
    friction: float = 0.5
    share: float = 0.5  #: tangential load over friction times normal load
    hertz: HertzProblem = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "hertz", HertzProblem(n=self.n))

    @property
    def tangential_load(self) -> float:
        """Q_x [E* a^2]."""
        return self.share * self.friction * self.hertz.load

    @property
    def stick_radius(self) -> float:
        """c/a of the closed form."""
        return float((1.0 - self.share) ** (1.0 / 3.0))

    @property
    def shear(self) -> FloatArray:
        """Closed form of q_x at the cell centres, (n, n) [E*]; exact for Poisson's ratio 0, q_y being left out."""
        r2, c = self.hertz.squared_radius, self.stick_radius
        whole, inner = np.sqrt(np.maximum(1.0 - r2, 0.0)), np.sqrt(np.maximum(1.0 - r2 / c**2, 0.0))
        return np.asarray(self.friction * self.hertz.peak * (whole - c * inner))


class ShearConvolution:
    """Zero-padded convolution of shear (2, n, n) to tangential displacement by plain scipy.fft; the unit of time.

    One call is two forward real transforms on (2n, 2n), four products with spectra computed beforehand, two inverse
    transforms and two crops.
    """

    def __init__(self, problem: SlidingProblem) -> None:
        n, cell, nu = problem.n, problem.hertz.cell, problem.poisson_ratio
        self.n = n
        lags = wrapped_lags(n, cell)
        x, y, half = lags[None, :], lags[:, None], 0.5 * cell
        straight = corners(lambda s, t: s * np.arcsinh(t / np.abs(s)), x, y, half)
        turned = corners(lambda s, t: t * np.arcsinh(s / np.abs(t)), x, y, half)
        crossed = corners(np.hypot, x, y, half)
        kernels = {
            (0, 0): straight + turned / (1.0 - nu),
            (1, 1): turned + straight / (1.0 - nu),
            (0, 1): -nu / (1.0 - nu) * crossed,
        }
        spectra = {pair: scipy.fft.rfft2(kernel / np.pi) for pair, kernel in kernels.items()}
        self.spectra = [[spectra[min(i, j), max(i, j)] for j in range(2)] for i in range(2)]

    def __call__(self, shear: FloatArray, workers: int = 1) -> FloatArray:
        """Displacement (2, n, n) of a shear (2, n, n)."""
        shape = (2 * self.n, 2 * self.n)
        waves = scipy.fft.rfft2(shear, s=shape, workers=workers)
        waves = np.stack([row[0] * waves[0] + row[1] * waves[1] for row in self.spectra])
        return np.asarray(scipy.fft.irfft2(waves, s=shape, workers=workers)[:, : self.n, : self.n])


@dataclass(frozen=True, kw_only=True, slots=True)
class SlidingJudgement:
    """Outside measure of one answer; all relative [-]."""

    #: Largest difference between the shear and what friction makes of it: ``q - P(q - k slip)`` with P the shortening
    #: to the bound, over the largest bound; k is the largest bound over the largest displacement. In stick this is the
    #: slip, in slip its part across the shear, and shear beyond its bound counts as such.
    residual: float
    load_error: float  #: tangential load against the prescribed one, minus 1
    shear_error: float  #: L2 norm of q_x minus the closed form, over the norm of that
    stick_radius: float  #: radius of the circle of the sticking area over that of the contact area


def judge_sliding(problem: SlidingProblem, pressure: FloatArray, shear: FloatArray) -> SlidingJudgement:
    """Measure an answer from outside.

    Parameters
    ----------
    problem : SlidingProblem
        What was solved.
    pressure, shear : (n, n), (2, n, n) array
        Any code's answer [E*]; the bound is friction times *its* pressure.

    Raises
    ------
    ValueError
        If the fields have other shapes, are not finite, or nothing sticks: the shift cannot be told then.
    """
    p, q = np.asarray(pressure, dtype=np.float64), np.asarray(shear, dtype=np.float64)
    n = problem.n
    if p.shape != (n, n) or q.shape != (2, n, n):
        raise ValueError(f"pressure and shear must be of shape {(n, n)} and {(2, n, n)} (got {p.shape} and {q.shape})")
    if not (np.isfinite(p).all() and np.isfinite(q).all()):
        raise ValueError("pressure and shear must be finite (got nan or inf); the code did not solve the problem")
    bound = problem.friction * np.maximum(p, 0.0)
    size, loaded = np.hypot(q[0], q[1]), p > 0
    deep = loaded & (size < _DEEP * bound)
    if not deep.any():
        raise ValueError("shear must be below its bound somewhere (got none); the code did not solve the problem")
    moved = ShearConvolution(problem)(q)
    slip = moved - moved[:, deep].mean(axis=1)[:, None, None]
    stiffness = float(bound.max()) / float(np.hypot(*moved)[loaded].max())
    trial = q - stiffness * slip
    allowed = trial * np.minimum(1.0, bound / np.maximum(np.hypot(*trial), np.finfo(float).tiny))
    closed, stick = problem.shear, loaded & (size < (1.0 - _AT_BOUND) * bound)
    return SlidingJudgement(
        residual=float(np.hypot(*(q - allowed)).max()) / float(bound.max()),
        load_error=float(q[0].sum()) * problem.hertz.cell**2 / problem.tangential_load - 1.0,
        shear_error=float(np.linalg.norm(q[0] - closed) / np.linalg.norm(closed)),
        stick_radius=float(np.sqrt(np.count_nonzero(stick) / np.count_nonzero(loaded))),
    )
