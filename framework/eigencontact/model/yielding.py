"""Bodies with their own law near the contact: the box of cells in which the law may exceed its elastic range.

The search computes the elastic stress by the tractions of coarse contacts at all places that may matter. It asks the
law whether the strain of that stress gives the same stress. A box that proves too small grows
(`eigencontact.model.growth`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.bulk import bulk_of, in_plane_strain, plane_stress
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.core.tensors import von_mises
from eigencontact.core.units import readable
from eigencontact.errors import EigencontactError, NotUnique, SceneError, require
from eigencontact.hooks.registry import Registry
from eigencontact.model.bodies import Bodies
from eigencontact.model.contact_window import contacts_of_steps
from eigencontact.model.initial import InitialState
from eigencontact.model.interface import Interface
from eigencontact.model.sizes import BYTES_OF_LAW_CELL, most, refuse_more
from eigencontact.model.sources import Inhomogeneity, Patch, Source
from eigencontact.plugin import ConstitutiveLaw, FrictionLaw, FrictionState, InclusionShape, LawStep, SurfaceInfluence
from eigencontact.scene.components import build_component
from eigencontact.scene.holding import held_bulk
from eigencontact.scene.schema import Scene
from eigencontact.scene.steps import named_ramps
from eigencontact.solvers.cell_conditions import compliance
from eigencontact.solvers.coarse_contact import coarse_contact
from eigencontact.solvers.elastic_zone import ACROSS, ElasticStress, Tractions, elastic_zone, overload

__all__ = ["SAFETY", "YieldingBody", "yielding_bodies"]

_Bounds = tuple[FloatArray, FloatArray]

#: Stress that is tried, as a multiple of the elastic one: the coarse contact errs by some 3 %.
SAFETY = 1.1
#: The same beside inclusions and eigenstrain, one after another until a place is found: stress next to a void or to a
#: hard ball is up to three times that far from it. The box grows from there.
_BESIDE = (1.1, 1.5, 2.0, 3.0)
#: A law that answers another stress than this close to the elastic one is not elastic there.
_ELASTIC_TOLERANCE = 1e-6
#: Depths at which bulk stress alone must leave a law elastic, in sizes of the window.
_DEPTHS = np.concatenate([[0.0], np.geomspace(1e-3, 10.0, 64)])
#: Room below a zone, in its heights, that whole layers of cells fill together with it.
_ROOM_OF_LAYERS = 0.25
#: Words in the names of such limits.
_LIMITS = ("stress", "strength", "threshold")
#: Stress at which a law must have the constants of its body, in parts of Young's modulus: the second for a law that is
#: beyond its limit at the first.
_SMALL = (1e-9, 1e-15)


@dataclass(frozen=True, kw_only=True)
class YieldingBody(Inhomogeneity):
    """Cells of a body's own law, where it may exceed its elastic range.

    Attributes
    ----------
    deep : float
        Depth [m] filled by whole layers of cells, independent of `numerics.law-room`; 0 for the depth of the box.
    """

    guessed: ClassVar[bool] = True
    deep: float

    @property
    def layered(self) -> tuple[float, float]:
        """See `Inhomogeneity.layered`."""
        return 0.0, self.deep or self.shape.bounds[1][2]

    @property
    def how(self) -> str:
        """See `Source.how`."""
        assert self.lattice is not None
        nz, ny, nx = self.lattice.shape
        return f"{nx} x {ny} x {nz} cells of {self.law.words}, where elastic stress reaches its limit, and around"


def yielding_bodies(
    scene: Scene,
    registry: Registry,
    bodies: Bodies,
    interface: Interface,
    grid: Grid,
    sources: Sequence[Source],
    initial: Mapping[int, InitialState],
) -> tuple[YieldingBody, ...]:
    """Boxes of the bodies with a law; a body whose law remains elastic has none.

    The box also holds those `sources` of its body that stand in enough stress, and the cells of an `initial` state.
    Prior stress that alone exceeds the limit of the law, far from the contact, is not searched for.
    """
    boxes = []
    for body, law in bodies.laws.items():
        where, influences = f"body{body}.law", interface.influences
        contacts = _coarse_contacts(scene, interface, grid)
        loads = _distinct([(at, load) for at, p in contacts for load in _loads(at, p, influences, interface.friction)])
        shapes = [source.shape for source in sources if source.body == body]
        material = bodies.half_space(body)
        trial = _Trial(law, material, where, _bulk_stresses(scene, body, material, grid))
        trial.refuse_bulk(_DEPTHS * max(grid.size))
        patch, deep = _box_where(trial, loads, influences, shapes, scene, grid)
        if body in initial:
            patch = _with(patch, initial[body].bounds(grid))
        if patch is not None:
            field = build_component(registry, "eigenstrain-field", {"type": "uniform", "value": 0.0}, where)
            name = f"body {body}"
            boxes.append(
                YieldingBody(
                    name=name, where=where, key=law.key, body=body, shape=patch, field=field, law=law, deep=deep
                )
            )
    return tuple(boxes)


def _bulk_stresses(scene: Scene, body: int, material: Material, grid: Grid) -> list[FloatArray]:
    """Mandel bulk stresses ``(6,)`` [Pa] of a body before the first step and at the end of each, each once."""
    at_rest = scene.bulk_at_rest
    history = [at_rest, *held_bulk([ramp for _, ramp in named_ramps(scene.steps, again=True)], at_rest)]
    distinct = np.unique([bulk_of(values, body) for values in history], axis=0)
    return [plane_stress(in_plane_strain(stress, material, grid), material) for stress in distinct]


@dataclass(frozen=True, slots=True)
class _Trial:
    """Elastic range of the law of an undeformed body.

    Attributes
    ----------
    law, material
    where : str
        Table of the law, for messages.
    bulk : sequence of (6,)
        Bulk stresses [Pa] of the history, each different, that add to those of the contact; one of zeros without.
    """

    law: ConstitutiveLaw
    material: Material
    where: str
    bulk: Sequence[FloatArray] = (np.zeros(6),)

    def yields(self, stress: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether the stress of the law differs from elastic stress ``(6, n)`` [Pa] at depths ``(n,)`` [m].

        Raises
        ------
        SceneError
            It has elastic constants other than the body.
        """
        self._require_constants(np.unique(z))
        reached = [self._differs(stress + bulk[:, None], z) for bulk in self.bulk]
        return np.asarray(np.any(reached, axis=0))

    def refuse_bulk(self, depths: FloatArray) -> None:
        """Refuse a bulk stress that alone exceeds the elastic range at some of these depths ``(n,)`` [m].

        Raises
        ------
        SceneError
            Names the stress and the depth.
        """
        for bulk in self.bulk:
            if not bulk.any():
                continue
            reached = self._differs(np.repeat(bulk[:, None], depths.size, axis=1), depths)
            if reached.any():
                mises = readable(float(von_mises(bulk)), "Pa")
                raise SceneError(
                    f"body{self.where[4]}.bulk-stress, also of steps, must be within the elastic range of the law (got "
                    f"a von Mises stress of {mises}, beyond the range of {self.law.key!r} at a depth of "
                    f"{depths[np.argmax(reached)]:g} m), because the body is elastic outside the cells; reduce it"
                )

    def _require_constants(self, depths: FloatArray) -> None:
        stress = self.material.young_modulus * np.random.default_rng(0).standard_normal((6, 8))
        z = np.repeat(depths, stress.shape[1])
        for scale in _SMALL:
            differs = self._differs(np.tile(scale * stress, depths.size), z)
            if not differs.any():
                return
        rule = f"of a law with the elastic constants of body {self.where[4]}: remove the constants from the law"
        got = f"{self.law.key!r}, with other constants at a depth of {z[np.argmax(differs)]:g} m"
        require(False, self.where, "type", got, rule)

    def _differs(self, stress: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        count = stress.shape[1]
        before = {name: np.zeros((variable.components, count)) for name, variable in self.law.variables.items()}
        step: Any = LawStep(x=np.zeros(count), y=np.zeros(count), z=z, time=1.0, duration=1.0)
        size: FloatArray = np.linalg.norm(stress, axis=0)
        try:
            answer = np.asarray(self.law.update(compliance(self.material) @ stress, before, step).stress)
        except NotUnique as problem:
            # Points that soften too fast are more than elastic; the other points are tried again.
            out = np.isin(np.arange(count), problem.points)
            if not out.any():
                return self._by_depth(stress, z)
            out[~out] = self._differs(stress[:, ~out], z[~out])
            return out
        except EigencontactError:
            return self._by_depth(stress, z)
        return np.asarray(np.linalg.norm(answer - stress, axis=0) > _ELASTIC_TOLERANCE * size, dtype=bool)

    def _by_depth(self, stress: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Test each depth separately if the law refuses all points together; a refused depth counts as inelastic."""
        depths = np.unique(z)
        out = np.asarray(np.linalg.norm(stress, axis=0) > 0.0)
        if depths.size > 1:
            for depth in depths:
                at_depth = z == depth
                out[at_depth] = self._differs(stress[:, at_depth], z[at_depth])
        return out


def _box_where(
    trial: _Trial,
    loads: Sequence[Tractions],
    influences: Mapping[str, SurfaceInfluence],
    beside: Sequence[InclusionShape | Patch],
    scene: Scene,
    grid: Grid,
) -> tuple[Patch | None, float]:
    """Box around all points where a load exceeds the elastic range of a law, and the depth for its layers [m].

    There is no box if there are no such points.

    Raises
    ------
    SceneError
        The zone is larger than the search looks, or than this machine's memory holds cells.
    """
    elastic = ElasticStress(influences, trial.material)

    def bounds(factor: float, *, closed: bool) -> _Bounds | None:
        zones = []
        for load in loads:
            zone = elastic_zone(trial.yields, load, elastic, factor)
            if zone is not None:
                if closed and not zone.closed:
                    got, advice = _pressed(trial, load, elastic, scene)
                    sides = (zone.high - zone.low)[list(grid.bounded_axes)]
                    got += f"the plastic zone is larger than {_sizes(*sides)}"
                    raise SceneError(f"{trial.where} must yield only near the contact (got {got}); {advice}")
                zones.append((zone.low, zone.high))
        return _around(zones)

    tried = (bounds(factor, closed=True) for factor in (_BESIDE if beside else [SAFETY]))
    box = next((around for around in tried if around is not None), None)
    if box is None:
        return None, 0.0
    if beside:
        far = bounds(_BESIDE[-1], closed=False) or box
        box = _around([box, *(clipped for shape in beside if (clipped := _clipped_bounds(shape, far)))]) or box
    low, high = box
    margin, bounded = np.zeros(3), list(grid.bounded_axes)
    margin[bounded] = scene.numerics.law_room * (high - low)[bounded] + max(trial.law.averaged.values(), default=0.0)
    (x0, y0, _), (x1, y1, depth) = low - margin, high + margin
    cells = (x1 - x0) * (y1 - y0) * depth / (grid.dx * grid.dy * min(grid.edges))
    if scene.numerics.inclusion_pitch is None and cells > most(BYTES_OF_LAW_CELL):
        hardest = max(loads, key=lambda load: float(load[1]["p"].max()))
        got, advice = _pressed(trial, hardest, elastic, scene)
        got += f"the plastic zone with its margin measures {_sizes(x1 - x0, y1 - y0, depth)}"
        advice += ", use a coarser grid or reduce numerics.law-room"
        refuse_more(cells, trial.where, "cells inside a body", got, advice, BYTES_OF_LAW_CELL)
    deep = float(depth + (_ROOM_OF_LAYERS - scene.numerics.law_room) * (high - low)[2])
    return Patch(((float(x0), float(y0), 0.0), (float(x1), float(y1), float(depth)))), deep


def _pressed(trial: _Trial, load: Tractions, elastic: ElasticStress, scene: Scene) -> tuple[str, str]:
    """Ratio of a load to the elastic limit of a law, in words, and advice to check units."""
    ratio = overload(trial.yields, load, elastic)
    table = getattr(scene, trial.where.split(".")[0]).law
    limits = ", ".join(f"{name} = {value!r}" for name, value in _limits(table)) or "the limits of the law"
    return (
        f"an elastic stress of {ratio:.2g} times the yield stress or other limit: ",
        f"check the unit of {limits} (a stress without a unit is in Pa), reduce the load",
    )


def _sizes(*sides: float) -> str:
    return " x ".join(readable(float(f"{side:.3g}"), "m") for side in sides)


def _limits(table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Keys and values of stress or strain limits of the elastic range in a law's table."""
    for name, value in table.items():
        nested = value if isinstance(value, list | tuple) else [value]
        if any(word in name for word in _LIMITS):
            yield name.replace("_", "-"), value
        for item in nested:
            if isinstance(item, Mapping):
                yield from _limits(item)


def _with(patch: Patch | None, zone: _Bounds) -> Patch:
    """Patch enlarged to contain other bounds."""
    bounds = [] if patch is None else [tuple(np.asarray(corner, dtype=float) for corner in patch.bounds)]
    corners = np.array([*bounds, zone])
    low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
    return Patch(((float(low[0]), float(low[1]), 0.0), (float(high[0]), float(high[1]), float(high[2]))))


def _around(zones: Sequence[_Bounds]) -> _Bounds | None:
    """Bounds of all zones; None without any."""
    if not zones:
        return None
    return np.min([low for low, _ in zones], axis=0), np.max([high for _, high in zones], axis=0)


def _clipped_bounds(shape: InclusionShape | Patch, far: _Bounds) -> _Bounds | None:
    """Bounds of a region, restricted to those of a zone; None outside. The edges of wider layers cause errors."""
    low, high = (np.asarray(corner, dtype=float) for corner in shape.bounds)
    low, high = np.maximum(low, far[0]), np.minimum(high, far[1])
    return (low, high) if np.all(low < high) else None


def _coarse_contacts(scene: Scene, interface: Interface, grid: Grid) -> Iterator[tuple[Grid, FloatArray]]:
    """Window and pressure [Pa] of the contact at the end of each step, with about `ACROSS` cells across it."""
    normal, periodic = interface.normal, scene.numerics.boundary == "periodic"
    for contact, control, separation in dict.fromkeys(contacts_of_steps(scene, grid, interface)):
        edge = max(min(contact.extent) / ACROSS, max(contact.extent) / (4 * ACROSS))
        nx, ny = (int(np.ceil(1.5 * extent / edge)) for extent in contact.extent)
        center = (0.5 * (contact.x0 + contact.x1), 0.5 * (contact.y0 + contact.y1))
        window = grid.with_cells(nx, ny, edge, edge, center)
        # A periodic contact that nearly fills its window is solved in all of it.
        whole = periodic and max(a / b for a, b in zip(window.sides, grid.sides, strict=True)) > 1.0
        place = grid if whole else window
        solution = coarse_contact(place, separation, normal, control, periodic=whole, cells=6 * ACROSS)
        # Without convergence, the largest pressure everywhere is on the safe side.
        yield solution if solution is not None else (window, np.full(window.shape, contact.peak))


def _loads(
    window: Grid, pressure: FloatArray, influences: Mapping[str, SurfaceInfluence], friction: FrictionLaw | None
) -> Iterator[dict[str, FloatArray]]:
    """Pressure only, and with friction the pressure with the largest shear along each axis in both directions."""
    yield {"p": pressure}
    if friction is None:
        return
    y, x = window.axes()
    state = FrictionState(pressure=pressure, x=x, y=y, slip_distance=np.zeros_like(pressure), time=1.0)
    bound = np.asarray(friction.shear_bound(state))
    for name in ("q_x", "q_y"):
        if name in influences:
            for sign in (1.0, -1.0):
                yield {"p": pressure, name: sign * np.where(pressure > 0, bound, 0.0)}


def _distinct(loads: Sequence[Tractions]) -> list[Tractions]:
    """Loads without duplicates, for example of a cycle."""
    keys = ((window, *((name, field.tobytes()) for name, field in fields.items())) for window, fields in loads)
    return list(dict(zip(keys, loads, strict=True)).values())
