"""Bodies of a stored step as finite elements take them, and the reasons why they cannot represent a body."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.body_cells import (
    cell_of_shapes,
    lattice_of,
    sampled,
    smooth_cells,
    stored_cells,
    stress_differences,
    tensor_of,
    under_bulk,
)
from eigencontact_verification.audit.bulk import bulk_stress_of, eigenstrain_by_bulk, strain_of
from eigencontact_verification.audit.moduli import NotJudged, moduli_of
from eigencontact_verification.audit.shape_region import ShapeRegion, shapes_meet
from eigencontact_verification.audit.shares import mean_of_parts
from eigencontact_verification.crosscheck.case import Gap
from eigencontact_verification.fem.loaded_body import LoadedBody, Tractions
from eigencontact_verification.fem.model import Layer, Region

if TYPE_CHECKING:
    from eigencontact.hooks.registry import Registry
    from eigencontact.model.sources import Inhomogeneity, Source
    from eigencontact_verification.audit.stored import StoredStep

__all__ = ["AuditedBody", "NotJudged", "ShapeRegion", "bodies_of_step", "moduli_of", "tractions_on"]

FloatArray = NDArray[np.float64]

#: Poisson's ratio from which displacement elements lock.
_INCOMPRESSIBLE = 0.495


@dataclass(frozen=True, kw_only=True, eq=False)
class AuditedBody:
    """A deformable body of a step.

    Attributes
    ----------
    number : int
        1 or 2.
    loaded : LoadedBody
        Without tractions, which `tractions_on` gives.
    different : tuple of ShapeRegion
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
    different: tuple[ShapeRegion, ...] = ()
    cell: tuple[float, float, float] = (0.0, 0.0, 0.0)
    box: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    damaged: bool = False
    means: tuple[str, ...] = ()
    stress_errors: tuple[tuple[FloatArray, FloatArray, FloatArray, FloatArray], ...] = ()
    bulk: FloatArray = field(default_factory=lambda: np.zeros((3, 3)))


def bodies_of_step(stored: StoredStep) -> tuple[tuple[AuditedBody, ...], list[Gap]]:
    """Deformable bodies of a step, and the gaps of the comparison.

    Bodies that the finite elements cannot represent are left out, with all results that depend on them.
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
        raise NotJudged(f'numerics.half-space is "{stored.scene.numerics.half_space}", and the elements need "exact"')
    if stored.scene.numerics.boundary != "non-periodic":
        raise NotJudged(
            f'numerics.boundary is "{stored.scene.numerics.boundary}", and the elements need "non-periodic"'
        )
    if material.poisson_ratio > _INCOMPRESSIBLE:
        raise NotJudged(
            f"Poisson's ratio is {material.poisson_ratio:g}, and the elements lock above {_INCOMPRESSIBLE:g}"
        )
    inelastic = _law_of_body(stored, registry, number, material)
    cells, damaged = stored_cells(stored, number, remembers=inelastic or _yielding(inhomogeneities, number))
    shaped = [source for source in inhomogeneities if source.body == number and hasattr(source.shape, "key")]
    beside = stored.history.get(f"plastic_strain_beside_{number}")
    strain_beside = None if beside is None else tensor_of(np.nan_to_num(beside))
    blocks = [mean_of_parts(block, strain_beside, shaped, own_law=inelastic) for block in cells]
    cells = tuple(smooth_cells(block, shaped, material, own_law=inelastic) for block in blocks)
    stress_errors = tuple(
        stress_differences(block, smooth, material) for block, smooth in zip(blocks, cells, strict=True)
    )
    worn_depth = _worn(stored, number) if inhomogeneities else None
    bulk, around = bulk_stress_of(stored, number), (material.young_modulus, material.poisson_ratio)
    different: list[ShapeRegion] = []
    regions: list[Region] = []
    for source in (source for source in prescribed if source.body == number):
        if source.field.uniform and source.layers is None and hasattr(source.shape, "key"):
            place = ShapeRegion(shape=source.shape)
            regions.append(place.with_eigenstrain(_strain(source, stored.time)))
            if not source.exact:
                different.append(place)
        else:
            cells += (sampled(source, stored),)
    inclusions = [source for source in inhomogeneities if source.body == number]
    for index, inhomogeneity in enumerate(inclusions):
        shape = inhomogeneity.shape
        later = tuple(source.shape for source in inclusions[index + 1 :] if shapes_meet(shape, source.shape))
        edges = stored.window.edges if worn_depth is not None else None
        place = ShapeRegion(shape=shape, later=later, worn=worn_depth, edges=edges)
        young, nu = moduli_of(inhomogeneity.law, material)
        if not inhomogeneity.field.uniform:
            raise NotJudged(
                f"the prestrain of {inhomogeneity.name!r} varies in space, and the elements need uniform ones"
            )
        strain = _strain(inhomogeneity, stored.time) + eigenstrain_by_bulk(bulk, (young, nu), around)
        region = place.with_eigenstrain(strain)
        unchanged = np.isclose(young, material.young_modulus, rtol=1e-9, atol=0) and np.isclose(
            nu, material.poisson_ratio, atol=0
        )
        if not (unchanged and not np.any(region.eigenstrain)):
            regions.append(replace(region, young_modulus=young, poisson_ratio=nu))
        if not unchanged:
            different.append(place)
    if damaged and np.any(bulk):
        if different:
            raise NotJudged("bulk stress acts on damaged cells beside inclusions, and the elements take one of the two")
        cells = tuple(under_bulk(block, strain_of(bulk, *around)) for block in cells)
    loaded = LoadedBody(
        young_modulus=material.young_modulus, poisson_ratio=material.poisson_ratio,
        layers=_layers(stored, number, solid), regions=tuple(regions), cells=cells,
    )  # fmt: skip
    cell, box = lattice_of(stored, number)
    cell = cell if box is not None or not different else cell_of_shapes(stored, different)
    along = ("u_x", "u_y", "u_z") if stored.scene.friction is not None else ("u_z",)
    return AuditedBody(
        number=number, loaded=loaded, different=tuple(different), cell=cell, box=box, damaged=damaged,
        means=along if box is not None and stored.scene.geometry else (), stress_errors=stress_errors, bulk=bulk,
    )  # fmt: skip


def _law_of_body(stored: StoredStep, registry: Registry, number: int, material: Any) -> bool:
    """Whether the law of the body has state variables; a law with other elastic constants is refused."""
    from eigencontact.model.sources import build_law

    table = (stored.scene.body1, stored.scene.body2)[number - 1].law
    if table is None:
        return False
    law = build_law(registry, table, f"body{number}.law", material)
    if law.varies:  # the elastic constants of the body itself do not vary
        return True
    constants = material.young_modulus, material.poisson_ratio
    if not np.allclose(moduli_of(law, material), constants, atol=0):
        raise NotJudged(f"the law {law.key!r} and its body have different elastic constants")
    return bool(law.variables)


def _yielding(inhomogeneities: tuple[Inhomogeneity, ...], number: int) -> bool:
    return any(source.body == number and source.law.variables for source in inhomogeneities)


def _strain(source: Source, time: float) -> FloatArray:
    return tensor_of(source.uniform_eigenstrain(time))


def _layers(stored: StoredStep, number: int, solid: Any) -> tuple[Layer, ...]:
    """Layers of a body; the uppermost has the thickness that the kernels of the run had."""
    if not hasattr(solid, "interfaces"):
        return ()
    worn = stored.scalars.get(f"layer_lost_{number}", 0.0)
    tops, layers = (0.0, *solid.interfaces), []
    for place, (top, bottom) in enumerate(pairwise(tops)):
        first, second = (solid.material_at(at, side=side) for at, side in ((top, "below"), (bottom, "above")))
        if first != second:
            raise NotJudged(
                f"the constants of layer {place + 1} change with depth, and the elements need uniform layers"
            )
        if first.poisson_ratio > _INCOMPRESSIBLE:
            raise NotJudged(
                f"Poisson's ratio is {first.poisson_ratio:g} in layer {place + 1}, and the elements lock above "
                f"{_INCOMPRESSIBLE:g}"
            )
        thickness = bottom - max(top, worn)
        if thickness > 0.0:
            layers.append(
                Layer(thickness=thickness, young_modulus=first.young_modulus, poisson_ratio=first.poisson_ratio)
            )
    return tuple(layers)


def _worn(stored: StoredStep, number: int) -> FloatArray | None:
    """Worn depth of a body before the step; None without wear."""
    depth = stored.earlier.get(f"worn_depth_{number}")
    return depth if depth is not None and np.any(depth > 0.0) else None


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
