"""Audit the bundled scenes, or those named, and write one line each: `python -m eigencontact_verification.audit`."""

from __future__ import annotations

import json
import os
import sys
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Annotated

import typer

from eigencontact_verification.audit.table import SceneAudit, line_of, markdown_of


def main(
    scenes: Annotated[list[str] | None, typer.Argument(help="Bundled scenes; by default all.")] = None,
    *,
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder of runs and finished solutions.")] = Path(
        "audit"
    ),
    runs: Annotated[
        Path | None, typer.Option("--runs", help="Folder with runs by the names of their scenes, solved elsewhere.")
    ] = None,
    workers: Annotated[int, typer.Option("--workers", min=1, help="Processes at a time.")] = 1,
    memory: Annotated[float, typer.Option("--memory", help="Limit of a solution [GB].")] = 6.0,
    collect: Annotated[
        bool, typer.Option("--collect", help="Audit nothing; the table of what earlier calls have audited.")
    ] = False,
    full: Annotated[bool, typer.Option("--full", help="Finer meshes.")] = False,
    markdown: Annotated[Path | None, typer.Option("--markdown", help="Page whose section `audit` is written.")] = None,
    section: Annotated[str, typer.Option("--section", help="Name in the markers of the page.")] = "scenes",
) -> None:
    """Solve scenes that are not solved yet, audit each, write the table; finished solutions are found again."""
    from eigencontact.scene.loader import bundled_names
    from eigencontact_verification.reporting.table import check_section, replace_section

    if markdown is not None:
        check_section(markdown, section, family="audit")
    lines = []
    for name in scenes or bundled_names():
        kept = output / "scenes" / f"{name}.json"
        if collect and not kept.is_file():
            continue
        if not collect:
            one = _audit(name, _run_of(name, runs, output), output, workers, memory, quick=not full)
            counts = ", ".join(f"{count} {word}" for word, count in one.counts.items())
            typer.echo(f"{name}: {one.word} ({counts}) {one.reason}", err=True)
            kept.parent.mkdir(parents=True, exist_ok=True)
            kept.write_text(json.dumps(line_of(one)), encoding="utf-8")
        lines.append(json.loads(kept.read_text(encoding="utf-8")))
    text = markdown_of(lines)
    if markdown is not None:
        replace_section(markdown, section, text, family="audit")
    typer.echo(text)
    sys.exit(1 if any(line["word"] == "disagrees" for line in lines) else 0)


def _run_of(name: str, runs: Path | None, output: Path) -> Path:
    """Folder of the run of a scene, which is solved if it is not there."""
    if runs is not None and (runs / name / "results.nc").is_file():
        return runs / name
    folder = output / "runs" / name
    if not (folder / "results.nc").is_file():
        import eigencontact as ec

        ec.run(ec.load_scene(name, ["output.pictures=false"]), folder).dataset.close()
    return folder


def _audit(name: str, run: Path, output: Path, workers: int, memory: float, *, quick: bool) -> SceneAudit:
    from eigencontact_verification.audit.cases import cases_of_step
    from eigencontact_verification.audit.checks import checked
    from eigencontact_verification.audit.stored import read_step
    from eigencontact_verification.crosscheck.judge import judge
    from eigencontact_verification.crosscheck.run import Limits, in_processes, run_cases
    from eigencontact_verification.crosscheck.store import Store

    start = perf_counter()
    stored = read_step(run)
    cases, gaps = cases_of_step(stored, quick=quick)
    executor = partial(in_processes, workers=workers, limits=Limits(memory=memory * 1e9))
    solved = run_cases(cases, Store(output / "solutions"), executor=executor)
    checks = checked(stored)
    judged = (*(judge(one) for one in solved), *((checks,) if checks.rows else ()))
    kept = any(outcome.cached for one in solved for _, outcome in one.outcomes)
    seconds = None if kept else perf_counter() - start
    return SceneAudit(name=name, step=stored.step, judged=judged, gaps=gaps, seconds=seconds)


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    typer.run(main)
