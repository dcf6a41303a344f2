"""Closed load cycles of a stored history: area of the loop, work of friction, amplitudes, energy ratio."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from eigencontact.core.rigid_modes import NORMAL_MODES, TANGENTIAL_MODES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

__all__ = ["OF_CYCLES", "Cycle", "friction_work", "last_cycle", "skips_cycles"]

#: Loads and what they work on: normal, tangential, torsional.
_PAIRS = tuple((mode.force, mode.displacement) for mode in (NORMAL_MODES[0], *TANGENTIAL_MODES))
_MOTIONS = {"shift": _PAIRS[1:3], "twist": _PAIRS[3:]}
#: Names of the scalars that `last_cycle` reads.
OF_CYCLES = frozenset({name for pair in _PAIRS for name in pair} | {"dissipated_energy"})
#: Two states are one if all loads and displacements agree to this part of their ranges.
_CLOSED = 0.01
#: Pairs whose ranges of load and displacement have a product below this part of the largest are by-products.
_BY_PRODUCT = 1e-6
#: A cycle leaves its end by at least this part of the range of something.
_EXCURSION = 0.5


@dataclass(frozen=True, kw_only=True, slots=True)
class Cycle:
    """A closed cycle of load steps.

    Attributes
    ----------
    first, last : int
        Positions along ``step`` of its two ends, which are the same state.
    area : float
        Area of the polygon through the steps, the closed integral of load over displacement of the motion [J],
        positive where the loop takes up work. Coarse increments cut the corners of a loop: its work is `dissipated`.
    work : float
        The same over all loads together, the normal one too [J].
    dissipated : float
        Growth of the local work of friction between the two ends [J]; NaN where it is not stored.
    load_amplitude : float
        Half of the largest difference of two loads [N], of moments [N m].
    displacement_amplitude : float
        Half of the largest difference of two shifts [m], of twists [rad].
    """

    first: int
    last: int
    area: float
    work: float
    dissipated: float
    load_amplitude: float
    displacement_amplitude: float

    @property
    def energy_ratio(self) -> float:
        """Work over the area of the rectangle around the loop, ``A = E / (4 Q* δ*)`` [-]: 0 elastic, 1 gross slip.

        The work is that of friction, and the area of the polygon where that is not stored.
        """
        around = 4.0 * self.load_amplitude * self.displacement_amplitude
        energy = self.dissipated if np.isfinite(self.dissipated) else self.area
        return energy / around if around > 0 else float("nan")


def last_cycle(history: Mapping[str, ArrayLike], motion: Literal["shift", "twist"] = "shift") -> Cycle | None:
    """Last closed cycle of a history of loads and displacements.

    Parameters
    ----------
    history : mapping of str to (steps,) array
        Scalars of all steps in order, by the names of results: ``tangential_load_x`` [N], ``shift_x`` [m] and so on,
        ``dissipated_energy`` [J]. Names that are missing are taken as zero.
    motion : {"shift", "twist"}
        Whose loop.

    Returns
    -------
    Cycle or None
        None where the history returns to no earlier state on the side that it came from.

    Notes
    -----
    Integrals are by the trapezoidal rule over the closed polygon (the area of the polygon). Where the tractions change
    linearly through each step that is the work exactly, so that in a cycle that closes on itself under a constant
    contact `work` and `dissipated` agree to the tolerance of the solver: one comes from loads and rigid displacements,
    the other from shear and slip of each cell. Where the state still drifts from cycle to cycle, as under coupling of
    normal and tangential contact, they differ by about the load times the displacement that is missing to closure.

    References
    ----------
    S. Fouvry, P. Kapsa, L. Vincent, Analysis of sliding behaviour for fretting loadings: determination of transition
    criteria, Wear 185 (1995) 35-46 (energy ratio).

    Examples
    --------
    >>> square = {"tangential_load_x": [1.0, 1, -1, -1, 1, 1], "shift_x": [0.0, 2, 2, -2, -2, 2]}
    >>> cycle = last_cycle(square)
    >>> cycle.first, cycle.last, cycle.area, cycle.energy_ratio
    (1, 5, 8.0, 1.0)
    """
    columns = {name: np.asarray(history[name], dtype=float) for pair in _PAIRS for name in pair if name in history}
    if not columns:
        return None
    steps = len(next(iter(columns.values())))
    zero = np.zeros(steps)
    ends = _ends(_states(columns))
    if ends is None:
        return None
    first, last = ends
    cycle_steps = slice(first, last + 1)

    def area(pairs: tuple[tuple[str, str], ...]) -> float:
        return sum(
            _polygon(columns.get(displacement, zero)[cycle_steps], columns.get(load, zero)[cycle_steps])
            for load, displacement in pairs
        )

    def amplitude(side: int) -> float:
        points = np.stack([columns.get(pair[side], zero)[cycle_steps] for pair in _MOTIONS[motion]], axis=-1)
        return 0.5 * float(np.max(np.linalg.norm(points[:, None] - points[None], axis=-1)))

    dissipated = float("nan")
    if "dissipated_energy" in history:
        energy = np.asarray(history["dissipated_energy"], dtype=float)
        dissipated = float(energy[last] - energy[first])
    return Cycle(
        first=first,
        last=last,
        area=area(_MOTIONS[motion]),
        work=area(_PAIRS),
        dissipated=dissipated,
        load_amplitude=amplitude(0),
        displacement_amplitude=amplitude(1),
    )


def skips_cycles(history: Mapping[str, ArrayLike]) -> bool:
    """Whether a history skips cycles between the solved ones."""
    return "cycles" in history and bool(np.any(np.diff(np.asarray(history["cycles"], dtype=float)) > 1.0))


def friction_work(history: Mapping[str, ArrayLike]) -> NDArray[np.float64] | None:
    """Work of friction at each step [J], including skipped cycles; None if it is not stored.

    Where cycles are skipped it is the work up to the last cycle that ended.

    Examples
    --------
    >>> friction_work({"cycles": [0, 1, 100], "dissipated_energy": [0.0, 1.0, 2.0], "wear_energy": [0.0, 1.0, 100.0]})
    array([  0.,   1., 100.])
    """
    name = "wear_energy" if skips_cycles(history) and "wear_energy" in history else "dissipated_energy"
    return np.asarray(history[name], dtype=float) if name in history else None


def _states(columns: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Loads and displacements relative to their ranges, ``(steps, k)``, of the pairs with significant work."""
    pairs = [
        (columns[load], columns[displacement])
        for load, displacement in _PAIRS
        if load in columns and displacement in columns
    ]
    works = [float(np.ptp(load) * np.ptp(displacement)) for load, displacement in pairs]
    driven = [pair for pair, work in zip(pairs, works, strict=True) if work > _BY_PRODUCT * max(works) > 0]
    scaled = [values / np.ptp(values) for pair in driven for values in pair]
    return np.stack(scaled, axis=-1) if scaled else np.zeros((0, 0))


def _ends(states: NDArray[np.float64]) -> tuple[int, int] | None:
    """Positions of the two ends of the last closed cycle."""
    came = np.diff(states, axis=0, prepend=states[:1])  # direction of arrival tells the two sides of a loop apart
    for last in range(len(states) - 1, 2, -1):
        distance = np.abs(states - states[last]).max(axis=1)
        away = np.flatnonzero(distance[:last] > _EXCURSION)
        if away.size == 0:
            continue
        close = (distance <= _CLOSED) & (came @ came[last] > 0)
        before = np.flatnonzero(close[: away[-1]])
        if before.size == 0:
            continue
        # Of several neighbours that are close, as with very small steps, the closest.
        run = before[before > away[away < before[-1]].max(initial=-1)]
        first = int(run[np.argmin(distance[run])])
        if last - first > 2:
            return first, last
    return None


def _polygon(x: NDArray[np.float64], y: NDArray[np.float64]) -> float:
    """Closed integral of y dx around a polygon, positive for clockwise order.

    That is the sign of a load y that takes up work: it is higher on the way out than on the way back.
    """
    x, y = x - x[0], y - y[0]  # small loops far from the origin
    return float(np.sum(0.5 * (np.roll(y, -1) + y) * (np.roll(x, -1) - x)))
