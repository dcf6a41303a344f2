"""Lines that a run writes where its output is no terminal, and where its time went."""

import io
import json
from dataclasses import dataclass
from math import fsum

import pytest

import eigencontact as ec
from close import close
from eigencontact.progress import ProgressLines, VerboseLines, draws_in_place


@dataclass
class Numbered:
    """A load point or a stored step, as far as it is told."""

    index: int


def told(times):
    """Lines about load steps that end at these times, the run beginning at 0."""
    now = [0.0]
    stream = io.StringIO()
    lines = ProgressLines(stream, clock=lambda: now[0])
    for index, end in enumerate(times, start=1):
        lines.step_started(Numbered(index), len(times))
        now[0] = end
        lines.step_finished(Numbered(index), len(times))
    return stream.getvalue().splitlines()


def test_a_line_per_load_step_tells_the_time_that_is_left():
    assert told([10.0, 12.0, 14.0]) == [
        "load step 1 of 3 done after 10 s, about 20 s left",
        "load step 2 of 3 done after 12 s, about 2 s left",  # the first step builds what the others only use
        "load step 3 of 3 done after 14 s",
    ]


def test_thousands_of_load_steps_do_not_flood():
    lines = told([0.01 * index for index in range(1, 5001)])  # 50 s
    assert 40 <= len(lines) <= 51
    assert lines[-1] == "load step 5000 of 5000 done after 50 s"


def test_runs_within_a_second_say_nothing():
    assert told([0.1, 0.5, 0.9]) == []
    assert told([0.1, 0.5, 1.1]) == ["load step 3 of 3 done after 1.1 s"]


def test_long_times_are_readable():
    assert told([400.0, 7000.0])[0].endswith("done after 6 min 40 s, about 6 min 40 s left")
    assert told([36000.0, 36001.0])[0].endswith("done after 10 h 0 min, about 10 h 0 min left")
    assert told([99.7, 199.4])[0].endswith("done after 100 s, about 100 s left")


def test_a_load_step_that_takes_long_says_how_far_it_is():
    now = [0.0]
    stream = io.StringIO()
    lines = ProgressLines(stream, clock=lambda: now[0])
    lines.step_started(Numbered(1), 2)
    for now[0] in range(0, 60, 4):
        lines.iterated("contact", 1e-3, 1e-6)
    assert stream.getvalue().splitlines() == ["load step 1 of 2: contact, residual 1.0e-03, to fall to 1.0e-06"] * 3


SMALL = ["grid.cells-per-contact-radius=8", "output.vtk=false", "numerics.threads=1"]
BARE = [*SMALL, "stress=[]", "output.pictures=false"]


@pytest.mark.usefixtures("small_pictures")
def test_summary_and_console_say_where_the_time_went(command, tmp_path):
    outcome = command("run", "hertz", "-o", str(tmp_path), *(word for text in SMALL for word in ("--set", text)))
    last = outcome.out.splitlines()[-1]
    assert last.startswith("  set-up ")
    assert " s, rest " in last
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    seconds = summary["seconds_by_block"]
    blocks = ["separation", "normal-contact", "reference-pressure", "stress-section", "stress-axis"]
    assert sorted(seconds) == sorted(["set-up", *blocks, "storing", "pictures", "rest"])
    assert all(value >= 0 for value in seconds.values())
    assert fsum(seconds.values()) == close(summary["total_seconds"], 1e-12)
    # What the driver does beside its blocks is little; what compute_seconds counts twice would show here.
    assert fsum(seconds[name] for name in blocks) <= summary["compute_seconds"]


@pytest.mark.parametrize(("words", "lines"), [((), 1), (("--quiet",), 0), (("--json",), 0)])
def test_lines_are_written_where_the_output_is_no_terminal(words, lines, command, tmp_path, monkeypatch):
    monkeypatch.setattr("eigencontact.progress._LINES", 0.0)
    outcome = command("run", "hertz", *words, "-o", str(tmp_path), *(w for text in BARE for w in ("--set", text)))
    assert [line.partition(" after ")[0] for line in outcome.err.splitlines()] == ["load step 1 of 1 done"] * lines


def test_a_plan_that_was_made_before_counts_in_the_time_of_its_run():
    plan = ec.plan(ec.load_scene("hertz", ["stress=[]", *SMALL]))
    summary = ec.run(plan).summary
    assert summary["seconds_by_block"]["set-up"] >= plan.seconds_planned > 0
    assert summary["total_seconds"] >= plan.seconds_planned


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self):
        return True


@pytest.mark.parametrize(
    ("environment", "expected"),
    [({"TERM": "xterm"}, True), ({"TERM": "dumb"}, False), ({"TERM": "xterm", "JPY_PARENT_PID": "1"}, False)],
)
def test_bars_are_drawn_where_a_cursor_moves_only(monkeypatch, environment, expected):
    monkeypatch.delenv("JPY_PARENT_PID", raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert draws_in_place(Terminal()) is expected
    assert not draws_in_place(io.StringIO())


def test_a_full_line_per_load_step_tells_work_residuals_and_times():
    stream = io.StringIO()
    changes = ["grid.cells-per-contact-radius=8", "stress=[]", "steps.1.increments=2", "output.pictures=false"]
    run = ec.run(ec.load_scene("cattaneo-mindlin", changes), watcher=VerboseLines(stream))
    lines = stream.getvalue().splitlines()
    assert [line.split(":")[0] for line in lines] == [f"load step {n} of 3" for n in (1, 2, 3)]
    last = run.summary["history"][-1]
    assert f"{last['iterations']:.0f} iterations" in lines[-1]
    assert "load 12.307 N" in lines[-1]
    assert "tangential load 3.07" in lines[-1]
    assert f"stick {last['stick_residual']:.0e}" in lines[-1]
    assert "frictional-contact " in lines[-1]


def test_the_command_tells_of_load_steps_where_it_is_asked_to(command, tmp_path):
    changes = [word for text in BARE for word in ("--set", text)]
    outcome = command("run", "hertz", "-v", "--json", *changes, "-o", tmp_path)
    assert outcome.err.startswith("load step 1 of 1: load 650 mN, approach ")
    assert json.loads(outcome.out)["converged"] is True
