"""The four paths of a first hour, typed as a new user types them: files of their own, the command line, the library."""

import csv
import json
from functools import partial

import numpy as np
import pytest

import eigencontact as ec
from close import close
from conftest import save_small
from eigencontact.viz.style import save

FRETTING = """
title = "Fretting wear of DLC on titanium"

[body1.medium]
type = "bonded-layers"
layers = [{ name = "DLC", thickness = "2 um", young-modulus = "200 GPa", poisson-ratio = 0.25 }]
substrate = { young-modulus = "114 GPa", poisson-ratio = 0.33 }

[body2]
young-modulus = "370 GPa"
poisson-ratio = 0.22

[geometry]
type = "sphere"
radius = "6 mm"

[friction]
type = "coulomb"
coefficient = 0.2

[wear]
type = "dissipated-energy"
coefficient = "1e3 um^3/J"
body = 1

[grid]
cells = 16
size = "110 um"

[[steps]]
normal-load = "1 N"

[[steps]]
shift-x = "2 um"

[[steps]]
cycle = [{ shift-x = "-2 um", increments = 2 }, { shift-x = "2 um", increments = 2 }]
repeat = 1

[output]
pictures = false
"""

DAMAGED = """
plugins = ["my_damage.py"]

[body1]
young-modulus = "210 GPa"
poisson-ratio = 0.3

[body1.law]
type = "j2"
hardening = { type = "linear", yield-stress = "2 GPa", modulus = "20 GPa" }
damage = { type = "my-damage", first = 0.001, strain = 0.01, last = 0.5 }

[geometry]
type = "sphere"
radius = "105 um"

[grid]
cells = 10
size = "14 um"

[[steps]]
normal-load = "0.3 N"
increments = 2

[numerics]
allow-coarse = true

[output]
pictures = false
"""

CAMPAIGN = """
title = "How many cells does a contact need?"
judge = "scene"
model = "some cells to the contact radius"
tolerance = 0.02
expect = "cells >= 6"
label = "{cells:g} cells"

[constants]
a = 6.0533e-6

[vary]
cells = { values = [3, 6], label = "n_a, cells to the contact radius" }

[scene]
body1 = { young-modulus = "210 GPa", poisson-ratio = 0.3 }
body2 = { rigid = true }
geometry = { type = "sphere", radius = "105 um" }
grid = { cells = "= 4 * cells", size = "= 4 * a" }
steps = [{ normal-load = "0.65 N" }]
numerics = { allow-coarse = true }
output = { pictures = false }

[reference]
words = "a fine grid"
set = { "grid.cells" = "= 4 * fine" }
refine = { fine = [6, 8, 10] }

[[quantity]]
name = "largest pressure"
is = "max_pressure"
"""


@pytest.fixture
def desk(tmp_path, monkeypatch):
    """Empty folder in which the user works."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def succeeded(outcome):
    assert outcome.code == 0, outcome.err
    return outcome.out


def test_own_fretting_scene(command, desk, monkeypatch):
    """Explain, run, look at one field, read the numbers, write the report (with small pictures)."""
    monkeypatch.setattr("eigencontact.viz.figures.save", partial(save_small, save=save))
    (desk / "dlc.toml").write_text(FRETTING, encoding="utf-8")
    assert "shift-x" in succeeded(command("schema", "steps"))
    plan = succeeded(command("explain", "dlc.toml"))
    assert "2 um of 'DLC'" in plan
    assert "body 1: dissipated-energy, coefficient 1000 um^3/J" in plan
    printed = succeeded(command("run", "dlc.toml", "-o", "dlc"))
    assert "shift x" in printed  # the course of the loading
    summary = json.loads((desk / "dlc" / "summary.json").read_text(encoding="utf-8"))
    assert summary["worn_volume"] == close(1e-15 * summary["wear_energy"], rel=1e-9)
    # friction does the work mu P along the path, less what is elastic: one cycle of 8 um, and 2 um to begin with
    assert 0.9 < summary["wear_energy"] / (0.2 * 1.0 * 10e-6) < 1.0
    succeeded(command("plot", "dlc", "--field", "worn-depth"))
    assert (desk / "dlc" / "plot-worn-depth.png").stat().st_size > 5000
    succeeded(command("report", "dlc"))
    assert "DLC" in (desk / "dlc" / "report.html").read_text(encoding="utf-8")


def test_own_damage_law(command, desk):
    """A file from the skeleton keeps its promises, enters a scene, and is named by explain."""
    succeeded(command("new-plugin", "my-damage", "--kind", "damage-law", "--file"))
    assert "11 of 11 promises kept" in succeeded(command("check", "my_damage.py"))
    (desk / "damaged.toml").write_text(DAMAGED, encoding="utf-8")
    plan = succeeded(command("explain", "damaged.toml"))
    assert "hardening: linear, yield-stress 2 GPa, modulus 20 GPa" in plan
    assert "damage: my-damage, first 0.001, strain 0.01, last 0.5" in plan
    succeeded(command("run", "damaged.toml", "-o", "damaged"))
    with ec.open_results(desk / "damaged") as results:
        damage, strain = (results[name].max().item() for name in ("damage_1", "equivalent_plastic_strain_1"))
    assert strain > 2e-3
    assert damage == close(0.5 * (1 - np.exp(-(strain - 1e-3) / 0.01)), rel=1e-6)


@pytest.mark.slow
def test_own_damage_law_agrees_with_finite_elements(command, desk):
    """The quick check of a law: what it cannot decide has a remedy."""
    succeeded(command("new-plugin", "my-damage", "--kind", "damage-law", "--file"))
    printed = succeeded(command("verify", "--plugin", "my_damage.py", "--quick"))
    assert "7 verdicts: 0 disagrees" in printed
    undecided = [line for line in printed.splitlines() if line.startswith("inconclusive: ")]
    assert len(undecided) <= 2  # a small component, and damage at a kink
    assert all("; repeat with --refine " in line for line in undecided)


@pytest.mark.slow
def test_campaign_from_one_file(command, desk):
    """Verdicts, table, map, and a second call that computes nothing."""
    (desk / "cells.toml").write_text(CAMPAIGN, encoding="utf-8")
    first = command("campaign", "cells.toml")
    printed = succeeded(first)
    assert "6 cells" in printed
    assert "Agreement is claimed where cells >= 6" in printed
    assert "1 of 8: 3 cells: model; about " in first.err
    with (desk / "campaigns" / "cells" / "table.csv").open(encoding="utf-8", newline="") as file:
        rows = {float(row["cells"]): row for row in csv.DictReader(file)}
    assert rows[6.0]["verdict"] == "agrees"
    assert float(rows[3.0]["error"]) > float(rows[6.0]["error"])
    assert (desk / "campaigns" / "cells" / "map.png").stat().st_size > 5000
    stamps = [path.stat().st_mtime_ns for path in (desk / "campaigns" / "cells" / "runs").glob("*/results.nc")]
    assert len(stamps) == 8
    succeeded(command("campaign", "cells.toml"))
    again = [path.stat().st_mtime_ns for path in (desk / "campaigns" / "cells" / "runs").glob("*/results.nc")]
    assert sorted(again) == sorted(stamps)


def test_library_in_a_script():
    """Hertz by hand, a rough array, a coating, friction, stress at points, a region, a picture."""
    steel = ec.HalfSpace("210 GPa", 0.3)
    x = (np.arange(48) - 23.5) * 0.35e-6
    gap = (x**2 + x[:, None] ** 2) / (2 * 105e-6)
    ball = ec.solve_contact(gap, steel, load="0.65 N", spacing="0.35 um")
    modulus = 210e9 / (1 - 0.3**2)
    radius = (0.75 * 0.65 * 105e-6 / modulus) ** (1 / 3)
    assert ball.max_pressure == close(1.5 * 0.65 / (np.pi * radius**2), rel=5e-3)
    assert ball.approach == close(radius**2 / 105e-6, rel=5e-3)
    stress = ball.stress([[0, 0, 0.48 * radius]])[0]
    assert 0.5 * (stress[0, 0] - stress[2, 2]) == close(0.31 * ball.max_pressure, rel=0.02)
    noise = 20e-9 * np.random.default_rng(1).standard_normal(gap.shape)
    rough = ec.solve_contact(gap + noise, steel, load="0.65 N", spacing="0.35 um")
    assert rough.max_pressure > 1.2 * ball.max_pressure
    coated = ec.Layered([("2 um", "420 GPa", 0.25)], substrate=steel)
    assert ec.solve_contact(gap, coated, load="0.65 N", spacing="0.35 um").max_pressure > ball.max_pressure
    pulled = ec.solve_contact(gap, (steel, steel), load=0.3, friction=0.3, tangential_load=0.045, spacing="0.35 um")
    assert pulled.dataset.stick_radius[-1].item() / pulled.radius == close(0.5 ** (1 / 3), rel=0.05)
    section = ball.region(name="section", shape="plane", normal="y", depth_max="12 um", depth_cells=8)
    assert section["section_stress"].max().item() < ball.max_pressure
    assert ball.plot("pressure").get_title()


def test_a_refusal_names_the_argument_and_the_rule():
    with pytest.raises(ec.EigencontactError, match=r"poisson_ratio must be in .* \(got 0\.7\)"):
        ec.HalfSpace("210 GPa", 0.7)
