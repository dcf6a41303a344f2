"""Audit the bundled scenes, or those named, and write one line each: `python -m eigencontact_verification.audit`."""

from __future__ import annotations

import json
import os
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from eigencontact_verification.audit.table import SceneAudit, contacts_of, line_of, markdown_of
from eigencontact_verification.crosscheck.judge import judge
from eigencontact_verification.crosscheck.run import Limits, in_processes, run_cases
from eigencontact_verification.crosscheck.store import Store

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from eigencontact_verification.crosscheck.run import Solved

    Solve = Callable[..., list[Solved]]


def main(
    scenes: Annotated[
        list[str] | None, typer.Argument(help="Bundled scenes, or folders of runs; by default all scenes.")
    ] = None,
    *,
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder of runs and finished solutions.")] = Path(
        "audit"
    ),
    runs: Annotated[
        Path | None, typer.Option("--runs", help="Folder with finished runs, named after their scenes.")
    ] = None,
    workers: Annotated[int, typer.Option("--workers", min=1, help="Processes at a time.")] = 1,
    memory: Annotated[float, typer.Option("--memory", help="Limit of a solution [GB].")] = 6.0,
    collect: Annotated[
        bool, typer.Option("--collect", help="Audit nothing; write the table of earlier audits.")
    ] = False,
    full: Annotated[bool, typer.Option("--full", help="Finer meshes.")] = False,
    contact: Annotated[
        bool,
        typer.Option("--contact", help="Solve whole contacts in place of the audit."),
    ] = False,
    coarser: Annotated[
        Path | None,
        typer.Option("--coarser", help="Folder with runs on coarser cells, named after their scenes; with --contact."),
    ] = None,
    markdown: Annotated[
        Path | None, typer.Option("--markdown", help="Page with the markers `audit:SECTION` around its table.")
    ] = None,
    section: Annotated[
        str | None, typer.Option("--section", help="SECTION; by default scenes, or whole-contacts with --contact.")
    ] = None,
) -> None:
    """Solve scenes that have no run yet, audit each, write the table; finished solutions are read from the folder."""
    from eigencontact.scene.loader import bundled_names
    from eigencontact_verification.reporting.table import check_section, replace_section

    section = section or ("whole-contacts" if contact else "scenes")
    if markdown is not None:
        check_section(markdown, section, family="audit")
    executor = partial(in_processes, workers=workers, limits=Limits(memory=memory * 1e9))
    solve = partial(run_cases, store=Store(output / "solutions"), executor=executor)
    names = scenes or bundled_names()
    if contact:
        text, words = _contacts([_run_of(name, runs, output) for name in names], solve, quick=not full, coarser=coarser)
    else:
        files = {name: output / "scenes" / f"{Path(name).name}.json" for name in names}
        for name in () if collect else names:
            _audit(_run_of(name, runs, output), files[name], solve, quick=not full)
        lines = [json.loads(file.read_text(encoding="utf-8")) for file in files.values() if file.is_file()]
        text, words = markdown_of(lines), {line["word"] for line in lines}
    if markdown is not None:
        replace_section(markdown, section, text, family="audit")
    typer.echo(text)
    raise typer.Exit(1 if words & {"disagrees", "failed"} else 0)


def _run_of(name: str, runs: Path | None, output: Path) -> Path:
    """Folder of a finished run, or of the run of a scene, which is solved if it is missing."""
    for folder in (Path(name), *([runs / name] if runs is not None else [])):
        if (folder / "results.nc").is_file():
            return folder
    folder = output / "runs" / name
    if not (folder / "results.nc").is_file():
        import eigencontact as ec

        ec.run(ec.load_scene(name, ["output.pictures=false"]), folder).dataset.close()
    return folder


def _audit(run: Path, file: Path, solve: Solve, *, quick: bool) -> None:
    """Audit the last step of a run; print its verdict and store its line of the table."""
    from eigencontact_verification.audit.cases import cases_of_step
    from eigencontact_verification.audit.checks import checked
    from eigencontact_verification.audit.stored import read_step

    start = perf_counter()
    stored = read_step(run)
    cases, gaps = cases_of_step(stored, quick=quick)
    solved, checks = solve(cases), checked(stored)
    cached = any(outcome.cached for case in solved for _, outcome in case.outcomes)
    audit = SceneAudit(
        name=file.stem, step=stored.step, gaps=gaps, seconds=None if cached else perf_counter() - start,
        judged=(*map(judge, solved), *([checks] if checks.rows else [])),
    )  # fmt: skip
    counts = ", ".join(f"{count} {word}" for word, count in audit.counts.items())
    typer.echo(f"{audit.name}: {audit.word} ({counts}) {audit.reason}", err=True)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(line_of(audit)), encoding="utf-8")


def _contacts(runs: Sequence[Path], solve: Solve, *, quick: bool, coarser: Path | None) -> tuple[str, set[str]]:
    """Table of the whole contacts of runs, and their verdicts."""
    from eigencontact_verification.audit.contact_cases import contact_cases_of
    from eigencontact_verification.crosscheck.progress import Bar

    coarser_runs = [None if coarser is None else coarser / run.name for run in runs]
    answers = [
        contact_cases_of(run, quick=quick, coarser=second if second is not None and second.is_dir() else None)
        for run, second in zip(runs, coarser_runs, strict=True)
    ]
    with Bar(show=True) as bar:
        solved = solve([case for cases, _ in answers for case in cases], progress=bar)
    judged = [judge(case) for case in solved]
    return contacts_of(judged, [gap for _, gaps in answers for gap in gaps]), {case.word for case in judged}


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    typer.run(main)
