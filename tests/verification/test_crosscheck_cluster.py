"""`eigencontact verify --cluster`: the whole command with real workers, one of which dies; a scheduler that dies."""

import json
import multiprocessing
import os
import signal
import sys
from pathlib import Path

import pytest

import analytic_cases
import eigencontact_verification.crosscheck as package
from eigencontact.scene.installed import installed_plugins
from eigencontact_verification.crosscheck.progress import Bar
from hooks.test_plugin_files import BALL
from sweep.test_cluster import free_port, scheduler, worker

TESTS = Path(__file__).parent.parent


@pytest.fixture
def verify(command, monkeypatch, tmp_path):
    """Run the command on the analytic cases, in the folder of the test."""
    pytest.importorskip("distributed")
    monkeypatch.setattr(package, "cases", analytic_cases, raising=False)
    monkeypatch.setitem(sys.modules, "eigencontact_verification.crosscheck.cases", analytic_cases)
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: command("verify", *arguments)


def verdicts(outcome):
    """Verdicts, errors and uncertainties of a report, without what differs from run to run."""
    data = json.loads(outcome.out)
    return data["counts"], [case["rows"] for case in data["cases"]]


@pytest.fixture
def after(monkeypatch):
    """Do something as soon as a number of solutions is finished."""

    def arrange(count, action):
        seen, known = [], Bar.finished

        def finished(self, task, outcome):
            known(self, task, outcome)
            seen.append(task)
            if len(seen) == count:
                action()

        monkeypatch.setattr(Bar, "finished", finished)
        return seen

    return arrange


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--workers", "2"], "--workers must be left out with --cluster, which sets its own number (got 2)"),
        (["--cluster", "local:0"], "cluster must be local:N, N from 1 to 1024 (got 'local:0')"),
    ],
)
def test_what_is_refused(verify, arguments, words, tmp_path):
    outcome = verify("--cluster", "local:2", *arguments)
    assert outcome.code in (2, 6)
    assert words in outcome.err
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_the_whole_command_while_a_worker_is_killed(verify, after):
    killed = []

    def kill():
        workers = [one for one in multiprocessing.active_children() if "Worker" in one.name or "Dask" in one.name]
        killed.append(workers[0].pid)
        os.kill(workers[0].pid, signal.SIGKILL)

    alone = verify("--workers", "1", "--json", "-o", "alone")
    after(2, kill)
    found = verify("--cluster", "local:2", "--json", "-o", "cluster")
    assert len(killed) == 1
    assert found.code == alone.code, found.err
    assert verdicts(found) == verdicts(alone)
    assert "2 workers" in found.err
    assert "dashboard: http://127.0.0.1:" in found.err


@pytest.mark.slow
def test_more_memory_than_a_worker_has_is_refused(verify):
    outcome = verify("--cluster", "local:1", "--memory", "1e6")
    assert outcome.code == 6
    assert "memory of a task must not exceed that of a worker (got 1e+06 GB, the largest worker" in outcome.err


@pytest.mark.slow
def test_a_scheduler_that_dies_and_one_that_goes_on(verify, after):
    port = free_port()
    options = ("--cluster", f"tcp://127.0.0.1:{port}", "--json")
    alone = verify("--workers", "1", "--json", "-o", "alone")
    with scheduler(port) as first, worker(port, TESTS):
        seen = after(3, first.kill)
        broken = verify(*options)
    assert broken.code == 6
    assert "the same command resumes" in broken.err
    kept = {path: path.stat().st_mtime_ns for path in Path("cross-check", "solutions").rglob("*") if path.is_file()}
    assert kept
    with scheduler(port), worker(port, TESTS):
        before = len(seen)
        found = verify(*options)
    assert found.code == alone.code, found.err
    assert verdicts(found) == verdicts(alone)
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    cases = json.loads(found.out)["cases"]
    assert len(seen) - before == sum(not task["cached"] for case in cases for task in case["tasks"])
    assert sum(task["cached"] for case in cases for task in case["tasks"]) >= len(kept)


@pytest.mark.slow
def test_plugin_files_reach_workers(command, tmp_path, monkeypatch):
    """A ball of one file, beside the bundled one: its file is gone before a worker is asked for anything."""
    from eigencontact_verification.commands import verify as module

    pytest.importorskip("distributed")
    monkeypatch.chdir(tmp_path)
    installed_plugins.cache_clear()
    path = tmp_path / "bead.py"
    path.write_text(BALL, encoding="utf-8")
    known = module.typer.echo

    def echo(words, **options):
        if "workers" in words:
            path.unlink()
        known(words, **options)

    monkeypatch.setattr(module.typer, "echo", echo)
    monkeypatch.setattr(module, "_chosen", only_the_answer)
    try:
        outcome = command("verify", "--quick", "--plugin", str(path), "--cluster", "local:1", "--json")
    finally:
        installed_plugins.cache_clear()
    tasks = json.loads(outcome.out)["cases"][0]["tasks"]
    assert not path.exists()
    assert tasks[0]["status"] == "done", tasks


def only_the_answer(cases, names, *, quick):
    """The first quick case of a kernel, of which the elements fail at once."""
    return tuple(case for name in names for case in cases.cases_of(name) if case.quick == quick)[:1]
