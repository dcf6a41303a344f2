"""The command `eigencontact campaign`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from eigencontact.engines.options import ClusterAddress, TaskThreads

if TYPE_CHECKING:
    from eigencontact_verification.campaign.report import MapReport

__all__ = ["campaign"]


def campaign(
    name: Annotated[
        str | None, typer.Argument(help="A bundled campaign, or a TOML file of your own; without one they are listed.")
    ] = None,
    *,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder of runs and reports.")] = Path(
        "campaigns"
    ),
    coarse: Annotated[bool, typer.Option("--coarse", help="Fewer points and cells, for a first look.")] = False,
    workers: Annotated[int, typer.Option("--workers", min=1, help="Processes at a time.")] = 1,
    cluster: ClusterAddress = None,
    memory: Annotated[
        float | None,
        typer.Option("--memory", metavar="GB", min=0.1, help="Of a solution by elements (6); on a cluster, of all."),
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
        bool, typer.Option("--trade", help="Write what both sides cost there instead: error, time, memory.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")] = False,
    form: Annotated[bool, typer.Option("--form", help="Print what a campaign may hold: keys.")] = False,
    show: Annotated[bool, typer.Option("--show", help="Print the file of a bundled campaign, to start from.")] = False,
) -> None:  # fmt: skip
    """Map where a model is accurate: its error over a range of parameters, with a verdict at each point.

    Re-running resumes; finished runs and solutions are reused.

    A campaign is a TOML file: scenes, what is varied, who judges (another model, finite elements under the tractions of
    each run, a contact by finite elements), the tolerance, and where agreement is claimed. `--form` tells its keys.

    Exit codes: 0 nothing disagrees where agreement is claimed, 1 something does or could not be solved, 2 wrong input,
    130 interrupted.

    Example: `eigencontact campaign inclusions-by-depth --coarse`
    """
    from eigencontact.errors import EigencontactError

    try:
        if form:
            _print_form()
        elif name is None:
            _list()
        elif show:
            _show(name)
        else:
            on = cluster, memory, threads
            report = _run(name, output, coarse=coarse, workers=workers, on=on, markdown=markdown, trade=trade,
                          as_json=as_json)  # fmt: skip
            raise typer.Exit(report.exit_code)
    except EigencontactError as problem:
        _leave(str(problem), problem.exit_code)
    except OSError as problem:
        _leave(f"the report cannot be written: {problem}", 2)
    except KeyboardInterrupt:
        _leave("interrupted; the same command resumes and reuses what is finished", 130)


def _leave(problem: str, code: int) -> NoReturn:
    typer.echo(f"eigencontact: {' '.join(problem.split())}", err=True)
    raise typer.Exit(code) from None


def _list() -> None:
    from rich.table import Table

    from eigencontact.core.text_table import print_table
    from eigencontact_verification.campaign.campaign import find, names

    table = Table("campaign", "question", "judge", box=None, pad_edge=False)
    for item in map(find, names()):
        table.add_row(item.name, item.title, item.judge)
    print_table(table)


def _print_form() -> None:
    from eigencontact_verification.campaign.form import FORM

    for table, keys in FORM.items():
        typer.echo(table if table == "campaign" else f"\n{table} (in a campaign)")
        for key, meaning in keys.items():
            typer.echo(f"  {key:<12} {meaning}")
    typer.echo("\n`source`, `vary` and `when` are those of a study, and so are formulas: `eigencontact study --form`")


def _show(name: str) -> None:
    from eigencontact_verification.campaign.campaign import FOLDER, find
    from eigencontact_verification.reporting.bundled import text_of

    find(name)  # refuses what is none
    typer.echo(text_of(name, "campaign", FOLDER), nl=False)


def _run(
    name: str, output: Path, *, coarse: bool, workers: int, on: tuple[str | None, float | None, int | None],
    markdown: Path | None, trade: bool, as_json: bool,
) -> MapReport:  # fmt: skip
    from eigencontact.engines.cluster import cluster_of
    from eigencontact.errors import SceneError
    from eigencontact.results.atomic import writable_folder
    from eigencontact_verification.campaign.campaign import find
    from eigencontact_verification.campaign.perform import perform
    from eigencontact_verification.campaign.report import as_section, write_map
    from eigencontact_verification.reporting.progress import counted
    from eigencontact_verification.reporting.table import check_section, replace_section

    item = find(name)
    address, gigabytes, threads = on
    needed = None if gigabytes is None else 1e9 * gigabytes
    say = partial(typer.echo, err=True)
    cluster = cluster_of(address, None if address is None else gigabytes, threads, say=say)
    if cluster is not None and workers != 1:
        raise SceneError(f"workers must be without cluster, which has its own (got {workers})")
    try:
        if markdown is not None:
            check_section(markdown, item.name, family="campaign")
    except ValueError as problem:
        raise SceneError(f"--markdown: {problem}") from None
    folder = output / item.name
    writable_folder(folder)
    with counted(item.name) as tell:
        report = perform(item, folder, coarse=coarse, workers=workers, cluster=cluster, memory=needed, told=tell)
    files = write_map(report, folder)
    if markdown is not None:
        replace_section(markdown, item.name, as_section(report, trade=trade), family="campaign")
    if as_json:
        typer.echo(files["json"].read_text(encoding="utf-8"), nl=False)
    else:
        _report(report)
        typer.echo(f"written: {', '.join(str(path) for path in files.values())}")
    return report


def _report(report: MapReport) -> None:
    from rich.console import Console
    from rich.table import Table

    from eigencontact.core.text_table import print_table
    from eigencontact_verification.campaign.answer import answers, totals
    from eigencontact_verification.campaign.figure import quantities_of
    from eigencontact_verification.reporting.verdict import MARKS, percent

    campaign, found = report.campaign, report.found
    typer.echo(campaign.title)
    names = quantities_of(campaign, found)
    table = Table("point", "claimed", *names, box=None, pad_edge=False)
    for one in found:
        cells = {f.quantity: f"{MARKS[f.word]} {percent(f.error)} ± {percent(f.uncertainty)}" for f in one.findings}
        count = sum(finding.claimed for finding in one.findings)
        claimed = "no" if not count else "yes" if count == len(one.findings) else "in part"
        style = "bold red" if one.breaks_claim else None
        table.add_row(one.point.label, claimed, *(cells.get(name, "") for name in names), style=style)
    console = Console(highlight=False)
    width = console.width if console.is_terminal else 40 + 24 * (len(names) + 1)
    print_table(table, Console(highlight=False, width=width))
    for one in found:
        for finding in one.findings:
            if finding.word == "failed":
                typer.echo(f"{one.point.label}, {finding.quantity}: {finding.reason}", err=True)
    for line in answers(campaign, found):
        typer.echo(line)
    typer.echo(totals(campaign, found))
