"""Scenes of prescribed eigenstrain, alone and under a contact, against closed forms and against each other."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close

E, NU = 210e9, 0.3
BALL = {"type": "sphere", "center": [0.0, 0.0, 2e-6], "radius": 1e-6, "eigenstrain": 1e-3}
GRID = {"cells": 15, "size": [7.5e-6, 7.5e-6]}
CONTACT = {
    "geometry": {"type": "sphere", "radius": 105e-6},
    "grid": {"cells": 32, "size": [16e-6, 16e-6]},
    "steps": {"normal-load": 0.5},
    "numerics": {"tolerance": 1e-9},
}


def run(**tables):
    return ec.run({"body1": STEEL, "inclusions": [BALL], "grid": GRID} | tables)


def test_the_ball_lifts_the_surface_as_davies_says():
    """Case DL-1 beside a centre of dilatation, u_z = -(1 + nu) e V c/(pi R^3) and in the plane +x (Davies 2003)."""
    result = run()
    data = result.dataset
    y, x = np.meshgrid(data.y, data.x, indexing="ij")
    c, volume = 2e-6, 4 / 3 * np.pi * 1e-18
    common = (1 + NU) * 1e-3 * volume / (np.pi * (x**2 + y**2 + c**2) ** 1.5)
    for component, place in (("x", x), ("y", y), ("z", -c)):
        np.testing.assert_allclose(data[f"residual_displacement_{component}"][0], common * place, atol=1e-22)
    assert result.summary["max_uplift"] == close(4 / 3 * (1 + NU) * 1e-3 * 1e-18 / c**2, rel=1e-12, abs=0)
    assert result.summary["max_sink"] == 0.0
    assert "pressure" not in data
    assert "contact_modulus" not in data.attrs
    assert "normal_load" not in result.summary


def test_fields_of_a_region_agree_with_the_library_and_with_each_other():
    region = {"name": "cut", "shape": "plane", "normal": "x", "position": 0.3e-6, "depth-max": 4e-6, "depth-cells": 6}
    data = run(stress=region | {"fields": ["stress", "strain", "displacement"]}).dataset
    z, y = np.meshgrid(data.cut_z, data.y, indexing="ij")
    points = np.stack([np.full(z.size, 0.3e-6), y.ravel(), z.ravel()], axis=1)
    shape = ec.make("sphere", kind="inclusion-shape", center=(0.0, 0.0, 2e-6), radius=1e-6)
    order = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    for quantity, count in (("stress", 6), ("strain", 6), ("displacement", 3)):
        expected = ec.inclusion_field(
            shape, 1e-3 * np.eye(3), points, young_modulus=E, poisson_ratio=NU, quantity=quantity
        )
        if count == 6:
            expected = np.stack([expected[:, i, j] for i, j in order], axis=-1)
        found = data[f"cut_{quantity}"][0]
        assert found.dims[0] == ("component" if count == 6 else "axis")
        np.testing.assert_allclose(
            found.values.reshape(count, -1).T, expected, rtol=1e-12, atol=1e-13 * np.abs(expected).max()
        )
    stress, strain = (data[f"cut_{name}"][0].values for name in ("stress", "strain"))
    outside = (0.3e-6**2 + y**2 + (z - 2e-6) ** 2) > 1e-12
    lame = E * NU / (1 + NU) / (1 - 2 * NU) * strain[:3].sum(axis=0)
    np.testing.assert_allclose(stress[0][outside], (lame + E / (1 + NU) * strain[0])[outside], atol=1e-3)


def test_one_inclusion_at_many_centers_is_many_inclusions(monkeypatch):
    """And the compiled sum of a cloud gives what the closed forms give one by one."""
    from eigencontact.execution.routes import closed_form

    centers = [[2e-6 * i, 3e-6 * j, 2e-6 + 1e-6 * i] for i in (-1, 0, 1) for j in (-1, 1)]
    region = {"shape": "plane", "depth-max": 4e-6, "depth-cells": 5}
    one_by_one = run(inclusions=[{**BALL, "center": [x, y, z + 1e-6]} for x, y, z in centers], stress=region).dataset
    monkeypatch.setattr(closed_form, "_CLOUD", 2)
    shape = {name: value for name, value in BALL.items() if name != "center"}
    cloud = run(inclusions={**shape, "centers": [[x, y, z + 1e-6] for x, y, z in centers]}, stress=region).dataset
    for name in ("residual_displacement_z", "residual_displacement_x", "plane_y1_stress"):
        largest = float(np.abs(one_by_one[name]).max())
        np.testing.assert_allclose(cloud[name], one_by_one[name], rtol=0, atol=1e-12 * largest)


def test_full_space_leaves_the_free_surface_out():
    """The uplift of a full space is that of Eshelby's ball, 4 (1 - nu) times smaller (Davies 2003)."""
    lifted = [run(numerics={"half-space": space}).summary["max_uplift"] for space in ("exact", "full-space")]
    assert lifted[0] / lifted[1] == close(4 * (1 - NU), rel=1e-12, abs=0)


# ---------------------------------------------------------------- time

HEAT = {"type": "thermal", "expansion": 1e-5, "temperature": 100.0, "times": [0.0, 2.0], "factors": [0.0, 1.0]}


def test_eigenstrain_follows_its_history_step_by_step():
    steady = {**BALL, "center": [2e-6, 0.0, 3e-6]}
    varying = {**BALL, "eigenstrain": HEAT}
    region = {"shape": "line", "start": [0, 0, 0], "end": [0, 0, 4e-6], "count": 5}
    steps = [{"increments": 2}, {}, {}]
    alone, base = (
        run(inclusions=inclusions, steps=steps, stress=region).dataset for inclusions in ([varying, steady], [steady])
    )
    full = run(stress=region).dataset
    np.testing.assert_allclose(alone.time, [0.5, 1.0, 2.0, 3.0])
    for name in ("residual_displacement_z", "line_body1_stress"):
        for step, factor in enumerate((0.25, 0.5, 1.0, 1.0)):
            expected = base[name][step] + factor * full[name][0].values
            np.testing.assert_allclose(
                alone[name][step], expected, rtol=0, atol=1e-13 * float(np.abs(full[name]).max())
            )


def test_an_interrupted_run_of_eigenstrain_is_resumed(tmp_path):
    scene = {"body1": STEEL, "inclusions": [{**BALL, "eigenstrain": HEAT}], "grid": GRID, "steps": {"increments": 4}}
    scene |= {"output": {"pictures": False}}

    class Fatal:
        def step_started(self, point, _):
            if point.index == 3:
                raise KeyboardInterrupt

        def iterated(self, *_): ...

        def step_finished(self, *_): ...

    with pytest.raises(KeyboardInterrupt):
        ec.run(scene, tmp_path / "out", watcher=Fatal())
    assert len(list((tmp_path / "out" / "steps").glob("*.step"))) == 2
    resumed = ec.run(scene, tmp_path / "out", resume=True)
    whole = ec.run(scene)
    np.testing.assert_array_equal(resumed.dataset.residual_displacement_z, whole.dataset.residual_displacement_z)
    assert [row["step"] for row in resumed.summary["history"]] == [1, 2, 3, 4]
    assert resumed.summary["history"][0]["max_uplift"] == close(whole.summary["max_uplift"] / 4, rel=1e-12, abs=0)
    resumed.dataset.close()


# ---------------------------------------------------------------- contact and eigenstrain together


def test_a_deep_ball_does_nothing_to_a_contact():
    far = {**BALL, "center": [0.0, 0.0, 3e-3]}
    region = {"stress": {"shape": "plane", "depth-max": 5e-6, "depth-cells": 4}}
    both = ec.run({"body1": STEEL, "inclusions": [far], **CONTACT, **region})
    plain = ec.run({"body1": STEEL, **CONTACT, **region})
    peak = plain.summary["max_pressure"]
    np.testing.assert_allclose(both.dataset.pressure, plain.dataset.pressure, rtol=0, atol=1e-7 * peak)
    np.testing.assert_allclose(both.dataset.plane_y1_stress, plain.dataset.plane_y1_stress, rtol=0, atol=1e-7 * peak)
    assert both.summary["approach"] == close(plain.summary["approach"], rel=1e-7, abs=0)


def test_a_wide_swollen_layer_shifts_the_approach_and_stresses_the_layer():
    """Wide layer of thickness t: uplift 2 (1 + nu) e t (Davies, integrated), stress -E e/(1 - nu) along the surface."""
    t, e = 2e-6, 1e-4
    layer = {"type": "cuboid", "center": [0.0, 0.0, t / 2], "edges": [0.1, 0.1, t], "eigenstrain": e}
    region = {"stress": {"shape": "points", "points": [[0.25e-6, 0.25e-6, 0.5e-6], [0.25e-6, 0.25e-6, 3e-6]]}}
    both = ec.run({"body1": STEEL, "inclusions": [layer], **CONTACT, **region})
    plain = ec.run({"body1": STEEL, **CONTACT, **region})
    peak = plain.summary["max_pressure"]
    uplift = 2 * (1 + NU) * e * t
    assert both.summary["max_uplift"] == close(uplift, rel=1e-4, abs=0)
    np.testing.assert_allclose(both.dataset.pressure, plain.dataset.pressure, rtol=0, atol=1e-6 * peak)
    assert plain.summary["approach"] - both.summary["approach"] == close(uplift, rel=1e-4, abs=0)
    extra = both.dataset.points_body1_stress[0].values - plain.dataset.points_body1_stress[0].values
    inside = -E * e / (1 - NU)
    np.testing.assert_allclose(extra[:, 0], [inside, inside, 0, 0, 0, 0], atol=2e-4 * abs(inside))
    np.testing.assert_allclose(extra[:, 1], 0.0, atol=2e-4 * abs(inside))


def test_the_gap_is_separation_and_both_displacements():
    """gap = h + u(pressure) + u(eigenstrain) - approach everywhere; a ball below the contact raises the peak."""
    near = {**BALL, "center": [1e-6, 0.0, 2e-6], "eigenstrain": 2e-2}
    both = ec.run({"body1": STEEL, "inclusions": [near], **CONTACT, "output": {"tangential-displacement": True}})
    data = both.dataset
    y, x = np.meshgrid(data.y, data.x, indexing="ij")
    h = (x**2 + y**2) / (2 * 105e-6)
    approach = both.summary["approach"]
    gap = h + data.displacement_z[0] + data.residual_displacement_z[0] - approach
    np.testing.assert_allclose(data.gap[0], np.maximum(gap, 0.0), atol=1e-7 * approach)
    assert float(gap.min()) > -1e-7 * approach
    assert "reference_pressure" not in data
    assert {"residual_displacement_x", "displacement_x"} <= set(data)
    plain = ec.run({"body1": STEEL, **CONTACT})
    assert both.summary["max_pressure"] > 1.05 * plain.summary["max_pressure"]
    _, column = np.unravel_index(int(np.argmax(data.pressure[0].values)), data.pressure[0].shape)
    assert 0.0 < float(data.x[column]) < 2e-6


@pytest.mark.parametrize("body", [1, 2])
def test_an_inclusion_in_either_of_two_like_bodies_presses_alike(body):
    """Seen from the interface the bodies are mirror images; along the surface the displacement changes sign."""
    bodies = {"body1": STEEL, "body2": STEEL}
    region = {"stress": {"shape": "plane", "depth-max": 4e-6, "depth-cells": 4, "body": body, "name": "cut"}}
    changed = {"output": {"tangential-displacement": True}}
    first = ec.run({**bodies, "inclusions": [BALL], **CONTACT, **changed, "stress": {**region["stress"], "body": 1}})
    other = ec.run({**bodies, "inclusions": [{**BALL, "body": body}], **CONTACT, **changed, **region})
    sign = 1.0 if body == 1 else -1.0
    for name, factor in (("pressure", 1.0), ("gap", 1.0), ("cut_stress", 1.0), ("residual_displacement_x", sign)):
        largest = float(np.abs(first.dataset[name]).max())
        np.testing.assert_allclose(other.dataset[name], factor * first.dataset[name], rtol=0, atol=1e-9 * largest)


def test_observers_see_the_residual_displacement():
    probe = {"type": "probe", "field": "residual_displacement_z", "points": [[0.0, 0.0]]}
    summary = run(observers=[probe]).summary
    assert summary["observed"]["probe_residual_displacement_z_1"] == close(-summary["max_uplift"], rel=1e-12, abs=0)


def test_strain_under_a_contact_is_hookes_strain_and_the_eigenstrain():
    """Total strain = compliance times stress + eigenstrain inside, compliance times stress outside."""
    wide = {
        "type": "cuboid",
        "center": [0.0, 0.0, 3e-6],
        "edges": [30e-6, 30e-6, 2e-6],
        "eigenstrain": [1e-4, 2e-4, 0.0],
    }
    region = {"shape": "line", "start": [0.2e-6, 0, 0], "end": [0.2e-6, 0, 5.9e-6], "count": 7, "name": "axis"}
    data = ec.run(
        {"body1": STEEL, "inclusions": [wide], **CONTACT, "stress": {**region, "fields": ["stress", "strain"]}}
    ).dataset
    stress, strain, z = (data[f"axis_{name}"].values for name in ("stress", "strain", "z"))
    stress, strain = stress[0], strain[0]
    elastic = ((1 + NU) * stress[:3] - NU * stress[:3].sum(axis=0)) / E
    inside = (z > 2e-6) & (z < 4e-6)
    assert inside.any()
    np.testing.assert_allclose(strain[:3] - elastic, np.outer([1e-4, 2e-4, 0.0], inside), atol=1e-15)
