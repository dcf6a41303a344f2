"""A rigid or elastic sphere on a half-space coated with bonded layers, without friction: one integral equation.

Conventions: z into the layered body; pressure positive in compression; the sphere is the paraboloid r²/(2R).

The surface answers a pressure wave J_0(kr) by the displacement ``2/(E k) (1 + L(k)) J_0(kr)``: E is the contact modulus
of the top layer (with the sphere), and L falls like exp(-2kh) with the thickness h of that layer. Sneddon's form of the
pressure, with φ(a) = 0 where the contact ends,

    P(k) = ∫_0^a p(r) J_0(kr) r dr = ∫_0^a φ(t) cos(kt) dt,   p(r) = -∫_r^a φ'(t)/√(t² - r²) dt,   load = 2π P(0),

turns contact for r < a into a Fredholm equation of the second kind on [0, a],

    φ(s) + (2/π) ∫_0^a φ(t) ∫_0^∞ L(k) cos(ks) cos(kt) dk dt = (E/π) (δ - s²/R).

L is sampled by dense solutions and interpolated by Chebyshev polynomials on intervals of k that double; the equation
is solved by Gauss's rule (Nyström). Everything converges exponentially. Without layers it is Hertz's solution.

References
----------
N. N. Lebedev, Ya. S. Ufliand 1958, PMM 22, 320 (the reduction, for one layer on a rigid base);
W. T. Chen, P. A. Engel 1972, Int. J. Solids Struct. 8, 1257 (layered half-spaces);
K. L. Johnson 1985, Contact Mechanics, section 4.2 (Hertz).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.oracles.layered_dense import traction_wave

__all__ = ["CoatedContact", "Interpolant", "coated_contact", "contact_of_radius", "layer_response"]

FloatArray = NDArray[np.float64]
#: Thickness [m], Young's modulus [Pa], Poisson's ratio [-].
Layer = tuple[float, float, float]

_DEGREE = 17
#: 2kh beyond which L is zero: 500 exp(-45) < 1e-16.
_LAST = 45.0


@dataclass(frozen=True)
class Interpolant:
    """A function of k, complex and of several components, on intervals that double; zero beyond the last.

    Attributes
    ----------
    edges : (n + 1,) array
        Ends of the intervals, from 0 [rad/m].
    coefficients : (n, degree + 1, ...) array
        Chebyshev coefficients.
    """

    edges: FloatArray
    coefficients: NDArray[np.complex128]

    @classmethod
    def of(cls, function: Callable[[float], ArrayLike], first: float, last: float) -> Interpolant:
        """Sample a function on [0, first], [first, 2 first], ... up to `last`; k = 0 itself is not called."""
        count = max(1, int(np.ceil(np.log2(last / first))))
        edges = np.concatenate([[0.0], np.geomspace(first, last, count + 1)])
        nodes = np.cos(np.pi * (np.arange(_DEGREE + 1) + 0.5) / (_DEGREE + 1))
        inverse = np.linalg.inv(np.polynomial.chebyshev.chebvander(nodes, _DEGREE))
        panels = []
        for low, high in pairwise(edges):
            values = np.array([function(0.5 * (low + high) + 0.5 * (high - low) * x) for x in nodes], dtype=complex)
            panels.append(np.tensordot(inverse, values, axes=1))
        return cls(edges, np.array(panels))

    def quadrature(self, reach: float) -> tuple[FloatArray, FloatArray, NDArray[np.complex128]]:
        """Nodes k ``(m,)``, weights ``(m,)`` and values ``(m, ...)`` for integrands that turn like exp(i k reach)."""
        unit, weight = np.polynomial.legendre.leggauss(16)
        nodes, weights, values = [], [], []
        for (low, high), series in zip(pairwise(self.edges), self.coefficients, strict=True):
            intervals = int(np.ceil((high - low) * reach / 8.0)) + 1
            half = 0.5 * (high - low) / intervals
            middles = low + half * (2.0 * np.arange(intervals) + 1.0)
            k = (middles[:, None] + half * unit).ravel()
            x = (2.0 * k - low - high) / (high - low)
            nodes.append(k)
            weights.append(np.tile(half * weight, intervals))
            values.append(np.tensordot(np.polynomial.chebyshev.chebvander(x, _DEGREE), series, axes=1))
        return np.concatenate(nodes), np.concatenate(weights), np.concatenate(values)


@dataclass(frozen=True, kw_only=True)
class CoatedContact:
    """Contact of a sphere and a layered half-space.

    Attributes
    ----------
    layers, substrate : as in `coated_contact`
    sphere_radius : float
        R [m].
    radius : float
        Contact radius a [m].
    approach : float
        Approach of the sphere and a distant point of the half-space [m].
    modulus : float
        Contact modulus E of the top layer and the sphere [Pa].
    nodes, waves : (n,) arrays
        Wavenumbers k [rad/m], and ``2/π L(k) P(k)`` times their weights [N/m]: what the layers add to φ and p.
    """

    layers: tuple[Layer, ...]
    substrate: tuple[float, float]
    sphere_radius: float
    radius: float
    approach: float
    modulus: float
    nodes: FloatArray
    waves: FloatArray

    def phi(self, t: ArrayLike) -> FloatArray:
        """φ(t) [N/m] for 0 <= t <= a; zero at a."""
        t = np.asarray(t, dtype=float)
        uncoated = self.modulus / np.pi * (self.approach - t * t / self.sphere_radius)
        return np.asarray(uncoated - np.cos(np.multiply.outer(t, self.nodes)) @ self.waves)

    def pressure(self, r: ArrayLike) -> FloatArray:
        """Pressure [Pa] at the distance r from the axis; zero outside the contact."""
        # with t² = r² + (a² - r²) v², p = √(a² - r²) ∫_0^1 -φ'(t)/t dv, and φ'/t is smooth
        r = np.asarray(r, dtype=float)
        unit, weight = np.polynomial.legendre.leggauss(24 + int(0.2 * self._turns))
        v = 0.5 * (unit + 1.0)
        inside = np.maximum(self.radius**2 - r * r, 0.0)
        t = np.sqrt((r * r)[..., None] + inside[..., None] * v * v)
        slope = 2.0 * self.modulus / (np.pi * self.sphere_radius) - np.sinc(
            np.multiply.outer(t, self.nodes) / np.pi
        ) @ (self.nodes**2 * self.waves)
        return np.asarray(np.sqrt(inside) * (slope @ (0.5 * weight)))

    @cached_property
    def load(self) -> float:
        """Normal load [N]."""
        return float(2.0 * np.pi * self.hankel(0.0))

    @cached_property
    def max_pressure(self) -> float:
        """Largest pressure [Pa]: on the axis, or near the rim of a stiff coating far thinner than the contact."""
        from scipy.optimize import minimize_scalar

        angles = np.linspace(0.0, 0.5 * np.pi, 33)
        place = int(self.pressure(self.radius * np.sin(angles)).argmax())
        if place == 0:
            return float(self.pressure(0.0))
        bounds = angles[place - 1], angles[min(place + 1, 32)]
        minimum = minimize_scalar(lambda t: -float(self.pressure(self.radius * np.sin(t))), bounds=bounds)
        return -float(minimum.fun)

    @property
    def _turns(self) -> float:
        return float(self.nodes[-1] * self.radius) if self.nodes.size else 0.0

    def hankel(self, k: ArrayLike) -> FloatArray:
        """P(k) = ∫ p(r) J_0(kr) r dr [N] at any k [rad/m]."""
        k = np.asarray(k, dtype=float)
        turns = max(self._turns, float(k.max(initial=0.0)) * self.radius)
        unit, weight = np.polynomial.legendre.leggauss(32 + int(turns / 3.0))
        t, w = 0.5 * self.radius * (unit + 1.0), 0.5 * self.radius * weight
        return np.asarray(np.cos(np.multiply.outer(k, t)) @ (w * self.phi(t)))


def contact_of_radius(
    radius: float,
    sphere_radius: float,
    layers: Sequence[Layer],
    substrate: tuple[float, float],
    *,
    sphere_compliance: float = 0.0,
    excess: Interpolant | None = None,
) -> CoatedContact:
    """Solve for a given contact radius a [m]; other parameters as in `coated_contact`.

    Parameters
    ----------
    excess : Interpolant, optional
        L(k) of the same layers, where it is known.
    """
    modulus = _contact_modulus(layers, substrate, sphere_compliance)
    if excess is None:
        excess = layer_response(layers, substrate, modulus, sphere_compliance)
    empty = np.zeros(0)
    k, w, values = excess.quadrature(2.0 * radius) if excess is not None else (empty, empty, empty)
    unit, weight = np.polynomial.legendre.leggauss(24 + int(4.0 * radius / layers[0][0]) if layers else 24)
    t, wt = 0.5 * radius * (unit + 1.0), 0.5 * radius * weight
    waves = np.cos(np.multiply.outer(k, t))  # (k, t)
    amplitude = 2.0 / np.pi * w * values.real
    matrix = np.eye(t.size) + (waves.T * amplitude) @ waves * wt
    right = np.column_stack([np.ones_like(t), t * t / sphere_radius]) * modulus / np.pi
    phi = np.linalg.solve(matrix, right)
    spectra = waves @ (wt[:, None] * phi)  # P(k) of δ = 1 and of the paraboloid
    # φ(a) = 0 gives the approach
    rim = np.cos(k * radius) * amplitude
    at_one = modulus / np.pi - rim @ spectra[:, 0]
    at_sphere = modulus / np.pi * radius**2 / sphere_radius - rim @ spectra[:, 1]
    approach = float(at_sphere / at_one)
    return CoatedContact(
        layers=tuple(layers),
        substrate=substrate,
        sphere_radius=sphere_radius,
        radius=radius,
        approach=approach,
        modulus=modulus,
        nodes=np.asarray(k),
        waves=amplitude * (approach * spectra[:, 0] - spectra[:, 1]),
    )


def coated_contact(
    load: float,
    sphere_radius: float,
    layers: Sequence[Layer],
    substrate: tuple[float, float],
    *,
    sphere_compliance: float = 0.0,
) -> CoatedContact:
    """Solve for the load.

    Parameters
    ----------
    load : float
        Normal load [N], positive.
    sphere_radius : float
        R [m].
    layers : sequence of (thickness [m], Young's modulus [Pa], Poisson's ratio [-])
        From the surface down; may be empty.
    substrate : (Young's modulus [Pa], Poisson's ratio [-])
    sphere_compliance : float
        (1 - ν²)/E of the sphere [1/Pa]; 0 for a rigid one.

    Notes
    -----
    Valid for a contact small beside R, without adhesion, that is a whole disk: so it was in every case tried, coatings
    up to 1e5 times as stiff included (look for negative `pressure`). a/h from 0 to some 100, as work and memory grow
    with (a/h)²; moduli within 1:1e4 cost no more than 1e-11 of accuracy.
    """
    from scipy.optimize import brentq

    modulus = _contact_modulus(layers, substrate, sphere_compliance)
    excess = layer_response(layers, substrate, modulus, sphere_compliance)

    def solved(logarithm: float) -> CoatedContact:
        return contact_of_radius(
            float(np.exp(logarithm)),
            sphere_radius,
            layers,
            substrate,
            sphere_compliance=sphere_compliance,
            excess=excess,
        )

    def miss(logarithm: float) -> float:
        return float(np.log(solved(logarithm).load / load))

    low = high = np.log(0.75 * load * sphere_radius / modulus) / 3.0
    while miss(low) > 0.0:
        low -= 0.3
    while miss(high) < 0.0:
        high += 0.3
    root = low if low == high else float(brentq(miss, low, high, xtol=1e-14, rtol=1e-14))
    return solved(root)


def _contact_modulus(layers: Sequence[Layer], substrate: tuple[float, float], sphere_compliance: float) -> float:
    young, nu = layers[0][1:] if layers else substrate
    return float(1.0 / ((1.0 - nu * nu) / young + sphere_compliance))


def layer_response(
    layers: Sequence[Layer], substrate: tuple[float, float], modulus: float, sphere_compliance: float
) -> Interpolant | None:
    """L(k), from dense solutions; None without layers.

    Parameters
    ----------
    layers, substrate, sphere_compliance : as in `coated_contact`
    modulus : float
        Contact modulus E of the top layer and the sphere [Pa].
    """
    if not layers:
        return None
    shear = [(h, E / (2.0 * (1.0 + nu)), nu) for h, E, nu in layers]
    base = (substrate[0] / (2.0 * (1.0 + substrate[1])), substrate[1])

    def excess(k: float) -> complex:
        displacement, _ = traction_wave(shear, base, (1.0, 0.0, 0.0), k, 0.0, 0.0)
        return complex(0.5 * modulus * (k * displacement[2] + 2.0 * sphere_compliance) - 1.0)

    moduli = [E for _, E, _ in layers] + [substrate[0]]
    first = 1e-3 * min(moduli) / max(moduli) / sum(h for h, _, _ in layers)
    return Interpolant.of(excess, first, 0.5 * _LAST / layers[0][0])
