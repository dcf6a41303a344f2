"""Bulk stress: surfaces that it drags, regions that it loads, its own value in stored fields, and what is refused."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL, perfect
from close import close
from eigencontact.core.bulk import in_plane_strain, relative_strain
from eigencontact.core.material import Material
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.blocks.surface import Surface
from eigencontact.execution.mechanics import friction_contact
from eigencontact.execution.run.loading import LoadHistory
from eigencontact.scene.schema import Step
from eigencontact_verification.oracles.bulk_slip import cerruti, moved_stick_zone, stretched, swept
from eigencontact_verification.oracles.eshelby_sphere import isotropic_stiffness, sphere_in_body, stress_about_sphere
from stopping import Stop, Stopper

E, NU, MU = STEEL["young_modulus"], STEEL["poisson_ratio"], 0.1
COULOMB = {"type": "coulomb", "coefficient": MU}
BALL = {"type": "sphere", "radius": "200 um"}


def solved(steps, *, body1=None, body2=None, geometry=BALL, cells=13, size="44 um", tolerance=1e-9, **more):
    tables = {
        "body1": {**STEEL, **(body1 or {})}, "body2": {**STEEL, **(body2 or {})}, "geometry": geometry,
        "friction": COULOMB, "grid": {"cells": cells, "size": size}, "steps": steps,
        "numerics": {"tolerance": tolerance, "threads": 1}, "output": {"pictures": False},
    }  # fmt: skip
    return ec.run(ec.Scene(**{name: value for name, value in (tables | more).items() if value is not None})).dataset


# ---------------------------------------------------------------- stick and slip

#: Pressed; stretched in both bodies, sheared and moved along; stretched the other way, out of phase with the shift.
OUT_OF_PHASE = [
    {"normal_load": "5 N"},
    {"shift_x": "20 nm", "bulk_stress_xx": "900 MPa", "bulk_stress_xy": "300 MPa"},
    {"bulk_stress_xx": "-1.2 GPa", "body2_bulk_stress_yy": "1 GPa", "shift_y": "10 nm"},
]
STRESSES = [((0, 0, 0), (0, 0, 0)), ((9e8, 0, 3e8), (0, 0, 0)), ((-1.2e9, 0, 3e8), (0, 1e9, 0))]
SHIFTS = [(0, 0), (20e-9, 0), (20e-9, 10e-9)]


def largest_misfit(dataset):
    """Largest difference of the shear to that of dense matrices after all steps [bounds], and the sticking parts."""
    x, y = dataset.x.values, dataset.y.values
    loaded = dataset.pressure.values[0] > 0
    xs, ys = (values[loaded] for values in np.meshgrid(x, y))
    half = 0.5 * (x[1] - x[0])
    compliance = 2.0 * cerruti(xs[:, None] - xs, ys[:, None] - ys, (half, half), E, NU)
    shear, before, misfits, sticking = np.zeros((2, xs.size)), np.zeros((2, xs.size)), [], []
    for n, ((first, second), shift) in enumerate(zip(STRESSES, SHIFTS, strict=True)):
        moved = stretched(xs, ys, first, E, NU) - stretched(xs, ys, second, E, NU) - np.array(shift)[:, None]
        bound = MU * dataset.pressure.values[n][loaded]
        shear, before = swept(compliance, bound, moved - before, shear), moved
        stored = np.stack([dataset[f"shear_{axis}"].values[n][loaded] for axis in "xy"])
        misfits.append(np.abs(stored - shear).max() / bound.max())
        sticking.append(np.mean(dataset.contact_zone.values[n][loaded] == 2))
    return max(misfits), sticking


def test_the_shear_of_stretched_bodies_is_that_of_dense_matrices():
    misfit, sticking = largest_misfit(solved(OUT_OF_PHASE))
    assert misfit < 1e-7
    assert 0.2 < min(sticking[1:]) < max(sticking[1:]) < 0.9


def test_a_body_2_that_moves_to_the_wrong_side_is_seen(monkeypatch):
    def wrong(values, substrates, **options):
        first, second = substrates
        return relative_strain(values, (first, None), **options) - relative_strain(values, (None, second), **options)

    monkeypatch.setattr(friction_contact, "relative_strain", wrong)
    assert largest_misfit(solved(OUT_OF_PHASE))[0] > 0.1


def test_the_stick_zone_of_a_long_contact_moves_by_the_closed_form_of_a_line():
    stress, friction = 1e8, 0.5
    long = {"type": "ellipsoid", "radius_x": "10 mm", "radius_y": "1 m"}
    along = {"tangential_load_x": "80 N", "bulk_stress_xx": stress, "bulk_stress_yy": NU * stress}  # no strain along y
    dataset = solved(
        [{"normal_load": "400 N"}, along], geometry=long, cells=[80, 41], size=["0.3 mm", "6 mm"], tolerance=1e-6,
        friction={"type": "coulomb", "coefficient": friction},
    )  # fmt: skip
    x, pressure, shear, zone = (
        values[len(values) // 2] if values.ndim == 2 else values
        for values in (dataset.x.values, *(dataset[n].values[-1] for n in ("pressure", "shear_x", "contact_zone")))
    )
    loaded, sticking = np.flatnonzero(pressure > 0)[3:-3], np.flatnonzero(zone == 2)[2:-2]
    slope, square = np.polyfit(x[loaded] ** 2, pressure[loaded] ** 2, 1)
    # Where it sticks, friction p less q is half an ellipse about the middle of the stick zone.
    curve, tilt, _ = np.polyfit(x[sticking], (friction * pressure - shear)[sticking] ** 2, 2)
    strain = in_plane_strain(np.array([stress, NU * stress, 0.0]), Material(young_modulus=E, poisson_ratio=NU))[0]
    expected = moved_stick_zone(strain, np.sqrt(-square / slope), friction, np.sqrt(square), E / (1.0 - NU**2))
    assert -tilt / (2.0 * curve) == close(expected, rel=0.02)


def test_large_bulk_stress_slips_back_at_the_other_edge():
    zones = {}
    for stress in ("0 MPa", "2 GPa"):
        along = {"tangential_load_x": "0.2 N", "bulk_stress_xx": stress, "body2_bulk_stress_xx": "0 MPa"}
        dataset = solved([{"normal_load": "5 N"}, along], cells=33, tolerance=1e-6)
        shear, slips = dataset.shear_x.values[-1], dataset.contact_zone.values[-1] == 1
        zones[stress] = np.sign(shear[slips])
    assert np.all(zones["0 MPa"] == 1.0)
    assert set(zones["2 GPa"]) == {-1.0, 1.0}


def test_a_quarter_turn_of_bulk_stress_and_load_turns_the_answer():
    along_x = [{"normal_load": "5 N"}, {"tangential_load_x": "0.2 N", "bulk_stress_xx": "1 GPa"}]
    along_y = [{"normal_load": "5 N"}, {"tangential_load_y": "0.2 N", "bulk_stress_yy": "1 GPa"}]
    first, second = solved(along_x), solved(along_y)
    largest = float(first.shear_x.max())
    for one, other in (("x", "y"), ("y", "x")):
        turned = second[f"shear_{other}"].values.swapaxes(1, 2)
        np.testing.assert_allclose(first[f"shear_{one}"].values, turned, rtol=0.0, atol=1e-7 * largest)


def test_bodies_that_stretch_alike_do_not_feel_it():
    alone, along = {"normal_load": "5 N"}, {"tangential_load_x": "0.2 N"}
    both = {"bulk_stress_xx": "1 GPa", "body2_bulk_stress_xx": "1 GPa"}
    plain, alike = solved([alone, along]), solved([alone, {**along, **both}])
    np.testing.assert_allclose(alike.shear_x, plain.shear_x, rtol=0.0, atol=1e-8 * float(plain.shear_x.max()))


def test_bodies_that_are_stretched_before_they_touch_do_not_feel_it():
    steps = [{"normal_load": "5 N"}, {"tangential_load_x": "0.2 N"}]
    plain, before = solved(steps), solved(steps, body1={"bulk_stress": {"xx": "1 GPa", "xy": "200 MPa"}})
    np.testing.assert_allclose(before.shear_x, plain.shear_x, rtol=0.0, atol=1e-8 * float(plain.shear_x.max()))
    assert before.bulk_stress_xx.values.tolist() == [1e9, 1e9]


def test_no_component_is_left_out_without_coupling():
    uncoupled = {"coupling": "none", "threads": 1}
    dataset = solved([{"normal_load": "5 N"}, {"bulk_stress_xx": "1 GPa"}], numerics=uncoupled)
    # Poisson's contraction shears along y.
    assert float(np.abs(dataset.shear_y.values[-1]).max()) > 0.1 * float(np.abs(dataset.shear_x.values[-1]).max())


# ---------------------------------------------------------------- stored fields

PLANE = {"shape": "plane", "normal": "y", "depth_max": "20 um", "depth_cells": 4, "fields": ["stress", "strain"]}


def test_without_friction_only_the_stored_fields_change():
    bulk = np.array([9e8, -1e8, 0, 0, 0, 3e8])
    table = {"bulk_stress": {"xx": 9e8, "yy": -1e8, "xy": 3e8}}
    options = {"friction": None, "stress": [PLANE], "tolerance": 1e-6}
    plain = solved([{"normal_load": "5 N"}], **options)
    loaded = solved([{"normal_load": "5 N"}], body1=table, **options)
    assert np.array_equal(plain.pressure, loaded.pressure)
    name = next(name for name in plain.data_vars if name.endswith("_stress") and not name.startswith("bulk"))
    change = (loaded[name] - plain[name]).values[-1].reshape(6, -1)
    np.testing.assert_allclose(change, np.broadcast_to(bulk[:, None], change.shape), rtol=0.0, atol=1e-3)
    strain = (loaded[name.replace("stress", "strain")] - plain[name.replace("stress", "strain")]).values[-1]
    expected = [(9e8 + NU * 1e8) / E, (-1e8 - NU * 9e8) / E, -NU * 8e8 / E, 0, 0, (1 + NU) / E * 3e8]
    np.testing.assert_allclose(strain.reshape(6, -1).mean(axis=1), expected, rtol=0.0, atol=1e-12)


def test_layers_share_the_strain_of_the_substrate():
    layers = [{"thickness": "5 um", "young_modulus": "420 GPa", "poisson_ratio": 0.2}]
    medium = {"type": "bonded-layers", "layers": layers, "substrate": STEEL}
    line = {"shape": "points", "points": [[3e-6, 2e-6, 2e-6], [3e-6, 2e-6, 15e-6]],
            "fields": ["stress", "strain", "displacement"], "name": "below"}  # fmt: skip
    tables = {"geometry": BALL, "grid": {"cells": 16, "size": "20 um"}, "stress": line, "output": {"pictures": False}}
    fields = []
    for stress in (0.0, 4e8):
        body = {"medium": medium, "bulk_stress": {"xx": stress}}
        fields.append(ec.run(ec.Scene(body1=body, steps={"normal_load": "0.5 N"}, **tables)).dataset)
    stress, strain, moved = (
        (fields[1][f"below_{name}"] - fields[0][f"below_{name}"]).values[-1]
        for name in ("stress", "strain", "displacement")
    )
    exx, eyy = 4e8 / E, -NU * 4e8 / E
    stiffness = 420e9 / (1 - 0.2**2)
    np.testing.assert_allclose(stress[:, 1], [4e8, 0, 0, 0, 0, 0], rtol=0.0, atol=1e-3)
    np.testing.assert_allclose(stress[:2, 0], stiffness * np.array([exx + 0.2 * eyy, eyy + 0.2 * exx]), rtol=1e-9)
    across = [-0.2 / 0.8 * (exx + eyy), eyy]
    np.testing.assert_allclose(strain[2], across, rtol=1e-9)
    np.testing.assert_allclose(moved[:2].T, [[3e-6 * exx, 2e-6 * eyy]] * 2, rtol=1e-6)
    np.testing.assert_allclose(moved[2], [2e-6 * across[0], 5e-6 * across[0] + 10e-6 * across[1]], rtol=1e-6)


def test_a_region_is_looked_at_afterwards_with_the_bulk_stress_of_the_step(tmp_path):
    steps = [{"normal_load": "5 N"}, {"bulk_stress_xx": "1 GPa", "increments": 2}]
    scene = ec.Scene(
        body1=STEEL, geometry=BALL, friction=COULOMB, grid={"cells": 13, "size": "44 um"}, steps=steps, stress=PLANE,
        output={"pictures": False},
    )  # fmt: skip
    result = ec.run(scene, tmp_path / "run")
    name = next(name for name in result.dataset.data_vars if str(name).endswith("_stress") and "bulk" not in str(name))
    later = ec.region(tmp_path / "run", {**PLANE, "name": "later"}, step=2)
    again = later["later_stress"].values
    np.testing.assert_allclose(np.squeeze(again), result.dataset[name].values[1], rtol=1e-12, atol=1.0)


# ---------------------------------------------------------------- regions of other material, and laws

REMOTE = {"xx": 2e8, "yy": -5e7, "xy": 8e7}
TENSOR = np.array([[2e8, 8e7, 0.0], [8e7, -5e7, 0.0], [0.0, 0.0, 0.0]])
DEEP = {"type": "sphere", "radius": "1 um", "center": ("0 um", "0 um", "30 um")}
#: Middle of the ball, and a point beside it, in its radii from there.
BESIDE = (1.5, 0.4, -0.3)
CENTRE = {"shape": "points", "points": [[0.0, 0.0, 30e-6], [1.5e-6, 0.4e-6, 29.7e-6]], "name": "middle"}


def buried(material, numerics, steps=({"bulk_stress_xx": 2e8, "bulk_stress_yy": -5e7, "bulk_stress_xy": 8e7},), **more):
    tables = {
        "body1": STEEL, "inclusions": {**DEEP, "material": material}, "grid": {"spacing": "0.2 um", "cells": 15},
        "stress": CENTRE, "steps": list(steps), "numerics": {"threads": 1, **numerics}, "output": {"pictures": False},
    }  # fmt: skip
    return ec.run(ec.Scene(**(tables | more))).dataset


def as_matrix(components):
    xx, yy, zz, yz, xz, xy = components
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


@pytest.mark.parametrize(
    ("ratio", "numerics", "tolerance"),
    [
        (0.0, {"inclusion_resolution": "whole"}, 1e-4),
        (3.0, {"inclusion_resolution": {"whole": 2}}, 1e-4),
        (3.0, {}, 0.02),
    ],
)
def test_a_ball_far_below_the_surface_is_eshelbys_under_the_bulk_stress(ratio, numerics, tolerance):
    dataset = buried({"young_modulus": ratio * E, "poisson_ratio": NU} if ratio else {"void": True}, numerics)
    stiffness = isotropic_stiffness(ratio * E, NU) if ratio else np.zeros((3, 3, 3, 3))
    inside, eigenstrain = sphere_in_body(stiffness, E, NU, TENSOR)
    about = TENSOR + stress_about_sphere(eigenstrain, E, NU, [BESIDE])[:, :, 0]
    stored = dataset.middle_stress.values[-1].T
    np.testing.assert_allclose(as_matrix(stored[0]), inside, rtol=0.0, atol=tolerance * 2e8)
    np.testing.assert_allclose(as_matrix(stored[1]), about, rtol=0.0, atol=tolerance * 2e8)


def test_under_a_contact_the_remote_strain_is_the_same():
    steps = [{"normal_load": "10 uN", **{f"bulk_stress_{name}": value for name, value in REMOTE.items()}}]
    dataset = buried(
        {"young_modulus": 3 * E, "poisson_ratio": NU},
        {"inclusion_resolution": "whole", "allow_coarse": True},
        steps,
        geometry=BALL,
    )
    inside, _ = sphere_in_body(isotropic_stiffness(3 * E, NU), E, NU, TENSOR)
    np.testing.assert_allclose(as_matrix(dataset.middle_stress.values[-1, :, 0]), inside, rtol=0.0, atol=1e-4 * 2e8)


def test_cells_of_the_material_of_the_body_feel_the_bulk_stress_alone():
    dataset = buried({"young_modulus": E, "poisson_ratio": NU}, {})
    np.testing.assert_allclose(as_matrix(dataset.middle_stress.values[-1, :, 0]), TENSOR, rtol=0.0, atol=1e-6 * 2e8)


@pytest.mark.slow
def test_a_ball_that_yields_under_bulk_tension_flows_as_far_as_the_body_around_lets_it():
    """Its stress is uniform: σ - 3 G (1 - β) ε_p, with Eshelby's β of deviators, is the yield stress Y + H ε_p."""
    limit, slope, peak = 4e8, 2e10, 9e8
    law = {**STEEL, "type": "j2", "hardening": {"type": "linear", "yield_stress": limit, "modulus": slope}}
    steps = [{"bulk_stress_xx": peak, "increments": 2}, {"bulk_stress_xx": 0.0}]
    dataset = buried(law, {}, steps)
    shear = E / (2 * (1 + NU))
    held = 3 * shear * (1 - 2 * (4 - 5 * NU) / (15 * (1 - NU)))
    flowed = (peak - limit) / (slope + held)
    stress = dataset.middle_stress.values[:, :, 0]
    first = max(0.0, 0.5 * peak - limit) / (slope + held)
    expected = [0.5 * peak - held * first * 2 / 3, peak - held * flowed * 2 / 3, -held * flowed * 2 / 3]
    np.testing.assert_allclose(stress[:, 0], expected, rtol=0.0, atol=0.02 * peak)


def test_a_law_of_the_body_flows_earlier_under_bulk_tension():
    body = {"law": perfect("3 GPa")}
    tables = {
        "geometry": BALL, "grid": {"cells": 12, "size": "26 um"}, "output": {"pictures": False},
        "steps": [{"normal_load": "1 N"}],
    }  # fmt: skip
    volumes = []
    for stress in ("0 GPa", "1.5 GPa"):
        scene = ec.Scene(body1={**STEEL, **body, "bulk_stress": {"xx": stress}}, **tables)
        volumes.append(float(ec.run(scene).summary["plastic_volume"]))
    # Below the contact stress is compressive, most along z: tension along x adds to the difference.
    assert volumes[1] > 1.5 * volumes[0] > 0.0


# ---------------------------------------------------------------- history


def test_bulk_stress_is_ramped_and_stays_where_a_step_does_not_mention_it():
    steps = [
        Step(normal_load=1.0, increments=2),
        Step(cycle=[{"bulk_stress_xx": 4.0, "increments": 2}, {"body2_bulk_stress_xy": 1.0}], repeat=2),
    ]
    at_rest = {"bulk_stress_xx": 2.0, "body2_bulk_stress_xy": 0.0}
    history, point, values = LoadHistory(steps, friction=False, bulk=at_rest), None, []
    while (point := history.after(point)) is not None:
        values.append(tuple(history.bulk(point).values()))
    assert values == [(2.0, 0.0), (2.0, 0.0), (3.0, 0.0), (4.0, 0.0), (4.0, 1.0), (4.0, 1.0), (4.0, 1.0), (4.0, 1.0)]


def test_halves_of_an_increment_meet_at_the_mean_bulk_stress():
    whole = Increment(
        times=(0.0, 1.0), begin={}, control=None, tangential=None, surface=Surface(), progress=None,
        bulk=({"bulk_stress_xx": 2.0}, {"bulk_stress_xx": 6.0}),
    )  # fmt: skip
    first, second = whole.halves()
    assert first.bulk == ({"bulk_stress_xx": 2.0}, {"bulk_stress_xx": 4.0})
    assert second.bulk == ({"bulk_stress_xx": 4.0}, {"bulk_stress_xx": 6.0})
    assert whole.at_start().bulk == ({"bulk_stress_xx": 2.0}, {"bulk_stress_xx": 2.0})


def test_a_resumed_run_goes_on_from_the_stored_bulk_stress(tmp_path):
    steps = [{"normal_load": "5 N"}, {"shift_x": "20 nm", "bulk_stress_xx": "900 MPa", "increments": 3}]
    planned = ec.plan(
        ec.Scene(
            body1={**STEEL, "bulk_stress": {"xx": "300 MPa", "xy": "100 MPa"}}, body2=STEEL, geometry=BALL,
            friction=COULOMB, grid={"cells": 13, "size": "44 um"}, steps=steps, output={"pictures": False},
        )
    )  # fmt: skip
    whole = ec.run(planned).dataset
    assert whole.bulk_stress_xx.values == close(np.array([3e8, 5e8, 7e8, 9e8]), rel=1e-12)
    with pytest.raises(Stop):
        ec.run(planned, tmp_path, watcher=Stopper(3))
    with ec.run(planned, tmp_path, resume=True).dataset as resumed:
        for name in ("shear_x", "shear_y", "slip_distance", "bulk_stress_xx", "bulk_stress_xy"):
            np.testing.assert_array_equal(resumed[name].values, whole[name].values, err_msg=name)


# ---------------------------------------------------------------- warnings and refusals


@pytest.mark.parametrize(("stress", "codes"), [("20 GPa", []), ("-22 GPa", ["small-strain"])])
def test_strains_that_are_not_small_are_told(stress, codes):
    steps = [{"normal_load": "0.5 N", "body2_bulk_stress_yy": stress}]
    planned = ec.plan(ec.Scene(body1=STEEL, body2=STEEL, geometry=BALL, steps=steps))
    assert [caution.code for caution in planned.cautions] == codes


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"body1": {**STEEL, "bulk_stress": {"zz": 1.0}}}, "unknown key 'zz' in body1.bulk_stress; known: xx, yy, xy"),
        ({"body1": {**STEEL, "bulk_stress": {"xx": np.inf}}}, "body1.bulk-stress.xx must be finite"),
        ({"body2": {"rigid": True, "bulk_stress": {"xx": 1.0}}}, "body2 must be rigid without bulk stress"),
        (
            {"steps": {"normal_load": 1.0, "body2_bulk_stress_xx": 1e6}},
            "must act on an elastic body (got a rigid body2)",
        ),
        (
            {"steps": {"normal_load": 1.0, "bulk_stress_xx": 1e6}, "numerics": {"boundary": "periodic"}},
            "numerics.boundary must be 'non-periodic' with bulk stress in a contact with friction",
        ),
        (
            {"steps": {"normal_load": 1.0, "bulk_stress_xx": 1e6, "impacts": {"count": 2, "size": 1e-6}}},
            "impacts and normal-load, and nothing else",
        ),
        (
            {"body1": {**STEEL, "law": perfect("300 MPa"), "bulk_stress": {"xx": "400 MPa"}}},
            "body1.bulk-stress, also of steps, must be within the elastic range of the law (got a von Mises",
        ),
    ],
)
def test_bulk_stress_is_refused_where_it_makes_no_sense(tables, words):
    scene = {"body1": STEEL, "geometry": BALL, "friction": COULOMB, "steps": {"normal_load": 1.0}}
    with pytest.raises(SceneError) as refusal:
        ec.plan(ec.Scene(**(scene | tables)))
    assert words in str(refusal.value)
