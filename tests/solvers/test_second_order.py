"""The stencil from means over cells to values at their centres: exact for quadratics, symmetric, cut between laws."""

import numpy as np
import pytest

from eigencontact.solvers.second_order import centre_values, linked_faces

SHAPE = (4, 5, 6)
ALL = np.arange(120)


@pytest.fixture
def random():
    return np.random.default_rng(3)


def test_uniform_fields_and_sums_are_kept_to_the_bit_and_to_round_off(random):
    faces = linked_faces([ALL], SHAPE)
    assert np.array_equal(centre_values(np.full((6, *SHAPE), 0.3), faces), np.full((6, *SHAPE), 0.3))
    field = random.standard_normal((6, *SHAPE))
    np.testing.assert_allclose(centre_values(field, faces).sum(axis=(1, 2, 3)), field.sum(axis=(1, 2, 3)), rtol=1e-12)


def test_zeros_threads_and_order_of_memory_change_nothing(random):
    """A field that fills a part of the box is the sum of what its cells become alone, whoever computes it."""
    faces, field = linked_faces([ALL], SHAPE), np.zeros((2, *SHAPE))
    field[0, 1:3, 0:2, 4:] = random.standard_normal((2, 2, 2))
    alone = [centre_values(row.reshape(SHAPE), faces) for row in np.diag(field[0].ravel())]
    found = centre_values(field, faces, threads=2)
    np.testing.assert_allclose(found[0], np.sum(alone, axis=0), rtol=0.0, atol=1e-15)
    assert not found[1].any()
    turned = np.moveaxis(np.ascontiguousarray(np.moveaxis(field, 0, 1)), 1, 0)
    assert np.array_equal(centre_values(turned, faces), found)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_means_of_a_parabola_become_its_values(axis):
    ends = np.arange(SHAPE[axis] + 1.0) - 1.3
    line = np.diff(ends**3) / 3.0
    means = np.broadcast_to(line.reshape([-1 if n == axis else 1 for n in range(3)]), SHAPE)
    inside = np.moveaxis(centre_values(means, linked_faces([ALL], SHAPE)), axis, -1)[..., 1:-1]
    middles = 0.5 * (ends[1:] + ends[:-1])[1:-1]
    np.testing.assert_allclose(inside, np.broadcast_to(middles**2, inside.shape), rtol=0.0, atol=1e-14)


def test_the_map_is_symmetric_with_eigenvalues_from_one_to_one_and_a_half(random):
    groups = [ALL[random.random(120) < 0.7]]
    faces = linked_faces(groups, SHAPE)
    matrix = np.array([centre_values(unit.reshape(SHAPE), faces).ravel() for unit in np.eye(120)])
    np.testing.assert_allclose(matrix, matrix.T, rtol=0.0, atol=1e-15)
    values = np.linalg.eigvalsh(matrix)
    assert values.min() > 1.0 - 1e-12
    assert values.max() < 1.5


def test_no_link_leaves_a_group():
    """Groups that touch are apart, and so are cells of no group."""
    left, right = ALL.reshape(SHAPE)[:, :, :3].ravel(), ALL.reshape(SHAPE)[:, :, 3:5].ravel()
    along_z, along_y, along_x = linked_faces([left, right], SHAPE)
    assert along_x[:, :, [0, 1, 3]].all()
    assert not along_x[:, :, [2, 4]].any()
    assert along_z[:, :, :5].all()
    assert not along_y[:, :, 5].any()


def test_single_cells_have_no_faces():
    assert linked_faces([ALL[:1], ALL[1:2]], SHAPE) is None
    assert linked_faces([], SHAPE) is None
