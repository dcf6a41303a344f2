"""A plan in words, and as data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from eigencontact.core.units import readable, time_in_words
from eigencontact.model.overlaps import WHAT_COUNTS, overlapping
from eigencontact.model.resolution import percent
from eigencontact.model.words import body_in_words, layers_in_words
from eigencontact.planning.facts import (
    contact_as_data,
    expected_lines,
    geometry_lines,
    grid_lines,
    largest_loads,
    law_lines,
)
from eigencontact.planning.memory import run_bytes
from eigencontact.scene.spacing import spaced_by_radius
from eigencontact.scene.steps import segments_of
from eigencontact.warnings_.before import worst_above

if TYPE_CHECKING:
    from eigencontact.execution.blocks.block import Block
    from eigencontact.model.sources import Source
    from eigencontact.planning.plan import Plan

__all__ = ["PlanWords", "as_data", "explain", "plan_words", "references"]


@dataclass(frozen=True, kw_only=True)
class PlanWords:
    """A plan in words, by paragraph.

    Attributes
    ----------
    title : str
        Name of the scene, and its title where it has one.
    facts : list of str
        Bodies, geometry, grid ...: a name of `eigencontact.results.records.FACT_NAME` characters, empty where a line
        continues the one before it, then the text.
    cautions : list of str
        Warnings about limited accuracy.
    inclusions, blocks, kernels, predicted : list of str
        Lines of their paragraphs; those of `predicted` as in `facts`.
    left_out : list of (str, str)
        What is not modelled, and why.
    """

    title: str
    facts: list[str]
    cautions: list[str]
    inclusions: list[str]
    blocks: list[str]
    kernels: list[str]
    predicted: list[str]
    left_out: list[tuple[str, str]]


def plan_words(plan: Plan) -> PlanWords:
    """Return the text of a plan: model, kernels, sizes, memory, time, and omitted effects with reasons."""
    scene, model = plan.scene, plan.model
    layers = layers_in_words(model.bodies.solids, periodic=scene.numerics.boundary == "periodic")
    facts = [
        f"bodies      {_body(plan, 0)}; {_body(plan, 1)}",
        *([f"layers      {layers}"] if layers else []),
        *law_lines(model),
        *geometry_lines(model),
        *grid_lines(model),
        f"numerics    {_numerics(plan)}",
        *(f"            {precision}" for precision in plan.precisions),
        *([f"friction    {model.friction}"] if model.friction is not None else []),
        *(line for block in plan.blocks for line in block.facts(model)),
        f"load        {_steps(plan)}{largest_loads(plan.scene, plan.grid)}",
        *expected_lines(model),
    ]
    blocks = []
    for block in plan.blocks:
        for item in block.parts:
            seconds = item.cost.seconds_once + plan.steps * item.cost.seconds_per_step
            price = ", ".join([*([_bytes(item.cost.peak)] if item.cost.peak else []), _time(seconds)])
            together = " (solved together)" if len(block.parts) > 1 else ""
            blocks.append(f"{item.name}{together}: {item.reason}" + (f"  [{price}]" if seconds else ""))
    blocks += [
        f"{item.name}, after the last step: {item.reason}  [{_time(item.cost.seconds_once)}]"
        for item in plan.conclusions
    ]
    return PlanWords(
        title=f"{plan.name}: {scene.title}" if scene.title else plan.name,
        facts=facts,
        cautions=[f"{item.words} ({item.code})" for item in plan.cautions],
        inclusions=_inclusions(plan),
        blocks=blocks,
        kernels=[str(kernel) for kernel in plan.kernels],
        predicted=[
            f"predicted   {_bytes(plan.cost.peak)} of arrays, {_bytes(run_bytes(plan))} with libraries and pictures",
            f"            {_time(plan.seconds)} of solving",
        ],
        left_out=[(effect.effect, effect.reason) for effect in plan.left_out],
    )


def explain(plan: Plan) -> str:
    """Return a plan as text: all paragraphs of `plan_words`."""
    words = plan_words(plan)
    lines = [words.title, "", *words.facts, ""]
    lines += ["warnings", *(f"  {text}" for text in words.cautions), ""] if words.cautions else []
    lines += [*words.inclusions, ""] if words.inclusions else []
    lines += ["blocks, in order", *(f"  {line}" for line in words.blocks), ""]
    lines += [f"kernels, {len(words.kernels)} in all", *(f"  {line}" for line in words.kernels), ""]
    lines += [*words.predicted, "", "left out, and why"]
    return "\n".join([*lines, *(f"  {subject}: {reason}" for subject, reason in words.left_out)])


def as_data(plan: Plan) -> dict[str, object]:
    """Return the plan as plain data."""
    expected = plan.model.window.expected
    return {
        "name": plan.name,
        "title": plan.scene.title,
        "grid": {
            "cells": [plan.grid.nx, plan.grid.ny],
            "spacing": [plan.grid.dx, plan.grid.dy],
            "center": list(plan.grid.center),
            "line": plan.grid.line,
            "reason": plan.model.window.reason,
        },
        "steps": plan.steps,
        "expected": None if expected is None else contact_as_data(expected, plan.grid),
        "warnings": [item.to_dict() for item in plan.cautions],
        "inclusions": [
            {
                "name": source.name,
                "plugin": source.key,
                "body": source.body,
                "bounds": [list(corner) for corner in source.shape.bounds],
                "exact": source.lattice is None,
                "how": source.how,
                "cells": 0 if source.lattice is None else source.lattice.cells,
                "material": source.material,
            }
            for source in plan.model.sources
        ],
        "precisions": [asdict(precision) for precision in plan.precisions],
        "blocks": [_block_as_data(block, plan.steps) for block in plan.blocks],
        "kernels": [
            {
                "response": kernel.response,
                "traction": kernel.traction,
                "plugin": kernel.influence,
                "layout": kernel.layout,
                "count": kernel.count,
            }
            for kernel in plan.kernels
        ],
        "predicted_memory_bytes": run_bytes(plan),
        "predicted_array_bytes": plan.cost.peak,
        "predicted_seconds": plan.seconds,
        "left_out": [{"what": item.effect, "why": item.reason} for item in plan.left_out],
        "references": list(references(plan)),
        "scene": plan.scene.resolved(),
    }


def _block_as_data(block: Block, steps: int) -> dict[str, object]:
    return {
        "name": block.name,
        "why": block.reason,
        "requires": sorted(block.requires),
        "provides": sorted(block.provides),
        "parts": [item.name for item in block.parts],
        "memory_bytes": block.cost.peak,
        "seconds": block.cost.seconds_once + steps * block.cost.seconds_per_step,
    }


def references(plan: Plan) -> tuple[str, ...]:
    """Sources to cite for the plan, each once."""
    model = plan.model
    texts = [text for component in model.components for text in component.references]
    if model.sources:
        texts += [
            "R. D. Mindlin, D. H. Cheng, J. Appl. Phys. 21 (1950) 926",
            "S. Liu, X. Jin, Z. Wang et al., Int. J. Plasticity 35 (2012) 135",
        ]
    if model.cells.inhomogeneities:
        texts += [
            "J. D. Eshelby, Proc. R. Soc. Lond. A 241 (1957) 376",
            "K. Zhou, W. W. Hoh, X. Wang et al., Mech. Mater. 60 (2013) 144",
        ]
    if model.interface:
        texts += [
            "I. A. Polonsky, L. M. Keer, Wear 231 (1999) 206, doi:10.1016/S0043-1648(99)00113-1",
            "E. A. H. Vollebregt, J. Tribol. 136 (2014) 041402",
        ]
    if model.friction is not None:
        texts += ["L. Gallego, D. Nélias, S. Deyber, Wear 268 (2010) 208, doi:10.1016/j.wear.2009.07.019"]
    return tuple(dict.fromkeys(texts))


_SPACES = {
    "exact": "exact half-space",
    "full-space": "full space (the free surface is left out)",
    "image-pressure": "half-space by image and sampled pressure (approximate)",
    "periodic": "half-space whose eigenstrain repeats with the window",
}


def _numerics(plan: Plan) -> str:
    numerics, model = plan.scene.numerics, plan.model
    words: list[str] = [numerics.boundary] if model.interface else []
    if model.sources:
        words.append(_SPACES[numerics.half_space])
    auto = "precision by operator" if plan.precisions else "double precision"
    words.append(auto if numerics.precision == "auto" else f"{numerics.precision} precision")
    if model.friction is not None:
        words.append(f"coupling {numerics.coupling}")
    return ", ".join([*words, f"tolerance {numerics.tolerance:g}"] if model.interface else words)


def _inclusions(plan: Plan) -> list[str]:
    """All regions with eigenstrain and the method of the field; equal regions on one line."""
    cells, lines = plan.model.cells, list[str]()
    if cells.prescribed:
        lines += [f"eigenstrain, {_counted(cells.prescribed)}", *_alike(cells.prescribed)]
    for body in (1, 2):
        sources = [source for source in cells.inhomogeneities if source.body == body]
        if not sources:
            continue
        if sources[0].lattice is None:
            lines += [f"whole inhomogeneities, {_counted(sources)}", *_alike(sources)]
            continue
        from eigencontact.model.boxes import box_of_inhomogeneities

        box = box_of_inhomogeneities(sources)
        dz, *_ = box.lattice.edges
        edges = " x ".join(readable(edge, "m") for edge in (*plan.grid.edges, dz))
        worst = worst_above(plan.model, body)
        above = "" if worst is None else f"; pressure above them within some {percent(worst.error)}"
        lines.append(f"inhomogeneities of body {body}, {_counted(sources)} in {box.words} of {edges}{above}")
        lines += _alike(sources)
    if next(overlapping(cells.sources), None) is not None:
        lines.append(f"  where they overlap: {WHAT_COUNTS}")
    return lines


def _steps(plan: Plan) -> str:
    scene = plan.scene
    about = "about " if any(scene.guesses_cycles(step.repeat) for step in scene.steps) else ""
    count = f"{about}{plan.steps} step{'s' if plan.steps != 1 else ''}"
    if plan.growth is None:
        return count
    first, repeated = spaced_by_radius(scene.steps, friction=scene.friction is not None)
    graded = sum(scene.ramps[place].increments for place in first)
    for segment in segments_of(scene.steps):
        places = repeated.intersection(range(segment.first, segment.first + segment.ramps))
        repeats = scene.solved_cycles(segment.repeat) - 1
        graded += repeats * sum(scene.ramps[place].increments for place in places)
    return f"{count}, {graded} of them even in the contact radius"


def _counted(sources: Sequence[Source]) -> str:
    return f"{len(sources)} region{'s' if len(sources) != 1 else ''}"


def _alike(sources: Sequence[Source]) -> list[str]:
    groups: dict[tuple[str, str, int], list[str]] = {}
    for source in sources:
        groups.setdefault((source.key, source.how, source.body), []).append(source.name)
    lines = []
    for (key, description, body), names in groups.items():
        label = names[0] if len(names) == 1 else f"{names[0]} ... {names[-1]}, {len(names)} of them"
        lines.append(f"  {label} (plugin {key!r}, body {body}): {description}")
    return lines


def _body(plan: Plan, index: int) -> str:
    bodies = plan.model.bodies
    return f"body {index + 1} {body_in_words(bodies.solids[index], bodies.laws.get(index + 1))}"


def _bytes(value: float) -> str:
    return f"{value / 1e6:.3g} MB" if value >= 1e5 else f"{value / 1e3:.3g} kB"


def _time(seconds: float) -> str:
    return time_in_words(seconds) if seconds >= 1 else f"{float(f'{1e3 * seconds:.2g}'):g} ms"
