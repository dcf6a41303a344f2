"""Options that the commands of verification share, and how these commands end."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

if TYPE_CHECKING:
    from eigencontact.engines.cluster import Cluster

__all__ = [
    "AsJson", "Coarse", "Form", "Name", "Output", "Quiet", "Show", "Workers", "cluster_or_none", "leave",
    "show_bundled", "show_form", "with_clear_errors",
]  # fmt: skip

Name = Annotated[
    str | None, typer.Argument(help="A bundled one, or a TOML file of your own; without a name they are listed.")
]
Output = Annotated[
    Path, typer.Option("-o", "--output", metavar="DIR", help="Folder of the report; files of another origin stay.")
]
Workers = Annotated[int | None, typer.Option("--workers", metavar="N", min=1, help="Processes at a time.")]
Coarse = Annotated[bool, typer.Option("--coarse", help="Fewer variants and cells, for a first look.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]
Form = Annotated[bool, typer.Option("--form", help="Print the keys of such a file.")]
Show = Annotated[bool, typer.Option("--show", help="Print the file of a bundled one, to start from.")]


def leave(problem: str, code: int) -> NoReturn:
    """End the command with one line on the error output."""
    typer.echo(f"eigencontact: {' '.join(problem.split())}", err=True)
    raise typer.Exit(code) from None


@contextmanager
def with_clear_errors(interrupted: str = "the same command resumes and reuses what is finished") -> Iterator[None]:
    """Run a command; what it refuses, a file that cannot be written, and an interruption end it with one line.

    Parameters
    ----------
    interrupted : str
        What an interruption leaves behind.
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
        raise SceneError(f"--workers must be without --cluster, which has its own (got {workers}); leave it out")
    return cluster_of(address, memory, threads, say=lambda words: typer.echo(words, err=True))


def show_bundled(name: str, kind: str, folder: str) -> None:
    """Print the TOML file of a bundled study or campaign."""
    from eigencontact_verification.reporting.bundled import text_of

    typer.echo(text_of(name, kind, folder), nl=False)


def show_form(form: dict[str, dict[str, str]], kind: str) -> None:
    """Print the keys of the tables of a study or campaign."""
    for table, keys in form.items():
        typer.echo(table if table == kind else f"\n{table} (in a {kind})")
        for key, meaning in keys.items():
            typer.echo(f"  {key:<12} {meaning}")
