"""Selection of the source of error to refine: the largest decrease of the error per increase of time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, log
from typing import TYPE_CHECKING, Any

from eigencontact.accuracy.changes import changed
from eigencontact.accuracy.runs import memory_of
from eigencontact.accuracy.sources import EDGES, SOURCES, ErrorSource, error_sources
from eigencontact.errors import EigencontactError

if TYPE_CHECKING:
    from eigencontact.accuracy.targets import Targets
    from eigencontact.core.numbers import ErrorBar
    from eigencontact.planning.plan import Plan

__all__ = ["SHARE", "Lever", "Refinement", "cheapest", "levers_of"]

#: Share of a target that a prediction aims at: orders are not exact.
SHARE = 0.85
#: Factor of one decision for the cells, whose number is free, and for other settings, whose change must show.
_CELLS, _LEAST = 1.1, 1.5
#: Factor for the prediction of a price where the larger factor exceeds the memory of the machine.
_LITTLE = 1.25
#: Largest factor of one rung: its error bars compare it with earlier runs.
_CELLS_AT_ONCE = 3.0
#: Least power of the time: a tenth of a tolerance of 1e-6 takes a sixth more iterations, which no prediction contains.
_FREE = 0.067
#: Least power of the time for cells: with few cells the fixed part of a run hides the growth with their number.
_SQUARE = 2.0
#: Least relative decrease of the errors beyond the targets for which a source is refined.
_SMALL = 0.01


@dataclass(frozen=True, kw_only=True)
class Lever:
    """A source of error with its price.

    Attributes
    ----------
    source : ErrorSource
    seconds, memory : float
        Powers of the factor with which the predicted time and memory rise.
    """

    source: ErrorSource
    seconds: float
    memory: float

    @property
    def step(self) -> float:
        """Factor of one decision."""
        if self.source.name == "cells":
            return _CELLS
        if self.source.of_cells:  # a whole number divides cells
            return self.source.stride
        return _LEAST if self.source.stride == 2.0 else self.source.stride

    @property
    def at_once(self) -> float:
        """Largest factor of one rung."""
        return _CELLS_AT_ONCE if self.source.name == "cells" else self.source.stride**2


@dataclass(frozen=True, kw_only=True)
class Refinement:
    """Refinement factors of the sources of error, with the predicted errors, time and memory.

    Attributes
    ----------
    factors : dict of str to float
        By name of the source.
    seconds, memory : float
        Predicted time and memory in those of the run that is refined.
    errors : dict of str to float
        Predicted error of each number with a target.
    holds : bool
        Whether all targets hold with these errors.
    """

    factors: dict[str, float]
    seconds: float
    memory: float
    errors: dict[str, float]
    holds: bool

    def changes(self, plan: Plan, tables: Mapping[str, Any]) -> dict[str, Any]:
        """Tables with the finer settings."""
        for source in error_sources(plan):
            if source.finer is not None and source.name in self.factors:
                output = tables["output"]
                tables = changed(tables, source.finer(plan, self.factors[source.name])) | {"output": output}
        return dict(tables)


def levers_of(plan: Plan, make: Callable[[Mapping[str, Any]], Plan]) -> list[Lever]:
    """Refinable sources of error of a plan, with the predicted time and memory of their refinement."""
    levers = []
    for source in error_sources(plan):
        lever = next(filter(None, (_lever(plan, source, factor, make) for factor in (source.stride, _LITTLE))), None)
        if lever is not None:
            levers.append(lever)
    return levers


def _lever(plan: Plan, source: ErrorSource, factor: float, make: Callable[[Mapping[str, Any]], Plan]) -> Lever | None:
    """Refinement of one source by the plan of the finer scene; None if it is not possible or the plan is refused."""
    if source.finer is None:
        return None
    try:
        finer = make(changed(plan.scene.resolved(), source.finer(plan, factor)))
    except EigencontactError:
        return None
    if finer.scene.model_dump(exclude={"output"}) == plan.scene.model_dump(exclude={"output"}):
        return None
    seconds, memory = (
        log(max(finer_cost, 1e-12) / max(cost, 1e-12)) / log(factor)
        for finer_cost, cost in ((finer.seconds, plan.seconds), (memory_of(finer), memory_of(plan)))
    )
    least = _SQUARE if source.name == "cells" else _FREE
    return Lever(source=source, seconds=max(least, seconds), memory=max(0.0, memory))


def cheapest(
    levers: Sequence[Lever],
    bars: Mapping[str, ErrorBar],
    targets: Targets,
    *,
    orders: Mapping[str, float] | None = None,
    time: float = inf,
    memory: float = inf,
    far: bool = False,
) -> Refinement:
    """Refine the source with the largest decrease of errors per increase of time, until all targets hold.

    Parameters
    ----------
    levers : sequence of Lever
    bars : mapping of str to ErrorBar
        Present errors; each share falls with its observed order, or with the lowest order of its source.
    targets : Targets
    orders : mapping of str to float, optional
        Better orders of numbers with the cells: that of a warning, or that between two rungs.
    time, memory : float
        Largest time and memory, in those of the run that is refined.
    far : bool
        Whether factors may be larger than those of one rung, to predict the cost of all targets.
    """
    falls = {
        (name, lever.source.name): _order(lever.source, bars[name], (orders or {}).get(name))
        for name in targets.allowed
        for lever in levers
    }
    least_errors = {source.name: source.lowest for source in SOURCES if source.is_least_error}
    falls |= {(name, source): order for name in targets.allowed for source, order in least_errors.items()}
    factors = dict.fromkeys((lever.source.name for lever in levers), 1.0)
    of_cells = {lever.source.name for lever in levers if lever.source.of_cells}
    postponed = set[str]()

    def refinement_of(source: str, trial: Mapping[str, float]) -> float:
        if source in least_errors:
            return trial.get("cells", 1.0)
        everywhere = [trial[name] for name in EDGES if name in trial]
        return trial.get(source, 1.0) * (min(everywhere, default=1.0) if source in of_cells else 1.0)

    def errors(trial: Mapping[str, float]) -> dict[str, float]:
        return {
            name: sum(
                share / refinement_of(source, trial) ** falls.get((name, source), 0.0)
                for source, share in bars[name].parts.items()
                if source not in postponed
            )
            for name in targets.allowed
        }

    def price(trial: Mapping[str, float], kind: str) -> float:
        out = 1.0
        for lever in levers:
            out *= trial[lever.source.name] ** getattr(lever, kind)
        return out

    # a number that holds need not become better; one that does not has the margin of a prediction
    limits = {
        name: limit * (share if SHARE < (share := errors(factors)[name] / limit) <= 1.0 else SHARE)
        for name, limit in targets.allowed.items()
    }
    aims = replace(targets, allowed=limits)
    excess = aims.excess(errors(factors))
    while excess > 0.0:
        seconds, best, gain = price(factors, "seconds"), None, 0.0
        for lever in (lever for lever in levers if lever.source.name not in postponed):
            trial = {**factors, lever.source.name: factors[lever.source.name] * lever.step}
            affordable = price(trial, "seconds") <= time and price(trial, "memory") <= memory
            fall = excess - aims.excess(errors(trial))
            fall_per_time = fall / (price(trial, "seconds") - seconds)
            if affordable and fall_per_time > gain and fall > _SMALL * excess:
                best, gain = (lever, trial), fall_per_time
        if best is None:
            break
        lever, trial = best
        if trial[lever.source.name] > (1e4 if far else 1.001 * lever.at_once):
            postponed.add(lever.source.name)  # finer in the next rung: other sources cannot make up for its error
        else:
            factors = trial
        excess = aims.excess(errors(factors))
    postponed.clear()
    predicted = errors(factors)
    return Refinement(
        factors={name: factor for name, factor in factors.items() if factor > 1.0},
        seconds=price(factors, "seconds"),
        memory=price(factors, "memory"),
        errors=predicted,
        holds=targets.excess(predicted) == 0.0,
    )


def _order(source: ErrorSource, bar: ErrorBar, order_of_cells: float | None) -> float:
    """Order of convergence of the contribution of a source."""
    if source.name == "cells" and order_of_cells is not None:
        return order_of_cells
    if source.name == bar.source and bar.order is not None:
        return min(bar.order, source.highest)
    return source.lowest
