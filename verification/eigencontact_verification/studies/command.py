"""The command `eigencontact study`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["study"]


def study(
    name: Annotated[str | None, typer.Argument(help="Name of a study; without one they are listed.")] = None,
    *,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder of results and figure.")] = Path(
        "studies"
    ),
    coarse: Annotated[bool, typer.Option("--coarse", help="Fewer variants and cells, for a first look.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the numbers as JSON.")] = False,
) -> None:
    """Compute a trend anew: variants of a scene, their numbers and a figure. Finished variants are not run again."""
    from eigencontact.errors import EigencontactError

    try:
        if name is None:
            _list()
        else:
            _run(name, output, coarse=coarse, as_json=as_json)
    except EigencontactError as problem:
        typer.echo(f"eigencontact: {problem}", err=True)
        raise typer.Exit(1) from None


def _list() -> None:
    from rich.console import Console
    from rich.table import Table

    from eigencontact_verification.studies.catalogue import studies

    table = Table("study", "what", "repeats", box=None, pad_edge=False)
    for item in studies():
        table.add_row(item.name, item.title, item.repeats)
    Console().print(table)


def _run(name: str, output: Path, *, coarse: bool, as_json: bool) -> None:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    from rich.table import Table

    from eigencontact_verification.studies.catalogue import find
    from eigencontact_verification.studies.study import Finished, run_study, write_study

    item, console = find(name), Console(stderr=True)
    total = len(item.variants(coarse=coarse))
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.completed}/{task.total}"))
    found: list[Finished] = []
    with Progress(*columns, TimeElapsedColumn(), console=console) as bar:
        task = bar.add_task(item.name, total=total)
        for finished in run_study(item, output, coarse=coarse):
            found.append(finished)
            bar.advance(task)
    files = write_study(item, found, output)
    for finished in found:
        finished.dataset.close()
    if as_json:
        typer.echo(files[1].read_text(encoding="utf-8"))
        return
    table = Table("variant", *found[0].row, title=item.title, box=None, pad_edge=False)
    for finished in found:
        table.add_row(finished.variant.label, *(f"{value:.4g}" for value in finished.row.values()))
    Console().print(table)
    if item.remark:
        typer.echo(item.remark)
    typer.echo(f"written: {', '.join(str(path) for path in files)}")
