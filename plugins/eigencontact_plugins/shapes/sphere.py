"""Sphere: potentials in closed form, in full space and of its mirror image."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import (
    FloatArray,
    InclusionShape,
    Length,
    Order,
    Place,
    PointKernels,
    PointSources,
    hook_for,
    real_points,
    require,
)
from eigencontact_plugins.shapes import sphere_moments

__all__ = ["SphericalInclusion"]

Point = tuple[float, float, float]

#: Distance from the boundary, in radii, below which a point lies on it.
SNAP = 1e-13
#: Depth of the top, in radii, below which the sphere touches the surface.
FLUSH = 1e-12

#: Factors of the derivatives of Phi and Psi inside, by orders in falling order; the others are 0. Those of odd order
#: are multiplied by the coordinate of odd order.
INSIDE: dict[str, dict[Order, float]] = {
    "phi": {(1, 0, 0): -4 * np.pi / 3, (2, 0, 0): -4 * np.pi / 3},
    "psi": {
        (3, 0, 0): -8 * np.pi / 5,
        (2, 1, 0): -8 * np.pi / 15,
        (4, 0, 0): -8 * np.pi / 5,
        (2, 2, 0): -8 * np.pi / 15,
    },
}


@dataclass(frozen=True, kw_only=True)
class SphericalInclusion(InclusionShape):
    """Sphere.

    Parameters
    ----------
    center : (float, float, float)
        Centre (x, y, z) [m].
    radius : float
        Radius a [m].

    Notes
    -----
    Outside, with the volume V and the distance R from the centre: Phi = V/R, Psi = V (R + a²/(5R)) and, as the
    mirror sphere never meets its own singular ray, Chi = V (Z ln(R + Z) - R), by the mean value property. Inside,
    Phi = 2π (a² - R²/3) and Psi = π (a⁴ + 2a²R²/3 - R⁴/15). On the boundary the values are means of both sides; at a
    point in the surface they are the limit along the surface, from outside. Exact to round-off everywhere.

    Examples
    --------
    >>> ball = SphericalInclusion(center=(0.0, 0.0, 2.0), radius=1.0)
    >>> below = (np.array([0.0]), np.array([0.0]), np.array([4.0]))
    >>> round(float(ball.phi([(0, 0, 1)], *below)[0, 0]), 10)  # -V / 4
    -1.0471975512
    """

    key: ClassVar[str] = "sphere"
    references: ClassVar[tuple[str, ...]] = (
        "J. D. Eshelby 1957, doi:10.1098/rspa.1957.0133",
        "R. D. Mindlin & D. H. Cheng 1950, J. Appl. Phys. 21, 926-930 and 931-933",
        "T. Mura 1987, Micromechanics of defects in solids, sec. 11",
    )

    center: Place
    radius: Length

    def __post_init__(self) -> None:
        require(
            len(self.center) == 3 and bool(np.isfinite(self.center).all()),
            self.key, "center", self.center, "three finite lengths (x, y, z) [m]",
        )  # fmt: skip
        require(0 < self.radius < np.inf, self.key, "radius", self.radius, "positive and finite [m]")

    @property
    def bounds(self) -> tuple[Point, Point]:
        """Corners of the cube around the sphere [m]."""
        (x, y, z), a = self.center, self.radius
        return (x - a, y - a, z - a), (x + a, y + a, z + a)

    def contains(self, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie in the sphere or on its boundary."""
        x, y, z = real_points(self.key, x, y, z)
        a = self.radius
        u, v, w = ((t - center) / a for t, center in zip((x, y, z), self.center, strict=True))
        return np.asarray(np.sqrt(u * u + v * v + w * w) <= 1.0 + SNAP)

    def phi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Phi, ``(len(orders), ...)`` [m^(2 - order)]."""
        return self._differentiate("phi", orders, (x, y, z))

    def psi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Psi of order 3 and more, ``(len(orders), ...)`` [m^(4 - order)]."""
        return self._differentiate("psi", orders, (x, y, z))

    def chi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Chi of order 2 and more at z >= 0, ``(len(orders), ...)`` [m^(4 - order)]."""
        (cx, cy, cz), a = self.center, self.radius
        kernels = PointKernels((x - cx) / a, (y - cy) / a, (z + cz) / a)
        out = np.empty((len(orders), *np.shape(x)))
        for row, order in enumerate(orders):
            out[row] = 4 * np.pi / 3 * a ** (4 - sum(order)) * kernels.derivative("chi", order)
        return out

    def far_field(self) -> PointSources:
        """One point source with a spread; identical to the closed form."""
        center = np.array(self.center, dtype=float)
        return PointSources(
            center=center,
            distance=self.radius * (1.0 + FLUSH),  # on the boundary the mean of both sides applies
            positions=center[None],
            volumes=np.array([4 * np.pi / 3 * self.radius**3]),
            spreads=np.array([self.radius**2 / 5]),
        )

    def densities(self, degree: int, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """See `HasMomentPotentials`: r^(2k) times solid harmonics, of mean square one over the boundary."""
        at = [np.ravel((t - center) / self.radius) for t, center in zip((x, y, z), self.center, strict=True)]
        values = sphere_moments.densities_of(degree, *at)
        return values.reshape(len(values), *np.shape(x))

    def density_rule(self, counts: tuple[int, int, int]) -> tuple[FloatArray, FloatArray]:
        """See `HasMomentPotentials`: exact for polynomials of degree min(2 counts - 3, 2 counts - 1, counts - 1)."""
        points, weights = sphere_moments.rule(counts)
        return self.center + self.radius * points, self.radius**3 * weights

    def phi_moments(
        self, degree: int, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray
    ) -> FloatArray:
        """See `HasMomentPotentials`."""
        n = (degree + 1) * (degree + 2) * (degree + 3) // 6
        unit_weights = np.eye(n * len(orders)).reshape(-1, n, len(orders))
        sums = self.moment_sums(degree, {"phi": (orders, unit_weights)}, x, y, z, image=False)
        return sums.reshape(n, len(orders), *np.shape(x))

    def moment_sums(
        self,
        degree: int,
        weights: Mapping[str, tuple[Sequence[Order], FloatArray]],
        x: FloatArray,
        y: FloatArray,
        z: FloatArray,
        *,
        image: bool,
    ) -> FloatArray:
        """See `HasMomentSums`; to round-off."""
        (cx, cy, cz), a, shape = self.center, self.radius, np.shape(x)
        u, v = np.ravel((x - cx) / a), np.ravel((y - cy) / a)
        count = next(len(of_orders) for _, of_orders in weights.values())
        if image:
            w = np.ravel((z + cz) / a)
            return sphere_moments.moment_sums(degree, "image", weights, a, (u, v, w)).reshape(count, *shape)
        w = np.ravel((z - cz) / a)
        share = self._inside(np.sqrt(u * u + v * v + w * w), np.ravel(z))
        out = np.zeros((count, u.size))
        for where, weight in (("outer", 1.0 - share), ("inner", share)):
            at = np.flatnonzero(weight)
            if at.size:
                sums = sphere_moments.moment_sums(degree, where, weights, a, (u[at], v[at], w[at]))
                out[:, at] += weight[at] * sums
        return out.reshape(count, *shape)

    def moment_integrals(
        self,
        degree: int,
        weights: Mapping[str, tuple[Sequence[Order], FloatArray]],
        x: FloatArray,
        y: FloatArray,
        z: FloatArray,
        tests: FloatArray,
        *,
        image: bool,
    ) -> FloatArray:
        """See `HasMomentIntegrals`."""
        (cx, cy, cz), a = self.center, self.radius
        u, v = (x - cx) / a, (y - cy) / a
        if image:
            return sphere_moments.moment_sums(degree, "image", weights, a, (u, v, (z + cz) / a), tests)
        w = (z - cz) / a
        share = self._inside(np.sqrt(u * u + v * v + w * w), z)
        total: FloatArray | float = 0.0
        for where, weight in (("outer", 1.0 - share), ("inner", share)):
            at = np.flatnonzero(weight)
            if at.size:
                parts = tests[:, at] * weight[at]
                total = total + sphere_moments.moment_sums(degree, where, weights, a, (u[at], v[at], w[at]), parts)
        return np.asarray(total)

    def _differentiate(
        self, potential: str, orders: Sequence[Order], points: tuple[FloatArray, FloatArray, FloatArray]
    ) -> FloatArray:
        """Mean of the closed forms of both sides, in units of the radius, weighted by the inner fraction."""
        a, shape = self.radius, np.shape(points[0])
        x, y, z = (np.ravel((t - center) / a) for t, center in zip(points, self.center, strict=True))
        inside = self._inside(np.sqrt(x * x + y * y + z * z), np.ravel(points[2]))
        outer, inner = np.flatnonzero(inside < 1), np.flatnonzero(inside > 0)
        kernels = PointKernels(x[outer], y[outer], z[outer])
        volume, power = 4 * np.pi / 3, 2 if potential == "phi" else 4
        out = np.zeros((len(orders), x.size))
        for row, order in enumerate(orders):
            values = kernels.derivative(potential, order)
            if potential == "psi":
                values = values + kernels.derivative("phi", order) / 5
            out[row, outer] = (1 - inside[outer]) * volume * values
            most, middle, least = sorted(order, reverse=True)
            factor = INSIDE[potential].get((most, middle, least), 0.0)
            if factor:
                odd = [t for t, n in zip((x, y, z), order, strict=True) if n % 2]
                out[row, inner] += factor * inside[inner] * (odd[0][inner] if odd else 1.0)
            out[row] *= a ** (power - sum(order))
        return out.reshape(len(orders), *shape)

    def _inside(self, distance: FloatArray, depth: FloatArray) -> FloatArray:
        """1 inside, 0 outside and at a point that touches the surface, 1/2 elsewhere on the boundary."""
        fraction: FloatArray = np.where(distance < 1.0, 1.0, 0.0)
        boundary = np.abs(distance - 1.0) <= SNAP
        fraction[boundary] = 0.5
        if abs(self.center[2] - self.radius) <= FLUSH * self.radius:
            fraction[boundary & (np.abs(depth) <= SNAP * self.radius)] = 0.0
        return fraction


eigencontact_register = hook_for(SphericalInclusion)
