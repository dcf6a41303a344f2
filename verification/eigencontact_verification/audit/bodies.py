"""The bodies of a stored step as finite elements see them, and the reasons why they cannot represent a body."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.bulk import bulk_stress_of, eigenstrain_by_bulk, strain_of
from eigencontact_verification.audit.shares import mean_of_parts
from eigencontact_verification.crosscheck.case import Gap
from eigencontact_verification.fem.loaded_body import Cells, LoadedBody, Tractions
from eigencontact_verification.fem.model import Layer, Region

if TYPE_CHECKING:
    from eigencontact.core.material import Material
    from eigencontact.hooks.registry import Registry
    from eigencontact.model.sources import Inhomogeneity, Source
    from eigencontact_verification.audit.stored import StoredStep

__all__ = ["AuditedBody", "NotJudged", "Part", "bodies_of_step", "moduli_of", "tractions_on"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Triple = tuple[float, float, float]

#: Young's modulus of a void, in that of the body: small enough, and the system stays solvable.
VOID = 1e-6
#: Poisson's ratio from which displacement elements lock.
_INCOMPRESSIBLE = 0.495
#: Layers of cells of a patch that names no number of its own.
_PATCH_LAYERS = 32
#: Cells across a shape that is filled by an eigenstrain that is not uniform.
_ACROSS = 24


class NotJudged(Exception):
    """No finite-element model of this package has this feature; the text is the reason."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Part:
    """Region of a shape without later shapes, raised by the worn depth above it.

    It is a dataclass and no closure, because cases are sent to other processes.

    Attributes
    ----------
    shape : object
        With ``contains(x, y, z)`` and ``bounds``.
    later : tuple of object
        Shapes that replace parts of this one.
    worn : (ny, nx) float64 or None
        Worn depth [m].
    edges : (x, y)
        Edges of the cells of `worn`.
    """

    shape: Any
    later: tuple[Any, ...] = ()
    worn: FloatArray | None = None
    edges: tuple[FloatArray, FloatArray] | None = None

    def __call__(self, x: FloatArray, y: FloatArray, z: FloatArray) -> BoolArray:
        """Whether points lie in the region."""
        x, y, z = np.broadcast_arrays(x, y, z)
        if self.worn is not None and self.edges is not None:
            column = np.clip(np.searchsorted(self.edges[0], x) - 1, 0, self.worn.shape[1] - 1)
            row = np.clip(np.searchsorted(self.edges[1], y) - 1, 0, self.worn.shape[0] - 1)
            z = z + self.worn[row, column]
        inside = np.asarray(self.shape.contains(x, y, z), dtype=bool)
        for other in self.later:
            inside = inside & ~np.asarray(other.contains(x, y, z), dtype=bool)
        return inside

    @property
    def bounds(self) -> tuple[Triple, Triple]:
        """Box around the region, below the surface."""
        low, high = (tuple(float(value) for value in corner) for corner in self.shape.bounds)
        risen = 0.0 if self.worn is None else float(self.worn.max())
        top = max(low[2] - risen, 0.0)
        if top < 1e-9 * (high[2] - low[2]):
            top = 0.0
        return (low[0], low[1], top), (high[0], high[1], high[2])


@dataclass(frozen=True, kw_only=True, eq=False)
class AuditedBody:
    """A deformable body of a step.

    Attributes
    ----------
    number : int
        1 or 2.
    loaded : LoadedBody
        Without tractions, which `tractions_on` gives.
    different : tuple of Part
        Regions of other moduli, or of a shape without a closed form, which the run cut into cells.
    cell : (float, float, float)
        Edges along x, y, z of the cells that remember or differ [m]; zeros where there are none.
    box : (low, high) or None
        Of these cells.
    damaged : bool
        Whether some have lost stiffness.
    means : tuple of str
        Components of the displacement of the surface of which the file holds, of the part by cells that answer the
        contact, the mean over each cell of the surface and not the value in its middle: those along its tractions, as
        the work of a uniform traction asks for (Betti).
    stress_errors : tuple of (x, y, z, size)
        Edges of cells, and the stress [Pa] ``(nz, ny, nx)`` by which blocks of the strain at their centres and blocks
        that act as the smooth field differ in each: the run takes the former for stress, the latter for displacement.
    bulk : (3, 3)
        Bulk stress [Pa], which adds to that of the elements; regions of `loaded` answer it.
    """

    number: int
    loaded: LoadedBody
    different: tuple[Part, ...] = ()
    cell: tuple[float, float, float] = (0.0, 0.0, 0.0)
    box: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    damaged: bool = False
    means: tuple[str, ...] = ()
    stress_errors: tuple[tuple[FloatArray, FloatArray, FloatArray, FloatArray], ...] = ()
    bulk: FloatArray = field(default_factory=lambda: np.zeros((3, 3)))


def moduli_of(law: Any, body: Material) -> tuple[float, float]:
    """Young's modulus [Pa] and Poisson's ratio of a law where it is elastic; nearly no modulus of a void.

    Raises
    ------
    NotJudged
        A law that is not isotropic, differs from place to place, or closes its cracks.
    """
    from eigencontact.plugin import LinearLaw

    if law.varies:
        raise NotJudged(f"the law {getattr(law, 'key', '')!r} differs from place to place")
    if getattr(law, "crack_closure", False):
        raise NotJudged(f"the law {law.key!r} closes its cracks, which is no factor of the stiffness")
    if isinstance(law, LinearLaw):
        stiffness = np.asarray(law.stiffness_matrix(), dtype=float)
        if not law.isotropic:
            raise NotJudged(f"the law {law.key!r} is not isotropic")
        twice_shear, lame = float(stiffness[3, 3]), float(stiffness[0, 1])
        if twice_shear == 0.0:
            return VOID * body.young_modulus, body.poisson_ratio
        nu = lame / (2.0 * lame + twice_shear)
        return twice_shear * (1.0 + nu), nu
    constants = getattr(law, "young_modulus", None), getattr(law, "poisson_ratio", None)
    if constants[0] is None or constants[1] is None:
        raise NotJudged(f"the law {law.key!r} does not tell its elastic constants")
    return float(constants[0]), float(constants[1])


def bodies_of_step(stored: StoredStep) -> tuple[tuple[AuditedBody, ...], list[Gap]]:
    """Deformable bodies of a step, and what cannot be judged.

    A body that no model stands for is left out, with all that depends on it; the gaps say so.
    """
    from eigencontact.core.material import Material
    from eigencontact.model.bodies import bodies_of
    from eigencontact.model.sources import build_sources

    scene, gaps = stored.scene, []
    registry = scene.known_plugins()
    solids = bodies_of(scene, registry)
    deep = [getattr(solid, "deep_material", solid) for solid in solids]
    prescribed, inhomogeneities = build_sources(scene, registry, None if _sized(scene) else _grid(stored), deep)
    bodies = []
    for number, solid in enumerate(solids, 1):
        if solid is None:
            continue
        material = deep[number - 1]
        assert isinstance(material, Material)
        try:
            bodies.append(_body(stored, registry, number, solid, material, prescribed, inhomogeneities))
        except NotJudged as problem:
            gaps.append(Gap(subject=stored.name, what=f"body {number}", reason=str(problem)))
    return tuple(bodies), gaps


def _sized(scene: Any) -> bool:
    return all(patch.size is not None for patch in scene.eigenstrain)


def _grid(stored: StoredStep) -> Any:
    from eigencontact.core.grid import Grid

    window = stored.window
    x, y = (0.5 * float(line[0] + line[-1]) for line in (window.x, window.y))
    return Grid(nx=window.x.size, ny=window.y.size, dx=window.cell[0], dy=window.cell[1], center=(x, y))


def _body(
    stored: StoredStep, registry: Registry, number: int, solid: Any, material: Any,
    prescribed: tuple[Source, ...], inhomogeneities: tuple[Inhomogeneity, ...],
) -> AuditedBody:  # fmt: skip
    if stored.scene.numerics.half_space != "exact":
        raise NotJudged(f'numerics.half-space = "{stored.scene.numerics.half_space}" is another body than a half-space')
    if stored.scene.numerics.boundary != "non-periodic":
        raise NotJudged('numerics.boundary = "periodic" is a body that repeats, and the elements have one')
    if material.poisson_ratio > _INCOMPRESSIBLE:
        raise NotJudged(f"Poisson's ratio is {material.poisson_ratio:g}, where displacement elements lock")
    own_law = _law_of_body(stored, registry, number, material)
    cells, damaged = _memory(stored, number, remembers=own_law or _yielding(inhomogeneities, number))
    others = [source for source in inhomogeneities if source.body == number and hasattr(source.shape, "key")]
    beside = stored.history.get(f"plastic_strain_beside_{number}")
    other_parts = None if beside is None else _tensor(np.nan_to_num(beside))
    cells = tuple(mean_of_parts(block, other_parts, others, own_law=own_law) for block in cells)
    smooth = tuple(_smooth(block, others, material, own_law=own_law) for block in cells)
    stress_errors = tuple(_difference(block, other, material) for block, other in zip(cells, smooth, strict=True))
    cells = smooth
    risen = _worn(stored, number) if inhomogeneities else None
    bulk, around = bulk_stress_of(stored, number), (material.young_modulus, material.poisson_ratio)
    parts: list[Part] = []
    regions: list[Region] = []
    for source in (one for one in prescribed if one.body == number):
        if source.field.uniform and source.layers is None and hasattr(source.shape, "key"):
            part = Part(shape=source.shape)
            regions.append(_region(part, _strain(source, stored.time)))
            if not source.exact:
                parts.append(part)
        else:
            cells += (_sampled(source, stored),)
    different = [one for one in inhomogeneities if one.body == number]
    for place, inhomogeneity in enumerate(different):
        later = tuple(other.shape for other in different[place + 1 :] if _meet(inhomogeneity.shape, other.shape))
        edges = stored.window.edges if risen is not None else None
        part = Part(shape=inhomogeneity.shape, later=later, worn=risen, edges=edges)
        young, nu = moduli_of(inhomogeneity.law, material)
        if not inhomogeneity.field.uniform:
            raise NotJudged(f"inclusion '{inhomogeneity.name}' has a prestrain that is not uniform")
        strain = _strain(inhomogeneity, stored.time) + eigenstrain_by_bulk(bulk, (young, nu), around)
        region = _region(part, strain)
        same = np.isclose(young, material.young_modulus, rtol=1e-9, atol=0) and np.isclose(
            nu, material.poisson_ratio, atol=0
        )
        if not (same and not np.any(region.eigenstrain)):
            regions.append(replace(region, young_modulus=young, poisson_ratio=nu))
        if not same:
            parts.append(part)
    if damaged and np.any(bulk):
        if parts:
            raise NotJudged("bulk stress acts on cells that have lost stiffness beside regions of other constants")
        cells = tuple(_under_bulk(block, strain_of(bulk, *around)) for block in cells)
    loaded = LoadedBody(
        young_modulus=material.young_modulus, poisson_ratio=material.poisson_ratio,
        layers=_layers(stored, number, solid), regions=tuple(regions), cells=cells,
    )  # fmt: skip
    cell, box = _lattice(stored, number)
    cell = cell if box is not None or not parts else _cell_of(stored, parts)
    along = ("u_x", "u_y", "u_z") if stored.scene.friction is not None else ("u_z",)
    return AuditedBody(
        number=number, loaded=loaded, different=tuple(parts), cell=cell, box=box, damaged=damaged,
        means=along if box is not None and stored.scene.geometry else (), stress_errors=stress_errors, bulk=bulk,
    )  # fmt: skip


def _law_of_body(stored: StoredStep, registry: Registry, number: int, material: Any) -> bool:
    """Whether the body has a law that remembers; refuses one whose elasticity is not that of the body."""
    from eigencontact.model.sources import build_law

    table = (stored.scene.body1, stored.scene.body2)[number - 1].law
    if table is None:
        return False
    law = build_law(registry, table, f"body{number}.law", material)
    if law.varies:  # the constants of a body are its own, whatever yields in it
        return True
    constants = material.young_modulus, material.poisson_ratio
    if not np.allclose(moduli_of(law, material), constants, atol=0):
        raise NotJudged(f"the law {law.key!r} of the body has other elastic constants than the body")
    return bool(law.variables)


def _yielding(inhomogeneities: tuple[Inhomogeneity, ...], number: int) -> bool:
    return any(one.body == number and one.law.variables for one in inhomogeneities)


def _memory(stored: StoredStep, number: int, *, remembers: bool) -> tuple[tuple[Cells, ...], bool]:
    """Plastic strain and damage of the cells of a body, and whether there is damage."""
    if not remembers:
        return (), False
    quiet = all(stored.scalars.get(name, 0.0) == 0.0 for name in ("max_plastic_strain", "max_damage"))
    if stored.step not in stored.histories:
        if quiet and "max_plastic_strain" in stored.scalars:
            return (), False
        kept = ", ".join(str(step) for step in stored.histories) or "none"
        raise NotJudged(
            f"what the body remembers after step {stored.step} is not stored (stored: {kept}); "
            'run with output.history = "all"'
        )
    strain, damage = stored.history.get(f"plastic_strain_{number}"), stored.history.get(f"damage_{number}")
    if strain is None and damage is None:
        return (), False
    shape = (strain[0] if strain is not None else damage).shape  # type: ignore[union-attr]
    tensor = np.zeros((3, 3, *shape)) if strain is None else _tensor(np.nan_to_num(strain))
    left = None if damage is None else 1.0 - np.nan_to_num(damage)
    if left is not None and not np.any(left < 1.0):
        left = None
    x, y, z = (_edges(line) for line in stored.lattices[number])
    z[0] = 0.0 if abs(z[0]) < 1e-6 * z[-1] else z[0]
    return (Cells(x=x, y=y, z=z, eigenstrain=tensor, kept=left),), left is not None


def _smooth(block: Cells, sources: list[Inhomogeneity], material: Any, *, own_law: bool) -> Cells:
    """Cells of uniform strain that act as the smooth field with the stored strain at their centres.

    A law answers at the centre of its cell. A block of the strain of its centre acts as a field that is smoothed over
    the edges of the cell; its second differences undo that to second order. Cells that a boundary cuts keep their
    strain, and so do cells of laws with other elastic constants.
    """
    sides = np.meshgrid(block.z, block.y, block.x, indexing="ij")
    corner_law = np.full(sides[0].shape, int(own_law))
    for number, source in enumerate(sources, 2):
        constants = material.young_modulus, material.poisson_ratio
        same = bool(source.law.variables) and not source.law.varies
        alike = same and np.allclose(moduli_of(source.law, material), constants, atol=0)
        inside = source.shape.contains(sides[2], sides[1], sides[0])
        corner_law[inside] = number if alike else 0
    windows = np.lib.stride_tricks.sliding_window_view(corner_law, (2, 2, 2)).reshape(
        *(n - 1 for n in corner_law.shape), 8
    )
    law = np.where(windows.min(axis=-1) == windows.max(axis=-1), windows[..., 0], 0)
    strain = block.eigenstrain.copy()
    for axis in range(3):
        first, second = np.moveaxis(law, axis, 0)[:-1], np.moveaxis(law, axis, 0)[1:]
        difference = np.diff(np.moveaxis(block.eigenstrain, axis + 2, 0), axis=0)
        flow = np.where(((first == second) & (first > 0))[:, None, None], difference, 0.0) / 24.0
        moved = np.moveaxis(strain, axis + 2, 0)
        moved[:-1] -= flow
        moved[1:] += flow
    return replace(block, eigenstrain=strain)


def _difference(block: Cells, smooth: Cells, material: Any) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Edges of cells, and the size of the stress of the difference of two strains in each, if it could not relax."""
    size = np.sqrt(((block.eigenstrain - smooth.eigenstrain) ** 2).sum(axis=(0, 1)))
    return block.x, block.y, block.z, material.young_modulus / (1.0 + material.poisson_ratio) * size


def _under_bulk(block: Cells, strain: FloatArray) -> Cells:
    """Cells with what damage adds to the strain (3, 3) of the bulk stress; see `bulk`."""
    if block.kept is None:
        return block
    added = strain[:, :, None, None, None] * (1.0 / block.kept - 1.0)
    return replace(block, eigenstrain=block.eigenstrain + added)


def _edges(middles: FloatArray) -> FloatArray:
    """Edges of cells of one size by their middles."""
    size = (middles[-1] - middles[0]) / (middles.size - 1) if middles.size > 1 else 2.0 * middles[0]
    return np.asarray(middles[0] + (np.arange(middles.size + 1) - 0.5) * size)


def _tensor(mandel: FloatArray) -> FloatArray:
    """Tensors ``(3, 3, ...)`` of Mandel vectors ``(6, ...)``: shear by the root of 2."""
    xx, yy, zz = mandel[:3]
    yz, xz, xy = mandel[3:] / np.sqrt(2.0)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _strain(source: Source, time: float) -> FloatArray:
    return _tensor(source.uniform_eigenstrain(time))


def _region(part: Part, eigenstrain: FloatArray) -> Region:
    return Region(contains=part, bounds=part.bounds, eigenstrain=eigenstrain)


def _meet(one: Any, other: Any) -> bool:
    """Whether the boxes of two shapes overlap."""
    (a, b), (c, d) = one.bounds, other.bounds
    return all(low < up and start < end for low, up, start, end in zip(c, b, a, d, strict=True))


def _sampled(source: Source, stored: StoredStep) -> Cells:
    """Eigenstrain that is not uniform, by its value in the middle of cells; a patch has the cells of the run."""
    low, high = (np.asarray(corner, dtype=float) for corner in source.shape.bounds)
    if hasattr(source.shape, "key"):
        lines = [np.linspace(low[axis], high[axis], _ACROSS + 1) for axis in range(3)]
    else:
        lines = []
        for axis, edges in enumerate(stored.window.edges):
            first, last = (int(np.argmin(np.abs(edges - corner[axis]))) for corner in (low, high))
            lines.append(edges[first : last + 1])
        lines.append(np.linspace(0.0, high[2], (source.layers or _PATCH_LAYERS) + 1))
    middles = [0.5 * (line[1:] + line[:-1]) for line in lines]
    z, y, x = np.meshgrid(middles[2], middles[1], middles[0], indexing="ij")
    field = source.field.eigenstrain(x.ravel(), y.ravel(), z.ravel(), stored.time)
    mandel = np.asarray(field, dtype=float).reshape(6, *z.shape)
    inside = np.asarray(source.shape.contains(x, y, z), dtype=bool)
    return _merged(lines[0], lines[1], lines[2], _tensor(np.where(inside, mandel, 0.0)))


def _merged(x: FloatArray, y: FloatArray, z: FloatArray, tensor: FloatArray) -> Cells:
    """Cells whose equal neighbours along x or y are one."""

    def kept(axis: int) -> BoolArray:
        jumps = np.any(np.diff(tensor, axis=axis) != 0.0, axis=tuple(k for k in range(tensor.ndim) if k != axis))
        return np.concatenate([[True], jumps])

    columns, rows = kept(4), kept(3)
    return Cells(
        x=np.append(x[:-1][columns], x[-1]), y=np.append(y[:-1][rows], y[-1]), z=z,
        eigenstrain=tensor[..., rows, :][..., columns],
    )  # fmt: skip


def _layers(stored: StoredStep, number: int, solid: Any) -> tuple[Layer, ...]:
    """Layers of a body, the uppermost thinner by what the kernels of the run had lost."""
    if not hasattr(solid, "interfaces"):
        return ()
    lost = stored.scalars.get(f"layer_lost_{number}", 0.0)
    tops, layers = (0.0, *solid.interfaces), []
    for place, (top, bottom) in enumerate(pairwise(tops)):
        first, second = (solid.material_at(at, side=side) for at, side in ((top, "below"), (bottom, "above")))
        if first != second:
            raise NotJudged(f"layer {place + 1} changes with depth, and the elements have layers of one material")
        if first.poisson_ratio > _INCOMPRESSIBLE:
            raise NotJudged(f"Poisson's ratio is {first.poisson_ratio:g} in layer {place + 1}, where elements lock")
        left = bottom - max(top, lost)
        if left > 0.0:
            layers.append(Layer(thickness=left, young_modulus=first.young_modulus, poisson_ratio=first.poisson_ratio))
    return tuple(layers)


def _worn(stored: StoredStep, number: int) -> FloatArray | None:
    """Depth that a body has lost when the step met it: that after the step before."""
    depth = stored.earlier.get(f"worn_depth_{number}")
    return depth if depth is not None and np.any(depth > 0.0) else None


def _lattice(stored: StoredStep, number: int) -> tuple[tuple[float, float, float], Any]:
    """Edges of the cells of a body, and their box."""
    if number not in stored.lattices:
        return (0.0, 0.0, 0.0), None
    lines = [_edges(line) for line in stored.lattices[number]]
    sizes = tuple(float(line[1] - line[0]) for line in lines)
    return sizes, (tuple(float(line[0]) for line in lines), tuple(float(line[-1]) for line in lines))  # type: ignore[return-value]


def _cell_of(stored: StoredStep, parts: list[Part]) -> tuple[float, float, float]:
    """Edges of the cells of shapes without a closed form: those of the window, and a part of the thinnest in depth."""
    thin = min(part.bounds[1][2] - part.bounds[0][2] for part in parts)
    numerics = stored.scene.numerics
    return (*stored.window.cell, numerics.inclusion_pitch or thin / numerics.inclusion_cells)


def tractions_on(stored: StoredStep, number: int) -> Tractions | None:
    """Stored tractions as they act on a body, whose z points into it; None where there are none.

    Pressure pushes either body along its own z; shear is stored as it acts on body 1, and acts on body 2 the other way.
    """
    shape = (stored.window.y.size, stored.window.x.size)
    values = np.zeros((3, *shape))
    side = 1.0 if number == 1 else -1.0
    for row, (name, sign) in enumerate((("shear_x", side), ("shear_y", side), ("pressure", 1.0))):
        if name in stored.surface:
            values[row] = sign * np.nan_to_num(stored.surface[name])
    loaded = np.any(values != 0.0, axis=0)
    if not loaded.any():
        return None
    rows, columns = (np.flatnonzero(loaded.any(axis=axis)) for axis in (1, 0))
    x, y = stored.window.edges
    span = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    return Tractions(x=x[columns[0] : columns[-1] + 2], y=y[rows[0] : rows[-1] + 2], values=values[:, span[0], span[1]])
