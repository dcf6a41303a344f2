r"""Field of a polynomial eigenstrain in an ellipsoid, inside and outside, by quadrature of Mindlin's solution.

With rho a monomial of the coordinates from the centre, in semi-axes of the largest, integration by parts leaves forces
on the boundary and forces in the volume::

    integral of rho dN_ij/dx'_k dV' = integral of N_ij rho n_k dS' - integral of N_ij rho,k dV'

and the same with the gradient of N by the field point. Off the boundary the first integral is smooth. The second has a
kernel of 1/R² at most: on rays from a field point inside, the volume element R² cancels it. Both rules converge
geometrically in the number of nodes; none sees a singularity. The moments go to `mindlin.displacement` and
`mindlin.stress` as those of a uniform eigenstrain do, with the value of rho as `inside`.

Range of validity: points farther from the boundary than about the size of the region divided by a quarter of `count`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.oracles import mindlin
from eigencontact_verification.oracles.volume_quadrature import (
    Rule,
    ellipsoid_boundary,
    ellipsoid_nodes,
    numerator,
    sphere_rule,
)

__all__ = ["PolynomialEllipsoid"]

FloatArray = NDArray[np.float64]
Exponents = tuple[int, int, int]

_STEP = 1e-50


@dataclass(frozen=True, kw_only=True)
class PolynomialEllipsoid:
    """An ellipsoid with an eigenstrain ``sum of e_n rho_n``.

    Attributes
    ----------
    center : (3,)
        [m].
    semi_axes : (3,)
        [m].
    terms : mapping as a tuple of (exponents, (3, 3) tensor)
        Monomials ``x^i y^j z^k`` in units of the largest semi-axis, along the fixed axes, and their eigenstrain [-].
    rotation : (3, 3), optional
        Its columns are the axes of the ellipsoid.
    count : int
        Nodes from pole to pole.

    Examples
    --------
    >>> ball = PolynomialEllipsoid(center=(0, 0, 2), semi_axes=(1, 1, 1), terms=(((0, 0, 0), np.eye(3)),), count=16)
    >>> round(float(ball.displacement([[0, 0, 0]], 0.3)[0, 2]), 9)  # -(4/3) (1 + nu) a³/c²
    -0.433333333
    """

    center: tuple[float, float, float]
    semi_axes: tuple[float, float, float]
    terms: Sequence[tuple[Exponents, ArrayLike]]
    rotation: ArrayLike | None = None
    count: int = 28

    def density(self, exponents: Exponents, points: ArrayLike) -> FloatArray:
        """Value of a monomial at points ``(n, 3)``, inside and outside alike."""
        offset = (np.asarray(points, dtype=float) - self.center) / max(self.semi_axes)
        return np.asarray((offset ** np.array(exponents)).prod(axis=-1))

    def eigenstrain(self, points: ArrayLike) -> FloatArray:
        """Eigenstrain ``(n, 3, 3)`` at points ``(n, 3)`` as a polynomial, inside and outside alike."""
        tensors = [self.density(powers, points)[:, None, None] * np.asarray(tensor) for powers, tensor in self.terms]
        return np.asarray(sum(tensors))

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether points ``(n, 3)`` lie inside."""
        return np.asarray((self._unit(points) ** 2).sum(axis=-1) < 1)

    def displacement(self, points: ArrayLike, nu: float, space: str = "half") -> FloatArray:
        """Displacement ``(n, 3)`` [m]."""
        moments = self._moments(points, space, gradient=False)
        terms = [
            mindlin.displacement(moment, np.asarray(tensor), nu)
            for moment, (_, tensor) in zip(moments, self.terms, strict=True)
        ]
        return np.asarray(sum(terms))

    def stress(self, points: ArrayLike, nu: float, space: str = "half") -> FloatArray:
        """Stress ``(n, 3, 3)`` over the shear modulus; nu up to and including 1/2."""
        moments, inside = self._moments(points, space, gradient=True), self.contains(points)
        terms = [
            mindlin.stress(moment, np.asarray(tensor), nu, inside * self.density(exponents, points))
            for moment, (exponents, tensor) in zip(moments, self.terms, strict=True)
        ]
        return np.asarray(sum(terms))

    def _axes(self) -> FloatArray:
        turn = np.eye(3) if self.rotation is None else np.asarray(self.rotation, dtype=float)
        return np.asarray(turn * np.asarray(self.semi_axes, dtype=float))

    def _unit(self, points: ArrayLike) -> FloatArray:
        """Points in the coordinates in which the ellipsoid is the unit ball."""
        return np.asarray(np.linalg.solve(self._axes(), (np.asarray(points, dtype=float) - self.center).T).T)

    def _volume_rule(self, point: FloatArray) -> Rule:
        """Nodes and weights: on rays from a point inside, on rays from the centre for a point outside."""
        (start,) = self._unit(point[None])
        if start @ start >= 1:
            return ellipsoid_nodes(self.center, self.semi_axes, self.rotation, self.count)
        unit, solid = sphere_rule(self.count)
        along = unit @ start
        length = np.sqrt(along**2 + 1 - start @ start) - along
        nodes, weight = np.polynomial.legendre.leggauss(self.count)
        share = (1 + nodes) / 2
        far = length * share[:, None]
        positions = point + (far[..., None] * (unit @ self._axes().T)).reshape(-1, 3)
        volume = abs(np.linalg.det(self._axes())) * (weight / 2)[:, None] * far**2 * length * solid
        return positions, volume.ravel()

    def _slopes(self, exponents: Exponents, points: FloatArray) -> FloatArray:
        """Gradient of a monomial, ``(n, 3)`` [1/m]."""
        out = np.zeros(points.shape)
        for axis, power in enumerate(exponents):
            if power:
                lower = (*exponents[:axis], power - 1, *exponents[axis + 1 :])
                out[:, axis] = power / max(self.semi_axes) * self.density((lower[0], lower[1], lower[2]), points)
        return out

    def _moments(self, points: ArrayLike, space: str, *, gradient: bool) -> FloatArray:
        """Moments of every term, ``(terms, 3, n, i, j, k)``, or of the gradient ``(terms, 3, n, i, l, j, k)``."""
        powers = [exponents for exponents, _ in self.terms]
        positions, area = ellipsoid_boundary(self.center, self.semi_axes, self.rotation, 2 * self.count)
        forces = np.stack([area * self.density(exponents, positions)[:, None] for exponents in powers], axis=1)
        out = []
        for point in np.atleast_2d(np.asarray(points, dtype=float)):
            total = _sums(point, (positions, forces), space, gradient=gradient)
            if any(map(any, powers)):
                nodes, volume = self._volume_rule(point)
                slopes = np.stack([self._slopes(exponents, nodes) for exponents in powers], axis=1)
                total = total - _sums(point, (nodes, slopes * volume[:, None, None]), space, gradient=gradient)
            out.append(total)
        return np.stack(out, axis=2)


def _sums(point: FloatArray, rule: Rule, space: str, *, gradient: bool) -> FloatArray:
    """Sums of N_ij w_k over nodes with weights ``(m, terms, 3)``, ``(terms, 3, i, j, k)``, or of dN_ij/dx_l w_k."""
    positions, weights = rule
    x = point[:, None].astype(complex)
    steps = 1j * _STEP * np.eye(3) if gradient else np.zeros((3, 1))
    slopes = []
    for step in steps.T[:, :, None]:
        values = numerator(x + step, positions.T, space)
        real = values.imag / _STEP if gradient else values.real
        slopes.append(np.tensordot(real, weights, axes=1))  # i, j, nu, terms, k
    stacked = np.moveaxis(np.stack(slopes, axis=1), (3, 4), (1, 0))  # terms, nu, i, l, j, k
    return stacked if gradient else stacked[:, :, :, 0]
