"""A run that dies between or within load steps, by kill -9 or Ctrl-C, continues and gives the same numbers."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

import eigencontact as ec

#: An observer that sends its own process a signal in one step, where the environment says so.
FATAL = '''
import os
import signal
from dataclasses import dataclass
from typing import ClassVar
from eigencontact.plugin import Observer, hookimpl

@dataclass(frozen=True, kw_only=True)
class Fatal(Observer):
    """Ends the process in the step named by the environment."""
    key: ClassVar[str] = "fatal"
    def observe(self, step):
        if str(step.index) == os.environ.get("FATAL_STEP"):
            # A shell lets its background jobs ignore the signal, and children inherit that.
            signal.signal(signal.SIGINT, signal.default_int_handler)
            os.kill(os.getpid(), int(os.environ["FATAL_SIGNAL"]))
        return {"peak": step.fields["pressure"].max()}

@hookimpl
def eigencontact_register():
    return [Fatal]
'''
#: Two ramps with different controls: the second starts from what the first ended with, stored or not.
SCENE = """
[[observers]]
type = "fatal"

[[stress]]
shape = "plane"
normal = "z"
position = "2 um"
name = "plane"
"""
LOAD = """
approach = "0.2 um"
increments = 2

[[steps]]
normal-load = "0.6 N"
increments = 3
"""


@pytest.fixture
def scene(scene_file, install):
    site = install(FATAL)
    path = scene_file(SCENE, load=LOAD)
    path.write_text(path.read_text(encoding="utf-8").replace("[steps]\n", "[[steps]]\n"), encoding="utf-8")
    return site, path


def stop(scene, folder, step, number):
    """Run in a process of its own, which gets a signal in a step."""
    site, path = scene
    environment = os.environ | {"PYTHONPATH": str(site), "FATAL_STEP": str(step), "FATAL_SIGNAL": str(int(number))}
    return subprocess.run(
        [sys.executable, "-m", "eigencontact.cli", "run", str(path), "-o", str(folder), "-q"],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


def same(one, other):
    """All numbers of two results but the times: contact to the last bit, stress to round-off.

    The stress operator is made for the first contact it meets, with transforms of that size.
    """
    with ec.open_results(one) as a, ec.open_results(other) as b:
        assert set(a.variables) == set(b.variables)
        for name in set(a.variables) - {"solve_seconds"}:
            first, second = a[name].values, b[name].values
            if "plane" in name or "von_mises" in name:
                np.testing.assert_allclose(first, second, rtol=0, atol=1e-12 * np.abs(second).max(), err_msg=name)
            else:
                np.testing.assert_array_equal(first, second, err_msg=name)
        assert a.attrs["scene_hash"] == b.attrs["scene_hash"]
        assert a.sizes["step"] == 5


@pytest.mark.slow
@pytest.mark.parametrize("step", [1, 2, 4])
def test_a_killed_run_continues_to_the_same_numbers(step, scene, tmp_path, command):
    killed = stop(scene, tmp_path / "killed", step, signal.SIGKILL)
    assert killed.returncode == -signal.SIGKILL
    stored = sorted(path.name for path in (tmp_path / "killed" / "steps").glob("*.step"))
    assert stored == [f"{index:04d}.step" for index in range(1, step)]
    with pytest.raises(ec.EigencontactError, match=rf"an interrupted run with {step - 1} stored steps.*--resume"):
        ec.open_results(tmp_path / "killed")
    if stored:
        before = (tmp_path / "killed" / "steps" / "0001.step").stat().st_mtime_ns
        again = command("run", scene[1], "-o", tmp_path / "killed", "-q")
        assert again.code == 5
        assert "--resume continues it" in again.err
        drawn = command("plot", tmp_path / "killed")
        assert drawn.code == 5
        assert f"(got an interrupted run with {step - 1} stored step" in drawn.err
        assert "; continue it with --resume" in drawn.err
        changes = ("--set", "body1.poisson-ratio=0.29", "--resume")
        changed = command("run", scene[1], "-o", tmp_path / "killed", "-q", *changes)
        assert changed.code == 5
        assert "--resume continues the same scene only" in changed.err
        assert (tmp_path / "killed" / "steps" / "0001.step").stat().st_mtime_ns == before
    resumed = command("run", scene[1], "-o", tmp_path / "killed", "-q", "--resume")
    assert (resumed.code, resumed.err) == (0, "")
    assert not (tmp_path / "killed" / "steps").exists()
    ec.run(scene[1], tmp_path / "whole")
    same(tmp_path / "killed", tmp_path / "whole")


def test_ctrl_c_returns_130_and_keeps_the_accepted_steps(scene, tmp_path, command):
    stopped = stop(scene, tmp_path / "out", 3, signal.SIGINT)
    assert stopped.returncode == 130
    assert stopped.stdout == ""
    assert stopped.stderr == "eigencontact: interrupted; accepted steps are kept, continue with --resume\n"
    assert len(list((tmp_path / "out" / "steps").glob("*.step"))) == 2
    assert command("run", scene[1], "-o", tmp_path / "out", "-q", "--resume").code == 0
    ec.run(scene[1], tmp_path / "whole")
    same(tmp_path / "out", tmp_path / "whole")
