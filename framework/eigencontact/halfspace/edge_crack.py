"""Stress intensity factors of a straight edge crack in an elastic half-plane, at any angle to its surface.

The crack is a row of edge dislocations whose tractions cancel those of the body without the crack (theorem of
superposition). A half-plane has no length, so the equations are solved once per angle; the factors of any crack
length and any traction are then a product with a small matrix.

Symbols: w = x + i z, body at z > 0, crack w = s exp(i omega), 0 < s < a. Capital Phi and Psi are Muskhelishvili's
potentials: sigma_xx + sigma_zz = 4 Re Phi, sigma_zz - sigma_xx + 2 i sigma_xz = 2 (conj(w) Phi' + Psi).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from eigencontact.core.array_types import ComplexArray, FloatArray
from eigencontact.errors import require

__all__ = ["EdgeCrack", "edge_crack"]

#: Dislocations of a crack. Factors under tension err by 3e-8 at 0, 3e-6 at 45, 2e-5 at 60 and 2e-4 at 75 degrees.
_NODES = 80
#: Largest angle between crack and normal of the surface [rad]: a thinner wedge needs more nodes.
_STEEPEST = np.radians(75.0)


@dataclass(frozen=True, slots=True, eq=False)
class EdgeCrack:
    """Weights of an edge crack of one angle.

    Attributes
    ----------
    places : (nodes,)
        Distances from the mouth at which tractions are read, in crack lengths, increasing.
    weights : (2, 2, nodes)
        K_I and K_II (first index) over ``sqrt(pi a)`` of unit normal and shear stress (second index) at the places.
    """

    places: FloatArray
    weights: FloatArray

    def factors(self, length: float, normal: FloatArray, shear: FloatArray) -> FloatArray:
        """Stress intensity factors of faces that do not touch.

        Parameters
        ----------
        length : float
            Length of the crack [m].
        normal, shear : (..., nodes)
            Stress of the body without the crack at ``length * places`` [Pa]: across the path (tension positive), and
            the component ``t . sigma . n``, with t from mouth to tip and n a quarter turn from t from x towards z.

        Returns
        -------
        (2, ...) float64
            K_I and K_II [Pa sqrt(m)].
        """
        tractions = np.stack([normal, shear])
        return np.asarray(np.sqrt(np.pi * length) * np.einsum("kcn,c...n->k...", self.weights, tractions))


@lru_cache(maxsize=64)
def edge_crack(angle: float, nodes: int = _NODES) -> EdgeCrack:
    """Weights of a crack that starts at the surface.

    Parameters
    ----------
    angle : float
        Between the crack and the inward normal of the surface [rad], positive towards +x.
    nodes : int
        Dislocations along the crack.

    Notes
    -----
    Integral equations with Cauchy kernels and the image of a dislocation below a free surface, by Gauss-Chebyshev
    quadrature. With ``s = a (1 + t)^2 / 4`` and the density ``g(t) sqrt((1 + t) / (1 - t)) / (1 + t)`` (mouth at
    t = -1, tip at t = 1) the error under tension falls with the fourth power of the number of nodes; the plain
    ``s = a (1 + t) / 2`` gives the second power, as the density at the mouth is finite and not zero.

    References
    ----------
    D. A. Hills, P. A. Kelly, D. N. Dai, A. M. Korsunsky, Solution of Crack Problems (Kluwer 1996), chapters 2 and 3.

    Examples
    --------
    >>> crack = edge_crack(0.0)
    >>> one = np.ones(crack.places.size)
    >>> tension = crack.factors(1 / np.pi, one, 0 * one)
    >>> tension.round(6).tolist()
    [1.121522, 0.0]
    """
    require(abs(angle) <= _STEEPEST, "crack", "angle", angle, f"within {_STEEPEST:.3f} of the normal [rad]")
    require(nodes >= 4, "crack", "nodes", nodes, "4 or more")
    count = 2 * nodes + 1
    odd = (2 * np.arange(1, nodes + 1) - 1) * np.pi / count
    t, r = np.cos(odd), np.cos(2 * np.arange(1, nodes + 1) * np.pi / count)
    shares = 2 * np.pi * (1 + t) / count
    along = np.exp(1j * (0.5 * np.pi - angle))
    field, at = 0.25 * (1 + r[:, None]) ** 2 * along, 0.25 * (1 + t) ** 2 * along
    opening, sliding = (_traction(field, at, strength, along) * shares for strength in (along, -1j * along))
    matrix = np.block([[opening.real, sliding.real], [opening.imag, sliding.imag]])
    tip = np.zeros((2, 2 * nodes))
    tip[0, :nodes] = tip[1, nodes:] = 2 / count / np.tan(0.5 * odd) * np.sin(nodes * odd)  # Krenk: density at t = 1
    # K_I and K_II are 2 pi sqrt(2 pi a) times the densities there; tractions of dislocations cancel those of the body.
    factors = -4 * np.pi * np.linalg.solve(matrix.T, tip.T).T
    order = np.argsort(r)
    places, weights = 0.25 * (1 + r[order]) ** 2, factors.reshape(2, 2, nodes)[..., order]
    for array in (places, weights):
        array.flags.writeable = False
    return EdgeCrack(places, weights)


def _traction(w: ComplexArray, at: ComplexArray, strength: complex, along: complex) -> ComplexArray:
    """``sigma_nn + i sigma_tn`` on the path by a dislocation below a free surface.

    The dislocation of strength ``A = G b / (i pi (kappa + 1))`` has ``Phi = A / (w - w0)`` and
    ``Psi = conj(A) / (w - w0) + A conj(w0) / (w - w0)^2``. Its image follows by continuation across z = 0:
    ``Phi1(w) = -conj((Phi + w Phi' + Psi)(conj(w)))``, ``Psi1 = -conj(Phi(conj(w))) - Phi1 - w Phi1'``.
    """
    a, b, apart = strength, np.conj(strength), np.conj(at) - at
    near, far = 1 / (w - at), 1 / (w - np.conj(at))
    phi1 = -a * far + b * apart * far**2
    slope1 = a * far**2 - 2 * b * apart * far**3
    phi, slope = a * near + phi1, -a * near**2 + slope1
    psi = b * near + a * np.conj(at) * near**2 - b * far - phi1 - w * slope1
    return np.asarray(2 * phi.real + along**2 * (np.conj(w) * slope + psi))
