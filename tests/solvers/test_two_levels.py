"""Two levels of cells: interpolation that keeps means, reciprocity, and the stress of cells that are all fine."""

import numpy as np
import pytest

from close import close
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.mean_stress import MeanVolumeField
from eigencontact.solvers.two_levels import TwoLevels, interpolation
from eigencontact_plugins.shapes.cuboid import Cuboid

CELL = Cuboid(center=(0.0, 0.0, 1.0), edges=(1.0, 1.0, 1.0))
SHAPE, FIRST, PART = (6, 7, 8), (0, 1, 2), (5, 5, 5)
INNER = (slice(0, 4), slice(1, 4), slice(1, 4))


def operator(edge, shape, first=(0, 0, 0), space="full"):
    """Of cubes; the first cell is counted along z, y, x from a corner on the surface."""
    at = [(n + 0.5) * edge for n in first][::-1]
    cells = Cells(first=tuple(at), pitch=(edge,) * 3, shape=shape)
    return MeanVolumeField(CELL, cells, cells, poisson_ratio=0.3, space=space)


def levels(ratio, space="full", shape=SHAPE):
    first, part = [n * ratio for n in FIRST], [n * ratio for n in PART]
    fine = operator(1.0 / ratio, tuple(part), first, space)
    return TwoLevels(operator(1.0, shape, space=space), operator(1.0, PART, FIRST, space), fine, INNER)


def split(both, coarse, fine):
    """Eigenstrain of coarse cells outside the rim's inside, and of fine cells within."""
    coarse, fine, r = coarse.copy(), fine.copy(), both.ratio
    coarse[:, *both.place][:, *INNER] = 0.0
    inside = np.zeros(fine.shape[1:], dtype=bool)
    inside[tuple(slice(s.start * r, s.stop * r) for s in INNER)] = True
    return coarse, fine * inside


def noise(seed, *shape):
    return np.random.default_rng(seed).standard_normal((6, *shape))


@pytest.mark.parametrize("ratio", [2, 3])
@pytest.mark.parametrize("count", [1, 2, 5, 7])
def test_interpolation_keeps_means_and_is_exact_for_polynomials(count, ratio):
    matrix = interpolation(count, ratio)
    np.testing.assert_allclose(matrix.reshape(count, ratio, count).mean(axis=1), np.eye(count), rtol=0, atol=1e-13)
    edges = np.linspace(0.0, count, count * ratio + 1)
    fine = np.diff(edges ** min(count, 5)) / np.diff(edges)
    coarse = fine.reshape(count, ratio).mean(axis=1)
    np.testing.assert_allclose(matrix @ coarse, fine, rtol=0, atol=1e-13 * fine.max())


def test_cells_as_fine_as_the_others_are_the_box_itself():
    both = levels(1, "half")
    coarse, fine = split(both, noise(0, *SHAPE), noise(1, *PART))
    total = coarse + both.spread(fine)
    expected = operator(1.0, SHAPE, space="half").apply(total)
    found = both.stress(coarse, fine)
    size = np.abs(expected).max()
    np.testing.assert_allclose(found[0], expected, rtol=0, atol=1e-12 * size)
    np.testing.assert_allclose(found[1], expected[:, *both.place], rtol=0, atol=1e-12 * size)


@pytest.mark.parametrize("ratio", [2, 3])
def test_the_two_levels_act_on_each_other_alike(ratio):
    """Work of the stress of one state on the eigenstrain of another, and the other way; and none is released."""
    both = levels(ratio)
    fine_shape = tuple(n * ratio for n in PART)
    states = [split(both, noise(seed, *SHAPE), noise(seed + 10, *fine_shape)) for seed in (0, 1)]

    def work(first, second):
        coarse, fine = both.stress(*first)
        return np.vdot(coarse, second[0]) + np.vdot(fine, second[1]) / ratio**3

    assert work(*states) == close(work(*states[::-1]), rel=1e-10)
    for state in states:
        assert work(state, state) < 0.0


def test_uniform_eigenstrain_of_coarse_cells_keeps_its_stress():
    """Fine cells that repeat coarse ones cause the same mean stress in every coarse cell as those."""
    both = levels(2)
    every = noise(3, *SHAPE)
    fine = every[:, *both.place].repeat(2, axis=1).repeat(2, axis=2).repeat(2, axis=3)
    expected = operator(1.0, SHAPE).apply(every)
    found = both.stress(*split(both, every, fine))
    outside = found[0].copy()
    both.put_means(outside, found[1])
    # Means over fine cells have more points in a coarse cell than its own: they agree to the accuracy of that rule.
    np.testing.assert_allclose(outside, expected, rtol=0, atol=0.03 * np.abs(expected).max())


def test_stress_comes_near_to_that_of_cells_that_are_all_fine():
    """An eigenstrain that coarse cells hardly resolve, one coarse cell or more from the rim."""
    ratio, shape = 2, (8, 9, 9)
    both = levels(ratio, "half", shape)
    whole = operator(0.5, tuple(n * ratio for n in shape), space="half")
    z, y, x = np.meshgrid(*((np.arange(n * ratio) + 0.5) / ratio for n in shape), indexing="ij")
    bump = np.exp(-((x - 4.6) ** 2 + (y - 3.4) ** 2 + (z - 2.2) ** 2) / 2.0)
    every = np.array([1.0, -0.5, 0.3, 0.7, 0.2, -0.4])[:, None, None, None] * bump
    truth = whole.apply(every)
    coarse = every.reshape(6, *(m for n in shape for m in (n, ratio))).mean(axis=(2, 4, 6))
    part = tuple(slice(s.start * ratio, s.stop * ratio) for s in both.place)
    inside = (slice(0, 6), slice(4, 6), slice(4, 6))
    found = both.stress(*split(both, coarse, every[:, *part]))[1][:, *inside]
    alone = both.interpolated(operator(1.0, shape, space="half").apply(coarse))[:, *inside]
    expected = truth[:, *part][:, *inside]
    error, before = (np.abs(values - expected).max() / np.abs(expected).max() for values in (found, alone))
    assert error < 0.01
    assert error < 0.2 * before
