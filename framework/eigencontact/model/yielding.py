"""Bodies that obey a law of their own near the contact: the box of cells in which that law may be more than elastic.

The box is found by asking the law: elastic stress by the tractions of coarse contacts, at all places that may matter,
and whether the law would bear the strain of that stress with that stress. A box that proves too small grows
(`eigencontact.model.growth`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from eigencontact.core.grid import Box, Grid
from eigencontact.core.material import Material
from eigencontact.core.tensors import COMPONENTS, SQRT2
from eigencontact.core.units import readable
from eigencontact.errors import EigencontactError, NotUnique, SceneError, require
from eigencontact.hooks.registry import Registry
from eigencontact.model.contact_window import contacts_of_steps
from eigencontact.model.initial import InitialState
from eigencontact.model.kernels import Bodies, PairCoefficients
from eigencontact.model.sources import Inhomogeneity, Patch, Source, build_law
from eigencontact.model.window import coarse_contact
from eigencontact.plugin import (
    ConstitutiveLaw,
    FrictionLaw,
    FrictionState,
    Geometry,
    InclusionShape,
    LawStep,
    SurfaceInfluence,
)
from eigencontact.scene.components import build_component
from eigencontact.scene.schema import Scene
from eigencontact.solvers.cell_conditions import compliance

__all__ = ["SAFETY", "YieldingBody", "laws_of_bodies", "yielding_bodies"]

FloatArray = NDArray[np.float64]
_Bounds = tuple[FloatArray, FloatArray]

#: Coarse cells across a contact, and times that the box that is searched may be doubled.
_ACROSS, _DOUBLINGS = 16, 5
#: Points about which a law is asked at once, where a depth does not have more [points].
_AT_ONCE = 1 << 15
#: Elastic stress that is kept at most, of all loads together [bytes].
_KEPT = 100_000_000
#: Stress that is tried, as a multiple of the elastic one: the coarse contact errs by some 3 %.
SAFETY = 1.1
#: The same beside inclusions and eigenstrain, one after another until a place is found: stress next to a void or to a
#: hard ball is up to three times that far from it. The box grows from there.
_BESIDE = (1.1, 1.5, 2.0, 3.0)
#: A law that answers another stress than this close to the elastic one is not elastic there.
_SAME = 1e-6


@dataclass(frozen=True, kw_only=True)
class YieldingBody(Inhomogeneity):
    """Cells of a body's own law, where it may be more than elastic."""

    guessed: ClassVar[bool] = True

    @property
    def how(self) -> str:
        """See `Source.how`."""
        assert self.lattice is not None
        nz, ny, nx = self.lattice.shape
        return f"{nx} x {ny} x {nz} cells of {self.law.words}, where elastic stress reaches its limit, and around"


def laws_of_bodies(scene: Scene, registry: Registry, bodies: Bodies) -> dict[int, ConstitutiveLaw]:
    """Laws of the bodies that have one, by body.

    Raises
    ------
    SceneError, PluginError
        A law that is refused, or that is elastic; a scene without contact.
    """
    found = {}
    for number, table in ((1, scene.body1.law), (2, scene.body2.law)):
        if table is not None:
            where, material = f"body{number}.law", bodies[number - 1]
            assert isinstance(material, Material)
            found[number] = build_law(registry, table, where, material)
            _refuse(found[number], scene, where)
    return found


def yielding_bodies(
    laws: Mapping[int, ConstitutiveLaw],
    scene: Scene,
    registry: Registry,
    bodies: Bodies,
    geometries: tuple[Geometry, ...],
    influences: Mapping[str, SurfaceInfluence],
    friction: FrictionLaw | None,
    grid: Grid,
    sources: Sequence[Source],
    initial: Mapping[int, InitialState],
) -> tuple[YieldingBody, ...]:
    """Boxes of the bodies with a law; none of a body that stays elastic, which then is an elastic one.

    Beside the `sources` of a body the box holds those that stand in stress enough, and the cells of an `initial` state.
    Prior stress that alone is beyond the limit of the law, far from the contact, is not looked for.
    """
    found = []
    for number, law in laws.items():
        where, material = f"body{number}.law", bodies[number - 1]
        assert isinstance(material, Material)
        loads = [
            (window, fields)
            for window, pressure in _coarse_contacts(scene, bodies, geometries, influences["p"], grid)
            for fields in _loads(window, pressure, influences, friction)
        ]
        beside = [source.shape for source in sources if source.body == number]
        patch = _box_where(_Trial(law, material, where), loads, influences, beside, scene.numerics.law_room)
        if number in initial:
            patch = _with(patch, initial[number].bounds(grid))
        if patch is not None:
            field = build_component(registry, "eigenstrain-field", {"type": "uniform", "value": 0.0}, where)
            name = f"body {number}"
            found.append(
                YieldingBody(name=name, where=where, key=law.key, body=number, shape=patch, field=field, law=law)
            )
    return tuple(found)


def _refuse(law: ConstitutiveLaw, scene: Scene, where: str) -> None:
    """Refuse laws and scenes that a body cannot have."""
    rule = "of a material that yields or degrades: one that is elastic has young-modulus and poisson-ratio"
    require(not law.linear, where, "type", law.key, rule)
    if not scene.geometry:
        raise SceneError(
            f"{where} must be left out without a contact (got {law.key!r}); give an inclusion with this material"
        )
    whole = scene.numerics.inclusion_resolution == "whole"
    require(not whole, where, "type", law.key, 'of a scene with numerics.inclusion-resolution = "cells"')


@dataclass(frozen=True, slots=True)
class _Trial:
    """Law of a body of some elastic constants, at rest, that is asked where it is elastic; `where` is for messages."""

    law: ConstitutiveLaw
    material: Material
    where: str

    def beyond(self, stress: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether the law answers the strain of elastic stress ``(6, n)`` [Pa] at depths ``(n,)`` [m] with another one.

        Raises
        ------
        SceneError
            It has elastic constants other than the body.
        """
        small = 1e-9 * self.material.young_modulus * np.random.default_rng(0).standard_normal((6, 8))
        depths = np.unique(z)
        asked = np.repeat(depths, small.shape[1])
        other = self._differs(np.tile(small, depths.size), asked)
        if other.any() and not self._differs(1e-9 * np.tile(small, depths.size), asked).any():
            limit = readable(1e-9 * self.material.young_modulus, "Pa")
            raise SceneError(
                f"{self.where} must stay elastic up to a stress of {limit}, 1e-9 of the Young modulus "
                f"(got {self.law.key!r}, which yields or degrades below it); check the unit of its yield stress"
            )
        rule = f"of a law that begins with the constants of body {self.where[4]}: leave out its own"
        got = f"{self.law.key!r}, with others at a depth of {asked[np.argmax(other)]:g} m"
        require(not other.any(), self.where, "type", got, rule)
        return self._differs(stress, z)

    def _differs(self, stress: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        count = stress.shape[1]
        before = {name: np.zeros((variable.components, count)) for name, variable in self.law.variables.items()}
        step: Any = LawStep(x=np.zeros(count), y=np.zeros(count), z=z, time=1.0, duration=1.0)
        size: FloatArray = np.linalg.norm(stress, axis=0)
        try:
            answer = np.asarray(self.law.update(compliance(self.material) @ stress, before, step).stress)
        except NotUnique as problem:
            # What softens too fast is more than elastic; the other points are asked again.
            out = np.isin(np.arange(count), problem.points)
            if not out.any():
                return self._by_depth(stress, z)
            out[~out] = self._differs(stress[:, ~out], z[~out])
            return out
        except EigencontactError:
            return self._by_depth(stress, z)
        return np.asarray(np.linalg.norm(answer - stress, axis=0) > _SAME * size, dtype=bool)

    def _by_depth(self, stress: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """The same of points that the law refused together: each depth alone; one refused is more than elastic."""
        depths = np.unique(z)
        out = np.asarray(np.linalg.norm(stress, axis=0) > 0.0)
        if depths.size > 1:
            for depth in depths:
                here = z == depth
                out[here] = self._differs(stress[:, here], z[here])
        return out


def _box_where(
    trial: _Trial,
    loads: Sequence[tuple[Grid, Mapping[str, FloatArray]]],
    influences: Mapping[str, SurfaceInfluence],
    beside: Sequence[InclusionShape | Patch],
    room: float,
) -> Patch | None:
    """Box around all places where a law is more than elastic under a load of the scene; None where it never is."""
    elastic = _ElasticStress(influences, trial.material)

    def bounds(factor: float) -> _Bounds | None:
        found = [_extent(trial, window, fields, elastic, factor) for window, fields in loads]
        return _around([one for one in found if one is not None])

    box = next((found for factor in (_BESIDE if beside else [SAFETY]) if (found := bounds(factor))), None)
    if box is None:
        return None
    if beside:
        far = bounds(_BESIDE[-1]) or box
        box = _around([box, *(held for shape in beside if (held := _held(shape, far)))]) or box
    low, high = box
    margin = room * (high - low)
    margin += max(trial.law.averaged.values(), default=0.0)
    (x0, y0, _), (x1, y1, depth) = low - margin, high + margin
    return Patch(((float(x0), float(y0), 0.0), (float(x1), float(y1), float(depth))))


def _with(patch: Patch | None, held: _Bounds) -> Patch:
    """Patch that holds other bounds too."""
    own = [] if patch is None else [tuple(np.asarray(corner, dtype=float) for corner in patch.bounds)]
    both = np.array([*own, held])
    low, high = both[:, 0].min(axis=0), both[:, 1].max(axis=0)
    return Patch(((float(low[0]), float(low[1]), 0.0), (float(high[0]), float(high[1]), float(high[2]))))


def _around(found: Sequence[_Bounds]) -> _Bounds | None:
    """Bounds of all; None of none."""
    if not found:
        return None
    return np.min([low for low, _ in found], axis=0), np.max([high for _, high in found], axis=0)


def _held(shape: InclusionShape | Patch, far: _Bounds) -> _Bounds | None:
    """Bounds of a region that lies in others, cut off there: one that is wider, as a layer, disturbs at its edges."""
    low, high = (np.asarray(corner, dtype=float) for corner in shape.bounds)
    low, high = np.maximum(low, far[0]), np.minimum(high, far[1])
    return (low, high) if np.all(low < high) else None


def _coarse_contacts(
    scene: Scene, bodies: Bodies, geometries: tuple[Geometry, ...], pressure: SurfaceInfluence, grid: Grid
) -> Iterator[tuple[Grid, FloatArray]]:
    """Window and pressure [Pa] of the contact at the end of each step, in some `_ACROSS` cells of its own."""
    normal, periodic = PairCoefficients(pressure, bodies, "z"), scene.numerics.boundary == "periodic"
    for contact, control, separation in contacts_of_steps(scene, grid, geometries, normal):
        edge = max(min(contact.extent) / _ACROSS, max(contact.extent) / (4 * _ACROSS))
        nx, ny = (int(np.ceil(1.5 * extent / edge)) for extent in contact.extent)
        center = (0.5 * (contact.x0 + contact.x1), 0.5 * (contact.y0 + contact.y1))
        window = Grid(nx=nx, ny=ny, dx=edge, dy=edge, center=center)
        # A periodic contact that nearly fills its window is looked at in all of it.
        whole = periodic and max(nx * edge / grid.size[0], ny * edge / grid.size[1]) > 1.0
        found = coarse_contact(
            grid if whole else window, separation, normal, control, periodic=whole, cells=6 * _ACROSS
        )
        # Where the coarse contact is not found, its largest pressure everywhere is on the safe side.
        yield found if found is not None else (window, np.full(window.shape, contact.peak))


def _loads(
    window: Grid, pressure: FloatArray, influences: Mapping[str, SurfaceInfluence], friction: FrictionLaw | None
) -> Iterator[dict[str, FloatArray]]:
    """Tractions to look at: the pressure, and with friction all the shear that it can bear, either way."""
    yield {"p": pressure}
    if friction is None:
        return
    y, x = window.axes()
    rest = np.zeros_like(pressure)
    bound = np.asarray(friction.shear_bound(FrictionState(pressure=pressure, x=x, y=y, slip_distance=rest, time=1.0)))
    for name in ("q_x", "q_y"):
        if name in influences:
            for sign in (1.0, -1.0):
                yield {"p": pressure, name: sign * np.where(pressure > 0, bound, 0.0)}


class _ElasticStress:
    """Stress by the tractions of coarse contacts, kept for loads and factors that ask again: it is most of the work."""

    def __init__(self, influences: Mapping[str, SurfaceInfluence], material: Material) -> None:
        self._influences, self._material, self._room = influences, material, _KEPT
        self._known: dict[tuple[Any, ...], list[tuple[FloatArray, FloatArray]]] = {}

    def at(self, window: Grid, loaded: Mapping[str, FloatArray], count: int, z: float) -> FloatArray:
        """Mandel stress ``(6, count, count)`` [Pa] about the loaded cells, at the depth `z` [m] in the body."""
        stress = np.zeros((6, count, count))
        for name, field in loaded.items():
            self._add(stress, name, window, field, z)
        stress[3:] *= SQRT2
        return stress

    def _add(self, stress: FloatArray, name: str, window: Grid, field: FloatArray, z: float) -> None:
        count = stress.shape[1]
        before = self._known.setdefault((name, window.dx, window.dy, field.shape, count, z), [])
        for known, caused in before:
            if np.array_equal(known, field):
                stress += caused
                return
            if np.array_equal(known, -field):
                stress -= caused
                return
        # Offsets from loaded cells to the points: all that a sum over the cells needs.
        y, x = (
            (np.arange(1 - loads, count) + 0.5 * (loads - count)) * edge
            for loads, edge in zip(field.shape, (window.dy, window.dx), strict=True)
        )
        half = (0.5 * window.dx, 0.5 * window.dy)
        tables = self._influences[name].sample("stress", list(COMPONENTS), x, y, z, half, self._material)
        caused = np.stack([fftconvolve(table, field, mode="valid") for table in tables])
        stress += caused
        if caused.nbytes <= self._room:
            self._room -= caused.nbytes
            before.append((field, caused))


def _extent(
    trial: _Trial,
    window: Grid,
    fields: Mapping[str, FloatArray],
    elastic: _ElasticStress,
    factor: float,
) -> _Bounds | None:
    """Bounds (x, y, z) of the places at which a law is more than elastic under tractions on a coarse window."""
    box = Box.around(fields["p"] > 0)
    if box is None:
        return None
    loaded = {name: field[box.y0 : box.y1, box.x0 : box.x1] for name, field in fields.items()}
    ny, nx = loaded["p"].shape
    middle = np.array([window.x[box.x0] + window.x[box.x1 - 1], window.y[box.y0] + window.y[box.y1 - 1]]) / 2
    count = 3 * max(nx, ny, _ACROSS)
    for _ in range(_DOUBLINGS):
        inside = _beyond(trial, window, loaded, elastic, count, factor)
        if not inside.any():
            return None
        rim = (inside[-1], inside[:, [0, -1]], inside[:, :, [0, -1]])
        if not any(np.any(part) for part in rim):
            break
        count *= 2
    spans = [np.flatnonzero(inside.any(axis=axes)) for axes in ((0, 1), (0, 2), (1, 2))]
    edges = np.array([window.dx, window.dy, window.dx])
    starts = np.array([middle[0] - 0.5 * count * edges[0], middle[1] - 0.5 * count * edges[1], 0.0])
    low = starts + edges * np.array([span[0] for span in spans])
    return low, starts + edges * np.array([span[-1] + 1.0 for span in spans])


def _beyond(
    trial: _Trial,
    window: Grid,
    loaded: Mapping[str, FloatArray],
    elastic: _ElasticStress,
    count: int,
    factor: float,
) -> NDArray[np.bool_]:
    """Whether a law is more than elastic, in coarse cells ``(nz, count, count)`` about the loaded ones."""
    depths = (np.arange(count // 2) + 0.5) * window.dx
    out = np.empty((depths.size, count, count), dtype=bool)
    # A law is asked about some depths at once: for each alone its calls would cost more than its numbers.
    for first in range(0, depths.size, together := max(1, _AT_ONCE // count**2)):
        some = depths[first : first + together]
        stress = np.stack([elastic.at(window, loaded, count, float(z)) for z in some], axis=1)
        tried = factor * stress.reshape(6, -1)
        out[first : first + together] = trial.beyond(tried, np.repeat(some, count**2)).reshape(-1, count, count)
    return out
