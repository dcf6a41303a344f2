"""Plans of contacts with friction: which kernels each coupling builds, what it leaves out and says so, the price."""

from collections import Counter

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL
from eigencontact.core.material import Material
from eigencontact.execution.mechanics.friction_cost import friction_cost
from eigencontact.model.coupling import Coupling
from eigencontact.scene.schema import Numerics
from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY

PULL = {"normal_load": 1.0, "tangential_load_x": 0.1}
#: Displacement and traction of the kernels that each coupling adds to the one before it.
NORMAL, ALONG = {("z", "z")}, {("x", "x"), ("y", "y")}
ACROSS, BY_PRESSURE = {("x", "y"), ("y", "x")}, {("x", "z"), ("y", "z")}
BY_SHEAR = {("z", "x"), ("z", "y")}


def scene(*, body2=None, coupling="full", steps=PULL, **more):
    """A ball on steel, a few cells."""
    return ec.Scene(
        **{
            "body1": STEEL,
            "body2": body2 or {"rigid": True},
            "geometry": {"type": "sphere", "radius": 200e-6},
            "friction": {"type": "coulomb", "coefficient": 0.3},
            "grid": {"cells": 16, "size": [24e-6, 24e-6]},
            "steps": steps,
            "numerics": {"coupling": coupling, **more.pop("numerics", {})},
            **more,
        }
    )


def pairs(planned):
    """Directions of displacement and traction of the surface kernels."""
    uses = [use for use in planned.kernels if use.response.startswith("displacement")]
    return [(use.response[-1], {"pressure p": "z"}.get(use.traction, use.traction[-1])) for use in uses]


def left_out(planned):
    return {item.effect: item.reason for item in planned.left_out}


@pytest.mark.parametrize(
    ("coupling", "expected"),
    [
        ("none", NORMAL | {("x", "x")}),
        ("partial", NORMAL | ALONG | ACROSS),
        ("one-way", NORMAL | ALONG | ACROSS | BY_PRESSURE),
        ("full", NORMAL | ALONG | ACROSS | BY_PRESSURE | BY_SHEAR),
    ],
)
def test_each_coupling_builds_its_kernels_and_no_other(coupling, expected):
    planned = ec.plan(scene(coupling=coupling))
    found = pairs(planned)
    assert len(found) == len(expected)
    assert set(found) == expected
    assert [block.name for block in planned.blocks][:2] == ["separation", "frictional-contact"]
    assert set(planned.model.interface.influences) == {"p", "q_x"} | ({"q_y"} if coupling != "none" else set())


@pytest.mark.parametrize(
    ("body2", "alike"),
    [
        (STEEL, True),
        ({"young_modulus": 210e9, "poisson_ratio": 0.25}, False),
        ({"young_modulus": 70e9, "poisson_ratio": 0.3}, False),
        # (1 - 2 nu)/G of steel is 0.4 * 2.6/210 GPa: the same from nu = 0.2 and E = 0.6 * 2.4 / (0.4 * 2.6) * 210 GPa
        ({"young_modulus": 210e9 * 1.44 / 1.04, "poisson_ratio": 0.2}, True),
        ({"rigid": True}, False),
    ],
)
def test_what_vanishes_for_like_bodies_is_not_built(body2, alike):
    full, partial = (ec.plan(scene(body2=body2, coupling=name)) for name in ("full", "partial"))
    assert (set(pairs(full)) == set(pairs(partial))) is alike
    said = left_out(full).get("displacement along the surface by pressure, and along its normal by shear", "")
    assert ("the relative displacements vanish" in said) is alike


def test_an_incompressible_body_on_a_rigid_one_is_uncoupled():
    planned = ec.plan(scene(coupling="full", body1={"young_modulus": 1e9, "poisson_ratio": 0.5}))
    assert set(pairs(planned)) == NORMAL | ALONG | ACROSS


@pytest.mark.parametrize(
    ("step", "components"),
    [
        ({}, "x"),
        ({"shift_x": 1e-8}, "x"),
        ({"tangential_load_y": 0.1}, "y"),
        ({"shift_x": 1e-8, "shift_y": 1e-8}, "xy"),
        ({"twist": 1e-3}, "xy"),
        ({"torsion_moment": 1e-8}, "xy"),
    ],
)
def test_without_coupling_only_what_is_pulled_is_modelled(step, components):
    planned = ec.plan(scene(coupling="none", steps=[{"normal_load": 1.0}, {"normal_load": 1.0, **step}]))
    assert set(pairs(planned)) == NORMAL | {(c, c) for c in components}
    for c in "xy":
        assert (f"shear and displacement along {c}" in left_out(planned)) is (c not in components)
    (contact,) = [block for block in planned.blocks if block.name == "frictional-contact"]
    assert {name for name in contact.provides if name.startswith("shear")} == {f"shear_{c}" for c in components}


def test_asking_for_the_tangential_displacement_keeps_both_directions():
    planned = ec.plan(scene(coupling="none", output={"tangential_displacement": True}))
    assert set(pairs(planned)) == NORMAL | ALONG
    assert "tangential-displacement" not in [block.name for block in planned.blocks]


@pytest.mark.parametrize(
    ("coupling", "said"),
    [
        ("none", ["along y by shear along x", "along the surface by pressure", "along the normal by shear"]),
        ("partial", ["along the surface by pressure", "along the normal by shear"]),
        ("one-way", ["along the normal by shear"]),
        ("full", []),
    ],
)
def test_explain_says_what_a_coupling_leaves_out(coupling, said):
    steps = [PULL, {"tangential_load_y": 0.1}]
    planned = ec.plan(scene(coupling=coupling, steps=steps, stress=[{"shape": "points", "points": [[0, 0, 0]]}]))
    text = planned.explain()
    found = [what for what in left_out(planned) if what.startswith("displacement")]
    assert len(found) == len(said)
    for words in said:
        assert any(words in what for what in found)
        assert f"displacement {words}" in text
    assert f"coupling {coupling}" in text
    assert "friction    Coulomb(coefficient=0.3)" in text
    assert ("Goodman" in text) is (coupling == "one-way")
    assert "shear tractions q_x, q_y and their kernels" not in left_out(planned)
    stresses = [use.traction for use in planned.kernels if use.response.startswith("stress")]
    assert stresses == ["pressure p", "shear q_x", "shear q_y"]


def test_only_what_is_planned_is_sampled(monkeypatch):
    asked = Counter()
    for load in (PressureLoad, ShearLoadX, ShearLoadY):
        original = load.sample

        def sample(self, quantity, components, *rest, original=original):
            asked.update((self.direction, component) for component in components)
            return original(self, quantity, components, *rest)

        monkeypatch.setattr(load, "sample", sample)
    ec.run(scene(coupling="none"))
    assert set(asked) == {("z", "z"), ("x", "x")}
    asked.clear()
    ec.run(scene(coupling="one-way", steps={"normal_load": 1.0}))
    assert set(asked) == {(j, i) for i, j in NORMAL | ALONG | ACROSS | BY_PRESSURE}


def test_eigenstrain_under_friction_drags_the_surface_along():
    inclusions = [{"type": "sphere", "center": [0, 0, 10e-6], "radius": 5e-6, "eigenstrain": 1e-3}]
    for coupling in ("none", "partial"):
        planned = ec.plan(scene(coupling=coupling, inclusions=inclusions))
        (contact,) = [part for part in planned.parts if part.name == "frictional-contact"]
        assert contact.directions == "xyz"
        (mechanics,) = [block for block in planned.blocks if contact in block.parts]
        assert {name for name in mechanics.provides if name.startswith("residual")} == {
            f"residual_displacement_{c}" for c in "xyz"
        }


def test_the_law_is_among_the_components_and_its_source_is_cited():
    planned = ec.plan(scene())
    assert "friction-law" in {component.kind for component in planned.model.components}
    assert any("Coulomb" in text for text in planned.to_dict()["references"])
    assert any("Gallego" in text for text in planned.to_dict()["references"])
    assert not any("Gallego" in text for text in ec.plan("hertz").to_dict()["references"])


def test_the_price_rises_with_what_is_coupled():
    def price(*sets):
        found = sorted(set().union(*sets))
        along = "".join(c for c in "xy" if (c, c) in found)
        coupling = Coupling(level="full", components=along, pairs=tuple(found), alike=False)
        return friction_cost((64, 64), (40, 40), coupling, Numerics(threads=1))

    prices = [
        price(NORMAL, {("x", "x")}),
        price(NORMAL, ALONG, ACROSS),
        price(NORMAL, ALONG, ACROSS, BY_PRESSURE),
        price(NORMAL, ALONG, ACROSS, BY_PRESSURE, BY_SHEAR),
    ]
    for attribute in ("memory", "seconds_per_step"):
        values = [getattr(cost, attribute) for cost in prices]
        assert np.all(np.diff(values) > 0), attribute


def test_body_1_may_be_the_rigid_one():
    planned = ec.plan(
        scene(body1={"rigid": True}, body2=STEEL, stress=[{"shape": "points", "body": 2, "points": [[0, 0, 1e-6]]}])
    )
    assert planned.model.bodies.solids == (None, Material(young_modulus=210e9, poisson_ratio=0.3))
    assert planned.seconds > 0
