"""Bodies that obey a law of their own near the contact: the box of cells in which that law may be more than elastic.

The box is found by asking the law: elastic stress by the tractions of coarse contacts, at all places that may matter,
and whether the law would bear the strain of that stress with that stress. A box that proves too small grows
(`eigencontact.model.growth`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from eigencontact.core.grid import Box, Grid
from eigencontact.core.material import Material
from eigencontact.core.tensors import COMPONENTS, SQRT2
from eigencontact.errors import EigencontactError, SceneError, require
from eigencontact.hooks.registry import Registry
from eigencontact.model.contact_window import contacts_of_steps
from eigencontact.model.kernels import Bodies, PairCoefficients
from eigencontact.model.sources import Inhomogeneity, Patch, build_law
from eigencontact.model.window import coarse_contact
from eigencontact.plugin import (
    ConstitutiveLaw,
    FrictionLaw,
    FrictionState,
    Geometry,
    LawStep,
    LinearLaw,
    SurfaceInfluence,
    VariesInSpace,
)
from eigencontact.scene.components import build_component
from eigencontact.scene.schema import Scene
from eigencontact.solvers.cell_conditions import compliance

__all__ = ["YieldingBody", "yielding_bodies"]

FloatArray = NDArray[np.float64]

#: Coarse cells across a contact, and times that the box that is searched may be doubled.
_ACROSS, _DOUBLINGS = 16, 5
#: Stress that is tried, as a multiple of the elastic one: the coarse contact errs by some 3 %.
_SAFETY = 1.1
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


def yielding_bodies(
    scene: Scene,
    registry: Registry,
    bodies: Bodies,
    geometries: tuple[Geometry, ...],
    influences: Mapping[str, SurfaceInfluence],
    friction: FrictionLaw | None,
    grid: Grid,
) -> tuple[YieldingBody, ...]:
    """Boxes of the bodies with a law; none of a body that stays elastic, which then is an elastic one.

    Raises
    ------
    SceneError, PluginError
        A law that is refused, or that is elastic; a scene without contact.
    """
    found = []
    for number, table in ((1, scene.body1.law), (2, scene.body2.law)):
        if table is None:
            continue
        where, material = f"body{number}.law", bodies[number - 1]
        assert isinstance(material, Material)
        law = build_law(registry, table, where, material)
        _refuse(law, material, scene, where)
        patch = _box_where(law, material, scene, bodies, geometries, influences, friction, grid)
        if patch is not None:
            field = build_component(registry, "eigenstrain-field", {"type": "uniform", "value": 0.0}, where)
            name = f"body {number}"
            found.append(
                YieldingBody(name=name, where=where, key=law.key, body=number, shape=patch, field=field, law=law)
            )
    return tuple(found)


def _refuse(law: ConstitutiveLaw, material: Material, scene: Scene, where: str) -> None:
    """Refuse laws and scenes that a body cannot have."""
    rule = "of a material that yields or degrades: one that is elastic has young-modulus and poisson-ratio"
    require(not isinstance(law, LinearLaw | VariesInSpace), where, "type", law.key, rule)
    if not scene.geometry:
        raise SceneError(
            f"{where} must be left out without a contact (got {law.key!r}); give an inclusion with this material"
        )
    small = 1e-9 * material.young_modulus * np.random.default_rng(0).standard_normal((6, 8))
    rule = f"of a law that begins with the constants of body {where[4]}: leave out its own"
    require(not _differs(law, compliance(material), small, 0.0).any(), where, "type", law.key, rule)
    whole = scene.numerics.inclusion_resolution == "whole"
    require(not whole, where, "type", law.key, 'of a scene with numerics.inclusion-resolution = "cells"')


def _box_where(
    law: ConstitutiveLaw,
    material: Material,
    scene: Scene,
    bodies: Bodies,
    geometries: tuple[Geometry, ...],
    influences: Mapping[str, SurfaceInfluence],
    friction: FrictionLaw | None,
    grid: Grid,
) -> Patch | None:
    """Box around all places where a law is more than elastic under a load of the scene; None where it never is."""
    bounds: list[tuple[FloatArray, FloatArray]] = []
    for window, pressure in _coarse_contacts(scene, bodies, geometries, influences["p"], grid):
        for fields in _loads(window, pressure, influences, friction):
            found = _extent(law, material, window, fields, influences)
            if found is not None:
                bounds.append(found)
    if not bounds:
        return None
    low = np.min([one for one, _ in bounds], axis=0)
    high = np.max([other for _, other in bounds], axis=0)
    room = scene.numerics.law_room * (high - low)
    (x0, y0, _), (x1, y1, depth) = low - room, high + room
    return Patch(((float(x0), float(y0), 0.0), (float(x1), float(y1), float(depth))))


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


def _extent(
    law: ConstitutiveLaw,
    material: Material,
    window: Grid,
    fields: Mapping[str, FloatArray],
    influences: Mapping[str, SurfaceInfluence],
) -> tuple[FloatArray, FloatArray] | None:
    """Bounds (x, y, z) of the places at which a law is more than elastic under tractions on a coarse window."""
    box = Box.around(fields["p"] > 0)
    if box is None:
        return None
    loaded = {name: field[box.y0 : box.y1, box.x0 : box.x1] for name, field in fields.items()}
    ny, nx = loaded["p"].shape
    middle = np.array([window.x[box.x0] + window.x[box.x1 - 1], window.y[box.y0] + window.y[box.y1 - 1]]) / 2
    count = 3 * max(nx, ny, _ACROSS)
    for _ in range(_DOUBLINGS):
        inside = _beyond(law, material, window, loaded, influences, count)
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
    law: ConstitutiveLaw,
    material: Material,
    window: Grid,
    loaded: Mapping[str, FloatArray],
    influences: Mapping[str, SurfaceInfluence],
    count: int,
) -> NDArray[np.bool_]:
    """Whether a law is more than elastic, in coarse cells ``(nz, count, count)`` about the loaded ones."""
    flexible = compliance(material)
    # Offsets from loaded cells to the points: all that a sum over the cells needs.
    y, x = (
        (np.arange(1 - loads, count) + 0.5 * (loads - count)) * edge
        for loads, edge in zip(loaded["p"].shape, (window.dy, window.dx), strict=True)
    )
    half = (0.5 * window.dx, 0.5 * window.dy)
    out = []
    for z in (np.arange(count // 2) + 0.5) * window.dx:
        stress = np.zeros((6, count, count))
        for name, field in loaded.items():
            tables = influences[name].sample("stress", list(COMPONENTS), x, y, float(z), half, material)
            for row, table in enumerate(tables):
                stress[row] += fftconvolve(table, field, mode="valid")
        stress[3:] *= SQRT2
        tried = _SAFETY * stress.reshape(6, -1)
        out.append(_differs(law, flexible, tried, float(z)).reshape(count, count))
    return np.array(out)


def _differs(law: ConstitutiveLaw, flexible: FloatArray, stress: FloatArray, z: float) -> NDArray[np.bool_]:
    """Whether a law at rest answers the strain of an elastic stress with another one."""
    count = stress.shape[1]
    before = {name: np.zeros((variable.components, count)) for name, variable in law.variables.items()}
    step: Any = LawStep(x=np.zeros(count), y=np.zeros(count), z=np.full(count, z), time=1.0, duration=1.0)
    size: FloatArray = np.linalg.norm(stress, axis=0)
    try:
        answer = np.asarray(law.update(flexible @ stress, before, step).stress)
    except EigencontactError:
        return np.asarray(size > 0.0)
    return np.asarray(np.linalg.norm(answer - stress, axis=0) > _SAME * size, dtype=bool)
