"""Whole contacts of many runs, solved by finite elements and judged, as one table.

``python -m eigencontact_verification.audit.contact_table RUN... [--quick] [--markdown FILE]``: folders of runs, of
which those whose contact is of revolution are solved. Finished solutions are kept: an interrupted table continues.
"""

from __future__ import annotations

import argparse
import os
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eigencontact_verification.crosscheck.judge import JudgedCase

__all__ = ["main", "row_of"]

#: Marker in the page.
_SECTION = "whole-contacts"


def row_of(one: JudgedCase) -> dict[str, Any]:
    """Line of the table: verdicts, largest difference by kind, effort."""
    words = [row.word for row in one.rows]
    found: dict[str, Any] = {
        "scene": one.case.subject,
        "verdicts": f"{words.count('agrees')} / {words.count('inconclusive')} / {words.count('disagrees')}",
        "seconds": sum(outcome.seconds for task, outcome in one.outcomes if task.level is not None),
        "memory": max((outcome.memory or 0 for _, outcome in one.outcomes), default=0),
    }
    for kind in ("approach", "contact radius", "pressure", "print", "stress"):
        rows = [row for row in one.rows if row.profile.startswith(kind) and row.difference is not None]
        if rows:
            worst = max(rows, key=lambda row: row.ratio or 0.0)
            mark = {"agrees": "", "inconclusive": " ?"}.get(min(rows, key=_rank).word, " ✗")
            found[kind] = f"{100 * (worst.difference or 0.0):.2g} ± {100 * (worst.uncertainty or 0.0):.2g}{mark}"
    return found


def _rank(row: Any) -> int:
    from eigencontact_verification.reporting.verdict import WORDS

    return WORDS.index(row.word)


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; 1 where something disagrees or failed."""
    from eigencontact_verification.audit.contact_cases import contact_cases_of
    from eigencontact_verification.crosscheck.judge import judge
    from eigencontact_verification.crosscheck.progress import Bar
    from eigencontact_verification.crosscheck.run import in_processes, run_cases
    from eigencontact_verification.crosscheck.store import Store
    from eigencontact_verification.reporting.machine import describe, facts
    from eigencontact_verification.reporting.table import Column, check_section, replace_section, table

    parser = argparse.ArgumentParser(
        prog="python -m eigencontact_verification.audit.contact_table", description=__doc__
    )
    parser.add_argument("runs", nargs="+", type=Path, help="folders of runs")
    parser.add_argument("--quick", action="store_true", help="lighter meshes")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes at a time")
    parser.add_argument("-o", "--output", type=Path, default=Path("cross-check"), help="folder of finished solutions")
    parser.add_argument("--markdown", type=Path, help=f"write between the markers verify:{_SECTION} of this file")
    given = parser.parse_args(arguments)
    if given.markdown is not None:
        check_section(given.markdown, _SECTION, family="verify")
    found = [contact_cases_of(run, quick=given.quick) for run in given.runs]
    cases = [case for cases, _ in found for case in cases]
    with Bar(show=sys.stderr.isatty()) as bar:
        store = Store(given.output / "solutions")
        solved = run_cases(cases, store, executor=partial(in_processes, workers=given.workers), progress=bar)
    judged = [judge(one) for one in solved]
    columns = [
        Column("scene", "scene"),
        Column("agrees / inconclusive / disagrees", "verdicts"),
        *(Column(f"{kind} [%]", kind) for kind in ("approach", "contact radius", "pressure", "print", "stress")),
        Column("elements [s]", "seconds", ".0f"),
        Column("peak [MB]", "memory", ".0f", scale=1e-6),
    ]
    text = table([row_of(one) for one in judged], columns)
    notes = [f"- {row.case}, {row.profile}, {row.component}: {row.word}, {row.reason}" for row in _open(judged)]
    gaps = [f"- {gap.subject}: {gap.reason}." for _, gaps in found for gap in gaps]
    parts = [text, *(["Not agreed:", "\n".join(notes)] if notes else [])]
    parts += [*(["Left out, or taken otherwise:", "\n".join(gaps)] if gaps else []), f"{describe(facts())}."]
    whole = "\n\n".join(parts)
    print(whole)
    if given.markdown is not None:
        replace_section(given.markdown, _SECTION, whole, family="verify")
    return int(any(one.word in {"disagrees", "failed"} for one in judged))


def _open(judged: Sequence[JudgedCase]) -> list[Any]:
    """Rows without agreement, each with the scene in place of its case."""
    from dataclasses import replace

    return [replace(row, case=row.subject) for one in judged for row in one.rows if row.word != "agrees"]


if __name__ == "__main__":
    sys.exit(main())
