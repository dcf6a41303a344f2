"""Decision for compiled loops, by counts of operations: a resumed run decides as before."""

from __future__ import annotations

from importlib.util import find_spec

__all__ = ["can_compile", "planes_repay", "volumes_repay"]

#: Seconds until numba and a loop are there from the disk: 0.23 to 0.28 on two cores.
_LOADING = 0.25
#: Gain of a compiled sum over a volume [s] without its points. Measured with `_POINT`: 1.5 ms at 2 000 points, 2.1 at
#: 5 000, 4.5 at 16 000, 7.7 at 33 000, and more beyond.
_VOLUME = 1.2e-3
#: Gain of a compiled sum over a volume per padded point [s].
_POINT = 2.0e-7
#: Gain of a compiled sum of many planes per pair of a source and a target [s].
_PAIR = 2.4e-6
#: Gain of a compiled sum of many planes per product of a pair [s].
_PRODUCT = 1.2e-9


def can_compile() -> bool:
    """Whether numba is installed."""
    return find_spec("numba") is not None


def volumes_repay(points: int, applications: float) -> bool:
    """Whether to load the loops for a box of so many padded points, applied so many times."""
    return applications * (_VOLUME + _POINT * points) >= _LOADING and can_compile()


def planes_repay(pairs: int, products: int, applications: float) -> bool:
    """Whether to load the loop for so many pairs of a source and a target, with so many products, applied so often."""
    return applications * (_PAIR * pairs + _PRODUCT * products) >= _LOADING and can_compile()
