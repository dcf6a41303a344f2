"""Interface of a shape: derivatives of its potentials, the input of the half-space theorem.

With R the distance between field point and source point, the potentials of a region are::

    Phi(x) = integral of 1/R        (harmonic outside, Laplacian -4 pi inside)
    Psi(x) = integral of R          (biharmonic outside, Laplacian 2 Phi)
    Chi(x, y, Z) = integral of Z' ln(R' + Z') - R'   with Z' = Z + z', R' the distance to the mirror point (x', y', -z')

Phi and Psi are those of the region itself, wherever the field point lies. The framework asks for them at mirrored
points for the image of the region above the surface. Chi belongs to the image; its second derivative along Z is the
Phi of the image, and a shape without a closed form leaves it out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np

from eigencontact.core.array_types import FloatArray

__all__ = [
    "HasCornerPotentials",
    "HasFarField",
    "HasMirrorPotential",
    "HasMomentIntegrals",
    "HasMomentPotentials",
    "HasMomentSums",
    "HasPotentials",
    "HasSidedPotentials",
    "HasVolumeFractions",
    "Order",
    "Point",
    "PointSources",
    "derivatives",
]

Point = tuple[float, float, float]
#: How often a potential is differentiated along x, y and z.
Order = tuple[int, int, int]


@runtime_checkable
class HasPotentials(Protocol):
    """Ability of a shape: derivatives of its potentials in full space, inside, outside and on the boundary.

    The framework asks for Psi of order 3 (displacement), 4 and 5 (strain, stress), Phi of order 1 to 4. On a face,
    where second derivatives of Phi jump, return the mean of both sides; on a flat face in the surface the limit from
    one side (`HasSidedPotentials`).
    """

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Lowest and highest coordinates of the region [m]."""

    def phi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Phi, ``(len(orders), ...)`` [m^(2 - order)]; x, y, z have one shape."""

    def psi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Psi, ``(len(orders), ...)`` [m^(4 - order)]; x, y, z have one shape."""


@runtime_checkable
class HasSidedPotentials(Protocol):
    """Ability of a shape with a flat face in the surface: potentials on one side of this face.

    Points of the body see such a face from inside, their mirror points see it from above. Where a shape sets
    ``takes_side = True``, `phi` and `psi` are given that as `side`, an array of the shape of z: 1 where z = 0 is seen
    from inside the body, -1 where it is seen from above, 0 off the surface; 0 there is the mean, as on other faces.
    Without the ability the sign of zero says it (`numpy.signbit`): ``z = +0.0`` from inside, ``z = -0.0`` from above.
    """

    takes_side: ClassVar[bool]

    def phi(
        self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray, side: FloatArray | float = 0.0
    ) -> FloatArray:
        """See `HasPotentials.phi`."""

    def psi(
        self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray, side: FloatArray | float = 0.0
    ) -> FloatArray:
        """See `HasPotentials.psi`."""


def derivatives(
    shape: HasPotentials, potential: str, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray
) -> FloatArray:
    """Derivatives of ``"phi"`` or ``"psi"`` of a shape; z of -0.0 is the upper side of the surface.

    A shape with ``takes_side`` receives the side, so that only the framework needs to know of signed zeros.
    """
    if isinstance(shape, HasSidedPotentials) and shape.takes_side:
        side = np.where(z == 0, np.where(np.signbit(z), -1.0, 1.0), 0.0)
        return (shape.phi if potential == "phi" else shape.psi)(orders, x, y, z, side)
    return (shape.phi if potential == "phi" else shape.psi)(orders, x, y, z)


@runtime_checkable
class HasMirrorPotential(Protocol):
    """Ability of a shape with potentials: derivatives of its Chi in closed form.

    Asked for at depths z >= 0, orders 3 and 4 with at most one derivative along z. Without it the framework
    integrates ``Chi,ab = integral from z to infinity of (t - z) Phi,ab(x, y, t) dt`` of the image, never singular.
    """

    def chi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Chi, ``(len(orders), ...)`` [m^(4 - order)]; x, y, z have one shape."""


@runtime_checkable
class HasMomentPotentials(Protocol):
    """Ability of a shape: harmonic potentials of polynomial densities over it, for nonuniform eigenstrain.

    A shape has densities ρ of its own choice. Those up to a degree N span all polynomials of that degree in the
    region: (N+1)(N+2)(N+3)/6 of them, the densities of lower degrees first. The framework takes biharmonic potentials
    from the identity ``Psi[ρ],i = x_i Phi[ρ] - Phi[x_i ρ]``, and Chi from an integral along a line.

    References
    ----------
    N. M. Ferrers 1877, Quart. J. Pure Appl. Math. 14, 1; F. W. Dyson 1891, ibid. 25, 259 (ellipsoids); T. Mura 1987,
    Micromechanics of Defects in Solids, section 13 (polynomial eigenstrain).
    """

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Lowest and highest coordinates of the region [m]."""

    def densities(self, degree: int, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Values of the densities up to a degree, ``(n, ...)`` [-], as polynomials inside and outside alike."""

    def density_rule(self, counts: tuple[int, int, int]) -> tuple[FloatArray, FloatArray]:
        """Points ``(m, 3)`` [m] and weights ``(m,)`` [m^3] of an integral over the region.

        `counts` asks for so many points outwards, from pole to pole along z, and around; of a box along x, y and z.
        """

    def phi_moments(
        self, degree: int, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray
    ) -> FloatArray:
        """Derivatives of the integral of ρ/R, ``(n, len(orders), ...)`` [m^(2 - order)]; x, y, z have one shape.

        Inside, outside, and on the boundary the mean of both sides; orders 0 to 5.
        """


@runtime_checkable
class HasMomentSums(Protocol):
    """Ability of a shape with moment potentials: sums over densities and orders, combined before the point loop."""

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
        """Weighted sums of derivatives of moment potentials, ``(k, ...)``.

        Parameters
        ----------
        degree : int
            Of the densities.
        weights : mapping
            By potential, ``"phi"``, ``"psi"`` (orders 3 to 5) and, of the image, ``"chi"`` (orders 3 and 4, at most one
            along z): the orders, and weights ``(k, n, len(orders))``.
        x, y, z : (...)
            Points [m].
        image : bool
            Whether the potentials are those of the mirror image of region and densities, as functions of points with
            z >= 0, and derivatives those by such points; otherwise of the region.
        """


@runtime_checkable
class HasMomentIntegrals(Protocol):
    """Ability of a shape with moment sums: their integrals with other functions, without sums at every point."""

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
        """Sums over points ``(m,)`` of `moment_sums` times each of `tests` ``(d, m)``: ``(k, d)``."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PointSources:
    """Points that represent a distant region.

    Attributes
    ----------
    center : (3,)
        Middle of the region [m].
    distance : float
        They may be used at points at least this far from `center` [m], and from its mirror image.
    positions : (m, 3)
        Points [m], all in z >= 0.
    volumes : (m,)
        Weights; their sum is the region's volume [m^3].
    spreads : (m,)
        Terms k of ``Psi = volume * (R + k / R)`` [m^2]: a²/5 of a ball of radius a, 0 of a bare point.
    coarser : PointSources, optional
        Fewer points that do further away; these may have still coarser ones.
    """

    center: FloatArray
    distance: float
    positions: FloatArray
    volumes: FloatArray
    spreads: FloatArray
    coarser: PointSources | None = None

    @property
    def reach(self) -> float:
        """Largest distance of a point from the center [m]."""
        return float(np.sqrt(((self.positions - self.center) ** 2).sum(axis=1).max()))

    @property
    def levels(self) -> list[PointSources]:
        """These sources and all coarser ones, the coarsest first."""
        return [*([] if self.coarser is None else self.coarser.levels), self]


@runtime_checkable
class HasFarField(Protocol):
    """Ability of a shape: point sources at distances where its closed form loses digits."""

    def far_field(self) -> PointSources:
        """Point sources, exact to round-off beyond their distance."""


@runtime_checkable
class HasCornerPotentials(Protocol):
    """Ability of the shape of grid cells: derivatives of the potentials of a cuboid as corner sums.

    With c the offset of the field point from the centre and h the half edges, the derivative is the sum over the eight
    signs of ``s1 s2 s3 corner(c_x + s1 h_x, c_y + s2 h_y, c_z + s3 h_z)``. Cells of a grid share corners: the framework
    evaluates the function once per lattice node and differences it three times.
    """

    def corner(self, potential: str, orders: Sequence[Order], x: Any, y: Any, z: Any) -> FloatArray:
        """Corner function of derivatives of ``"phi"``, ``"psi"`` or ``"chi"``, ``(len(orders), ...)``.

        x, y, z broadcast; they must not lie on a coordinate plane's singular line (lattice nodes never do). For chi
        z is the distance along Z, positive. All y may be infinite, for cells without end along y (line contacts).
        """


@runtime_checkable
class HasVolumeFractions(Protocol):
    """Ability of a shape without potentials: its volume fractions in the cells of a lattice, without ``contains``.

    Worth it where ``contains`` is dear: it is otherwise asked at up to a thousand points of a cell.
    """

    def volume_fractions(self, low: Point, edges: Point, shape: tuple[int, int, int]) -> FloatArray | None:
        """Volume fraction of the shape in each cell, ``(nz, ny, nx)`` in 0 to 1; None to use ``contains``.

        Parameters
        ----------
        low : (x, y, z)
            Lowest corner of the lattice [m].
        edges : (dx, dy, dz)
            Edges of a cell [m].
        shape : (nz, ny, nx)
            Numbers of cells.
        """
