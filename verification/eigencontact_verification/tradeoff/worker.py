"""The child process: plan and solve one variant, leave its numbers and fields in two files."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from time import perf_counter
from typing import Any

from eigencontact_verification.reporting.memory import PeakMemory

__all__ = ["FIELDS", "main", "solve"]

#: Fields of the surface that are compared, and the axes.
FIELDS = (
    "pressure",
    "shear_x",
    "shear_y",
    "residual_displacement_x",
    "residual_displacement_y",
    "residual_displacement_z",
    "worn_depth",
)


def solve(tables: dict[str, Any], fields: Path) -> dict[str, Any]:
    """Solve a scene; its fields go to an ``.npz`` file, everything else is returned as plain data."""
    import numpy as np

    from eigencontact import app

    memory = PeakMemory()
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
        "predicted_seconds": summary["predicted_seconds"],
        "peak_bytes": summary["peak_memory_bytes"],
        "array_bytes": memory.peak(),
        "predicted_bytes": summary["predicted_memory_bytes"],
        "iterations": summary["iterations"],
        "history": summary["history"],
    }


def main(task: str, answer: str, fields: str) -> None:
    """Read the tables of a scene from the file `task` (JSON), write what was found to `answer` and `fields`."""
    tables = json.loads(Path(task).read_text(encoding="utf-8"))
    Path(answer).write_text(json.dumps(solve(tables, Path(fields))), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
