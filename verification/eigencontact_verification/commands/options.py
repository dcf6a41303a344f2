"""Options that the commands of verification share, and how these commands list, show and end."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn, TypeVar

import typer

if TYPE_CHECKING:
    from eigencontact.engines.cluster import Cluster
    from eigencontact_verification.studies.catalogue import Catalogue

__all__ = [
    "AsJson", "Coarse", "Errors", "Form", "Name", "Output", "Quiet", "Show", "Workers", "chosen_file",
    "cluster_or_none", "leave", "print_keys", "with_clear_errors",
]  # fmt: skip

T = TypeVar("T")

Name = Annotated[
    str | None, typer.Argument(help="Name of a bundled file, or a TOML file; without it the bundled files are listed.")
]
Output = Annotated[
    Path, typer.Option("-o", "--output", metavar="DIR", help="Folder of the report; other files in it are kept.")
]
Workers = Annotated[int | None, typer.Option("--workers", metavar="N", min=1, help="Processes at a time.")]
Coarse = Annotated[bool, typer.Option("--coarse", help="Fewer variants and cells, for a first look.")]
Errors = Annotated[
    bool, typer.Option("--errors", help="Estimate the errors of the numbers of every run from coarser runs.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]
Form = Annotated[bool, typer.Option("--form", help="Print the keys of the file.")]
Show = Annotated[bool, typer.Option("--show", help="Print a bundled file, as a template.")]


def leave(problem: str, code: int) -> NoReturn:
    """End the command with one line on the error output."""
    typer.echo(f"eigencontact: {' '.join(problem.split())}", err=True)
    raise typer.Exit(code) from None


@contextmanager
def with_clear_errors(interrupted: str = "the same command resumes and reuses what is finished") -> Iterator[None]:
    """Run a command; a refusal, a file that cannot be written, and an interruption end it with one line.

    Parameters
    ----------
    interrupted : str
        State after an interruption, in words.
    """
    from eigencontact.errors import EigencontactError

    try:
        yield
    except EigencontactError as problem:
        leave(str(problem), problem.exit_code)
    except OSError as problem:
        leave(f"the report cannot be written: {problem}", 2)
    except KeyboardInterrupt:
        leave(f"interrupted; {interrupted}", 130)


def cluster_or_none(
    workers: int | None, address: str | None, memory: float | None, threads: int | None
) -> Cluster | None:
    """Cluster of the options; None where processes of this machine perform the tasks.

    Raises
    ------
    SceneError
        Workers beside a cluster, which has its own.
    """
    from eigencontact.engines.cluster import cluster_of
    from eigencontact.errors import SceneError

    if address is not None and workers not in (None, 1):
        raise SceneError(f"--workers must be left out with --cluster, which sets its own number (got {workers})")
    return cluster_of(address, memory, threads, say=lambda words: typer.echo(words, err=True))


def chosen_file(
    catalogue: Catalogue[T], name: str | None, *, show: bool, columns: Mapping[str, Callable[[T], str]]
) -> T | None:
    """Content of the file to compute; None where there is no name, and the bundled files are listed, or it is shown.

    Parameters
    ----------
    catalogue : Catalogue
        Where the name is looked up.
    name : str, optional
        Name of a bundled file, or a path.
    show : bool
        Whether the text of the file is printed instead.
    columns : mapping
        Cells of the list by their title; the first is the name.
    """
    if name is not None:
        item = catalogue.find(name)
        if not show:
            return item
        typer.echo(catalogue.text(name), nl=False)
        return None
    from rich.table import Table

    from eigencontact.core.text_table import print_table

    table = Table(*columns, box=None, pad_edge=False)
    for item in map(catalogue.find, catalogue.names()):
        table.add_row(*(cell(item) for cell in columns.values()))
    print_table(table)
    return None


def print_keys(tables: Mapping[str, Mapping[str, str]], kind: str = "", width: int = 12) -> None:
    """Print keys and their meaning, table by table; the tables of a file, its own and those in it, have its kind."""
    for number, (table, keys) in enumerate(tables.items()):
        head = f"{table} (in a {kind})" if kind and table != kind else table
        typer.echo(f"\n{head}" if number or not kind else head)
        for key, meaning in keys.items():
            typer.echo(f"  {key:<{width}} {meaning}")
