"""The command `eigencontact campaign`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from eigencontact.engines.options import ClusterAddress, TaskThreads
from eigencontact_verification.commands.options import (
    AsJson,
    Coarse,
    Errors,
    Form,
    Name,
    Output,
    Show,
    Workers,
    chosen_file,
    cluster_or_none,
    print_keys,
    with_clear_errors,
)

if TYPE_CHECKING:
    from eigencontact_verification.campaign.campaign import Campaign
    from eigencontact_verification.campaign.report import MapReport

__all__ = ["campaign"]


def campaign(
    name: Name = None,
    *,
    output: Output = Path("campaigns"),
    coarse: Coarse = False,
    errors: Errors = False,
    workers: Workers = 1,
    cluster: ClusterAddress = None,
    memory: Annotated[
        float | None,
        typer.Option("--memory", metavar="GB", min=0.1, help="For a finite-element solution (6); on a cluster, all."),
    ] = None,
    threads: TaskThreads = None,
    markdown: Annotated[
        Path | None,
        typer.Option(
            "--markdown", metavar="FILE",
            help="Also write the verdicts between `<!-- campaign:NAME -->` and `<!-- /campaign:NAME -->` of FILE.",
        ),
    ] = None,
    trade: Annotated[
        bool, typer.Option("--trade", help="Write error, time and memory of both methods there instead.")
    ] = False,
    as_json: AsJson = False,
    form: Form = False,
    show: Show = False,
) -> None:  # fmt: skip
    """Map where a model is accurate: its error over a range of parameters, with a verdict at each point.

    Re-running resumes; finished runs and solutions are reused.

    A campaign is a TOML file: scenes, parameters that vary, a judge (another model, finite elements under the tractions
    of each run, a contact by finite elements), the tolerance, and the claim of agreement. `--form` lists its keys.

    Exit codes: 0 nothing disagrees where agreement is claimed, 1 something does or could not be solved, 2 wrong input,
    130 interrupted.

    Example: `eigencontact campaign inclusions-by-depth --coarse`
    """
    with with_clear_errors():
        from eigencontact_verification.campaign.campaign import CAMPAIGNS

        if form:
            _print_form()
            return
        columns = {
            "campaign": lambda item: item.name, "question": lambda item: item.title, "judge": lambda item: item.judge,
        }  # fmt: skip
        item = chosen_file(CAMPAIGNS, name, show=show, columns=columns)
        if item is None:
            return
        item = item.with_errors() if errors else item
        engine = cluster_or_none(workers, cluster, None if cluster is None else memory, threads)
        report, files = _computed(
            item, output / item.name, markdown, trade=trade, coarse=coarse, workers=workers or 1, cluster=engine,
            memory=None if memory is None else 1e9 * memory,
        )  # fmt: skip
        if as_json:
            typer.echo(files["json"].read_text(encoding="utf-8"), nl=False)
        else:
            _report(report)
            typer.echo(f"written: {', '.join(str(path) for path in files.values())}")
        raise typer.Exit(report.exit_code)


def _print_form() -> None:
    from eigencontact_verification.campaign.form import FORM

    print_keys(FORM, "campaign")
    typer.echo("\n`source`, `vary` and `when` are those of a study, and so are formulas: `eigencontact study --form`")


def _computed(
    item: Campaign, folder: Path, markdown: Path | None, *, trade: bool, **options: Any
) -> tuple[MapReport, dict[str, Path]]:
    """Report of a campaign, and its files."""
    from eigencontact.errors import SceneError
    from eigencontact_verification.campaign.perform import perform
    from eigencontact_verification.campaign.report import FILES, as_section, write_map
    from eigencontact_verification.reporting.files import open_folder
    from eigencontact_verification.reporting.progress import counted
    from eigencontact_verification.reporting.table import check_section, replace_section

    try:
        if markdown is not None:
            check_section(markdown, item.name, family="campaign")
    except ValueError as problem:
        raise SceneError(f"--markdown: {problem}") from None
    open_folder(folder, FILES.values())
    with counted(item.name) as tell:
        report = perform(item, folder, tell=tell, **options)
    files = write_map(report, folder)
    if markdown is not None:
        replace_section(markdown, item.name, as_section(report, trade=trade), family="campaign")
    return report, files


def _report(report: MapReport) -> None:
    from rich.console import Console
    from rich.table import Table

    from eigencontact.core.text_table import print_table
    from eigencontact_verification.campaign.answer import answers, totals
    from eigencontact_verification.campaign.figure import quantities_of
    from eigencontact_verification.reporting.verdict import MARKS

    campaign, points = report.campaign, report.points
    typer.echo(campaign.title)
    names = quantities_of(campaign, points)
    table = Table("point", "claimed", *names, box=None, pad_edge=False)
    for point in points:
        cells = {finding.quantity: f"{MARKS[finding.word]} {finding.numbers}" for finding in point.findings}
        count = sum(finding.claimed for finding in point.findings)
        claimed = "no" if not count else "yes" if count == len(point.findings) else "in part"
        style = "bold red" if point.breaks_claim else None
        table.add_row(point.point.label, claimed, *(cells.get(name, "") for name in names), style=style)
    console = Console(highlight=False)
    width = console.width if console.is_terminal else 40 + 24 * (len(names) + 1)
    print_table(table, Console(highlight=False, width=width))
    for point in points:
        for finding in point.findings:
            if finding.word == "failed":
                typer.echo(f"{point.point.label}, {finding.quantity}: {finding.reason}", err=True)
    for line in answers(campaign, points):
        typer.echo(line)
    typer.echo(totals(campaign, points))
