"""Fatigue criteria: the kit, faults planted in what it judges, closed forms, brute force."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eigencontact as ec
from eigencontact.core.paths import PathBounds, PlanePaths, half_sphere, smallest_balls, worst_planes
from eigencontact.plugin import DamageParameter, StressCycle, to_mandel
from eigencontact_plugins.fatigue import crossland, dang_van, findley, mcdiarmid
from eigencontact_verification.conformance import parametrize_with_checks
from planted import failing_checks

MPA = 1e6


def criterion(key, **parameters):
    return ec.make(key, kind="fatigue-criterion", **parameters)


CRITERIA = [
    criterion("crossland", slope=0.3, limit_amplitude="250 MPa"),
    criterion("dang-van", slope=0.3, limit_amplitude="250 MPa"),
    criterion("findley", slope=0.3, limit_amplitude="260 MPa"),
    criterion("findley", slope=0.0, limit_amplitude="260 MPa"),
    criterion("mcdiarmid", limit_amplitude="250 MPa", tensile_strength="900 MPa"),
    criterion("smith-watson-topper", limit_product="0.8 MPa"),
    criterion("fatemi-socie", slope=0.3, yield_stress="900 MPa", limit_strain_amplitude=4e-3),
    criterion("papadopoulos", slope=0.3, limit_amplitude="250 MPa"),
]


@parametrize_with_checks(CRITERIA)
def test_criteria_conform(component, check):
    check(component)


def cycle(components, poisson=0.3, young=1.0):
    """One point, from plain components (steps, 6)."""
    stress = to_mandel(np.asarray(components, dtype=float).T).T[:, :, None]
    strain = (1 + poisson) / young * stress
    strain[:, :3] -= poisson / young * stress[:, :3].sum(axis=1, keepdims=True)
    return StressCycle(stress=stress, strain=strain)


def value(key, components, **parameters):
    return float(criterion(key, **parameters).damage(cycle(components)).value[0])


TENSION = [[1, 0, 0, 0, 0, 0], [-1, 0, 0, 0, 0, 0]]
PULSATING = [[2, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]]
TORSION = [[0, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, -1]]
PHASE = 2 * np.pi * np.arange(24) / 24
APART = np.stack([np.cos(PHASE), *np.zeros((4, 24)), np.sin(PHASE)], axis=-1)


@pytest.mark.parametrize(
    ("key", "components", "expected"),
    [
        ("crossland", TENSION, 1 / 3**0.5 + 0.1),
        ("crossland", PULSATING, 1 / 3**0.5 + 0.2),
        ("crossland", TORSION, 1.0),
        ("crossland", APART, 1.1),  # the ball around the ellipse, not sqrt(4/3) of the box around it
        ("dang-van", TENSION, 0.6),
        ("dang-van", PULSATING, 0.7),
        ("dang-van", TORSION, 1.0),
        ("findley", TENSION, 0.67202),
        ("findley", TORSION, 1.04403),
    ],
)
def test_table_of_closed_forms(key, components, expected):
    assert abs(value(key, components, slope=0.3, limit_amplitude=1.0) / expected - 1) < 1e-5


def test_trailing_edge_of_a_fretting_cylinder():
    """Ti: sigma_xx = S at full load, -S at reversal, plane strain; numbers of a script that shares nothing."""
    S, nu, E, k = 1130.8, 0.3, 119e3, 0.3
    path = cycle([[S, nu * S, 0, 0, 0, 0], [-S, -nu * S, 0, 0, 0, 0]], nu, E)
    found = {
        key: float(criterion(key, **parameters).damage(path).value[0])
        for key, parameters in {
            "crossland": {"slope": 0.0, "limit_amplitude": 1.0},
            "smith-watson-topper": {"limit_product": 1.0},
            "findley": {"slope": k, "limit_amplitude": 1.0},
        }.items()
    }
    assert abs(found["crossland"] / 580.3 - 1) < 1e-4
    assert abs(found["smith-watson-topper"] / 9.7785 - 1) < 1e-4
    assert abs(found["findley"] / (S * (k + np.hypot(1, k)) / 2) - 1) < 1e-5


def test_the_plane_is_that_of_the_value():
    """Findley in tension: the normal lies at atan(k)/2 below 45 degrees from the axis."""
    normal = criterion("findley", slope=0.3, limit_amplitude=1.0).damage(cycle(TENSION)).normal[0]
    expected = np.degrees(0.5 * np.arctan(1 / 0.3))
    assert abs(np.degrees(np.arccos(abs(normal[0]))) - expected) < 0.1


@settings(max_examples=40, deadline=None)
@given(st.integers(2, 6), st.integers(1, 5), st.integers(0, 10**6), st.integers(0, 2))
def test_smallest_ball_is_that_of_brute_force(count, dim, seed, degenerate):
    points = np.random.default_rng(seed).normal(size=(count, dim))
    if degenerate and dim > 1:
        points[:, degenerate - 1 :] = 0.3  # on a line, or all alike
    centre, radius = smallest_balls(points[:, :, None])
    assert np.all(np.linalg.norm(points - centre[:, 0], axis=1) <= radius[0] * (1 + 1e-9) + 1e-14)
    assert abs(radius[0] - brute_force(points)) <= 1e-9 * radius[0] + 1e-14


def brute_force(points):
    """Smallest of the spheres through every subset that encloses all, by least squares."""
    best = np.inf
    for size in range(1, len(points) + 1):
        for rows in combinations(points, size):
            edges = np.array(rows[1:]).reshape(-1, points.shape[1]) - rows[0]
            offset = np.linalg.lstsq(edges, 0.5 * np.sum(edges**2, axis=1), rcond=None)[0] if size > 1 else 0 * rows[0]
            radius = np.linalg.norm(offset)
            if np.all(np.linalg.norm(points - rows[0] - offset, axis=1) <= radius * (1 + 1e-9) + 1e-14):
                best = min(best, radius)
    return best


@settings(max_examples=20, deadline=None)
@given(st.integers(1, 30), st.integers(0, 10**6))
def test_shear_circles_are_smallest_balls_of_the_traction(steps, seed):
    """The compiled circle of a plane against the ball, found in another way, around the shear traction in space."""
    rng = np.random.default_rng(seed)
    tensors = rng.normal(size=(steps, 3, 3))
    tensors += tensors.swapaxes(1, 2)
    normal = rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    traction = tensors @ normal
    shear = traction - (traction @ normal)[:, None] * normal
    plain = np.array([tensors[:, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))])
    planes = PlanePaths(to_mandel(plain).T[:, :, None])
    expected = smallest_balls(shear[:, :, None])[1][0]
    assert abs(planes.shear_amplitude(normal[None])[0, 0] - expected) <= 1e-9 * expected + 1e-14
    assert abs(planes.normal_maximum(normal[None])[0, 0] - (traction @ normal).max()) < 1e-12


def test_no_plane_of_a_dense_sweep_is_worse():
    rng = np.random.default_rng(2)
    phase = PHASE[:, None, None]
    first, second, third = rng.normal(size=(3, 6, 100))
    planes = PlanePaths(np.cos(phase) * first + np.sin(phase) * second + np.cos(2 * phase) * third)

    def findley_value(at):
        return planes.shear_amplitude(at) + 0.3 * planes.normal_maximum(at)

    largest, normal = worst_planes(findley_value)
    assert np.all(largest >= findley_value(half_sphere(np.radians(2.0))).max(axis=1) * (1 - 1e-3))
    np.testing.assert_allclose(findley_value(normal[:, None])[:, 0], largest, rtol=1e-12, atol=0)


@pytest.mark.parametrize("component", CRITERIA, ids=lambda item: item.key)
def test_order_of_steps_and_scale_do_not_matter(component):
    """All bundled criteria look at the set of states; they are of degree 1 in stress, that of a product of degree 2."""
    stress = 100 * MPA * np.random.default_rng(4).normal(size=(9, 6, 8))
    mixed = stress[np.random.default_rng(5).permutation(9)]

    def damage(path):
        return component.damage(StressCycle(stress=path, strain=path / 200e9)).value

    np.testing.assert_allclose(damage(mixed), damage(stress), rtol=1e-6, atol=0)
    degree = {"smith-watson-topper": 2, "fatemi-socie": None}.get(component.key, 1)
    if degree:
        np.testing.assert_allclose(damage(3.0 * stress), 3.0**degree * damage(stress), rtol=1e-6, atol=0)


def chord_ball(paths):
    steps = np.moveaxis(paths, 1, 0)
    size = np.linalg.norm(steps[:, :, None] - steps[:, None], axis=0) / 2
    return paths.mean(axis=0), size.max(axis=(0, 1))


def test_half_of_the_longest_chord_is_found(monkeypatch):
    """0.866 of the radius for three corners of a triangle: exactly the fault that fatigue tools have."""
    monkeypatch.setattr(crossland, "smallest_balls", chord_ball)
    assert failing_checks(CRITERIA[0]) == {"check_known_values"}


@pytest.mark.slow
def test_half_of_the_longest_chord_on_a_plane_is_found(monkeypatch):
    class Chord(PlanePaths):
        def shear_amplitude(self, normals):
            at = normals if normals.ndim == 3 else normals[None]
            xx, yy, zz, yz, xz, xy = np.moveaxis(self._paths, 1, 0)
            tensors = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1).reshape(*xx.shape, 3, 3)
            traction = np.einsum("ptij,pkj->pkti", tensors, np.broadcast_to(at, (len(xx), *at.shape[1:])))
            normal = np.sum(traction * at[:, :, None], axis=-1, keepdims=True)
            shear = traction - normal * at[:, :, None]
            return 0.5 * np.linalg.norm(shear[:, :, :, None] - shear[:, :, None], axis=-1).max(axis=(2, 3))

    monkeypatch.setattr(mcdiarmid, "PlanePaths", Chord)
    assert failing_checks(CRITERIA[4]) == {"check_known_values"}


def test_the_wrong_sign_of_the_mean_stress_is_found(monkeypatch):
    monkeypatch.setattr(StressCycle, "hydrostatic", property(lambda self: -self.stress[:, :3].sum(axis=1) / 3))
    assert {"check_tension", "check_known_values"} <= failing_checks(CRITERIA[0])


def test_a_missed_plane_is_found(monkeypatch):
    """A sweep without refinement misses the worst plane by a few degrees."""

    def swept(function):
        normals = half_sphere(np.radians(20.0))
        values = function(normals)
        return values.max(axis=1), normals[values.argmax(axis=1)]

    monkeypatch.setattr(findley, "worst_planes", swept)
    assert "check_turned_axes" in failing_checks(CRITERIA[2])


def test_the_centre_of_the_box_instead_of_the_ball_is_found(monkeypatch):
    """Axes of the stress components then matter."""

    def box(paths):
        high, low = paths.max(axis=0), paths.min(axis=0)
        return 0.5 * (high + low), 0.5 * np.linalg.norm(high - low, axis=0)

    monkeypatch.setattr(dang_van, "smallest_balls", box)
    assert "check_turned_axes" in failing_checks(CRITERIA[1])


def test_a_largest_value_over_points_is_found(monkeypatch):
    real = crossland.Crossland.damage

    def damage(self, path):
        return DamageParameter(np.full(path.points, real(self, path).value.max()))

    monkeypatch.setattr(crossland.Crossland, "damage", damage)
    assert "check_points_apart" in failing_checks(CRITERIA[0])


def test_a_bound_without_the_normal_stress_is_found(monkeypatch):
    bound = lambda self, cycle: PathBounds(cycle.stress).shear_amplitude()  # noqa: E731, ARG005
    monkeypatch.setattr(findley.Findley, "upper_bound", bound)
    assert failing_checks(CRITERIA[2]) == {"check_upper_bound"}


@pytest.mark.parametrize(
    ("key", "parameters", "words"),
    [
        ("crossland", {"slope": -0.1, "limit_amplitude": 1.0}, "crossland.slope must be zero or positive"),
        ("findley", {"slope": 0.3, "limit_amplitude": "0 MPa"}, "findley.limit_amplitude must be positive"),
        ("crosland", {"slope": 0.3}, "did you mean 'crossland'"),
        ("crossland", {"slope": 0.3, "limit": 1.0}, "crossland.*limit"),
    ],
)
def test_refusals_name_the_field(key, parameters, words):
    with pytest.raises(ec.EigencontactError, match=words):
        criterion(key, **parameters)
