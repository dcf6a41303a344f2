"""A study as a table on the terminal, as Markdown and as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from eigencontact_verification.reporting.page import markdown_table
from eigencontact_verification.tradeoff.study import standing

if TYPE_CHECKING:
    from rich.table import Table

    from eigencontact_verification.tradeoff.study import Prediction, Row, Study

__all__ = ["as_data", "as_markdown", "plan_data", "plan_table", "remarks", "study_table"]

#: Errors that have a column of their own beside the headline, where a scene has them.
_COLUMNS = (
    "pressure field",
    "shear field",
    "displacement field",
    "max pressure",
    "contact radius",
    "approach",
    "loads",
    "max von Mises",
    "plastic strain",
    "worn depth",
    "worn volume",
)
#: Characters that the whole table takes.
_WIDE = 170


def study_table(study: Study, width: int) -> Table:
    """Rich table; ``T`` and ``M`` mark what no other variant, as accurate, beats in time, in memory.

    Parameters
    ----------
    width : int
        Characters of the terminal; a narrow one gets the error that is compared, time and memory alone.
    """
    from rich.markup import escape
    from rich.table import Table

    head, lines = _lines(study, brief=width < _WIDE)
    table = Table(*map(escape, head), box=None, pad_edge=False)
    for line in lines:
        table.add_row(*map(escape, line))
    return table


def as_markdown(study: Study) -> str:
    """Markdown: the table, what was not solved, and how to read it."""
    head, lines = _lines(study)
    how = f"Error: {study.headline} against the reference (first line), relative. "
    how += "Front: T, no other variant is as accurate, within 2 %, in less time; M, in less memory."
    items = "\n".join(f"- {line}" for line in remarks(study))
    return "\n\n".join([f"# {study.name}", markdown_table(head, lines), how, items]) + "\n"


def as_data(study: Study, machine: dict[str, Any]) -> dict[str, Any]:
    """Plain data for JSON; SI units, errors relative."""
    return {
        "scene": study.name,
        "headline": study.headline,
        "note": study.note,
        "standing": standing(study),
        "machine": machine,
        "rows": [
            {
                "key": row.variant.key,
                "words": row.variant.words,
                "changes": row.variant.changes,
                "status": row.status,
                "reason": row.reason,
                "cells": row.cells,
                "seconds": row.seconds,
                "memory_bytes": row.memory,
                "predicted_seconds": row.prediction.seconds,
                "predicted_memory_bytes": row.prediction.memory,
                "error": row.error,
                "errors": dict(row.errors),
                "fronts": list(row.fronts),
                **({"error_bars": dict(row.bars)} if row.bars else {}),
            }
            for row in study.rows
        ],
    }


def plan_table(predictions: Sequence[Prediction]) -> Table:
    """Variants with the planner's time and memory."""
    from rich.markup import escape
    from rich.table import Table

    head = ("", "varied", "variant", "cells", "time [s]", "memory [MB]", "refused")
    table = Table(*map(escape, head), box=None, pad_edge=False)
    for k, prediction in enumerate(predictions):
        numbers = (
            _cells(prediction.cells),
            _number(prediction.seconds, ".2g"),
            _number(prediction.memory, ".0f", 1e-6),
        )
        table.add_row(str(k), prediction.variant.key, prediction.variant.words, *numbers, escape(prediction.reason))
    return table


def plan_data(predictions: Sequence[Prediction]) -> list[dict[str, Any]]:
    """Plain data for JSON of what would be solved; SI units."""
    return [
        {
            "key": prediction.variant.key,
            "words": prediction.variant.words,
            "cells": prediction.cells,
            "seconds": prediction.seconds,
            "memory_bytes": prediction.memory,
            "reason": prediction.reason,
        }
        for prediction in predictions
    ]


def remarks(study: Study) -> list[str]:
    """Where the scene stands, what was not solved and why, and whether the reference is another."""
    unsolved = [(k, row) for k, row in enumerate(study.rows) if row.status != "ok"]
    lines = [f"{k} ({row.variant.words}) {row.status}: {row.reason}" for k, row in unsolved]
    barred = [_bars(row, study.rows[0]) for row in study.rows if row.bars]
    return [*([study.note] if study.note else []), *standing(study), *barred, *lines]


def _bars(row: Row, reference: Row) -> str:
    """Error bars of a row; of the scene beside its errors, which they should hold but for the bars of the reference."""
    if row is reference:
        error_bars = ", ".join(f"{name} {bar:.1e}" for name, bar in row.bars.items())
        return f"error bars of the reference, below which the table tells nothing apart: {error_bars}"
    sentences = []
    for name, bar in row.bars.items():
        error = row.errors.get(name)
        holds = error is None or error <= bar + reference.bars.get(name, 0.0)
        beside = "" if error is None else f" ({'holds' if holds else 'does not hold'} the error {error:.1e})"
        sentences.append(f"{name} {bar:.1e}{beside}")
    return f"error bars of the {row.variant.key}: {', '.join(sentences)}"


def _lines(study: Study, *, brief: bool = False) -> tuple[list[str], list[list[str]]]:
    """Titles and cells."""
    error, prices = f"error: {study.headline}", ["time [s]", "memory [MB]", "front"]
    if brief:
        lines = [[str(k), row.variant.words, _error(row), *_prices(row)] for k, row in enumerate(study.rows)]
        return ["", "variant", error, *prices], lines
    names = [name for name in _COLUMNS if name != study.headline and any(name in row.errors for row in study.rows)]
    head = ["", "varied", "variant", "cells", error, *names, *prices, "predicted [s]", "[MB]"]
    lines = []
    for k, row in enumerate(study.rows):
        varied = [row.variant.key, row.variant.words, _cells(row.cells or row.prediction.cells)]
        errors = [_number(row.errors.get(name), ".1e") for name in names]
        predicted = [_number(row.prediction.seconds, ".2g"), _number(row.prediction.memory, ".0f", 1e-6)]
        lines.append([str(k), *varied, _error(row), *errors, *_prices(row), *predicted])
    return head, lines


def _cells(cells: tuple[int, int] | None) -> str:
    return "–" if cells is None else f"{cells[0]} x {cells[1]}"


def _error(row: Row) -> str:
    return _number(row.error, ".2e") if row.status == "ok" else row.status


def _prices(row: Row) -> list[str]:
    front = "".join(price[0].upper() for price in row.fronts)
    return [_number(row.seconds, ".3g"), _number(row.memory, ".0f", 1e-6), front]


def _number(value: float | None, form: str, scale: float = 1.0) -> str:
    return "–" if value is None else format(scale * value, form)
