"""Whole contacts by finite elements with a contact of their own: profiles, runs, planted faults, what is left out."""

from __future__ import annotations

import json

import numpy as np
import pytest
import typer
import xarray as xr

import eigencontact as ec
from bodies import STEEL
from close import close
from eigencontact_verification.audit import contact_cases_of
from eigencontact_verification.audit.__main__ import main
from eigencontact_verification.audit.bodies import NotJudged
from eigencontact_verification.audit.contact_model import contact_model, pliancy
from eigencontact_verification.audit.contact_scene import contact_scene
from eigencontact_verification.crosscheck.judge import judge
from eigencontact_verification.crosscheck.run import Solved, tasks_of
from eigencontact_verification.crosscheck.worker import Outcome
from eigencontact_verification.fem.yielding import solve_indentation
from eigencontact_verification.oracles.coated_contact import coated_contact

MODULUS = 210e9 / (1 - 0.3**2)


def judged(case):
    """Verdicts by profile and component, all solved here."""
    outcomes = []
    for task in tasks_of(case):
        fields = case.judged() if task.level is None else case.reference(task.level, task.outer)
        outcomes.append((task, Outcome(status="done", fields=fields, seconds=0.0, memory=0)))
    return {(row.profile, row.component): row for row in judge(Solved(case=case, outcomes=tuple(outcomes))).rows}


def solved(profile, load, a, fine, layers=(), **changed):
    mesh = {
        "radius": a, "fine": fine, "extent": 1.6 * a, "inner": 0.0, "deep": 1.6 * a, "reach": 40 * a, "growth": 2.0,
        **changed,
    }  # fmt: skip
    given = {**STEEL, "law": None, "layers": list(layers), "regions": [], "profile": [profile], "mesh": mesh}
    return solve_indentation(contact_model(given, 3, "fixed"), [load]).moments[0]


@pytest.mark.slow
def test_a_rounded_punch_has_sneddon_s_radius_and_approach():
    """Load and approach of the profile max(0, r - b)²/2R by Sneddon's integrals, over the contact radius."""
    b, R, a = 100e-6, 1e-3, 107e-6
    t = b + (a - b) * np.polynomial.legendre.leggauss(40)[0] / 2 + (a - b) / 2
    weights = (a - b) / 2 * np.polynomial.legendre.leggauss(40)[1]

    def approach(x):
        return x * (np.sqrt(x * x - b * b) - b * np.arccos(b / x)) / R

    load = 2 * MODULUS * (a * approach(a) - np.sum(weights * approach(t)))
    profile = {"kind": "punch", "flat": b, "radius": R}
    found = solved(profile, load, a, (a - b) / 4, inner=b, extent=2 * a - b, deep=0.0)
    assert found.depth == close(approach(a), rel=1e-4)
    assert found.contact_radius == close(a, rel=1e-3)


def test_a_cone_has_sneddon_s_approach():
    """Far beyond its tip: δ = (π/2) a cot α less the R cot²α / 2 that the rounding takes off, P = (π/2) E* a² cot α."""
    a, R, angle = 10e-6, 1e-6, np.deg2rad(80)
    load = 0.5 * np.pi * MODULUS * a**2 / np.tan(angle)
    profile = {"kind": "cone", "half_angle": angle, "radius": R}
    found = solved(profile, load, a, a / 5)
    approach = 0.5 * np.pi * a / np.tan(angle) - 0.5 * R / np.tan(angle) ** 2
    assert found.depth == close(approach, rel=1e-3)
    assert found.contact_radius == close(a, rel=5e-3)
    assert pliancy([profile], a) * a == close(0.5 * np.pi * a / np.tan(angle), rel=1e-3)


def test_the_approach_of_a_punch_changes_by_sneddon_s_integral():
    b, R, a = 100e-6, 1e-3, 107e-6
    exact = (2 * np.sqrt(a * a - b * b) - b * np.arccos(b / a)) / R
    assert pliancy([{"kind": "punch", "flat": b, "radius": R}], a) == close(exact, rel=1e-3)
    assert pliancy([{"kind": "parabola", "radius": R}], a) == close(2 * a / R, rel=1e-6)


def test_a_coated_body_is_that_of_the_integral_equation():
    h, R, load = 2e-6, 20e-6, 0.123
    exact = coated_contact(load, R, [(h, 420e9, 0.3)], (210e9, 0.3))
    layer = {"thickness": h, "young_modulus": 420e9, "poisson_ratio": 0.3}
    found = solved({"kind": "parabola", "radius": R}, load, exact.radius, h / 3, [layer])
    assert found.depth == close(exact.approach, rel=1e-3)
    assert found.pressure.max() == close(exact.max_pressure, rel=1e-2)


def coated(thickness="2 um"):
    return ec.Scene(
        name="coated",
        body1={
            "medium": {
                "type": "bonded-layers",
                "layers": [{"thickness": thickness, "young-modulus": "420 GPa", "poisson-ratio": 0.3}],
                "substrate": {"young-modulus": "210 GPa", "poisson-ratio": 0.3},
            }
        },
        geometry={"type": "sphere", "radius": "20 um"},
        grid={"cells_per_contact_radius": 24, "margin": 1.6},
        steps={"normal_load": "0.12 N"},
        output={"pictures": False, "vtk": False},
    )


def changed(folder, target, old, new):
    """Copy of a run whose scene says something else."""
    target.mkdir()
    with xr.open_dataset(folder / "results.nc") as data:
        other = data.load()
    assert old in other.attrs["scene"]
    other.attrs["scene"] = other.attrs["scene"].replace(old, new)
    other.to_netcdf(target / "results.nc")
    return target


@pytest.mark.slow
def test_a_layer_that_is_thinner_than_it_was_is_caught(tmp_path):
    ec.run(coated(), tmp_path / "run").dataset.close()
    (case,), gaps = contact_cases_of(tmp_path / "run")
    assert gaps == ()
    rows = judged(case)
    assert {row.word for row in rows.values()} <= {"agrees", "inconclusive"}
    assert rows["approach", "u_z"].word == "agrees"
    (fault,), _ = contact_cases_of(changed(tmp_path / "run", tmp_path / "fault", '"2 um"', '"1.9 um"'))
    assert judged(fault)["approach", "u_z"].word == "disagrees"


@pytest.mark.slow
def test_a_yield_stress_that_was_another_is_caught(tmp_path):
    scene = ec.Scene(
        name="yielding",
        body1={**STEEL, "law": {"type": "j2", "hardening": {"type": "perfect", "yield-stress": "3 GPa"}}},
        geometry={"type": "sphere", "radius": "105 um"},
        grid={"cells_per_contact_radius": 10, "margin": 1.5},
        steps=[{"normal_load": "0.65 N", "increments": 2}, {"normal_load": 0.0}],
        output={"pictures": False, "vtk": False},
    )
    ec.run(scene, tmp_path / "run").dataset.close()
    (case,), _ = contact_cases_of(tmp_path / "run")
    rows = judged(case)
    assert {row.word for row in rows.values()} <= {"agrees", "inconclusive"}
    assert rows["approach", "u_z"].word == "agrees"
    (fault,), _ = contact_cases_of(changed(tmp_path / "run", tmp_path / "fault", '"3 GPa"', '"2.85 GPa"'))
    assert judged(fault)["approach", "u_z"].word == "disagrees"


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"friction": {"type": "coulomb", "coefficient": 0.3}}, "the contact has friction"),
        ({"body2": {"young_modulus": 70e9, "poisson_ratio": 0.2}}, "both bodies are elastic"),
        (
            {"geometry": {"type": "cylinder", "radius": "1 mm", "length": "20 um"}},
            "'cylinder' has no equivalent",
        ),
    ],
)
def test_what_is_not_covered_is_said(tmp_path, change, reason):
    given = {
        "name": "other", "body1": STEEL, "geometry": {"type": "sphere", "radius": "105 um"},
        "grid": {"cells": 16, "spacing": ["1.5 um", "1.5 um"]}, "steps": {"normal_load": "0.3 N"},
        "numerics": {"allow_contact_at_edge": True, "allow_coarse": True}, "output": {"pictures": False, "vtk": False},
    }  # fmt: skip
    ec.run(ec.Scene(**{**given, **change}), tmp_path / "run").dataset.close()
    cases, (gap,) = contact_cases_of(tmp_path / "run")
    assert cases == ()
    assert reason in gap.reason


def test_the_table_says_what_it_leaves_out(tmp_path, capsys):
    """Between its markers, and nothing else of the page."""
    scene = ec.Scene(
        name="rolls", body1=STEEL, geometry={"type": "cylinder", "radius": "1 mm", "length": "20 um"},
        grid={"cells": 16, "spacing": ["1.5 um", "1.5 um"]}, steps={"normal_load": "0.3 N"},
        numerics={"allow_contact_at_edge": True, "allow_coarse": True}, output={"pictures": False, "vtk": False},
    )  # fmt: skip
    ec.run(scene, tmp_path / "run").dataset.close()
    page = tmp_path / "page.md"
    page.write_text("before\n<!-- audit:whole-contacts -->\n<!-- /audit:whole-contacts -->\nafter\n", encoding="utf-8")
    with pytest.raises(typer.Exit) as end:
        main([str(tmp_path / "run")], output=tmp_path / "store", contact=True, markdown=page)
    assert end.value.exit_code == 0
    text = page.read_text(encoding="utf-8")
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert "- rolls: the geometry 'cylinder' has no equivalent" in text
    assert "rolls" in capsys.readouterr().out


BOX = """
[body1]
young-modulus = 210e9
poisson-ratio = 0.3
[geometry]
type = "sphere"
radius = 105e-6
[[inclusions]]
type = "cuboid"
center = [0, 0, 2e-6]
edges = [{x}, {y}, 4e-6]
material = {{ young-modulus = 420e9, poisson-ratio = 0.3 }}
[[steps]]
normal-load = 0.65
"""


def test_a_wide_box_is_a_disc_of_its_area():
    (disc,) = contact_scene(BOX.format(x=18e-6, y=18e-6), 6e-6).regions
    assert disc["kind"] == "disc"
    assert np.pi * disc["radius"] ** 2 == close(18e-6**2, rel=1e-12)
    (layer,) = contact_scene(BOX.format(x=140e-6, y=120e-6), 6e-6).regions
    assert layer["kind"] == "layer"
    for x, y in ((18e-6, 20e-6), (12e-6, 12e-6)):
        with pytest.raises(NotJudged, match="not axisymmetric"):
            contact_scene(BOX.format(x=x, y=y), 6e-6)


@pytest.mark.slow
def test_the_command_judges_a_run_and_its_contact(command, quick, tmp_path):
    cells = ("--set", "grid.cells-per-contact-radius=24")  # fewer leave more open than agreement allows
    assert command("run", "hertz", *quick, *cells, "-o", tmp_path / "run").code == 0
    outcome = command("verify", "--quick", "--contact", tmp_path / "run", "-o", tmp_path / "report")
    assert outcome.code == 0
    cases = json.loads((tmp_path / "report" / "report.json").read_text(encoding="utf-8"))["cases"]
    words = {case["name"]: {row["profile"]: row["word"] for row in case["rows"]} for case in cases}
    compared = ("approach", "contact radius", "contact radius from the gap", "pressure, step 1")
    assert words.pop("contact") == dict.fromkeys(compared, "agrees")
    assert "surface along x" in str(words)


def test_contact_is_asked_of_runs_only(command):
    outcome = command("verify", "--contact", "cuboid")
    assert outcome.code == 2
    assert "--contact must be given with a run (got none)" in outcome.err
