"""Uniform eigenstrain as a polynomial of degree 0: a shape with potentials as one with the density 1."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.errors import require
from eigencontact.halfspace.mirror import integrated_chi
from eigencontact.halfspace.potentials import (
    HasFarField,
    HasMirrorPotential,
    HasMomentPotentials,
    HasPotentials,
    Order,
    derivatives,
)
from eigencontact.halfspace.region_means import averaging_points

__all__ = ["UniformDensity", "with_densities"]


class _Region(HasPotentials, HasFarField, Protocol):
    """Region with potentials, and with point sources for its volume."""


@dataclass(frozen=True, eq=False)
class UniformDensity:
    """Moment potentials of degree 0 of a shape with potentials; see `HasMomentPotentials` and `HasMomentSums`."""

    shape: _Region

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Lowest and highest coordinates of the region [m]."""
        return self.shape.bounds

    def densities(self, degree: int, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """The density 1, ``(1, ...)``."""
        require(degree == 0, "inclusions", "degree", degree, "0 for a shape without moment potentials")
        return np.ones((1, *np.broadcast_shapes(np.shape(x), np.shape(y), np.shape(z))))

    def density_rule(self, counts: tuple[int, int, int]) -> tuple[FloatArray, FloatArray]:  # noqa: ARG002
        """Averaging points, independent of `counts`: see `averaging_points`."""
        points, weights = averaging_points(self.shape)
        return points, weights * float(self.shape.far_field().volumes.sum())

    def phi_moments(
        self, degree: int, orders: Sequence[Order], x: FloatArray, y: FloatArray, z: FloatArray
    ) -> FloatArray:
        """Derivatives of Phi, ``(1, len(orders), ...)``."""
        require(degree == 0, "inclusions", "degree", degree, "0 for a shape without moment potentials")
        return derivatives(self.shape, "phi", orders, x, y, z)[None]

    def moment_sums(
        self,
        degree: int,  # noqa: ARG002
        weights: Mapping[str, tuple[Sequence[Order], FloatArray]],
        x: FloatArray,
        y: FloatArray,
        z: FloatArray,
        *,
        image: bool,
    ) -> FloatArray:
        """Weighted sums of derivatives of the potentials of the shape."""
        total: FloatArray | float = 0.0
        for name, (orders, of_orders) in weights.items():
            if name == "chi":
                shape: Any = self.shape
                has_chi = isinstance(shape, HasMirrorPotential)
                values = shape.chi(orders, x, y, z) if has_chi else integrated_chi(shape, orders, x, y, z)
            else:
                signs = [-1.0 if image and order[2] % 2 else 1.0 for order in orders]
                values = derivatives(self.shape, name, orders, x, y, -z if image else z)
                values = values * np.reshape(signs, (-1, *(1,) * np.ndim(x)))
            total = total + np.tensordot(of_orders[:, 0], values, 1)
        return np.asarray(total)


def with_densities(shape: HasMomentPotentials | _Region) -> HasMomentPotentials:
    """A shape with moment potentials: the shape itself, or one with its potentials as those of the density 1."""
    return shape if isinstance(shape, HasMomentPotentials) else UniformDensity(shape)
