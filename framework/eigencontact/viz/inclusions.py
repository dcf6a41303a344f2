"""Borders of inclusions on planes, as results store them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.results.stored import Results

    FloatArray = NDArray[np.float64]

__all__ = ["Coating", "coatings", "inclusion_segments"]

#: A plane is drawn with the borders of the nearest stored one, no farther away than this part of a cell.
NEAR = 0.5001


@dataclass(frozen=True)
class Coating:
    """Inclusion at the surface of a body.

    Attributes
    ----------
    number : int
        Position among the inclusions of the results.
    body : int
        1 or 2.
    bottom : float
        Its largest depth [m].
    """

    number: int
    body: int
    bottom: float


def inclusion_segments(dataset: Results, body: int, normal: str, at: float, number: int | None = None) -> FloatArray:
    """Borders (n, 2, 2) [m] on a plane, of all inclusions of a body or of one of them.

    Parameters
    ----------
    body : int
        1 or 2.
    normal, at : str, float
        Axis normal to the plane, and where it cuts it [m].
    number : int, optional
        Position among the inclusions of the results.
    """
    nothing = np.empty((0, 2, 2))
    if "section_segments" not in dataset:
        return nothing
    table = np.asarray(dataset["section_table"].values, dtype=float)
    numbers = [n for n, item in enumerate(_inclusions(dataset)) if item["body"] == body and number in (None, n)]
    table = table[np.isin(table[:, 0], numbers) & (table[:, 1] == "xyz".index(normal))]
    away = np.abs(table[:, 2] - at)
    if not away.size or away.min() > NEAR * float(np.max(dataset.attrs["cell_size"])):
        return nothing
    segments = np.asarray(dataset["section_segments"].values, dtype=float)
    sections = table[table[:, 2] == table[away.argmin(), 2]]
    return np.concatenate([segments[int(row[5]) : int(row[5] + row[6])] + row[3:5] for row in sections])


def coatings(dataset: Results) -> tuple[Coating, ...]:
    """Inclusions with stored borders that reach the surface of their body."""
    if "section_segments" not in dataset:
        return ()
    described = _inclusions(dataset)
    stored = [(int(n), described[int(n)]) for n in np.unique(dataset["section_table"].values[:, 0])]
    return tuple(Coating(n, item["body"], item["bounds"][1][2]) for n, item in stored if item["bounds"][0][2] <= 0.0)


def _inclusions(dataset: Results) -> list[dict[str, Any]]:
    return list(json.loads(dataset.attrs.get("inclusions", "[]")))
