"""The command `eigencontact fatigue`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

from typing import Annotated

import typer

from eigencontact.command_help import JsonOption, QuietOption, refusals
from eigencontact.postprocess.options import (
    CriterionOption,
    CycleOption,
    OutputOption,
    PluginOption,
    ResultsArgument,
    parameters_of,
    print_answer,
    steps_of,
)

__all__ = ["fatigue"]


def fatigue(
    results: ResultsArgument,
    *,
    criterion: Annotated[
        str, typer.Option("--criterion", metavar="NAME", help="`crossland`, `findley`, `dang-van`, …")
    ],
    changes: CriterionOption = None,
    region: Annotated[
        str | None, typer.Option("--region", metavar="NAME", help="Name of a region, or the table of a new region.")
    ] = None,
    cycle: CycleOption = "last",
    distance: Annotated[
        str | None, typer.Option("--distance", metavar="LENGTH", help="Critical distance: `50 um`.")
    ] = None,
    method: Annotated[
        str, typer.Option("--method", metavar="NAME", help="`point`, `line` or `volume`; see the page on output.")
    ] = "point",
    life: Annotated[
        str | None,
        typer.Option("--life", metavar="KEYS", help="Wöhler curve: `slope = 5, knee-cycles = 1e6, scatter = 1.5`."),
    ] = None,
    plugin: PluginOption = None,
    output: OutputOption = None,
    quiet: QuietOption = False,
    as_json: JsonOption = False,
) -> None:
    """Evaluate a fatigue criterion over one cycle in a region of stored results, with the hot spot.

    Example: `eigencontact fatigue RUN --criterion crossland --set slope=0.3 --set limit-amplitude="250 MPa"`

    `eigencontact plugins crossland` lists the parameters of a criterion.
    """
    with refusals():
        from eigencontact.postprocess.fatigue import fatigue as evaluate
        from eigencontact.results.reader import results_file
        from eigencontact.scene.inline_table import inline_table
        from eigencontact.scene.installed import add_plugin_files

        add_plugin_files(plugin or [])
        rule = "--life must be keys and values, slope = 5, knee-cycles = 1e6"
        answer = evaluate(
            results,
            {"type": criterion, **parameters_of(changes or [])},
            region=region,
            cycle=steps_of(cycle),
            distance=distance,
            method=method,  # type: ignore[arg-type]
            life=None if life is None else inline_table(life, rule),
            folder=output or results_file(results).parent,
        )
    print_answer(answer, quiet=quiet, as_json=as_json)
