"""Route for whole inhomogeneities with polynomial eigenstrain, by potentials of polynomials at the points."""

from __future__ import annotations

from typing import cast

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.parallel import working_threads
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.routes.route import Route
from eigencontact.halfspace.potentials import HasMomentPotentials
from eigencontact.model.sources import Inhomogeneity

__all__ = ["MomentForms"]

#: Seconds per point on one thread, and per point and function: fitted to balls of degree 2 to 6.
_POINT, _FUNCTION = 1.5e-6, 4e-8
#: A degree N has about 2 (N + 6)² functions.
_ABOVE = 6


class MomentForms(Route):
    """Field of a polynomial eigenstrain in each of some shapes, ``(6, densities, n)``."""

    @property
    def words(self) -> str:
        """See `Route.words`."""
        return "potentials of its polynomial eigenstrain"

    @property
    def cost(self) -> Cost:
        """See `Route.cost`; only the field is stored."""
        count = int(np.prod(self.lattice.shape))
        degrees = [source.degree for source in self.sources if isinstance(source, Inhomogeneity)]
        functions = [2 * (item.degree + _ABOVE) ** 2 for item in degrees if item is not None]
        seconds = count * (len(functions) * _POINT + sum(functions) * _FUNCTION)
        memory = 8.0 * count * len(self.rows) * 3 + 64e6
        return Cost(memory=memory, seconds_per_step=seconds / working_threads(self.half_space.threads))

    def field(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Route.field`."""
        from eigencontact.halfspace.moments import degree_of, densities_up_to, moment_field

        points, numerics = self.lattice.flat_points(), self.half_space.numerics
        total = np.zeros((3 if self.quantity == "displacement" else 6, points[0].size))
        for source, coefficients in zip(self.sources, np.moveaxis(eigenstrain, 2, 0), strict=True):
            degree = degree_of(coefficients)
            total += moment_field(
                cast("HasMomentPotentials", source.shape), coefficients[:, : densities_up_to(degree)], points,
                degree=degree, poisson_ratio=self.half_space.material.poisson_ratio, quantity=self.quantity,
                space=self.half_space.space, threads=numerics.threads,
            )  # fmt: skip
        if self.quantity == "stress":
            total *= self.half_space.material.shear_modulus
        return total[list(self.rows)].reshape(self.shape)
