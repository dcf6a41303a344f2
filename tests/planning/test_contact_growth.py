"""Increments that are even in the contact radius: of closed forms, of what is refused, and what a run makes of them."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.execution.run.loading import LoadHistory
from eigencontact.scene.steps import Step
from eigencontact.solvers.contact_estimate import ContactEstimate
from eigencontact.solvers.contact_growth import contact_growth
from eigencontact.solvers.control import Control

A = 10e-6
#: Gaps that rise from one place, and the powers of the radius with which approach and load grow.
RISING = {
    "paraboloid": (lambda x, y: (x**2 + y**2) / 2, 2, 3),
    "beside the middle": (lambda x, y: (x - 3e-7) ** 2 + (y + 1.7e-7) ** 2, 2, 3),
    "ellipse": (lambda x, y: x**2 + 4 * y**2 + x * y, 2, 3),
    "cone": (np.hypot, 1, 2),
    "quartic": (lambda x, y: 1e10 * (x**2 + y**2) ** 2, 4, 5),
}


@pytest.mark.parametrize("name", RISING)
def test_approach_and_load_are_powers_of_the_radius(name):
    gap, approach, load = RISING[name]
    growth = contact_growth(gap, ContactEstimate(-A, A, -A, A), Control(normal_load=2.0))
    share = np.arange(1, 6) / 5
    assert growth.parts("normal_load", 0.0, 2.0, 5) == close(share**load, rel=1e-4)
    assert growth.parts("approach", 0.0, growth.approach[-1], 5) == close(share**approach, rel=1e-4)
    assert growth.normal_load[-1] == 2.0


def test_a_cone_and_a_paraboloid_approach_as_sneddon_says():
    for gap, expected in ((np.hypot, np.pi / 2 * A), (lambda x, y: x**2 + y**2, 2 * A**2)):
        growth = contact_growth(gap, ContactEstimate(-A, A, -A, A), Control(approach=1.0))
        assert growth.approach[-1] == close(expected, rel=1e-6)


def test_a_ramp_between_loads_and_back_to_nothing_is_even_in_the_radius():
    growth = contact_growth(RISING["paraboloid"][0], ContactEstimate(-A, A, -A, A), Control(normal_load=8.0))
    assert growth.parts("normal_load", 1.0, 8.0, 2) == close([(1.5**3 - 1) / 7, 1.0], rel=1e-4)
    assert growth.parts("normal_load", 8.0, 0.0, 2) == close([7 / 8, 1.0], rel=1e-4)
    assert growth.parts("normal_load", 8.0, 8.0, 4) == close([0.25, 0.5, 0.75, 1.0], rel=1e-12)


def test_a_punch_begins_at_the_radius_of_its_flat():
    """Of a flat of radius b: even steps between b and a, so none lies below the load at which the rounding touches."""
    box = ContactEstimate(-A, A, -A, A)
    growth = contact_growth(lambda x, y: np.maximum(np.hypot(x, y) - A / 2, 0.0) ** 2, box, Control(normal_load=1.0))
    parts = growth.parts("normal_load", 0.0, 1.0, 4)
    radii = np.interp(parts, growth.normal_load, growth.radius)
    assert radii == close(A * np.array([0.625, 0.75, 0.875, 1.0]), rel=0.03)


@pytest.mark.parametrize(
    "gap",
    [lambda x, y: (np.hypot(x, y) - A / 2) ** 2, lambda x, y: np.sin(6 * x / A) ** 2 + y**2, lambda x, y: 0 * x * y],
    ids=["ring", "waves", "flat"],
)
def test_contacts_without_one_radius_have_no_growth(gap):
    assert contact_growth(gap, ContactEstimate(-A, A, -A, A), Control(normal_load=1.0)) is None


def small(*changes, scene="fretting-mode-2"):
    return ec.load_scene(
        scene, ["grid.cells-per-contact-radius=10", "steps.increments=5", "output.pictures=false", *changes]
    )


def test_the_first_loading_with_friction_grows_evenly_and_others_do_not():
    radius, even, alone = (
        ec.run(made).dataset.contact_radius.values
        for made in (
            small(),
            small("steps.spacing=even"),
            ec.load_scene("hertz", ["grid.cells-per-contact-radius=10", "steps.increments=5", "stress=[]"]),
        )
    )
    assert radius / radius[-1] == close(np.arange(1, 6) / 5, abs=0.04)
    for found in (even, alone):
        assert found / found[-1] == close((np.arange(1, 6) / 5) ** (1 / 3), abs=0.04)


def test_an_approach_grows_with_the_square_of_the_radius_and_a_frictionless_step_as_told():
    changes = ["grid.cells-per-contact-radius=10", "stress=[]"]
    steps = "steps=[{approach='1 um', increments=4, spacing='radius'}, {approach=0.0, increments=2}]"
    data = ec.run(ec.load_scene("hertz", [*changes, steps])).dataset
    assert data.approach.values == close(1e-6 * np.array([1 / 16, 1 / 4, 9 / 16, 1, 0.5, 0]), rel=1e-4, abs=1e-15)
    assert data.time.values == close([1 / 16, 1 / 4, 9 / 16, 1, 1.5, 2], rel=1e-4)


def test_what_slides_within_a_step_slides_in_parts_of_it():
    steps = [Step(normal_load=1.0, increments=2, spacing="radius", sliding_distance=8.0)]
    growth = contact_growth(RISING["paraboloid"][0], ContactEstimate(-A, A, -A, A), Control(normal_load=1.0))
    history, point, found = LoadHistory(steps, friction=False, growth=growth), None, []
    while (after := history.after(point)) is not None:
        found.append(history.slide(after, point).distance)
        point = after
    assert found == close([1.0, 7.0], rel=1e-4)


LOADING, UNLOADING = Step(normal_load=8.0, increments=4), Step(normal_load=0.0, increments=2)
#: The same path written in several ways, and the increments that end with the loading.
PATHS = {
    "again": [LOADING, UNLOADING, LOADING],
    "in a cycle": [Step(normal_load=0.0), Step(cycle=[LOADING, UNLOADING], repeat=3)],
    "in a cycle that starts loaded": [LOADING, Step(cycle=[UNLOADING, LOADING], repeat=3)],
    "with a shift that rests": [
        LOADING, Step(shift_x=1e-6), UNLOADING, LOADING.model_copy(update={"shift_x": 1e-6, "increments": 4}),
    ],
    "after an approach": [Step(approach=1e-6), Step(approach=-1e-6), LOADING],
}  # fmt: skip


def increments(steps, growth):
    """Where each ramp of several increments is cut, as parts of it, by its start and end load."""
    history, point, cuts = LoadHistory(steps, friction=True, growth=growth), None, []
    while (point := history.after(point)) is not None:
        if point.number == 1:
            cuts.append((history.ramp(point).normal_load, []))
        cuts[-1][1].append(point.fraction)
    return cuts


@pytest.mark.parametrize("path", PATHS)
def test_a_ramp_is_cut_by_its_path_however_a_scene_writes_it(path):
    growth = contact_growth(RISING["paraboloid"][0], ContactEstimate(-A, A, -A, A), Control(normal_load=8.0))
    loadings = [parts for load, parts in increments(PATHS[path], growth) if load == 8.0 and len(parts) > 1]
    assert len(loadings) == {"again": 2, "in a cycle": 3, "in a cycle that starts loaded": 4}.get(path, len(loadings))
    assert loadings
    for parts in loadings:
        assert parts == close((np.arange(1, 5) / 4) ** 3, rel=1e-4)
    assert all(parts == [0.5, 1.0] for load, parts in increments(PATHS[path], growth) if load == 0.0 and len(parts) > 1)


def test_a_ramp_from_above_the_surface_is_even_in_the_radius_once_it_touches():
    growth = contact_growth(RISING["paraboloid"][0], ContactEstimate(-A, A, -A, A), Control(approach=1.0))
    end = float(growth.approach[-1])
    assert growth.parts("approach", -end, end, 2) == close([0.5 + 0.5 / 4, 1.0], rel=1e-4)


def test_a_motion_along_the_surface_keeps_increments_even():
    growth = contact_growth(RISING["paraboloid"][0], ContactEstimate(-A, A, -A, A), Control(normal_load=8.0))
    moved = [LOADING, UNLOADING, LOADING.model_copy(update={"shift_x": 1e-6})]
    assert increments(moved, growth)[-1][1] == [0.25, 0.5, 0.75, 1.0]


def test_loading_again_after_the_contact_is_lost_is_the_first_loading_again():
    """Dissimilar bodies, coupled in full: pressure, shear and stick follow from the increments of the loading."""
    steps = "[{normal-load=12.307, increments=4}, {normal-load=0}, {normal-load=12.307, increments=4}]"
    data = ec.run(small(f"steps={steps}", "grid.cells-per-contact-radius=8")).dataset
    first, again = data.isel(step=3), data.isel(step=-1)
    assert float(abs(first.shear_x).max()) > 0.05 * float(first.max_pressure)
    for name in ("pressure", "shear_x", "shear_y"):
        assert np.abs(again[name] - first[name]).max() < 1e-6 * float(first.max_pressure)
    assert float(again.stick_radius) == close(float(first.stick_radius), rel=1e-9)


def test_explain_says_what_is_even_in_the_radius():
    assert "5 steps, 5 of them even in the contact radius" in ec.plan(small()).explain()
    assert "even in the contact radius" not in ec.plan(small("steps.spacing=even")).explain()
    rough = ec.plan("rough-surface-friction")
    assert rough.growth is None


REFUSED = {
    "no load": (
        ["steps=[{normal-load=1, increments=2}, {shift-x=1e-8, increments=3, spacing='radius'}]"],
        r"steps.1.spacing must be 'even' unless this step and the previous step both prescribe .*with neither",
    ),
    "another control": (
        ["steps=[{normal-load=1}, {approach=1e-8, increments=3, spacing='radius'}]"],
        r"steps.1.spacing .*got 'radius' with approach after normal-load",
    ),
    "a cycle that ends with another control": (
        ["steps=[{normal-load=1}, {cycle=[{normal-load=2, increments=3, spacing='radius'}, {approach=0}], repeat=2}]"],
        r"steps.1.cycle.0.spacing .*got 'radius' with normal-load after approach",
    ),
    "a word": (["steps.spacing=area"], r"steps\.0\.spacing must be one of 'radius' or 'even'"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_refused(case):
    changes, words = REFUSED[case]
    with pytest.raises(ec.EigencontactError, match=words):
        ec.load_scene("fretting-mode-2", changes)


def test_a_contact_without_one_radius_is_refused_where_the_radius_is_asked_for():
    with pytest.raises(ec.EigencontactError, match=r"steps.1.spacing must be 'even' unless the gap rises on all sides"):
        ec.plan(ec.load_scene("rough-surface", ["steps.1.spacing=radius", "steps.1.increments=2"]))


def test_explain_counts_the_loadings_of_cycles():
    steps = "[{normal-load=12.307}, {cycle=[{normal-load=0}, {normal-load=12.307, increments=4}], repeat=3}]"
    assert "16 steps, 12 of them even in the contact radius" in ec.plan(small(f"steps={steps}")).explain()
