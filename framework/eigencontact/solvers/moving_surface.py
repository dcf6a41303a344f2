"""Surfaces that lose depth in proportion to the pressure on them: one implicit step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Moved", "moved"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Moved:
    """What the surfaces lost: `depth` added [m], the final `pressure` [Pa], its estimated `error`, contact `solves`."""

    depth: FloatArray
    pressure: FloatArray
    error: float
    solves: int


def moved(
    pressed: Callable[[FloatArray, FloatArray, FloatArray], FloatArray],
    depth: FloatArray,
    pressure: FloatArray,
    rate: FloatArray,
    cycles: float,
    *,
    steady: FloatArray | None = None,
    tolerance: float,  # noqa: ARG001
) -> Moved:
    """Integrate ``d(depth)/dN = rate p + steady`` over some cycles by one implicit step."""
    fixed = cycles * (np.zeros_like(depth) if steady is None else steady)
    after = pressed(depth + fixed, cycles * rate, pressure)
    return Moved(depth=cycles * rate * after + fixed, pressure=after, error=0.0, solves=1)
