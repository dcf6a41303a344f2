"""Planning of inhomogeneities: the box of cells that those of one body share, and the blocks that it takes.

Prescribed eigenstrain of the same body acts on them by its stress. Where it lies in an inhomogeneity it stays what it
is, a strain without stress, whatever the material: it adds to the prestrain there. The equivalent eigenstrain is not
stored with the results; what it does is, on the surface and in the regions asked for.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, floor

import numpy as np

from eigencontact.convolution import Layout
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.errors import SceneError
from eigencontact.planning.blocks import Block, Cost
from eigencontact.planning.cell_groups import CellGroup
from eigencontact.planning.cost import sampling_seconds, stress_cost
from eigencontact.planning.eigenstrain import EigenstrainDeclaration
from eigencontact.planning.field_cost import Pace, volume_cost
from eigencontact.planning.field_parts import FieldPart, part_of_cells, space_of
from eigencontact.planning.kernels import DIRECTIONS, Bodies, KernelUse
from eigencontact.planning.materials import elasticity_of
from eigencontact.planning.regions import RegionLattice, region_lattice, surface_lattice
from eigencontact.planning.sources import Lattice, Source
from eigencontact.plugin import HasCornerPotentials, SurfaceInfluence
from eigencontact.scene.schema import Scene, StressRequest

__all__ = ["EQUIVALENT", "InhomogeneityDeclaration", "boxes_of", "cell_centres", "layer_that_fills", "with_boxes"]

#: What the block of the inhomogeneities provides.
EQUIVALENT = "equivalent_eigenstrain"

#: Cells across the thickness of a flat inhomogeneity, at least; flat is thinner than this part of its width.
_ACROSS, _FLAT = 4, 0.5
#: Krylov iterations of one solve and rounds between it and the contact, typically, for the cost.
_ITERATIONS, _ROUNDS = 15, 8
_SNAP = 1e-6


def with_boxes(sources: Sequence[Source], scene: Scene, grid: Grid) -> tuple[Source, ...]:
    """Sources with the cells of the inhomogeneities: columns of the grid, layers of one height in each body."""
    found = list(sources)
    for body in (1, 2):
        members = [k for k, source in enumerate(found) if source.material is not None and source.body == body]
        if not members:
            continue
        height = _layer_height([found[k] for k in members], scene, grid)
        for k in members:
            elasticity_of(found[k])  # refused here, not in the middle of a run
            found[k] = replace(found[k], lattice=_lattice(found[k], height, grid))
    return tuple(found)


def _layer_height(sources: Sequence[Source], scene: Scene, grid: Grid) -> float:
    """Height of the cells of one body.

    That of the scene; or near the smaller pitch of the grid, at most a quarter of the thinnest flat one, and such that
    their upper and lower ends fall on faces of cells, where a height of at least half that does it.
    """
    if scene.numerics.inclusion_pitch is not None:
        return scene.numerics.inclusion_pitch
    spans = [(source.shape.bounds[0][2], source.shape.bounds[1][2]) for source in sources]
    most, thinnest = min(grid.dx, grid.dy), min(high - low for low, high in spans)
    for source, (low, high) in zip(sources, spans, strict=True):
        width = min(hi - lo for lo, hi in zip(source.shape.bounds[0][:2], source.shape.bounds[1][:2], strict=True))
        if high - low < _FLAT * width:
            most = min(most, (high - low) / _ACROSS)
    fewest = max(1, ceil(thinnest / most - _SNAP))
    ends = np.unique(np.array(spans).ravel())
    for count in range(fewest, 2 * fewest + 1):
        places = ends / (thinnest / count)
        if np.all(np.abs(places - np.round(places)) < _SNAP * np.maximum(1.0, places)):
            return thinnest / count
    return min(most, thinnest / fewest) if thinnest > most else most


def _lattice(source: Source, height: float, grid: Grid) -> Lattice:
    """Whole cells around a region."""
    low, high = source.shape.bounds
    if low[2] < -_SNAP * height:
        raise SceneError(
            f"{source.where} ({source.name!r}) must lie in z >= 0 to be cut into cells (got z from {low[2]:g} m); "
            "move it down: in a full space only the place of the points beside it matters"
        )
    edges = (height, grid.dy, grid.dx)
    starts = (0.0, float(grid.y[0]) - 0.5 * grid.dy, float(grid.x[0]) - 0.5 * grid.dx)
    spans = []
    for start, edge, lo, hi in zip(starts, edges, low[::-1], high[::-1], strict=True):
        first = floor((lo - start) / edge + _SNAP)
        spans.append((first, max(first + 1, ceil((hi - start) / edge - _SNAP))))
    (k, stop_k), (j, stop_j), (i, stop_i) = spans
    return Lattice((max(k, 0), j, i), (stop_k - max(k, 0), stop_j - j, stop_i - i), edges)


def boxes_of(sources: Sequence[Source]) -> dict[int, CellGroup]:
    """One box of cells for the inhomogeneities of each body that has some."""
    found: dict[int, CellGroup] = {}
    for body in (1, 2):
        members = tuple(source for source in sources if source.material is not None and source.body == body)
        lattices = [source.lattice for source in members if source.lattice is not None]
        if lattices:
            starts = np.min([lattice.first for lattice in lattices], axis=0)
            stops = np.max([np.add(lattice.first, lattice.shape) for lattice in lattices], axis=0)
            (k, j, i), (nz, ny, nx) = starts.tolist(), (stops - starts).tolist()
            found[body] = CellGroup(members, Lattice((k, j, i), (nz, ny, nx), lattices[0].edges))
    return found


def cell_centres(box: Lattice, grid: Grid) -> RegionLattice:
    """Centres of the cells as target points of other fields."""
    z, y, x = box.axes(grid)
    origin = (float(box.first[1]), float(box.first[2]))
    return RegionLattice(target=box.shape[1:], origin=origin, x=x, y=y, depths=z)


def layer_that_fills(sources: Sequence[Source], grid: Grid) -> Source | None:
    """Uniform flat layer of one material, from the surface and over the whole window, if there is one."""
    x0, y0 = (center - 0.5 * size for center, size in zip(grid.center, grid.size, strict=True))
    x1, y1 = x0 + grid.size[0], y0 + grid.size[1]
    for source in sources:
        if source.material is None or source.material.type != "isotropic":
            continue
        low, high = source.shape.bounds
        slack = _SNAP * max(grid.size)
        fills = low[0] <= x0 + slack and low[1] <= y0 + slack and high[0] >= x1 - slack and high[1] >= y1 - slack
        z = (np.arange(8) + 0.5) / 8 * high[2]
        y, x = grid.axes()
        if fills and low[2] <= slack and bool(source.shape.contains(x[..., None], y[..., None], z).all()):
            return source
    return None


@dataclass(frozen=True, slots=True)
class InhomogeneityDeclaration:
    """Facts of a scene that the blocks of its inhomogeneities are declared from.

    Attributes
    ----------
    boxes : mapping of int to CellGroup
        By body.
    prescribed : EigenstrainDeclaration
        The other sources, whose stress acts on the inhomogeneities too.
    influences : mapping of str to SurfaceInfluence
        Tractions of the contact; none without one.
    """

    scene: Scene
    grid: Grid
    boxes: Mapping[int, CellGroup]
    bodies: Bodies
    cell: HasCornerPotentials
    prescribed: EigenstrainDeclaration
    influences: Mapping[str, SurfaceInfluence]

    def solution(self) -> Block:
        """The solve for the equivalent eigenstrain of all cells."""
        tractions = tuple(self.influences)
        parts = {body: self._prescribed_stress(body, box) for body, box in self.boxes.items()}
        numerics, cost, uses = self.scene.numerics, Cost(), []
        for body, box in self.boxes.items():
            nz, ny, nx = box.lattice.shape
            words = f"{nx} x {ny} x {nz} cells"
            material = self._material(body)
            pace = Pace.of(self.cell, "stress", material.poisson_ratio, space_of(numerics), numerics)
            one = volume_cost(pace, box.lattice, box.lattice.shape[1:], (0.0, 0.0), nz)
            applications = (_ITERATIONS + 4) if tractions else _ITERATIONS
            rounds = _ROUNDS if tractions else 1
            # Eight Gauss points make the means; the solver keeps two vectors of six components an iteration.
            cost += Cost(
                memory=one.memory + 8.0 * 12 * box.lattice.cells * _ITERATIONS,
                seconds_once=8.0 * one.seconds_once,
                seconds_per_step=one.seconds_per_step * applications * (1.0 + 0.3 * (rounds - 1)),
            )
            uses.append(
                KernelUse("mean stress (6 components)", f"eigenstrain of {box.names}", self._cell_key, words, 58)
            )
            for name in tractions:
                key = self.influences[name].key
                cost += self._traction_cost(body, box, name)
                uses.append(KernelUse("mean stress (6 components)", f"traction {name}", key, words, nz))
            cost += sum((part.cost for part in parts[body]), Cost())
        fields = {"p": "pressure", "q_x": "shear_x", "q_y": "shear_y"}
        count = sum(len(box.sources) for box in self.boxes.values())
        return Block(
            name="inhomogeneities",
            runner="inhomogeneities",
            requires=frozenset(fields[name] for name in tractions),
            provides=frozenset({EQUIVALENT}),
            why=f"equivalent eigenstrain of {count} inhomogeneit{'ies' if count != 1 else 'y'}",
            kernels=tuple(uses),
            cost=cost,
            settings={"boxes": self.boxes, "tractions": tractions, "prescribed": parts},
        )

    def surface(self, components: str) -> Block:
        """Displacement of the surface by all eigenstrain, prescribed and equivalent."""
        base = self.prescribed.surface(components)
        lattice = surface_lattice(self.grid)
        tractions = tuple(name for name in self.influences if DIRECTIONS[name] in components)
        means = "".join(DIRECTIONS[name] for name in tractions)
        others = [c for c in components if c not in means]
        parts = [self._part(body, "displacement", lattice, 3) for body in self.boxes] if others else []
        words = f"{self.grid.nx} x {self.grid.ny} points of the surface"
        block = self._with(base, parts, words, {"displacement": f"displacement {', '.join(others)}"})
        uses, cost = list(block.kernels), block.cost
        for body, box in self.boxes.items():
            nz = box.lattice.shape[0]
            for name in tractions:
                who, key = f"eigenstrain of {box.names}", self.influences[name].key
                uses.append(KernelUse(f"mean displacement {DIRECTIONS[name]}", who, key, words, nz))
                cost += self._traction_cost(body, box, name)
        settings = {**block.settings, "boxes": self.boxes, "tractions": tractions}
        return replace(block, kernels=tuple(uses), cost=cost, settings=settings)

    def _traction_cost(self, body: int, box: CellGroup, name: str) -> Cost:
        """Cells and surface joined through the stress by one traction."""
        (nz, ny, nx), (_, row, column), numerics = box.lattice.shape, box.lattice.first, self.scene.numerics
        layout = Layout(self.grid.shape, (ny, nx), (row, column))
        sampling = 8.0 * sampling_seconds(self.influences[name], self._material(body))
        return stress_cost(layout, nz, sampling, precision=numerics.precision, threads=numerics.threads)

    def region(self, request: StressRequest) -> Block | None:
        """Fields at the points of a region; None where its body has neither inhomogeneities nor other eigenstrain."""
        base = self.prescribed.region(request)
        if request.body not in self._numbers:
            return base
        lattice = region_lattice(request, self.grid)
        parts = [
            self._part(request.body, quantity, lattice, 3 if quantity == "displacement" else 6)
            for quantity in request.fields
        ]
        if base is None:
            base = Block(
                name=f"eigenstrain-{request.label}",
                runner="eigenstrain-region",
                provides=frozenset({f"eigenstrain:{request.label}"}),
                why=f"fields of the inhomogeneities at the points of {request.label!r}",
                settings={"request": request, "parts": []},
            )
        spread = {"displacement": "displacement x, y, z"}
        spread |= {name: f"{name} (6 components)" for name in ("strain", "stress")}
        words = f"{len(lattice.points)} points" if lattice.points is not None else f"points of {request.label!r}"
        return self._with(base, parts, words, spread)

    def _with(self, base: Block, parts: list[FieldPart], words: str, spread: Mapping[str, str]) -> Block:
        uses = tuple(
            KernelUse(
                spread[part.quantity], f"eigenstrain of {part.group.names}", self._cell_key, f"{words}, {part.words}"
            )
            for part in parts
            if part.group is not None
        )
        return replace(
            base,
            runner="solved-" + base.runner,
            requires=base.requires | {EQUIVALENT},
            kernels=(*base.kernels, *uses),
            cost=sum((part.cost for part in parts), base.cost),
            settings={**base.settings, "solved": parts},
        )

    @property
    def _numbers(self) -> Sequence[int]:
        """Bodies with inhomogeneities."""
        return tuple(self.boxes)

    @property
    def _cell_key(self) -> str:
        return str(getattr(self.cell, "key", "cell"))

    def _part(self, body: int, quantity: str, lattice: RegionLattice, components: int) -> FieldPart:
        return part_of_cells(
            self.boxes[body], quantity, lattice, body=self._material(body), numerics=self.scene.numerics,
            cell=self.cell, components=components,
        )  # fmt: skip

    def _prescribed_stress(self, body: int, box: CellGroup) -> list[FieldPart]:
        return self.prescribed.parts(body, "stress", cell_centres(box.lattice, self.grid), 6)

    def _material(self, body: int) -> Material:
        material = self.bodies[body - 1]
        assert isinstance(material, Material)
        return material
