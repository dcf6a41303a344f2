"""Overlaps of regions of one body, and the rule for the overlap."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from eigencontact.model.sources import Source

__all__ = ["WHAT_COUNTS", "bounds_meet", "overlapping"]

#: What holds where regions overlap, for `explain`.
WHAT_COUNTS = (
    "prescribed eigenstrains add up; of materials the later one counts, with its prestrain; "
    "what is prescribed in a material is prestrain of it"
)
#: Points along an edge of the box that two bounds share; even, so that balls that touch in its middle share none.
_POINTS = 16


def bounds_meet(source: Source, neighbour: Source) -> bool:
    """Whether the bounds of two regions overlap."""
    pairs = zip(*source.shape.bounds, *neighbour.shape.bounds, strict=True)
    return all(low < stop and start < high for low, high, start, stop in pairs)


def overlapping(sources: Sequence[Source]) -> Iterator[tuple[Source, Source]]:
    """Pairs of one body, the earlier first, that share points of a lattice within their common bounds."""
    bounds = np.array([source.shape.bounds for source in sources], dtype=float).reshape(-1, 2, 3)
    bodies = np.array([source.body for source in sources])
    for number, source in enumerate(sources):
        low, high = bounds[number]
        meet = np.all((bounds[:number, 0] < high) & (low < bounds[:number, 1]), axis=1)
        for earlier in np.flatnonzero(meet & (bodies[:number] == source.body)).tolist():
            if _share_points(sources[earlier], source):
                yield sources[earlier], source


def _share_points(source: Source, neighbour: Source) -> bool:
    low = np.maximum(source.shape.bounds[0], neighbour.shape.bounds[0])
    high = np.minimum(source.shape.bounds[1], neighbour.shape.bounds[1])
    parts = (np.arange(_POINTS) + 0.5) / _POINTS
    x, y, z = (axis.ravel() for axis in np.meshgrid(*(a + parts * (b - a) for a, b in zip(low, high, strict=True))))
    return bool(np.any(source.shape.contains(x, y, z) & neighbour.shape.contains(x, y, z)))
