"""Solve one variant in a fresh process: a first call, and a peak of memory of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Solved", "solve_fresh"]


@dataclass(frozen=True, kw_only=True)
class Solved:
    """What came back.

    Attributes
    ----------
    status : str
        ``"ok"``, ``"failed"``, ``"slow"`` or ``"refused"`` (not started).
    reason : str
        Why not ok, in words.
    numbers : dict
        See `eigencontact_verification.tradeoff.worker.solve`.
    fields : dict of arrays
        ``x``, ``y`` and surface fields ``(step, y, x)``, SI units.
    """

    status: str
    reason: str = ""
    numbers: dict[str, Any] = field(default_factory=dict)
    fields: dict[str, NDArray[np.float64]] = field(default_factory=dict)


def solve_fresh(tables: Mapping[str, Any], limit: float) -> Solved:
    """Solve the tables of a scene; never raises for what the child does.

    Parameters
    ----------
    tables : mapping
        Scene, plain data.
    limit : float
        Wall time after which the process is ended [s].
    """
    with TemporaryDirectory() as folder:
        task, answer, fields = (Path(folder) / name for name in ("scene.json", "answer.json", "fields.npz"))
        task.write_text(json.dumps(tables), encoding="utf-8")
        module = "eigencontact_verification.tradeoff.worker"
        command = [sys.executable, "-m", module, str(task), str(answer), str(fields)]
        environment = {**os.environ, "EIGENCONTACT_CACHE": "off"}  # or what was solved before would look quicker
        try:
            done = subprocess.run(command, timeout=limit, capture_output=True, text=True, check=False, env=environment)
        except subprocess.TimeoutExpired:
            return Solved(status="slow", reason=f"not done within {limit:.0f} s")
        if not answer.exists():
            last = (done.stderr.strip().splitlines() or ["no message"])[-1]
            return Solved(status="failed", reason=f"process ended with {done.returncode}: {last}")
        found = json.loads(answer.read_text(encoding="utf-8"))
        if found["status"] != "ok":
            return Solved(status=found["status"], reason=found["reason"])
        with np.load(fields) as stored:
            arrays = {name: stored[name] for name in stored.files}
        return Solved(status="ok", numbers=found, fields=arrays)
