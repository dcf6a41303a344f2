"""The command `eigencontact study`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eigencontact.engines.options import ClusterAddress, TaskMemory, TaskThreads

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eigencontact_verification.studies.run import Failed
    from eigencontact_verification.studies.study import Finished, Study

__all__ = ["study"]


def study(
    name: Annotated[
        str | None, typer.Argument(help="A bundled study, or a TOML file of your own; without one they are listed.")
    ] = None,
    *,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder of results and figure.")] = Path(
        "studies"
    ),
    coarse: Annotated[bool, typer.Option("--coarse", help="Fewer variants and cells, for a first look.")] = False,
    workers: Annotated[int, typer.Option("--workers", min=1, help="Processes that share the variants.")] = 1,
    cluster: ClusterAddress = None,
    memory: TaskMemory = None,
    threads: TaskThreads = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the numbers as JSON.")] = False,
    form: Annotated[bool, typer.Option("--form", help="Print what a study may hold: keys and functions.")] = False,
    show: Annotated[bool, typer.Option("--show", help="Print the file of a bundled study, to start from.")] = False,
) -> None:
    """Reproduce a trend of the literature: a parameter sweep from one file, its numbers, and a figure with its source.

    Re-running resumes; finished variants are reused.

    A study is a TOML file: a scene, what is varied, what is read and drawn, and where the trend was published. `--form`
    tells its keys. Example: `eigencontact study spence-radius --show > my.toml`, then `eigencontact study my.toml`.
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
            _run(name, output, coarse=coarse, workers=workers, on=(cluster, memory, threads), as_json=as_json)
    except EigencontactError as problem:
        typer.echo(f"eigencontact: {' '.join(str(problem).split())}", err=True)
        raise typer.Exit(problem.exit_code) from None
    except KeyboardInterrupt:
        typer.echo("eigencontact: interrupted; the same command resumes and reuses finished variants", err=True)
        raise typer.Exit(130) from None


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

    for table, keys in FORM.items():
        typer.echo(f"{table}" if table == "study" else f"\n{table} (in a study)")
        for key, meaning in keys.items():
            typer.echo(f"  {key:<12} {meaning}")
    typer.echo("\nfunctions of formulas")
    told = {name: meaning for name, (_, meaning) in FUNCTIONS.items()}
    told |= {"given": "whether a variant has a parameter", "has": "whether results have a name"}
    for key, meaning in told.items():
        typer.echo(f"  {key:<16} {meaning}")
    typer.echo("\nmoments of a load history, whose last argument is read then; a bare name is read at the end")
    for key, (_, meaning) in MOMENTS.items():
        typer.echo(f"  {key:<16} {meaning}")


def _show(name: str) -> None:
    from eigencontact_verification.reporting.bundled import text_of
    from eigencontact_verification.studies.catalogue import FOLDER, find

    find(name)  # refuses what is none
    typer.echo(text_of(name, "study", FOLDER), nl=False)


def _run(
    name: str,
    output: Path,
    *,
    coarse: bool,
    workers: int,
    on: tuple[str | None, float | None, int | None],
    as_json: bool,
) -> None:
    from eigencontact.engines.cluster import cluster_of
    from eigencontact.errors import SceneError
    from eigencontact.results.atomic import writable_folder
    from eigencontact_verification.reporting.progress import counted
    from eigencontact_verification.studies.catalogue import find
    from eigencontact_verification.studies.run import Failed, run_study, write_study

    item = find(name)
    cluster = cluster_of(*on, say=lambda words: typer.echo(words, err=True))
    if cluster is not None and workers != 1:
        raise SceneError(f"workers must be without cluster, which has its own (got {workers})")
    writable_folder(output / item.name)
    total = len(item.coarse_rows if coarse else item.rows)
    found: list[Finished | Failed] = []
    with counted(item.name, "variant ") as tell:
        for outcome in run_study(item, output, coarse=coarse, workers=workers, cluster=cluster):
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
    from eigencontact.sweeps.warned import warnings_in_words
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
