"""Progress of a command: a bar on a terminal that draws in place, else a line for each finished item."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Protocol

import typer

__all__ = ["Tell", "counted"]


class Tell(Protocol):
    """Function that commands call after each finished item."""

    def __call__(self, label: str, done: int, total: int, /, share: float | None = None) -> None:
        """Show an item with its number, the number of all, and the share of the work that is done, 0 to 1."""


@contextmanager
def counted(name: str, unit: str = "", *, show: bool = True, interval: float = 0.0) -> Iterator[Tell]:
    """Give a function to call after each finished item; it shows how many are done and the time left.

    Parameters
    ----------
    name : str
        Name of the work, before the bar.
    unit : str
        Text before the number in lines: ``"variant "``.
    show : bool
        Whether to show anything.
    interval : float
        Least time between two lines [s], where the terminal does not draw in place; ``inf``: no lines.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    from eigencontact.core.units import time_in_words
    from eigencontact.progress import draws_in_place

    began = last = monotonic()

    def line(label: str, done: int, total: int, /, share: float | None = None) -> None:
        nonlocal last
        time, share = monotonic(), share or done / total
        if time - last < interval:
            return
        last = time
        remaining = f"; about {time_in_words((time - began) / share * (1.0 - share))} left" if done < total else ""
        typer.echo(f"{unit}{done} of {total}: {label}{remaining}", err=True)

    def nothing(label: str, done: int, total: int, /, share: float | None = None) -> None:
        """Show nothing."""

    if not (show and draws_in_place(sys.stderr)):
        yield line if show else nothing
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn(), TextColumn("left"))
    with Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(name, total=1.0)

        def draw(_label: str, done: int, total: int, /, share: float | None = None) -> None:
            bar.update(task, completed=share or done / total, description=f"{name}, {done} of {total}")

        yield draw
