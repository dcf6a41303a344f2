"""Sides of interfaces and borders of inclusions on which the points of a line lie."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.sides import SAME, interface_depths

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results

    FloatArray = NDArray[np.float64]

__all__ = ["LineSides", "line_sides"]


@dataclass(frozen=True)
class LineSides:
    """Sides of the points of a line.

    Attributes
    ----------
    number : (n,) int
        Side of each point; neighbours of different numbers have a jump between them.
    shares : (m,)
        Where each jump lies, as a part of the way from one point to the next.
    whole : (n,) bool
        Points that lie on no border, and in no cell which a border cuts; stress in those is that of neither side.
    """

    number: NDArray[np.intp]
    shares: FloatArray
    whole: NDArray[np.bool_]


def line_sides(dataset: Results, region: str, body: int, z: FloatArray, step: int) -> LineSides:
    """Sides of the points of a line region in a body at depths z (n,) [m]."""
    depths = np.array(interface_depths(dataset, body, step))
    number = np.searchsorted(depths * (1.0 - SAME), z, side="right")
    border, whole = np.full(z.size, np.nan), np.ones(z.size, dtype=bool)
    if f"{region}_inclusion" in dataset:
        inclusion, border, uncut = (dataset[f"{region}_{name}"].values for name in ("inclusion", "border", "uncut"))
        number, whole = number + inclusion * (depths.size + 1), uncut != 0
    breaks = np.flatnonzero(number[1:] != number[:-1])
    shares = [border[breaks]]
    for depth in depths:
        with np.errstate(divide="ignore", invalid="ignore"):  # a line along an interface does not cross it
            share = (depth - z[breaks]) / (z[breaks + 1] - z[breaks])
        shares.append(np.where((share >= 0.0) & (share <= 1.0), share, np.nan))
    return LineSides(number, np.fmin.reduce(shares), whole)
