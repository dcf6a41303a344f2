"""What one fresh process has to measure, and what it sends back."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import Any

__all__ = ["Sample", "Task"]

#: What one process measured: JSON, with ``status`` "ok", "absent" or "failed" and a ``reason`` for the latter two.
Sample = dict[str, Any]


@dataclass(frozen=True, kw_only=True, slots=True)
class Task:
    """One code at one size in one process.

    Parameters
    ----------
    benchmark : str
        Name of one of those in `eigencontact_verification.benchmarks.catalogue`.
    code : str
        A name for `eigencontact_verification.benchmarks.codes.find_code`.
    n : int
        Cells along each side; inclusions of a cloud; cells per contact radius (plasticity).
    threads : int
        Threads that the code may use.
    precision : str
        ``"double"`` or ``"single"``; for codes that have the choice.
    warm : int
        Calls after the first one in the same process.
    budget : float
        Wall time after which no further repeat is begun [s].
    depths : int
        Number of depths (stress and layers).
    case : str
        Where the eigenstrain is (fidelity); what is computed of it (eigenstrain); shapes (cloud); Poisson's
        ratio (tangential); boundary and share of the area in contact (rough).
    """

    benchmark: str
    code: str
    n: int
    threads: int = 1
    precision: str = "double"
    warm: int = 2
    budget: float = 120.0
    depths: int = 32
    case: str = ""

    def to_json(self) -> str:
        """Text for the command line of the process."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> Task:
        """Read it back."""
        return cls(**json.loads(text))
