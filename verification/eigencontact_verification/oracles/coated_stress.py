"""Stress in a coated half-space under a sphere that rests on it or slides: Hankel integrals of plane waves.

Conventions: z into the layered body; stress positive in tension, plain tensor components in the order xx, yy, zz, yz,
xz, xy; the shear traction q_x = μp acts on the layered body along +x. Sliding leaves the pressure as it is: normal and
tangential problem are not coupled.

A pressure or shear of amplitude J_0(kr) is the mean of plane waves over all directions. The stress of one wave is found
along and across it by a dense solution and turned; its dependence on the direction θ is a trigonometric polynomial of
degree three, and the mean of exp(imθ) times the wave is i^m J_m(kr) exp(imψ) at the angle ψ of the point.

References
----------
I. N. Sneddon 1951, Fourier Transforms, chapter 10 (Hankel integrals of the half-space).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.oracles.coated_contact import CoatedContact, Interpolant
from eigencontact_verification.oracles.layered_dense import traction_wave

__all__ = ["sliding_stress"]

FloatArray = NDArray[np.float64]
#: kz beyond which a wave has died out: with the P(k) k of the integral, 1e-13 of the pressure.
_LAST = 36.0
_ANGLES = 8


def sliding_stress(
    contact: CoatedContact,
    x: ArrayLike,
    y: ArrayLike,
    z: float,
    *,
    friction: float = 0.0,
    side: str = "below",
) -> FloatArray:
    """Stress ``(6, ...)`` [Pa] at points of the depth z.

    Parameters
    ----------
    contact : CoatedContact
        Supplies layers and pressure.
    x, y : array, broadcastable
        Points [m].
    z : float
        Depth [m], positive; from about a/1000 on (work grows with a/z).
    friction : float
        μ of the sliding contact.
    side : "above" or "below"
        Which material counts at an interface.
    """
    from scipy.special import jv

    x, y = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    r, psi = np.hypot(x, y), np.arctan2(y, x)
    local = _local(contact, z, side, 3 if friction else 1)
    k, weights, waves = local.quadrature(contact.radius + float(r.max(initial=0.0)))
    harmonics = _harmonics(waves, friction) * (weights * k * contact.hankel(k))
    stress = np.zeros((6, *x.shape))
    turned = np.multiply.outer(r, k)
    for order in range(4):
        bessel = jv(order, turned)
        for m in {order, -order}:
            # i^m J_m is even in m
            harmonic = np.einsum("ck,...k->c...", harmonics[m], bessel)
            stress += ((1j**order) * harmonic * np.exp(1j * m * psi)).real
    return stress


def _local(contact: CoatedContact, z: float, side: str, count: int) -> Interpolant:
    """Stress of waves along x under unit p, q_x and q_y, (3, 6), the first so many, as a function of k."""
    layers = [(h, E / (2.0 * (1.0 + nu)), nu) for h, E, nu in contact.layers]
    young, nu = contact.substrate
    base = (young / (2.0 * (1.0 + nu)), nu)
    units = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))[:count]

    def waves(k: float) -> NDArray[np.complex128]:
        amplitudes = np.zeros((3, 6), dtype=complex)
        for row, unit in enumerate(units):
            amplitudes[row] = traction_wave(layers, base, unit, k, 0.0, z, side=side)[1]
        return amplitudes

    last = _LAST / z
    first = 1e-2 * last
    if layers:
        moduli = [E for _, E, _ in contact.layers] + [young]
        first = min(first, 1e-3 * min(moduli) / max(moduli) / sum(h for h, _, _ in layers))
    return Interpolant.of(waves, first, last)


def _harmonics(waves: NDArray[np.complex128], friction: float) -> NDArray[np.complex128]:
    """Fourier coefficients over the direction of the wave, (8, 6, k), of the stress in x, y, z; -m stands at 8 - m."""
    stresses = []
    for angle in 2.0 * np.pi * np.arange(_ANGLES) / _ANGLES:
        c, s = np.cos(angle), np.sin(angle)
        # q_x of 1 is c along the wave and -s across it
        nn, tt, zz, tz, nz, nt = (waves[:, 0] + friction * (c * waves[:, 1] - s * waves[:, 2])).T
        xx = c * c * nn + s * s * tt - 2.0 * c * s * nt
        yy = s * s * nn + c * c * tt + 2.0 * c * s * nt
        xy = c * s * (nn - tt) + (c * c - s * s) * nt
        stresses.append(np.array([xx, yy, zz, c * tz + s * nz, c * nz - s * tz, xy]))
    return np.asarray(np.fft.fft(np.array(stresses), axis=0) / _ANGLES)
