"""`[[fatigue]]` in a scene: the numbers of `eigencontact.fatigue`, in memory, in a folder, in a sweep; refusals."""

import json

import numpy as np
import pytest

import eigencontact as ec

TABLE = {"type": "findley", "slope": 0.3, "limit-amplitude": "2.6 GPa", "cycle": "all"}
LIFE = {"slope": 5.0, "knee-cycles": 1e6, "scatter": 1.5, "failure-probability": 0.1}


def scene(*tables, **changes):
    tables = tables or ({**TABLE, "distance": "2 um", "life": LIFE},)
    resolved = ec.load_scene("hertz", ["grid.cells-per-contact-radius=8", "stress.0.depth-cells=12"]).resolved()
    resolved["stress"] = resolved["stress"][:1]
    steps = [{"normal-load": 0.65}, {"normal-load": 0.0}]
    return {**resolved, "steps": steps, "fatigue": list(tables), "output": {"pictures": False}, **changes}


@pytest.fixture(scope="module")
def in_memory():
    return ec.run(scene())


def fatigue_numbers(result):
    return {name: value for name, value in result.summary.items() if name.startswith("fatigue_")}


def test_numbers_are_those_of_the_call_on_the_results(in_memory):
    criterion = {name: TABLE[name] for name in ("type", "slope", "limit-amplitude")}
    again = ec.fatigue(in_memory, criterion, cycle="all", distance="2 um", life=LIFE)
    expected = {
        "utilisation": again.summary["utilisation"], "at_distance": again.summary["at_distance"],
        **dict(zip(("x", "y", "depth"), again.summary["place"], strict=True)),
        "cycles": again.summary["life"]["cycles"],
        "failure_probability": again.summary["life"]["failure_probability_without_end"],
    }  # fmt: skip
    assert fatigue_numbers(in_memory) == {f"fatigue_findley_{name}": value for name, value in expected.items()}
    assert again.summary["life"]["cycles"] is None  # below the limit amplitude
    np.testing.assert_array_equal(in_memory.dataset["section_fatigue_findley"].values, again.dataset.utilisation.values)


@pytest.mark.slow
def test_a_folder_holds_the_same_with_a_picture(in_memory, tmp_path):
    stored = ec.run(scene(output={"pictures": True}), tmp_path / "run")
    assert fatigue_numbers(stored) == fatigue_numbers(in_memory)
    np.testing.assert_array_equal(
        stored.dataset["section_fatigue_findley"].values, in_memory.dataset["section_fatigue_findley"].values
    )
    assert (tmp_path / "run" / "fatigue-findley.png").is_file()
    assert "normal" in stored.files["fatigue-findley.png"]
    summary = json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))
    assert summary["numbers"]["fatigue_findley_utilisation"]["headline"]
    line = {"name": "axis", "shape": "line", "start": [0, 0, 1e-6], "end": [0, 0, 5e-6], "count": 3}
    assert "axis_stress" in ec.region(tmp_path / "run", line)  # a scene without the region of the table


def test_a_sweep_has_its_columns():
    """Elastic: the amplitude of the stress goes with the cube root of the load."""
    swept = ec.sweep(scene(stress=_axis(), fatigue=[TABLE]), {"steps.0.normal-load": [0.1, 0.8]}).dataset
    ratio = np.divide(*swept["fatigue_findley_utilisation"].values[::-1])
    assert abs(ratio - 2.0) < 0.02


def _axis():
    """Points so close that both hot spots lie on one within 1 %."""
    return [{"name": "axis", "shape": "line", "start": [0, 0, 5e-7], "end": [0, 0, 6e-6], "count": 200}]


def test_a_value_at_the_edge_has_no_error_bar():
    """The largest normal stress lies at the edge of the contact on the surface, where cells raise it."""
    table = {"type": "smith-watson-topper", "limit-product": "40 MPa", "cycle": "all", "name": "swt", "life": LIFE}
    result = ec.run(scene(table), errors=True)
    left_out = result.summary["errors_left_out"]
    assert {"fatigue_swt_utilisation", "fatigue_swt_cycles"} <= set(left_out)
    assert "fatigue_swt_utilisation" not in result.summary["errors"]
    assert "fatigue_swt_depth" in result.summary["errors"]
    assert {warning["code"] for warning in result.summary["warnings"]} >= {"fatigue-edge"}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"region": "sectio"}, "did you mean 'section'"),
        ({"type": "findly"}, "did you mean 'findley'"),
        ({"slop": 0.3}, "unknown key 'slop' in fatigue"),
        ({"slope": -1.0}, "slope must be zero or positive"),
        ({"cycle": "last"}, "fatigue.cycle must be given where the load history has no closed cycle"),
        ({"cycle": [2, 9]}, "this run has 2 steps"),
        ({"cycle": "lst"}, "'last', 'all' or the numbers"),
        ({"distance": "2 um", "method": "volume"}, "must be of shape 'volume'"),
        ({"distance": "-2 um"}, "distance must be positive"),
        ({"life": {**LIFE, "scatter": 0.5}}, "scatter must be 1 or more"),
        ({"life": {"slope": 5}}, "knee-cycles must be given"),
    ],
)
def test_refusals_when_it_is_planned(change, words):
    with pytest.raises(ec.EigencontactError, match=words):
        ec.plan(scene({**TABLE, **change}))


def test_strain_of_a_body_that_yields_must_be_stored():
    table = {"type": "smith-watson-topper", "limit-product": "40 MPa", "cycle": "all"}
    law = {"type": "j2", "hardening": {"type": "perfect", "yield-stress": "9 GPa"}}
    body = {"young-modulus": "210 GPa", "poisson-ratio": 0.3, "law": law}
    with pytest.raises(ec.EigencontactError, match="region 'section' must store its strain"):
        ec.plan(scene(table, body1=body))


def test_two_tables_of_one_criterion_need_names():
    with pytest.raises(ec.EigencontactError, match="fatigue tables must have different names"):
        ec.plan(scene(TABLE, TABLE))
    assert len(ec.plan(scene(TABLE, {**TABLE, "name": "second"})).conclusions) == 2
