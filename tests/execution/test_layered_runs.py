"""Runs with layered bodies: like layers, either body, every coupling, fields across interfaces, resume."""

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.execution.fields.regions import RunningRegion
from eigencontact.execution.run.driver import drive
from eigencontact.planning.plan import Plan
from eigencontact_plugins.layered.stack import BondedLayers, Layer, Substrate

#: Thickness of the coating [m]; E [Pa] of the substrate; ball of 10 h that touches the bare substrate in a radius of h.
H, E, NU = 1e-6, 210e9, 0.3
RADIUS = 10 * H
LOAD = 4 / 3 * E / (1 - NU**2) * H**3 / RADIUS
MU = 0.4
SECTION = {
    "name": "section", "shape": "plane", "normal": "y", "fields": ["stress", "strain"],
    "depths": [0.0, 0.4 * H, H * (1 - 1e-9), H, 1.7 * H],
}  # fmt: skip
POINTS = {"name": "points", "shape": "points", "points": [[0.1 * H, 0.0, 0.3 * H], [0.0, 0.5 * H, 1.2 * H]],
          "fields": ["stress", "strain"]}  # fmt: skip
ROW = {name: row for row, name in enumerate(("xx", "yy", "zz", "yz", "xz", "xy"))}
SOLID = {"young-modulus": E, "poisson-ratio": NU}
SLIDE = [{"normal-load": LOAD}, {"tangential-load-x": 0.3 * MU * LOAD}]


def coating(ratio=1.0, nu=NU, *, layers=1, factor=1.0):
    """Body of H, in so many layers, on a substrate; moduli times a factor."""
    layer = Layer(thickness=H / layers, young_modulus=ratio * factor * E, poisson_ratio=nu)
    substrate = Substrate(young_modulus=factor * E, poisson_ratio=NU)
    return {"medium": BondedLayers(layers=(layer,) * layers, substrate=substrate)}


def scene(body1=SOLID, *, body2=None, boundary="periodic", cells=24, width=4 * H, coupling=None, **more):
    steps = {"normal-load": LOAD} if coupling is None else SLIDE
    friction = None if coupling is None else {"type": "coulomb", "coefficient": MU}
    numerics = {"boundary": boundary, "threads": 1, "coupling": coupling or "full", "tolerance": 1e-8}
    return ec.Scene(
        **{
            "body1": body1, "body2": body2 or {"rigid": True}, "geometry": {"type": "sphere", "radius": RADIUS},
            "grid": {"cells": cells, "size": [width, width]}, "steps": steps, "numerics": numerics,
            "friction": friction, "output": {"pictures": False}, **more,
        }
    )  # fmt: skip


def fields_of(made):
    """Fields of the last step, those of regions as ``<region>_<field>``; nothing is stored."""
    *_, last = drive(made if isinstance(made, Plan) else ec.plan(made))
    regions = {f"{name}_{key}": values for name, part in last.regions.items() for key, values in part.fields.items()}
    return last.fields | regions


def agree(one, other, *, rtol):
    """Fields agree, relative to the size of each kind."""
    peak = float(other["pressure"].max())
    kinds = {"section_stress": 1, "section_strain": 1 / E, "points_stress": 1, "points_strain": 1 / E, "pressure": 1}
    for name, size in (kinds | {"shear_x": 1, "displacement_z": H / E}).items():
        assert (name in one) == (name in other)
        if name in other:
            np.testing.assert_allclose(one[name], other[name], rtol=0, atol=rtol * size * peak, err_msg=name)


@pytest.mark.parametrize("coupling", [None, "none", "partial", "one-way", "full"])
def test_like_layers_are_no_layers(coupling):
    """In a periodic window, by the response to waves: every field, stress and strain under pressure and shear."""
    layered = fields_of(scene(coating(layers=3), coupling=coupling, stress=SECTION))
    agree(layered, fields_of(scene(coupling=coupling, stress=SECTION)), rtol=1e-6)


@pytest.mark.parametrize("coupling", [None, pytest.param("full", marks=pytest.mark.slow)])
def test_like_layers_are_no_layers_in_a_half_space_without_end(coupling):
    """By coefficients of cells; on a lattice and at points between cells."""
    more = {"boundary": "non-periodic", "cells": 12, "stress": [SECTION, POINTS]}
    layered = fields_of(scene(coating(layers=2), coupling=coupling, **more))
    agree(layered, fields_of(scene(coupling=coupling, **more)), rtol=1e-6)


@pytest.mark.parametrize("ratio", [0.5, 4.0])
def test_across_an_interface(ratio):
    """Tractions and in-plane strains are continuous; σ_xx jumps by what Hooke's law says."""
    data = fields_of(scene(coating(ratio), coupling="full", stress=SECTION))
    stress, strain = data["section_stress"], data["section_strain"]
    size = np.abs(stress).max()
    jump = stress[:, 2] - stress[:, 3]
    for name in ("zz", "xz", "yz"):
        assert np.abs(jump[ROW[name]]).max() <= 1e-7 * size
    assert np.abs(jump[ROW["xx"]]).max() > 0.05 * size
    for name in ("xx", "yy", "xy"):  # but for the mean over a period, where each layer is free to spread
        assert np.ptp((strain[:, 2] - strain[:, 3])[ROW[name]]) <= 1e-7 * size / E
    trace = stress[:3].sum(axis=0)
    for layer, modulus in enumerate((ratio * E, ratio * E, ratio * E, E, E)):
        hooke = ((1 + NU) * stress[ROW["xx"], layer] - NU * trace[layer]) / modulus
        np.testing.assert_allclose(strain[ROW["xx"], layer], hooke, rtol=0, atol=1e-12 * size / E)


def test_either_body_may_be_layered():
    """Seen from body 2 the load along the surface is the opposite one: the same contact, mirrored in x."""
    first = fields_of(scene(coating(2.0), coupling="full", stress=SECTION))
    second = fields_of(scene({"rigid": True}, body2=coating(2.0), coupling="full", stress={**SECTION, "body": 2}))
    size = float(first["pressure"].max())
    for name in ("pressure", "shear_x", "section_von_mises"):
        np.testing.assert_allclose(second[name], first[name][..., ::-1], rtol=0, atol=1e-6 * size, err_msg=name)


def test_two_like_bodies_move_alike():
    """Normal and tangential contact part, and together they give way like one body of half the stiffness."""
    both = ec.plan(scene(coating(2.0), body2=coating(2.0), coupling="full"))
    assert any("Dundurs' constant is 0" in item.reason for item in both.left_out)
    assert any("counted twice" in item.reason for item in both.left_out)
    single = scene(coating(2.0, factor=0.5), coupling="partial")
    agree(fields_of(both), fields_of(single), rtol=1e-6)


def test_a_layered_and_a_homogeneous_body():
    """Each side brings its own compliance: like layers on one side are the two homogeneous bodies."""
    soft = {"young-modulus": 0.3 * E, "poisson-ratio": 0.2}
    layered = fields_of(scene(coating(layers=2), body2=soft, coupling="full"))
    agree(layered, fields_of(scene(body2=soft, coupling="full")), rtol=1e-6)


def test_eigenstrain_under_the_other_body_and_tangential_displacement():
    """A sphere that swells in the homogeneous body lifts the contact with the layered one."""
    soft = {"young-modulus": 0.3 * E, "poisson-ratio": 0.2}
    swelling = {"type": "sphere", "body": 2, "center": [0, 0, 2 * H], "radius": H, "eigenstrain": 1e-3}
    more = {
        "body2": soft, "boundary": "non-periodic", "cells": 12, "inclusions": swelling, "stress": [SECTION],
        "output": {"tangential-displacement": True},
    }  # fmt: skip
    layered, bare = fields_of(scene(coating(layers=2), **more)), fields_of(scene(**more))
    agree(layered, bare, rtol=1e-6)
    size = np.abs(bare["displacement_z"]).max()
    np.testing.assert_allclose(layered["displacement_x"], bare["displacement_x"], rtol=0, atol=1e-6 * size)


@pytest.mark.parametrize("nu", [0.5, -0.5])
def test_extreme_layers(nu):
    data = fields_of(scene(coating(2.0, nu), coupling="full", stress=SECTION))
    assert np.isfinite(data["section_stress"]).all()
    strain = data["section_strain"][:, :3]  # in the coating
    spread = np.abs(strain[:3].sum(axis=0)).max() / np.abs(strain).max()
    assert (spread < 1e-9) == (nu == 0.5)


@pytest.mark.slow
def test_a_resumed_run_is_the_whole_run(tmp_path, monkeypatch):
    made = scene(coating(2.0), coupling="full", stress=SECTION)
    whole = ec.run(made).dataset
    original, calls = RunningRegion.advance, []

    def cut(self, step):
        calls.append(step.index)
        if step.index == 2 and len(calls) == 2:
            raise KeyboardInterrupt
        original(self, step)

    monkeypatch.setattr(RunningRegion, "advance", cut)
    with pytest.raises(KeyboardInterrupt):
        ec.run(made, tmp_path)
    resumed = ec.run(made, tmp_path, resume=True).dataset
    assert calls == [1, 2, 2]
    for name in ("pressure", "shear_x", "section_stress"):
        np.testing.assert_array_equal(resumed[name], whole[name])
    resumed.close()
