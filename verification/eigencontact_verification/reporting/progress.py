"""Progress of a command: a bar on a terminal that draws in place, else a line for each finished item."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

import typer

__all__ = ["counted"]


@contextmanager
def counted(
    name: str, unit: str = "", *, show: bool = True, lines: bool = True
) -> Iterator[Callable[[str, int, int], None]]:
    """Function to call with the label of a finished item, its number, and the number of all; shows the time left.

    Parameters
    ----------
    name : str
        What is performed; before the bar.
    unit : str
        Before the number in lines: ``"variant "``.
    show : bool
        Whether to show anything.
    lines : bool
        Whether to write a line for each item where the terminal does not draw in place.
    """
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    from eigencontact.core.units import time_in_words
    from eigencontact.progress import draws_in_place

    began = monotonic()

    def line(label: str, done: int, total: int) -> None:
        left = (monotonic() - began) / done * (total - done)
        remaining = f"; about {time_in_words(left)} left" if done < total else ""
        typer.echo(f"{unit}{done} of {total}: {label}{remaining}", err=True)

    if not (show and draws_in_place(sys.stderr)):
        yield line if show and lines else lambda _label, _done, _total: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(name, total=None)
        yield lambda _label, done, total: bar.update(task, completed=done, total=total)
