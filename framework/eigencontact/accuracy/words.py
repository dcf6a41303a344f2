"""Text about the accuracy that a run has reached."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from eigencontact.core.numbers import Number
from eigencontact.core.units import readable, time_in_words

__all__ = ["accuracy_lines", "missed_targets"]


def accuracy_lines(summary: Mapping[str, Any]) -> list[str]:
    """Lines about targets and runs, from the summary of a run."""
    accuracy = summary["accuracy"]
    count = len(accuracy["rungs"])
    runs = f"{count} runs, each finer than the last, and {accuracy['runs'] - count} coarser ones"
    reached = "reached" if accuracy["reached"] else "not reached"
    names_by_reason: dict[str, list[str]] = {}
    for name, reason in accuracy["left_out"].items():
        names_by_reason.setdefault(reason, []).append(name)
    left_out = [f"no target for {', '.join(names)}: {reason}" for reason, names in names_by_reason.items()]
    return [f"accuracy {reached}: {runs}, {time_in_words(accuracy['seconds'])}", *left_out]


def missed_targets(summary: Mapping[str, Any]) -> str:
    """Missed targets, the reason of the end of the run, and the predicted cost of the targets."""
    accuracy = summary["accuracy"]
    declared = {name: Number(**table) for name, table in summary["numbers"].items()}
    texts = [
        f"{name} has an error of {_error(declared.get(name), row)}, {row['target']} asked for"
        for name, row in accuracy["targets"].items()
        if not row["holds"]
    ]
    required = accuracy.get("more")
    if required and required["holds"]:
        cost = f"{time_in_words(required['seconds'])} and {readable(required['memory'], 'B')} of arrays"
        factors = ", ".join(f"{name} {factor:.2g} times finer" for name, factor in required["factors"].items())
        texts.append(f"a run with {factors} would take about {cost}")
    return "; ".join([*texts, accuracy["stopped"]])


def _error(number: Number | None, row: Mapping[str, Any]) -> str:
    """Error of a number, or relative error of a field."""
    if row["value"] or number is None:
        return f"{100 * row['error'] / abs(row['value']):.2g} %"
    return number.text(row["error"])
