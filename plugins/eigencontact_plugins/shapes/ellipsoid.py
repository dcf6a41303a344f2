"""Ellipsoid of any proportions and orientation: potentials to round-off, inside and outside."""

from __future__ import annotations

from collections.abc import Sequence
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
from eigencontact_plugins.shapes.ellipsoid_potentials import potential_derivatives

__all__ = ["Ellipsoid"]

Point = tuple[float, float, float]

#: Distance of Σ (x_i/a_i)² from 1 up to which a point lies on the boundary.
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
        Half its extent along its own axes [m], in any order of size.
    rotation : (3, 3) or (3,), optional
        Directions of the semi-axes: a rotation matrix whose *columns* are their unit vectors in scene axes; or three
        angles [rad] yaw, pitch, roll that turn the axes from x, y, z by ``Rz(yaw) Ry(pitch) Rx(roll)`` (about z, then
        the turned y, then the twice turned x; positive from x to y, z to x, y to z). Along x, y, z if left out.

    Notes
    -----
    Exact to round-off inside and outside for all proportions: spheres, spheroids, nearly equal axes, needles and discs
    (1 : 1000 is tested). On the boundary every derivative is the mean of both sides; where an ellipsoid touches z = 0,
    the limit along the surface, from outside, as for a sphere. Chi has no closed form: it is a cubature over the focal
    ellipse or, where that would need too many nodes (next to the image of a disc), the framework's integral of Phi of
    the image (to 2e-11).
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
        unit = 2.0 ** round(np.log2(max(self.semi_axes)))
        semi_axes = np.array(self.semi_axes) / unit
        at = [np.ravel(np.asarray(t, dtype=float)) for t in (x, y, z)]
        across, around = chi_degrees(semi_axes, tuple(t / unit for t in self._in_axes(at[0], at[1], -at[2])))
        offset = (at[0] - self.center[0], at[1] - self.center[1], at[2] + self.center[2])
        values = np.empty((len(orders), at[0].size))
        for degrees in map(tuple, np.unique(np.stack([across, around])[:, around >= 0], axis=1).T.tolist()):
            place = np.flatnonzero((across == degrees[0]) & (around == degrees[1]))
            values[:, place] = focal_chi(semi_axes, self.axes, orders, tuple(t[place] / unit for t in offset), degrees)
        values *= np.array([unit ** (4 - sum(order)) for order in orders])[:, None]
        place = np.flatnonzero(around < 0)
        if place.size:
            values[:, place] = integrated_chi(self, orders, *(t[place] for t in at))
        return values.reshape(len(orders), *np.shape(x))

    def far_field(self) -> PointSources:
        """Cubatures over the focal ellipse, exact to 1e-12: some tens of points far away, hundreds next to the tips."""
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
        unit = 2.0 ** round(np.log2(max(self.semi_axes)))
        semi_axes = np.array(self.semi_axes) / unit
        local_orders, transform = (
            turned_derivatives(self.axes, tuple(orders)) if self.rotation is not None else (orders, None)
        )
        points = [np.ravel(t) for t in self._in_axes(x, y, z)]
        level = self._level(points)
        border = np.abs(level) <= SNAP
        depth = np.broadcast_to(z, np.shape(x)).ravel()
        surface = border & (depth == 0)
        outside = (level > SNAP) | surface
        halves = border & ~surface
        values = np.empty((len(local_orders), level.size))
        for first in range(0, level.size, CHUNK):
            chunk = slice(first, first + CHUNK)
            for side in (False, True):
                place = first + np.flatnonzero((outside[chunk] == side) & ~halves[chunk])
                if place.size:
                    values[:, place] = potential_derivatives(
                        potential, semi_axes, local_orders, tuple(t[place] / unit for t in points), outside=side
                    )
        place = np.flatnonzero(halves)
        if place.size:
            at = tuple(t[place] / unit for t in points)
            inner, outer = (
                potential_derivatives(potential, semi_axes, local_orders, at, outside=side) for side in (False, True)
            )
            values[:, place] = 0.5 * (inner + outer)
        if transform is not None:
            values = transform @ values
        power = 2 if potential == "phi" else 4
        values *= np.array([unit ** (power - sum(order)) for order in orders])[:, None]
        return values.reshape(len(orders), *np.shape(x))


eigencontact_register = hook_for(Ellipsoid)
