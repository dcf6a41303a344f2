"""Solution of a planned scene: its load steps, in order, into a store."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

from eigencontact.core.stopwatch import Stopwatch
from eigencontact.errors import DomainTooSmall

if TYPE_CHECKING:
    from eigencontact.accuracy.bars import Run
    from eigencontact.execution.run.driver import Watcher
    from eigencontact.planning.plan import Plan
    from eigencontact.results.memory import MemoryStore
    from eigencontact.results.records import StepRecord
    from eigencontact.results.store import ResultStore

    Store = ResultStore | MemoryStore

__all__ = ["Solved", "numbers_and_warnings", "solve_stored", "solver_in_memory"]


class Solved(NamedTuple):
    """The last step, and the time of solving [s]."""

    last: StepRecord
    seconds: float


def solve_stored(
    planned: Plan,
    store: Store,
    watcher: Watcher | None,
    stopwatch: Stopwatch,
    accepted: Mapping[int, Callable[[], StepRecord]],
) -> Solved:
    """Solve and store all steps that are not stored yet."""
    from eigencontact.execution.run.driver import drive

    last = accepted[max(accepted)]() if accepted else None
    solving, resumed = 0.0, perf_counter()
    try:
        for record in drive(planned, watcher=watcher, stopwatch=stopwatch, stored_steps=accepted):
            solving += perf_counter() - resumed
            with stopwatch.on("storing"):
                store.write_step(record)
            last, resumed = record, perf_counter()
    except DomainTooSmall as problem:
        from eigencontact.planning.room import with_room

        raise with_room(problem, planned.model, problem.step) from problem
    assert last is not None
    return Solved(last, solving)


def numbers_and_warnings(planned: Plan, store: Store, last: StepRecord) -> dict[str, Any]:
    """Numbers of all steps and of the run, and the warnings about their accuracy."""
    from eigencontact.warnings_.after import noticed

    history = store.history(last)
    cautions = [*noticed(planned.model, planned.blocks, last, history)]
    numbers: dict[str, float] = {}
    if planned.conclusions:
        with store.opened() as results:
            findings = [conclusion.conclude(results) for conclusion in planned.conclusions]
        store.append(variable for item in findings for variable in item.variables)
        cautions += [caution for item in findings for caution in item.cautions]
        numbers = {name: value for item in findings for name, value in item.numbers.items()}
    return {"history": history, "warnings": [caution.to_dict() for caution in cautions], **numbers}


class StoredInMemory(NamedTuple):
    """Results of a run in memory, for storage."""

    store: MemoryStore
    solved: Solved


def _solved_in_memory(planned: Plan) -> tuple[StoredInMemory, dict[str, Any]]:
    """Solve a plan without a folder; return the data for storage, and the summary."""
    from eigencontact.planning.provenance import run_info
    from eigencontact.results.memory import MemoryStore
    from eigencontact.results.summary import summary_of

    store = MemoryStore(run_info(planned))
    solved = solve_stored(planned, store, None, Stopwatch(), {})
    noted = numbers_and_warnings(planned, store, solved.last)
    return StoredInMemory(store, solved), summary_of(store.info, solved.last, noted["history"], noted)


def solver_in_memory(watcher: Watcher | None) -> Callable[[Plan, str], Run]:
    """Solver of runs in memory that reports to the watcher."""
    from eigencontact.accuracy.bars import Run

    announced = getattr(watcher, "announced", None)

    def solve(planned: Plan, words: str) -> Run:
        if announced is not None:
            announced(words)
        stored, summary = _solved_in_memory(planned)
        return Run(planned, summary, stored.store.results(), stored)

    return solve
