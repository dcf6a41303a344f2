"""Hierarchical sums: expansions of points in a tree, levels of sources, and large clouds, against sums one by one."""

from itertools import product

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.errors import SceneError
from eigencontact.halfspace import cloud, expansions
from eigencontact.halfspace.cloud import field_of_cloud
from eigencontact.halfspace.expansions import Tree, distances_for
from eigencontact.halfspace.points import field_at_points

STRESS = {"poisson_ratio": 0.3, "quantity": "stress"}


def _biharmonic(points):
    """R and 1/R of a source 3.2 beside the origin, the farthest that a node of radius 1 takes by its expansion."""
    r = np.sqrt(((points - np.array([2.0, 1.5, -2.0])[:, None]) ** 2).sum(axis=0))
    return np.array([r, 1.0 / r])


def test_expansions_converge_at_their_rate_through_the_whole_tree():
    """What the root knows reaches all points; each two degrees gain the square of what a source is nearer by."""
    rng = np.random.default_rng(1)
    points = rng.normal(size=(3, 4000))
    points /= np.sqrt((points**2).sum(axis=0)).max()
    errors = []
    for degree in (4, 6, 8, 10):
        tree = Tree.over(points, degree)
        inside = np.ascontiguousarray(points[:, tree.order])
        at = tree.expansion_points
        values = np.zeros((at.shape[1], 2, at.shape[2]))
        values[0] = _biharmonic(at[:, 0])
        out = np.zeros((2, 4000))
        tree.add(inside, values, out, 1)
        errors.append(np.abs(out - _biharmonic(inside)).max())
    assert (tree.nodes[:, 4] > 0).sum() > 4  # expansions were passed down, and to points
    rates = np.diff(np.log(errors)) / 2.0
    assert np.all(rates < np.log(1 / 2.4))
    assert np.all(rates > np.log(1 / 6.0))
    assert errors[-1] < 1e-5


def test_a_tree_holds_every_point_once_in_balls_that_hold_theirs():
    points = np.concatenate([np.random.default_rng(2).normal(size=(3, 500)), np.ones((3, 200))], axis=1)
    tree = Tree.over(points, 3)
    assert np.array_equal(np.sort(tree.order), np.arange(700))
    leaves = np.flatnonzero(tree.children[:, 0] < 0)
    assert sum(stop - first for first, stop in tree.ranges[leaves]) == 700
    for (first, stop), node in zip(tree.ranges, tree.nodes, strict=True):
        away = np.linalg.norm(points[:, tree.order[first:stop]] - node[:3, None], axis=0)
        assert np.all(away <= node[3] * (1 + 1e-12))


@pytest.mark.parametrize("semi_axes", [(1.0, 0.7, 0.5), (1.0, 0.3, 0.1), (1.0, 0.2, 0.2)])
def test_levels_of_sources_do_from_the_distances_told(semi_axes):
    """From there on the field is that of the exact potentials to the tolerance, and for most not to a tenth of it."""
    shape, tolerance = ec.make("ellipsoid", center=(0.0, 0.0, 9.0), semi_axes=semi_axes), 1e-5
    directions = np.random.default_rng(3).normal(size=(3, 200))
    directions /= np.linalg.norm(directions, axis=0)
    strain = np.array([1.0, -0.5, 0.3, 0.2, 0.7, -0.4])
    errors = []
    far = shape.far_field()
    for level, distance in zip(far.levels, distances_for(far, tolerance), strict=True):
        x, y, z = directions * distance + level.center[:, None]
        sources = cloud._Sources([cloud.replace(level, distance=0.0, coarser=None)], strain[None])
        found = cloud._sum_of_sources(sources, (x, y, z), space="full", threads=1, **STRESS)
        exact = field_at_points(shape, strain, (x, y, z), space="full", **STRESS)
        errors.append(np.abs(found - exact).max() * distance**3 / (far.volumes.sum() * np.linalg.norm(strain)))
    assert max(errors) < tolerance
    assert max(errors) > 0.01 * tolerance


def _cloud(count, points):
    """Ellipsoids and spheres below the surface, some of them close to it, and scattered points."""
    rng = np.random.default_rng(4)
    centers = rng.uniform(0, 1, (count, 3)) * [10.0, 10.0, 4.0] + [0.0, 0.0, 0.55]
    shapes = [
        ec.make("ellipsoid", center=tuple(center), semi_axes=(0.5, 0.3, 0.2))
        if number % 4 == 0
        else ec.make("sphere", center=tuple(center), radius=0.3)
        for number, center in enumerate(centers.tolist())
    ]
    at = rng.uniform(0, 1, (3, points)) * np.array([[10.0], [10.0], [6.0]])
    at[2, ::50] = 0.0
    return shapes, rng.normal(size=(count, 6)), tuple(at)


#: Tolerance, least work of an expansion, quantity and space; each value of each occurs in the default suite.
CLOUDS = list(product([(1e-3, 0), (1e-6, 0), (1e-6, 10**6)], ["displacement", "stress"], ["half", "full"]))
QUICK = [((1e-3, 0), "stress", "full"), ((1e-6, 10**6), "displacement", "half")]


@pytest.mark.parametrize(
    ("kind", "quantity", "space"),
    [*QUICK, *(pytest.param(*case, marks=pytest.mark.slow) for case in CLOUDS if case not in QUICK)],
)
def test_large_clouds_are_summed_to_the_tolerance(monkeypatch, kind, quantity, space):
    """By expansions, and by regions of few sources alone."""
    tolerance, worth = kind
    monkeypatch.setattr(cloud, "_MIN_SOURCES", worth)
    shapes, strains, points = _cloud(60, 34_000)
    given = {"poisson_ratio": 0.3, "quantity": quantity, "space": space}
    found = field_of_cloud(shapes, strains, points, tolerance=tolerance, **given)
    some = np.random.default_rng(5).choice(points[0].size, 300, replace=False)
    at = tuple(values[some] for values in points)
    wanted = sum(field_at_points(shape, strain, at, **given) for shape, strain in zip(shapes, strains, strict=True))
    error = np.abs(found[:, some] - wanted).max()
    assert 1e-14 * np.abs(wanted).max() < error < tolerance * np.abs(found).max()


@pytest.mark.slow
def test_a_sum_that_is_not_good_enough_is_taken_again(monkeypatch):
    shapes, strains, points = _cloud(60, 34_000)
    degrees = []
    monkeypatch.setattr(cloud, "_MIN_SOURCES", 0)

    def too_low(tolerance):
        degrees.append(expansions.degree_for(tolerance) if degrees else 2)
        return degrees[-1]

    monkeypatch.setattr(cloud, "degree_for", too_low)
    found = field_of_cloud(shapes, strains, points, tolerance=1e-6, **STRESS)
    exact = field_of_cloud(shapes, strains, points, **STRESS)
    assert len(degrees) == 2
    assert np.abs(found - exact).max() < 1e-6 * np.abs(exact).max()


def test_small_clouds_are_summed_to_round_off():
    shapes, strains, points = _cloud(12, 500)
    exact = field_of_cloud(shapes, strains, points, **STRESS)
    assert np.array_equal(field_of_cloud(shapes, strains, points, tolerance=1e-3, **STRESS), exact)


@pytest.mark.parametrize("tolerance", [-1.0, 0.1, float("nan"), "small"])
def test_a_tolerance_is_a_small_number(tolerance):
    ball = ec.make("sphere", center=(0.0, 0.0, 2.0), radius=1.0)
    with pytest.raises(SceneError, match="tolerance"):
        ec.inclusion_field(ball, np.eye(3), [[0, 0, 0]], young_modulus=1.0, poisson_ratio=0.3, tolerance=tolerance)
