"""Sources of a model: regions of the scene and yielding bodies, first whole, then cut into cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from eigencontact.errors import SceneError
from eigencontact.halfspace.potentials import HasFarField, HasMomentPotentials
from eigencontact.hooks.registry import Registry
from eigencontact.model.bodies import Bodies
from eigencontact.model.boxes import with_cells, with_lattices
from eigencontact.model.close_up import resolved
from eigencontact.model.initial import InitialState
from eigencontact.model.interface import Interface, dragged_interface
from eigencontact.model.resolution import refuse_coarse_regions
from eigencontact.model.sources import Inhomogeneity, Source, build_patches
from eigencontact.model.window import Window
from eigencontact.scene.schema import Scene, StressRequest
from eigencontact.scene.whole import Whole

__all__ = ["Cells", "Sources", "cut_cells", "place_sources"]


@dataclass(frozen=True, kw_only=True)
class Sources:
    """Regions with eigenstrain before division into cells, and the interface that they displace.

    Attributes
    ----------
    prescribed, inhomogeneities : tuple of Source
        Regions with prescribed eigenstrain, and regions with a law of their own. Yielding bodies come first: where
        regions overlap the later one counts.
    interface : Interface or None
        Interface with kernels along x and y where eigenstrain drags the surfaces; None without a contact.
    """

    prescribed: tuple[Source, ...]
    inhomogeneities: tuple[Inhomogeneity, ...]
    interface: Interface | None


@dataclass(frozen=True, kw_only=True)
class Cells:
    """Sources with their cells, and the stress regions that follow from these.

    Attributes
    ----------
    prescribed, inhomogeneities : tuple of Source
        As in `Sources`; regions without a closed form have cells.
    requests : tuple of StressRequest
        Stress regions with their limits and depths filled in.
    """

    prescribed: tuple[Source, ...]
    inhomogeneities: tuple[Inhomogeneity, ...]
    requests: tuple[StressRequest, ...]

    @property
    def sources(self) -> tuple[Source, ...]:
        """All regions with eigenstrain, prescribed or computed."""
        return (*self.prescribed, *self.inhomogeneities)


def place_sources(
    scene: Scene,
    registry: Registry,
    bodies: Bodies,
    interface: Interface | None,
    window: Window,
    initial: Mapping[int, InitialState],
) -> Sources:
    """Regions of a scene, and the parts of bodies with a law that may exceed their elastic range.

    Raises
    ------
    SceneError, PluginError
        Components that are refused; a plastic zone that is too large.
    """
    fills_window = interface is not None or not scene.grid.automatic
    prescribed = (*bodies.prescribed, *build_patches(scene, registry, window.grid if fills_window else None))
    inhomogeneities = bodies.inhomogeneities
    if interface is not None and bodies.laws:
        from eigencontact.model.yielding import yielding_bodies

        regions = (*prescribed, *inhomogeneities)
        yielding = yielding_bodies(scene, registry, bodies, interface, window.grid, regions, initial)
        inhomogeneities = (*yielding, *inhomogeneities)
    if interface is not None and (prescribed or inhomogeneities):
        interface = dragged_interface(interface, scene, registry)
    return Sources(prescribed=prescribed, inhomogeneities=inhomogeneities, interface=interface)


def cut_cells(
    scene: Scene, bodies: Bodies, window: Window, sources: Sources, initial: Mapping[int, InitialState]
) -> Cells:
    """Sources with their cells on the columns of the window's grid.

    Raises
    ------
    SceneError
        Too many cells, cells wider than a region, or a degree that misses the error of the scene.
    """
    grid, inhomogeneities = window.grid, sources.inhomogeneities
    prescribed = with_lattices(sources.prescribed, scene, grid)
    heights = {body: state.height for body, state in initial.items()}
    for body in (1, 2):
        members = [source for source in inhomogeneities if source.body == body]
        wholes = _wholes(members, scene, bodies)
        inhomogeneities = tuple(wholes.get(id(source), source) for source in inhomogeneities)
        members = [source for source in inhomogeneities if source.body == body]
        if not all(source.whole for source in members):
            celled = dict(zip(map(id, members), with_cells(members, scene, grid, heights), strict=True))
            inhomogeneities = tuple(celled.get(id(source), source) for source in inhomogeneities)
    finer = scene.numerics.refinement
    if finer > 1 and not any(_is_refined(inhomogeneities, body) for body in (1, 2)):
        raise SceneError(
            f"numerics.inclusion-refinement must be 1 without inclusions of another material in cells (got {finer}); "
            "leave it out, or give a finer grid"
        )
    regions = (*prescribed, *inhomogeneities)
    if not scene.numerics.allow_coarse:
        refuse_coarse_regions(regions, grid)
    requests = tuple(resolved(scene.stress, regions, grid))
    return Cells(prescribed=prescribed, inhomogeneities=inhomogeneities, requests=requests)


def _wholes(sources: Sequence[Inhomogeneity], scene: Scene, bodies: Bodies) -> dict[int, Inhomogeneity]:
    """Whole inhomogeneities of a body, with their degrees, by the identity of the sources."""
    resolution = scene.numerics.inclusion_resolution
    if resolution == "cells":
        return {}
    whole_sources = [source for source in sources if _is_whole(source, resolution)]
    if not whole_sources:
        return {}
    from eigencontact.model.whole_degrees import degrees_of

    surface = scene.numerics.half_space not in ("full-space", "image-pressure")
    degrees = degrees_of(whole_sources, resolution, bodies.half_space(whole_sources[0].body), surface=surface)
    return {id(source): replace(source, degree=item) for source, item in zip(whole_sources, degrees, strict=True)}


def _is_whole(source: Inhomogeneity, resolution: Whole) -> bool:
    """Whether a region is uniform, and its shape has the potentials for the degree."""
    exact = source.exact and isinstance(source.shape, HasFarField) and resolution.whole == 0
    has_potentials = exact or isinstance(source.shape, HasMomentPotentials)
    return has_potentials and source.field.uniform and source.uniform_law is not None


def _is_refined(sources: Sequence[Inhomogeneity], body: int) -> bool:
    """Whether a body has inclusions, and cells."""
    members = [source for source in sources if source.body == body]
    return not all(source.guessed for source in members) and not all(source.whole for source in members)
