"""A command in a process of its own, which leaves its answer in a JSON file, with a limit on its time."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

__all__ = ["answer_of"]


def answer_of(command: Sequence[str], answer: Path, limit: float, environment: Mapping[str, str]) -> dict[str, Any]:
    """Content of the answer; where there is none, a ``status`` ("slow", "absent" or "failed") and its ``reason``.

    Parameters
    ----------
    command : sequence of str
        Program and arguments.
    answer : Path
        JSON file that the command writes.
    limit : float
        Wall time after which the process is ended [s].
    environment : mapping
        Its environment variables.
    """
    try:
        process = subprocess.run(command, env=environment, timeout=limit, capture_output=True, text=True, check=False)
    except subprocess.TimeoutExpired:
        return {"status": "slow", "reason": f"not done within {limit:.0f} s"}
    except OSError as error:
        return {"status": "absent", "reason": f"interpreter does not start: {error.strerror}"}
    if not answer.exists():
        last = (process.stderr.strip().splitlines() or ["no message"])[-1]
        return {"status": "failed", "reason": f"process ended with {process.returncode}: {last}"}
    content: dict[str, Any] = json.loads(answer.read_text(encoding="utf-8"))
    return content
