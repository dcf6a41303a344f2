"""Stress on edges that four cells share, where uniform cells leave a logarithm, against a closed form."""

import numpy as np
import pytest

from close import close
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.eigenstrain import VolumeField
from eigencontact_plugins.shapes.cuboid import Cuboid

CELL = Cuboid(center=(0.0, 0.0, 1.0), edges=(1.0, 1.0, 1.0))
G, NU, RADIUS, COUNT = 80.0, 0.3, 1.0, 16
#: Axis along the edges through the middle of the ball, and the Mandel component of shear across it.
SHEARED = {"x": 3, "y": 4, "z": 5}


def stress_on_edges(along):
    """Places on the edge through the middle of a ball that swells by the product of the other two coordinates."""
    d = 2.0 * RADIUS / COUNT
    middles = (np.arange(COUNT) - 0.5 * (COUNT - 1)) * d
    z, y, x = np.meshgrid(middles, middles, middles, indexing="ij")
    fine = (np.arange(6) - 2.5) / 6.0 * d
    inside = [(x + a) ** 2 + (y + b) ** 2 + (z + c) ** 2 < RADIUS**2 for a in fine for b in fine for c in fine]
    strain = np.zeros((6, *x.shape))
    strain[:3] = np.mean(inside, axis=0) * {"x": y * z, "y": x * z, "z": x * y}[along]
    # The middles along the edges, and the lowest of the faces across them that is inside.
    first = [middles[0] if axis == along else middles[0] + 0.5 * d for axis in "xyz"]
    cells = Cells(first=(middles[0],) * 3, pitch=(d,) * 3, shape=x.shape)
    target = Cells(first=tuple(first), pitch=(d,) * 3, shape=x.shape)
    field = VolumeField(CELL, cells, target, poisson_ratio=NU, shear_modulus=G, space="full").apply(strain)
    here = [slice(None) if axis == along else COUNT // 2 - 1 for axis in "zyx"]
    return middles, field[(SHEARED[along], *here)]


@pytest.mark.parametrize("along", "xyz")
def test_shear_of_a_ball_that_swells_by_a_product(along):
    """Goodier's potential y z (r²/14 - R²/10) has the Laplacian y z within the ball, and goes on as one of y z / r⁵."""
    place, found = stress_on_edges(along)
    inner = np.abs(place) < 0.6 * RADIUS
    expected = np.sqrt(2.0) * 2.0 * G * (1.0 + NU) / (1.0 - NU) * (place**2 / 14.0 - RADIUS**2 / 10.0)
    assert found[inner] == close(expected[inner], rel=0.02)
