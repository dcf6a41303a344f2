"""A plan in words, and as data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from eigencontact.core.units import readable
from eigencontact.planning.bodies import body_in_words, layers_in_words

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan
    from eigencontact.planning.sources import Source

__all__ = ["as_data", "explain"]


def explain(plan: Plan) -> str:
    """Return what will be modelled, with which kernels, sizes, memory and time; and what is left out and why."""
    from eigencontact.planning.cost import resident_bytes

    scene, grid = plan.scene, plan.grid
    layers = layers_in_words(plan.bodies, periodic=scene.numerics.boundary == "periodic")
    width, height = grid.size
    pitch = f"{readable(grid.dx, 'm')} x {readable(grid.dy, 'm')}"
    lines = [f"{plan.name}: {scene.title}" if scene.title else plan.name, ""]
    lines += [
        f"bodies      {_body(plan, 0)}; {_body(plan, 1)}",
        *([f"layers      {layers}"] if layers else []),
        f"grid        {grid.nx} x {grid.ny} cells of {pitch}; {plan.grid_reason}",
        f"window      {readable(width, 'm')} x {readable(height, 'm')}",
        f"numerics    {_numerics(plan)}",
        *([] if plan.friction is None else [f"friction    {plan.friction}"]),
        f"load        {plan.steps} step{'s' if plan.steps != 1 else ''}",
        "",
        *_inclusions(plan),
        "blocks, in order",
    ]
    for group in plan.groups:
        for block in group:
            cost = block.cost
            price = f"{_bytes(cost.peak)}, {_time(cost.seconds_once + plan.steps * cost.seconds_per_step)}"
            together = " (solved together)" if len(group) > 1 else ""
            lines.append(f"  {block.name}{together}: {block.why}" + (f"  [{price}]" if cost.peak else ""))
    lines += ["", f"kernels, {len(plan.kernels)} in all"]
    lines += [f"  {kernel}" for kernel in plan.kernels]
    base = resident_bytes()
    lines += [
        "",
        f"predicted   {_bytes(plan.cost.peak)} of arrays, {_bytes(base + plan.cost.peak)} with the libraries",
        f"            {_time(plan.seconds)} of solving",
        "",
        "left out, and why",
    ]
    lines += [f"  {item.what}: {item.why}" for item in plan.left_out]
    return "\n".join(lines)


def as_data(plan: Plan) -> dict[str, object]:
    """Return the plan as plain data."""
    from eigencontact.planning.cost import resident_bytes

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
        "inclusions": [
            {
                "name": source.name,
                "plugin": source.key,
                "body": source.body,
                "bounds": [list(corner) for corner in source.shape.bounds],
                "exact": source.lattice is None,
                "how": source.how,
                "cells": 0 if source.lattice is None else source.lattice.cells,
                "material": None if source.material is None else source.material.type,
            }
            for source in plan.sources
        ],
        "blocks": [
            {
                "name": block.name,
                "why": block.why,
                "requires": sorted(block.requires),
                "provides": sorted(block.provides),
                "memory_bytes": block.cost.peak,
                "seconds": block.cost.seconds_once + plan.steps * block.cost.seconds_per_step,
            }
            for block in plan.blocks
        ],
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
        "predicted_memory_bytes": plan.cost.peak + resident_bytes(),
        "predicted_array_bytes": plan.cost.peak,
        "predicted_seconds": plan.seconds,
        "left_out": [{"what": item.what, "why": item.why} for item in plan.left_out],
        "references": list(references(plan)),
        "scene": plan.scene.resolved(),
    }


def references(plan: Plan) -> tuple[str, ...]:
    """Sources to cite for what the plan uses, each once."""
    texts = [text for component in plan.components for text in component.references]
    if plan.sources:
        texts += [
            "R. D. Mindlin, D. H. Cheng, J. Appl. Phys. 21 (1950) 926",
            "S. Liu, X. Jin, Z. Wang et al., Int. J. Plasticity 35 (2012) 135",
        ]
    if any(source.material is not None for source in plan.sources):
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
    words.append(f"{numerics.precision} precision")
    if plan.friction is not None:
        words.append(f"coupling {numerics.coupling}")
    return ", ".join([*words, f"tolerance {numerics.tolerance:g}"] if plan.geometries else words)


def _inclusions(plan: Plan) -> list[str]:
    """Every region with eigenstrain and how its field is found; like ones on one line."""
    if not plan.sources:
        return []
    prescribed = [source for source in plan.sources if source.material is None]
    lines = _alike(prescribed)
    if prescribed:
        lines.insert(0, f"eigenstrain, {_counted(prescribed)}")
    if len(prescribed) < len(plan.sources):
        from eigencontact.planning.inhomogeneities import boxes_of

        for body, box in boxes_of(plan.sources).items():
            (nz, ny, nx), (dz, dy, dx) = box.lattice.shape, box.lattice.edges
            edges = " x ".join(readable(edge, "m") for edge in (dx, dy, dz))
            lines.append(
                f"inhomogeneities of body {body}, {_counted(box.sources)} in {nx} x {ny} x {nz} cells of {edges}"
            )
            lines += _alike(box.sources)
        whole = [source for source in plan.sources if source.material is not None and source.lattice is None]
        lines += [f"whole inhomogeneities, {_counted(whole)}", *_alike(whole)] if whole else []
    return [*lines, ""]


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
    return f"body {index + 1} {body_in_words(plan.bodies[index])}"


def _bytes(value: float) -> str:
    return f"{value / 1e6:.3g} MB" if value >= 1e5 else f"{value / 1e3:.3g} kB"


def _time(seconds: float) -> str:
    return f"{seconds:.2g} s" if seconds >= 1 else f"{1e3 * seconds:.2g} ms"
