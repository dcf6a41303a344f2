"""What a run says of its own worth: in its summary, and in the words that it prints."""

import json

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.cli import app
from eigencontact.results.records import RegionRecord, StepRecord
from eigencontact.warnings_.after import noticed

A, CARRIED = 20e-6, 12.307 * 0.5  # contact radius, and what friction carries


def rubbed(steps, cells=24, **more):
    """A ball of which friction carries half the load, without coupling, on a window of three contact radii."""
    tables = {
        "body1": STEEL,
        "geometry": {"type": "sphere", "radius": 2e-4},
        "friction": {"type": "coulomb", "coefficient": 0.5},
        "grid": {"cells": cells, "size": [3 * A, 3 * A]},
        "steps": [{"normal-load": 12.307}, *steps],
        "numerics": {"coupling": "none"},
        "output": {"pictures": False},
    }
    return ec.run({**tables, **more}).summary["warnings"]


def codes(warnings):
    return [warning["code"] for warning in warnings]


def test_a_ring_of_slip_narrower_than_a_cell_is_told():
    slight, plain = ([{"tangential-load-x": share * CARRIED, "increments": 2}] for share in (0.05, 0.6))
    (warning,) = rubbed(slight)
    assert warning["code"] == "slip-cells"
    assert "the slip annulus is at most" in warning["words"]
    assert rubbed(plain) == []


def test_a_jump_from_stick_to_gross_slip_is_told():
    jump, path = ([{"shift-x": 2e-6, "increments": count}] for count in (1, 12))
    (warning,) = rubbed(jump)
    assert warning["code"] == "load-steps"
    assert "in load step 2 the slipping part of the contact rises from 0 % to all of it" in warning["words"]
    assert rubbed(path) == []


@pytest.mark.parametrize(("x", "depth", "told"), [(-A, 0.0, True), (-A, 2.5e-6, False), (0.0, 0.0, False)])
def test_the_edge_of_a_contact_with_friction_is_told_where_the_largest_stress_lies_there(x, depth, told):
    planned = ec.plan(ec.load_scene("gross-slip", ["stress=[]", "grid.cells-per-contact-radius=16"]))
    grid = planned.grid
    stress = RegionRecord(
        name="few", shape="points", body=1, dims=("point",), fields={"von_mises": np.array([1.0, 2.0, 1.5])},
        coords={"x": np.array([0.5 * A, x, 3 * A]), "y": np.zeros(3), "z": np.array([0.0, depth, 0.0])},
    )  # fmt: skip
    pressure = np.where(np.hypot(*np.meshgrid(grid.x, grid.y)) < A, 1.0, 0.0)
    row = {"step": 1.0, "slip_fraction": 1.0, "normal_load": 1.0, "tangential_load": 0.5, "torsion_moment": 0.0}
    row["contact_area_counted"] = np.count_nonzero(pressure) * grid.cell_area
    last = StepRecord(index=1, time=1.0, fields={"pressure": pressure}, scalars=row, regions={"few": stress})
    found = noticed(planned.model, planned.blocks, last, [row])
    assert codes([one.to_dict() for one in found]) == (["slow-place"] if told else [])
    assert not told or "lies at the edge of a contact with friction" in found[0].words


def test_the_rim_of_a_layer_is_told_and_a_ball_is_not():
    def warned(region):
        section = {"shape": "plane", "normal": "y", "depth-max": 8e-6, "depth-cells": 16}
        tables = {"body1": STEEL, "inclusions": {**region, "eigenstrain": 1e-3}, "stress": section}
        tables |= {"grid": {"cells": 32, "size": [16e-6, 16e-6]}, "output": {"pictures": False}}
        return ec.run(tables).summary["warnings"]

    (warning,) = warned({"type": "cuboid", "center": [0, 0, 4e-6], "edges": [6e-6, 6e-6, 2e-6]})
    assert warning["code"] == "slow-place"
    assert "lies on an edge of 'cuboid 1'" in warning["words"]
    assert warned({"type": "sphere", "center": [0, 0, 4e-6], "radius": 3e-6}) == []


#: Load by approach of the rows below [J].
LOAD_BY_APPROACH = 12.307 * 2e-6


@pytest.mark.parametrize(
    ("increments", "spacing", "work", "told"),
    [
        (16, "radius", 8e-9, 0.04 * LOAD_BY_APPROACH / 16**2.5 / 8e-9), (16, "even", 8e-9, 6 / 16),
        pytest.param(32, "radius", 8e-10, 0.04 * LOAD_BY_APPROACH / 32**2.5 / 8e-10, marks=pytest.mark.slow),
        (32, "radius", 8e-9, None),
    ],
)  # fmt: skip
def test_few_increments_of_a_contact_that_yields_with_friction_are_told_by_number(increments, spacing, work, told):
    """Excess of the work: .04 P δ / n^2.5; error of the displacement that stays: 1.2/n or 6/n of it."""
    changes = [f"steps.0.increments={increments}", f"steps.0.spacing={spacing}", "grid.cells-per-contact-radius=4"]
    planned = ec.plan(ec.load_scene("fretting-mode-2-plastic", [*changes, "stress=[]"]))
    row = {
        "normal_load": 12.307, "approach": 2e-6, "dissipated_energy": work, "max_plastic_strain": 0.01,
        "max_pressure": 1e10, "shift_magnitude": 0.0, "twist": 0.0, "slip_fraction": 0.3, "tangential_load": 0.0,
        "torsion_moment": 0.0, "contact_area_counted": 1e-9,
    }  # fmt: skip
    rows = [{**row, "step": n + 1.0, "time": (n + 1) / increments, "substeps": 1.0} for n in range(increments)]
    last = StepRecord(index=increments, time=1.0, scalars=row, fields={}, regions={}, observed={})
    found = [
        caution for caution in noticed(planned.model, planned.blocks, last, rows) if caution.code == "plastic-steps"
    ]
    assert [caution.error for caution in found] == ([] if told is None else [close(told, rel=1e-12)])
    assert all(f"grows in {increments} increments" in caution.words for caution in found)
    elastic = [{**row, "max_plastic_strain": 0.0} for row in rows]
    assert "plastic-steps" not in [caution.code for caution in noticed(planned.model, planned.blocks, last, elastic)]


def test_the_command_prints_warnings_and_stores_them(tmp_path, capsys):
    changes = ["stress=[]", "grid={cells=24, size=[1e-4, 1e-4]}", "numerics.allow-coarse=true", "output.pictures=false"]
    with pytest.raises(SystemExit) as end:
        app(["run", "hertz", "-o", str(tmp_path), *(f"--set={change}" for change in changes)])
    assert end.value.code == 0
    assert "warning (contact-cells): the contact has " in capsys.readouterr().out
    stored = json.loads((tmp_path / "summary.json").read_text())["warnings"]
    assert codes(stored) == ["contact-cells"]


def test_a_resumed_run_has_the_warnings_of_the_whole(tmp_path):
    scene = {
        "body1": STEEL,
        "geometry": {"type": "sphere", "radius": 2e-4},
        "friction": {"type": "coulomb", "coefficient": 0.5},
        "grid": {"cells": 24, "size": [3 * A, 3 * A]},
        "steps": [{"normal-load": 12.307}, {"shift-x": 2e-6}, {"shift-x": 2.1e-6}],
        "numerics": {"coupling": "none"},
        "output": {"pictures": False},
    }
    first = ec.run(scene, tmp_path)
    first.dataset.close()
    again = ec.run(scene, tmp_path, resume=True)
    again.dataset.close()
    assert codes(first.summary["warnings"]) == codes(again.summary["warnings"]) == ["load-steps"]
