"""``python -m eigencontact_verification.benchmarks``: measure, print, and write the table of a README."""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task
from eigencontact_verification.benchmarks.catalogue import BENCHMARKS
from eigencontact_verification.benchmarks.codes import CODES
from eigencontact_verification.benchmarks.measurements import Measurements, measure_all
from eigencontact_verification.benchmarks.process import run_fresh
from eigencontact_verification.reporting.machine import describe, facts
from eigencontact_verification.reporting.table import replace_section, table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eigencontact_verification.reporting.table import Column

__all__ = ["main", "parser"]


def _positive(text: str) -> float:
    value = float(text)
    if not (value > 0 and math.isfinite(value)):
        raise argparse.ArgumentTypeError(f"must be positive and finite (got {text})")
    return value


def _count(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"must be at least 1 (got {text})")
    return value


def _code(text: str) -> str:
    names = {*CODES, *(name for benchmark in BENCHMARKS.values() for name in benchmark.methods or ())}
    if ":" not in text and text not in names:
        names_in_words = ", ".join(sorted(names))
        raise argparse.ArgumentTypeError(f"must be one of {names_in_words} or package.module:OBJECT (got {text})")
    return text


def _interpreter(text: str) -> tuple[str, str]:
    code, equals, python = text.partition("=")
    if not (code and equals and python):
        raise argparse.ArgumentTypeError(f"must be CODE=PYTHON (got {text}); e.g. tamaas=venv/bin/python")
    return code, python


def parser() -> argparse.ArgumentParser:
    """Command line of the benchmarks."""
    top = argparse.ArgumentParser(prog="python -m eigencontact_verification.benchmarks", description=__doc__)
    commands = top.add_subparsers(dest="benchmark", required=True)
    common = argparse.ArgumentParser(add_help=False)
    add = common.add_argument
    names = "only these; 'package.module:OBJECT' names your own"
    add("--codes", type=_code, nargs="+", default=[], metavar="CODE", help=names)
    add("--repeats", type=_count, default=3, help="fresh processes per code and size")
    add("--warm", type=_count, default=2, help="further calls in each process")
    add("--threads", type=_count, default=os.cpu_count() or 1, help="threads that a code may use")
    add("--precision", choices=("double", "single"), default="double", help="for codes that have the choice")
    add("--limit", type=_positive, default=120.0, help="seconds per code and size; slower codes skip larger sizes")
    add("--interpreter", type=_interpreter, action="append", default=[], metavar="CODE=PYTHON", help="where a code is")
    add("--json", type=Path, metavar="FILE", help="write raw samples and rows")
    add("--markdown", type=Path, metavar="FILE", help="replace the table between its markers")
    add("--section", help="name in the markers; by default that of the benchmark")
    for benchmark in BENCHMARKS.values():
        add = commands.add_parser(benchmark.name, parents=[common], help=benchmark.help).add_argument
        if len(benchmark.sizes) > 1:
            add("--sizes", type=_count, nargs="+", default=list(benchmark.sizes), metavar=benchmark.unit)
        elif benchmark.sizes:
            add("--size", type=_count, default=benchmark.sizes[0], metavar=benchmark.unit)
        if benchmark.depths:
            add("--depths", type=_count, default=benchmark.depths)
        if len(benchmark.cases) > 1:
            words = "; ".join(benchmark.cases).replace("%", "%%")  # argparse fills in formats
            add("--cases", nargs="+", choices=benchmark.cases, default=benchmark.cases, metavar="CASE", help=words)
        if benchmark.rows:
            add("--rows", default="", metavar="FOLDER", help="keep raw rows there; a later call solves those that lack")
        if benchmark.peers:
            add("--peers", action="store_true", help=f"also {', '.join(benchmark.peers)}, where installed")
        keys = [column.key for column in benchmark.columns]
        add("--columns", nargs="+", choices=keys, metavar="KEY", help=f"of the stored table: {', '.join(keys)}")
        if benchmark.draw:
            add("--picture", type=Path, metavar="FILE", help="draw error against time and memory")
    return top


def _report(out: Measurements, benchmark: Benchmark, machine: str, columns: Sequence[Column]) -> str:
    """Table, notes, settings and machine, as Markdown."""
    blocks = [table(out.rows, columns)] if out.rows else []
    remarks = benchmark.remarks(out.rows) + out.notes
    remarks += [f"{code} {text}" for code, text in out.settings.items()]
    blocks.append("\n".join(f"- {remark}" for remark in remarks))
    blocks.append(f"Measured {datetime.now(UTC):%Y-%m-%d} on {machine}.")
    return "\n\n".join(block for block in blocks if block)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one benchmark; return 1 if nothing could be measured, 2 for files that cannot be written."""
    options = parser().parse_args(arguments)
    benchmark, chosen = BENCHMARKS[options.benchmark], vars(options)
    codes = options.codes or [*benchmark.ours, *(benchmark.peers if chosen.get("peers") else ())]
    sizes = chosen.get("sizes") or [chosen.get("size", 1)]
    elsewhere = dict(options.interpreter)
    machine = facts()

    def run(task: Task, limit: float) -> Sample:
        return run_fresh(task, limit, elsewhere.get(task.code))

    template = Task(
        benchmark=benchmark.name,
        code="",
        n=0,
        threads=options.threads,
        precision=options.precision,
        warm=options.warm,
        depths=chosen.get("depths", 0),
        rows=chosen.get("rows", ""),
    )
    out = Measurements()
    for case in chosen.get("cases", benchmark.cases):
        measured = measure_all(
            replace(template, case=case),
            codes=codes,
            sizes=sizes,
            repeats=options.repeats,
            limit=options.limit,
            run=run,
            say=lambda text, case=case: print(f"{case}: {text}" if case else text, file=sys.stderr),  # type: ignore[misc]
        )
        out.rows += measured.rows
        out.samples += measured.samples
        out.notes += [f"{case}: {note}" if case else note for note in measured.notes]
        out.settings |= measured.settings
    print(_report(out, benchmark, describe(machine), benchmark.columns))
    try:
        if options.json:
            content = {
                "benchmark": benchmark.name,
                "machine": machine,
                "rows": out.rows,
                "samples": out.samples,
                "notes": out.notes,
                "settings": out.settings,
            }
            options.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
        if benchmark.draw and options.picture and out.rows:
            benchmark.draw(out.rows, options.picture)
        if options.markdown and out.rows:
            keys = options.columns or [column.key for column in benchmark.columns if column.brief]
            columns = [column for column in benchmark.columns if column.key in keys]
            text = _report(out, benchmark, describe(machine), columns)
            replace_section(options.markdown, options.section or benchmark.name, text)
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    return 0 if out.rows else 1


if __name__ == "__main__":
    sys.exit(main())
