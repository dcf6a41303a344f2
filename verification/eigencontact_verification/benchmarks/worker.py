"""The child process: one code, one size, one sample as JSON in a file.

It runs in a process of its own so that the first call is a first call, and the peak of memory that of this code alone.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact_verification.benchmarks import (
    cloud,
    eigenstrain,
    fidelity,
    hertz,
    inhomogeneity,
    layers,
    stress,
    tangential,
    trade,
)
from eigencontact_verification.benchmarks.codes import find_code
from eigencontact_verification.benchmarks.machine import installed
from eigencontact_verification.benchmarks.task import Sample, Task

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

__all__ = ["MEASURES", "METHODS", "main", "perform"]

MEASURES: dict[str, Callable[[Any, Task], Sample]] = {
    "hertz": hertz.measure,
    "stress": stress.measure,
    "fidelity": fidelity.measure,
    "eigenstrain": eigenstrain.measure,
    "cloud": cloud.measure,
    "trade": trade.measure,
    "tangential": tangential.measure,
    "inhomogeneity": inhomogeneity.measure,
    "layers": layers.measure,
}

#: Ways of computing of benchmarks that do not compare codes, or compare what few of them do.
METHODS: dict[str, Mapping[str, Any]] = {
    "fidelity": fidelity.METHODS,
    "eigenstrain": eigenstrain.METHODS,
    "cloud": cloud.METHODS,
    "trade": trade.METHODS,
    "tangential": tangential.METHODS,
    "inhomogeneity": inhomogeneity.METHODS,
    "layers": layers.METHODS,
}


def perform(task: Task) -> Sample:
    """Measure, and turn every failure into words: one code's fault must not end the run of the others."""
    try:
        methods = METHODS.get(task.benchmark)
        code = methods[task.code] if methods else find_code(task.code)
        found = MEASURES[task.benchmark](code, task)
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
