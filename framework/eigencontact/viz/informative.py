"""Rules that omit standard pictures without information: constant values, or changes within the resolution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray

    from eigencontact.results.stored import Results

__all__ = ["NOISE", "area_varies", "axis_from_zero", "vanishes", "varies", "zones_change"]

#: Values that differ by no more than this part of the largest are constant.
CONSTANT = 1e-6
#: Values that fall to this part of the largest have an axis from zero.
LOW = 0.5
#: Largest pressures and areas that differ by no more than this part of the largest are noise of the cells.
NOISE = 0.03


def varies(values: ArrayLike, share: float = CONSTANT) -> bool:
    """Whether values differ by more than a part of the largest magnitude; those that are not finite do not count.

    Examples
    --------
    >>> varies([2.0, 2.0 + 1e-9]), varies([2.0, 2.1])
    (False, True)
    """
    numbers = np.asarray(values, dtype=float)
    numbers = numbers[np.isfinite(numbers)]
    return bool(numbers.size) and float(np.ptp(numbers)) > share * float(np.abs(numbers).max())


def vanishes(dataset: Results, names: Iterable[str], step: int) -> bool:
    """Whether all of some fields are zero, or missing, at a position along ``step``."""
    return not any(np.any(np.nan_to_num(dataset[name][step].values)) for name in names if name in dataset)


def area_varies(dataset: Results) -> bool:
    """Whether the contact area changes by more than a rim of half a cell all round the largest contact.

    The area is that of whole cells: a smaller change may be the steps of a few cells.
    """
    area = np.asarray(dataset["contact_area"].values, dtype=float)
    cell = float(np.prod(np.atleast_1d(dataset.attrs["cell_size"])))
    count = float(area.max(initial=0.0)) / cell
    return float(np.ptp(area)) > float(np.sqrt(np.pi * count)) * cell


def axis_from_zero(values: ArrayLike) -> bool:
    """Whether the axis of values of one sign begins at zero: for values that fall far or change by noise only.

    Examples
    --------
    >>> axis_from_zero([0.4, 1.0]), axis_from_zero([0.9, 1.0]), axis_from_zero([0.99, 1.0])
    (True, False, True)
    """
    numbers = np.asarray(values, dtype=float)
    low, high = float(np.nanmin(numbers)), float(np.nanmax(numbers))
    return low >= 0.0 and (low <= LOW * high or high - low <= NOISE * high)


def zones_change(dataset: Results, zones: NDArray[np.intp]) -> bool:
    """Whether both stick and slip occur in steps that move the surfaces.

    Parameters
    ----------
    zones : (steps, ...) int
        2 where the surfaces stick, 1 where they slip; in a step without motion all sticks, which tells nothing.
    """
    loads = ("normal_load", "tangential_load_x", "tangential_load_y", "torsion_moment")
    histories = [np.asarray(dataset[name].values, dtype=float) for name in loads if name in dataset]
    moved = np.zeros(len(zones), dtype=bool)
    for values in histories:
        change = np.abs(np.diff(values, prepend=values[:1]))
        moved |= change > CONSTANT * np.abs(values).max(initial=0.0)
    zones_in_motion = zones[moved]
    return bool((zones_in_motion == 2).any() and (zones_in_motion == 1).any())
