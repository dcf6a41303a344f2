"""Fine lattices around a few cells against the sum of all cells' closed forms at the same points."""

import numpy as np
import pytest

from direct_sums import sum_of_cells
from eigencontact.errors import SceneError
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.close_up import close_up
from eigencontact_plugins.shapes.cuboid import Cuboid

CELL = Cuboid(center=(0.0, 0.0, 1.0), edges=(1.0, 1.0, 1.0))
#: Of shear modulus times the largest eigenstrain (of its cells' edge for displacement), measured 5e-7: what is
#: interpolated is caused by cells at least six of their longest edges away.
BOUND = 1e-6


def direct(source, points, strain, **options):
    z, y, x = np.meshgrid(points.centres(2), points.centres(1), points.centres(0), indexing="ij")
    return sum_of_cells(source, (x.ravel(), y.ravel(), z.ravel()), strain, **options).reshape(-1, *points.shape)


def cells(first, pitch, shape):
    return Cells(first=first, pitch=pitch, shape=shape)


def sparse_strain(source, share, seed=3):
    random = np.random.default_rng(seed)
    return random.standard_normal((6, *source.shape)) * (random.random(source.shape) < share)


PITCH = (0.5, 0.4, 0.3)
SOURCE = cells((0.0, 0.0, 0.15), PITCH, (16, 24, 26))
TARGETS = {
    "section": cells((2.1, 2.03, 0.07), (0.25, 0.4, 0.1), (7, 1, 5)),
    "block": cells((3.0, 2.0, 1.0), (0.25, 0.4, 0.15), (5, 3, 4)),
    "beside": cells((-2.2, 1.0, 0.4), (0.25, 0.4, 0.15), (3, 2, 4)),
    "same pitch": cells((2.0, 1.2, 0.45), PITCH, (2, 3, 4)),
}

SLOW = ("block", "beside", "same pitch")


@pytest.mark.parametrize("name", ["section", *(pytest.param(n, marks=pytest.mark.slow) for n in SLOW)])
@pytest.mark.parametrize("quantity", [pytest.param("stress", marks=pytest.mark.slow), "displacement"])
def test_against_direct_sum(name, quantity):
    strain = sparse_strain(SOURCE, 0.02)
    target = TARGETS[name]
    options = {"poisson_ratio": 0.3, "quantity": quantity}
    found = close_up(CELL, SOURCE, strain, target, **options)
    expected = direct(SOURCE, target, strain, **options)
    assert np.abs(found - expected).max() <= 2.5 * BOUND * np.abs(strain).max()


def test_full_space_and_units():
    strain = sparse_strain(SOURCE, 0.02)
    options = {"poisson_ratio": 0.2, "quantity": "stress", "space": "full"}
    found = close_up(CELL, SOURCE, strain, TARGETS["section"], shear_modulus=2.5, **options)
    expected = 2.5 * direct(SOURCE, TARGETS["section"], strain, **options)
    assert np.abs(found - expected).max() <= 2.5 * BOUND * np.abs(strain).max()


def test_no_eigenstrain_no_field():
    found = close_up(CELL, SOURCE, np.zeros((6, *SOURCE.shape)), TARGETS["block"], poisson_ratio=0.3)
    assert found.shape == (6, *TARGETS["block"].shape)
    assert not found.any()


def test_pitch_must_divide_the_cells():
    target = cells((2.0, 1.2, 0.45), (0.3, 0.4, 0.3), (2, 2, 2))
    with pytest.raises(SceneError, match=r"pitch of points must be .* divided by whole numbers"):
        close_up(CELL, SOURCE, np.zeros((6, *SOURCE.shape)), target, poisson_ratio=0.3)
