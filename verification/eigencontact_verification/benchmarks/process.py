"""One task in a fresh process: the parent, which limits its time, and the child, which leaves a sample in a file.

A process of its own makes the first call a first call, and the peak of memory that of one code alone.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from eigencontact_verification.benchmarks.benchmark import Sample, Task
from eigencontact_verification.benchmarks.catalogue import BENCHMARKS
from eigencontact_verification.benchmarks.codes import find_code
from eigencontact_verification.reporting.machine import installed
from eigencontact_verification.reporting.process import answer_of

__all__ = ["main", "perform", "run_fresh"]

#: Path of our package comes last, so that another interpreter finds its own packages first.
_START = (
    "import sys; sys.path.append(sys.argv[1]); "
    "from eigencontact_verification.benchmarks.process import main; main(*sys.argv[2:])"
)


def run_fresh(task: Task, limit: float, interpreter: str | None = None) -> Sample:
    """Measure `task` in a process of its own.

    Its thread pools have one size and do not spin while they wait; it keeps no tables on disk.

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
    pools = {f"{pool}_NUM_THREADS": str(task.threads) for pool in ("OMP", "OPENBLAS", "MKL", "NUMBA")}
    environment = {**os.environ, **pools, "OMP_WAIT_POLICY": "passive", "EIGENCONTACT_CACHE": "off"}
    root = str(Path(__file__).resolve().parents[2])
    with TemporaryDirectory() as folder:
        answer = Path(folder) / "sample.json"
        command = [interpreter or sys.executable, "-c", _START, root, task.to_json(), str(answer)]
        return answer_of(command, answer, limit, environment)


def perform(task: Task) -> Sample:
    """Measure, and turn every failure into words: one code's fault must not end the run of the others."""
    try:
        benchmark = BENCHMARKS[task.benchmark]
        code = benchmark.methods[task.code] if benchmark.methods else find_code(task.code)
        code.load(benchmark.function)
        sample = benchmark.measure(code, task)
    except ImportError as error:
        return {"status": "absent", "reason": str(error)}
    except Exception as error:  # noqa: BLE001 - a peer may raise anything
        return {"status": "failed", "reason": f"{type(error).__name__}: {error}"}
    return {**sample, "version": installed(code.distribution), "settings": code.settings}


def main(task: str, answer: str) -> None:
    """Read a task (JSON), write its sample to the file `answer`."""
    Path(answer).write_text(json.dumps(perform(Task.from_json(task))), encoding="utf-8")
