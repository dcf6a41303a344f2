r"""A rigid sphere pressed on an elastic half-space with a ball of another material below the middle of the contact.

Frictionless and of revolution. The pressure is a superposition of point loads at imaginary depths (Green and Collins)::

    psi = -1/(2 pi) integral of G(s) / R(r, z + i s) ds,   phi,z = (1 - 2 nu) psi,    -a < s < a, G even, G(a) = 0

so that the surface is free of traction outside r = a and its displacement is given by Abel's equation within::

    G(s) = E* [(a² - s²)/R + K(a) - K(s)],   K(s) = s integral of u'(s sin t) dt, 0 < t < pi/2,
    load = integral of G,   p(0) = -1/pi integral of G'(s)/s ds over 0 < s < a

with u the normal displacement of the surface by the ball. For a multipole about (0, d), K is the multipole's surface
displacement at the imaginary radius, in closed form. The amounts of the multipoles are linear in G, and G in them: one
linear system for a given a; a follows from the load.

Units of the results: contact radius a0 and pressure p0 of Hertz without the ball.

References
----------
W. D. Collins 1959, Mathematika 6, 120; K. L. Johnson 1985, Contact Mechanics, section 4.2 (Hertz).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray
from scipy.optimize import brentq

from eigencontact_verification.oracles.axial_potentials import fields, singular
from eigencontact_verification.oracles.ball_multipoles import BallMultipoles

__all__ = ["BallUnderContact", "ball_under_contact"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class BallUnderContact:
    """Solution; lengths in contact radii a0, stress in pressures p0 of Hertz's contact without the ball.

    Attributes
    ----------
    radius : float
        Contact radius.
    nodes, weights : (n,)
        Gauss rule of s over the contact radius, from -1 to 1.
    density, slope : (n,)
        G and G'(s)/s there, in units of the ball's radius and p0.
    amounts : (unknowns,)
        Of the unknowns of `ball`, in the same units.
    ball : BallMultipoles
        Unknowns and their fields.
    size : float
        Radius of the ball.
    """

    radius: float
    nodes: FloatArray
    weights: FloatArray
    density: FloatArray
    slope: FloatArray
    amounts: FloatArray
    ball: BallMultipoles
    size: float

    @property
    def central_pressure(self) -> float:
        """p(0) / p0."""
        a = self.radius / self.size
        return float(-(self.weights * self.slope).sum() * a / (2 * np.pi))

    def pressure(self, r: FloatArray) -> FloatArray:
        """p(r) / p0 at radii (...) within the contact, by ``s² = r² + (a² - r²) x²``; G'(s)/s from the unknowns."""
        a, place = self.radius / self.size, np.asarray(r)[..., None] / self.size
        s = np.sqrt(place**2 + (a**2 - place**2) * self.nodes**2)
        _, by_ball = _surface(self.ball, s.ravel())
        curvature = np.pi * self.size / 2 * (1 - self.ball.nu)
        slope = (self.amounts @ by_ball).reshape(s.shape) - 2 * curvature
        front = np.sqrt(np.maximum(a**2 - place[..., 0] ** 2, 0.0))
        return np.asarray(-front * (slope @ self.weights) / (2 * np.pi * (1 - self.ball.nu)))

    def stress(self, r: FloatArray, z: FloatArray) -> FloatArray:
        """``(s_rr, s_tt, s_zz, s_rz) / p0``, (4, ...), in the body outside the ball.

        z is the depth; below it the rule of G must resolve: at depths under 8 a / nodes the values mean nothing.
        """
        place, depth = np.asarray(r) / self.size, np.asarray(z) / self.size
        a = self.radius / self.size
        load = _disc_fields(self.nodes * a, place, depth, self.ball.nu) @ (self.weights * a * self.density)
        ball = np.einsum("cu...,u->c...", self.ball.unit_fields(place, depth - self.ball.depth), self.amounts)
        return np.asarray((load + ball)[2:])


def _disc_fields(s: FloatArray, r: FloatArray, z: FloatArray, nu: float) -> FloatArray:
    """Six of `axial_potentials.fields` per unit of G, (6, ..., n)."""
    far = singular(1, r[..., None] + 0j, z[..., None] + 1j * s, logarithm=True).real / (2 * np.pi)
    return fields((1 - 2 * nu) * far[:, 0], -far[:, 1], r[..., None], z[..., None], nu)


def _surface(ball: BallMultipoles, s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """K of every unknown, and -K'(s)/s for s off 0, both (unknowns, n)."""
    phi, psi = ball.sources
    nu, d = ball.nu, ball.depth - 1j * s
    value, slope = np.zeros((2, len(phi), s.size))
    for l in range(phi.shape[1]):
        for column, power, factor in (
            (phi[:, l], l + 2, 4 * (1 - nu) * factorial(l + 1)),
            (psi[:, l], l + 1, -8 * (1 - nu) ** 2 * factorial(l)),
        ):
            scale = (-1) ** l * factor * column[:, None]
            value += scale * (d ** (-power)).real
            slope -= scale * (1j * power * d ** (-power - 1)).real / s
    return value, slope


def ball_under_contact(
    *,
    radius: float,
    depth: float,
    nu: float,
    ratio: float,
    inner_nu: float | None = None,
    degree: int = 16,
    contact_nodes: int = 240,
    nodes: int = 80,
) -> BallUnderContact:
    """Contact over a ball at a fixed load.

    Parameters
    ----------
    radius, depth : float
        Of the ball and of its centre, in Hertz's contact radii a0 without the ball; depth above radius.
    nu, inner_nu : float
        Poisson's ratios of the body and of the ball (by default the same).
    ratio : float
        Young's modulus of the ball over that of the body; 0: void, infinity: rigid; not the body's own material.
    degree : int
        Degree of the strain in the ball; 16 is exact to five digits for depth above 1.18 radii.
    contact_nodes, nodes : int
        Gauss points of G, and from pole to pole of the ball.

    Examples
    --------
    >>> void = ball_under_contact(radius=0.17, depth=0.5, nu=0.3, ratio=0.0)
    >>> round(void.central_pressure, 5), round(void.radius, 5)
    (0.84307, 1.00356)
    """
    inner = nu if inner_nu is None else inner_nu
    shear = ratio * (1 + nu) / (1 + inner)
    ball = BallMultipoles(
        nu=nu, ratio=shear, inner_nu=inner, degree=degree, boundary="free", depth=depth / radius, nodes=nodes
    )
    # curvature chosen so that p0 = 1 at the contact radius a0 without the ball
    modulus, a0 = 1.0 / (1.0 - nu), 1.0 / radius
    curvature = np.pi / (2 * a0 * modulus)
    force = 2 / 3 * np.pi * a0**2
    x, w = leggauss(contact_nodes)

    def solved(a: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """G, G'(s)/s and amounts for a contact radius."""
        s = a * x
        value, slope = _surface(ball, s)
        edge, _ = _surface(ball, np.array([a]))
        by_ball, by_sphere = modulus * (edge - value), modulus * curvature * (a**2 - s**2)

        def load(r: FloatArray, z: FloatArray) -> FloatArray:
            columns = np.stack([by_sphere, *by_ball], axis=1) * (w * a)[:, None]
            return np.moveaxis(_disc_fields(s, r, z + ball.depth, nu) @ columns, -1, 1)

        conditions = ball.conditions_of(load)
        amounts = np.asarray(np.linalg.solve(ball.matrix + conditions[:, 1:], -conditions[:, 0]))
        density = by_sphere + amounts @ by_ball
        return density, modulus * (amounts @ slope - 2 * curvature), amounts

    def excess(a: float) -> float:
        return float(a * (w * solved(a)[0]).sum() / force - 1)

    a = float(brentq(excess, 0.8 * a0, 1.25 * a0, xtol=1e-12 * a0))
    density, slope, amounts = solved(a)
    return BallUnderContact(
        radius=a * radius, nodes=x, weights=w, density=density, slope=slope, amounts=amounts, ball=ball, size=radius
    )
