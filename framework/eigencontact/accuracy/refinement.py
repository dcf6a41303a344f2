"""Division of cells at inclusions that a scene leaves to the program, from two runs on coarse cells."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import ceil
from typing import TYPE_CHECKING, Any

from eigencontact.accuracy.bars import Run, error_bars
from eigencontact.accuracy.changes import changed
from eigencontact.accuracy.runs import edge_of
from eigencontact.accuracy.sources import SOURCES
from eigencontact.accuracy.targets import targets_of
from eigencontact.core.cautions import Caution
from eigencontact.errors import EigencontactError, SceneError
from eigencontact.execution.mechanics.mechanics import Mechanics
from eigencontact.model.resolution import percent
from eigencontact.scene.accuracy import Accuracy
from eigencontact.scene.numerics import MOST_REFINED

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan

__all__ = ["with_refinement"]

#: Largest error of a main result by the cells at inclusions, relative to the result.
_ALLOWED = 0.02
#: Largest number that is chosen: a run with 4 takes about 20 times the time of a run with 1.
_MOST = 4
_CELLS, _AT_INCLUSIONS = (
    next(source for source in SOURCES if source.name == name) for name in ("cells", "cells at inclusions")
)


def with_refinement(
    plan: Plan, make: Callable[[Mapping[str, Any]], Plan], solve: Callable[[Plan, str], Run]
) -> tuple[Plan, Caution | None]:
    """Plan of a scene with a number in place of ``numerics.inclusion-refinement = "auto"``.

    The number is the smallest one for which the error of each main result of the contact by the cells at inclusions is
    within 2 % of the result, at most 4. The largest stress in a region and numbers of observers do not count: a peak at
    an inclusion may rise with every refinement. A run on coarse cells, and one with cells divided in two at inclusions,
    give the error, which is of first order. A scene with an accuracy gets 1, as the accuracy refines all cells. So does
    a scene that cannot have finer cells or has no body that yields around an inclusion.

    Parameters
    ----------
    plan : Plan
        Of the scene.
    make, solve : callable
        `make` returns the plan of the tables of a scene; `solve` takes a plan and its difference in words, and returns
        its run in memory.

    Returns
    -------
    Plan
        With the number.
    Caution or None
        Warning of the run if 4 leaves an error above 2 %.

    Raises
    ------
    SceneError
        A run on coarse cells fails.
    """
    refinement = 1
    caution: Caution | None = None
    if plan.scene.accuracy is None and _AT_INCLUSIONS.applies(plan):
        refinement, caution = _chosen(plan, make, solve)
    tables = plan.scene.resolved()
    return make({**tables, "numerics": {**tables["numerics"], "inclusion-refinement": refinement}}), caution


def _chosen(
    plan: Plan, make: Callable[[Mapping[str, Any]], Plan], solve: Callable[[Plan, str], Run]
) -> tuple[int, Caution | None]:
    """Refinement by two runs on coarse cells, and the warning if it does not suffice."""
    words = "choice of numerics.inclusion-refinement"

    def coarser(tables: Mapping[str, Any], difference: str) -> Run:
        return solve(make(tables), f"{words}: {difference}")._replace(storage=None)

    numerics: dict[str, float] = {"inclusion-refinement": 1}
    coarsest = _CELLS.variations(plan)[-1]
    if plan.numerics.inclusion_pitch is not None:
        numerics["inclusion-pitch"] = coarsest.ratio * plan.numerics.inclusion_pitch
    tables = changed(plan.scene.resolved(), {"numerics": numerics})
    try:
        coarse = coarser(changed(tables, coarsest.changes), "coarse cells")
        accuracy = error_bars(coarse.plan, coarse.summary, coarser, sources=[_AT_INCLUSIONS])
    except EigencontactError as problem:
        raise _failed(" ".join(str(problem).split())) from problem
    if not accuracy.runs or accuracy.left_out.get(_AT_INCLUSIONS.name):
        raise _failed(accuracy.left_out[_AT_INCLUSIONS.name])
    contact_numbers = {number.name for block in plan.blocks if isinstance(block, Mechanics) for number in block.numbers}
    declared = coarse.summary["numbers"]
    bars = {
        name: bar
        for name, bar in accuracy.bars.items()
        if name in contact_numbers and not declared[name].get("scatters")
    }
    try:
        targets = targets_of(Accuracy(numbers=_ALLOWED), coarse.summary, accuracy, bars)
    except SceneError:  # the cells at inclusions change no main result
        return 1, None
    size = edge_of(coarse.plan) / edge_of(plan)
    required = {name: bars[name].error / (size * allowed) for name, allowed in targets.allowed.items()}
    worst = max(required, key=lambda name: required[name])
    refinement = min(_MOST, max(1, ceil(required[worst])))
    return refinement, _insufficient(plan, worst, required[worst]) if required[worst] > refinement else None


def _insufficient(plan: Plan, name: str, required: float) -> Caution:
    """Warning of a number that requires a larger refinement than the largest one."""
    error, grid = _ALLOWED * required / _MOST, plan.scene.grid
    key = "cells" if grid.spacing is None else "spacing"
    keys = ["grid." + ("cells-per-contact-radius" if grid.automatic and plan.scene.geometry else key)]
    if plan.numerics.inclusion_pitch is not None:
        keys.append("numerics.inclusion-pitch")
    words = (
        f"the estimated error of {name} by the cells at inclusions is {percent(error)}, above {percent(_ALLOWED)}, "
        f'with numerics.inclusion-refinement = {_MOST}, the largest that "auto" takes; use finer cells '
        f"({' and '.join(keys)}), or give a number up to {MOST_REFINED}"
    )
    return Caution("inclusion-refinement", words, error)


def _failed(reason: str) -> SceneError:
    return SceneError(
        f'numerics.inclusion-refinement must be a number where the runs that choose it fail (got "auto": {reason}); '
        "give 2, or leave it out"
    )
