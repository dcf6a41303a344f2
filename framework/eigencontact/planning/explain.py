"""A plan in words, and as data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from eigencontact.core.units import readable, time_in_words
from eigencontact.model.bodies import body_in_words, layers_in_words
from eigencontact.model.overlaps import WHAT_COUNTS, overlapping
from eigencontact.model.resolution import percent
from eigencontact.planning.memory import run_bytes
from eigencontact.scene.steps import segments_of, solved_cycles, spaced_by_radius
from eigencontact.warnings_.before import worst_above
from eigencontact.warnings_.sizes import (
    body_laws,
    contact_as_data,
    expected_lines,
    geometry_lines,
    largest_loads,
    law_lines,
    wear_lines,
)

if TYPE_CHECKING:
    from eigencontact.execution.blocks.block import Block
    from eigencontact.model.sources import Source
    from eigencontact.planning.plan import Plan

__all__ = ["Told", "as_data", "explain", "references", "told"]


@dataclass(frozen=True, kw_only=True)
class Told:
    """A plan in words, by paragraph.

    Attributes
    ----------
    title : str
        Name of the scene, and its title where it has one.
    facts : list of str
        Bodies, geometry, grid ...: a name of `eigencontact.results.records.FACT_NAME` characters, empty where a line
        continues the one before it, then what is said.
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


def told(plan: Plan) -> Told:
    """Return what will be modelled, with which kernels, sizes, memory and time; and what is left out and why."""
    scene, grid = plan.scene, plan.grid
    layers = layers_in_words(plan.bodies, periodic=scene.numerics.boundary == "periodic")
    width, height = grid.size
    pitch = f"{readable(grid.dx, 'm')} x {readable(grid.dy, 'm')}"
    facts = [
        f"bodies      {_body(plan, 0)}; {_body(plan, 1)}",
        *([f"layers      {layers}"] if layers else []),
        *law_lines(plan),
        *geometry_lines(plan),
        f"grid        {grid.nx} x {grid.ny} cells of {pitch}; {plan.grid_reason}",
        f"window      {readable(width, 'm')} x {readable(height, 'm')}",
        f"numerics    {_numerics(plan)}",
        *(f"            {precision}" for precision in plan.precisions),
        *([] if plan.friction is None else [f"friction    {plan.friction}"]),
        *wear_lines(plan),
        f"load        {_steps(plan)}{largest_loads(plan.scene)}",
        *expected_lines(plan),
    ]
    blocks = []
    for block in plan.blocks:
        for part in block.parts:
            seconds = part.cost.seconds_once + plan.steps * part.cost.seconds_per_step
            price = ", ".join([*([_bytes(part.cost.peak)] if part.cost.peak else []), _time(seconds)])
            together = " (solved together)" if len(block.parts) > 1 else ""
            blocks.append(f"{part.name}{together}: {part.why}" + (f"  [{price}]" if seconds else ""))
    return Told(
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
        left_out=[(item.what, item.why) for item in plan.left_out],
    )


def explain(plan: Plan) -> str:
    """Return a plan as text: all paragraphs of `told`."""
    said = told(plan)
    lines = [said.title, "", *said.facts, ""]
    lines += ["warnings", *(f"  {words}" for words in said.cautions), ""] if said.cautions else []
    lines += [*said.inclusions, ""] if said.inclusions else []
    lines += ["blocks, in order", *(f"  {line}" for line in said.blocks), ""]
    lines += [f"kernels, {len(said.kernels)} in all", *(f"  {line}" for line in said.kernels), ""]
    lines += [*said.predicted, "", "left out, and why"]
    return "\n".join([*lines, *(f"  {what}: {why}" for what, why in said.left_out)])


def as_data(plan: Plan) -> dict[str, object]:
    """Return the plan as plain data."""
    return {
        "name": plan.name,
        "title": plan.scene.title,
        "grid": {
            "cells": [plan.grid.nx, plan.grid.ny],
            "spacing": [plan.grid.dx, plan.grid.dy],
            "center": list(plan.grid.center),
            "reason": plan.grid_reason,
        },
        "steps": plan.steps,
        "expected": None if plan.expected is None else contact_as_data(plan.expected, plan.grid),
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
            for source in plan.sources
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
        "left_out": [{"what": item.what, "why": item.why} for item in plan.left_out],
        "references": list(references(plan)),
        "scene": plan.scene.resolved(),
    }


def _block_as_data(block: Block, steps: int) -> dict[str, object]:
    return {
        "name": block.name,
        "why": block.why,
        "requires": sorted(block.requires),
        "provides": sorted(block.provides),
        "parts": [part.name for part in block.parts],
        "memory_bytes": block.cost.peak,
        "seconds": block.cost.seconds_once + steps * block.cost.seconds_per_step,
    }


def references(plan: Plan) -> tuple[str, ...]:
    """Sources to cite for what the plan uses, each once."""
    texts = [text for component in plan.components for text in component.references]
    if plan.sources:
        texts += [
            "R. D. Mindlin, D. H. Cheng, J. Appl. Phys. 21 (1950) 926",
            "S. Liu, X. Jin, Z. Wang et al., Int. J. Plasticity 35 (2012) 135",
        ]
    if plan.inhomogeneities:
        texts += [
            "J. D. Eshelby, Proc. R. Soc. Lond. A 241 (1957) 376",
            "K. Zhou, W. W. Hoh, X. Wang et al., Mech. Mater. 60 (2013) 144",
        ]
    if plan.geometries:
        texts += [
            "I. A. Polonsky, L. M. Keer, Wear 231 (1999) 206, doi:10.1016/S0043-1648(99)00113-1",
            "E. A. H. Vollebregt, J. Tribol. 136 (2014) 041402",
        ]
    if plan.friction is not None:
        texts += ["L. Gallego, D. Nélias, S. Deyber, Wear 268 (2010) 208, doi:10.1016/j.wear.2009.07.019"]
    return tuple(dict.fromkeys(texts))


_SPACES = {
    "exact": "exact half-space",
    "full-space": "full space (the free surface is left out)",
    "image-pressure": "half-space by image and sampled pressure (approximate)",
    "periodic": "half-space whose eigenstrain repeats with the window",
}


def _numerics(plan: Plan) -> str:
    numerics = plan.scene.numerics
    words: list[str] = [numerics.boundary] if plan.geometries else []
    if plan.sources:
        words.append(_SPACES[numerics.half_space])
    auto = "precision by operator" if plan.precisions else "double precision"
    words.append(auto if numerics.precision == "auto" else f"{numerics.precision} precision")
    if plan.friction is not None:
        words.append(f"coupling {numerics.coupling}")
    return ", ".join([*words, f"tolerance {numerics.tolerance:g}"] if plan.geometries else words)


def _inclusions(plan: Plan) -> list[str]:
    """Every region with eigenstrain and how its field is found; like ones on one line."""
    if not plan.sources:
        return []
    lines = [f"eigenstrain, {_counted(plan.prescribed)}", *_alike(plan.prescribed)] if plan.prescribed else []
    for body in (1, 2):
        sources = [source for source in plan.inhomogeneities if source.body == body]
        if not sources:
            continue
        if sources[0].lattice is None:
            lines += [f"whole inhomogeneities, {_counted(sources)}", *_alike(sources)]
            continue
        from eigencontact.model.boxes import box_of_inhomogeneities

        box = box_of_inhomogeneities(sources)
        edges = " x ".join(readable(edge, "m") for edge in box.lattice.edges[::-1])
        worst = worst_above(plan, body)
        above = "" if worst is None else f"; pressure above them within some {percent(worst.error)}"
        lines.append(f"inhomogeneities of body {body}, {_counted(sources)} in {box.words} of {edges}{above}")
        lines += _alike(sources)
    if next(overlapping(plan.sources), None) is not None:
        lines.append(f"  where they overlap: {WHAT_COUNTS}")
    return lines


def _steps(plan: Plan) -> str:
    wear = plan.scene.wear
    repeats = [step.repeat for step in plan.scene.steps]
    guessed = wear is not None and wear.error and any(solved_cycles(repeat, wear) < repeat for repeat in repeats)
    count = f"{'about ' if guessed else ''}{plan.steps} step{'s' if plan.steps != 1 else ''}"
    if plan.growth is None:
        return count
    first, repeated = spaced_by_radius(plan.scene.steps, friction=plan.friction is not None)
    graded = sum(plan.scene.ramps[place].increments for place in first)
    for segment in segments_of(plan.scene.steps):
        passes = (segment.repeat if wear is None else solved_cycles(segment.repeat, wear)) - 1
        places = repeated.intersection(range(segment.first, segment.first + segment.ramps))
        graded += passes * sum(plan.scene.ramps[place].increments for place in places)
    return f"{count}, {graded} of them even in the contact radius"


def _counted(sources: Sequence[Source]) -> str:
    return f"{len(sources)} region{'s' if len(sources) != 1 else ''}"


def _alike(sources: Sequence[Source]) -> list[str]:
    groups: dict[tuple[str, str, int], list[str]] = {}
    for source in sources:
        groups.setdefault((source.key, source.how, source.body), []).append(source.name)
    lines = []
    for (key, how, body), names in groups.items():
        who = names[0] if len(names) == 1 else f"{names[0]} ... {names[-1]}, {len(names)} of them"
        lines.append(f"  {who} (plugin {key!r}, body {body}): {how}")
    return lines


def _body(plan: Plan, index: int) -> str:
    return f"body {index + 1} {body_in_words(plan.bodies[index], body_laws(plan).get(index + 1))}"


def _bytes(value: float) -> str:
    return f"{value / 1e6:.3g} MB" if value >= 1e5 else f"{value / 1e3:.3g} kB"


def _time(seconds: float) -> str:
    return time_in_words(seconds) if seconds >= 1 else f"{float(f'{1e3 * seconds:.2g}'):g} ms"
