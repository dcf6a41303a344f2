"""Exposed material: topmost material of each column of a worn body."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.errors import SceneError, nearest
from eigencontact.model.kernels import Solids
from eigencontact.model.sources import Inhomogeneity
from eigencontact.plugin import InclusionShape, LayeredMedium, NamesMaterials
from eigencontact.plugin.materials import SUBSTRATE

__all__ = ["Exposed", "exposed_of"]


#: Halvings of a depth in search of an interface.
_BISECTIONS = 10
#: Part of a cell's width below the surface, by which what ends there does not count.
_BELOW = 1e-9


@dataclass(frozen=True, kw_only=True)
class Exposed:
    """Materials of one body, by number.

    Attributes
    ----------
    body : int
        1 or 2.
    names : tuple of str
        By number; 0 is the substrate.
    interfaces : tuple of float
        Depths of the undersides of layers 1, 2 ... [m].
    shapes : tuple of (int, InclusionShape)
        Inclusions and their numbers; where they overlap the later one counts.
    grid : Grid
    """

    body: int
    names: tuple[str, ...]
    interfaces: tuple[float, ...]
    shapes: tuple[tuple[int, InclusionShape], ...]
    grid: Grid

    def at(self, worn_depth: FloatArray | None = None) -> NDArray[np.intp]:
        """Numbers ``(ny, nx)`` under a worn depth ``(ny, nx)`` [m], by default zero."""
        depth = np.zeros(self.grid.shape) if worn_depth is None else worn_depth
        depth = depth + _BELOW * min(self.grid.edges)
        layer = np.searchsorted(np.asarray(self.interfaces), depth) + 1
        out = np.where(layer > len(self.interfaces), 0, layer)
        y, x = self.grid.axes()
        for number, shape in self.shapes:
            out[np.asarray(shape.contains(x, y, depth))] = number
        return out

    def share_below(self, worn_depth: FloatArray, added: FloatArray) -> float:
        """Volume fraction of additional wear ``(ny, nx)`` [m] below the exposed material."""
        numbers = self.at(worn_depth)
        crossed = self.at(worn_depth + added) != numbers
        if not crossed.any():
            return 0.0
        low, step = np.zeros(numbers.shape), 0.5
        for _ in range(_BISECTIONS):
            low = np.where(self.at(worn_depth + (low + step) * added) == numbers, low + step, low)
            step *= 0.5
        return float((added * (1.0 - low))[crossed].sum() / added.sum())

    @property
    def uniform(self) -> bool:
        """Whether the body consists of one material."""
        return len(self.names) == 1


def exposed_of(
    solids: Solids,
    inhomogeneities: Sequence[Inhomogeneity],
    grid: Grid,
    laws: Mapping[str, Any],
    losses: Collection[int],
) -> Exposed | None:
    """Materials at the surface; None if no law distinguishes materials and no surface wears.

    Parameters
    ----------
    inhomogeneities : sequence of Inhomogeneity
        Inclusions; the name of their table is that of the material.
    laws : mapping of str to object
        Laws of the surface by their table in the scene; those with `NamesMaterials` distinguish materials.
    losses : collection of int
        Bodies whose surface loses depth.

    Raises
    ------
    SceneError
        A law names an unknown material, or both bodies have several materials.
    """
    material_laws = [(table, law) for table, law in laws.items() if isinstance(law, NamesMaterials)]
    if not material_laws and not losses:
        return None
    candidates = {body: _materials(solids, body, inhomogeneities, grid) for body in (1, 2)}
    several = [body for body, exposed in candidates.items() if not exposed.uniform]
    if len(several) > 1 and material_laws:
        table, law = material_laws[0]
        raise SceneError(
            f"{table}.type must be a law without names of materials if both bodies have several materials (got "
            f"{law.key!r}, and {', '.join(candidates[1].names)} in body 1, {', '.join(candidates[2].names)} in body "  # type: ignore[attr-defined]
            "2); make one body of one material"
        )
    exposed = candidates[several[0] if several else next(iter(losses), 1)]
    for table, law in material_laws:
        for name in law.materials:
            if name not in exposed.names:
                raise SceneError(
                    f"{table} ({law.key}) must name materials of body {exposed.body}: "  # type: ignore[attr-defined]
                    f"{', '.join(map(repr, dict.fromkeys(exposed.names)))} (got {name!r}){nearest(name, exposed.names)}"
                )
    return None if exposed.uniform and not material_laws else exposed


def _materials(solids: Solids, body: int, sources: Sequence[Inhomogeneity], grid: Grid) -> Exposed:
    """Substrate, layers and inclusions of a body, by number."""
    medium = solids[body - 1]
    names: list[str] = [SUBSTRATE]
    interfaces: tuple[float, ...] = ()
    if isinstance(medium, LayeredMedium):
        names += medium.layer_names
        interfaces = medium.interfaces
    numbers: dict[str, int] = {}
    shapes = []
    for source in sources:
        if source.body == body and not source.guessed and isinstance(source.shape, InclusionShape):
            if source.where not in numbers:
                numbers[source.where] = len(names)
                names.append(source.material_name)
            shapes.append((numbers[source.where], source.shape))
    return Exposed(body=body, names=tuple(names), interfaces=interfaces, shapes=tuple(shapes), grid=grid)
