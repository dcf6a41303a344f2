"""Boxes of cells that stand for regions without a closed form; regions near each other share a box."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from eigencontact.planning.sources import Lattice, Source

__all__ = ["CellGroup", "cell_groups"]

#: Regions share a box of cells as long as it has at most this many times their own cells.
_SPARSE = 3.0


@dataclass(frozen=True, slots=True)
class CellGroup:
    """Sources of one body that share a box of cells."""

    sources: tuple[Source, ...]
    lattice: Lattice

    @property
    def names(self) -> str:
        """Names of the sources, for people."""
        shown = [repr(source.name) for source in self.sources[:4]]
        return ", ".join(shown) + (f" and {len(self.sources) - 4} more" if len(self.sources) > 4 else "")

    @property
    def varies(self) -> bool:
        """Whether the eigenstrain in it changes with time."""
        return any(source.field.varies for source in self.sources)


def cell_groups(sources: Sequence[Source]) -> list[CellGroup]:
    """Group the sources of one body that have cells: equal cells, equally still or moving, and not far apart."""
    groups: list[CellGroup] = []
    for source in sources:
        if source.lattice is None:
            continue
        for number, group in enumerate(groups):
            joined = _join(group, source, source.lattice)
            if joined is not None:
                groups[number] = joined
                break
        else:
            groups.append(CellGroup((source,), source.lattice))
    return groups


def _join(group: CellGroup, source: Source, lattice: Lattice) -> CellGroup | None:
    alike = np.allclose(group.lattice.edges, lattice.edges, rtol=1e-12, atol=0.0)
    if not alike or group.varies != bool(source.field.varies):
        return None
    starts = np.minimum(group.lattice.first, lattice.first)
    stops = np.maximum(np.add(group.lattice.first, group.lattice.shape), np.add(lattice.first, lattice.shape))
    (k, j, i), (nz, ny, nx) = starts.tolist(), (stops - starts).tolist()
    union = Lattice((k, j, i), (nz, ny, nx), group.lattice.edges)
    own = sum(member.lattice.cells for member in group.sources if member.lattice is not None) + lattice.cells
    return CellGroup((*group.sources, source), union) if union.cells <= _SPARSE * own else None
