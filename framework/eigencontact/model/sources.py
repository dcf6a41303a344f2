"""Regions with eigenstrain or another material: shapes, fields, laws and cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.arrays import real_answer
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.errors import SceneError, require
from eigencontact.halfspace.potentials import HasMirrorPotential, HasPotentials
from eigencontact.hooks.registry import Registry
from eigencontact.model.cross_section import CrossSection
from eigencontact.plugin import ConstitutiveLaw, EigenstrainField, InclusionShape, LinearLaw
from eigencontact.scene.components import build_component
from eigencontact.scene.inclusions import eigenstrain_table
from eigencontact.scene.schema import Scene

if TYPE_CHECKING:
    from eigencontact.model.whole_degrees import WholeDegree

__all__ = [
    "Inhomogeneity",
    "Lattice",
    "Patch",
    "Source",
    "build_inclusions",
    "build_law",
    "build_patches",
    "build_sources",
    "region_of_patch",
]

Point = tuple[float, float, float]

#: A region may reach above the surface by this part of its size: rounding of coordinates.
_ROUND_OFF = 1e-12


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
        return prod(self.shape)

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
    """One region with a prescribed eigenstrain.

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
    guessed : bool
        Class attribute; whether its bounds were chosen such that its law is elastic beyond them.
    """

    name: str
    where: str
    key: str
    body: int
    shape: InclusionShape | Patch
    field: EigenstrainField
    layers: int | None = None
    lattice: Lattice | None = None
    guessed: ClassVar[bool] = False

    @property
    def exact(self) -> bool:
        """Whether shape and eigenstrain have a closed form, so that nothing need be cut into cells."""
        return isinstance(self.shape, HasPotentials) and bool(self.field.uniform)

    @property
    def material(self) -> str | None:
        """Key of its own law; None for the material of the body."""
        return None

    @property
    def how(self) -> str:
        """Method for the field of the region, in words."""
        if self.lattice is not None:
            nz, ny, nx = self.lattice.shape
            reason = "the eigenstrain is not uniform" if isinstance(self.shape, HasPotentials) else "no potentials"
            if isinstance(self.shape, Patch):
                reason = "a patch of the window"
            elif self.exact:
                reason = "the half-space is periodic"
            return f"cut into {self.lattice.cells} cells, {nx} x {ny} x {nz} ({reason})"
        method = self.shape.method if isinstance(self.shape, InclusionShape) else "closed form"
        if isinstance(self.shape, HasMirrorPotential):
            return method
        return f"{method}, and quadrature of the mirror image (the shape gives no chi)"

    def uniform_eigenstrain(self, time: float) -> FloatArray:
        """Mandel eigenstrain ``(6,)`` of a uniform field."""
        low, high = self.shape.bounds
        x, y, z = (np.array([0.5 * (lo + hi)]) for lo, hi in zip(low, high, strict=True))
        return real_answer(
            self.field.eigenstrain(x, y, z, time), f"eigenstrain of eigenstrain field {self.field.key!r}"
        ).reshape(6)


@dataclass(frozen=True, kw_only=True)
class Inhomogeneity(Source):
    """Region with its own constitutive law; `field` is its prestrain.

    Attributes
    ----------
    law : ConstitutiveLaw
    degree : WholeDegree or None
        Degree of its one polynomial eigenstrain, and the error foretold; None where it is resolved by cells.
    """

    law: ConstitutiveLaw
    degree: WholeDegree | None = None

    @property
    def whole(self) -> bool:
        """Whether it has one eigenstrain; its cells, if any, then belong to the material around it."""
        return self.degree is not None

    @property
    def material(self) -> str | None:
        """Key of its law."""
        return self.law.key

    @property
    def layered(self) -> tuple[float, float]:
        """Depths [m] between which whole layers of cells lie."""
        return self.shape.bounds[0][2], self.shape.bounds[1][2]

    @property
    def uniform_law(self) -> LinearLaw | None:
        """Linear law with uniform constants; None for others."""
        return self.law if isinstance(self.law, LinearLaw) and not self.law.varies else None

    @property
    def is_empty(self) -> bool:
        """Whether the region carries no stress; the factors are finite for every material, also a rigid one."""
        return self.uniform_law is not None and not np.any(self.uniform_law.factors(1.0)[1])

    @property
    def material_name(self) -> str:
        """Name for laws by material, the same for all copies."""
        return self.name.split(", ")[0]

    @property
    def how(self) -> str:
        """Resolution of the region, in words."""
        if self.degree is not None:
            kind = f"polynomial eigenstrain of degree {self.degree.degree}" if self.degree.degree else "eigenstrain"
            return f"{self.law.words}, with one {kind}"
        assert self.lattice is not None
        nz, ny, nx = self.lattice.shape
        return f"{nx} x {ny} x {nz} cells of {self.law.words}"


def build_sources(
    scene: Scene, registry: Registry, grid: Grid | None, bodies: Sequence[object] = (None, None)
) -> tuple[tuple[Source, ...], tuple[Inhomogeneity, ...]]:
    """Regions with prescribed eigenstrain, and inhomogeneities, built and checked, without their cells.

    Parameters
    ----------
    grid : Grid or None
        The window that patches fill; None where it is chosen from the regions, which then must give their size.
    bodies : two of Material, or anything else
        Constants that a law takes where it gives none itself.

    Raises
    ------
    SceneError, PluginError
        Components that are refused; regions that reach above the surface.
    """
    prescribed, inhomogeneities = build_inclusions(scene, registry, bodies)
    return (*prescribed, *build_patches(scene, registry, grid)), inhomogeneities


def build_inclusions(
    scene: Scene, registry: Registry, bodies: Sequence[object]
) -> tuple[tuple[Source, ...], tuple[Inhomogeneity, ...]]:
    """Inclusions with eigenstrain only, and inclusions of another material; see `build_sources`."""
    prescribed: list[Source] = []
    inhomogeneities: list[Inhomogeneity] = []
    for number, item in enumerate(scene.inclusions):
        where = _place("inclusions", number, scene.inclusions)
        field = _field(registry, eigenstrain_table(item.eigenstrain), f"{where}.eigenstrain")
        body, material = bodies[item.body - 1], item.material
        law = None if material is None else build_law(registry, material, f"{where}.material", body)
        entry = registry.get("inclusion-shape", item.type, where=where)
        for copy, table in enumerate(item.tables(entry.component, where)):
            shape = build_component(registry, "inclusion-shape", table, where, item.beside)
            if scene.grid.line:
                shape = _cross_section(shape, where)
            name = item.name or f"{item.type} {number + 1}"
            name += f", {copy + 1}" if item.centers is not None else ""
            facts: dict[str, Any] = {"name": name, "where": where, "key": item.type, "body": item.body}
            if law is None:
                prescribed.append(Source(**facts, shape=shape, field=field))
            else:
                inhomogeneities.append(Inhomogeneity(**facts, shape=shape, field=field, law=law))
            if scene.numerics.half_space != "full-space":
                _refuse_above((prescribed if law is None else inhomogeneities)[-1])
    _refuse_clashes(inhomogeneities)
    return tuple(prescribed), tuple(inhomogeneities)


def _cross_section(shape: InclusionShape, where: str) -> CrossSection:
    """Region of infinite length along y in a line contact; None for a shape that does not meet y = 0."""
    low, high = shape.bounds
    rule = "cut by the plane y = 0 in a line contact, where its cross-section counts"
    require(low[1] < 0.0 < high[1], where, "extent along y", (low[1], high[1]), rule)
    return CrossSection(solid=shape)


def build_patches(scene: Scene, registry: Registry, grid: Grid | None) -> tuple[Source, ...]:
    """Patches with eigenstrain; see `build_sources`."""
    return tuple(
        Source(
            name=patch.name or f"{patch.type} {number + 1}",
            where=(where := _place("eigenstrain", number, scene.eigenstrain)),
            key=patch.type,
            body=patch.body,
            shape=region_of_patch(scene, number, grid),
            field=_field(registry, patch.component, where),
            layers=patch.layers,
        )
        for number, patch in enumerate(scene.eigenstrain)
    )


def _place(group: str, number: int, tables: Sequence[object]) -> str:
    """Table of an array, for messages."""
    return group if len(tables) == 1 else f"{group}.{number}"


#: What is stored of every cell, beside the variables of its law.
_STORED = ("equivalent_eigenstrain",)


def _refuse_clashes(inhomogeneities: Sequence[Inhomogeneity]) -> None:
    """Refuse laws of one body with different variables of the same name, which share a stored field."""
    first: dict[tuple[int, str], Inhomogeneity] = {}
    for source in inhomogeneities:
        for name, variable in source.law.variables.items():
            rule = f"of a law with another name for its variable; the program stores its own {name!r} of every cell"
            require(name not in _STORED, source.where, "material", source.law.key, rule)
            earlier = first.setdefault((source.body, name), source)
            stored = earlier.law.variables[name]
            alike = (variable.unit, variable.components) == (stored.unit, stored.components)
            rule = f"of a law whose variable {name!r} equals that of {earlier.law.key!r} of {earlier.name!r}, "
            rule += f"[{stored.unit}] with {stored.components} components, or in the other body"
            got = f"{source.law.key!r}: [{variable.unit}] with {variable.components}"
            require(alike, source.where, "material", got, rule)


def _field(registry: Registry, table: Mapping[str, Any], where: str) -> EigenstrainField:
    field: EigenstrainField = build_component(registry, "eigenstrain-field", table, where)
    return field


def build_law(registry: Registry, table: Mapping[str, Any], where: str, body: object) -> ConstitutiveLaw:
    """Law of a table, in a body; error messages begin with its position in the scene."""
    try:
        law: ConstitutiveLaw = build_component(registry, "constitutive-law", table, where)
    except SceneError as problem:
        text = str(problem)
        raise SceneError(text if where in text else f"{where}: {text}") from None
    return law.of_body(body.young_modulus, body.poisson_ratio) if isinstance(body, Material) else law


def region_of_patch(scene: Scene, number: int, grid: Grid | None) -> Patch:
    """Region of a patch, not yet rounded to cells; without size it fills the window of a grid."""
    patch = scene.eigenstrain[number]
    if grid is None and patch.size is None:
        raise SceneError(
            f"{_place('eigenstrain', number, scene.eigenstrain)}.size must be given with an automatic grid (got "
            "neither); give grid.cells and grid.size, and the eigenstrain fills the window, or the size of the patch"
        )
    sizes = patch.size or (grid.size if grid is not None else (0.0, 0.0))
    middles = patch.center or (grid.center if grid is not None else (0.0, 0.0))
    area = scene.grid.with_cells(1, 1, *sizes, middles)
    spans = [(middle - 0.5 * size, middle + 0.5 * size) for middle, size in zip(area.center, area.size, strict=True)]
    return Patch(((spans[0][0], spans[1][0], 0.0), (spans[0][1], spans[1][1], patch.depth)))


def _refuse_above(source: Source) -> None:
    low, high = source.shape.bounds
    size = max(hi - lo for lo, hi in zip(low, high, strict=True))
    if not low[2] >= -_ROUND_OFF * size:
        raise SceneError(
            f"{source.where} must lie below the surface, z >= 0 (got z from {low[2]:g} m to "
            f'{high[2]:g} m); move or shrink it, or set numerics.half-space = "full-space" to leave the surface out'
        )
