"""Cells that a boundary cuts carry the mean of what their parts remember."""

from types import SimpleNamespace

import numpy as np

from close import close
from eigencontact_verification.audit.shares import mean_of_parts
from eigencontact_verification.fem.loaded_body import Cells


def half_space(depth, remembers, averaged=()):
    """Source below a depth."""
    law = SimpleNamespace(variables={"plastic_strain": None} if remembers else {}, averaged=averaged)
    return SimpleNamespace(law=law, shape=SimpleNamespace(contains=lambda x, y, z: z > depth + 0 * x * y))


def cells(strain=2e-3, stiffness_factor=None):
    """Two cells by two, four layers of height 1, of one strain."""
    return Cells(
        x=np.arange(3.0),
        y=np.arange(3.0),
        z=np.arange(5.0),
        eigenstrain=np.full((3, 3, 4, 2, 2), strain),
        stiffness_factor=stiffness_factor,
    )


def layers(block):
    return block.eigenstrain[0, 0, :, 0, 0]


def test_an_elastic_part_has_no_strain():
    found = mean_of_parts(cells(), None, [half_space(2.5, remembers=False)], own_law=True)
    np.testing.assert_allclose(layers(found), [2e-3, 2e-3, 1e-3, 2e-3], rtol=1e-12)


def test_the_other_part_counts_with_its_own_share():
    """Two thirds of a layer are of the body, its larger part."""
    beside = np.full((3, 3, 4, 2, 2), 6e-3)
    found = mean_of_parts(cells(), beside, [half_space(2 + 2 / 3, remembers=True)], own_law=True)
    np.testing.assert_allclose(layers(found), [2e-3, 2e-3, (2 * 2e-3 + 6e-3) / 3, 2e-3], rtol=1e-12)


def test_slivers_belong_to_the_rest_of_their_cell():
    found = mean_of_parts(cells(), None, [half_space(2.01, remembers=True)], own_law=False)
    np.testing.assert_array_equal(layers(found), 2e-3)


def test_damage_is_shared_too():
    damaged = cells(stiffness_factor=np.full((4, 2, 2), 0.6))
    found = mean_of_parts(damaged, None, [half_space(2.5, remembers=True)], own_law=False)
    assert found.stiffness_factor[2, 0, 0] == close(0.8)
    assert found.stiffness_factor[3, 0, 0] == close(0.6)


def test_laws_of_a_neighbourhood_have_whole_cells():
    block = cells()
    assert mean_of_parts(block, None, [half_space(2.5, remembers=True, averaged={"x": 1.0})], own_law=True) is block
