"""Base of geometries of revolution: separation from the profile, and the contact in closed form from its integral.

A profile h(r) enters through g(t) = t ∫_0^t h'(r) / √(t² - r²) dr, the approach at which the contact radius is t.
With its derivative g'(t), the *rate* below,

    P    = 2 E* ∫_0^a t g'(t) dt
    p(r) = (E* / π) ∫_r^a g'(t) / √(t² - r²) dt

Both integrals are split at the junction, the radius where g'' is singular (0 if there is none), and become smooth by
t² = start² + (stop² - start²) s² with s in 0..1.

References
----------
I. N. Sneddon 1965, doi:10.1016/0020-7225(65)90019-4; K. L. Johnson 1985, Contact Mechanics, section 5.2.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence

import numpy as np

from eigencontact.core.arrays import FloatArray, real_points
from eigencontact.plugin.geometry import Geometry

__all__ = ["Revolution", "RevolutionSum", "contact_radius", "revolution_pressure"]

Rate = Callable[[FloatArray], FloatArray]

_X, _W = np.polynomial.legendre.leggauss(64)
NODES, WEIGHTS = 0.5 * (_X + 1.0), 0.5 * _W


class Revolution(Geometry):
    """Convex body of revolution about a vertical axis, defined by its profile and the derivative of its approach.

    The class computes the separation from the profile, and the pressure in closed form for comparisons
    (`HasReferencePressure`) from the derivative of the approach.

    Attributes
    ----------
    center : (float, float)
        Position (x, y) of the axis [m]; a field of the subclass.
    junction : float
        Radius [m] at which the profile changes its form; 0 if it never does.
    limit : float
        Radius [m] at which the profile ends in a vertical flank.

    Examples
    --------
    >>> class Ball(Revolution):
    ...     key, center = "ball", (0.0, 0.0)
    ...     def height(self, r):
    ...         return r**2 / 2e-3
    ...     def rate(self, t):
    ...         return 2 * t / 1e-3
    >>> pressure = Ball().reference_pressure(np.zeros(1), np.zeros(1), 1.0, 1e11)  # Hertz: (6 P E*² / (π³ R²))^(1/3)
    >>> f"{pressure[0] / 1e9:.3f} GPa"
    '1.246 GPa'
    """

    center: tuple[float, float]

    @abstractmethod
    def height(self, r: FloatArray) -> FloatArray:
        """Profile: separation h(r) [m] at the distance r [m] from the axis; 0 on the axis."""

    @abstractmethod
    def rate(self, t: FloatArray) -> FloatArray:
        """Growth g'(t) [-] of the approach with the contact radius t [m].

        The approach is g(t) = t ∫_0^t h'(r) / √(t² - r²) dr of the profile h: of a parabola r²/(2R) it is t²/R, and
        its growth 2t/R. Positive beyond the junction.
        """

    @property
    def junction(self) -> float:
        """See the attributes."""
        return 0.0

    @property
    def limit(self) -> float:
        """See the attributes."""
        return float(np.inf)

    def _radius(self, x: FloatArray, y: FloatArray) -> FloatArray:
        x, y = real_points("separation", x, y)
        return np.asarray(np.hypot(x - self.center[0], y - self.center[1]))

    def separation(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Separation h(x, y) [m]; 0 on the axis."""
        return self.height(self._radius(x, y))

    def reference_pressure(
        self, x: FloatArray, y: FloatArray, normal_load: float, contact_modulus: float
    ) -> FloatArray:
        """Closed-form pressure [Pa] under `normal_load` [N]; NaN if the profile is too small for the load."""
        r = self._radius(x, y)
        if normal_load <= 0:
            return np.zeros(r.shape)
        a = contact_radius(self.rate, normal_load, contact_modulus, junction=self.junction, limit=self.limit)
        return revolution_pressure(r, self.rate, a, contact_modulus, junction=self.junction)


class RevolutionSum(Revolution):
    """Two or more bodies of revolution about one axis: their profiles add up, and so do the growths of the approach.

    Parameters
    ----------
    bodies : sequence of Revolution
        At most one of them has a junction.
    """

    key = "sum"

    def __init__(self, bodies: Sequence[Revolution]) -> None:
        self._bodies = tuple(bodies)
        self.center = bodies[0].center

    @staticmethod
    def of(geometries: Sequence[Geometry]) -> RevolutionSum | None:
        """Sum of geometries; None unless all are of revolution about one axis with at most one junction."""
        bodies = [geometry for geometry in geometries if isinstance(geometry, Revolution)]
        coaxial = len(bodies) == len(geometries) and len({tuple(body.center) for body in bodies}) == 1
        return RevolutionSum(bodies) if coaxial and len({body.junction for body in bodies} - {0.0}) < 2 else None

    def height(self, r: FloatArray) -> FloatArray:
        """Separation h(r) [m]; 0 on the axis."""
        return np.asarray(sum(body.height(r) for body in self._bodies))

    def rate(self, t: FloatArray) -> FloatArray:
        """Growth of the approach; see `Revolution`."""
        return np.asarray(sum(body.rate(t) for body in self._bodies))

    @property
    def junction(self) -> float:
        """See `Revolution`."""
        return max(body.junction for body in self._bodies)

    @property
    def limit(self) -> float:
        """See `Revolution`."""
        return min(body.limit for body in self._bodies)


def contact_radius(
    rate: Rate, normal_load: float, contact_modulus: float, *, junction: float = 0.0, limit: float = np.inf
) -> float:
    """Contact radius a [m] under a load [N]; NaN if the profile is too small for the load.

    Parameters
    ----------
    rate : callable
        g'(t) [-] of radii (n,) [m]; positive beyond the junction.
    normal_load, contact_modulus : float
        P > 0 [N] and E* [Pa].
    junction : float
        Radius [m] at which the profile changes its form.
    limit : float
        Radius [m] at which the profile ends (vertical flank); a stays below it.
    """
    from scipy.optimize import brentq

    goal = normal_load / (2.0 * contact_modulus)

    def excess(a: float) -> float:
        total, start = -goal, 0.0
        for stop in (min(junction, a), a):
            span = (stop - start) * (stop + start)
            total += span * float(np.sum(WEIGHTS * NODES * rate(np.sqrt(start**2 + span * NODES**2))))
            start = stop
        return total

    low, high = 0.0, min(max(junction, np.sqrt(goal)), 0.5 * limit)
    while excess(high) < 0:
        low, high = high, min(2.0 * high, 0.5 * (high + limit))
        if limit - high < 1e-9 * limit:
            return float("nan")
    return float(brentq(excess, low, high, xtol=1e-14 * high, rtol=1e-14))


def revolution_pressure(
    r: FloatArray, rate: Rate, contact_radius: float, contact_modulus: float, *, junction: float = 0.0
) -> FloatArray:
    """Pressure p(r) [Pa] for a contact radius [m], zero outside it, NaN if it is NaN; shape of `r`."""
    if np.isnan(contact_radius):
        return np.full(r.shape, np.nan)
    inside = r < contact_radius
    radius = r[inside]
    split = np.clip(junction, radius, contact_radius)
    total = np.zeros_like(radius)
    for start, stop in ((radius, split), (split, np.full_like(radius, contact_radius))):
        offset, span = (start - radius) * (start + radius), (stop - start) * (stop + start)
        for node, weight in zip(NODES, WEIGHTS, strict=True):
            t = np.sqrt(start**2 + span * node**2)
            distance = np.sqrt(offset + span * node**2)
            step = weight * node * np.divide(span, t * distance, out=np.zeros_like(t), where=span > 0)
            total += step * rate(t)
    pressure = np.zeros(r.shape)
    pressure[inside] = contact_modulus / np.pi * total
    return pressure
