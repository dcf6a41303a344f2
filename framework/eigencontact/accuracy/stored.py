"""Error bars of a run, with the errors of its fields stored beside the fields."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from eigencontact.accuracy.bars import error_bars
from eigencontact.accuracy.fields import FieldErrors
from eigencontact.results.memory import MemoryResults

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan
    from eigencontact.results.layout import Variable
    from eigencontact.results.memory import MemoryStore
    from eigencontact.results.store import ResultStore

__all__ = ["stored_errors"]

#: Solves a scene given by its tables, with what differs in words: plan, summary and results of its run in memory.
Solve = Callable[[Mapping[str, Any], str], "tuple[Plan, dict[str, Any], MemoryResults]"]


def stored_errors(
    plan: Plan, summary: Mapping[str, Any], store: ResultStore | MemoryStore, solve: Solve
) -> dict[str, Any]:
    """Estimate the errors of all numbers and fields of a finished run, and store those of the fields.

    Returns
    -------
    dict
        Plain data for ``summary.json``: those of `Accuracy`, and ``field_errors``.
    """
    with ExitStack() as stack:
        fields = FieldErrors(stack.enter_context(store.opened()), summary)

        def kept(tables: Mapping[str, Any], words: str) -> tuple[Plan, dict[str, Any]]:
            coarse, coarse_summary, results = solve(tables, words)
            fields.keep(coarse_summary, results)
            return coarse, coarse_summary

        bars = error_bars(plan, summary, kept, fields)

        def variables() -> Iterator[Variable]:
            yield from fields.variables(bars.bars)
            stack.close()  # before the file is replaced

        store.append(variables())
    return bars.to_dict() | {"field_errors": {name: error.to_dict() for name, error in fields.fields.items()}}
