"""Search of the largest damage parameter by upper bounds: the same point and value as at all points."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eigencontact as ec
from eigencontact.core.paths import PathBounds, PlanePaths, half_sphere, smallest_balls
from eigencontact.errors import PluginError
from eigencontact.execution.fields.critical_distance import value_near
from eigencontact.execution.fields.largest_damage import largest_first, utilisation_of
from eigencontact.execution.fields.stress_cycle import CycleOfRegion, elastic_strain
from eigencontact.plugin import DamageParameter, StressCycle
from eigencontact.scene.fatigue import CriticalDistance
from eigencontact_verification.benchmarks.fatigue import CRITERIA
from plugins.test_fatigue_criteria import criterion

ALL = [criterion(key, **table) for key, table in CRITERIA.items()]


@st.composite
def cycles(draw):
    """Paths at points: of full or small rank, of plane strain or not, about a mean, of one size or decaying."""
    steps, points, rank = draw(st.integers(1, 20)), draw(st.integers(1, 300)), draw(st.integers(1, 6))
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    stress = np.einsum("tkp,kip->tip", rng.normal(size=(steps, rank, points)), rng.normal(size=(rank, 6, points)))
    stress += draw(st.sampled_from([0.0, 0.5, 3.0])) * rng.normal(size=(1, 6, points))
    if draw(st.booleans()):  # a line contact
        stress[:, 3] = stress[:, 5] = 0.0
        stress[:, 1] = 0.3 * (stress[:, 0] + stress[:, 2])
    stress *= 1e8 * np.exp(-draw(st.sampled_from([0.0, 0.01, 0.5])) * np.arange(points))
    return StressCycle(stress=stress, strain=elastic_strain(stress, 200e9, 0.3))


@pytest.mark.parametrize("component", ALL, ids=lambda item: item.key)
@settings(max_examples=40, deadline=None)
@given(cycle=cycles())
def test_largest_value_and_its_point_are_those_of_all_points(component, cycle):
    everywhere = component.damage(cycle).value
    searched = largest_first(component, cycle.at, cycle.points)
    assert searched.argmax() == everywhere.argmax()
    assert abs(searched.max() - everywhere.max()) <= 1e-9 * abs(everywhere.max())


@settings(max_examples=60, deadline=None)
@given(cycle=cycles())
def test_bounds_hold_on_every_plane(cycle):
    planes, bounds, sweep = PlanePaths(cycle.stress), PathBounds(cycle.stress), half_sphere(np.radians(15.0))
    room = 1e-12 * np.abs(cycle.stress).max(axis=(0, 1))
    assert np.all(planes.shear_amplitude(sweep).max(axis=1) <= bounds.shear_amplitude() + room)
    assert np.all(planes.normal_maximum(sweep).max(axis=1) <= bounds.normal_maximum() + room)
    assert np.all(planes.normal_amplitude(sweep).max(axis=1) <= bounds.normal_amplitude() + room)
    radii = smallest_balls(cycle.deviator)[1]
    assert np.all(radii <= bounds.deviator_radius() + room)
    assert np.all(radii <= bounds.deviator_widths() + room)


@pytest.mark.parametrize("mean", [0.0, 1e9, -1e9])
def test_bounds_of_many_points_are_larger_by_a_sixth_at_most(mean):
    """By J2 alone: at least those by eigenvalues; the root of J2 is at most 2 / sqrt 3 of the largest shear."""
    stress = 1e8 * np.random.default_rng(6).normal(size=(9, 6, 3000))
    stress[:, :3] += mean
    many, parts = PathBounds(stress), [PathBounds(stress[..., start : start + 500]) for start in range(0, 3000, 500)]
    for name in ("shear_amplitude", "normal_maximum", "normal_amplitude"):
        loose, close_bounds = getattr(many, name)(), np.concatenate([getattr(part, name)() for part in parts])
        assert np.all(loose >= close_bounds - 1e-6 * np.abs(close_bounds))
        assert np.any(loose > 1.001 * close_bounds) or mean
    shear = np.concatenate([part.shear_amplitude() for part in parts])
    assert np.all(many.shear_amplitude() <= 2 / 3**0.5 * 1.000001 * shear)


@pytest.mark.parametrize("component", ALL, ids=lambda item: item.key)
def test_largest_of_many_random_points(component):
    stress = 1e8 * np.random.default_rng(7).normal(size=(5, 6, 1500))
    cycle = StressCycle(stress=stress, strain=elastic_strain(stress, 200e9, 0.3))
    everywhere = component.damage(cycle).value
    searched = largest_first(component, cycle.at, cycle.points)
    assert (searched.argmax(), searched.max()) == (everywhere.argmax(), everywhere.max())


def test_bounds_are_near_the_largest_point_and_exact_for_a_line():
    """Uniaxial tension between -1 and 1: shear amplitude 1/2, normal stress 1, radius and widths sqrt(2/3)."""
    tension = np.zeros((2, 6, 1))
    tension[:, 0] = [[1.0], [-1.0]]
    bounds = PathBounds(tension)
    names = ("shear_amplitude", "normal_maximum", "normal_amplitude", "deviator_radius", "deviator_widths")
    values = [float(getattr(bounds, name)()[0]) for name in names]
    np.testing.assert_allclose(values, [0.5, 1.0, 1.0, (2 / 3) ** 0.5, (2 / 3) ** 0.5], rtol=1e-6)


def counted(component, calls):
    """The criterion, noting the points at which it is evaluated."""

    class Counted(type(component)):
        def damage(self, cycle):
            calls.append(cycle.points)
            return super().damage(cycle)

    return Counted(**{name: getattr(component, name) for name in CRITERIA[component.key]})


@pytest.mark.parametrize("component", ALL, ids=lambda item: item.key)
def test_few_points_are_evaluated(component):
    """A stress that falls from point to point, like below the edge of a contact."""
    phase = 2 * np.pi * np.arange(24)[:, None] / 24
    stress = np.zeros((24, 6, 4000))
    stress[:, 0] = 1e8 * (np.cos(phase) + 0.2) * np.exp(-np.arange(4000) / 400)
    stress[:, 4] = 4e7 * np.sin(phase) * np.exp(-np.arange(4000) / 400)
    cycle, calls = StressCycle(stress=stress, strain=elastic_strain(stress, 200e9, 0.3)), []
    value = largest_first(counted(component, calls), cycle.at, cycle.points, threads=2)
    assert value.argmax() == 0
    assert sum(calls) < 400
    assert np.isneginf(value).sum() == 4000 - sum(calls)


def test_a_bound_that_is_too_small_is_refused():
    class Small(type(ALL[2])):
        def upper_bound(self, cycle):
            return 0.9 * self.damage(cycle).value

    stress = np.random.default_rng(1).normal(size=(5, 6, 50))
    cycle = StressCycle(stress=stress)
    with pytest.raises(PluginError, match="upper_bound of fatigue criterion 'findley' must be at least the damage"):
        largest_first(Small(**CRITERIA["findley"]), cycle.at, cycle.points)


def test_a_criterion_without_bounds_is_evaluated_everywhere():
    class Plain:
        key, limit = "plain", 1.0

        def damage(self, cycle):
            return DamageParameter(cycle.stress[:, 0].max(axis=0))

    stress = np.random.default_rng(1).normal(size=(5, 6, 50))
    value = largest_first(Plain(), StressCycle(stress=stress).at, 50)
    np.testing.assert_array_equal(value, stress[:, 0].max(axis=0))


@pytest.mark.parametrize(
    ("dims", "shape", "near"),
    [
        ("zx", (9, 20), {}),
        ("zx", (9, 20), {"distance": 1.0}),
        ("zyx", (9, 7, 6), {"distance": 1.0, "method": "line"}),
        ("zyx", (9, 7, 6), {"distance": 0.4, "method": "volume"}),
    ],
)
def test_utilisation_is_that_of_all_points(dims, shape, near):
    places = np.zeros((3, *shape))
    axes = [np.linspace(0.0 if name == "z" else -2.0, 4.0, n) for name, n in zip(dims, shape, strict=True)]
    for name, values in zip(dims, np.meshgrid(*axes, indexing="ij"), strict=True):
        places["xyz".index(name)] = values
    x, y, z = places = places.reshape(3, -1)
    size = np.exp(-z - (x - 1.0) ** 2 - (y - 1.0) ** 2)
    cycle = StressCycle(stress=1e8 * np.random.default_rng(3).normal(size=(6, 6, 1)) * size)
    section = CycleOfRegion(
        region="r", body=1, dims=tuple(f"r_{name}" for name in dims), shape=shape, places=places, steps=(1, 6),
        at=cycle.at,
    )  # fmt: skip
    chosen, damage = CriticalDistance.of(**near), ALL[2].damage(cycle).value
    expected = value_near(section, damage, chosen.distance, chosen.method) if near else damage.max()
    assert abs(utilisation_of(ALL[2], section, chosen) * ALL[2].limit / expected - 1.0) < 1e-12


@pytest.mark.slow
def test_map_has_the_utilisation_of_fatigue():
    """Each variant of a line contact against all points of a run of its own, with and without distance."""
    few = ["grid.cells-per-contact-radius=16", "steps.1.increments=2", "steps.2.increments=3", "steps.3.increments=3"]
    scene = ec.load_scene("cylinder-fretting", [*few, "stress.0.depth-cells=20", "output.pictures=false"])
    for key in ("findley", "smith-watson-topper"):
        table = {"type": key, **{name.replace("_", "-"): value for name, value in CRITERIA[key].items()}}
        for near in ({}, {"distance": "40 um", "method": "line"}):
            answer = ec.fretting_map(scene, load=["400 N/mm"], amplitude=["192 N/mm"], criterion={**table, **near})
            summary = ec.fatigue(ec.run(scene), table, **near).summary
            expected = summary["at_distance" if near else "utilisation"]
            assert abs(float(answer.dataset["utilisation"][0, 0]) / expected - 1.0) < 1e-12
