"""The command `eigencontact report`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eigencontact import completion
from eigencontact.command_help import QuietOption, refusals

__all__ = ["report"]


def report(
    results: Annotated[
        Path,
        typer.Argument(
            help="The folder of a run or of a sweep, or a results.nc.",
            metavar="RESULTS",
            autocompletion=completion.results,
        ),
    ],
    *,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="File of the page; by default report.html in RESULTS."),
    ] = None,
    quiet: QuietOption = False,
) -> None:
    """Write one HTML page about a run or a sweep: scene, plan, certificates, numbers, pictures, times, sources to cite.

    Example: `eigencontact run hertz && eigencontact report hertz`
    """
    from eigencontact.core.units import readable
    from eigencontact.reports.report import report as write

    with refusals(" "):
        page = write(results, output)
    if not quiet:
        typer.echo(f"{page}  one page, {readable(page.stat().st_size, 'B')}, that needs no network")
