"""The memory that is predicted of a run, against what it takes: the interpreter and the process that draws count."""

import json
import subprocess
import sys

import pytest

import eigencontact as ec
from close import close
from eigencontact.core.memory import resident_bytes
from eigencontact.execution.fields.traction_field import TractionField
from eigencontact.planning.memory import run_bytes

CENTRED = ["hertz", "cattaneo-mindlin", "coated-sphere"]


@pytest.mark.parametrize("name", CENTRED)
def test_the_price_of_a_section_is_the_size_of_its_operator(name, monkeypatch):
    """A contact in the middle of an even window has an even number of cells: half of the coefficients are images."""
    made = []
    operator = TractionField._operator

    def noted(field, quantity, source, *, near):
        made.append(operator(field, quantity, source, near=near))
        return made[-1]

    monkeypatch.setattr(TractionField, "_operator", noted)
    plan = ec.plan(ec.load_scene(name, ["grid.cells-per-contact-radius=24", "output.pictures=false"]))
    (section,) = [block for block in plan.blocks if block.name == "stress-section"]
    ec.run(plan)
    sections = [each.nbytes for each in made if type(each).__name__ == "SectionStress"]
    assert 1.0 < section.cost.memory / max(sections) < 2.0


def test_what_a_run_takes_beside_its_arrays():
    plan = ec.plan("fretting-mode-3")
    base = resident_bytes() + plan.cost.peak
    alone, stored, drawn = (run_bytes(plan, **how) for how in ({"stored": False}, {"painter": False}, {}))
    assert base + 2e7 < alone <= stored < drawn
    assert drawn - alone > 1e8
    quiet = ec.plan(ec.load_scene("fretting-mode-3", ["output.pictures=false"]))
    assert run_bytes(quiet) == close(run_bytes(quiet, painter=False), rel=0.05)
    film = ec.plan(ec.load_scene("fretting-mode-3", ["output.animation='gif'"]))
    assert run_bytes(film) - drawn > 1.5e8
    assert plan.to_dict()["predicted_memory_bytes"] == close(drawn, rel=0.05)
    assert "with libraries and pictures" in plan.explain()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["hertz-ellipse", "cattaneo-mindlin", "fretting-mode-3", "plastic-inclusion"])
def test_a_run_takes_what_was_predicted(name, tmp_path):
    """Never more, and at least 1/1.25 of it, in a fresh process and with the one that draws."""
    code = "from eigencontact.cli import app; app()"
    subprocess.run([sys.executable, "-c", code, "run", name, "-o", str(tmp_path / name)], check=True)
    summary = json.loads((tmp_path / name / "summary.json").read_text())
    ratio = summary["predicted_memory_bytes"] / summary["peak_memory_bytes"]
    assert 1.0 <= ratio <= 1.25
