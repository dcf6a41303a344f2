"""Tables of the command line: as wide as their columns on a terminal, without blanks at the ends of lines elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

__all__ = ["print_table"]


def print_table(table: Table, console: Console | None = None) -> None:
    """Print a table; into a pipe or a file, cells at the ends of lines are not padded.

    Examples
    --------
    >>> import io
    >>> from rich.console import Console
    >>> from rich.table import Table
    >>> table = Table("name", "value", box=None, pad_edge=False)
    >>> table.add_row("load", "1 N"); table.add_row("approach of the bodies", "")
    >>> stream = io.StringIO()
    >>> print_table(table, Console(file=stream))
    >>> [line for line in stream.getvalue().splitlines() if line != line.rstrip()]
    []
    """
    from rich.console import Console

    console = console or Console(highlight=False)
    if console.is_terminal:
        console.print(table)
        return
    with console.capture() as capture:
        console.print(table)
    print("\n".join(line.rstrip() for line in capture.get().splitlines()), file=console.file)
