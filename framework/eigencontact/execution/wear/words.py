"""Text of a plan about wear: law, motion of the surfaces, cycles, and neglected effects."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from eigencontact.core.cautions import LeftOut
from eigencontact.execution.wear.cautions import shift_by_radius
from eigencontact.model.model import Model
from eigencontact.model.resolution import percent
from eigencontact.model.wear import WearModel
from eigencontact.model.words import sizes
from eigencontact.scene.schema import Step
from eigencontact.scene.wear import Wear

__all__ = ["left_out_of_wear", "wear_lines"]


def wear_lines(wear: WearModel, steps: Sequence[Step]) -> list[str]:
    """Law and bodies, motion of the surfaces, and the number of cycles that will be solved."""
    table, law = wear.table, wear.law
    bodies = " and ".join(f"body {body}" for body in table.parts)
    if len(table.parts) > 1:
        bodies = " and ".join(f"body {body} by {share:.3g} of the depth" for body, share in table.parts.items())
    words = ", ".join(text for text in (law.key, sizes(law)) if text)
    method = "implicit in the pressure" + ("" if law.linear_in_pressure else ", linearised")
    cycles = any(step.cycle is not None for step in steps)
    when = "at the end of each cycle" if cycles and table.update == "cycle" else "by each increment"
    lines = [f"wear        {bodies}: {words}", f"            the surface moves {when}, {method}"]
    repeats = [step.repeat for step in steps if step.repeat > 1]
    return [*lines, *(f"            {repeat} cycles, {_solved_cycles(repeat, table)}" for repeat in repeats)]


def _solved_cycles(repeat: int, table: Wear) -> str:
    """Number of solved cycles in words."""
    count = table.solved_cycles(repeat)
    if count == repeat:
        return "all of them solved"
    if table.error is None:
        return f"{count} of them solved: one for {table.cycles_per_update} cycles"
    return f"about {count} of them solved, for an error of the worn volume of at most {percent(table.error)}"


def left_out_of_wear(model: Model, table: Wear) -> list[LeftOut]:
    """Effects that the wear model neglects."""
    out = [
        LeftOut("debris, a third body and transfer", "wear removes material, and the model deposits none"),
        LeftOut(
            "slopes of the worn surfaces",
            "half-spaces remain flat, and the gap grows by the worn depth: valid for depths small against the contact",
        ),
    ]
    ratio = shift_by_radius(model)
    if ratio:
        share = "" if ratio == inf else f", up to {percent(ratio)} of its radius"
        out.append(
            LeftOut(
                f"motion of the contact over body 1 by shift-x and shift-y{share}",
                "a shift makes the surfaces slip and does not move the contact; travel-x and travel-y move it",
            )
        )
    for step in model.scene.steps:
        skipped = step.repeat - table.solved_cycles(step.repeat)
        if step.cycle is not None and skipped:
            most = f"{'' if table.error is None else 'about '}{skipped} of {step.repeat} cycles"
            out.append(LeftOut(most, "their wear is extrapolated from the solved cycles"))
    return out
