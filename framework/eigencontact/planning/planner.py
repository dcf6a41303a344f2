"""The planner: what a scene holds decides what is built, for contacts, for eigenstrain, and for both together."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from eigencontact.core.grid import Grid
from eigencontact.errors import PlanError, SceneError
from eigencontact.hooks.registry import Registry
from eigencontact.planning.blocks import Block, resolve
from eigencontact.planning.bodies import bodies_of, influence_for
from eigencontact.planning.coupling import Coupling, coupling_of
from eigencontact.planning.grids import given_grid, grid_around
from eigencontact.planning.kernels import Bodies
from eigencontact.planning.left_out import left_out
from eigencontact.planning.plan import Plan
from eigencontact.planning.sources import Source, build_sources, with_lattices
from eigencontact.plugin import FrictionLaw, Geometry, SurfaceInfluence
from eigencontact.scene.components import build_component
from eigencontact.scene.files import anchored
from eigencontact.scene.schema import Scene

if TYPE_CHECKING:
    from eigencontact.planning.inhomogeneities import InhomogeneityDeclaration

__all__ = ["make_plan"]

#: The largest plan that is accepted, as a share of the machine's memory.
_MEMORY_SHARE = 0.9


def make_plan(scene: Scene, registry: Registry) -> Plan:
    """Decide what a scene needs.

    Raises
    ------
    SceneError, PluginError, PlanError
        A component that is refused, a plugin that is missing, an output that nothing provides, a window too large
        for this machine's memory.
    """
    scene, files = anchored(scene, registry)
    as_given, bodies = scene, bodies_of(scene, registry)
    geometries: tuple[Geometry, ...] = tuple(_components(scene.geometry, "geometry", "geometry", registry))
    observed = _components(scene.observers, "observer", "observers", registry)
    observers = tuple((str(table["type"]), item) for table, item in zip(scene.observers, observed, strict=True))
    blocks: list[Block] = []
    outputs: dict[str, str] = {}
    influences: dict[str, SurfaceInfluence] = {}
    coupling: Coupling | None = None
    friction: FrictionLaw | None = None
    if geometries:
        from eigencontact.planning.contact import plan_contact
        from eigencontact.planning.declare import ContactDeclaration

        part = plan_contact(scene, registry, bodies, geometries)
        grid, reason, influences = part.grid, part.reason, {"p": part.influence}
        sources = _fitted(build_sources(scene, registry, grid), scene, grid)
        scene = _with_close_ups(scene, sources, grid)  # the plan keeps the scene as it was given
        strained = tuple(sorted({source.body for source in sources}))
        if scene.friction is not None:
            friction = build_component(registry, "friction-law", scene.friction, "friction")
            coupling = coupling_of(scene, bodies)
            influences |= {name: influence_for(registry, name, bodies) for name in coupling.tractions[1:]}
        declared = ContactDeclaration(scene, grid, part.box, geometries, influences, bodies, strained, coupling)
        blocks, outputs = declared.everything()
    else:
        sources = build_sources(scene, registry, given_grid(scene.grid))
        grid, reason = _grid_without_contact(scene, sources)
        sources = _fitted(sources, scene, grid)
        scene = _with_close_ups(scene, sources, grid)
    if sources:
        more, wanted = _eigenstrain(scene, registry, grid, sources, bodies, coupling, influences)
        blocks, outputs = blocks + more, outputs | wanted
    _observe(scene, blocks, outputs, coupling, contact=bool(geometries))
    plan = Plan(
        scene=as_given,
        registry=registry,
        grid=grid,
        grid_reason=reason,
        bodies=bodies,
        geometries=geometries,
        observers=observers,
        influences=influences,
        sources=sources,
        groups=resolve(blocks, outputs),
        left_out=left_out(scene, bodies, sources, coupling, grid),
        friction=friction,
        files=files,
    )
    _check_memory(plan)
    return plan


def _fitted(sources: tuple[Source, ...], scene: Scene, grid: Grid) -> tuple[Source, ...]:
    """Sources with the cells that they are cut into."""
    sources = with_lattices(sources, scene, grid)
    cut = scene.numerics.inclusion_resolution == "cells"
    if cut and any(source.material is not None for source in sources):
        from eigencontact.planning.inhomogeneities import with_boxes

        sources = with_boxes(sources, scene, grid)
    return sources


def _with_close_ups(scene: Scene, sources: tuple[Source, ...], grid: Grid) -> Scene:
    """Scene whose regions around inclusions have limits and depths."""
    if all(request.around is None for request in scene.stress):
        return scene
    from eigencontact.planning.close_up import resolved

    return scene.model_copy(update={"stress": resolved(scene.stress, sources, grid)})


def _components(tables: Sequence[dict[str, object]], kind: str, group: str, registry: Registry) -> list[Any]:
    where = [group if len(tables) == 1 else f"{group}.{number}" for number in range(len(tables))]
    return [build_component(registry, kind, table, place) for table, place in zip(tables, where, strict=True)]


def _grid_without_contact(scene: Scene, sources: Sequence[Source]) -> tuple[Grid, str]:
    given = given_grid(scene.grid)
    if given is not None:
        return given, "given in the scene"
    grid = grid_around([source.shape.bounds for source in sources])
    return grid, "automatic: around all inclusions, and four times their depth"


def _eigenstrain(
    scene: Scene,
    registry: Registry,
    grid: Grid,
    sources: tuple[Source, ...],
    bodies: Bodies,
    coupling: Coupling | None,
    influences: Mapping[str, SurfaceInfluence],
) -> tuple[list[Block], dict[str, str]]:
    """Blocks of the eigenstrain, and what is wanted of them beside what the contact wants."""
    from eigencontact.planning.declare import region_block
    from eigencontact.planning.eigenstrain import EigenstrainDeclaration

    cell = None
    if not all(source.exact and source.material is None for source in sources):
        from eigencontact.planning.cells import installed_cell

        cell = installed_cell(registry)((0.0, 0.0, 0.5), (1.0, 1.0, 1.0))
    prescribed = [source for source in sources if source.material is None]
    declaration: EigenstrainDeclaration | InhomogeneityDeclaration
    declaration = EigenstrainDeclaration(scene, grid, prescribed, bodies, cell)
    blocks: list[Block] = []
    if len(prescribed) < len(sources):
        from eigencontact.planning.inhomogeneities import InhomogeneityDeclaration, boxes_of

        assert cell is not None
        boxes, facts = boxes_of(sources), (bodies, cell, declaration, influences)
        if scene.numerics.inclusion_resolution == "whole":
            from eigencontact.planning.whole_inclusions import WholeDeclaration, wholes_of

            declaration = WholeDeclaration(scene, grid, boxes, *facts, wholes_of(sources))
        else:
            declaration = InhomogeneityDeclaration(scene, grid, boxes, *facts)
        blocks.append(declaration.solution())
    dragged = coupling is not None and coupling.level != "none"
    components = "xyz" if not scene.geometry or scene.output.tangential_displacement or dragged else "z"
    blocks.append(declaration.surface(components))
    outputs = {f"residual_displacement_{c}": "every scene with eigenstrain" for c in components}
    for request in scene.stress:
        block = declaration.region(request)
        if block is not None:
            blocks.append(block)
        if scene.geometry:
            continue
        if block is None:
            raise SceneError(
                f"stress region {request.label!r} must lie in a body with eigenstrain (body{request.body} has none, "
                "and there is no contact); set body"
            )
        blocks.append(region_block(request, grid))
        outputs[f"stress:{request.label}"] = f"[[stress]] {request.label!r}"
    return blocks, outputs


def _observe(
    scene: Scene, blocks: list[Block], outputs: dict[str, str], coupling: Coupling | None, *, contact: bool
) -> None:
    """Add the observers, who see the surface fields that every run of this scene has."""
    from eigencontact.planning.declare import CONTACT, friction_fields, observer_block

    residual = {name for name in outputs if name.startswith("residual_displacement_")}
    seen = frozenset(residual | (CONTACT | friction_fields(coupling) if contact else set()))
    for number, table in enumerate(scene.observers):
        blocks.append(observer_block(number, str(table["type"]), seen))
        outputs[f"observed:{number}"] = f"[[observers]] {table['type']!r}"


def _check_memory(plan: Plan) -> None:
    try:
        total = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return
    wanted = plan.cost.peak
    if wanted > _MEMORY_SHARE * total:
        largest = max(plan.blocks, key=lambda block: block.cost.peak)
        raise PlanError(
            f"plan must fit into memory, {total / 2**30:.3g} GiB (got {wanted / 2**30:.3g} GiB, most of it for block "
            f"{largest.name!r}); use fewer cells or depths, or numerics.precision = 'single'"
        )
