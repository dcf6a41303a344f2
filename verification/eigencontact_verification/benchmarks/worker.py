"""The child process: one code, one size, one sample as JSON in a file.

It runs in a process of its own so that the first call is a first call, and the peak of memory that of this code alone.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from eigencontact_verification.benchmarks.catalogue import BENCHMARKS
from eigencontact_verification.benchmarks.codes import find_code
from eigencontact_verification.benchmarks.task import Sample, Task
from eigencontact_verification.reporting.machine import installed

__all__ = ["main", "perform"]


def perform(task: Task) -> Sample:
    """Measure, and turn every failure into words: one code's fault must not end the run of the others."""
    try:
        benchmark = BENCHMARKS[task.benchmark]
        code = benchmark.methods[task.code] if benchmark.methods else find_code(task.code)
        found = benchmark.measure(code, task)
    except ImportError as error:
        return {"status": "absent", "reason": str(error)}
    except Exception as error:  # noqa: BLE001 - a peer may raise anything
        return {"status": "failed", "reason": f"{type(error).__name__}: {error}"}
    return {**found, "version": installed(code.distribution), "settings": code.settings}


def main(task: str, answer: str) -> None:
    """Read a task (JSON), write its sample to the file `answer`."""
    Path(answer).write_text(json.dumps(perform(Task.from_json(task))), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
