"""Boxes of cells: regions divided into cells, height of the cells, and regions that share a box."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, floor
from types import MappingProxyType

import numpy as np

from eigencontact.core.grid import Grid
from eigencontact.errors import SceneError
from eigencontact.model.refined import with_patch
from eigencontact.model.regions import RegionLattice
from eigencontact.model.sizes import BYTES_OF_LAW_CELL, BYTES_OF_ONE, comfortable, cut_down, most, refuse_more
from eigencontact.model.sources import Inhomogeneity, Lattice, Patch, Source
from eigencontact.scene.schema import Scene
from eigencontact.solvers.cells import Cells

__all__ = ["CellBox", "box_of_inhomogeneities", "boxes_of", "with_cells", "with_lattices"]

#: Layers of a patch, by default, and at least and at most where they follow a region of stress.
_LAYERS, _FEWEST, _MOST = 32, 16, 64
#: Cells across the thickness of a flat inhomogeneity, at least; flat is thinner than this part of its width.
_ACROSS, _FLAT = 4, 0.5
#: Regions with prescribed eigenstrain share a box as long as it has at most this many times their own cells.
_SPARSE = 3.0
_SNAP = 1e-6
#: So many layers must fit for their height to be what makes the cells too many.
_MIN_LAYERS = 4

#: Field of a scene, its value, and the power (1 or -1) of it that the number of layers grows with.
_Setting = tuple[str, float, int]


@dataclass(frozen=True, slots=True)
class CellBox:
    """Regions of one body that share a box of cells."""

    sources: tuple[Source, ...]
    lattice: Lattice

    @property
    def body(self) -> int:
        """Number of the body, 1 or 2, that contains the regions."""
        return self.sources[0].body

    @property
    def names(self) -> str:
        """Names of the regions, for people."""
        quoted = [repr(source.name) for source in self.sources[:4]]
        return ", ".join(quoted) + (f" and {len(self.sources) - 4} more" if len(self.sources) > 4 else "")

    @property
    def varies(self) -> bool:
        """Whether the prescribed eigenstrain in the box changes with time."""
        return any(source.field.varies for source in self.sources)

    @property
    def words(self) -> str:
        """Its size in words."""
        nz, ny, nx = self.lattice.shape
        return f"{nx} x {ny} x {nz} cells"

    def cells(self, grid: Grid) -> Cells:
        """Box in the form of the solvers."""
        z, y, x = self.lattice.axes(grid)
        dz, dy, dx = self.lattice.edges
        return Cells(first=(float(x[0]), float(y[0]), float(z[0])), pitch=(dx, dy, dz), shape=self.lattice.shape)

    def centres(self, grid: Grid) -> RegionLattice:
        """Centres of its cells as points of other fields."""
        z, y, x = self.lattice.axes(grid)
        origin = (float(self.lattice.first[1]), float(self.lattice.first[2]))
        return RegionLattice(target=self.lattice.shape[1:], origin=origin, x=x, y=y, depths=z)


def with_lattices(sources: Sequence[Source], scene: Scene, grid: Grid) -> tuple[Source, ...]:
    """Add cells to regions of prescribed eigenstrain without a closed form, and round patches to whole cells."""
    fitted = []
    for region in sources:
        shape = _whole_cells(region.shape, grid) if isinstance(region.shape, Patch) else region.shape
        fitted_region = replace(region, shape=shape)
        whole = fitted_region.exact and scene.numerics.half_space != "periodic"
        fitted.append(
            fitted_region if whole else replace(fitted_region, lattice=_cells_of_source(fitted_region, scene, grid))
        )
    return tuple(fitted)


def with_cells(
    sources: Sequence[Inhomogeneity], scene: Scene, grid: Grid, stored: Mapping[int, float] = MappingProxyType({})
) -> tuple[Inhomogeneity, ...]:
    """Inhomogeneities with their cells: columns of the grid, layers of one height in each body.

    Heights [m] that are `known`, by body, count where the scene gives none.
    """
    members = {body: [source for source in sources if source.body == body] for body in (1, 2)}
    pitch = scene.numerics.inclusion_pitch
    free = {} if pitch is not None else stored
    heights = {
        body: free.get(body) or _layer_height(regions, scene, grid) for body, regions in members.items() if regions
    }
    setting = None if pitch is None else ("numerics.inclusion-pitch", pitch, -1)
    celled = [replace(source, lattice=_around(source, heights[source.body], grid, setting)) for source in sources]
    if scene.numerics.refinement > 1:
        celled = [_with_patches(source, [with_patch(member) for member in celled]) for source in celled]
    return tuple(celled)


def _with_patches(source: Inhomogeneity, members: Sequence[Inhomogeneity]) -> Inhomogeneity:
    """Inclusion with its patch of finer cells, or yielding body whose cells fill all patches of the body as well."""
    if not source.guessed:
        return with_patch(source)
    lattices = [member.lattice for member in members if member.body == source.body and member.lattice is not None]
    return replace(source, lattice=_union(lattices))


def boxes_of(sources: Sequence[Source]) -> list[CellBox]:
    """Group regions of a body into boxes, if their cells are equal, all still or all moving, and close together."""
    boxes: list[CellBox] = []
    for source in sources:
        if source.lattice is None:
            continue
        for number, box in enumerate(boxes):
            joined = _join(box, source, source.lattice)
            if joined is not None:
                boxes[number] = joined
                break
        else:
            boxes.append(CellBox((source,), source.lattice))
    return boxes


def box_of_inhomogeneities(sources: Sequence[Inhomogeneity]) -> CellBox:
    """Common box of all inhomogeneities of a body."""
    lattices = [source.lattice for source in sources if source.lattice is not None]
    box = CellBox(tuple(sources), _union(lattices))
    advice = "give a coarser grid or numerics.inclusion-pitch, or let the regions lie closer together"
    where, cells = "inclusions that share a box", box.lattice.cells
    refuse_more(cells, where, "cells inside a body", box.words, advice, BYTES_OF_LAW_CELL)
    return box


def _union(lattices: Sequence[Lattice]) -> Lattice:
    starts = np.min([lattice.first for lattice in lattices], axis=0)
    stops = np.max([np.add(lattice.first, lattice.shape) for lattice in lattices], axis=0)
    (k, j, i), (nz, ny, nx) = starts.tolist(), (stops - starts).tolist()
    return Lattice((k, j, i), (nz, ny, nx), lattices[0].edges)


def _join(box: CellBox, source: Source, lattice: Lattice) -> CellBox | None:
    alike = np.allclose(box.lattice.edges, lattice.edges, rtol=1e-12, atol=0.0)
    if not alike or box.varies != bool(source.field.varies):
        return None
    union = _union([box.lattice, lattice])
    filled = sum(member.lattice.cells for member in box.sources if member.lattice is not None) + lattice.cells
    return CellBox((*box.sources, source), union) if union.cells <= _SPARSE * filled else None


def _whole_cells(patch: Patch, grid: Grid) -> Patch:
    """Patch moved to the nearest edges of cells, at least one cell in each direction."""
    low, high = patch.bounds
    spans = []
    for axis, pitch in enumerate((grid.dx, grid.dy)):
        start = grid.center[axis] - 0.5 * grid.size[axis]
        first = round((low[axis] - start) / pitch)
        last = max(first + 1, round((high[axis] - start) / pitch))
        spans.append((start + first * pitch, start + last * pitch))
    return Patch(((spans[0][0], spans[1][0], 0.0), (spans[0][1], spans[1][1], high[2])))


def _cells_of_source(source: Source, scene: Scene, grid: Grid) -> Lattice:
    """Cells of a region with prescribed eigenstrain; whole layers of an inclusion keep its faces."""
    low, high = source.shape.bounds
    extents = [hi - lo for lo, hi in zip(low, high, strict=True)]
    patch = isinstance(source.shape, Patch)
    layers = source.layers or (_layers_of_patch(extents[2], scene, source.body) if patch else None)
    across = scene.numerics.inclusion_cells
    height = extents[2] / layers if layers else min(extents) / across
    setting = (f"{source.where}.layers", source.layers, 1) if source.layers else None
    setting = ("numerics.inclusion-cells", across, 1) if layers is None else setting
    return _around(source, extents[2] / max(1, round(extents[2] / height)), grid, setting)


def _layers_of_patch(depth: float, scene: Scene, body: int) -> int:
    """Layers of a patch equal to the depth steps of a stress region, if their number is suitable."""
    for region in scene.stress:
        if region.depth_max is not None and region.body == body:
            count = depth * region.depth_steps / region.depth_max
            if _FEWEST <= round(count) <= _MOST and abs(count - round(count)) < 1e-6 * count:
                return round(count)
    return _LAYERS


def _layer_height(sources: Sequence[Inhomogeneity], scene: Scene, grid: Grid) -> float:
    """Height of the cells of one body.

    That of the scene; or near the smaller pitch of the grid, at most a quarter of the thinnest flat one, and such that
    their upper and lower ends fall on faces of cells, where a height of at least half that does it.
    """
    if scene.numerics.inclusion_pitch is not None:
        return scene.numerics.inclusion_pitch
    spans = [source.layered for source in sources]
    most, thinnest = min(grid.edges), min(high - low for low, high in spans)
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


def _around(source: Source, height: float, grid: Grid, setting: _Setting | None) -> Lattice:
    """Whole cells around a region: columns of the grid, layers counted from the surface.

    `setting` is the field of the scene that the height follows from, if it has one.
    """
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
    lattice = Lattice((max(k, 0), j, i), (stop_k - max(k, 0), stop_j - j, stop_i - i), edges)
    _refuse_many(lattice, source, setting)
    return lattice


def _refuse_many(lattice: Lattice, source: Source, setting: _Setting | None) -> None:
    """Refuse too many cells; name the setting of their height if some layers would fit, otherwise the region."""
    nz, ny, nx = lattice.shape
    bytes_per_cell = BYTES_OF_LAW_CELL if isinstance(source, Inhomogeneity) else BYTES_OF_ONE
    if lattice.cells <= most(bytes_per_cell):
        return
    extent = f"{nx} x {ny} x {nz} for {source.name!r}"
    if setting is not None and _MIN_LAYERS * ny * nx <= comfortable(bytes_per_cell):
        name, value, power = setting
        nearest = cut_down(value**power, lattice.cells, item_bytes=bytes_per_cell) ** power
        refuse_more(lattice.cells, name, "cells inside a body", extent, f"{nearest:.3g} would do", bytes_per_cell)
    wide = f"{lattice.edges[2]:.3g} m x {lattice.edges[1]:.3g} m"
    advice = f"its cells are {wide} wide: give a smaller one, or a coarser grid"
    refuse_more(lattice.cells, source.where, "cells inside a body", extent, advice, bytes_per_cell)
