"""Cuboid of any orientation: potentials in closed form, in full space and, for a vertical edge, of its mirror image."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations
from typing import Any, ClassVar

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
from eigencontact_plugins.shapes.cuboid_corner import Corner, LineCorner, corner_derivative
from eigencontact_plugins.shapes.cuboid_distant import distant_derivatives, distant_from, gauss_rule

__all__ = ["Cuboid"]

Point = tuple[float, float, float]

#: Distance from a face, in half edges, below which a point lies on it.
SNAP = 1e-13
#: Depth of the upper face, in half edges, below which it lies in the surface.
FLUSH = 1e-12
#: Sine of an angle that counts as zero.
STRAIGHT = 1e-15


@dataclass(frozen=True, kw_only=True)
class Cuboid(InclusionShape):
    """Cuboid.

    Parameters
    ----------
    center : (float, float, float)
        Middle (x, y, z) [m].
    edges : (float, float, float)
        Full lengths of the edges [m]: along x, y and z, or along the rotated axes.
    rotation : (3, 3) or (3,), optional
        Directions of the edges: a rotation matrix whose *columns* are their unit vectors in scene axes; or three angles
        [rad] yaw, pitch, roll that rotate the axes from x, y, z by ``Rz(yaw) Ry(pitch) Rx(roll)`` (about z, then the
        rotated y, then the twice rotated x; positive from x to y, z to x, y to z). By default along x, y, z.

    Notes
    -----
    A derivative of order n is finite and exact to round-off inside, outside, on faces and in line with faces and edges.
    On a face it is the mean of both sides; on a face in z = 0 it is the limit from the requested side. On edges and
    corners second derivatives of Phi and fourth derivatives of Psi have logarithmic singularities, and higher
    derivatives have poles: there the values are large and finite.

    The mirror image of a rotated cuboid is a rotated cuboid: its Psi and Phi are those of the region at mirrored
    points. Chi has a closed form if two faces are parallel to the surface (only yaw); otherwise it is the framework's
    integral of Phi of the image.

    The sum over the corners loses accuracy at a distance by cancellation, earlier for elongated cuboids. Where the loss
    exceeds 1e-11, the potentials are integrated in closed form along the longest edge and by Gauss sums across it (see
    `cuboid_distant`). ``far_field`` returns the point sources, which are cheaper at larger distances.

    Examples
    --------
    >>> cube = Cuboid(center=(0.0, 0.0, 1.0), edges=(1.0, 1.0, 1.0))
    >>> middle = (np.array([0.0]), np.array([0.0]), np.array([1.0]))
    >>> round(float(cube.psi([(2, 2, 0)], *middle)[0, 0]), 10)  # -4 / sqrt(3)
    -2.3094010768
    >>> round(float(cube.phi([(2, 0, 0)], *middle)[0, 0]), 10)  # -4 pi / 3
    -4.1887902048
    """

    key: ClassVar[str] = "cuboid"
    takes_side: ClassVar[bool] = True
    references: ClassVar[tuple[str, ...]] = (
        "Y. P. Chiu 1978, J. Appl. Mech. 45, 302-306",
        "S. Liu & Q. Wang 2005, J. Appl. Mech. 72, 871-878",
    )

    center: Place
    edges: tuple[Length, Length, Length]
    rotation: Rotation | None = None

    def __post_init__(self) -> None:
        if self.rotation is not None:
            object.__setattr__(self, "rotation", as_tuple(self.rotation))
        require(
            len(self.center) == 3 and bool(np.isfinite(self.center).all()),
            self.key, "center", self.center, "three finite lengths (x, y, z) [m]",
        )  # fmt: skip
        require(
            len(self.edges) == 3 and all(0 < edge < np.inf for edge in self.edges),
            self.key, "edges", self.edges, "three positive, finite lengths (full edges along x, y, z) [m]",
        )  # fmt: skip
        _ = self._frame

    @cached_property
    def _frame(self) -> tuple[FloatArray | None, tuple[float, float, float]]:
        """Directions of the edges as columns, None along the axes of the scene, and their lengths in that order.

        A cuboid rotated by quarter turns is another cuboid. The columns are therefore in the order and with the signs
        closest to x, y and z: a face in the surface is then normal to the third.
        """
        if self.rotation is None:
            return None, self.edges
        rotation = rotation_matrix(self.key, self.rotation)
        order = max(permutations(range(3)), key=lambda p: sum(abs(float(rotation[i, j])) for i, j in enumerate(p)))
        turn = rotation[:, order] * np.where(rotation[range(3), order] < 0, -1.0, 1.0)
        turn[np.abs(turn) < STRAIGHT] = 0.0
        turn[np.abs(turn - 1.0) < STRAIGHT] = 1.0
        a, b, c = (float(self.edges[i]) for i in order)
        return None if np.array_equal(turn, np.eye(3)) else turn, (a, b, c)

    @property
    def _has_closed_chi(self) -> bool:
        """Whether two faces are parallel to the surface."""
        turn, _ = self._frame
        return turn is None or bool(turn[2, 2] == 1.0)

    @property
    def method(self) -> str:
        """Method for the potentials."""
        return "closed form" if self._has_closed_chi else "closed form, and quadrature of the mirror image"

    @property
    def bounds(self) -> tuple[Point, Point]:
        """Corners of lowest and of highest coordinates [m]."""
        (x, y, z), (turn, (a, b, c)) = self.center, self._frame
        if turn is not None:
            a, b, c = (float(reach) for reach in np.abs(turn) @ (a, b, c))
        return (x - a / 2, y - b / 2, z - c / 2), (x + a / 2, y + b / 2, z + c / 2)

    def contains(self, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie in the cuboid or on its boundary."""
        x, y, z = real_points(self.key, x, y, z)
        turn, edges = self._frame
        offsets = _along(turn, [t - center for t, center in zip((x, y, z), self.center, strict=True)])
        in_x, in_y, in_z = (
            np.abs(offset) <= 0.5 * edge * (1 + SNAP) for offset, edge in zip(offsets, edges, strict=True)
        )
        return np.asarray(in_x & in_y & in_z)

    def phi(
        self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray, side: FloatArray | float = 0.0
    ) -> FloatArray:
        """Derivatives of Phi of order 1 to 4, ``(len(orders), ...)`` [m^(2 - order)]; `side` as in the framework."""
        return self._differentiate("phi", orders, (x, y, z), side)

    def psi(
        self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray, side: FloatArray | float = 0.0
    ) -> FloatArray:
        """Derivatives of Psi of order 3 to 5, ``(len(orders), ...)`` [m^(4 - order)]; `side` as in the framework."""
        return self._differentiate("psi", orders, (x, y, z), side)

    def chi(self, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Derivatives of Chi of order 3 and 4 at z >= 0, ``(len(orders), ...)`` [m^(4 - order)]."""
        if not self._has_closed_chi:
            at = [np.ravel(np.asarray(t, dtype=float)) for t in (x, y, z)]
            return integrated_chi(self, orders, *at).reshape(len(orders), *np.shape(x))
        return self._differentiate("chi", orders, (x, y, z))

    def corner(self, potential: str, orders: Sequence[Order], x: Any, y: Any, z: Any) -> FloatArray:
        """Corner function of derivatives of ``"phi"``, ``"psi"`` or ``"chi"``, ``(len(orders), ...)``.

        It does not depend on the fields of the cuboid. Lengths should be of order one, for example in cells. It is
        computed in the precision of the coordinates, `numpy.longdouble` included. All y may be infinite; the function
        is then that of a rectangle in the plane of x and z, the cross-section of an infinite cell.
        """
        x, y, z = (np.asarray(t, dtype=np.result_type(t, float)) for t in (x, y, z))
        endless = bool(np.isinf(y).all())
        corner = LineCorner(x, z) if endless else Corner(x, y, z)
        out = np.empty((len(orders), *np.broadcast_shapes(x.shape, y.shape, z.shape)), corner.R.dtype)
        for row, order in enumerate(orders):
            if not endless:
                out[row] = corner_derivative(potential, order, corner)
            elif order[1]:
                out[row] = 0.0
            else:
                out[row] = np.sign(y) * corner_derivative(potential, order, corner)
        return out

    def far_field(self) -> PointSources:
        """Gauss-Legendre points, exact to 5e-14 of the largest derivative of an order from their distance on."""
        turn, edges = self._frame
        half = 0.5 * np.array(edges)
        longest = 2 * float(half.max())
        # Distance at which the corner sum has lost three digits, but with at most about 10 points along the longest
        # edge.
        distance = float(np.clip(7.0 * np.cbrt(np.prod(2 * half / longest)), 2.0, 7.0)) * longest
        gap = distance - float(np.sqrt(half @ half))
        rules = [gauss_rule(h, gap) for h in half]
        offsets = np.stack(np.meshgrid(*(nodes for nodes, _ in rules), indexing="ij"), axis=-1).reshape(-1, 3)
        volumes = np.multiply.outer(np.multiply.outer(rules[0][1], rules[1][1]), rules[2][1]).ravel()
        center = np.array(self.center, dtype=float)
        if turn is not None:
            offsets = offsets @ turn.T
        return PointSources(
            center=center,
            distance=distance,
            positions=center + offsets,
            volumes=volumes,
            spreads=np.zeros(volumes.size),
        )

    def _differentiate(
        self,
        potential: str,
        orders: Sequence[Order],
        points: tuple[FloatArray, FloatArray, FloatArray],
        seen_from: FloatArray | float = 0.0,
    ) -> FloatArray:
        """Derivatives at points reflected to the octant of positive offsets, in a unit near the longest edge.

        Chi has no parity along z; all its offsets z + z' are positive anyway.
        """
        turn, edges = self._frame
        local_orders, transform = orders, None
        if turn is not None:
            turned_orders, matrix = turned_derivatives(turn, tuple(orders))
            columns = np.flatnonzero(matrix.any(axis=0))
            local_orders, transform = [turned_orders[column] for column in columns], matrix[:, columns]
        unit = 2.0 ** round(np.log2(max(edges)))
        half = [0.5 * edge / unit for edge in edges]
        center = [c / unit for c in self.center]
        flush = abs(center[2] - half[2]) <= FLUSH * half[2] and self._has_closed_chi
        if flush:
            center[2] = half[2]
        if potential == "chi":
            center[2] = -center[2]
        offsets = _along(turn, [np.ravel(t) / unit - c for t, c in zip(points, center, strict=True)])
        reflected = [np.abs(t) for t in offsets]
        side: FloatArray | None = None
        if potential == "chi":
            reflected[2] = offsets[2]
        elif flush:
            side = np.where(offsets[2] < 0, -np.ravel(seen_from), 0.0)
        values = _evaluate(potential, local_orders, reflected, half, side)
        power = 2 if potential == "phi" else 4
        for row, order in enumerate(local_orders):
            for axis in range(2 if potential == "chi" else 3):
                if order[axis] % 2:
                    np.negative(values[row], out=values[row], where=offsets[axis] < 0)
            values[row] *= unit ** (power - sum(order))
        if transform is not None:
            values = transform @ values
        return values.reshape(len(orders), *np.shape(points[0]))


def _along(turn: FloatArray | None, offset: list[FloatArray]) -> list[FloatArray]:
    """Coordinates along the edges."""
    if turn is None:
        return offset
    return [offset[0] * axis[0] + offset[1] * axis[1] + offset[2] * axis[2] for axis in turn.T]


def _evaluate(
    potential: str,
    orders: Sequence[Order],
    offsets: Sequence[FloatArray],
    half: Sequence[float],
    side: FloatArray | None,
) -> FloatArray:
    """Sum over the corners, or its replacement far away."""
    gaps = [np.maximum(t - h, 0.0) for t, h in zip(offsets, half, strict=True)]
    limit = distant_from([2 * h for h in half])
    distant = gaps[0] ** 2 + gaps[1] ** 2 + gaps[2] ** 2 > limit**2
    if not distant.any():
        return _corner_sum(potential, orders, offsets, half, side)
    out = np.empty((len(orders), distant.size))
    out[:, distant] = distant_derivatives(potential, orders, [t[distant] for t in offsets], half)
    near = ~distant
    if near.any():
        near_side = None if side is None else side[near]
        out[:, near] = _corner_sum(potential, orders, [t[near] for t in offsets], half, near_side)
    return out


def _corner_sum(
    potential: str,
    orders: Sequence[Order],
    offsets: Sequence[FloatArray],
    half: Sequence[float],
    side: FloatArray | None,
) -> FloatArray:
    """Sum over the eight corners; distances from faces are snapped to 0."""
    axes: list[FloatArray] = []
    for offset, h in zip(offsets, half, strict=True):
        low = offset - h
        low[np.abs(low) <= SNAP * h] = 0.0
        axes.append(np.stack([low, offset + h]))
    x, y, z = axes
    corner = Corner(x[:, None, None], y[:, None], z, 0.0 if side is None else side)
    out = np.empty((len(orders), offsets[0].size))
    for row, order in enumerate(orders):
        values = corner_derivative(potential, order, corner)
        values = values[1] - values[0]
        values = values[1] - values[0]
        np.subtract(values[1], values[0], out=out[row])
    return out


eigencontact_register = hook_for(Cuboid)
