"""The command `eigencontact crack`; this module imports little, because the help of `eigencontact` loads it."""

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

__all__ = ["crack"]


def crack(
    results: ResultsArgument,
    *,
    length: Annotated[str, typer.Option("--length", metavar="LENGTH", help="Longest crack: `200 um`.")],
    threshold: Annotated[
        str, typer.Option("--threshold", metavar="RANGE", help="Threshold of long cracks: `5 MPa sqrt(m)`.")
    ],
    limit_amplitude: Annotated[
        str | None,
        typer.Option(
            "--limit-amplitude", metavar="STRESS", help="Stress amplitude of a smooth specimen, fully reversed."
        ),
    ] = None,
    at: Annotated[str | None, typer.Option("--at", metavar="X,Y", help="Place on the surface: `-20 um, 0 um`.")] = None,
    criterion: Annotated[
        str | None, typer.Option("--from", metavar="NAME", help="Instead, the hot spot of a fatigue criterion.")
    ] = None,
    changes: CriterionOption = None,
    angle: Annotated[
        str | None,
        typer.Option("--angle", metavar="ANGLE", help="To the inward normal, positive towards +x: `20 deg`."),
    ] = None,
    rule: Annotated[
        str, typer.Option("--rule", metavar="NAME", help="Short cracks: `el-haddad` or `kitagawa-takahashi`.")
    ] = "el-haddad",
    mode: Annotated[
        str, typer.Option("--mode", metavar="NAME", help="Compare `both` modes together, or `opening` alone.")
    ] = "both",
    region: Annotated[
        str | None, typer.Option("--region", metavar="NAME", help="Region of the hot spot, or of the stress.")
    ] = None,
    cycle: CycleOption = "last",
    plugin: PluginOption = None,
    output: OutputOption = None,
    quiet: QuietOption = False,
    as_json: JsonOption = False,
) -> None:
    """Determine whether a crack from the surface grows or stops, over one cycle of stored results.

    Example: `eigencontact crack RUN --at "-20 um, 0 um" --angle "20 deg" --length "100 um" --threshold "5 MPa sqrt(m)"`
    """
    with refusals():
        from eigencontact.postprocess.crack import crack as evaluate
        from eigencontact.results.reader import results_file
        from eigencontact.scene.installed import add_plugin_files

        add_plugin_files(plugin or [])
        answer = evaluate(
            results,
            length=length,
            threshold=threshold,
            limit_amplitude=limit_amplitude,
            at=None if at is None else tuple(coordinate.strip() for coordinate in at.split(",")),
            criterion=None if criterion is None else {"type": criterion, **parameters_of(changes or [])},
            angle=angle,
            rule=rule,  # type: ignore[arg-type]
            mode=mode,  # type: ignore[arg-type]
            region=region,
            cycle=steps_of(cycle),
            folder=output or results_file(results).parent,
        )
    print_answer(answer, quiet=quiet, as_json=as_json, table=answer.table())
