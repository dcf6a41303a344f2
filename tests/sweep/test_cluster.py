"""Sweeps on a cluster: the numbers of a serial sweep to the bit, workers and schedulers that die, what is refused."""

import contextlib
import multiprocessing
import os
import runpy
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from eigencontact.core.memory import machine_bytes
from eigencontact.engines import cluster as engine_of_cluster
from eigencontact.engines.cluster import Cluster, cluster_of
from eigencontact.engines.versions import unlike, versions
from eigencontact.errors import ClusterError, EigencontactError, SceneError
from eigencontact.sweeps.runner import Outcome
from eigencontact.sweeps.sweep import sweep
from hooks.test_plugin_files import BOWL
from sweep.test_sweep import SCENE

VARY = {"steps.normal-load": {"from": 0.1, "to": 1.0, "count": 8}}


@pytest.mark.parametrize("address", ["local", "local:0", "local:x", "local:2000", "somewhere", "host:"])
def test_addresses_that_are_none(address):
    with pytest.raises(ClusterError, match=r"cluster must be local:N, .*got '" + address):
        Cluster(address)


def test_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ClusterError, match=r"install eigencontact\[cluster\]"):
        Cluster("local:2")


@pytest.mark.parametrize("content", [b'{"a": 1}', b"[1]", b'{"address": 5}', b'{"address": ""}', b"\xff\xfe", b""])
def test_files_without_the_address_of_a_scheduler(tmp_path, content):
    pytest.importorskip("distributed")
    path = tmp_path / "scheduler.json"
    path.write_bytes(content)
    with pytest.raises(ClusterError, match=r"file .*scheduler.json must contain the address of a scheduler \(got "):
        sweep(SCENE, VARY, cluster=str(path))


@pytest.mark.parametrize("what", ["workers=2", "cluster='local:2'"])
@pytest.mark.parametrize(
    ("before", "refused"), [("", True), ("for _ in range(1):\n    ", True), ("if __name__ == '__main__':\n    ", False)]
)
def test_a_script_without_the_guard_is_refused_before_a_process_starts(tmp_path, monkeypatch, what, before, refused):
    if "cluster" in what:
        pytest.importorskip("distributed")
    monkeypatch.setattr("eigencontact.sweeps.sweep.outcomes", lambda variants, *_, **__: [  # nothing is run
        Outcome(variant.place, {}, {}, "not run", 0.0) for variant in variants])  # fmt: skip
    script = tmp_path / "loads.py"
    call = f"sweep({SCENE}, {VARY}, {str(tmp_path / 'out')!r},\n{what})"
    script.write_text(f"from eigencontact.sweeps.sweep import sweep\n{before}{call}\n", encoding="utf-8")
    with pytest.raises(EigencontactError) as told:
        runpy.run_path(str(script), run_name="__main__")
    guard = 'loads.py, line {} must be below `if __name__ == "__main__":` (got {} outside of it)'
    assert (guard.format(2 + bool(before), what) in str(told.value)) == refused
    assert refused != (tmp_path / "out").exists()


def test_options_that_contradict():
    with pytest.raises(ClusterError, match="memory must be used with --cluster"):
        cluster_of(None, 4.0, None, say=print)
    with pytest.raises(ClusterError, match="threads must be used with --cluster"):
        cluster_of(None, None, 4, say=print)
    pytest.importorskip("distributed")
    with pytest.raises(SceneError, match="workers must be without cluster"):
        sweep(SCENE, VARY, cluster="local:2", workers=2)


@pytest.mark.parametrize(
    ("found", "words"),
    [
        ({"eigencontact": "1.0", "bowls": "2.0", "more": "3.0"}, ""),
        ({"eigencontact": "1.0"}, "must have bowls 2.0 (got none); install it"),
        ({"eigencontact": "0.9", "bowls": "2.1"}, "must have eigencontact 1.0, bowls 2.0 (got 0.9, 2.1); install it"),
        ({}, "must have eigencontact 1.0, bowls 2.0 (got none, none); install it"),
    ],
)
def test_versions_that_are_not_ours(found, words):
    assert unlike({"eigencontact": "1.0", "bowls": "2.0"}, found) == words


def test_versions_are_those_of_packages_with_plugins(install):
    before = versions()
    install("", name="eigencontact-stranger", version="1.2.3")
    assert versions() == {**before, "eigencontact-stranger": "1.2.3"}


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


@pytest.mark.slow
def test_no_scheduler_there(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(engine_of_cluster, "_CONNECT", 1.0)
    address = f"tcp://127.0.0.1:{free_port()}"
    began = time.monotonic()
    with pytest.raises(ClusterError, match=f"reachable within 1 s .*{address}") as refused:
        sweep(SCENE, VARY, cluster=address)
    assert time.monotonic() - began < 20.0
    assert "\n" not in str(refused.value)


def same_to_the_bit(one, other):
    for name in ("max_pressure", "contact_radius", "approach", "pressure"):
        assert np.array_equal(one.dataset[name].values, other.dataset[name].values), name
        assert np.isfinite(one.dataset[name].values).all()


@pytest.fixture(scope="module")
def serial():
    pytest.importorskip("distributed")
    return sweep(SCENE, VARY, fields=["pressure"])


@pytest.mark.slow
@pytest.mark.parametrize("workers", [2, 4])
def test_numbers_of_the_serial_sweep(serial, tmp_path, workers):
    said = []
    engine = Cluster(f"local:{workers}", say=said.append)
    same_to_the_bit(sweep(SCENE, VARY, tmp_path, fields=["pressure"], cluster=engine), serial)
    assert f"{workers} workers" in said[0]
    assert "dashboard: http://127.0.0.1:" in said[0]
    assert said[0].endswith("/status (this machine only)")
    assert not list(tmp_path.glob(".eigencontact-*"))


@pytest.mark.slow
def test_no_other_machine_reaches_a_cluster_of_this_one():
    psutil = pytest.importorskip("psutil")
    pytest.importorskip("distributed")
    before = {end.laddr for end in psutil.Process().net_connections()}
    with Cluster("local:1"):
        processes = [psutil.Process(), *psutil.Process().children(recursive=True)]
        ends = [end for process in processes for end in process.net_connections() if end.status == "LISTEN"]
        new = {end.laddr for end in ends} - before
    assert len(new) > 2
    assert {address.ip for address in new} == {"127.0.0.1"}


@pytest.mark.slow
def test_a_worker_killed_while_it_starts():
    dask = pytest.importorskip("dask")
    with (
        dask.config.set({"distributed.worker.preload": ["import os; os._exit(9)"]}),
        pytest.raises(ClusterError, match=r"cluster local:1 must start its workers \(got: .*\); a worker died while"),
    ):
        sweep(SCENE, VARY, cluster="local:1")


def test_a_worker_killed_while_it_is_asked(monkeypatch):
    """Its answers are missing: the number of them, and how dask says so, are its own."""
    pytest.importorskip("distributed")
    engine = Cluster("local:1")
    monkeypatch.setattr(engine, "_check", lambda _: max({}.values()))
    with pytest.raises(ClusterError, match="workers of local:1 must stay connected during the query"):
        next(engine.map(max, [1], lambda _: 5))


@pytest.mark.slow
def test_a_killed_worker_costs_its_task_only(serial, tmp_path):
    killed = []

    def told(outcome, done, total):
        if done == 2:
            workers = [one for one in multiprocessing.active_children() if "Worker" in one.name or "Dask" in one.name]
            killed.append(workers[0].pid)
            os.kill(workers[0].pid, signal.SIGKILL)

    found = sweep(SCENE, VARY, tmp_path, fields=["pressure"], cluster="local:2", report_progress=told)
    assert len(killed) == 1
    assert not found.failed
    same_to_the_bit(found, serial)


@contextlib.contextmanager
def started(*words, path=None):
    """A scheduler or worker of dask, in a process of its own."""
    env = os.environ | ({"PYTHONPATH": str(path)} if path else {})
    process = subprocess.Popen(
        [sys.executable, "-m", *words], env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def scheduler(port):
    address = ("--host", "127.0.0.1", "--port", str(port), "--dashboard-address", "127.0.0.1:0")
    return started("distributed.cli.dask_scheduler", *address)


def worker(port, path=None):
    options = ("--nthreads", "1", "--no-dashboard", "--death-timeout", "60")
    return started("distributed.cli.dask_worker", f"tcp://127.0.0.1:{port}", *options, path=path)


@pytest.mark.slow
def test_a_scheduler_that_dies_and_one_that_goes_on(serial, tmp_path):
    port = free_port()
    address = f"tcp://127.0.0.1:{port}"
    with scheduler(port) as first, worker(port):

        def told(outcome, done, total):
            if done == 3:
                first.kill()

        with pytest.raises(ClusterError, match=r"lost after [3-7] of 8.*the same command resumes"):
            sweep(SCENE, VARY, tmp_path, fields=["pressure"], cluster=address, report_progress=told)
    kept = {path: path.stat().st_mtime_ns for path in tmp_path.glob("*/results.nc")}
    assert 3 <= len(kept) < 8
    with scheduler(port), worker(port):
        same_to_the_bit(sweep(SCENE, VARY, tmp_path, fields=["pressure"], cluster=address), serial)
    assert {path: path.stat().st_mtime_ns for path in kept} == kept


@pytest.mark.slow
@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("__version__ = '0.0.9'", r"worker tcp://\S+ must have eigencontact \S+ \(got 0.0.9\)"),
        ("raise ImportError", r"worker tcp://\S+ must have eigencontact \S+ \(got none\)"),
    ],
)
def test_workers_unlike_this_machine_are_refused(tmp_path, content, words):
    pytest.importorskip("distributed")
    (tmp_path / "eigencontact").mkdir()
    (tmp_path / "eigencontact" / "__init__.py").write_text(content, encoding="utf-8")
    port = free_port()
    with scheduler(port), worker(port, tmp_path), pytest.raises(ClusterError, match=words):
        sweep(SCENE, VARY, cluster=f"tcp://127.0.0.1:{port}")


@pytest.mark.slow
def test_a_folder_that_workers_do_not_see_and_memory_that_they_have_not(tmp_path, monkeypatch):
    pytest.importorskip("distributed")
    with Cluster("local:1") as engine:  # opened once for both
        address = engine._client.scheduler.address
        with pytest.raises(ClusterError, match="memory of a task must not exceed that of a worker"):
            sweep(SCENE, VARY, tmp_path, cluster=Cluster(address, memory=2.0 * machine_bytes()))
        with pytest.raises(ClusterError, match=r"threads of a task must not exceed those of a worker \(got 4096, "):
            sweep(SCENE, VARY, tmp_path, cluster=Cluster(address, threads=4096))
        assert not sweep(SCENE, VARY, tmp_path / "enough", cluster=Cluster(address, threads=1)).failed
        touch = Path.touch
        unseen = lambda path: None if path.name.startswith(".eigencontact-") else touch(path)  # noqa: E731
        monkeypatch.setattr(Path, "touch", unseen)
        with pytest.raises(ClusterError, match=f"must have access to {tmp_path}"):
            sweep(SCENE, VARY, tmp_path, cluster=address)


@pytest.mark.slow
def test_a_worker_without_a_package_of_plugins_is_refused(install):
    pytest.importorskip("distributed")
    install("", name="eigencontact-stranger", version="1.2.3")
    port = free_port()
    words = r"worker tcp://\S+ must have eigencontact-stranger 1.2.3 \(got none\); install it"
    with scheduler(port), worker(port), pytest.raises(ClusterError, match=words):
        sweep(SCENE, VARY, cluster=f"tcp://127.0.0.1:{port}")


@pytest.mark.slow
def test_plugin_files_reach_workers_that_do_not_see_them(tmp_path):
    """The file is moved away before a worker is asked for anything, and back for the command itself."""
    pytest.importorskip("distributed")
    path, away = tmp_path / "bowl.py", tmp_path / "elsewhere.py"
    path.write_text(BOWL, encoding="utf-8")
    scene = {**SCENE, "plugins": [str(path)], "geometry": {"type": "bowl", "bend": "100 um"}}
    alone = sweep(scene, VARY, fields=["pressure"])

    def told(outcome, done, total):
        if done == total:
            away.rename(path)

    engine = Cluster("local:2", say=lambda _: path.rename(away))
    found = sweep(scene, VARY, tmp_path / "out", fields=["pressure"], cluster=engine, report_progress=told)
    assert not found.failed
    same_to_the_bit(found, alone)


@pytest.mark.slow
def test_a_task_that_cannot_be_sent_costs_no_other():
    pytest.importorskip("distributed")
    with Cluster("local:1") as engine:
        found = list(engine.map(max, [3, (one for one in range(2))], lambda _: 5))
        alone = list(engine.map(max, [(one for one in range(2))], lambda _: 5))
    assert found[0] == (3, 5)
    assert found[1][1].reason.startswith("cannot be sent to a worker: ")
    assert len(found) == 2
    assert len(alone) == 1
