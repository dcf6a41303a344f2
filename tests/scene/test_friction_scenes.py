"""Scenes with friction: the table of the law, steps along the surface, what steps keep, and what is refused."""

import tomllib
from dataclasses import fields

import numpy as np
import pytest
import tomli_w

from bodies import rubbed
from close import close
from eigencontact import load_scene, make, plan, run
from eigencontact.core.rigid_modes import NORMAL_MODES, TANGENTIAL_MODES
from eigencontact.errors import PluginError, SceneError
from eigencontact.scene.holding import held_steps
from eigencontact.scene.schema import Step
from eigencontact.solvers.control import Control
from eigencontact.solvers.tangential.control import TangentialControl
from one_line import one_line_error

UM = 1e-6
COULOMB = {"type": "coulomb", "coefficient": 0.3}
BALL = {"type": "sphere", "radius": "105 um"}
PRESSED = {"normal-load": "0.65 N"}
PULLED = [PRESSED, {"tangential-load-x": "0.1 N"}]


def scene(**changes):
    grid = {"cells": 24, "size": ["16 um", "16 um"]}
    return rubbed(**{"friction": COULOMB, "grid": grid, "steps": PRESSED, **changes})


# field, text, SI value
UNITS = [
    ("tangential-load-x", "100 mN", 0.1),
    ("tangential-load-y", "-1 N", -1.0),
    ("shift-x", "25 nm", 2.5e-8),
    ("shift-y", "-3 um", -3e-6),
    ("torsion-moment", "10 uN*m", 1e-5),
    ("torsion-moment", "2 N*mm", 2e-3),
    ("twist", "0.1 mrad", 1e-4),
    ("twist", "90 deg", np.pi / 2),
]


@pytest.mark.parametrize(("name", "text", "value"), UNITS)
def test_steps_along_the_surface_have_units(name, text, value):
    (step,) = load_scene(scene(steps=PRESSED | {name: text})).steps
    assert getattr(step, name.replace("-", "_")) == close(value, rel=1e-15, abs=0)
    assert step.prescribed == ["normal-load", name]


@pytest.mark.parametrize(("control", "modes"), [(Control, NORMAL_MODES), (TangentialControl, TANGENTIAL_MODES)])
def test_rigid_modes_are_fields_of_steps_and_controls(control, modes):
    names = {name for mode in modes for name in mode}
    assert {item.name for item in fields(control)} == names
    assert names <= set(Step.model_fields)


# steps, what the last of them prescribes with all that it keeps
HELD = {
    "alone": ([{"normal_load": 1.0}], {"normal_load": 1.0}),
    "normal load": ([{"normal_load": 1.0}, {"shift_x": 2.0}], {"normal_load": 1.0, "shift_x": 2.0}),
    "approach in place of load": ([{"normal_load": 1.0}, {"approach": 3.0}, {}], {"approach": 3.0}),
    "load in place of shift": (
        [{"normal_load": 1.0, "shift_x": 2.0}, {"tangential_load_x": 0.0}, {"increments": 3}],
        {"normal_load": 1.0, "tangential_load_x": 0.0},
    ),
    "each pair by itself": (
        [{"approach": 1.0, "tangential_load_y": 2.0, "twist": 3.0}, {"shift_y": 4.0}, {"torsion_moment": 5.0}],
        {"approach": 1.0, "shift_y": 4.0, "torsion_moment": 5.0},
    ),
    "tilt": ([{"normal_load": 1.0, "tilt_x": 2.0}, {"moment_y": 3.0}], {"normal_load": 1.0, "tilt_x": 2.0,
                                                                        "moment_y": 3.0}),
}  # fmt: skip


@pytest.mark.parametrize("case", HELD)
def test_a_step_keeps_what_it_does_not_mention(case):
    steps, expected = HELD[case]
    last = held_steps([Step(**step) for step in steps])[-1]
    assert {name.replace("-", "_"): getattr(last, name.replace("-", "_")) for name in last.prescribed} == expected
    assert last.increments == steps[-1].get("increments", 1)


def test_without_friction_each_step_says_how_it_is_controlled():
    with pytest.raises(SceneError, match=r"steps\.1 must be controlled by normal-load or approach: give one of them"):
        load_scene(scene(friction=None, steps=[PRESSED, {"increments": 2}]))
    assert len(load_scene(scene(steps=[PRESSED, {"increments": 2}])).steps) == 2


def test_the_law_is_a_table_a_component_or_a_change(command, scene_file):
    law = make("coulomb-map", coefficient=0.1, regions=[{"radius": 2e-6, "coefficient": 0.5}])
    assert plan(scene(friction=law)).model.friction == law
    assert plan(scene()).model.friction == make("coulomb", coefficient=0.3)
    assert plan(scene(friction=None)).model.friction is None
    path = scene_file('[friction]\ntype = "shear-cap"\ncoefficient = 0.2\ncap = "1 GPa"\n')
    changed = plan(load_scene(path, ["friction.coefficient=0.4"])).model.friction
    assert changed == make("shear-cap", coefficient=0.4, cap=1e9)
    listed = command("plugins").out
    for key in ("coulomb", "coulomb-map", "shear-cap"):
        assert f"\n  {key} " in listed.split("friction-law")[1]


@pytest.mark.parametrize(
    "law",
    [
        COULOMB,
        {"type": "coulomb-map", "coefficient": 0.1, "regions": [{"radius": "2 um", "coefficient": 0.5}]},
        make("coulomb-map", coefficient=0.1, regions=[{"radius": 2e-6, "coefficient": 0.5}]),
        make("shear-cap", coefficient=0.1, cap=1e9),
    ],
)
def test_the_resolved_scene_loads_as_the_same_scene(law):
    first = load_scene(scene(friction=law, steps=PULLED))
    again = load_scene(tomllib.loads(tomli_w.dumps(first.resolved())))
    assert again.resolved() == first.resolved()
    assert plan(again).model.friction == plan(first).model.friction


def test_the_map_of_a_scene_counts_from_its_folder(tmp_path, monkeypatch):
    axis = UM * np.array([-9.0, 0.0, 9.0])
    np.savez(tmp_path / "mu.npz", x=axis, y=axis, coefficient=np.full((3, 3), 0.2))
    tables = scene(friction={"type": "coulomb-map", "file": "mu.npz"})
    (tmp_path / "my.toml").write_text(tomli_w.dumps(tables), encoding="utf-8")
    monkeypatch.chdir("/")
    loaded = load_scene(tmp_path / "my.toml")
    assert loaded.resolved()["friction"]["file"] == str(tmp_path / "mu.npz")
    assert plan(loaded).model.friction.coefficients(np.zeros((1, 1)), np.zeros((1, 1))) == 0.2


# changes to the scene, words of the refusal
REFUSED = {
    "negative coefficient": (
        {"friction": {"type": "coulomb", "coefficient": -0.1}},
        "friction.coefficient must be zero or positive, and finite [-] (got -0.1)",
    ),
    "coefficient in words": (
        {"friction": {"type": "coulomb", "coefficient": "low"}},
        "friction.coefficient must be a number (got 'low')",
    ),
    "typo of a key": (
        {"friction": {"type": "coulomb", "coeficient": 0.1}},
        "unknown key 'coeficient' in friction (coulomb); known: coefficient; did you mean 'coefficient'?",
    ),
    "typo in a region": (
        {"friction": {"type": "coulomb-map", "coefficient": 0.1, "regions": [{"radios": 1.0, "coefficient": 0.1}]}},
        "unknown key 'radios' in friction.regions.0; known: coefficient, center, size, angle, radius; did you mean",
    ),
    "typo of the table": ({"frcition": COULOMB}, "did you mean 'friction'?"),
    "typo of a step": (
        {"steps": PRESSED | {"tangental-load-x": 1.0}},
        "did you mean 'tangential-load-x'?",
    ),
    "unknown law": (
        {"friction": {"type": "colomb", "coefficient": 0.1}},
        "friction: unknown friction-law 'colomb'; installed: 'by-material', 'coulomb', 'coulomb-map'",
    ),
    "no type": (
        {"friction": {"coefficient": 0.1}},
        "friction.type must name a friction-law (got None); installed: 'by-material', 'coulomb', 'coulomb-map'",
    ),
    "two laws": ({"friction": [COULOMB, COULOMB]}, "friction must be a table (got [{"),
    "a number for a law": ({"friction": 0.3}, "friction must be a table (got 0.3)"),
    "load without friction": (
        {"friction": None, "steps": PULLED[0] | PULLED[1]},
        "steps must not prescribe tangential-load-x without friction (got a frictionless contact, which carries no sh",
    ),
    "twist without friction": (
        {"friction": None, "steps": [PRESSED, PRESSED | {"twist": 0.1}]},
        "steps.1 must not prescribe twist without friction",
    ),
    "both along x": (
        {"steps": PRESSED | {"tangential-load-x": 0.0, "shift-x": 0.0}},
        "steps must be controlled by tangential-load-x or shift-x, not both",
    ),
    "both along y": (
        {"steps": PRESSED | {"tangential-load-y": 0.0, "shift-y": 0.0}},
        "steps must be controlled by tangential-load-y or shift-y, not both",
    ),
    "both of torsion": (
        {"steps": [PRESSED, {"torsion-moment": 0.0, "twist": 0.0}]},
        "steps.1 must be controlled by torsion-moment or twist, not both",
    ),
    "load without geometry": (
        {"geometry": None, "friction": None, "eigenstrain": {"type": "uniform", "value": 1e-3, "depth": 1e-6},
         "steps": {"shift-y": 1e-9}},
        "steps must not prescribe shift-y without a contact (got no geometry); add [geometry]",
    ),
    "friction without geometry": (
        {"geometry": None, "eigenstrain": {"type": "uniform", "value": 1e-3, "depth": 1e-6}, "steps": None},
        "friction must be left out of a scene without a contact (got no geometry); add [geometry]",
    ),
    "both rigid": ({"body1": {"rigid": True}}, "body1 and body2 must not both be rigid; give one of them"),
    "never pressed": (
        {"steps": [{"tangential-load-x": 0.1}, PRESSED]},
        "steps.0 must be controlled by normal-load or approach: give one of them (got tangential-load-x)",
    ),
    "NaN load": (
        {"steps": PRESSED | {"tangential-load-x": float("nan")}},
        "steps.tangential-load-x must be finite [N] (got nan)",
    ),
    "infinite twist": ({"steps": PRESSED | {"twist": float("inf")}}, "steps.twist must be finite [rad] (got inf)"),
    "unit of a shift": ({"steps": PRESSED | {"shift-x": "1 N"}}, "steps.shift-x must be a length [m]; '1 N' has the"),
    "unit of a moment": ({"steps": PRESSED | {"torsion-moment": "1 N"}}, "steps.torsion-moment must be a moment [N*m]"),
    "coupling": (
        {"numerics": {"coupling": "parcial"}},
        "numerics.coupling must be one of 'none', 'partial', 'one-way' or 'full' (got 'parcial'); did you mean 'partia",
    ),
    "map with a hole": ({"friction": {"type": "coulomb-map", "file": "holed.npz"}}, "1 of 9 are not, the first is nan"),
    "no map": ({"friction": {"type": "coulomb-map", "file": "none.npz"}}, "must be an existing file (got 'none.npz')"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_refusals_are_one_line(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    values = np.full((3, 3), 0.2)
    values[1, 1] = np.nan
    np.savez("holed.npz", x=UM * np.arange(3), y=UM * np.arange(3), coefficient=values)
    changes, words = REFUSED[case]
    with one_line_error(words):
        plan(load_scene(scene(**changes)))


def test_torsion_without_coupling_is_allowed_and_takes_both_directions():
    fields = run(plan(scene(steps=[PRESSED, {"twist": "1 mrad"}]))).dataset.isel(step=-1)
    assert float(np.abs(fields["shear_x"]).max()) == close(float(np.abs(fields["shear_y"]).max()), rel=1e-6)
    assert float(fields["torsion_moment"]) > 0


# law, shear bound at a pressure p and place x
LAWS = {
    "coulomb": (COULOMB, lambda p, _x: 0.3 * p),
    "shear-cap": (
        {"type": "shear-cap", "coefficient": 0.3, "cap": "1 GPa"},
        lambda p, _x: np.minimum(0.3 * p, 1e9),
    ),
    "coulomb-map": (
        {
            "type": "coulomb-map",
            "coefficient": 0.1,
            "regions": {"center": ["8 um", 0.0], "size": ["16 um", "16 um"], "coefficient": 0.5},
        },
        lambda p, x: np.where(x > 0, 0.5, 0.1) * p,
    ),
}


@pytest.mark.parametrize("case", LAWS)
def test_gross_slip_carries_the_bound_of_the_law(case):
    """Far behind the shift every point slips: the shear is the bound, and the load is its sum."""
    law, bound = LAWS[case]
    fields = run(plan(scene(friction=law, steps=[PRESSED, {"shift-x": "2 um"}]))).dataset.isel(step=-1)
    expected = bound(fields["pressure"].values, fields["x"].values[None, :])
    np.testing.assert_allclose(fields["shear_x"].values, expected, rtol=1e-9, atol=1e-6 * expected.max())
    area = (16 * UM / 24) ** 2
    assert float(fields["tangential_load_x"]) == close(expected.sum() * area, rel=1e-9)
    assert float(fields["slip_fraction"]) == 1.0


STRANGER = """
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import FrictionLaw, hookimpl


@dataclass(frozen=True, kw_only=True)
class Odd(FrictionLaw):
    '''A law that goes wrong.'''

    key: ClassVar[str] = "odd"

    answer: str = "nan"

    def shear_bound(self, state):
        wrong = {"nan": np.nan * state.pressure, "negative": -state.pressure, "flat": state.pressure[0]}
        return wrong[self.answer]


@hookimpl
def eigencontact_register():
    return [Odd]
"""


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        ("nan", r"must be zero or positive, and finite \[Pa\] \(got nan at x = "),
        ("negative", r"must be zero or positive, and finite \[Pa\] \(got -"),
        ("flat", r"must be of shape \(24, 24\), that of the pressure \(got shape \(24,\)\)"),
        ("none", r"must return without an exception \(got KeyError: 'none', line"),
    ],
)
def test_a_run_names_the_law_that_goes_wrong(answer, words, install):
    install(STRANGER)
    with pytest.raises(PluginError, match=f"^shear_bound of friction law 'odd' {words}"):
        run(plan(scene(friction={"type": "odd", "answer": answer})))


def test_contact_beyond_the_map_stops_the_run_with_a_line(command, scene_file, tmp_path):
    axis = UM * np.array([-2.0, 0.0, 2.0])
    np.savez(tmp_path / "mu.npz", x=axis, y=axis, coefficient=np.full((3, 3), 0.2))
    path = scene_file('[friction]\ntype = "coulomb-map"\nfile = "mu.npz"\n')
    done = command("run", path, "-o", tmp_path / "out")
    assert done.code == 2
    assert done.err.count("\n") == 1
    assert "coulomb-map.file must cover the contact (got " in done.err
    assert "give coefficient for the surface outside the map" in done.err
    done = command("run", path, "-o", tmp_path / "out", "--set", "friction.coefficient=0.1")
    assert done.code == 0, done.err
