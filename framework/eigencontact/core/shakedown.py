"""Shakedown and ratchetting from the plastic strain at both ends of a cycle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray

__all__ = ["STATES", "CycleResponse", "cycle_response"]

#: States by number.
STATES = ("elastic", "elastic shakedown", "plastic shakedown", "ratchetting")


@dataclass(frozen=True, eq=False, slots=True)
class CycleResponse:
    """Plastic response of cells to one cycle.

    Attributes
    ----------
    state : (...) int8
        Position in `STATES`.
    growth : (...) float64
        Growth of the equivalent plastic strain in the cycle [-]: the length of the path of the plastic strain.
    net_increment : (...) float64
        Equivalent strain of the plastic strain at the end less that at the start [-], ``sqrt(2/3)`` of its norm.
    """

    state: NDArray[np.int8]
    growth: FloatArray
    net_increment: FloatArray


def cycle_response(equivalent: FloatArray, strain: FloatArray, tolerance: float) -> CycleResponse:
    """Classify each cell.

    Parameters
    ----------
    equivalent : (2, ...)
        Equivalent plastic strain at the start and at the end of a cycle [-].
    strain : (2, 6, ...)
        Plastic strain there, Mandel vectors [-].
    tolerance : float
        Part of the largest equivalent plastic strain at the end, below which an increment counts as none.

    Returns
    -------
    CycleResponse
        Elastic: never a plastic strain. Elastic shakedown: an earlier one, but no growth in this cycle. Plastic
        shakedown: growth, but no net increment, so the path of the plastic strain is closed. Ratchetting: a net
        increment.

    References
    ----------
    K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985, section 9.2.

    Examples
    --------
    >>> ends = np.zeros((2, 6, 4))
    >>> ends[1, 0, 3] = 1e-3
    >>> response = cycle_response(np.array([[0, 1, 1, 1], [0, 1, 1.01, 1.01]]), ends, 1e-4)
    >>> [STATES[number] for number in response.state]
    ['elastic', 'elastic shakedown', 'plastic shakedown', 'ratchetting']
    """
    growth = np.asarray(equivalent[1] - equivalent[0], dtype=float)
    net = np.sqrt(2.0 / 3.0) * np.linalg.norm(strain[1] - strain[0], axis=0)
    least = tolerance * float(np.max(equivalent[1], initial=0.0))
    state = np.where(equivalent[1] > least, 1, 0)
    state = np.where(growth > least, 2, state)
    return CycleResponse(np.where(net > least, 3, state).astype(np.int8), growth, np.asarray(net))
