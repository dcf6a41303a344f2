"""Studies: listed, run coarsely, resumed, drawn; written by users; refused by key, name and formula."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import eigencontact as ec
from close import close
from eigencontact.errors import SceneError
from eigencontact_verification.studies.catalogue import STUDIES
from eigencontact_verification.studies.checks import verdicts
from eigencontact_verification.studies.errors import error_of, errors_at_end, with_errors
from eigencontact_verification.studies.figure import draw_study
from eigencontact_verification.studies.form import FORM
from eigencontact_verification.studies.formula import Context, evaluate
from eigencontact_verification.studies.run import Failed, run_study, source_in_words, variants_of_study, write_study
from eigencontact_verification.studies.study import read_study
from eigencontact_verification.studies.template import filled

OWN = """
title = "Load on a ball"
scene = "ball.toml"
[[source]]
authors = "H. Hertz"
year = 1881
title = "Ueber die Beruehrung fester elastischer Koerper"
journal = "Journal fuer die reine und angewandte Mathematik 92, 156-171"
[vary]
"geometry.radius" = ["50 um", "100 um"]
load = { key = "steps.normal-load", values = ["0.1 N", "0.8 N", "600 N"], label = "load" }
[read]
"largest pressure [Pa]" = { is = "max_pressure", as = "p" }
[[check]]
number = "p"
is = "rising"
along = "load"
[[check]]
number = "p"
is = [1e9, 2e9]
[[panel]]
[[panel.curve]]
x = "load"
y = "1e-9 * p"
by = "geometry.radius"
"""
BALL = """
body1 = {young-modulus = "210 GPa", poisson-ratio = 0.3}
geometry = {type = "sphere", radius = "100 um"}
grid = {cells = 24, size = "26 um"}
steps = {normal-load = "0.5 N"}
"""


@pytest.fixture
def own(tmp_path):
    (tmp_path / "ball.toml").write_text(BALL, encoding="utf-8")
    path = tmp_path / "own.toml"
    path.write_text(OWN, encoding="utf-8")
    return path


def test_names_are_unique_and_variants_are_scenes():
    assert len(set(STUDIES.names())) == len(STUDIES.names())
    for study in map(STUDIES.find, STUDIES.names()):
        coarse, fine = variants_of_study(study, coarse=True), variants_of_study(study, coarse=False)
        assert 1 < len(coarse) <= len(fine)
        assert [variant.label for variant in (*coarse, *fine) if variant.refused] == []


def test_every_study_names_its_source_in_full():
    for study in map(STUDIES.find, STUDIES.names()):
        assert study.sources, study.name
        for source in study.sources:
            assert {"authors", "year", "title", "journal"} <= set(source), study.name
            assert {"figure", "form", "case"} & set(source), study.name
        assert study.figure["panel"], study.name


def test_unknown_name_gets_the_nearest():
    with pytest.raises(SceneError, match=r"rolling-homogen.*did you mean 'rolling-homogeneous'"):
        STUDIES.find("rolling-homogenous")


def test_finished_variants_are_read_again(tmp_path):
    study = STUDIES.find("rolling-homogeneous")
    found = list(run_study(study, tmp_path, coarse=True))
    picture, numbers = write_study(study, found, tmp_path)
    for item in found:
        item.dataset.close()
    assert picture.stat().st_size > 10_000
    content = json.loads(numbers.read_text(encoding="utf-8"))
    assert content["variants"][1]["largest von Mises / p0"] == close(0.620, rel=0.02)
    assert [check["holds"] for check in content["checks"]] == [True]
    stamps = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nc")}
    again = list(run_study(study, tmp_path, coarse=True))
    assert [item.row for item in again] == [item.row for item in found]
    for item in again:
        item.dataset.close()
    assert stamps == {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nc")}


@pytest.mark.parametrize(
    ("name", "blocks"),
    [
        ("cluster-stiffness", {"inhomogeneities", "normal-contact"}),
        ("sphere-radius", {"inhomogeneities", "normal-contact"}),
        ("two-spheres-spacing", {"inhomogeneities", "normal-contact"}),
        ("coating-pressure", {"inhomogeneities", "normal-contact"}),
        ("coating-thickness", {"normal-contact"}),
        ("coating-fretting", {"frictional-contact"}),
        ("plastic-friction", {"inhomogeneities", "frictional-contact"}),
        ("wear-fretting-loops", {"wear", "frictional-contact"}),
    ],
)
def test_scenes_can_be_planned(name, blocks):
    """One study of a kind; the last of its coarse variants."""
    plan = ec.plan(variants_of_study(STUDIES.find(name), coarse=True)[-1].scene)
    assert blocks <= {part.name for part in plan.parts}


@pytest.mark.parametrize(
    ("name", "degree"),
    [("sphere-radius", 4), ("two-spheres-pressure", 4), ("layer-of-spheres-depth", 2)],
)
def test_spheres_of_studies_are_whole(name, degree):
    plan = ec.plan(variants_of_study(STUDIES.find(name), coarse=True)[0].scene)
    assert plan.numerics.inclusion_resolution.whole == degree
    assert all(source.whole for source in plan.model.cells.inhomogeneities)


def test_the_sphere_closest_to_the_surface_has_a_higher_degree():
    variants = variants_of_study(STUDIES.find("sphere-radius"), coarse=False)
    degrees = [ec.plan(variants[row].scene).numerics.inclusion_resolution.whole for row in (-2, -1)]
    assert degrees == [4, 8]


def test_thick_coating_against_the_integral_equation(tmp_path):
    """Case PL-2 of the soft coating, read off coarse cells; and what is read agrees with the catalogue."""
    study = STUDIES.find("coating-thickness")
    chosen = replace(study, coarse_rows=study.coarse_rows[1:2])
    (found,) = run_study(chosen, tmp_path, coarse=True)
    found.dataset.close()
    assert found.row["integral equation: pressure"] == close(0.638, abs=1e-3)
    assert found.row["integral equation: area"] == close(1.568, abs=1e-3)
    assert found.row["pressure ratio"] == close(0.638, rel=0.005)
    assert found.row["area ratio"] == close(1.568, rel=0.02)


@pytest.mark.slow
def test_a_study_of_a_user(own, tmp_path, command, monkeypatch):
    """Texts with units become numbers; a failed variant is told; checks are judged; the order is the study's."""
    backwards = lambda *a, **k: reversed(list(run_study(*a, **k)))  # noqa: E731 - as several processes may finish
    monkeypatch.setattr("eigencontact_verification.studies.run.run_study", backwards)
    done = command("study", own, "-o", tmp_path)
    assert done.code == 1
    assert done.err.count("failed: ") == 2  # 600 N fill more than the window
    assert "holds: p rising along load at geometry.radius = 5e-05" in done.out
    assert "does not hold: p within 1e+09 and 2e+09" in done.out
    assert "after: H. Hertz 1881, Ueber die" in done.out
    content = json.loads((tmp_path / "own.json").read_text(encoding="utf-8"))
    assert len(content["failed"]) == 2
    order = [(row["geometry.radius"], row["load"]) for row in content["variants"]]
    assert order == sorted(order)
    for code in {one["code"] for said in content["warnings"].values() for one in said}:
        count = sum(code in {one["code"] for one in said} for said in content["warnings"].values())
        assert f"{count} of 6 variants warn" in done.out
    rows = {(row["geometry.radius"], row["load"]): row["largest pressure [Pa]"] for row in content["variants"]}
    assert set(rows) == {(5e-5, 0.1), (5e-5, 0.8), (1e-4, 0.1), (1e-4, 0.8)}
    assert rows[1e-4, 0.8] / rows[1e-4, 0.1] == close(2.0, rel=0.05)  # P^(1/3)
    assert rows[5e-5, 0.8] / rows[1e-4, 0.8] == close(2.0 ** (2 / 3), rel=0.05)  # R^(-2/3)
    assert (tmp_path / "own.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.slow
def test_errors_of_readings_are_those_of_the_numbers_that_they_read(own, tmp_path, command, monkeypatch):
    monkeypatch.setenv("COLUMNS", "300")
    text = OWN.replace('"0.1 N", "0.8 N", "600 N"', '"0.4 N", "0.8 N"').replace('"50 um", "100 um"', '"100 um"')
    more = """
"exact [m]" = { is = "(3 * load * sqrt(R) / (4 * E * R)) ** (2 / 3)", as = "exact" }
"relative approach" = { is = "approach / exact", as = "relative" }
"rise" = { is = "relative * p", as = "rise" }
"pressure of a cell" = { is = "max(pressure)", as = "cell" }
"pressure in the middle" = { is = "middle(pressure) / 2", as = "half" }
"pressure in parts" = { is = "sum(pressure) / max(pressure)", as = "parts" }
[constants]
R = 100e-6
E = 2.3e11
[[check]]"""
    own.write_text(text.replace("\n[[check]]", more, 1), encoding="utf-8")
    done = command("study", own, "--errors", "-o", tmp_path / "out")
    assert done.code == 0, done.err
    content = json.loads((tmp_path / "out" / "own.json").read_text(encoding="utf-8"))
    for row, folder in zip(content["variants"], sorted((tmp_path / "out" / "own").iterdir()), strict=True):
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        bars = {name: bar["error"] for name, bar in summary["errors"].items()}
        assert row["largest pressure [Pa] error"] == close(bars["max_pressure"])
        assert row["relative approach error"] == close(bars["approach"] / row["exact [m]"])
        relative = bars["approach"] / summary["approach"] + bars["max_pressure"] / summary["max_pressure"]
        assert row["rise error"] == close(relative * row["rise"], rel=1e-6)
        assert {"exact [m] error", "pressure in parts error"}.isdisjoint(row)
        with xr.open_dataset(folder / "results.nc") as data:
            values, errors = (data[name].isel(step=-1).values for name in ("pressure", "pressure_error"))
        ends = [np.nanmax(values + sign * errors) - values.max() for sign in (1.0, -1.0)]
        middle = errors[11:13, 11:13].mean()
        assert min(np.abs(ends)) > 0.0
        assert row["pressure of a cell error"] == close(np.abs(ends).max())
        assert row["pressure in the middle error"] == close(0.5 * middle)
        assert f"{row['rise']:.4g} ± {row['rise error']:.2g}" in " ".join(done.out.split())


def test_only_what_has_a_bar_has_an_error():
    """At the end and at the moment that is the end; not of other moments, of readings and fields without errors."""
    data = xr.Dataset({"depth": ("step", [1.0, 4.0, 2.0]), "normal_load": ("step", [1.0, 2.0, 3.0]),
                       "field": (("step", "x"), np.ones((3, 2)))})  # fmt: skip
    bars = {"depth": {"error": 0.5, "value": 2.0}, "normal_load": {"error": 0.0, "value": 3.0},
            "field": {"error": 0.1, "value": 9.0}}  # fmt: skip
    errors = errors_at_end({"errors": bars}, data)
    assert errors == {"depth": 0.5, "normal_load": 0.0}
    context = Context({"a": 3.0, "read": 1.0}, data)
    known = {"a * depth": 1.5, "depth ** 2": 2.25, "peak(depth)": 0.5, "a": 0.0, "depth / normal_load": 0.5 / 3}
    assert {text: float(error_of(text, context, errors)) for text in known} == close(known)
    for text in ("first(depth)", "max(all(depth))", "sum(field)", "depth * sum(field)"):
        assert error_of(text, context, errors) is None
    assert error_of("read + depth", context, {**errors, "read": None}) is None
    assert error_of("depth", context, {}) is None
    wavy = data.assign(field_error=(("step", "x"), np.array([[9.0, 9.0], [9.0, 9.0], [0.25, 0.5]])))
    wavy["field"][-1] = [-3.0, 2.0]
    known = {"max(field)": 0.5, "min(field)": 0.25, "field[0] / depth": 0.125 + 3 / 2 - 3 / 2.5, "-field[1]": 0.5}
    for text, error in known.items():
        assert float(error_of(text, Context({}, wavy), errors)) == close(error), text
    for text in ("field[1] - field[0]", "sum(field)", "first(field[0])", "max(field) > 1"):  # errors could cancel
        assert error_of(text, Context({}, wavy), errors) is None
    assert errors_at_end({}, data) == {}


@pytest.mark.slow
def test_bars_are_drawn_where_there_are_errors(own, tmp_path):
    text = OWN.replace('"0.1 N", "0.8 N", "600 N"', '"0.4 N", "0.8 N"').replace('"50 um", "100 um"', '"100 um"')
    own.write_text(text, encoding="utf-8")
    study = read_study(own)
    for item, expected in ((study, 0), (with_errors(study), 1)):
        done = list(run_study(item, tmp_path / str(expected)))
        (axes,) = draw_study(item, done).axes
        assert len(axes.containers) == expected
        for container in axes.containers:
            (bars,) = container[2]
            spans = [float(np.ptp(segment[:, 1])) for segment in bars.get_segments()]
            assert spans == close([2e-9 * one.errors["p"] for one in done])


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("[read]", "[raed]", "unknown key 'raed' in study own; .*did you mean 'read'"),
        ("journal = ", "jurnal = ", "unknown key 'jurnal' in source; .*did you mean 'journal'"),
        ('label = "load"', 'labl = "load"', "unknown key 'labl' in vary.load"),
        ('title = "Load on a ball"', "", "study own must have title"),
        ('is = "max_pressure"', 'is = "max_presure"', "did you mean 'max_pressure'"),
        ('is = "max_pressure"', "is = \"__import__('os')\"", "function must be one of"),
        ('is = "max_pressure"', 'is = "max_pressure.values"', "a formula must have only"),
        ('is = "rising"', 'is = "up"', "check.is must be rising or falling"),
        ('"50 um", "100 um"', '"50 um", "50 um"', "each value once"),
        ('"geometry.radius" = [', '"geometri.radius" = [', "no variant is valid; .*geometri"),
    ],
)
def test_what_is_refused(own, finished_runs, before, after, words):
    assert before in OWN
    own.write_text(OWN.replace(before, after).replace(', "0.8 N", "600 N"', ""), encoding="utf-8")
    with pytest.raises(SceneError, match=words):
        _judged(own, finished_runs)


@pytest.fixture(scope="module")
def finished_runs(tmp_path_factory):
    """Folder of runs that studies with equal scenes share."""
    return tmp_path_factory.mktemp("runs")


def _judged(path, folder):
    study = read_study(path)
    done = list(run_study(study, folder))
    assert not any(isinstance(one, Failed) for one in done)
    return verdicts(study, done)


def test_formulas():
    steps = np.arange(4)
    data = xr.Dataset({"normal_load": ("step", [1.0, 3.0, 2.0, 0.0]), "depth": ("step", [1.0, 4.0, 3.5, 2.0]),
                       "field": (("y", "x"), np.arange(6.0).reshape(2, 3))},
                      {"step": steps, "y": [-1.0, 0.2], "x": [-1.0, 0.0, 2.0]})  # fmt: skip
    context = Context({"a": 2.0, "several": [1, 2]}, data)
    for text, value in {
        "depth": 2.0, "peak(depth)": 4.0, "first(depth) + a**2": 5.0, "max(all(depth))": 4.0,
        "max(row(field))": 5.0, "place(x, field)": 2.0, "nearest(row(field), 0.1)": 4.0,
        "sum(where(field, field > 3))": 9.0, "when(normal_load, 1.9, depth)": 3.5,
        "integral([0, 1, 1], [0, 1, 3])": 2.5,
        "if_else(has(nothing), nothing, -1)": -1.0, "given(a) and not given(b)": 1.0,
        "interp(2.5, [1, 2, 3], [0, 0, 1])": 0.5,
        "round(2.6) // 2": 1.0,
    }.items():  # fmt: skip
        assert float(evaluate(text, context)) == close(value, rel=1e-12), text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("9**9**9**9", "must stay within the range of float64"),
        ("(9**9)**(9**9)", "must stay within the range of float64"),
        ("a**9**9**9", "must stay within the range of float64"),
        ("count(1e12)", "must make at most 1000000 values"),
        ("sum(places(1e12))", "must make at most 1000000 values"),
        ("linspace(0, 1, 1e12)", "must make at most 1000000 values"),
        ("geomspace(1, 2, 1e12)", "must make at most 1000000 values"),
        ("lattice(count(1e3), count(1e3), count(1e3))", "must make at most 1000000 values"),
        ("'a' * 10**12", "must not be used in arithmetic"),
        ("'%999999999999d' % 1", "must not be used in arithmetic"),
    ],
)
def test_formulas_end_soon(text, words):
    with pytest.raises(SceneError, match=words):
        evaluate(text, Context({"a": 2.0}))


def test_powers_are_those_of_numbers():
    for text, value in {"2**3": 8.0, "2**-1": 0.5, "a**2": 4.0, "sum(count(3)**2)": 14.0, "-2**2": -4.0}.items():
        assert float(evaluate(text, Context({"a": 2.0}))) == close(value, rel=1e-15)


@pytest.mark.parametrize("text", ["open('x')", "a.b", "lambda: 1", "[i for i in a]", "a := 1", "1 if a else 2", "a +"])
def test_what_formulas_cannot_say(text):
    with pytest.raises(SceneError):
        evaluate(text, Context({"a": 1.0}))


def test_an_entry_stands_for_several():
    nested = [{"each": {"r": "count(2)"}, "entries": [{"load": "= r"}, {"load": 0}]}]
    assert filled(nested, Context({}), "steps") == [{"load": 1.0}, {"load": 0}, {"load": 2.0}, {"load": 0}]


def test_the_form_is_told(command):
    told = command("study", "--form").out
    for table, keys in FORM.items():
        assert f"\n{table} (in a study)\n" in told or table == "study"
        assert all(f"\n  {key}" in told and meaning for key, meaning in keys.items())


def test_a_bundled_study_is_printed_to_start_from(command):
    printed = command("study", "spence-radius", "--show").out
    assert read_study(Path("spence-radius.toml"), printed) == STUDIES.find("spence-radius")


def test_sources_in_words():
    (thesis,) = STUDIES.find("coating-thickness").sources
    assert source_in_words(thesis) == (
        "B. Fulleringer 2011, Semi-analytical modeling of complex mechanical contacts: application to inclusions and "
        "wear of coated surfaces, PhD thesis, INSA de Lyon, 2011ISAL0061, figures 4.13 and 4.14, case PL-1 to PL-3"
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", STUDIES.names())
def test_coarse_studies_run_and_are_drawn(name, tmp_path):
    study = STUDIES.find(name)
    found = list(run_study(study, tmp_path, coarse=True))
    assert [one.reason for one in found if isinstance(one, Failed)] == []
    picture, numbers = write_study(study, found, tmp_path)
    for item in found:
        item.dataset.close()
    assert picture.stat().st_size > 10_000
    rows = json.loads(numbers.read_text(encoding="utf-8"))["variants"]
    assert all(math.isfinite(value) for row in rows for value in row.values() if not isinstance(value, str))
