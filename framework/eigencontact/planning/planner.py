"""Planner: builds the model of a scene and selects the blocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import ceil
from time import perf_counter

from eigencontact.core.memory import machine_bytes
from eigencontact.errors import PlanError
from eigencontact.execution.blocks.block import Block
from eigencontact.execution.blocks.conclusion import Conclusion
from eigencontact.execution.interiors.initial import initial_states
from eigencontact.execution.mechanics.mechanics import mechanics_of
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
    """Plan the blocks of a scene.

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
    blocks = in_order(_blocks(model))
    plan = Plan(model=model, blocks=blocks, left_out=(), conclusions=_conclusions(model))
    _check_memory(plan)
    cautions = foreseen(model, blocks)
    return replace(plan, left_out=left_out(model, blocks), cautions=cautions, seconds_planned=perf_counter() - began)


def _blocks(model: Model) -> list[Block]:
    """Blocks that a scene may need: before the contact, the contact, wear, regions, observers."""
    blocks: list[Block] = []
    if model.scene.bulk_at_rest:
        from eigencontact.execution.blocks.bulk import BulkStress

        blocks.append(BulkStress(model))
    mechanics = mechanics_of(model)
    surface_blocks: list[Block] = [] if mechanics is None else [mechanics]
    if model.interface is not None:
        from eigencontact.execution.mechanics.separation import blocks_beside_contact, separation_blocks

        blocks += [*(() if model.wear else separation_blocks(model)), *blocks_beside_contact(model)]
    if model.wear is not None and mechanics is not None:
        from eigencontact.execution.wear.blocks import blocks_of_wear

        surface_blocks += blocks_of_wear(model, mechanics)
    blocks += surface_blocks
    if model.cells.requests:
        from eigencontact.execution.fields.regions import regions_of

        blocks += regions_of(model)
    if model.observers:
        from eigencontact.execution.run.observers import observers_of

        blocks += observers_of(model, frozenset(name for block in surface_blocks for name in block.requesters))
    return blocks


def _conclusions(model: Model) -> Sequence[Conclusion]:
    """Requested evaluations of all steps."""
    if not model.fatigue:
        return ()
    from eigencontact.execution.fields.fatigue import fatigue_conclusions

    return fatigue_conclusions(model)


def _check_memory(plan: Plan) -> None:
    total, predicted = machine_bytes(), plan.cost.peak
    if predicted > MEMORY_SHARE * total:
        largest = max(plan.parts, key=lambda part: part.cost.peak)
        raise PlanError(
            f"plan must fit into memory, {total / 2**30:.3g} GiB (got {predicted / 2**30:.3g} GiB, most of it for "
            f"block {largest.name!r}); use about 1/{ceil(predicted / (MEMORY_SHARE * total))} of the cells or depths, "
            "or numerics.precision = 'single' or, with a larger tolerance, 'auto'"
        )
