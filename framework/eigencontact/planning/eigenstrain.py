"""Planning the fields of prescribed eigenstrain: which blocks, by which way, at which cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import cast

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.core.parallel import available_threads
from eigencontact.halfspace.potentials import HasPotentials
from eigencontact.planning.blocks import Block, Cost
from eigencontact.planning.cost import timed
from eigencontact.planning.kernels import KernelUse
from eigencontact.planning.regions import RegionLattice, region_lattice, surface_lattice
from eigencontact.planning.sources import Source
from eigencontact.scene.schema import Numerics, Scene, StressRequest

__all__ = ["CLOUD", "EigenstrainDeclaration", "space_of"]

FloatArray = NDArray[np.float64]

#: From so many closed forms on they are summed as a cloud of point sources where that is exact.
CLOUD = 16
#: Points on which the closed form of a shape is timed, spread over those wanted.
_SAMPLE = 1024


def space_of(numerics: Numerics) -> str:
    """Name of the space in `eigencontact.halfspace`."""
    return "full" if numerics.half_space == "full-space" else "half"


@dataclass(frozen=True, slots=True)
class EigenstrainDeclaration:
    """Facts of a scene that the blocks of its eigenstrain are declared from."""

    scene: Scene
    grid: Grid
    sources: Sequence[Source]
    bodies: tuple[Material | None, Material | None]

    def surface(self, components: str) -> Block:
        """Displacement of the surface along `components` (of "xyz")."""
        lattice = surface_lattice(self.grid)
        words = f"{self.grid.nx} x {self.grid.ny} points of the surface"
        uses, cost = self._parts(self.sources, {"displacement": components}, lattice, words)
        return Block(
            name="residual-displacement",
            runner="residual-displacement",
            provides=frozenset(f"residual_displacement_{c}" for c in components),
            why="displacement of the surface by " + _names(self.sources),
            kernels=uses,
            cost=cost,
            settings={"components": components, "lattice": lattice},
        )

    def region(self, request: StressRequest) -> Block | None:
        """Fields at the points of a region; None where its body has no eigenstrain."""
        sources = [source for source in self.sources if source.body == request.body]
        if not sources:
            return None
        lattice = region_lattice(request, self.grid)
        if lattice.points is not None:
            words = f"{len(lattice.points)} points"
        else:
            words = f"{lattice.target[1]} x {lattice.target[0]} points at {lattice.depths.size} depths"
        wanted = {"displacement": "xyz"} if "displacement" in request.fields else {}
        wanted |= {name: "all" for name in ("strain", "stress") if name in request.fields}
        uses, cost = self._parts(sources, wanted, lattice, words)
        return Block(
            name=f"eigenstrain-{request.label}",
            runner="eigenstrain-region",
            provides=frozenset({f"eigenstrain:{request.label}"}),
            why=f"fields of {_names(sources)} at the points of {request.label!r}",
            kernels=uses,
            cost=cost,
            settings={"request": request, "lattice": lattice},
        )

    def _parts(
        self, sources: Sequence[Source], wanted: dict[str, str], lattice: RegionLattice, words: str
    ) -> tuple[tuple[KernelUse, ...], Cost]:
        """Kernels and cost of quantities at points, like sources counted together."""
        uses: dict[tuple[str, str], KernelUse] = {}
        cost = Cost()
        for quantity, components in wanted.items():
            spread = f" {', '.join(components)}" if components in ("x", "y", "z", "xyz") else " (6 components)"
            for source in sources:
                like = (quantity, f"{source.key} {source.how}")
                if like in uses:
                    uses[like] = replace(uses[like], count=uses[like].count + 1)
                else:
                    words_ = f"{words}, {source.how}"
                    uses[like] = KernelUse(quantity + spread, f"eigenstrain of {source.name!r}", source.key, words_)
                cost += self._cost(source, quantity, lattice)
        return tuple(uses.values()), cost

    def _cost(self, source: Source, quantity: str, lattice: RegionLattice) -> Cost:
        body = self.bodies[source.body - 1]
        assert body is not None
        numerics = self.scene.numerics
        if source.exact:
            count = int(np.prod(lattice.shape))
            pace = _closed_form_pace(source, quantity, lattice, body, space_of(numerics))
            seconds = count * pace / (0.8 * (numerics.threads or available_threads())) + 1e-3
            held = 8.0 * count * (6 if quantity != "displacement" else 3) * 3
            return Cost(memory=held, seconds_once=seconds)
        raise NotImplementedError


def _names(sources: Sequence[Source]) -> str:
    shown = ", ".join(repr(source.name) for source in sources[:4])
    return shown if len(sources) <= 4 else f"{shown} and {len(sources) - 4} more"


_PACES: dict[tuple[object, ...], float] = {}


def _closed_form_pace(source: Source, quantity: str, lattice: RegionLattice, body: Material, space: str) -> float:
    """Measured time of one point on one thread [s]; like shapes of a scene at like points are timed once."""
    mandel = source.uniform_eigenstrain(1.0)
    key = (type(source.shape), quantity, space, tuple(mandel != 0), lattice.shape)
    if key not in _PACES:
        from eigencontact.halfspace.points import field_at_points

        points = lattice.flat_points(every=max(1, int(np.prod(lattice.shape)) // _SAMPLE))
        evaluate = partial(
            field_at_points,
            cast("HasPotentials", source.shape),
            mandel if mandel.any() else np.ones(6),
            points,
            poisson_ratio=body.poisson_ratio,
            quantity=quantity,
            space=space,
            threads=1,
        )
        _PACES[key] = timed(evaluate) / points[0].size
    return _PACES[key]
