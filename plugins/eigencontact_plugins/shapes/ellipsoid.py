"""Ellipsoid of any proportions and orientation: potentials exact to round-off, inside and outside."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import (
    FloatArray,
    InclusionShape,
    Length,
    Order,
    Place,
    PointSources,
    Rotation,
    as_tuple,
    hook_for,
    integrated_chi,
    real_points,
    require,
    rotation_matrix,
    turned_derivatives,
)
from eigencontact_plugins.shapes.ellipsoid_mirror import chi_degrees, focal_chi, focal_sources
from eigencontact_plugins.shapes.ellipsoid_mirror_moments import focal_chi_sums, integrated_sums
from eigencontact_plugins.shapes.ellipsoid_moments import density_scales, density_values, weighted_sums
from eigencontact_plugins.shapes.ellipsoid_potentials import potential_derivatives
from eigencontact_plugins.shapes.sphere_moments import rule as ball_rule

__all__ = ["Ellipsoid"]

Point = tuple[float, float, float]
Points = tuple[FloatArray, FloatArray, FloatArray]

#: Largest difference of Σ (x_i/a_i)² from 1 for points on the boundary.
SNAP = 4e-15
CHUNK = 1024


@dataclass(frozen=True, kw_only=True)
class Ellipsoid(InclusionShape):
    """Ellipsoid.

    Parameters
    ----------
    center : (float, float, float)
        Middle (x, y, z) [m].
    semi_axes : (float, float, float)
        Semi-axes along the axes of the ellipsoid [m], in any order of size.
    rotation : (3, 3) or (3,), optional
        Directions of the semi-axes: a rotation matrix whose *columns* are their unit vectors in scene axes; or three
        angles [rad] yaw, pitch, roll that rotate the axes from x, y, z by ``Rz(yaw) Ry(pitch) Rx(roll)`` (about z, then
        the rotated y, then the twice rotated x; positive from x to y, z to x, y to z). By default along x, y, z.

    Notes
    -----
    Exact to round-off inside and outside for all proportions: spheres, spheroids, nearly equal axes, needles and discs
    (tested to 1 : 1000). On the boundary every derivative is the mean of both sides. If the ellipsoid touches z = 0, it
    is there the limit along the surface, from outside, as for a sphere. Chi has no closed form: it is a cubature over
    the focal ellipse or, next to the image of a disc, where a cubature would need too many nodes, the framework's
    integral of Phi of the image (to 2e-11).

    Potentials of polynomial densities, relative to the largest derivative of the same order at the point: at degree 6,
    Phi (orders 0 to 5) to 2e-11 and Psi (3 to 5) to 1e-10, worst for a sphere; at degree 4, 2e-12 and 1e-11; on the
    boundary as well as far from it. Chi (3 and 4) at degree 6 agrees with the integral of Phi to 2e-11, and to 4e-10
    within a third of the length of discs and needles of 1 : 20 from their image.
    """

    key: ClassVar[str] = "ellipsoid"
    method: ClassVar[str] = "elliptic integrals, and cubature of the mirror image"
    references: ClassVar[tuple[str, ...]] = (
        "J. D. Eshelby 1957, doi:10.1098/rspa.1957.0133",
        "J. D. Eshelby 1959, doi:10.1098/rspa.1959.0173",
        "T. Mura 1987, Micromechanics of Defects in Solids, section 11, doi:10.1007/978-94-009-3489-4",
    )

    center: Place
    semi_axes: tuple[Length, Length, Length]
    rotation: Rotation | None = None

    def __post_init__(self) -> None:
        for name in ("center", "semi_axes", "rotation"):
            object.__setattr__(self, name, as_tuple(getattr(self, name)))
        require(
            np.shape(self.center) == (3,) and bool(np.isfinite(self.center).all()),
            self.key, "center", self.center, "three finite lengths (x, y, z) [m]",
        )  # fmt: skip
        require(
            np.shape(self.semi_axes) == (3,) and all(0 < axis < np.inf for axis in self.semi_axes),
            self.key, "semi_axes", self.semi_axes, "three positive, finite lengths [m]",
        )  # fmt: skip
        _ = self.axes

    @cached_property
    def axes(self) -> FloatArray:
        """Rotation matrix; its columns are the directions of the semi-axes."""
        return rotation_matrix(self.key, self.rotation)

    @property
    def volume(self) -> float:
        """Volume 4π/3 a b c [m³]."""
        return 4.0 * np.pi / 3.0 * float(np.prod(self.semi_axes))

    @property
    def bounds(self) -> tuple[Point, Point]:
        """Corners of lowest and of highest coordinates [m]."""
        x, y, z = self.center
        a, b, c = (float(v) for v in np.hypot.reduce(self.axes * np.array(self.semi_axes), axis=1))
        return (x - a, y - b, z - c), (x + a, y + b, z + c)

    def contains(self, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie in the ellipsoid or on its boundary."""
        x, y, z = real_points(self.key, x, y, z)
        return np.asarray(self._level(self._in_axes(x, y, z)) <= SNAP)

    def phi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Phi of any order, ``(len(orders), ...)`` [m^(2 - order)]."""
        return self._differentiate("phi", orders, x, y, z)

    def psi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Psi of order 1 and higher, ``(len(orders), ...)`` [m^(4 - order)]."""
        for order in orders:
            require(sum(order) >= 1, self.key, "psi", order, "asked for derivatives of order 1 or higher")
        return self._differentiate("psi", orders, x, y, z)

    def chi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Chi of order 3 and 4 at z >= 0, ``(len(orders), ...)`` [m^(4 - order)]."""
        unit, semi_axes = self._scaled()
        scales = np.array([unit ** (4 - sum(order)) for order in orders])[:, None]
        at = [np.ravel(np.asarray(t, dtype=float)) for t in (x, y, z)]
        values = np.empty((len(orders), at[0].size))
        for place, degrees, points in self._cubatures(at):
            if degrees is None:
                values[:, place] = integrated_chi(self, orders, *(t[place] for t in at))
            else:
                values[:, place] = scales * focal_chi(semi_axes, self.axes, orders, points, degrees)
        return values.reshape(len(orders), *np.shape(x))

    def far_field(self) -> PointSources:
        """Cubatures over the focal ellipse, exact to 1e-12: some tens of points far away, hundreds near the tips."""
        center = np.array(self.center, dtype=float)
        far: PointSources | None = None
        for distance, positions, weights, spreads in focal_sources(np.array(self.semi_axes), self.axes):
            far = PointSources(
                center=center,
                distance=distance,
                positions=center + positions,
                volumes=self.volume * weights,
                spreads=spreads,
                coarser=far,
            )
        assert far is not None
        return far

    def densities(self, degree: int, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """See `HasMomentPotentials`: polynomials along the semi-axes, of mean square one over the ellipsoid.

        The densities of a degree are orthogonal to all of lower degree.
        """
        points = [np.ravel(t) / a for t, a in zip(self._in_axes(x, y, z), self.semi_axes, strict=True)]
        values = density_values(degree, points)
        return values.reshape(len(values), *np.shape(x))

    def density_rule(self, counts: tuple[int, int, int]) -> tuple[FloatArray, FloatArray]:
        """See `HasMomentPotentials`: the rule of a ball, stretched; its poles are on the third semi-axis."""
        points, weights = ball_rule(counts)
        places = np.array(self.center) + (points * np.array(self.semi_axes)) @ self.axes.T
        return places, weights * float(np.prod(self.semi_axes))

    def phi_moments(
        self, degree: int, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray
    ) -> FloatArray:
        """See `HasMomentPotentials`; to round-off, of any order."""
        unit, semi_axes = self._scaled()
        local_orders, transform = self._along_axes(orders)
        count = len(density_scales(degree))

        columns = (("phi", tuple(local_orders)),)
        sums = np.zeros((count * len(local_orders), np.size(x)))
        for place, share, points, outside in self._sides(x, y, z):
            sums[:, place] += share * weighted_sums(semi_axes, degree, columns, None, points, outside=outside)
        values = sums.reshape(count, len(local_orders), -1)
        if transform is not None:
            values = transform @ values
        values *= np.array([unit ** (2 - sum(order)) for order in orders])[:, None]
        return values.reshape(count, len(orders), *np.shape(x))

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
        """See `HasMomentSums`; Phi and Psi to round-off, Chi as `chi`."""
        sums = self._sums(degree, weights, [np.ravel(np.asarray(t, dtype=float)) for t in (x, y, z)], None, image=image)
        return sums.reshape(len(sums), *np.shape(x))

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
        return self._sums(degree, weights, [np.asarray(t, dtype=float) for t in (x, y, z)], tests, image=image)

    def _sums(
        self,
        degree: int,
        weights: Mapping[str, tuple[Sequence[Order], FloatArray]],
        at: Sequence[FloatArray],
        tests: FloatArray | None,
        *,
        image: bool,
    ) -> FloatArray:
        """Sums at points, ``(k, points)``, or summed over the points with tests ``(d, points)``, ``(k, d)``."""
        unit, semi_axes = self._scaled()
        columns: list[tuple[str, tuple[Order, ...]]] = []
        local: list[FloatArray] = []
        total: FloatArray | float = 0.0
        for name, (orders, of_orders) in weights.items():
            if name == "chi":
                total = self._chi_sums(degree, orders, of_orders, at, tests)
                continue
            scaled = of_orders * np.array([unit ** ((2 if name == "phi" else 4) - sum(order)) for order in orders])
            if image:  # the potentials of the mirror image are those of the region at the mirrored point
                scaled = scaled * np.array([-1.0 if order[2] % 2 else 1.0 for order in orders])
            local_orders, transform = self._along_axes(orders)
            scaled = scaled if transform is None else scaled @ transform
            columns.append((name, tuple(local_orders)))
            local.append(scaled.reshape(len(scaled), -1))
        if columns:
            joined = np.concatenate(local, axis=1)
            sums = np.zeros((len(joined), at[0].size if tests is None else len(tests)))
            for place, share, points, outside in self._sides(at[0], at[1], -at[2] if image else at[2]):
                parts = None if tests is None else share * tests[:, place]
                values = weighted_sums(semi_axes, degree, tuple(columns), joined, points, parts, outside=outside)
                if tests is None:
                    sums[:, place] += share * values
                else:
                    sums += values
            total = total + sums
        return np.asarray(total)

    def _chi_sums(
        self,
        degree: int,
        orders: Sequence[Order],
        weights: FloatArray,
        at: Sequence[FloatArray],
        tests: FloatArray | None,
    ) -> FloatArray:
        """Weighted sums of derivatives of Chi of the densities: see `_sums`."""
        unit, semi_axes = self._scaled()
        scaled = weights * np.array([unit ** (4 - sum(order)) for order in orders])
        flat = scaled.reshape(len(weights), -1)
        # Sums of orders without and with a derivative along z act as two orders of one potential.
        along = np.array([order[2] for order in orders], dtype=bool)
        split_weights = np.concatenate([weights * ~along, weights * along])
        plane = [(i, j, 0) for i, j, _ in orders]

        def phi(x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
            sums = self.moment_sums(degree, {"phi": (plane, split_weights)}, x, y, z, image=False)
            return sums.reshape(2, len(weights), -1)

        total = np.zeros((len(weights), at[0].size if tests is None else len(tests)))
        for place, degrees, points in self._cubatures(at):
            parts = None if tests is None else tests[:, place]
            if degrees is None:
                sums = integrated_sums(self.bounds, phi, [t[place] for t in at])
                sums = sums if parts is None else sums @ parts.T
            else:
                sums = focal_chi_sums(semi_axes, self.axes, degree, orders, flat, points, degrees, parts)
            if tests is None:
                total[:, place] = sums
            else:
                total += sums
        return total

    def _in_axes(self, x: FloatArray, y: FloatArray, z: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Coordinates along the semi-axes, from the centre."""
        offset = [np.asarray(t, dtype=float) - c for t, c in zip((x, y, z), self.center, strict=True)]
        if self.rotation is None:
            return offset[0], offset[1], offset[2]
        turned = [offset[0] * R[0] + offset[1] * R[1] + offset[2] * R[2] for R in self.axes.T]
        return turned[0], turned[1], turned[2]

    def _level(self, coordinates: Sequence[FloatArray]) -> FloatArray:
        """Σ (x_i/a_i)² - 1: negative inside."""
        a, b, c = ((t / axis) ** 2 for t, axis in zip(coordinates, self.semi_axes, strict=True))
        return np.asarray(a + b + c - 1.0)

    def _differentiate(
        self, potential: str, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray
    ) -> FloatArray:
        unit, semi_axes = self._scaled()
        local_orders, transform = self._along_axes(orders)

        values = np.zeros((len(local_orders), np.size(x)))
        for place, share, points, outside in self._sides(x, y, z, CHUNK):
            sums = potential_derivatives(potential, semi_axes, local_orders, points, outside=outside)
            values[:, place] += share * sums
        if transform is not None:
            values = transform @ values
        power = 2 if potential == "phi" else 4
        values *= np.array([unit ** (power - sum(order)) for order in orders])[:, None]
        return values.reshape(len(orders), *np.shape(x))

    def _scaled(self) -> tuple[float, FloatArray]:
        """A power of two near the longest semi-axis [m], and the semi-axes in its units."""
        unit = 2.0 ** round(np.log2(max(self.semi_axes)))
        return unit, np.array(self.semi_axes) / unit

    def _along_axes(self, orders: Sequence[Order]) -> tuple[tuple[Order, ...], FloatArray | None]:
        """Derivatives along the semi-axes, and the matrix from them to the requested ones; see `_in_axes`."""
        if self.rotation is None:
            return tuple(orders), None
        return turned_derivatives(self.axes, tuple(orders))

    def _sides(
        self, x: FloatArray, y: FloatArray, z: FloatArray, chunk: int | None = None
    ) -> Iterator[tuple[NDArray[np.intp], FloatArray, Points, bool]]:
        """Points of one side: indices, weights, coordinates in units of `_scaled`, and whether they are outside.

        Points on the boundary belong to both sides with half a weight.
        """
        unit, _ = self._scaled()
        points = [np.ravel(t) for t in self._in_axes(x, y, z)]
        level = self._level(points)
        border = np.abs(level) <= SNAP
        depth = np.broadcast_to(z, np.shape(x)).ravel()
        surface = border & (depth == 0)
        share = np.where((level > SNAP) | surface, 1.0, np.where(border, 0.5, 0.0))
        for outside, of_side in ((False, 1.0 - share), (True, share)):
            place = np.flatnonzero(of_side)
            for first in range(0, place.size, chunk or max(place.size, 1)):
                chunk_points = place[first : first + (chunk or place.size)]
                yield (
                    chunk_points,
                    of_side[chunk_points],
                    (points[0][chunk_points] / unit, points[1][chunk_points] / unit, points[2][chunk_points] / unit),
                    outside,
                )

    def _cubatures(self, at: Sequence[FloatArray]) -> Iterator[tuple[NDArray[np.intp], tuple[int, int] | None, Points]]:
        """Points that share a cubature over the focal ellipse of the image, its degrees, and the points in its units.

        Degrees are None if a cubature would be too expensive.
        """
        unit, semi_axes = self._scaled()
        across, around = chi_degrees(semi_axes, tuple(t / unit for t in self._in_axes(at[0], at[1], -at[2])))
        offset = [(t - c) / unit for t, c in zip(at, (*self.center[:2], -self.center[2]), strict=True)]
        across[around < 0] = -1
        for degrees in map(tuple, np.unique(np.stack([across, around]), axis=1).T.tolist()):
            place = np.flatnonzero((across == degrees[0]) & (around == degrees[1]))
            yield place, None if degrees[1] < 0 else degrees, (offset[0][place], offset[1][place], offset[2][place])


eigencontact_register = hook_for(Ellipsoid)
