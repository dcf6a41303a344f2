"""Campaigns over parameters: files, verdicts, claims, maps, resuming, a fault in the model that is found."""

import csv
import importlib
import json
import signal
import subprocess
import sys
from dataclasses import dataclass, replace
from shutil import copytree

import numpy as np
import pytest
from typer.testing import CliRunner

from close import close
from eigencontact.engines.cluster import Cluster
from eigencontact.errors import SceneError
from eigencontact.results.ownership import is_ours
from eigencontact_verification.campaign.answer import answers, totals
from eigencontact_verification.campaign.campaign import CAMPAIGNS, read_campaign
from eigencontact_verification.campaign.elements import judge_by_elements
from eigencontact_verification.campaign.figure import axes_of_map, draw_map
from eigencontact_verification.campaign.finding import JudgedPoint, MapFinding
from eigencontact_verification.campaign.form import FORM
from eigencontact_verification.campaign.perform import perform
from eigencontact_verification.campaign.report import MapReport, as_section, write_map
from eigencontact_verification.campaign.runs import perform_runs, points_of
from eigencontact_verification.commands.campaign import campaign as command
from eigencontact_verification.crosscheck.case import Case, Gap, Profile, error_key
from eigencontact_verification.crosscheck.worker import perform as perform_task
from eigencontact_verification.reporting.verdict import word_of, worst
from hooks.test_plugin_files import BOWL

#: A stack of two equal layers is one body: the model is right but for what `softer` takes off.
TOY = """
title = "A softer body for a layered one"
judge = "scene"
model = "a body without layers"
tolerance = 0.03
expect = "softer <= 0.01"
label = "softer {softer:g}, P {load:g}"

[constants]
E = 210e9
fine = 8

[vary]
softer = { values = [0.0, 0.2], label = "taken off E" }
load = { values = [0.4, 0.6], label = "P_n / N" }

[coarse]
vary = { load = [0.4] }

[scene]
body1 = { young-modulus = "= E * (1 - softer)", poisson-ratio = 0.3 }
body2 = { rigid = true }
geometry = { type = "sphere", radius = 100e-6 }
grid = { cells = "= 2 * round(2 * fine)", size = "26 um" }
steps = [{ normal-load = "= load" }]
numerics = { allow-coarse = true }
output = { pictures = false, vtk = false }

[reference]
words = "the body as it is"
set = { "body1.young-modulus" = "= E" }
refine = { fine = [6, 9, 13] }

[[quantity]]
name = "approach"
is = "approach"

[[quantity]]
name = "pressure"
is = "interp(linspace(-4e-6, 4e-6, 9), x, row(pressure))"
tolerance = 0.1

[map]
x = "softer"
"""


@pytest.fixture
def toy(tmp_path):
    path = tmp_path / "toy.toml"
    path.write_text(TOY, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("toy")
    (folder / "toy.toml").write_text(TOY, encoding="utf-8")
    return folder, perform(read_campaign(folder / "toy.toml"), folder / "toy")


@pytest.fixture
def found(done):
    return done[1]


def test_a_model_agrees_where_it_is_right_and_is_caught_where_it_is_not(found):
    assert len(found.points) == 4
    for one in found.points:
        soft = one.point.values["softer"] > 0
        approach = next(finding for finding in one.findings if finding.quantity == "approach")
        assert approach.claimed is not soft
        assert approach.word == ("disagrees" if soft else "agrees")
        # the approach of a ball goes as E to the power -2/3
        expected = 0.8 ** (-2 / 3) - 1.0 if soft else 0.0
        assert abs(approach.error - expected) <= approach.uncertainty + 0.005
        assert approach.reference is not None
        assert approach.value is not None
        assert one.reference_seconds is not None
        assert one.all_seconds > one.reference_seconds
    assert found.exit_code == 0  # what disagrees is outside of the claim


@pytest.mark.slow
def test_error_bars_of_the_model_stand_beside_its_error(toy, done, tmp_path):
    copytree(done[0] / "toy", tmp_path / "toy")  # the runs of the reference are read again
    item = read_campaign(toy).with_errors()
    assert not any(study.changes for model in item.models for study in model.reference)
    report = perform(item, tmp_path / "toy", coarse=True)
    for one, judged in zip(
        report.points, (one for one in done[1].points if one.point.values["load"] == 0.4), strict=True
    ):
        findings = {finding.quantity: finding for finding in one.findings}
        bar = one.point.model.summary["errors"]["approach"]
        approach = findings["approach"]
        assert approach.run_error == close(bar["error"] / approach.scale)
        assert findings["pressure"].run_error is None
        soft = one.point.values["softer"] > 0
        assert approach.word == ("disagrees" if soft else "agrees")
        u_val = np.hypot(approach.run_error, approach.uncertainty)
        assert bool(approach.error > u_val) is soft
        assert approach.reason.startswith("model or implementation error E ± u_val" if soft else "agrees within u_val")
        before = {finding.quantity: finding for finding in judged.findings}
        assert before["approach"].run_error is None
        assert "tolerance" in before["approach"].reason
    files = write_map(report, tmp_path / "report")
    assert "| u_SA |" in files["markdown"].read_text(encoding="utf-8")
    assert "| u_SA |" not in write_map(done[1], tmp_path / "before")["markdown"].read_text(encoding="utf-8")
    axes = next(axes for axes in draw_map(report.campaign, report.points).axes if axes.get_title() == "approach")
    (container,) = axes.containers
    (bars,) = container[2]
    spans = [float(np.ptp(segment[:, 1])) for segment in bars.get_segments()]
    found = sorted(report.points, key=lambda one: one.point.values["softer"])
    assert spans == close([200 * one.findings[0].run_error for one in found])


def test_disagreement_inside_the_claim_fails(found):
    claim = replace(found.campaign, expect="")
    judged = tuple(replace(one, findings=tuple(replace(f, claimed=True) for f in one.findings)) for one in found.points)
    report = MapReport(campaign=claim, points=judged)
    assert report.exit_code == 1
    silent = tuple(replace(one, findings=tuple(replace(f, claimed=False) for f in one.findings)) for one in judged)
    assert totals(claim, silent).endswith("Agreement is claimed nowhere.")
    assert "2 disagree or failed" in totals(claim, judged) or "4 disagree or failed" in totals(claim, judged)


@pytest.mark.slow
def test_what_is_stored_is_read_again(toy, done, tmp_path):
    told = []
    copytree(done[0] / "toy", tmp_path / "out")
    runs = tmp_path / "out" / "runs"
    stamps = {path: path.stat().st_mtime_ns for path in runs.glob("*/results.nc")}
    assert len(stamps) == 16
    # an interrupted campaign lacks some runs: these alone are computed
    lost = next(iter(stamps))
    lost.with_name("variant.json").unlink()
    again = perform(read_campaign(toy), tmp_path / "out", tell=lambda *words: told.append(words))
    assert [words[1:] for words in told] == [(n + 1, 16) for n in range(16)]
    runs_of_a_point = {"model", *(f"reference, refinement {k} of 3" for k in (1, 2, 3))}
    names = {words[0] for words in told}
    assert {name for name in names if name.startswith("softer 0.2, P 0.4: ")} == {
        f"softer 0.2, P 0.4: {run}" for run in runs_of_a_point
    }
    assert [path for path, stamp in stamps.items() if path.stat().st_mtime_ns != stamp] == [lost]
    assert [one.findings for one in again.points] == [one.findings for one in done[1].points]


def test_files_are_written_and_tell_the_same(found, tmp_path):
    files = write_map(found, tmp_path)
    assert all(map(is_ours, files.values()))
    data = json.loads(files["json"].read_text(encoding="utf-8"))
    assert data["exit_code"] == 0
    assert len(data["points"]) == 4
    page = files["html"].read_text(encoding="utf-8")
    assert "data:image/png;base64," in page
    assert "http" not in page
    for text in (page, files["markdown"].read_text(encoding="utf-8")):
        assert "What both cost" in text
        assert "Agreement is claimed where softer" in text
    assert files["map"].stat().st_size > 5000
    assert "| (✗ 16 % ±" in as_section(found)
    assert "largest error" in as_section(found, trade=True)


def test_the_table_has_every_number_in_csv_and_latex(found, tmp_path):
    files = write_map(found, tmp_path)
    with files["csv"].open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert files["csv"].name == "table.csv"
    findings = [(point, finding) for point in found.points for finding in point.findings]
    assert len(rows) == len(findings)
    for row, (point, finding) in zip(rows, findings, strict=True):
        assert (row["quantity"], row["verdict"]) == (finding.quantity, finding.word)
        assert (float(row["softer"]), float(row["load"])) == (point.point.values["softer"], point.point.values["load"])
        assert float(row["error"]) == finding.error  # all digits
        assert float(row["model_seconds"]) > 0.0
    latex = files["latex"].read_text(encoding="utf-8")
    assert r"\begin{tabular}{rrll}" in latex
    assert r"taken off E & $P_{n}$ / N & approach & pressure \\" in latex
    assert latex.count(r" \%") == 2 * len(findings)
    assert "*" not in latex.split("\n", 1)[1]
    assert latex.count(r"$^\ast$") == sum(finding.word == "disagrees" for _, finding in findings)


def test_symbols_with_an_index_are_formulas_on_the_axes(found):
    (axes, *_) = draw_map(found.campaign, found.points).axes
    assert axes.get_ylabel() == "$P_{n}$ / N"
    assert axes.get_xlabel() == "taken off E"


def test_a_map_has_a_cell_for_each_point_and_a_curve_where_one_parameter_varies(found):
    assert axes_of_map(found.campaign, found.points) == ("softer", "load", [])
    figure = draw_map(found.campaign, found.points)
    words = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert len(words) == 8
    assert sum("✗ disagrees" in one for one in words) >= 2
    row = [one for one in found.points if one.point.values["load"] == 0.4]
    assert axes_of_map(found.campaign, row) == ("softer", None, [])
    curve = draw_map(found.campaign, row)
    assert {text.get_text() for text in curve.axes[0].texts} == {"✓ agrees", "✗ disagrees"}


def test_the_answer_says_from_where_on(found):
    lines = answers(found.campaign, found.points)
    assert "approach, load = 0.4: up to softer = 0" in lines


def test_an_island_is_no_answer(found):
    def point(at, word):
        source = found.points[0]
        numbers = {"tolerance": 0.1, "error": 0.0, "uncertainty": 0.0}
        finding = MapFinding(quantity="q", word=word, reason="", claimed=True, **numbers)
        values = {"softer": at, "load": 0.4}
        return JudgedPoint(point=replace(source.point, values=values), findings=(finding,))

    words = ["disagrees", "agrees", "inconclusive", "agrees", "agrees"]
    course = [point(float(n), word) for n, word in enumerate(words)]
    assert answers(found.campaign, course)[1] == "q: from softer = 3"
    course[-1] = point(4.0, "disagrees")
    assert answers(found.campaign, course)[1] == "q: nowhere at an end of the axis"


@pytest.mark.parametrize(
    ("error", "uncertainty", "word"),
    [(0.01, 0.009, "agrees"), (0.01, 0.011, "inconclusive"), (0.05, 0.031, "inconclusive"), (0.05, 0.029, "disagrees"),
     (np.nan, 0.0, "failed")],
)  # fmt: skip
def test_words(error, uncertainty, word):
    assert word_of(error, uncertainty, 0.02)[0] == word
    assert worst(["agrees", word]) == word
    assert worst([]) == "failed"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("tolerance = 0.03", "tolerence = 0.03", "unknown key 'tolerence' in campaign .*tolerance"),
        ('judge = "scene"', 'judge = "scenes"', "judge must be one of .*'scenes'.*did you mean 'scene'"),
        ("tolerance = 0.03", "tolerance = 3", "tolerance must be between 0 and 1 .got 3."),
        ("fine = [6, 9, 13]", "fine = [6, 9]", "reference.refine.fine must be three positive numbers"),
        ("fine = [6, 9, 13]", "fine = [6, 7, 13]", "by one ratio above 1.1"),
        ('x = "softer"', 'x = "soft"', "map.x must be one of softer, load .*did you mean 'softer'"),
        ('expect = "softer <= 0.01"', 'expect = "soft <= 0.01"', "expect.*'soft'.*softer"),
        ('title = "A', 'scenes = ["hertz"]\ntitle = "A', "either scene or scenes"),
        ('name = "pressure"', 'name = "approach"', "quantity names must be different .got 'approach' twice."),
        ("[map]", "[mapp]", "unknown key 'mapp'"),
    ],
)
def test_files_with_a_fault_are_refused_by_key(toy, old, new, message):
    toy.write_text(TOY.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(SceneError, match=message):
        read_campaign(toy)


@pytest.mark.slow
def test_different_numbers_of_values_are_told(toy, done):
    toy.write_text(TOY.replace('is = "approach"', 'is = "row(pressure)"', 1), encoding="utf-8")
    report = perform(read_campaign(toy), done[0] / "toy", coarse=True)
    reasons = {f.reason for one in report.points for f in one.findings if f.word == "failed"}
    assert len(reasons) == 1
    assert "equally many values in all models" in reasons.pop()
    assert report.exit_code == 1


@pytest.mark.slow
def test_a_variant_that_fails_is_told_and_stops_nothing(toy, tmp_path):
    toy.write_text(TOY.replace("[0.4, 0.6]", "[0.4, 400.0]", 1), encoding="utf-8")
    toy.write_text(toy.read_text(encoding="utf-8").replace("[0.0, 0.2]", "[0.0]", 1), encoding="utf-8")
    report = perform(read_campaign(toy), tmp_path / "out")
    assert [one.word for one in report.points] == ["agrees", "failed"]
    assert "edge" in report.points[1].findings[0].reason


@pytest.mark.slow
def test_exit_codes_of_the_command(toy, done, tmp_path):
    import typer

    app = typer.Typer()
    app.command()(command)
    run = CliRunner().invoke
    assert run(app, [str(toy), "--coarse", "-o", str(done[0])]).exit_code == 0
    page = tmp_path / "page.md"
    page.write_text("<!-- campaign:toy -->\n<!-- /campaign:toy -->\n", encoding="utf-8")
    toy.write_text(TOY.replace('expect = "softer <= 0.01"', ""), encoding="utf-8")
    options = ["--coarse", "-o", str(done[0]), "--markdown", str(page)]
    claimed = run(app, [str(toy), *options])
    assert claimed.exit_code == 1
    assert "disagree or failed" in claimed.output
    assert "✗ disagrees" in page.read_text(encoding="utf-8")
    wrong = run(app, ["inclusions-by-dept"])
    assert wrong.exit_code == 2
    assert "did you mean 'inclusions-by-depth'" in wrong.output
    assert run(app, [str(toy), "--markdown", str(toy)]).exit_code == 2
    assert "inclusions-by-depth" in run(app, []).output
    assert "reference" in run(app, ["--form"]).output
    assert run(app, ["coatings", "--show"]).output.startswith("title = ")


def test_bundled_campaigns_make_scenes():
    assert {"coatings", "inclusions-by-depth", "plastic-indentation", "voids", "whole-scenes"} == set(CAMPAIGNS.names())
    for name in CAMPAIGNS.names():
        item = CAMPAIGNS.find(name)
        coarse, fine = points_of(item, coarse=True), points_of(item)
        assert 1 < len(coarse) <= len(fine)
        assert [one.label for one in (*coarse, *fine) if one.model.variant.refused] == []
        assert any(item.claimed(one.model.names) for one in fine) is (item.expect != "0")


@dataclass(frozen=True, kw_only=True, eq=False)
class Ball(Case):
    """Approach of a ball that was read from a run; the reference has meshes that converge to Hertz's."""

    approach: float
    exact: float
    broken: bool = False

    def reference(self, level, outer):
        if self.broken and level == 2:
            raise ValueError("no convergence")
        return {"depth": np.full((2, 1), self.exact * (1.0 + 0.001 * 0.25**level + (outer == "free") * 0.001))}

    def judged(self):
        # what a run says of its own error does not excuse it in a map
        return {"depth": np.full((2, 1), self.approach), error_key("depth"): np.full((2, 1), 0.3 * self.approach)}


def by_hertz(*, scale=1.0, broken=False, subject="ball"):
    """Cases of a run; Hertz with the modulus of the body as it is."""

    def cases_of(folder):
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        modulus, radius = 210e9 / (1.0 - 0.3**2), 100e-6
        exact = scale * (3.0 * summary["normal_load"] / (4.0 * modulus * radius**0.5)) ** (2.0 / 3.0)
        points, along = np.zeros((2, 3)), np.arange(2.0)
        depth = Profile(name="depth", quantity="displacement", points=points, along=along, label="", components=("u",))
        given = {"approach": summary["approach"], "exact": exact}
        names = {"subject": subject, "name": "step", "parameters": given}
        case = Ball(**names, quick=True, profiles=(depth,), broken=broken, **given)
        return (case,), (Gap(subject=subject, what="stress", reason="none is stored"),)

    return cases_of


def here(tasks):
    for task in tasks:
        yield task, perform_task(task)


@pytest.fixture
def audited(toy, done):
    """Campaign that elements judge, and its points with their runs."""
    head, _, rest = TOY.partition("[reference]")
    text = head.replace('"scene"', '"audit"', 1) + rest[rest.index("[map]") :]
    toy.write_text(text, encoding="utf-8")
    item = read_campaign(toy)
    return item, perform_runs(points_of(item, coarse=True), done[0] / "toy" / "runs"), done[0] / "toy"


def test_elements_judge_runs_under_the_same_words(audited, tmp_path):
    item, points, folder = audited
    judged = judge_by_elements(item, points, folder, cases_of=by_hertz(), executor=here)
    assert [(one.point.values["softer"], one.word) for one in judged] == [
        (0.0, "agrees"), (0.2, "disagrees")
    ]  # fmt: skip
    assert all(one.gaps == ("stress: none is stored",) for one in judged)
    assert all(one.reference_seconds is not None and one.all_seconds >= one.reference_seconds for one in judged)
    report = MapReport(campaign=item, points=tuple(judged))
    assert report.exit_code == 0
    files = write_map(report, tmp_path)
    assert "stress: none is stored (2 of 2 points)" in files["html"].read_text(encoding="utf-8")
    # stored solutions are read: none is left to be solved, and a fault of the reference is then found in the claim
    fields = {key: one.findings for key, one in enumerate(judged)}

    def refusing(tasks):
        assert all(task.level is None for task in tasks)
        yield from here(tasks)

    again = judge_by_elements(item, points, folder, cases_of=by_hertz(), executor=refusing)
    assert {key: one.findings for key, one in enumerate(again)} == fields
    wrong = judge_by_elements(item, points, folder, cases_of=by_hertz(scale=1.05), executor=here)
    assert MapReport(campaign=item, points=tuple(wrong)).exit_code == 1


def test_a_solution_that_fails_is_told(audited):
    item, points, folder = audited
    judged = judge_by_elements(item, points, folder, cases_of=by_hertz(broken=True, subject="b"), executor=here)
    assert {one.word for one in judged} == {"failed"}
    assert "no convergence" in judged[0].findings[0].reason
    assert MapReport(campaign=item, points=tuple(judged)).exit_code == 1

    def nothing(_):
        return (), (Gap(subject="b", what="all", reason="it is worn"),)

    judged = judge_by_elements(item, points[:1], folder, cases_of=nothing, executor=here)
    assert judged[0].findings[0].reason == "nothing of it can be judged: all: it is worn"


#: Cells to the contact radius, judged by a contact that elements find themselves.
CELLS = """
title = "How many cells does a contact need?"
judge = "contact"
model = "some cells to the contact radius"
tolerance = 0.01
expect = "cells >= 16"
label = "{cells:g} cells"

[constants]
a = 6.0533e-6

[vary]
cells = [3, 16]

[scene]
body1 = { young-modulus = "210 GPa", poisson-ratio = 0.3 }
body2 = { rigid = true }
geometry = { type = "sphere", radius = "105 um" }
grid = { cells = "= 3 * cells", size = "= 3 * a" }
steps = [{ normal-load = "0.65 N" }]
numerics = { allow-coarse = true }
output = { pictures = false, vtk = false }
"""


@pytest.mark.slow
def test_a_contact_by_elements_judges_and_finds_too_few_cells(tmp_path):
    (tmp_path / "cells.toml").write_text(CELLS, encoding="utf-8")
    report = perform(read_campaign(tmp_path / "cells.toml"), tmp_path / "cells")
    words = {(one.point.values["cells"], f.quantity): f.word for one in report.points for f in one.findings}
    kinds = ("approach", "contact radius", "pressure, step 1")
    assert [words[16, kind] for kind in kinds] == ["agrees"] * 3
    assert words[3, "contact radius"] == "disagrees"
    assert report.exit_code == 0
    assert "Agreement is claimed where cells >= 16: 4 verdicts, of which 4 agree" in totals(
        report.campaign, report.points
    )


@pytest.mark.slow
def test_numbers_of_a_contact_have_their_bars(tmp_path):
    """A coarse contact is off by more than the tolerance, and not by more than its bar."""
    text = CELLS.replace("[3, 16]", "[8]").replace("output = {", "output = { errors = true,")
    (tmp_path / "cells.toml").write_text(text, encoding="utf-8")
    report = perform(read_campaign(tmp_path / "cells.toml"), tmp_path / "cells")
    findings = {finding.quantity: finding for finding in report.points[0].findings}
    summary = report.points[0].point.model.summary
    for quantity, name in {"contact area": "contact_area", "approach": "approach"}.items():
        bar = summary["errors"][name]
        assert findings[quantity].run_error == close(bar["relative"])
        assert findings[quantity].value == close(bar["value"])
        assert findings[quantity].error < findings[quantity].run_error + findings[quantity].uncertainty
    assert len({finding.quantity for finding in report.points[0].findings}) == len(report.points[0].findings)


#: Asks for the geometry of a plugin file, where it is solved; a module that processes import.
BOWLS = """
from dataclasses import dataclass
import numpy as np
from eigencontact.scene.installed import installed_plugins
from eigencontact_verification.crosscheck.case import Case, Profile

@dataclass(frozen=True, kw_only=True, eq=False)
class Bowl(Case):
    def reference(self, level, outer):
        return {"depth": np.full((2, 1), installed_plugins().get("geometry", "bowl").component.example["bend"])}

    def judged(self):
        return {"depth": np.full((2, 1), 1e-4)}

def of_bowls(folder):
    points, along = np.zeros((2, 3)), np.arange(2.0)
    depth = Profile(name="depth", quantity="displacement", points=points, along=along, label="", components=("u",))
    return (Bowl(subject="bowl", name=folder.name, parameters={}, quick=True, profiles=(depth,)),), ()
"""


@pytest.mark.slow
@pytest.mark.parametrize("cluster", [None, "local:1"])
def test_plugin_files_of_the_scenes_reach_who_solves(tmp_path, monkeypatch, cluster):
    (tmp_path / "bowl.py").write_text(BOWL, encoding="utf-8")
    (tmp_path / "bowl_cases.py").write_text(BOWLS, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    of_bowls = importlib.import_module("bowl_cases").of_bowls
    text = CELLS.replace('type = "sphere", radius = "105 um"', 'type = "bowl", bend = "105 um"')
    text = text.replace("[scene]", f"[scene]\nplugins = ['{tmp_path / 'bowl.py'}']").replace("[3, 16]", "[3]")
    (tmp_path / "bowls.toml").write_text(text, encoding="utf-8")
    engine = None if cluster is None else Cluster(cluster)
    report = perform(read_campaign(tmp_path / "bowls.toml"), tmp_path / "bowls", cluster=engine, cases_of=of_bowls)
    assert [one.word for one in report.points] == ["agrees"]


def test_every_key_is_explained():
    assert all(words for table in FORM.values() for words in table.values())


@pytest.mark.slow
def test_a_cluster_finds_the_same(toy, done, tmp_path):
    report = perform(read_campaign(toy), tmp_path / "out", cluster=Cluster("local:2"))
    for one, other in zip(report.points, done[1].points, strict=True):
        for mine, theirs in zip(one.findings, other.findings, strict=True):
            assert (mine.word, mine.error) == (theirs.word, close(theirs.error, rel=1e-6, abs=1e-9))


@pytest.mark.slow
def test_an_interrupted_campaign_says_so_and_continues(toy, done, tmp_path):
    begin = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"  # tests may run ignoring it
    program = f"{begin}; from eigencontact.cli import main; main()"
    words = [sys.executable, "-c", program, "campaign", str(toy), "-o", str(tmp_path)]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as running:
        seen = [running.stderr.readline() for _ in range(2)]
        running.send_signal(signal.SIGINT)
        rest = running.communicate(timeout=60)[1]
    assert seen[1].startswith("2 of 16: ")
    assert running.returncode == 130
    assert "the same command resumes" in rest
    stamps = {path: path.stat().st_mtime_ns for path in (tmp_path / "toy" / "runs").glob("*/variant.json")}
    assert 2 <= len(stamps) < 16
    again = perform(read_campaign(toy), tmp_path / "toy")
    assert all(path.stat().st_mtime_ns == stamp for path, stamp in stamps.items())
    assert [one.findings for one in again.points] == [one.findings for one in done[1].points]
