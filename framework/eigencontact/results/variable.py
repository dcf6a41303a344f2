"""One variable of a results file."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray

__all__ = ["Variable"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Variable:
    """One array of a results file: its dimensions (``step`` first where it changes), values and attributes."""

    name: str
    dims: tuple[str, ...]
    values: NDArray[Any]
    attrs: dict[str, str | int] = field(default_factory=dict)
