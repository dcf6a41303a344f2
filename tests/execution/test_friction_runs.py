"""Runs of contacts with friction: loads that are held, steps handed on, cut and resumed, zones, stress, everything."""

from math import pi

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL
from close import close
from eigencontact.core.quantities import QUANTITIES
from eigencontact.errors import NotConverged, ResultsError
from eigencontact.execution.run.loading import control_at, start_of_ramp, tangential_control_at
from eigencontact.reference.numbers import known_numbers
from eigencontact.scene.holding import held_steps
from eigencontact.scene.schema import Step
from eigencontact.solvers.tangential.contact import FrictionalContact
from eigencontact_plugins.friction.coulomb import Coulomb
from stopping import Stop, Stopper

RADIUS, LOAD, MU = 200e-6, 12.307, 0.5
#: Hertz, HZ-2 of the case catalogue: contact radius [m], peak pressure [Pa].
A, P0 = 20.0e-6, 14.691e9
#: Shift at which a ball on steel slides, 3 mu P (2 - nu)/(16 G a) [m].
SLIDES = 3 * MU * LOAD * 1.7 * 2.6 / (16 * 210e9 * A)


def scene(steps, *, cells=20, width=56e-6, coupling="partial", mu=MU, numerics=None, **more):
    return ec.Scene(
        **{
            "body1": STEEL,
            "geometry": {"type": "sphere", "radius": RADIUS},
            "friction": {"type": "coulomb", "coefficient": mu},
            "grid": {"cells": cells, "size": [width, width]},
            "steps": steps,
            "numerics": {"coupling": coupling, "threads": 1, **(numerics or {})},
            "output": {"pictures": False},
            **more,
        }
    )


# ---------------------------------------------------------------- controls


HISTORY = [
    Step(normal_load=4.0),
    Step(shift_x=2.0, increments=2),
    Step(tangential_load_y=1.0, increments=4),
    Step(tangential_load_x=3.0, twist=0.5, increments=2),
    Step(normal_load=2.0, increments=2),
]


@pytest.mark.parametrize(
    ("ramp", "fraction", "solved", "normal", "along"),
    [
        (0, 1.0, {}, 4.0, {}),
        (1, 0.5, {"normal_load": 4.001}, 4.0, {"shift_x": 1.0}),
        (2, 0.25, {"shift_x": 2.0, "tangential_load_y": 0.0}, 4.0, {"shift_x": 2.0, "tangential_load_y": 0.25}),
        # the kind changes: from the load that the shift had come to
        (
            3,
            0.5,
            {"shift_x": 2.0, "tangential_load_x": 1.0, "tangential_load_y": 1.0001},
            4.0,
            {"tangential_load_x": 2.0, "tangential_load_y": 1.0, "twist": 0.25},
        ),
        (
            4,
            0.5,
            {"tangential_load_x": 3.0001, "tangential_load_y": 0.9999, "twist": 0.5, "normal_load": 4.001},
            3.0,
            {"tangential_load_x": 3.0, "tangential_load_y": 1.0, "twist": 0.5},
        ),
    ],
)
def test_what_a_step_does_not_mention_stays_as_it_was_prescribed(ramp, fraction, solved, normal, along):
    steps = held_steps(scene(HISTORY).ramps)
    before = start_of_ramp(solved, steps[ramp - 1] if ramp else None)
    assert control_at(steps[ramp], fraction, before).normal_load == normal
    control = tangential_control_at(steps[ramp], fraction, before)
    names = ("shift_x", "tangential_load_x", "shift_y", "tangential_load_y", "twist", "torsion_moment")
    assert {name: getattr(control, name) for name in names if getattr(control, name) is not None} == along


def test_a_run_follows_its_history():
    steps = [
        {"normal_load": LOAD},
        {"shift_x": 2e-7},
        {"tangential_load_y": 1.0, "increments": 2},
        {"tangential_load_x": 0.0, "twist": 2e-3},
        {"normal_load": 0.8 * LOAD},
    ]
    data = ec.run(scene(steps)).dataset
    np.testing.assert_allclose(data.normal_load, LOAD * np.array([1, 1, 1, 1, 1, 0.8]), rtol=1e-9)
    np.testing.assert_allclose(data.shift_x[:4], [0.0, 2e-7, 2e-7, 2e-7], rtol=1e-12, atol=1e-20)
    np.testing.assert_allclose(data.tangential_load_y, [0.0, 0.0, 0.5, 1.0, 1.0, 1.0], rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(data.tangential_load_x[4:], 0.0, atol=1e-5)
    np.testing.assert_allclose(data.twist, [0.0, 0.0, 0.0, 0.0, 2e-3, 2e-3], rtol=1e-12, atol=1e-20)
    assert float(data.tangential_load_x[1]) > 1.0
    assert float(data.shift_x[4]) != close(2e-7, rel=0.1)


# ---------------------------------------------------------------- one contact, its fields and numbers


@pytest.fixture(scope="module")
def pulled():
    """Cattaneo and Mindlin, half of what friction carries, with 16 cells per contact radius (CM-1)."""
    steps = [{"normal_load": LOAD}, {"tangential_load_x": 0.5 * MU * LOAD}]
    return ec.run(scene(steps, cells=40, width=50e-6, coupling="none"))


def test_cattaneo_and_mindlin(pulled):
    """Stick radius, shift and traction in closed form (K. L. Johnson 1985, eqs 7.30, 7.34, 7.43)."""
    summary, data = pulled.summary, pulled.dataset
    c = 0.5 ** (1 / 3) * A
    assert abs(summary["stick_radius"] - c) < 0.1 * 50e-6 / 40
    assert summary["slip_fraction"] == close(1 - (c / A) ** 2, abs=0.02)
    assert summary["shift_magnitude"] == close(SLIDES * (1 - 0.5 ** (2 / 3)), rel=3e-3)
    assert summary["tangential_load"] == close(0.5 * MU * LOAD, rel=1e-6)
    r = np.hypot(*np.meshgrid(data.x.values, data.y.values))

    def root(radius):
        return np.sqrt(np.maximum(0.0, 1 - (r / radius) ** 2))

    exact = MU * P0 * (root(A) - c / A * root(c))
    inside = (r < 0.95 * A) & (np.abs(r - c) > 50e-6 / 40)
    error = np.abs(data.shear_x[-1].values - exact)[inside] / (MU * P0)
    assert error.max() < 0.04
    assert error.mean() < 5e-3


def test_every_result_has_its_unit_and_the_summary_its_numbers(pulled):
    data, summary = pulled.dataset, pulled.summary
    for name, unit in {
        "shear_x": "Pa", "slip_x": "m", "displacement_x": "m", "slip_distance": "m",
        "dissipated_energy_density": "J/m2", "contact_zone": "1",
    }.items():  # fmt: skip
        assert data[name].dims == ("step", "y", "x")
        assert data[name].attrs["units"] == unit == QUANTITIES[name].unit
    for name in ("tangential_load_x", "tangential_load", "shift_x", "shift_magnitude", "torsion_moment", "twist",
                 "stick_radius", "slip_fraction", "dissipated_energy", "bound_residual", "stick_residual"):  # fmt: skip
        assert data[name].attrs["units"] == known_numbers()[name].unit == summary["units"][name]
        assert summary[name] == float(data[name][-1])
    assert summary["tangential_convolutions"] == int(data.tangential_convolutions.sum()) > 0
    assert set(np.unique(data.contact_zone)) == {0.0, 1.0, 2.0}
    assert "shear_y" not in data
    for name in ("bound_residual", "stick_residual", "alignment_residual", "load_residual", "coupling_residual"):
        assert float(data[name].max()) <= 1e-6


def test_zones_slip_and_energy_belong_together(pulled):
    last = pulled.dataset.isel(step=-1)
    zone, pressure = last.contact_zone.values, last.pressure.values
    np.testing.assert_array_equal(zone > 0, pressure > 0)
    np.testing.assert_array_equal(last.slip_x.values != 0, zone == 1)
    np.testing.assert_allclose(np.abs(last.shear_x.values)[zone == 1], MU * pressure[zone == 1], rtol=1e-12)
    np.testing.assert_allclose(last.slip_distance, np.abs(last.slip_x), rtol=1e-12, atol=0)
    # under a steady pressure friction works with the shear that it bounds, against the slip
    work = -(last.shear_x * last.slip_x).values
    np.testing.assert_allclose(last.dissipated_energy_density, work, rtol=1e-12, atol=0)
    cell = float(np.prod(pulled.dataset.attrs["cell_size"]))
    assert float(last.dissipated_energy) == close(work.sum() * cell, rel=1e-12)


def test_work_balance_of_a_closed_cycle():
    """Load times shift around a steady loop is what friction took (CM-2: 2.942e-7 J, here on coarse cells).

    The trapezoids under the loop miss a part that falls with the square of the increment.
    """
    sweep = [{"shift_x": value, "increments": 20} for value in (5e-7, -5e-7, 5e-7)]
    data = ec.run(scene([{"normal_load": LOAD}, *sweep], cells=28, width=48e-6, coupling="none")).dataset
    load, shift = data.tangential_load_x.values[-41:], data.shift_x.values[-41:]
    put_in = float(np.sum(0.5 * (load[1:] + load[:-1]) * np.diff(shift)))
    taken = float(data.dissipated_energy[-1] - data.dissipated_energy[-41])
    assert put_in == close(taken, rel=0.01)
    assert taken == close(2.942e-7, rel=0.02)


def test_body_2_is_the_mirror_image_of_body_1():
    """Body 2 elastic, body 1 rigid: as body 1 under the opposite shear; z of each body points into it."""
    spots = {"name": "spots", "shape": "points", "points": [[8e-6, 3e-6, 5e-6], [-8e-6, 3e-6, 5e-6]]}
    shared = {"coupling": "full", "cells": 20, "width": 52e-6}

    def run(load, body, **bodies):
        steps = [{"normal_load": LOAD, "tangential_load_x": load}]
        return ec.run(scene(steps, stress={**spots, "body": body}, **bodies, **shared)).dataset.isel(step=-1)

    below, above = run(-3.0, 1), run(3.0, 2, body1={"rigid": True}, body2=STEEL)
    for name, weight in (("pressure", 1), ("shear_x", -1), ("shear_y", -1), ("spots_stress", 1)):
        values = below[name].values
        np.testing.assert_allclose(above[name], weight * values, rtol=0, atol=2e-6 * P0, err_msg=name)


@pytest.mark.parametrize(("mu", "centre", "body"), [(0.25, 0.4770, 1), (0.5, 0.8888, 2)])
def test_stress_under_a_sliding_ball(mu, centre, body):
    """HM-2 on the axis and HM-5 at the middle of the surface; the shear on body 2 is opposed to that on body 1."""
    points = {"name": "axis", "shape": "points", "body": body, "points": [[0, 0, z * A] for z in (0, 0.2, 0.5, 1.0)]}
    tables = {"body1": STEEL, "body2": {"rigid": True}} if body == 1 else {"body1": {"rigid": True}, "body2": STEEL}
    steps = [{"normal_load": LOAD, "shift_x": 3 * SLIDES}]
    data = ec.run(scene(steps, cells=40, width=50e-6, coupling="none", mu=mu, stress=points, **tables)).dataset
    assert float(data.slip_fraction[-1]) == 1.0
    mises, stress = data.axis_von_mises[-1].values, data.axis_stress[-1].values
    assert mises[0] / P0 == close(centre, rel=5e-3)
    sign = 1.0 if body == 1 else -1.0
    np.testing.assert_allclose(sign * stress[4, 1:] / (mu * P0), [-0.60721, -0.26964, -0.07190], rtol=5e-3)


def test_full_slip_peaks_where_hamilton_says():
    """CMC-3: von Mises on the surface at mu = 0.5, 0.9189 p0 at x = -0.55 a; trailing half in tension."""
    section = {"name": "top", "shape": "plane", "normal": "y", "depths": [0.0]}
    steps = [{"normal_load": LOAD, "shift_x": 3 * SLIDES}]
    data = ec.run(scene(steps, cells=51, width=50e-6, coupling="none", stress=section)).dataset
    x, mises = data.top_x.values / A, data.top_von_mises[-1, 0].values / P0
    inner = np.abs(x) < 0.9
    assert mises[inner].max() == close(0.9189, rel=0.01)
    assert x[inner][np.argmax(mises[inner])] == close(-0.55, abs=0.1)


# ---------------------------------------------------------------- handed on: resumed, and cut


SPOT = {"type": "sphere", "center": [4e-6, 0, 9e-6], "radius": 5e-6}


@pytest.mark.parametrize(
    ("coupling", "stop"),
    [pytest.param("none", 4, marks=pytest.mark.slow), ("full", 2), pytest.param("full", 4, marks=pytest.mark.slow)],
)
def test_a_resumed_run_repeats_an_uninterrupted_one_to_the_last_bit(tmp_path, coupling, stop, uninterrupted):
    planned, whole = uninterrupted(coupling)
    with pytest.raises(Stop):
        ec.run(planned, tmp_path, watcher=Stopper(stop))
    with ec.run(planned, tmp_path, resume=True).dataset as resumed:
        assert set(resumed.variables) == set(whole.variables)
        for name in set(whole.variables) - {"solve_seconds", "convolutions"}:  # work that the last step had saved
            np.testing.assert_array_equal(resumed[name].values, whole[name].values, err_msg=name)


@pytest.fixture(scope="module")
def uninterrupted():
    """Scene with a history, and what it gives in one go, for each coupling."""
    steps = [
        {"normal_load": LOAD, "increments": 2},
        {"tangential_load_x": 2.0, "twist": 4e-3},
        {"shift_y": 1e-7},
        {"normal_load": 0.7 * LOAD, "tangential_load_x": -1.0},
    ]
    known = {}

    def run(coupling):
        if coupling not in known:
            planned = ec.plan(scene(steps, coupling=coupling, cells=18, inclusions=[{**SPOT, "eigenstrain": 1e-3}]))
            known[coupling] = planned, ec.run(planned).dataset
        return known[coupling]

    return run


def test_another_map_of_friction_is_another_scene(tmp_path):
    """A run cannot be resumed with a file that has changed since."""
    file, folder = tmp_path / "map.npz", tmp_path / "out"
    law = {"type": "coulomb-map", "file": str(file)}
    mapped = scene([{"normal_load": LOAD}, {"tangential_load_x": 1.0}], friction=law)
    for coefficient in (0.3, 0.4):
        axis = np.array([-50e-6, 50e-6])
        np.savez(file, x=axis, y=axis, coefficient=np.full((2, 2), coefficient))
        if coefficient == 0.3:
            with pytest.raises(Stop):
                ec.run(mapped, folder, watcher=Stopper(2))
        else:
            with pytest.raises(ResultsError, match="another scene"):
                ec.run(mapped, folder, resume=True)


@pytest.fixture
def stubborn(monkeypatch):
    """Let increments fail that change the tangential load or the normal load by more than so much at a time."""

    def limit(largest):
        original, asked = FrictionalContact.step, []

        def step(self, separation, control, tangential, before=None, **more):
            load = float(np.sum(before.shear[0])) * self.grid.cell_area
            asked.append(tangential.tangential_load_x)
            if abs(tangential.tangential_load_x - load) > largest:
                raise NotConverged("too far")
            return original(self, separation, control, tangential, before, **more)

        monkeypatch.setattr(FrictionalContact, "step", step)
        return asked

    return limit


def test_a_step_that_does_not_converge_is_halved(stubborn):
    """As if the scene had asked for smaller increments; slip, path and dissipated energy add up."""
    loads = [{"normal_load": LOAD, "tangential_load_x": 0.0}, {"normal_load": 0.8 * LOAD, "tangential_load_x": 4.0}]
    finer = ec.run(scene([loads[0], {**loads[1], "increments": 4}], cells=24)).dataset
    asked = stubborn(1.01)
    cut = ec.run(scene(loads, cells=24)).dataset
    assert asked == [0.0, 4.0, 2.0, 1.0, 2.0, 4.0, 3.0, 4.0]
    np.testing.assert_array_equal(cut.substeps, [1.0, 4.0])
    assert float(cut.time[-1]) == 2.0
    for name in ("pressure", "shear_x", "shear_y", "slip_distance", "dissipated_energy_density", "displacement_x"):
        size = float(np.abs(finer[name][-1]).max())
        np.testing.assert_allclose(cut[name][-1], finer[name][-1], rtol=0, atol=1e-6 * size, err_msg=name)
    loaded = cut.pressure[-1].values > 0
    np.testing.assert_allclose(cut.slip_x[-1], finer.slip_x[1:].sum("step").values * loaded, rtol=0, atol=1e-12)
    slipped = (finer.contact_zone[1:] == 1).any("step").values
    np.testing.assert_array_equal(cut.contact_zone[-1].values == 1, slipped & loaded)
    assert float(cut.tangential_convolutions[-1]) == float(finer.tangential_convolutions[1:].sum())
    assert float(cut.dissipated_energy[-1]) == close(float(finer.dissipated_energy[-1]), rel=1e-6)


def test_after_five_halvings_the_user_is_told(stubborn, tmp_path):
    asked = stubborn(1e-3)
    steps = [{"normal_load": LOAD, "tangential_load_x": 0.0}, {"tangential_load_x": 3.2}]
    with pytest.raises(NotConverged, match="too far"):
        ec.run(scene(steps), tmp_path)
    assert asked[1:] == close([3.2, 1.6, 0.8, 0.4, 0.2, 0.1], rel=1e-12)
    assert (tmp_path / "steps" / "0001.step").exists()


def test_a_law_sees_where_the_history_stands(monkeypatch):
    seen = []
    original = Coulomb.shear_bound

    def shear_bound(self, state):
        seen.append((state.time, float(state.slip_distance.max())))
        return original(self, state)

    monkeypatch.setattr(Coulomb, "shear_bound", shear_bound)
    steps = [{"normal_load": LOAD}, {"shift_x": 3 * SLIDES, "increments": 2}]
    data = ec.run(scene(steps)).dataset
    assert sorted({time for time, _ in seen}) == [1.0, 1.5, 2.0]
    assert dict(seen)[1.5] == 0.0
    assert dict(seen)[2.0] == float(data.slip_distance[1].max()) > 0


# ---------------------------------------------------------------- eigenstrain under friction


def test_eigenstrain_from_before_the_contact_drags_nothing():
    still = {**SPOT, "eigenstrain": 1e-3}
    data = ec.run(scene([{"normal_load": LOAD}], inclusions=[still])).dataset
    assert float(np.abs(data.residual_displacement_x).max()) > 5e-10
    assert float(np.abs(data.shear_x).max()) < 1e-9 * P0
    assert float(data.slip_fraction[-1]) == 0.0


def test_eigenstrain_that_grows_under_load_drags_the_surface():
    """A region that swells moves its surface outwards: the shear on body 1 holds it back, towards the middle."""
    field = {
        "type": "depth-profile",
        "depths": [0.0, 1e-4],
        "values": [1e-3, 1e-3],
        "times": [0.0, 1.0, 2.0],
        "factors": [0.0, 0.0, 1.0],
    }
    swelling = {**SPOT, "center": [0, 0, 9e-6], "eigenstrain": field}
    steps = [{"normal_load": LOAD}, {"normal_load": LOAD}]
    data = ec.run(scene(steps, inclusions=[swelling], cells=18)).dataset
    assert float(np.abs(data.shear_x[0]).max()) < 1e-9 * P0
    shear, x = data.shear_x[1].values, data.x.values[None, :]
    assert float(np.sum(shear * x)) < 0
    assert float(np.abs(shear).max()) > 1e-3 * P0
    # no load along x: the shift is held at zero, and by symmetry nothing pulls
    assert abs(float(data.tangential_load_x[1])) < 1e-6 * MU * LOAD


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("coupling", ["none", "full"])
def test_a_sheared_layer_drags_the_surface_as_a_shift_does(coupling, axis):
    """Eigenstrain e_xz in a thin, wide layer of thickness h moves all of the surface by -2 e_xz h, without stress.

    Held at a shift of zero, the contact then bears what a shift of 2 e_xz h would make it bear: Mindlin's force.
    """
    depth, moved, c = 1e-6, 0.4 * SLIDES, "xy"[axis]
    strain = np.zeros((3, 3))
    strain[axis, 2] = strain[2, axis] = 0.5 * moved / depth
    field = {"type": "uniform", "value": strain.tolist(), "times": [1.0, 2.0], "factors": [0.0, 1.0]}
    layer = {"type": "cuboid", "center": [0, 0, 0.5 * depth], "edges": [1.0, 1.0, depth], "eigenstrain": field}
    press = {"normal_load": LOAD}
    dragged = ec.run(scene([press, press], inclusions=[layer], coupling=coupling)).dataset
    shifted = ec.run(scene([press, {f"shift_{c}": moved}], coupling=coupling)).dataset
    largest = float(abs(shifted[f"shear_{c}"]).max())
    np.testing.assert_allclose(dragged[f"residual_displacement_{c}"][1], -moved, rtol=1e-4)
    np.testing.assert_allclose(dragged[f"shear_{c}"], shifted[f"shear_{c}"], rtol=0, atol=1e-4 * largest)
    assert float(dragged.slip_fraction[1]) == close(float(shifted.slip_fraction[1]), rel=1e-3)
    assert 0.1 < float(shifted.slip_fraction[1]) < 0.9
    if coupling == "none":
        mindlin = MU * LOAD * (1.0 - (1.0 - moved / SLIDES) ** 1.5)
        assert float(dragged[f"tangential_load_{c}"][1]) == close(mindlin, rel=0.02)


# ---------------------------------------------------------------- everything at once


def rough(seed, count, size, height):
    """Summits along x and y in random phase, periodic in the window [m]."""
    rng = np.random.default_rng(seed)
    at = (np.arange(count) + 0.5) * size / count
    total = np.zeros((count, count))
    for ky in range(5):
        for kx in range(5):
            if kx + ky:
                phase = rng.uniform(0, 2 * pi)
                total += np.cos(2 * pi * (kx * at[None] + ky * at[:, None]) / size + phase) / (kx**2 + ky**2)
    return height * total / np.abs(total).max()


@pytest.mark.parametrize("boundary", ["non-periodic", "periodic"])
def test_everything_at_once(tmp_path, boundary):
    """Torsion, tilt and shear on a dissimilar, elliptical, rough contact: certified, and in balance with its loads."""
    count, size = 32, 96e-6
    np.savez(tmp_path / "rough.npz", rough(1, count, size, 60e-9))
    geometry = [
        {"type": "ellipsoid", "radius_x": 300e-6, "radius_y": 180e-6},
        {"type": "topography", "file": str(tmp_path / "rough.npz"), "spacing": size / count, "height-unit": 1.0},
    ]
    steps = [
        {"normal_load": LOAD, "increments": 2},
        {"moment_y": 1e-5, "tangential_load_x": 1.2, "tangential_load_y": -0.6, "torsion_moment": 8e-6},
        {"tilt_x": 5e-4, "shift_x": -1e-7, "torsion_moment": -8e-6, "normal_load": 0.8 * LOAD},
    ]
    found = ec.run(
        ec.Scene(
            body1=STEEL,
            body2={"young_modulus": 70e9, "poisson_ratio": 0.33},
            geometry=geometry,
            friction={"type": "coulomb", "coefficient": 0.3},
            grid={"cells": count, "size": [size, size]},
            steps=steps,
            numerics={"boundary": boundary, "threads": 1},
            output={"pictures": False},
        )
    ).dataset
    for name in ("gap_residual", "penetration_residual", "load_residual", "bound_residual", "stick_residual",
                 "alignment_residual", "coupling_residual"):  # fmt: skip
        assert float(found[name].max()) <= 1e-6, name
    dx, dy = found.attrs["cell_size"]
    x, y = found.x.values[None, :], found.y.values[:, None]
    last, third = found.isel(step=-1), found.isel(step=2)
    for step in (third, last):
        qx, qy, p = step.shear_x.values, step.shear_y.values, step.pressure.values
        assert float(step.tangential_load_x) == close(qx.sum() * dx * dy, rel=1e-9)
        assert float(step.torsion_moment) == close(float(np.sum(x * qy - y * qx)) * dx * dy, rel=1e-6)
        assert np.all(np.hypot(qx, qy) <= 0.3 * p + 1e-6 * 0.3 * p.max())
    assert float(third.tangential_load_x) == close(1.2, rel=1e-5)
    assert float(third.tangential_load_y) == close(-0.6, rel=1e-5)
    assert float(third.torsion_moment) == close(8e-6, rel=1e-4)
    assert float(last.torsion_moment) == close(-8e-6, rel=1e-4)
    assert float(last.shift_x) == -1e-7
    assert 0.0 < float(last.slip_fraction) < 1.0
    assert np.all(np.diff(found.dissipated_energy) >= 0)


def test_a_force_at_the_limit_of_friction_does_not_converge():
    """Rigid sliding is then possible in all cells at once, and the shift is not determined."""
    tables = ec.load_scene("fretting-mode-1", ["observers=[]", "grid.cells-per-contact-radius=8"]).resolved()
    limit = 0.5 * tables["steps"][0]["normal-load"]
    tables["steps"] = [tables["steps"][0], {"tangential-load-x": limit, "increments": 2}]
    tables["numerics"]["max-iterations"] = 40
    words = (
        r"steps.1.tangential-load-x, at load step 3, must be below what friction carries, .* prescribe shift-x to slide"
    )
    with pytest.raises(NotConverged, match=f"{words}: friction did not converge in"):
        ec.run(tables)
    tables["steps"][1]["tangential-load-x"] = (1 - 1e-9) * limit
    assert ec.run(tables).summary["slip_fraction"] == 1.0
