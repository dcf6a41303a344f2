"""Error bars of a run, with the errors of its fields stored beside the fields."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from eigencontact.accuracy.bars import error_bars
from eigencontact.accuracy.fields import FieldErrors

if TYPE_CHECKING:
    from eigencontact.accuracy.bars import Run
    from eigencontact.planning.plan import Plan
    from eigencontact.results.layout import Variable
    from eigencontact.results.memory import MemoryStore
    from eigencontact.results.store import ResultStore

__all__ = ["stored_errors"]


def stored_errors(
    plan: Plan,
    summary: Mapping[str, Any],
    store: ResultStore | MemoryStore,
    make: Callable[[Mapping[str, Any]], Plan],
    solve: Callable[[Plan, str], Run],
) -> dict[str, Any]:
    """Estimate the errors of all numbers and fields of a finished run, and store the errors of the fields.

    Parameters
    ----------
    plan, summary, store
        The run: its plan, the contents of its ``summary.json`` and its results.
    make, solve : callable
        `make` returns the plan of the tables of a scene; `solve` takes a plan and its difference in words, and returns
        its run in memory.

    Returns
    -------
    dict
        Plain data for ``summary.json``: entries of `Accuracy`, and ``field_errors``.
    """
    with ExitStack() as stack:
        fields = FieldErrors(stack.enter_context(store.opened()), summary)

        def coarser(tables: Mapping[str, Any], words: str) -> Run:
            return solve(make(tables), f"error bars: {words}")._replace(storage=None)

        accuracy = error_bars(plan, summary, coarser, fields)

        def variables() -> Iterator[Variable]:
            yield from fields.variables(accuracy.bars)
            stack.close()  # before the file is replaced

        store.append(variables())
    return accuracy.to_dict() | fields.to_dict()
