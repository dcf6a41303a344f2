"""The command `eigencontact study`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from eigencontact.engines.options import ClusterAddress, TaskMemory, TaskThreads
from eigencontact_verification.commands.options import (
    AsJson,
    Coarse,
    Form,
    Name,
    Output,
    Show,
    Workers,
    cluster_or_none,
    show_bundled,
    show_form,
    with_clear_errors,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eigencontact_verification.studies.run import Failed
    from eigencontact_verification.studies.study import Finished, Study

__all__ = ["study"]


def study(
    name: Name = None,
    *,
    output: Output = Path("studies"),
    coarse: Coarse = False,
    workers: Workers = 1,
    cluster: ClusterAddress = None,
    memory: TaskMemory = None,
    threads: TaskThreads = None,
    as_json: AsJson = False,
    form: Form = False,
    show: Show = False,
) -> None:
    """Reproduce a trend of the literature: a parameter sweep from one file, its numbers, and a figure with its source.

    Re-running resumes; finished variants are reused.

    A study is a TOML file: a scene, what is varied, what is read and drawn, and where the trend was published. `--form`
    tells its keys. Example: `eigencontact study spence-radius --show > my.toml`, then `eigencontact study my.toml`.
    """
    with with_clear_errors():
        if form:
            _print_form()
        elif name is None:
            _list()
        elif show:
            _show(name)
        else:
            _run(name, output, coarse=coarse, workers=workers, on=(cluster, memory, threads), as_json=as_json)


def _list() -> None:
    from rich.table import Table

    from eigencontact.core.text_table import print_table
    from eigencontact_verification.studies.catalogue import studies

    table = Table("study", "what", "after", box=None, pad_edge=False)
    for item in studies():
        after = "; ".join(f"{one.get('authors', '')} {one.get('year', '')}, {one.get('figure', one.get('form', ''))}"
                          for one in item.sources)  # fmt: skip
        table.add_row(item.name, item.title, after)
    print_table(table)


def _print_form() -> None:
    from eigencontact_verification.studies.form import FORM
    from eigencontact_verification.studies.formula import FUNCTIONS
    from eigencontact_verification.studies.moments import MOMENTS

    show_form(FORM, "study")
    typer.echo("\nfunctions of formulas")
    told = {name: meaning for name, (_, meaning) in FUNCTIONS.items()}
    told |= {"given": "whether a variant has a parameter", "has": "whether results have a name"}
    for key, meaning in told.items():
        typer.echo(f"  {key:<16} {meaning}")
    typer.echo("\nmoments of a load history, whose last argument is read then; a bare name is read at the end")
    for key, (_, meaning) in MOMENTS.items():
        typer.echo(f"  {key:<16} {meaning}")


def _show(name: str) -> None:
    from eigencontact_verification.studies.catalogue import FOLDER, find

    find(name)  # refuses what is none
    show_bundled(name, "study", FOLDER)


def _run(
    name: str,
    output: Path,
    *,
    coarse: bool,
    workers: int | None,
    on: tuple[str | None, float | None, int | None],
    as_json: bool,
) -> None:
    from eigencontact_verification.reporting.files import open_folder
    from eigencontact_verification.reporting.progress import counted
    from eigencontact_verification.studies.catalogue import find
    from eigencontact_verification.studies.run import Failed, run_study, write_study

    item = find(name)
    cluster = cluster_or_none(workers, *on)
    open_folder(output, (f"{item.name}.json", f"{item.name}.png"))
    total = len(item.coarse_rows if coarse else item.rows)
    found: list[Finished | Failed] = []
    with counted(item.name, "variant ") as tell:
        for outcome in run_study(item, output, coarse=coarse, workers=workers or 1, cluster=cluster):
            found.append(outcome)
            tell(outcome.label, len(found), total)
    found.sort(key=lambda one: one.place)  # several processes finish in any order
    files = write_study(item, found, output)
    failed = [one for one in found if isinstance(one, Failed)]
    if as_json:
        typer.echo(files[-1].read_text(encoding="utf-8"))
    else:
        _report(item, found)
        typer.echo(f"written: {', '.join(str(path) for path in files)}")
    for one in found:
        if not isinstance(one, Failed):
            one.dataset.close()
    for bad in failed:
        typer.echo(f"eigencontact: variant {bad.label} failed: {bad.reason}", err=True)
    if failed:
        raise typer.Exit(1)


def _report(item: Study, found: Sequence[Finished | Failed]) -> None:
    from rich.table import Table

    from eigencontact.core.text_table import print_table
    from eigencontact.sweeps.gather import warnings_in_words
    from eigencontact_verification.studies.checks import verdicts
    from eigencontact_verification.studies.run import source_in_words
    from eigencontact_verification.studies.study import Finished

    done = [one for one in found if isinstance(one, Finished)]
    columns = dict.fromkeys(name for one in done for name in one.row)
    typer.echo(item.title)
    table = Table("variant", *columns, box=None, pad_edge=False)
    for one in done:
        table.add_row(one.label, *(f"{one.row[name]:.4g}" if name in one.row else "" for name in columns))
    print_table(table)
    for line in warnings_in_words({one.label: one.warnings for one in done}, len(found)):
        typer.echo(line)
    for verdict in verdicts(item, done):
        typer.echo(f"{'holds' if verdict.holds else 'does not hold'}: {verdict.check} ({verdict.found})")
    if item.trend:
        typer.echo(item.trend)
    for source in item.sources:
        typer.echo(f"after: {source_in_words(source)}")
