"""The planner: what a scene holds decides what is built."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields, replace
from math import ceil
from time import perf_counter

from eigencontact.core.memory import machine_bytes
from eigencontact.errors import PlanError
from eigencontact.execution.blocks.block import Block
from eigencontact.execution.interiors.initial import initial_states
from eigencontact.execution.mechanics.mechanics import Mechanics, mechanics_of
from eigencontact.hooks.registry import Registry
from eigencontact.model.model import Model, build_model
from eigencontact.model.sizes import MEMORY_SHARE
from eigencontact.planning.left_out import left_out
from eigencontact.planning.order import in_order
from eigencontact.planning.plan import Plan
from eigencontact.scene.files import anchored
from eigencontact.scene.labels import labels_in_messages
from eigencontact.scene.schema import Scene
from eigencontact.warnings_.before import foreseen

__all__ = ["make_plan"]


def make_plan(scene: Scene, registry: Registry) -> Plan:
    """Decide what a scene needs.

    Raises
    ------
    SceneError, PluginError, PlanError
        A component that is refused, a plugin that is missing, an output that nothing provides, a window too large
        for this machine's memory.
    """
    with labels_in_messages(scene):
        return _planned(scene, registry)


def _planned(scene: Scene, registry: Registry) -> Plan:
    began = perf_counter()
    model = build_model(scene, registry, initial_states(anchored(scene, registry)[0]))
    mechanics = list(_mechanics(model))
    seen = [*mechanics, *_wear(model, mechanics)]
    blocks = [*_beside_the_contact(model), *seen, *_regions(model), *_observers(model, seen)]
    known = {item.name: getattr(model, item.name) for item in fields(model)}
    plan = Plan(**known, blocks=in_order(blocks), left_out=())
    _check_memory(plan)
    plan = replace(plan, left_out=left_out(model), cautions=foreseen(model))
    return replace(plan, seconds_planned=perf_counter() - began)


def _mechanics(model: Model) -> Iterator[Mechanics]:
    mechanics = mechanics_of(model)
    if mechanics is not None:
        yield mechanics


def _beside_the_contact(model: Model) -> Iterable[Block]:
    if not model.geometries:
        return ()
    from eigencontact.execution.mechanics.separation import blocks_beside_contact

    return blocks_beside_contact(model, new_surfaces=model.wear is None)


def _wear(model: Model, mechanics: Iterable[Mechanics]) -> Iterable[Block]:
    if model.wear is None:
        return ()
    from eigencontact.execution.wear.blocks import blocks_of_wear

    return [block for one in mechanics for block in blocks_of_wear(model, one)]


def _regions(model: Model) -> Iterable[Block]:
    if not model.requests:
        return ()
    from eigencontact.execution.fields.regions import regions_of

    return regions_of(model)


def _observers(model: Model, mechanics: Iterable[Block]) -> Iterable[Block]:
    """Observers see what mechanics and wear give of the surface."""
    if not model.observers:
        return ()
    from eigencontact.execution.run.observers import observers_of

    return observers_of(model, frozenset(name for block in mechanics for name in block.wanted))


def _check_memory(plan: Plan) -> None:
    total, wanted = machine_bytes(), plan.cost.peak
    if wanted > MEMORY_SHARE * total:
        largest = max(plan.parts, key=lambda part: part.cost.peak)
        raise PlanError(
            f"plan must fit into memory, {total / 2**30:.3g} GiB (got {wanted / 2**30:.3g} GiB, most of it for block "
            f"{largest.name!r}); use about 1/{ceil(wanted / (MEMORY_SHARE * total))} of the cells or depths, or "
            "numerics.precision = 'single' or, with a larger tolerance, 'auto'"
        )
