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

from eigencontact_verification.benchmarks import (
    cloud,
    eigenstrain,
    fidelity,
    hertz,
    inhomogeneity,
    layers,
    tangential,
    trade,
)
from eigencontact_verification.benchmarks.campaign import BENCHMARKS, Campaign, run_campaign
from eigencontact_verification.benchmarks.codes import CODES, OURS, PEERS
from eigencontact_verification.benchmarks.machine import describe, facts
from eigencontact_verification.benchmarks.process import run_fresh
from eigencontact_verification.benchmarks.table import replace_section, table
from eigencontact_verification.benchmarks.task import Sample, Task

if TYPE_CHECKING:
    from collections.abc import Sequence

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
    names = {**CODES, **fidelity.METHODS, **trade.METHODS, **tangential.METHODS}
    if ":" not in text and text not in names:
        known = ", ".join(sorted(names))
        raise argparse.ArgumentTypeError(f"must be one of {known} or package.module:OBJECT (got {text})")
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
    add(
        "--codes",
        type=_code,
        nargs="+",
        default=[],
        metavar="CODE",
        help="only these; 'package.module:OBJECT' names your own",
    )
    add("--repeats", type=_count, default=3, help="fresh processes per code and size")
    add("--warm", type=_count, default=2, help="further calls in each process")
    add("--threads", type=_count, default=os.cpu_count() or 1, help="threads that a code may use")
    add("--precision", choices=("double", "single"), default="double", help="for codes that have the choice")
    add("--limit", type=_positive, default=120.0, help="seconds per code and size; slower codes skip larger sizes")
    add("--interpreter", type=_interpreter, action="append", default=[], metavar="CODE=PYTHON", help="where a code is")
    add("--json", type=Path, metavar="FILE", help="write raw samples and rows")
    add("--markdown", type=Path, metavar="FILE", help="replace the table between its markers")
    add("--section", help="name in the markers; by default that of the benchmark")
    one = commands.add_parser("hertz", parents=[common], help="frictionless Hertz against one bare convolution")
    one.add_argument("--sizes", type=_count, nargs="+", default=[256, 512, 1024, 2048], metavar="N")
    one.add_argument("--peers", action="store_true", help=f"also {', '.join(PEERS)}, where installed")
    two = commands.add_parser("stress", parents=[common], help="sub-surface stress against its bare FFTs")
    two.add_argument("--size", type=_count, default=256, metavar="N")
    two.add_argument("--depths", type=_count, default=32)
    three = commands.add_parser("fidelity", parents=[common], help="lower fidelities of the half-space and their price")
    three.add_argument("--size", type=_count, default=32, metavar="N")
    three.add_argument("--cases", nargs="+", choices=list(fidelity.CASES), default=list(fidelity.CASES), metavar="CASE")
    four = commands.add_parser("eigenstrain", parents=[common], help="eigenstrain in a volume against its bare FFTs")
    four.add_argument("--sizes", type=_count, nargs="+", default=[16, 32, 64, 128], metavar="N")
    four.add_argument("--cases", nargs="+", choices=list(eigenstrain.CASES), default=list(eigenstrain.CASES))
    five = commands.add_parser("cloud", parents=[common], help="hundreds of inclusions off the grid")
    five.add_argument("--sizes", type=_count, nargs="+", default=cloud.SIZES, metavar="INCLUSIONS")
    five.add_argument("--cases", nargs="+", choices=list(cloud.CASES), default=list(cloud.CASES))
    six = commands.add_parser("trade", parents=[common], help="finite elements against the semi-analytical ways")
    six.add_argument("--picture", type=Path, metavar="FILE", help="draw error against time and memory")
    six.set_defaults(size=1)
    seven = commands.add_parser("tangential", parents=[common], help="partial slip against one bare application")
    seven.add_argument("--sizes", type=_count, nargs="+", default=[64, 128, 256, 512], metavar="N")
    seven.add_argument("--cases", nargs="+", choices=list(tangential.CASES), default=list(tangential.CASES))
    seven.add_argument("--peers", action="store_true", help=f"also {', '.join(tangential.PEERS)}, where installed")
    eight = commands.add_parser("inhomogeneity", parents=[common], help="clusters, coatings, stiffness ratios")
    eight.add_argument("--size", type=_count, default=inhomogeneity.COATED_CELLS, metavar="N", help="of coated-sphere")
    eight.add_argument(
        "--cases", nargs="+", choices=list(inhomogeneity.CASES), default=list(inhomogeneity.CASES), metavar="CASE"
    )
    nine = commands.add_parser("layers", parents=[common], help="stress in a coated body against the bare one")
    nine.add_argument("--size", type=_count, default=256, metavar="N")
    nine.add_argument("--depths", type=_count, default=32)
    nine.add_argument("--cases", nargs="+", choices=list(layers.CASES), default=list(layers.CASES), metavar="CASE")
    return top


def _report(out: Campaign, benchmark: str, machine: str, *, brief: bool) -> str:
    """Table, notes, settings and machine, as Markdown."""
    columns = [column for column in BENCHMARKS[benchmark][0] if column.brief or not brief]
    parts = [table(out.rows, columns)] if out.rows else []
    remarks = [*out.notes]
    if benchmark == "hertz":
        remarks = hertz.scaling(out.rows) + remarks
    elif benchmark == "eigenstrain":
        remarks = eigenstrain.scaling(out.rows) + remarks
    elif benchmark == "tangential":
        remarks = tangential.growth(out.rows) + remarks
    remarks += [f"{code} {text}" for code, text in out.settings.items()]
    parts.append("\n".join(f"- {remark}" for remark in remarks))
    parts.append(f"Measured {datetime.now(UTC):%Y-%m-%d} on {machine}.")
    return "\n\n".join(part for part in parts if part)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one benchmark; return 1 if nothing could be measured, 2 for files that cannot be written."""
    options = parser().parse_args(arguments)
    ways = {"fidelity": fidelity.METHODS, "trade": trade.METHODS}.get(options.benchmark)
    friction = options.benchmark == "tangential"
    ours, peers = (tangential.OURS, tangential.PEERS) if friction else (OURS, PEERS)
    with_peers = getattr(options, "peers", False)
    codes = options.codes or (list(ways) if ways else [*ours, *(peers if with_peers else ())])
    sizes = options.sizes if "sizes" in options else [options.size]
    elsewhere = dict(options.interpreter)
    machine = facts()

    def run(task: Task, limit: float) -> Sample:
        return run_fresh(task, limit, elsewhere.get(task.code))

    template = Task(
        benchmark=options.benchmark,
        code="",
        n=0,
        threads=options.threads,
        precision=options.precision,
        warm=options.warm,
        depths=getattr(options, "depths", 0),
    )
    out = Campaign()
    for case in getattr(options, "cases", [""]):
        found = run_campaign(
            replace(template, case=case),
            codes=codes,
            sizes=sizes,
            repeats=options.repeats,
            limit=options.limit,
            run=run,
            say=lambda text, case=case: print(f"{case}: {text}" if case else text, file=sys.stderr),  # type: ignore[misc]
        )
        out.rows += found.rows
        out.samples += found.samples
        out.notes += [f"{case}: {note}" if case else note for note in found.notes]
        out.settings |= found.settings
    print(_report(out, options.benchmark, describe(machine), brief=False))
    try:
        if options.json:
            content = {
                "benchmark": options.benchmark,
                "machine": machine,
                "rows": out.rows,
                "samples": out.samples,
                "notes": out.notes,
                "settings": out.settings,
            }
            options.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
        if getattr(options, "picture", None) and out.rows:
            trade.draw(out.rows, options.picture)
        if options.markdown and out.rows:
            text = _report(out, options.benchmark, describe(machine), brief=True)
            replace_section(options.markdown, options.section or options.benchmark, text)
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    return 0 if out.rows else 1


if __name__ == "__main__":
    sys.exit(main())
