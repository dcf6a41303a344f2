"""The command `eigencontact shakedown`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

from typing import Annotated

import typer

from eigencontact.command_help import JsonOption, QuietOption, refusals
from eigencontact.postprocess.options import CycleOption, OutputOption, ResultsArgument, print_answer, steps_of

__all__ = ["shakedown"]


def shakedown(
    results: ResultsArgument,
    *,
    body: Annotated[
        int, typer.Option("--body", metavar="NUMBER", help="Body with a law that yields.", min=1, max=2)
    ] = 1,
    cycle: CycleOption = "last",
    tolerance: Annotated[
        float, typer.Option("--tolerance", metavar="PART", help="Part of the largest plastic strain that is nothing.")
    ] = 1e-3,
    output: OutputOption = None,
    quiet: QuietOption = False,
    as_json: JsonOption = False,
) -> None:
    """Find shakedown and ratchetting in a body, from the stored plastic strain at both ends of a cycle.

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
    print_answer(answer, quiet=quiet, as_json=as_json)
