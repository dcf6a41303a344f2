"""Elastic strain in a body whose constants change with depth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eigencontact.execution.regions import strain_from_stress
from eigencontact.planning.regions import RegionLattice
from eigencontact.plugin import LayeredMedium

__all__ = ["strain_in_layers"]

FloatArray = NDArray[np.float64]


def strain_in_layers(stress: FloatArray, medium: LayeredMedium, lattice: RegionLattice) -> FloatArray:
    """Mandel strain of a Mandel stress ``(6, *lattice.shape)`` by the constants at each point's depth.

    At the depth of an interface they are those of the deeper layer, as the stress is.
    """
    depths = lattice.depths if lattice.points is None else lattice.points[:, 2]
    strain = np.empty_like(stress)
    for depth in np.unique(depths):
        here = depths == depth
        strain[:, here] = strain_from_stress(stress[:, here], medium.material_at(float(depth) + 0.0))
    return strain
