"""One variant in a fresh process: the parent limits its time, the child solves and leaves two files."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.reporting.process import answer_of
from eigencontact_verification.tradeoff.errors import FIELDS, bars

__all__ = ["Solved", "main", "solve", "solve_fresh"]


@dataclass(frozen=True, kw_only=True)
class Solved:
    """Answer of the child."""

    status: str  #: ``"ok"``, ``"failed"``, ``"slow"`` or ``"refused"`` (not started)
    reason: str = ""  #: why not ok, in words
    numbers: dict[str, Any] = field(default_factory=dict)  #: see `solve`
    #: ``x``, ``y`` and surface fields ``(step, y, x)``, SI units.
    fields: dict[str, NDArray[np.float64]] = field(default_factory=dict)


def solve_fresh(tables: Mapping[str, Any], limit: float) -> Solved:
    """Solve the tables of a scene within a wall time [s]; never raises for a failure of the child."""
    with TemporaryDirectory() as folder:
        task, answer, fields = (Path(folder) / name for name in ("scene.json", "answer.json", "fields.npz"))
        task.write_text(json.dumps(tables), encoding="utf-8")
        command = [sys.executable, "-m", __name__, str(task), str(answer), str(fields)]
        environment = {**os.environ, "EIGENCONTACT_CACHE": "off"}  # a variant must not be quicker by tables of another
        numbers = answer_of(command, answer, limit, environment)
        if numbers["status"] != "ok":
            return Solved(status=numbers["status"], reason=numbers["reason"])
        with np.load(fields) as stored:
            arrays = {name: stored[name] for name in stored.files}
        return Solved(status="ok", numbers=numbers, fields=arrays)


def solve(tables: dict[str, Any], fields: Path) -> dict[str, Any]:
    """Solve a scene; its fields go to an ``.npz`` file, everything else is returned as plain data."""
    from eigencontact import app

    began = perf_counter()
    try:
        planned = app.plan(tables)
        result = app.run(planned)
    except Exception as problem:  # noqa: BLE001 - any fault of one variant is a line of the table
        return {"status": "failed", "reason": f"{type(problem).__name__}: {' '.join(str(problem).split())}"}
    whole, dataset = perf_counter() - began, result.dataset
    arrays: dict[str, Any] = {name: dataset[name].to_numpy() for name in ("time", "x", "y", *FIELDS) if name in dataset}
    np.savez(fields, **arrays)
    summary = result.summary
    return {
        "status": "ok",
        "cells": [planned.grid.nx, planned.grid.ny],
        "seconds": summary["compute_seconds"],
        "whole_seconds": whole,
        "peak_bytes": summary["peak_memory_bytes"],
        "history": summary["history"],
        "bars": bars(summary, dataset),
    }


def main(task: str, answer: str, fields: str) -> None:
    """Read the tables of a scene from the file `task` (JSON), write the solution to `answer` and `fields`."""
    tables = json.loads(Path(task).read_text(encoding="utf-8"))
    Path(answer).write_text(json.dumps(solve(tables, Path(fields))), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
