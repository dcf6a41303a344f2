"""What is exposed: the topmost material of each column of a body under its worn surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.errors import SceneError, nearest
from eigencontact.model.kernels import Bodies
from eigencontact.model.sources import Inhomogeneity
from eigencontact.plugin import FrictionLaw, InclusionShape, LayeredMedium, NamesMaterials, WearLaw
from eigencontact.plugin.materials import SUBSTRATE

__all__ = ["Exposed", "exposed_of"]

FloatArray = NDArray[np.float64]

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

    def at(self, worn: FloatArray | None = None) -> NDArray[np.intp]:
        """Numbers ``(ny, nx)`` under a depth ``(ny, nx)`` [m] that the body has lost; None for none."""
        depth = np.zeros(self.grid.shape) if worn is None else worn
        depth = depth + _BELOW * min(self.grid.dx, self.grid.dy)
        layer = np.searchsorted(np.asarray(self.interfaces), depth) + 1
        out = np.where(layer > len(self.interfaces), 0, layer)
        y, x = self.grid.axes()
        for number, shape in self.shapes:
            out[np.asarray(shape.contains(x, y, depth))] = number
        return out

    def beyond(self, worn: FloatArray, added: FloatArray) -> float:
        """Part of a depth to be worn, by volume, that lies below what is exposed now; both ``(ny, nx)`` [m]."""
        now = self.at(worn)
        crossed = self.at(worn + added) != now
        if not crossed.any():
            return 0.0
        low, step = np.zeros(now.shape), 0.5
        for _ in range(_BISECTIONS):
            low = np.where(self.at(worn + (low + step) * added) == now, low + step, low)
            step *= 0.5
        return float((added * (1.0 - low))[crossed].sum() / added.sum())

    @property
    def alone(self) -> bool:
        """Whether the body is of one material."""
        return len(self.names) == 1


def exposed_of(
    bodies: Bodies,
    sources: Sequence[Inhomogeneity],
    grid: Grid,
    friction: FrictionLaw | None,
    wear: WearLaw | None,
    worn: Sequence[int],
) -> Exposed | None:
    """Materials that laws may look at; None where no law tells materials apart and none comes to the surface by wear.

    Parameters
    ----------
    sources : sequence of Inhomogeneity
        Inclusions; the name of their table is that of the material.
    worn : sequence of int
        Bodies that wear.

    Raises
    ------
    SceneError
        A law names a material that there is not, or two bodies have materials that it could mean.
    """
    laws: list[tuple[str, Any]] = [
        (kind, law) for kind, law in (("friction", friction), ("wear", wear)) if isinstance(law, NamesMaterials)
    ]
    if not laws and wear is None:
        return None
    known = {body: _materials(bodies, body, sources, grid) for body in (1, 2)}
    made = [body for body, one in known.items() if not one.alone]
    if len(made) > 1 and laws:
        where, law = laws[0]
        raise SceneError(
            f"{where}.type must be a law that does not tell materials apart where both bodies have several (got "
            f"{law.key!r}, and {', '.join(known[1].names)} in body 1, {', '.join(known[2].names)} in body 2); make one "
            "body of one material"
        )
    found = known[made[0] if made else next(iter(worn), 1)]
    for where, law in laws:
        for name in law.materials:
            if name not in found.names:
                raise SceneError(
                    f"{where} ({law.key}) must name materials of body {found.body}: "
                    f"{', '.join(map(repr, dict.fromkeys(found.names)))} (got {name!r}){nearest(name, found.names)}"
                )
    return None if found.alone and not laws else found


def _materials(bodies: Bodies, body: int, sources: Sequence[Inhomogeneity], grid: Grid) -> Exposed:
    medium = bodies[body - 1]
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
