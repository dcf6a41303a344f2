"""Fields of cells at depths that all but lie on a face between two layers of them."""

import numpy as np
import pytest

from eigencontact.solvers.cells import Cells
from eigencontact.solvers.eigenstrain_planes import PlaneFields
from eigencontact_plugins.shapes.cuboid import Cuboid

CELL = Cuboid(center=(0.0, 0.0, 0.5), edges=(1.0, 1.0, 1.0))


@pytest.mark.parametrize("share", [1e-12, 0.9e-9, 1.1e-9, 3e-9, 1e-8, 1e-6])
@pytest.mark.parametrize("side", [-1, 1])
def test_stress_across_a_face_is_continuous_from_any_distance(share, side):
    """The face at 1 between the third layer, swollen, and the fourth: the stress on it is the same from either side."""
    pitch = 1.0 / 3.0
    cells = Cells(first=(0.0, 0.0, 0.5 * pitch), pitch=(0.4, 0.4, pitch), shape=(4, 3, 3))
    depths = [1.0 + side * share, 1.0 + 1e-5, 1.0 - 1e-5]
    fields = PlaneFields(
        CELL, cells, target=(3, 3), depths=depths, poisson_ratio=0.3, quantity="stress", shear_modulus=1.0
    )
    strain = np.zeros((6, *cells.shape))
    strain[:, :3] = np.array([1.0, 0.5, -0.3, 0.2, 0.4, 0.1])[:, None, None, None]
    near, below, above = np.moveaxis(fields.apply(strain), 1, 0)
    across = [2, 3, 4]
    np.testing.assert_allclose(near[across], below[across], rtol=0, atol=2e-4)
    # along the face the stress is that of a side, or the mean of both on the face itself
    along = [0, 1, 5]
    expected = (
        [0.5 * (below + above)] if share < 1e-9 * pitch else [below if side > 0 else above, 0.5 * (below + above)]
    )
    assert min(float(np.abs(near[along] - one[along]).max()) for one in expected) < 2e-4
    assert np.abs(below[along] - above[along]).max() > 1.0
