"""Run one task in a fresh process, with a limit on its time."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eigencontact_verification.benchmarks.task import Sample, Task

__all__ = ["run_fresh"]

#: Path of our package comes last, so that another interpreter finds its own packages first.
_START = (
    "import sys; sys.path.append(sys.argv[1]); "
    "from eigencontact_verification.benchmarks.worker import main; main(*sys.argv[2:])"
)


def _environment(threads: int) -> dict[str, str]:
    """Environment of the child: thread pools of one size, which do not spin while they wait; no tables kept on disk."""
    pools = ("OMP", "OPENBLAS", "MKL", "NUMBA")
    return {
        **os.environ,
        **{f"{pool}_NUM_THREADS": str(threads) for pool in pools},
        "OMP_WAIT_POLICY": "passive",
        "EIGENCONTACT_CACHE": "off",
    }


def run_fresh(task: Task, limit: float, interpreter: str | None = None) -> Sample:
    """Measure `task` in a process of its own.

    Parameters
    ----------
    task : Task
        What to measure.
    limit : float
        Wall time after which the process is ended [s].
    interpreter : str, optional
        Python that has the code installed; by default this one.

    Returns
    -------
    dict
        The sample; ``status`` is ``"slow"`` where the limit was passed.
    """
    root = str(Path(__file__).resolve().parents[2])
    with TemporaryDirectory() as folder:
        answer = Path(folder) / "sample.json"
        command = [interpreter or sys.executable, "-c", _START, root, task.to_json(), str(answer)]
        try:
            done = subprocess.run(
                command,
                env=_environment(task.threads),
                timeout=limit,
                capture_output=True,
                text=True,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return {"status": "slow", "reason": f"not done within {limit:.0f} s"}
        except OSError as error:
            return {"status": "absent", "reason": f"interpreter does not start: {error.strerror}"}
        if not answer.exists():
            last = (done.stderr.strip().splitlines() or ["no message"])[-1]
            return {"status": "failed", "reason": f"process ended with {done.returncode}: {last}"}
        found: Sample = json.loads(answer.read_text(encoding="utf-8"))
        return found
