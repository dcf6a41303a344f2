"""Where a scene has eigenstrain: regions, their fields, and whether a closed form or cells describe them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import ceil, floor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.core.units import readable
from eigencontact.errors import SceneError
from eigencontact.halfspace.potentials import HasMirrorPotential, HasPotentials
from eigencontact.hooks.registry import Registry
from eigencontact.plugin import EigenstrainField, InclusionShape
from eigencontact.scene.components import build_component
from eigencontact.scene.inclusions import EigenstrainPatch, eigenstrain_table
from eigencontact.scene.materials import InclusionMaterial
from eigencontact.scene.schema import Scene

__all__ = ["Lattice", "Patch", "Source", "build_sources", "with_lattices"]

FloatArray = NDArray[np.float64]
Point = tuple[float, float, float]

#: A region may reach above the surface by this part of its size: rounding of coordinates.
_ROUND_OFF = 1e-12
# Layers of a patch, by default and at least and at most.
_LAYERS, _FEWEST, _MOST = 32, 16, 64


@dataclass(frozen=True, slots=True)
class Patch:
    """Box from the surface down to a depth, filled by an eigenstrain field."""

    bounds: tuple[Point, Point]

    def contains(self, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie in the box."""
        low, high = self.bounds
        inside = [(lo <= at) & (at <= hi) for lo, at, hi in zip(low, (x, y, z), high, strict=True)]
        return np.asarray(inside[0] & inside[1] & inside[2])


@dataclass(frozen=True, slots=True)
class Lattice:
    """Cells that a region is cut into, on the columns of the grid.

    Attributes
    ----------
    first : (int, int, int)
        Lowest cell (layer, row, column): layers count from the surface, rows and columns from the grid's first cell.
    shape : (int, int, int)
        Cells (nz, ny, nx).
    edges : (float, float, float)
        (dz, dy, dx) [m].
    """

    first: tuple[int, int, int]
    shape: tuple[int, int, int]
    edges: tuple[float, float, float]

    @property
    def cells(self) -> int:
        """Number of cells."""
        return int(np.prod(self.shape))

    def axes(self, grid: Grid) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Centres along z, y, x [m]."""
        starts = (0.5 * self.edges[0], float(grid.y[0]), float(grid.x[0]))
        z, y, x = (
            np.asarray(start + (first + np.arange(count)) * edge, dtype=float)
            for start, first, count, edge in zip(starts, self.first, self.shape, self.edges, strict=True)
        )
        return z, y, x


@dataclass(frozen=True, kw_only=True)
class Source:
    """One region with eigenstrain.

    Attributes
    ----------
    name, where : str
        For people, and its table in the scene.
    key : str
        Plugin of the shape; of the field for a patch.
    body : int
        1 or 2.
    shape : InclusionShape or Patch
        The region.
    field : EigenstrainField
        The eigenstrain in it.
    layers : int or None
        Layers of a patch; None for an inclusion.
    lattice : Lattice or None
        Its cells; None where its field has a closed form.
    material : InclusionMaterial or None
        Its elastic constants, where it is an inhomogeneity; `field` is then its prestrain.
    """

    name: str
    where: str
    key: str
    body: int
    shape: InclusionShape | Patch
    field: EigenstrainField
    layers: int | None = None
    lattice: Lattice | None = None
    material: InclusionMaterial | None = None

    @property
    def exact(self) -> bool:
        """Whether shape and eigenstrain have a closed form, so that nothing is cut into cells."""
        return isinstance(self.shape, HasPotentials) and bool(self.field.uniform)

    @property
    def how(self) -> str:
        """How its field is found, in words."""
        if self.lattice is not None:
            nz, ny, nx = self.lattice.shape
            if self.material is not None:
                return f"{nx} x {ny} x {nz} cells of {_words(self.material)}"
            why = "the eigenstrain is not uniform" if isinstance(self.shape, HasPotentials) else "no potentials"
            if isinstance(self.shape, Patch):
                why = "a patch of the window"
            elif self.exact:
                why = "the half-space is periodic"
            return f"cut into {self.lattice.cells} cells, {nx} x {ny} x {nz} ({why})"
        if self.material is not None:
            return f"one eigenstrain of {_words(self.material)}"
        method = self.shape.method if isinstance(self.shape, InclusionShape) else "closed form"
        if isinstance(self.shape, HasMirrorPotential):
            return method
        return f"{method}, and quadrature of the mirror image (the shape gives no chi)"

    def uniform_eigenstrain(self, time: float) -> FloatArray:
        """Mandel eigenstrain ``(6,)`` of a uniform field."""
        low, high = self.shape.bounds
        x, y, z = (np.array([0.5 * (lo + hi)]) for lo, hi in zip(low, high, strict=True))
        return np.asarray(self.field.eigenstrain(x, y, z, time), dtype=float).reshape(6)


def build_sources(scene: Scene, registry: Registry, grid: Grid | None) -> tuple[Source, ...]:
    """Regions of a scene with shapes and fields built and checked, without their cells.

    Parameters
    ----------
    grid : Grid or None
        The window that patches fill; None where it is chosen from the regions, which then must give their size.

    Raises
    ------
    SceneError, PluginError
        Components that are refused; regions that reach above the surface.
    """
    full = scene.numerics.half_space == "full-space"
    sources = []
    for number, item in enumerate(scene.inclusions):
        where = "inclusions" if len(scene.inclusions) == 1 else f"inclusions.{number}"
        field = _field(registry, eigenstrain_table(item.eigenstrain), f"{where}.eigenstrain")
        entry = registry.get("inclusion-shape", item.type, where=where)
        for copy, table in enumerate(item.tables(entry.component, where)):
            shape = build_component(registry, "inclusion-shape", table, where)
            name = item.name or f"{item.type} {number + 1}"
            name += f", {copy + 1}" if item.centers is not None else ""
            source = Source(
                name=name, where=where, key=item.type, body=item.body, shape=shape, field=field, material=item.material
            )
            sources.append(source)
            if not full:
                _refuse_above(sources[-1])
    for number, patch in enumerate(scene.eigenstrain):
        where = "eigenstrain" if len(scene.eigenstrain) == 1 else f"eigenstrain.{number}"
        sources.append(
            Source(
                name=patch.name or f"{patch.type} {number + 1}",
                where=where,
                key=patch.type,
                body=patch.body,
                shape=_patch(patch, grid, where),
                field=_field(registry, patch.component, where),
                layers=patch.layers,
            )
        )
    return tuple(sources)


def _words(material: InclusionMaterial) -> str:
    """Material in words."""
    if material.type == "isotropic":
        assert material.young_modulus is not None
        return f"E = {readable(material.young_modulus, 'Pa')}, ν = {material.poisson_ratio:g}"
    known = {"void": "nothing (a void)", "map": f"the map {material.file}"}
    return known.get(material.type, f"{material.type} material")


def _field(registry: Registry, table: Mapping[str, Any], where: str) -> EigenstrainField:
    field: EigenstrainField = build_component(registry, "eigenstrain-field", table, where)
    return field


def _patch(patch: EigenstrainPatch, grid: Grid | None, where: str) -> Patch:
    if grid is None and patch.size is None:
        raise SceneError(
            f"{where}.size must be given with an automatic grid (got neither); give grid.cells and grid.size, and the "
            "eigenstrain fills the window, or the size of the patch"
        )
    width, height = patch.size or (grid.size if grid is not None else (0.0, 0.0))
    x, y = patch.center or (grid.center if grid is not None else (0.0, 0.0))
    return Patch(((x - 0.5 * width, y - 0.5 * height, 0.0), (x + 0.5 * width, y + 0.5 * height, patch.depth)))


def _whole_cells(patch: Patch, grid: Grid) -> Patch:
    """Patch moved to the nearest edges of cells, at least one cell each way."""
    low, high = patch.bounds
    spans = []
    for axis, pitch in enumerate((grid.dx, grid.dy)):
        start = grid.center[axis] - 0.5 * grid.size[axis]
        first = round((low[axis] - start) / pitch)
        last = max(first + 1, round((high[axis] - start) / pitch))
        spans.append((start + first * pitch, start + last * pitch))
    return Patch(((spans[0][0], spans[1][0], 0.0), (spans[0][1], spans[1][1], high[2])))


def _refuse_above(source: Source) -> None:
    low, high = source.shape.bounds
    size = max(hi - lo for lo, hi in zip(low, high, strict=True))
    if not low[2] >= -_ROUND_OFF * size:
        raise SceneError(
            f"{source.where} ({source.name!r}) must lie below the surface, z >= 0 (got z from {low[2]:g} m to "
            f'{high[2]:g} m); move or shrink it, or set numerics.half-space = "full-space" to leave the surface out'
        )


def with_lattices(sources: tuple[Source, ...], scene: Scene, grid: Grid) -> tuple[Source, ...]:
    """Sources with the cells of those that have no closed form; patches are rounded to cells.

    Inhomogeneities get theirs, which they share, from `eigencontact.planning.inhomogeneities`.
    """
    fitted = []
    for source in sources:
        if isinstance(source.shape, Patch):
            source = replace(source, shape=_whole_cells(source.shape, grid))  # noqa: PLW2901
        if source.material is not None:
            fitted.append(source)
            continue
        whole = source.exact and scene.numerics.half_space != "periodic"
        fitted.append(source if whole else replace(source, lattice=_lattice(source, scene, grid)))
    return tuple(fitted)


def _layers(depth: float, scene: Scene, body: int) -> int:
    """Layers of a patch that are the steps of depth of a region of stress, where some are of a sensible size."""
    for region in scene.stress:
        if region.depth_max is not None and region.body == body:
            count = depth * region.depth_cells / region.depth_max
            if _FEWEST <= round(count) <= _MOST and abs(count - round(count)) < 1e-6 * count:
                return round(count)
    return _LAYERS


def _lattice(source: Source, scene: Scene, grid: Grid) -> Lattice:
    """Whole cells around a region: columns of the grid, layers counted from the surface."""
    low, high = source.shape.bounds
    patch = isinstance(source.shape, Patch)
    if low[2] < 0 and not patch:
        raise SceneError(
            f"{source.where} ({source.name!r}) must lie in z >= 0 to be cut into cells (got z from {low[2]:g} m); "
            "move it down: in a full space only the place of the points beside it matters"
        )
    extents = [hi - lo for lo, hi in zip(low, high, strict=True)]
    layers = source.layers or (_layers(extents[2], scene, source.body) if patch else None)
    dz = extents[2] / layers if layers else min(extents) / scene.numerics.inclusion_cells
    # An inclusion of which whole layers fit keeps its faces.
    dz = extents[2] / max(1, round(extents[2] / dz))
    edges = (dz, grid.dy, grid.dx)
    starts = (0.0, float(grid.y[0]) - 0.5 * grid.dy, float(grid.x[0]) - 0.5 * grid.dx)
    first, last = [], []
    for start, edge, lo, hi in zip(starts, edges, low[::-1], high[::-1], strict=True):
        first.append(floor((lo - start) / edge + 1e-6))
        last.append(max(first[-1] + 1, ceil((hi - start) / edge - 1e-6)))
    shape = tuple(stop - begin for begin, stop in zip(first, last, strict=True))
    return Lattice((first[0], first[1], first[2]), (shape[0], shape[1], shape[2]), edges)
