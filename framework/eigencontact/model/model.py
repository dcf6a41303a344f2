"""The physical model of a scene, in stages: bodies, interface, window, sources, cells."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from eigencontact.core.grid import Grid
from eigencontact.core.kept import cached_object
from eigencontact.core.rigid_modes import TANGENTIAL_MODES
from eigencontact.hooks.registry import Registry
from eigencontact.model.bodies import Bodies, build_bodies
from eigencontact.model.cells import Cells, cut_cells, place_sources
from eigencontact.model.cross_section import CrossSection
from eigencontact.model.exposed import Exposed, exposed_of
from eigencontact.model.fatigue import FatigueModel, fatigue_of
from eigencontact.model.initial import InitialState
from eigencontact.model.interface import Interface, build_interface
from eigencontact.model.observing import Observing, observing
from eigencontact.model.sources import Source
from eigencontact.model.wear import WearModel, wear_model
from eigencontact.model.window import Window, window_of_regions
from eigencontact.plugin import Component, ConstitutiveLaw, FrictionLaw
from eigencontact.scene.files import anchored
from eigencontact.scene.schema import Numerics, Scene
from eigencontact.scene.step_messages import keys_of_scene
from eigencontact.scene.steps import expected_points

__all__ = ["Model", "build_model"]


@dataclass(frozen=True, kw_only=True)
class Model:
    """Physical model of a scene, independent of the methods that solve it.

    Attributes
    ----------
    scene : Scene
        With absolute paths of its files.
    files : tuple of Path
        Data files that the scene names.
    registry : Registry
        Source of the components.
    bodies : Bodies
        Solids and laws.
    interface : Interface or None
        Geometries, friction and kernels; None without a contact.
    window : Window
        Grid, and the expected contact.
    cells : Cells
        Regions with eigenstrain and their cells, and the stress regions.
    observers : tuple of Observing
        With the regions that they ask for.
    fatigue : tuple of FatigueModel
        Fatigue criteria, with their regions.
    wear : WearModel or None
        Law of wear; None where the surfaces stay.
    exposed : Exposed or None
        Materials at the surface; None where no law distinguishes materials and none comes to the surface.
    initial : mapping of int to InitialState
        States of earlier runs at the start, by body.
    """

    scene: Scene
    files: tuple[Path, ...]
    registry: Registry
    bodies: Bodies
    interface: Interface | None
    window: Window
    cells: Cells
    observers: tuple[Observing, ...]
    fatigue: tuple[FatigueModel, ...]
    wear: WearModel | None
    exposed: Exposed | None
    initial: Mapping[int, InitialState]

    @property
    def grid(self) -> Grid:
        """Grid of the window."""
        return self.window.grid

    @property
    def numerics(self) -> Numerics:
        """Fidelity and effort."""
        return self.scene.numerics

    @property
    def steps(self) -> int:
        """Number of increments that will be solved; a guess where cycles are skipped."""
        return expected_points(self.scene.steps, self.scene.solved_cycles)

    @property
    def periodic(self) -> bool:
        """Whether the contact repeats with the window."""
        return self.numerics.boundary == "periodic"

    @property
    def sources(self) -> tuple[Source, ...]:
        """All regions with eigenstrain, prescribed or computed."""
        return self.cells.sources

    @property
    def friction(self) -> FrictionLaw | None:
        """Friction law of the contact."""
        return None if self.interface is None else self.interface.friction

    @property
    def laws(self) -> tuple[ConstitutiveLaw, ...]:
        """Laws of the bodies, including those that remain elastic, and of the inhomogeneities."""
        return (*self.bodies.laws.values(), *(source.law for source in self.cells.inhomogeneities))

    @property
    def components(self) -> list[Component]:
        """All plugin components of the model."""
        surface, used = self.interface, list[Any]()
        if surface is not None:
            used += [*surface.influences.values(), *surface.geometries]
        used += dict.fromkeys(self.bodies.solids)
        for source in self.sources:
            shape = source.shape.solid if isinstance(source.shape, CrossSection) else source.shape
            used += [shape, source.field, getattr(source, "law", None)]
        used += [self.friction, self.wear and self.wear.law]
        used += [observing.observer for observing in self.observers]
        used += [item.criterion for item in self.fatigue]
        return [component for item in used if isinstance(item, Component) for component in (item, *item.parts)]


def build_model(scene: Scene, registry: Registry, initial: Mapping[int, InitialState] = MappingProxyType({})) -> Model:
    """Build and check all components of a scene, and choose its window and cells.

    Parameters
    ----------
    scene, registry : Scene, Registry
    initial : mapping of int to InitialState
        States at the start, by body. Cells then have their height, unless the scene gives another.

    Raises
    ------
    SceneError, PluginError, PlanError
        A component that is refused, a plugin that is missing, a window that cannot be chosen.
    """
    scene, files = anchored(scene, registry)
    bodies = build_bodies(scene, registry)
    elastic = build_interface(scene, registry, bodies.solids)
    window = _window(scene, bodies, elastic)
    elastic = elastic and elastic.against(window.grid.size[0])
    sources = place_sources(scene, registry, bodies, elastic, window, initial)
    cells = cut_cells(scene, bodies, window, sources, initial)
    wear = wear_model(scene, registry)
    laws = {"friction": elastic and elastic.friction, "wear": wear and wear.law}
    return Model(
        scene=scene,
        files=files,
        registry=registry,
        bodies=bodies,
        interface=sources.interface,
        window=window,
        cells=cells,
        observers=observing(scene, registry),
        fatigue=fatigue_of(scene, registry),
        wear=wear,
        exposed=exposed_of(bodies.solids, cells.inhomogeneities, window.grid, laws, scene.losses),
        initial=initial,
    )


def _window(scene: Scene, bodies: Bodies, interface: Interface | None) -> Window:
    """Window around the contact; without one, around the regions."""
    if interface is None:
        return window_of_regions(scene, bodies)
    from eigencontact.model.contact_window import contact_window

    with keys_of_scene(scene.steps):
        return cached_object(lambda: _key(scene), lambda: contact_window(scene, interface))


def _key(scene: Scene) -> str:
    """All that chooses the window of a contact, for variants of a sweep: motions along the surface up to a factor."""
    tables = scene.resolved()
    for name in ("title", "description", "name", "stress", "observers", "fatigue", "output"):
        tables.pop(name, None)
    steps = [inner for step in tables["steps"] for inner in (step, *step.get("cycle", ()))]
    for key in (name.replace("_", "-") for mode in TANGENTIAL_MODES for name in mode):
        largest = max((abs(step[key]) for step in steps if step.get(key)), default=1.0)
        for step in steps:
            if step.get(key):
                step[key] = round(step[key] / largest, 12)
    return json.dumps(tables, sort_keys=True)
