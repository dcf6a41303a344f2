"""How far a command has come: a bar on a terminal that draws in place, else a line for each of what is done."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import typer

__all__ = ["counted"]


@contextmanager
def counted(name: str, unit: str = "") -> Iterator[Callable[[str, int, int], None]]:
    """Function that is told what is done, the number of it, and of how many; `unit` goes before the number in lines."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from eigencontact.progress import draws_in_place

    if not draws_in_place(sys.stderr):
        yield lambda label, done, total: typer.echo(f"{unit}{done} of {total}: {label}", err=True)
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(name, total=None)
        yield lambda _label, done, total: bar.update(task, completed=done, total=total)
