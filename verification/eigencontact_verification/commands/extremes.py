"""The command `eigencontact extremes`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from eigencontact_verification.extremes.feature import Feature
    from eigencontact_verification.extremes.report import Report

__all__ = ["extremes"]


def extremes(
    *,
    features: Annotated[
        list[str] | None, typer.Option("--feature", metavar="NAME", help="Only this feature; repeatable.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Only corners that take a tenth of a second or so.")] = False,
    listed: Annotated[bool, typer.Option("--list", help="List the features and compute nothing.")] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder of the report; by default ./extremes.")
    ] = None,
    markdown: Annotated[
        Path | None, typer.Option("--markdown", metavar="FILE", help="Also write the report as this page.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")] = False,
) -> None:
    """Test numerical stability at built-in extreme inputs: the largest error, or where the program refuses.

    Poisson's ratio and stiffness at their ends, aspects and depths over six decades, loads from first touch to a full
    window, friction from 1e-6 to 10, scales from nm to km, odd grids, single precision, thin stiff layers, softening
    laws, wear through a layer, and input without meaning. Each corner is compared with a closed form, another method or
    an invariant, and has a bound with its reason.

    Exit codes: 0 all within their bounds or refused as they must be, 1 a corner fails, 2 wrong input.

    Example: `eigencontact extremes --quick --feature layers`
    """
    from eigencontact.errors import EigencontactError
    from eigencontact.results.atomic import writable_folder
    from eigencontact_verification.extremes.catalogue import KEYS, chosen

    try:
        found = chosen(tuple(features) if features else KEYS)
    except EigencontactError as problem:
        _leave(str(problem), problem.exit_code)
    if listed:
        for feature in found:
            typer.echo(f"{feature.key:<12}{len(feature.corners):>4} corners  {feature.title}")
        return
    folder = output or Path("extremes")
    try:
        writable_folder(folder)
        report = _computed(found, quick=quick, told=not (quiet or as_json))
        _tell(report, folder, markdown, as_json=as_json, quiet=quiet)
    except EigencontactError as problem:
        _leave(str(problem), problem.exit_code)
    except OSError as problem:
        _leave(f"the report cannot be written: {problem}", 2)
    except KeyboardInterrupt:
        _leave("interrupted", 130)
    raise typer.Exit(report.exit_code)


def _leave(problem: str, code: int) -> None:
    typer.echo(f"eigencontact: {' '.join(problem.split())}", err=True)
    raise typer.Exit(code) from None


def _computed(features: tuple[Feature, ...], *, quick: bool, told: bool) -> Report:
    """All corners, with a line of progress for each that takes time."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from eigencontact.progress import draws_in_place
    from eigencontact_verification.extremes.judge import FoundFeature, run
    from eigencontact_verification.extremes.report import Report

    total = sum(corner.quick or not quick for feature in features for corner in feature.corners)
    done: list[FoundFeature] = []
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.completed}/{task.total}"))
    told = told and draws_in_place(sys.stderr)
    with Progress(*columns, TimeElapsedColumn(), console=Console(stderr=True), disable=not told, transient=True) as bar:
        task = bar.add_task("extremes", total=total)
        for feature, found in run(features, quick=quick):
            if isinstance(found, FoundFeature):
                done.append(found)
            else:
                bar.update(task, advance=1, description=feature.key)
    return Report(features=tuple(done), quick=quick)


def _tell(report: Report, folder: Path, markdown: Path | None, *, as_json: bool, quiet: bool) -> None:
    """Write the files, print the table."""
    from eigencontact.core.text_table import print_table
    from eigencontact_verification.extremes.report import as_markdown, table, write_report

    files = write_report(report, folder)
    if markdown is not None:
        markdown.parent.mkdir(parents=True, exist_ok=True)
        markdown.write_text(as_markdown(report), encoding="utf-8")
    if as_json:
        typer.echo(files["json"].read_text(encoding="utf-8"), nl=False)
    elif not quiet:
        print_table(table(report))
        for key, fault in report.faults:
            typer.echo(f"{key}, {fault.corner.name}: {fault.message}")
        typer.echo(f"\n{report.summary}\nin {folder.resolve()}: {', '.join(file.name for file in files.values())}")
