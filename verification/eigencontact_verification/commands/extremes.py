"""The command `eigencontact extremes`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eigencontact_verification.commands.options import AsJson, Output, Quiet, with_clear_errors

if TYPE_CHECKING:
    from eigencontact_verification.extremes.feature import Feature
    from eigencontact_verification.extremes.report import Report

__all__ = ["extremes"]


def extremes(
    *,
    features: Annotated[
        list[str] | None, typer.Option("--feature", metavar="NAME", help="Only this feature; repeatable.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Only fast corners (about 0.1 s each).")] = False,
    listed: Annotated[bool, typer.Option("--list", help="List the features and compute nothing.")] = False,
    output: Output = Path("extremes"),
    markdown: Annotated[
        Path | None, typer.Option("--markdown", metavar="FILE", help="Also write the report as this page.")
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Test numerical stability at built-in extreme inputs: the largest error, or where the program refuses.

    Poisson's ratio and stiffness at their ends, aspects and depths over six decades, loads from first touch to a full
    window, friction from 1e-6 to 10, scales from nm to km, odd grids, single precision, thin stiff layers, softening
    laws, wear through a layer, and input without meaning. Each corner is compared with a closed form, another method or
    an invariant, and has a bound with its reason.

    Exit codes: 0 all within their bounds or refused as they must be, 1 a corner fails, 2 wrong input.

    Example: `eigencontact extremes --quick --feature layers`
    """
    from eigencontact.results.ownership import refuse_foreign_file
    from eigencontact_verification.extremes.catalogue import KEYS, chosen
    from eigencontact_verification.reporting.files import open_folder, report_names

    with with_clear_errors("nothing is kept"):
        selected = chosen(tuple(features) if features else KEYS)
        if listed:
            for feature in selected:
                typer.echo(f"{feature.key:<12}{len(feature.corners):>4} corners  {feature.title}")
            return
        open_folder(output, report_names().values())
        if markdown is not None:
            refuse_foreign_file(markdown)
        report = _computed(selected, quick=quick, show=not (quiet or as_json))
        _tell(report, output, markdown, as_json=as_json, quiet=quiet)
        raise typer.Exit(report.exit_code)


def _computed(features: tuple[Feature, ...], *, quick: bool, show: bool) -> Report:
    """Compute all corners, with a bar on a terminal."""
    from eigencontact_verification.extremes.judge import FeatureVerdict, run
    from eigencontact_verification.extremes.report import Report
    from eigencontact_verification.reporting.progress import counted

    total, count = sum(corner.quick or not quick for feature in features for corner in feature.corners), 0
    verdicts: list[FeatureVerdict] = []
    with counted("extremes", show=show, interval=inf) as tell:
        for feature, verdict in run(features, quick=quick):
            if isinstance(verdict, FeatureVerdict):
                verdicts.append(verdict)
            else:
                count += 1
                tell(feature.key, count, total)
    return Report(features=tuple(verdicts), quick=quick)


def _tell(report: Report, folder: Path, markdown: Path | None, *, as_json: bool, quiet: bool) -> None:
    """Write the files, print the table."""
    from eigencontact.core.text_table import print_table
    from eigencontact_verification.extremes.report import table, write_report

    files = write_report(report, folder)
    if markdown is not None:
        markdown.parent.mkdir(parents=True, exist_ok=True)
        markdown.write_bytes(files["markdown"].read_bytes())
    if as_json:
        typer.echo(files["json"].read_text(encoding="utf-8"), nl=False)
    elif not quiet:
        print_table(table(report))
        for key, fault in report.faults:
            typer.echo(f"{key}, {fault.corner.name}: {fault.message}")
        typer.echo(f"\n{report.summary}\nin {folder.resolve()}: {', '.join(file.name for file in files.values())}")
