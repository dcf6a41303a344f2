"""Closed forms and published numbers for eigenstrain: Eshelby's tensors, a hot ball below a surface, a long bar.

Conventions: z into the body (the surface is z = 0), tension positive, plain tensor components, small strains, isotropic
body. Eshelby's tensor S gives the total strain ``e_ij = S_ijkl e*_kl`` inside an inclusion in full space.

References
----------
J. D. Eshelby 1957, Proc. R. Soc. A 241, 376; T. Mura 1987, Micromechanics of Defects in Solids, section 11 (cube: the
potentials of a rectangular block, section 12); G. P. Tandon and G. J. Weng 1984, Polymer Composites 5, 327 (spheroids);
R. D. Mindlin and D. H. Cheng 1950, J. Appl. Phys. 21, 931 (ball in a half-space); J. H. Davies 2003,
J. Appl. Mech. 70, 655 (any dilatational inclusion in a half-space); G. Lamé's thick cylinder (bar).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "SURFACE_OF_BURIED_CUBE",
    "TANGENT_BALL_AXIS",
    "Bar",
    "apply",
    "cube_centre_tensor",
    "dilatational_ball_displacement",
    "dilatational_ball_stress",
    "dilatational_ball_surface",
    "infinite_bar",
    "sphere_tensor",
    "spheroid_tensor",
]

FloatArray = NDArray[np.float64]


def _tensor(values: dict[str, float]) -> FloatArray:
    """Fourth-order tensor from plain components ``"1122": value``, minor symmetries filled in."""
    S = np.zeros((3, 3, 3, 3))
    for key, value in values.items():
        i, j, k, l = (int(c) - 1 for c in key)
        S[i, j, k, l] = S[j, i, k, l] = S[i, j, l, k] = S[j, i, l, k] = value
    return S


def _cubic(s1111: float, s1122: float, s1212: float) -> FloatArray:
    pairs = ("12", "13", "23")
    values = {f"{i}{i}{i}{i}": s1111 for i in (1, 2, 3)}
    values |= {f"{i}{i}{j}{j}": s1122 for i in (1, 2, 3) for j in (1, 2, 3) if i != j}
    return _tensor(values | {p + p: s1212 for p in pairs})


def apply(tensor: FloatArray, eigenstrain: ArrayLike) -> FloatArray:
    """Total strain ``S_ijkl e*_kl``, (3, 3)."""
    return np.asarray(np.einsum("ijkl,kl->ij", tensor, np.asarray(eigenstrain, dtype=float)))


def sphere_tensor(nu: float) -> FloatArray:
    """Eshelby's tensor (3, 3, 3, 3) of a ball, -1 < nu <= 0.5 (Mura eq. 11.21)."""
    return _cubic(*(value / (15 * (1 - nu)) for value in (7 - 5 * nu, 5 * nu - 1, 4 - 5 * nu)))


def cube_centre_tensor(nu: float) -> FloatArray:
    """Eshelby's tensor (3, 3, 3, 3) at the centre of a cube.

    From ``phi,11 = -4 pi/3`` (by symmetry), ``psi,1122 = -4/sqrt(3)`` and ``psi,1111 + 2 psi,1122 = 2 phi,11``
    (Mura, sections 11 and 12: the potentials of a block and their relation to S).
    """
    phi, mixed = -4 * np.pi / 3, -4 / np.sqrt(3)
    axial = 2 * phi - 2 * mixed
    factor = 8 * np.pi * (1 - nu)
    return _cubic(
        (axial - 2 * nu * phi - 4 * (1 - nu) * phi) / factor,
        (mixed - 2 * nu * phi) / factor,
        (mixed - 2 * (1 - nu) * phi) / factor,
    )


def spheroid_tensor(aspect: float, nu: float) -> FloatArray:
    """Eshelby's tensor (3, 3, 3, 3) of a spheroid about axis 1 = x (Tandon and Weng 1984, appendix).

    Parameters
    ----------
    aspect : float
        Length along the axis over diameter; above 1 prolate, below 1 oblate. Cancellation loses digits like
        1e-16 / (aspect - 1)^2 near the ball, which has its own function.
    nu : float
        Poisson's ratio, -1 < nu <= 0.5.
    """
    t2 = aspect * aspect
    d = t2 - 1
    root = np.sqrt(abs(d))
    if d > 0:
        g = float(aspect * (aspect * root - np.arccosh(aspect)) / root**3)
    else:
        g = float(aspect * (np.arccos(aspect) - aspect * root) / root**3)
    n, m = 1 - 2 * nu, 1 - nu
    s1111 = (n + (3 * t2 - 1) / d - (n + 3 * t2 / d) * g) / (2 * m)
    s2222 = 3 * t2 / (8 * m * d) + (n - 9 / (4 * d)) * g / (4 * m)
    s2233 = (t2 / (2 * d) - (n + 3 / (4 * d)) * g) / (4 * m)
    s2211 = -t2 / (2 * m * d) + (3 * t2 / d - n) * g / (4 * m)
    s1122 = (-(n + 1 / d) + (n + 3 / (2 * d)) * g) / (2 * m)
    s2323 = (t2 / (2 * d) + (n - 3 / (4 * d)) * g) / (4 * m)
    s1212 = (n - (t2 + 1) / d - (n - 3 * (t2 + 1) / d) * g / 2) / (4 * m)
    return _tensor(
        {
            "1111": s1111, "2222": s2222, "3333": s2222, "2233": s2233, "3322": s2233, "2211": s2211, "3311": s2211,
            "1122": s1122, "1133": s1122, "2323": s2323, "1212": s1212, "1313": s1212,
        }
    )  # fmt: skip


def _newton(offset: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """First, second and third derivatives of 1/R at the offsets ``(n, 3)``."""
    x = np.asarray(offset)
    R2 = (x * x).sum(axis=1)
    unit = np.eye(3)
    first = -x / R2[:, None] ** 1.5
    second = (3 * np.einsum("ni,nj->nij", x, x) - R2[:, None, None] * unit) / R2[:, None, None] ** 2.5
    pairs = np.einsum("ni,jk->nijk", x, unit)
    pairs = pairs + np.einsum("nj,ik->nijk", x, unit) + np.einsum("nk,ij->nijk", x, unit)
    cubes = np.einsum("ni,nj,nk->nijk", x, x, x)
    third = (3 * R2[:, None, None, None] * pairs - 15 * cubes) / R2[:, None, None, None] ** 3.5
    return first, second, third


def _ball(points: ArrayLike, center: ArrayLike, radius: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    x = np.atleast_2d(np.asarray(points, dtype=float))
    c = np.asarray(center, dtype=float)
    real, mirror = x - c, x - c * (1, 1, -1)
    return x, real, mirror, np.sqrt((real**2).sum(axis=1)) <= radius


def dilatational_ball_displacement(
    points: ArrayLike, center: ArrayLike, radius: float, eigenstrain: float, nu: float
) -> FloatArray:
    """Displacement ``(n, 3)`` [m] by ``eigenstrain * I`` in a ball that lies in the half-space (it may touch z = 0).

    Davies 2003: ``u_i = -(1+nu) e / (4 pi (1-nu)) [F0,i + (3-4nu) s_i F,i + 2 z F,3i]``, s = (1, 1, -1), with F0
    and F the Newtonian potentials of the ball and of its mirror image; -1 < nu <= 0.5.
    """
    x, real, mirror, inside = _ball(points, center, radius)
    volume = 4 * np.pi / 3 * radius**3
    first, second, _ = (volume * d for d in _newton(mirror))
    near = np.where(inside[:, None], np.array((0.0, 0.0, radius)), real)
    direct = np.where(inside[:, None], -4 * np.pi / 3 * real, volume * _newton(near)[0])
    field = direct + (3 - 4 * nu) * first * (1, 1, -1) + 2 * x[:, 2:] * second[:, 2]
    return np.asarray(-(1 + nu) * eigenstrain / (4 * np.pi * (1 - nu)) * field)


def dilatational_ball_stress(
    points: ArrayLike, center: ArrayLike, radius: float, eigenstrain: float, nu: float, shear_modulus: float = 1.0
) -> FloatArray:
    """Stress ``(n, 3, 3)`` [Pa] of the same ball, from `dilatational_ball_displacement` by Hooke's law.

    Points on the boundary of the ball count as inside; -1 < nu <= 0.5.
    """
    x, real, mirror, inside = _ball(points, center, radius)
    volume = 4 * np.pi / 3 * radius**3
    _, second, third = (volume * d for d in _newton(mirror))
    near = np.where(inside[:, None], np.array((0.0, 0.0, radius)), real)
    hot = inside[:, None, None]
    direct = np.where(hot, -4 * np.pi / 3 * np.eye(3), volume * _newton(near)[1])
    slope = direct + (3 - 4 * nu) * np.array((1, 1, -1))[:, None] * second + 2 * x[:, 2, None, None] * third[:, 2]
    slope[:, :, 2] += 2 * second[:, 2]
    factor = -(1 + nu) * eigenstrain / (4 * np.pi * (1 - nu))
    strain = factor * (slope + np.swapaxes(slope, 1, 2)) / 2 - np.where(hot, eigenstrain * np.eye(3), 0.0)
    # (e_kk - e*_kk)/(1-2nu): -2e/(1-nu) inside, and the image's -4 factor F,33
    mean = np.where(inside, -2 * eigenstrain / (1 - nu), 0.0) - 4 * factor * second[:, 2, 2]
    return np.asarray(2 * shear_modulus * (strain + nu * mean[:, None, None] * np.eye(3)))


def dilatational_ball_surface(
    depth: float, radius: float, eigenstrain: float, nu: float, young_modulus: float = 1.0
) -> tuple[float, float]:
    """Surface above the centre of the same ball: sigma_xx = sigma_yy [Pa] just outside it, uplift -u_z [m].

    ``(4/3) E e (1+nu)/(1-nu) (a/c)^3`` and ``(4/3)(1+nu) e a^3/c^2``; depth c >= radius a.
    """
    ratio = radius / depth
    tension = 4 / 3 * young_modulus * eigenstrain * (1 + nu) / (1 - nu) * ratio**3
    return tension, 4 / 3 * (1 + nu) * eigenstrain * radius * ratio**2


#: Ball tangent to the surface (depth = radius a), nu = 0.3: depth z/a on the axis, sigma_xx and sigma_zz in units of
#: ``2 mu e (1+nu)/(1-nu)``. At z = 0 the value just outside the ball, at z = 2a the one inside. Six digits. A
#: tabulation of the Mindlin-Cheng solution that was compared with quadrature of Mindlin's point force.
TANGENT_BALL_AXIS: tuple[tuple[float, float, float], ...] = (
    (0.0, 1.73333, 0.0),
    (0.5, -0.449383, -0.074074),
    (1.0, -0.616667, -0.333333),
    (1.5, -0.653867, -0.470400),
    (2.0, -0.664198, -0.543210),
    (2.5, 0.098099, -0.115343),
)


def _single(*entries: tuple[int, int, float]) -> FloatArray:
    e = np.zeros((3, 3))
    for i, j, value in entries:
        e[i, j] = e[j, i] = value
    return e


#: Unit cube with its centre at (2, 1, 5), nu = 0.3, field point (0, 0, 0) on the surface: eigenstrain (3, 3),
#: displacement (x, y, z) and the unit of its last printed digit. From the reciprocal theorem: integrals of Boussinesq's
#: and Cerruti's stress times the eigenstrain over the cube, trace-free rows first.
SURFACE_OF_BURIED_CUBE: tuple[tuple[str, FloatArray, tuple[float, float, float], tuple[float, float, float]], ...] = (
    ("11-22", _single((0, 0, 1), (1, 1, -1)), (-9.8538e-4, -3.6568e-5, -1.26323e-3), (1e-8, 1e-9, 1e-8)),
    ("11-33", _single((0, 0, 1), (2, 2, -1)), (4.17634e-3, 2.31607e-3, 1.11636e-2), (1e-8, 1e-8, 1e-7)),
    ("12", _single((0, 1, 1)), (-9.3376e-4, -8.0886e-4, -1.68445e-3), (1e-8, 1e-8, 1e-8)),
    ("13", _single((0, 2, 1)), (-3.90016e-3, -1.90961e-3, -9.58275e-3), (1e-8, 1e-8, 1e-8)),
    ("23", _single((1, 2, 1)), (-1.90961e-3, -1.03598e-3, -4.79113e-3), (1e-8, 1e-8, 1e-8)),
    ("11", _single((0, 0, 1)), (-6.1503e-4, -7.949e-5, -8.9707e-4), (1e-8, 1e-8, 1e-8)),
    ("22", _single((1, 1, 1)), (3.7035e-4, -4.293e-5, 3.6616e-4), (1e-8, 1e-8, 1e-8)),
    ("33", _single((2, 2, 1)), (-4.79138e-3, -2.39557e-3, -1.206067e-2), (1e-8, 1e-8, 1e-8)),
    ("identity", np.eye(3), (-5.03606e-3, -2.51799e-3, -1.259157e-2), (1e-8, 1e-8, 1e-8)),
)


@dataclass(frozen=True, kw_only=True)
class Bar:
    """Infinite circular bar along x in full space, in another material, with a uniform axial eigenstrain.

    Attributes
    ----------
    axial, transverse : float
        Stress in the bar along x, and across it [Pa].
    von_mises : float
        ``|axial - transverse|`` [Pa].
    equivalent : (3, 3) array
        Eigenstrain of a bar of the matrix material that has the same stress (Eshelby's equivalent inclusion).
    """

    axial: float
    transverse: float
    von_mises: float
    equivalent: FloatArray


def infinite_bar(eigenstrain: float, bar: tuple[float, float], matrix: tuple[float, float]) -> Bar:
    """Stress in an infinite circular bar whose natural length is ``1 + eigenstrain`` times that of its hole.

    Parameters
    ----------
    eigenstrain : float
        Axial eigenstrain.
    bar, matrix : (float, float)
        Young's modulus [Pa] and Poisson's ratio of each; nu < 0.5 in the bar.

    Notes
    -----
    The total axial strain is zero; across, the matrix answers a radial strain g of its hole with the pressure
    ``2 mu_0 g`` (Lamé), so ``g = lambda_1 e / (2 (lambda_1 + mu_1 + mu_0))``.
    """
    E1, n1 = bar
    E0, n0 = matrix
    mu1, mu0 = E1 / (2 * (1 + n1)), E0 / (2 * (1 + n0))
    lame = 2 * mu1 * n1 / (1 - 2 * n1)
    radial = lame * eigenstrain / (2 * (lame + mu1 + mu0))
    axial = -(lame + 2 * mu1) * eigenstrain + 2 * lame * radial
    across = -2 * mu0 * radial
    along_eq = -(axial - 2 * n0 * across) / E0
    across_eq = radial - ((1 - n0) * across - n0 * axial) / E0
    return Bar(
        axial=axial,
        transverse=across,
        von_mises=abs(axial - across),
        equivalent=np.diag([along_eq, across_eq, across_eq]),
    )
