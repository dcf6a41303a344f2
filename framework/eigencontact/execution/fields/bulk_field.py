"""Bulk stress of a body at the points of a region, with its strain and displacement."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.bulk import bulk_of, dragged, in_plane_strain, plane_stress, strain_across
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.core.tensors import SQRT2
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.fields.cause import Cause, StressAtDepths
from eigencontact.model.kernels import Solid
from eigencontact.model.regions import RegionLattice
from eigencontact.scene.schema import StressRequest

__all__ = ["BulkField"]

#: Points and weights of the integral of the strain across a layer with graded constants.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)


class BulkField(Cause):
    """Field of one body.

    All layers have the strain of the substrate. At the depth of an interface the constants of the deeper layer apply.
    The displacement is zero at the surface in the middle of the window.

    Parameters
    ----------
    request : StressRequest
    lattice : RegionLattice
        Points of the region.
    solid : Material or LayeredMedium
        The body.
    grid : Grid
        Cells of the window. The displacement is zero in its middle. In a line contact the strain is plane.
    """

    requires, kernels, cost, precisions = frozenset(), (), Cost(), ()

    def __init__(self, request: StressRequest, lattice: RegionLattice, solid: Solid, grid: Grid) -> None:
        self._body, self._quantities, self._lattice, self._solid = request.body, request.fields, lattice, solid
        self._grid, self.by_depths = grid, "stress" in request.fields and lattice.points is None

    @cached_property
    def _places(self) -> tuple[FloatArray, FloatArray, FloatArray, NDArray[np.intp]]:
        """Coordinates x, y of the points, the different depths, and the number of the depth of each point."""
        x, y, z = self._lattice.flat_points()
        return (x, y, *np.unique(z, return_inverse=True))

    def fields(self, step: Step) -> dict[str, FloatArray]:
        """Fields by quantity, ``(3 or 6, *lattice.shape)``."""
        x, y, depths, place = self._places
        strain = self._strain(step.bulk[1])
        columns = {quantity: getattr(self, f"_{quantity}_at")(strain, depths) for quantity in self._quantities}
        fields = {quantity: values[:, place] for quantity, values in columns.items()}
        if "displacement" in fields:
            fields["displacement"][:2] += dragged(strain, x - self._grid.center[0], y - self._grid.center[1])
        return {name: values.reshape(-1, *self._lattice.shape) for name, values in fields.items()}

    def of_steps(self, steps: Sequence[Step]) -> StressAtDepths:
        """See `Cause.of_steps`."""
        depths = self._lattice.depths + 0.0
        stress = np.stack([self._stress_at(self._strain(step.bulk[1]), depths) for step in steps])
        return lambda layers: stress[:, :, layers, None]

    def _strain(self, values: Mapping[str, float]) -> FloatArray:
        """Strain (xx, yy, xy), equal at all depths."""
        substrate = self._solid if isinstance(self._solid, Material) else self._solid.deep_material
        return in_plane_strain(bulk_of(values, self._body), substrate, self._grid)

    def _material(self, depth: float) -> Material:
        return self._solid if isinstance(self._solid, Material) else self._solid.material_at(float(depth))

    def _stress_at(self, strain: FloatArray, depths: FloatArray) -> FloatArray:
        """Mandel stress ``(6, n)`` [Pa] at depths ``(n,)`` [m]."""
        if isinstance(self._solid, Material):
            return np.repeat(plane_stress(strain, self._solid)[:, None], depths.size, axis=1)
        return np.stack([plane_stress(strain, self._material(depth)) for depth in depths], axis=1)

    def _strain_at(self, strain: FloatArray, depths: FloatArray) -> FloatArray:
        """Mandel strain ``(6, n)`` at depths ``(n,)`` [m]."""
        out = np.zeros((6, depths.size))
        out[0], out[1], out[5] = strain[0], strain[1], SQRT2 * strain[2]
        out[2] = [strain_across(strain, self._material(depth)) for depth in depths]
        return out

    def _displacement_at(self, strain: FloatArray, depths: FloatArray) -> FloatArray:
        """Displacement ``(3, n)`` [m] along z at depths ``(n,)`` [m], relative to the surface."""
        out = np.zeros((3, depths.size))
        out[2] = [self._settlement(strain, depth) for depth in depths]
        return out

    def _settlement(self, strain: FloatArray, depth: float) -> float:
        """Integral of the strain zz from the surface to a depth [m]."""
        faces = () if isinstance(self._solid, Material) else self._solid.interfaces
        knots = np.array([0.0, *(face for face in faces if face < depth), depth])
        total = 0.0
        for low, high in pairwise(knots):
            places = 0.5 * (low + high) + 0.5 * (high - low) * _POINTS
            across = [strain_across(strain, self._material(place)) for place in places]
            total += 0.5 * (high - low) * float(_WEIGHTS @ across)
        return total
