"""The model of a scene: its components built, its window chosen, its regions cut into cells where they have to be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.core.tractions import Traction
from eigencontact.errors import SceneError
from eigencontact.hooks.registry import Registry
from eigencontact.model.bodies import bodies_of, influence_for
from eigencontact.model.boxes import with_cells, with_lattices
from eigencontact.model.close_up import resolved
from eigencontact.model.contact_estimate import ContactEstimate
from eigencontact.model.contact_growth import ContactGrowth
from eigencontact.model.coupling import Coupling, coupling_of
from eigencontact.model.exposed import Exposed, exposed_of
from eigencontact.model.grids import given_grid, grid_around
from eigencontact.model.initial import InitialState
from eigencontact.model.kernels import Bodies
from eigencontact.model.observing import Observing, observing
from eigencontact.model.resolution import refuse_coarse_regions
from eigencontact.model.separation import sum_separations
from eigencontact.model.sources import Inhomogeneity, Source, build_sources
from eigencontact.plugin import Component, ConstitutiveLaw, FrictionLaw, Geometry, SurfaceInfluence, WearLaw
from eigencontact.scene.components import build_component
from eigencontact.scene.files import anchored
from eigencontact.scene.schema import Numerics, Scene, StressRequest
from eigencontact.scene.steps import expected_points

__all__ = ["Model", "build_model"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Model:
    """What a scene stands for, before it is decided how it is computed.

    Attributes
    ----------
    scene : Scene
        As it was given, files with their full paths.
    files : tuple of Path
        Data files that the scene names.
    registry : Registry
        Where its components came from.
    grid, grid_reason : Grid, str
        The window, and where it came from.
    contact_box : (int, int)
        Cells along (y, x) that the contact will occupy, by estimate; the window where there is none.
    expected : ContactEstimate or None
        The largest contact of the load history, by estimate; eigenstrain and inhomogeneities are not looked at.
    growth : ContactGrowth or None
        Of the radius of the contact, where a load step is even in it.
    bodies : two of Material, LayeredMedium or None
        Elastic constants, the same everywhere or layered; None is rigid.
    geometries : tuple of Geometry
        Without them there is no contact.
    observers : tuple of Observing
        With the regions that they ask for.
    friction : FrictionLaw or None
        Bound of the shear; None where the contact has no friction.
    wear : WearLaw or None
        Depth that sliding takes off the surfaces; None where they stay.
    exposed : Exposed or None
        Materials that can come to the surface; None where no law asks and nothing wears, or where there is but one.
    coupling : Coupling or None
        Tractions of the contact and the kernels that join them; None without a contact.
    influences : mapping of str to SurfaceInfluence
        By traction.
    prescribed, inhomogeneities : tuple of Source
        Regions with eigenstrain, and those with a law of their own.
    initial : mapping of int to InitialState
        States of earlier runs that bodies begin with.
    requests : tuple of StressRequest
        Regions of results, those around inclusions with the places that they stand for.
    laws : tuple of ConstitutiveLaw
        Of the bodies, also where they stay elastic, and of the inhomogeneities.
    """

    scene: Scene
    files: tuple[Path, ...]
    registry: Registry
    grid: Grid
    grid_reason: str
    contact_box: tuple[int, int]
    expected: ContactEstimate | None
    growth: ContactGrowth | None
    bodies: Bodies
    geometries: tuple[Geometry, ...]
    observers: tuple[Observing, ...]
    friction: FrictionLaw | None
    wear: WearLaw | None
    exposed: Exposed | None
    coupling: Coupling | None
    influences: Mapping[str, SurfaceInfluence]
    prescribed: tuple[Source, ...]
    inhomogeneities: tuple[Inhomogeneity, ...]
    initial: Mapping[int, InitialState]
    requests: tuple[StressRequest, ...]
    laws: tuple[ConstitutiveLaw, ...]

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self.scene.label

    @property
    def numerics(self) -> Numerics:
        """Fidelity and effort."""
        return self.scene.numerics

    @property
    def steps(self) -> int:
        """Number of load steps, ramps counted in increments; of cycles that wear those that will be solved, a guess."""
        return expected_points(self.scene.steps, self.scene.wear)

    @property
    def periodic(self) -> bool:
        """Whether the contact repeats with the window."""
        return self.numerics.boundary == "periodic"

    @property
    def sources(self) -> tuple[Source, ...]:
        """All regions with eigenstrain, prescribed or to be found."""
        return (*self.prescribed, *self.inhomogeneities)

    @property
    def tractions(self) -> tuple[Traction, ...]:
        """Tractions of the contact, the pressure first; none without a contact."""
        return () if self.coupling is None else self.coupling.tractions

    @property
    def components(self) -> list[Component]:
        """Every plugin component that the model uses."""
        used: list[Any] = [*self.influences.values(), *self.geometries, *dict.fromkeys(self.bodies)]
        for source in self.sources:
            used += [source.shape, source.field, getattr(source, "law", None)]
        used += [self.friction, self.wear, *(one.observer for one in self.observers)]
        return [part for item in used if isinstance(item, Component) for part in (item, *item.parts)]

    def half_space(self, body: int) -> Material:
        """Constants of a body (1 or 2) that is a homogeneous half-space; eigenstrain lies in no other."""
        found = self.bodies[body - 1]
        assert isinstance(found, Material)
        return found

    def separation(self, travel: tuple[float, float] = (0.0, 0.0)) -> FloatArray:
        """Sum of the geometries on the grid, moved to a place (x, y) [m], ``(ny, nx)`` [m]."""
        y, x = self.grid.axes()
        return sum_separations(self.geometries, x - travel[0], y - travel[1])


def build_model(scene: Scene, registry: Registry, initial: Mapping[int, InitialState] = MappingProxyType({})) -> Model:
    """Build and check everything that a scene names, and choose its window and cells.

    Parameters
    ----------
    scene, registry : Scene, Registry
    initial : mapping of int to InitialState
        States that bodies begin with: cells are then of the same height, unless the scene gives another.

    Raises
    ------
    SceneError, PluginError, PlanError
        A component that is refused, a plugin that is missing, a window that cannot be chosen.
    """
    scene, files = anchored(scene, registry)
    bodies = bodies_of(scene, registry)
    geometries: tuple[Geometry, ...] = tuple(_components(scene.geometry, "geometry", "geometry", registry))
    observed = _components(scene.observers, "observer", "observers", registry)
    friction, coupling, influences = None, None, {}
    window = None
    if geometries:
        coupling = coupling_of(scene, bodies)
        influences = _influences(coupling, registry, bodies)
        from eigencontact.model.contact_window import contact_window

        window = contact_window(scene, bodies, geometries, influences["p"])
    if scene.friction is not None:
        friction = build_component(registry, "friction-law", scene.friction, "friction")
    given = given_grid(scene.grid) if window is None else window.grid
    prescribed, inhomogeneities = build_sources(scene, registry, given, bodies)
    grid, reason = (window.grid, window.reason) if window else _grid_of_regions(given, (*prescribed, *inhomogeneities))
    laws: Mapping[int, ConstitutiveLaw] = {}
    if scene.body1.law is not None or scene.body2.law is not None:
        from eigencontact.model.yielding import laws_of_bodies, yielding_bodies

        laws = laws_of_bodies(scene, registry, bodies)
        # First, so that inhomogeneities win where they lie in what yields.
        regions = (*prescribed, *inhomogeneities)
        own = yielding_bodies(laws, scene, registry, bodies, geometries, influences, friction, grid, regions, initial)
        inhomogeneities = (*own, *inhomogeneities)
    if friction is not None and (prescribed or inhomogeneities):
        coupling = coupling_of(scene, bodies, dragged=True)
        influences = _influences(coupling, registry, bodies)
    prescribed = with_lattices(prescribed, scene, grid)
    if scene.numerics.inclusion_resolution == "cells":
        heights = {body: state.height for body, state in initial.items()}
        inhomogeneities = with_cells(inhomogeneities, scene, grid, heights)
    if not scene.numerics.allow_coarse:
        refuse_coarse_regions((*prescribed, *inhomogeneities))
    wear = _wear_law(scene, registry)
    return Model(
        scene=scene,
        files=files,
        registry=registry,
        grid=grid,
        grid_reason=reason,
        contact_box=window.box if window else grid.shape,
        expected=window.expected if window else None,
        growth=window.growth if window else None,
        bodies=bodies,
        geometries=geometries,
        observers=observing(scene, observed),
        friction=friction,
        wear=wear,
        exposed=exposed_of(
            bodies, inhomogeneities, grid, friction, wear, () if scene.wear is None else tuple(scene.wear.parts)
        ),
        coupling=coupling,
        influences=influences,
        prescribed=prescribed,
        inhomogeneities=inhomogeneities,
        initial=initial,
        requests=tuple(resolved(scene.stress, (*prescribed, *inhomogeneities), grid)),
        laws=(*laws.values(), *(source.law for source in inhomogeneities)),
    )


def _wear_law(scene: Scene, registry: Registry) -> WearLaw | None:
    """Wear law of a scene, whose steps have what it looks at."""
    if scene.wear is None:
        return None
    table = scene.wear
    law: WearLaw = build_component(registry, WearLaw.kind, table.component, "wear", table.beside)
    if law.needs_friction and scene.friction is None:
        others = [
            repr(entry.key)
            for entry in registry.of_kind(law.kind)
            if not getattr(entry.component, "needs_friction", True)
        ]
        raise SceneError(
            f"wear.type must name a law of pressure and path in a contact without friction, {' or '.join(others)} "
            f"(got {law.key!r}, which looks at the work of friction); set it, or add [friction]"
        )
    if law.needs_cycles and table.update == "increment":
        raise SceneError(
            f"wear.update must be 'cycle' with {law.key!r}, which looks at the slip amplitude of a cycle (got "
            "'increment'); leave it out"
        )
    if law.needs_cycles and all(step.cycle is None for step in scene.steps):
        raise SceneError(
            f"steps must have a cycle with wear.type = {law.key!r}, which looks at the slip amplitude of a cycle (got "
            "none); write them as cycle = [{ ... }]"
        )
    return law


def _components(tables: Sequence[dict[str, object]], kind: str, group: str, registry: Registry) -> list[Any]:
    where = [group if len(tables) == 1 else f"{group}.{number}" for number in range(len(tables))]
    return [build_component(registry, kind, table, place) for table, place in zip(tables, where, strict=True)]


def _influences(coupling: Coupling, registry: Registry, bodies: Bodies) -> dict[str, SurfaceInfluence]:
    """Surface influences by traction."""
    return {item.name: influence_for(registry, item.name, bodies) for item in coupling.tractions}


def _grid_of_regions(given: Grid | None, sources: Sequence[Source]) -> tuple[Grid, str]:
    """Window of a scene without contact."""
    if given is not None:
        return given, "given in the scene"
    return grid_around([source.shape.bounds for source in sources]), (
        "automatic: around all inclusions, and four times their depth"
    )
