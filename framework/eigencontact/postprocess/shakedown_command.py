"""The command `eigencontact shakedown`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from eigencontact import completion
from eigencontact.command_help import JsonOption, QuietOption, refusals
from eigencontact.postprocess.fatigue_command import steps_of

__all__ = ["shakedown"]


def shakedown(
    results: Annotated[
        Path,
        typer.Argument(
            help="A folder of results, or its results.nc.", metavar="RESULTS", autocompletion=completion.results
        ),
    ],
    *,
    body: Annotated[
        int, typer.Option("--body", metavar="NUMBER", help="Body with a law that yields.", min=1, max=2)
    ] = 1,
    cycle: Annotated[
        str,
        typer.Option("--cycle", metavar="STEPS", help="`last` (closed cycle), `all`, or first and last step: `11:51`."),
    ] = "last",
    tolerance: Annotated[
        float, typer.Option("--tolerance", metavar="PART", help="Part of the largest plastic strain that is nothing.")
    ] = 1e-3,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder; by default that of the results.")
    ] = None,
    quiet: QuietOption = False,
    as_json: JsonOption = False,
) -> None:
    """Find where a body shakes down and where it ratchets, from stored plastic strain at both ends of a cycle.

    The run needs `output.history = "all"`.
    """
    with refusals():
        from eigencontact.postprocess.shakedown import shakedown as evaluate
        from eigencontact.results.reader import results_file

        answer = evaluate(
            results,
            body=body,  # type: ignore[arg-type]
            cycle=steps_of(cycle),
            tolerance=tolerance,
            folder=output or results_file(results).parent,
        )
    if as_json:
        typer.echo(json.dumps(answer.summary, indent=2))
    elif not quiet:
        for line in [*answer.lines(), *(f"{path}  {text}" for path, text in answer.files.items())]:
            typer.echo(line)
