"""Initial state of a body from an earlier run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid

if TYPE_CHECKING:
    from eigencontact.results.records import HistoryRecord

__all__ = ["InitialState", "overlaps"]


#: Cells of other runs are the same where edges and places differ by less than this part of an edge.
_EDGE_TOLERANCE = 1e-6


@dataclass(frozen=True, kw_only=True, eq=False)
class InitialState:
    """State of a body after a step of an earlier run.

    Attributes
    ----------
    where : str
        The table of the scene, for messages.
    records : mapping of str to HistoryRecord
        By name, as they were stored; all in the same cells.
    """

    where: str
    records: Mapping[str, HistoryRecord]

    @property
    def coords(self) -> Mapping[str, FloatArray]:
        """Centres of the cells along z, y, x [m]."""
        return next(iter(self.records.values())).coords

    @property
    def height(self) -> float:
        """Height of the cells [m]; a single layer touches the surface."""
        return _edge(self.coords["z"], 2.0 * float(self.coords["z"][0]))

    def bounds(self, grid: Grid) -> tuple[FloatArray, FloatArray]:
        """Corners (x, y, z) of the cells [m]; one row or column is as wide as those of the grid."""
        axes, edges = [self.coords[axis] for axis in "xyz"], (grid.dx, grid.dy, self.height)
        half = 0.5 * np.array([_edge(axis, edge) for axis, edge in zip(axes, edges, strict=True)])
        low, high = (np.array([float(axis[end]) for axis in axes]) for end in (0, -1))
        return np.asarray(low - half), np.asarray(high + half)


def _edge(centres: FloatArray, single_edge: float) -> float:
    """Edge length of cells from their centres; `single_edge` if there is only one cell."""
    return float(centres[-1] - centres[0]) / (len(centres) - 1) if len(centres) > 1 else single_edge


def overlaps(stored: FloatArray, centres: FloatArray, edge: float) -> FloatArray:
    """Fractions ``(n, m)`` of cells ``(n,)`` of an axis that lie in stored cells ``(m,)``; 0 or 1 for equal cells.

    Parameters
    ----------
    stored, centres : (m,), (n,)
        Centres of both, ascending [m].
    edge : float
        Of the cells [m], and of a single stored one.

    Examples
    --------
    >>> overlaps(np.array([1.0, 3.0]), np.array([0.5, 1.5, 2.5]), 1.0).tolist()
    [[1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
    """
    wide = _edge(stored, edge)
    shift = (float(stored[0]) - float(centres[0])) / edge
    if abs(wide - edge) < _EDGE_TOLERANCE * edge / len(stored) and abs(shift - round(shift)) < _EDGE_TOLERANCE:
        places = np.arange(len(centres))[:, None] == round(shift) + np.arange(len(stored))
        return np.asarray(places, dtype=float)
    low = np.maximum(centres[:, None] - 0.5 * edge, stored - 0.5 * wide)
    high = np.minimum(centres[:, None] + 0.5 * edge, stored + 0.5 * wide)
    parts: FloatArray = np.clip((high - low) / edge, 0.0, 1.0)
    return parts
