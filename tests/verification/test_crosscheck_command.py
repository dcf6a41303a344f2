"""`eigencontact verify`, and how commands of other packages are found."""

import base64
import json
import subprocess
import sys
from importlib.metadata import EntryPoint

import pytest

import analytic_cases
import eigencontact.cli
import eigencontact_verification.crosscheck as package
from eigencontact.core.units import time_in_words
from eigencontact_verification.commands.verify import _chosen
from eigencontact_verification.crosscheck import cases, report
from eigencontact_verification.crosscheck import run as runner
from eigencontact_verification.crosscheck.progress import Bar
from eigencontact_verification.crosscheck.run import tasks_of
from eigencontact_verification.crosscheck.whole import crosscheck
from eigencontact_verification.crosscheck.worker import Outcome, perform

HEAVY = ("skfem", "scipy", "matplotlib", "pyvista", "numba", "pyamg", "eigencontact_verification.fem")


def here(tasks, **options):
    """Executor without processes."""
    yield from ((task, perform(task)) for task in tasks)


@pytest.fixture
def verify(verify_in_processes, monkeypatch):
    """Run the command on the analytic cases without other processes."""
    monkeypatch.setattr(runner, "in_processes", here)
    return verify_in_processes


#: The figure of a case, and a file in its place that costs nothing.
DRAW, NOTHING = report.draw, b"\x89PNG of eigencontact in the place of a figure"


@pytest.fixture(autouse=True)
def undrawn(monkeypatch):
    """Reports have files in the place of their figures."""

    def draw(_judged, file):
        file.write_bytes(NOTHING)
        return file

    monkeypatch.setattr(report, "draw", draw)


@pytest.fixture
def verify_in_processes(command, monkeypatch, tmp_path):
    """Run the command on the analytic cases in a folder of the test."""
    monkeypatch.setattr(package, "cases", analytic_cases, raising=False)
    monkeypatch.setitem(sys.modules, "eigencontact_verification.crosscheck.cases", analytic_cases)
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: command("verify", "--workers", "1", *arguments)


def test_everything_quick_agrees_or_is_listed(verify_in_processes, tmp_path):
    verify = verify_in_processes
    outcome = verify("--quick")
    assert outcome.code == 0, outcome.err
    (line,) = (line for line in outcome.out.splitlines() if line.startswith("inconclusive: other/blunt, x axis, u_x:"))
    assert " % of the field, exceeds the limit of 2 %; its largest part is the mesh of the finite elements (" in line
    assert "--refine" not in line  # this case has no finer mesh
    assert "analytic/full" not in outcome.out
    assert {"report.json", "report.md", "report.html"} <= {file.name for file in (tmp_path / "cross-check").iterdir()}
    again = verify("--quick", "--json")
    data = json.loads(again.out)
    assert [case["name"] for case in data["cases"]] == ["plain", "blunt"]
    assert all(task["cached"] for case in data["cases"] for task in case["tasks"][1:])
    assert data["counts"]["inconclusive"] > 0


def test_one_kernel_says_what_was_left_out(verify):
    outcome = verify("--kernel", "analytic", "--json", "-o", "out")
    data = json.loads(outcome.out)
    assert [case["name"] for case in data["cases"]] == ["plain", "full"]
    assert {"subject": "other", "what": "everything", "reason": "not requested in this run"} in data["not_covered"]
    assert outcome.code == 0


def test_refinement_is_refused_where_meshes_are_not_divided(verify):
    outcome = verify("--kernel", "analytic", "--refine", "1.5")
    assert outcome.code == 2
    assert "--refine must be of laws, plasticity, layers or inhomogeneities (got analytic/plain)" in outcome.err


def test_a_disagreement_is_an_exit_code(verify, monkeypatch):
    monkeypatch.setattr(analytic_cases, "cases_of", lambda _: (analytic_cases.analytic("wrong", "sign"),))
    outcome = verify("analytic", "--quiet")
    assert outcome.code == 1
    assert outcome.out == ""


def test_a_failed_solution_is_an_exit_code(verify, monkeypatch):
    monkeypatch.setattr(analytic_cases, "cases_of", lambda _: (analytic_cases.analytic("bad", "raises"),))
    outcome = verify("analytic")
    assert outcome.code == 1
    assert "mesh is tangled" in outcome.out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["analytik"], "got 'analytik'); did you mean 'analytic'?"),
        (["--kernel", "zzz"], "kernel must be one of analytic, other (got 'zzz')"),
        (["--limit", "2"], "--limit must be between 0 and 1 (got 2.0)"),
        (["--workers", "0"], "--workers"),
        (["odd"], "shape 'odd' must be buildable from lengths"),
        (["--markdown", "nowhere.md"], "nowhere.md"),
        (["--figure", "plain.png"], "--figure must be CASE=FILE.png (got plain.png)"),
        (["--figure", "analytic/plan=a.png"], "got 'analytic/plan'); did you mean 'analytic/plain'?"),
    ],
)
def test_wrong_input_is_refused(verify, tmp_path, arguments, words):
    outcome = verify(*arguments)
    assert outcome.code == 2
    assert words in outcome.err
    assert outcome.out == ""
    assert list(tmp_path.iterdir()) == []


def test_what_has_no_quick_case_is_told_why_and_what_all_costs():
    """Two cases of four finite-element solutions each; not as if the file lacked something."""
    words = r"for example a shape of revolution \(got layer\); without --quick: 8 cases, 32 finite-element solves, "
    with pytest.raises(ValueError, match=words):
        _chosen(cases, ["layer"], quick=True)


def test_lines_without_a_terminal_are_seldom(monkeypatch, capsys):
    """One at the beginning, then one where ten seconds have passed; failures at once."""
    now = [0.0]
    monkeypatch.setattr("eigencontact_verification.reporting.progress.monotonic", lambda: now[0])
    tasks = tasks_of(cases.cases_of("layer")[0])
    with Bar(show=True) as bar:
        bar.started(tasks)
        for task, seconds, status in zip(tasks, (4.0, 9.0, 14.0, 20.0, 130.0), ("done",) * 4 + ("time",), strict=True):
            now[0] = seconds
            bar.finished(task, Outcome(status=status, reason="too long" * (status == "time")))
    first, third, failed, last = capsys.readouterr().err.splitlines()
    assert first == "5 solutions to compute"
    left = 14.0 * (sum(task.weight for task in tasks) / sum(task.weight for task in tasks[:3]) - 1.0)
    assert third == f"solution 3 of 5: {tasks[2].case.key}, {tasks[2].label}; about {time_in_words(left)} left"
    assert failed == f"{tasks[-1].case.key}, {tasks[-1].label}: too long"
    assert last == f"solution 5 of 5: {tasks[-1].case.key}, {tasks[-1].label}"


@pytest.mark.slow
def test_markdown_and_figure(verify, tmp_path, monkeypatch):
    monkeypatch.setattr(report, "draw", DRAW)
    page, markers = tmp_path / "page.md", ("<!-- verify:coverage -->", "<!-- /verify:coverage -->")
    page.write_text("\n".join(["before", *markers, "after"]), encoding="utf-8")
    arguments = ("--markdown", page, "--figure", f"analytic/plain={tmp_path}/new/plain.png")
    outcome = verify("analytic", "--quick", *arguments)
    assert outcome.code == 0, outcome.err
    text = page.read_text(encoding="utf-8")
    assert text.startswith(f"before\n{markers[0]}\n\n1 case (quick), 5 verdicts")
    assert text.endswith(f"\n{markers[1]}\nafter")
    assert "| analytic | ✓ 1/1" in text
    figure = (tmp_path / "new" / "plain.png").read_bytes()
    assert figure.startswith(b"\x89PNG")
    assert figure != NOTHING


def test_markers_are_looked_for_before_anything_is_solved(verify, tmp_path):
    (tmp_path / "page.md").write_text("nothing\n", encoding="utf-8")
    for arguments, section in ([], "coverage"), (["--section", "part"], "part"):
        outcome = verify("--markdown", "page.md", *arguments)
        assert outcome.code == 2
        assert f"page.md must have the lines '<!-- verify:{section} -->' and" in outcome.err
    assert not (tmp_path / "cross-check").exists()


def test_pictures_that_fail_are_said(tmp_path, monkeypatch):
    case = analytic_cases.analytic("plain")

    def broken(self, folder):
        raise OSError("no\ndisplay")

    monkeypatch.setattr(analytic_cases.Analytic, "pictures", broken)
    report, _ = crosscheck([case], (), tmp_path, executor=here, pictures=True)
    assert report.notes == ("analytic/plain: no pictures, OSError: no display",)


def test_pictures_stand_in_the_report(tmp_path, monkeypatch):
    """Whatever PNG a case wrote, beside its profiles; in the page itself, and by name in the Markdown."""

    def drawn(self, folder):
        folder.mkdir(parents=True)
        (folder / "mesh.png").write_bytes(b"PNG of a mesh")
        return (folder / "mesh.png",)

    monkeypatch.setattr(analytic_cases.Analytic, "pictures", drawn)
    case = analytic_cases.analytic("plain")
    report, files = crosscheck([case], (), tmp_path, executor=here, pictures=True)
    assert report.notes == ("analytic/plain: mesh and field in fields/analytic-plain: mesh.png",)
    assert base64.b64encode(b"PNG of a mesh").decode() in files["html"].read_text(encoding="utf-8")
    assert "(fields/analytic-plain/mesh.png)" in files["markdown"].read_text(encoding="utf-8")
    again, files = crosscheck([case], (), tmp_path, executor=here)
    assert again.pictures == {}
    assert "mesh.png" not in files["markdown"].read_text(encoding="utf-8")


# --- commands of other packages ---------------------------------------------------------------------------------------


def plant(monkeypatch, *points):
    """Entry points as if packages had them installed."""

    def found(*, group, name=None):
        return [one for one in points if one.group == group and name in (None, one.name)]

    monkeypatch.setattr(eigencontact.cli, "entry_points", found)


def point(name, value):
    return EntryPoint(name, value, "eigencontact.commands")


def test_a_command_that_cannot_be_imported_says_so_and_stops_nothing_else(command, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    plant(
        monkeypatch,
        point("broken", "no_such_module:command"),
        point("verify", "eigencontact_verification.commands.verify:verify"),
    )
    outcome = command("--help")
    assert outcome.code == 0
    assert "cannot be loaded from no_such_module:command" in outcome.out
    assert "Cross-check kernels" in outcome.out
    outcome = command("broken", "--anything", "x")
    assert outcome.code == 2
    assert outcome.err.startswith("eigencontact: command 'broken' cannot be loaded from no_such_module:command")
    assert outcome.err.count("\n") == 1
    assert command("gallery").code == 0


def test_a_command_cannot_take_the_place_of_our_own(command, monkeypatch):
    plant(monkeypatch, point("gallery", "no_such_module:command"))
    outcome = command("gallery")
    assert outcome.code == 0
    assert "hertz" in outcome.out


@pytest.mark.parametrize("arguments", [["--help"], ["verify", "--help"]])
def test_help_imports_no_finite_elements(arguments):
    code = (
        "import sys\nfrom eigencontact.cli import app\n"
        f"try:\n    app(prog_name='eigencontact', args={arguments})\nexcept SystemExit:\n    pass\n"
        f"print([name for name in {HEAVY} if name in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "verify" in done.stdout
    assert done.stderr.strip() == "[]"
