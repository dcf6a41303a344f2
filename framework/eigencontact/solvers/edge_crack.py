"""Stress intensity factors of a straight edge crack of any inclination in a half-plane, by distributed dislocations.

The crack is a row of edge dislocations whose stress, with that of their images in the free surface, cancels the stress
of the body without the crack on its faces. The half-plane has no length of its own: the dislocations of a crack of unit
length are those of every length, so that an inclination has one small matrix for all lengths and all load steps.

References
----------
D. A. Hills, P. A. Kelly, D. N. Dai, A. M. Korsunsky 1996, Solution of Crack Problems: The Distributed Dislocation
Technique, Kluwer (sections 2.6 and 4); F. Erdogan, G. D. Gupta 1972, Q. Appl. Math. 29, 525 (Gauss-Chebyshev rules);
N. I. Muskhelishvili 1953, Some Basic Problems of the Mathematical Theory of Elasticity (images by continuation).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.errors import require

__all__ = ["EdgeCrack"]

#: Dislocations along a crack. The error of K falls with their square: 1e-5 at 0, 7e-4 at 60 degrees (uniform stress).
_NODES = 200
#: Largest inclination: a crack nearly along the surface is a thin flake, which takes far more dislocations.
_STEEPEST = np.radians(65.0)


class EdgeCrack:
    """Straight crack from the free surface of an isotropic half-plane (plane strain or plane stress alike).

    Parameters
    ----------
    inclination : float
        Angle [rad] between the crack and the inward normal z, positive towards +x; at most 65 degrees either way.
    nodes : int
        Dislocations along the crack.

    Attributes
    ----------
    positions : (nodes,)
        Points along the crack, in parts of its length, at which the stress of the body without the crack is wanted.
    tangent, normal : (2,)
        Unit vectors (x, z): along the crack into the body, and across it, towards +x for a crack along z.

    Notes
    -----
    Both faces are free: where the crack is closed, K_I is negative, and K_II is that of faces without friction.

    Examples
    --------
    A crack across a uniform tension, K = 1.1215 sigma sqrt(pi a):

    >>> crack = EdgeCrack(0.0)
    >>> k = crack.intensity(np.ones((1, crack.positions.size)), np.zeros((1, crack.positions.size)), np.array([1.0]))
    >>> (k[0, 0] / np.sqrt(np.pi)).round(4).item()
    1.1215
    """

    def __init__(self, inclination: float, *, nodes: int = _NODES) -> None:
        require(
            abs(inclination) <= _STEEPEST,
            "crack",
            "inclination",
            inclination,
            "within -65 and 65 degrees [rad] from the normal",
        )
        self.inclination, self._nodes = float(inclination), nodes
        sine, cosine = np.sin(inclination), np.cos(inclination)
        self.tangent, self.normal = np.array([sine, cosine]), np.array([cosine, -sine])
        count = 2 * nodes + 1
        #: Dislocations and points of collocation on (-1, 1), from the mouth (-1) to the tip (1).
        self._sources = np.cos((2 * np.arange(1, nodes + 1) - 1) * np.pi / count)
        self._targets = np.cos(2 * np.arange(1, nodes + 1) * np.pi / count)
        self.positions = 0.5 * (1.0 + self._targets)

    @cached_property
    def weights(self) -> FloatArray:
        """Weights ``(2, 2 nodes)``: (K_I, K_II) / sqrt(pi a) from normal, then shear stress at the positions."""
        nodes = self._nodes
        sources, targets = 0.5 * (1.0 + self._sources), self.positions
        rule = np.pi * (1.0 + self._sources) / (2 * nodes + 1)
        opening, sliding = (
            _traction(self.inclination, targets[:, None], sources[None, :], burgers) * rule for burgers in (1j, 1.0)
        )
        matrix = np.block([[opening.real, sliding.real], [opening.imag, sliding.imag]])
        odd = (2 * np.arange(1, nodes + 1) - 1) * np.pi / (2 * nodes + 1)
        at_tip = 2.0 / (2 * nodes + 1) * np.sin(nodes * odd) / np.tan(0.5 * odd)
        tips = np.kron(np.eye(2), np.pi * np.sqrt(2.0) * at_tip)
        return -np.asarray(np.linalg.solve(matrix.T, tips.T).T)

    def intensity(self, normal_stress: FloatArray, shear_stress: FloatArray, lengths: FloatArray) -> FloatArray:
        """Stress intensity factors K_I and K_II.

        Parameters
        ----------
        normal_stress, shear_stress : (..., nodes)
            Stress of the body without the crack [Pa], n.sigma.n and t.sigma.n, at `positions` times the length.
        lengths : (...)
            Length of the crack [m], broadcast over the leading axes.

        Returns
        -------
        (2, ...)
            K_I (opening, negative where the stress closes the crack) and K_II [Pa sqrt(m)].
        """
        both = np.concatenate([normal_stress, shear_stress], axis=-1)
        return np.asarray(np.moveaxis(both @ self.weights.T, -1, 0) * np.sqrt(np.pi * lengths))


def _traction(inclination: float, target: FloatArray, source: FloatArray, burgers: complex) -> NDArray[np.complex128]:
    """Normal + i shear stress on the line of the crack by a dislocation on it, with its image in the free surface.

    The body is the lower half of the complex plane, x + i y with y = -z. Burgers vectors (along + i across the crack)
    are in units in which the stress at the distance r ahead of a dislocation is 1/r.
    """
    along = np.exp(1j * (inclination - 0.5 * np.pi))
    z, z0 = target * along, source * along
    strength = burgers * along / 2j
    conjugate, mirrored = np.conj(strength), np.conj(z0)
    ahead, apart = z - z0, z - mirrored
    # Infinite plane: phi' = A / (z - z0), psi' = conj(A) / (z - z0) + A conj(z0) / (z - z0)^2.
    phi, slope = strength / ahead, -strength / ahead**2
    psi = conjugate / ahead + strength * mirrored / ahead**2
    # Image, holomorphic in the body, which frees the real axis of traction.
    phi_image = -(strength / apart + conjugate * (z0 - mirrored) / apart**2)
    slope_image = strength / apart**2 + 2.0 * conjugate * (z0 - mirrored) / apart**3
    psi_image = -(conjugate / apart + phi_image + z * slope_image)
    phi, slope, psi = phi + phi_image, slope + slope_image, psi + psi_image
    return np.asarray(2.0 * phi.real + along**2 * (np.conj(z) * slope + psi))
