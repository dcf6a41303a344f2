"""The command `eigencontact map`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from eigencontact import completion
from eigencontact.command_help import QuietOption, refusals

__all__ = ["fretting_map"]

#: Tables of the options.
_EXAMPLES = {"criterion": 'type = "crossland", slope = 0.3, …', "crack": 'at = [0, 0], angle = 0, length = "50 um", …'}


def fretting_map(
    scene: Annotated[
        str,
        typer.Argument(help="A scene with a closed cycle.", metavar="SCENE", autocompletion=completion.scenes),
    ],
    *,
    load: Annotated[str, typer.Option("--load", metavar="VALUES", help="Normal loads: `5 N:50 N:20`, or a list.")],
    amplitude: Annotated[
        str, typer.Option("--amplitude", metavar="VALUES", help="Amplitudes of the motion: `0.1 um:2 um:20`.")
    ],
    changes: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a value of the scene.")
    ] = None,
    criterion: Annotated[
        str | None,
        typer.Option("--criterion", metavar="TABLE", help=f"Fatigue criterion: `{_EXAMPLES['criterion']}`."),
    ] = None,
    crack: Annotated[
        str | None,
        typer.Option("--crack", metavar="TABLE", help=f"Crack: `{_EXAMPLES['crack']}`."),
    ] = None,
    region: Annotated[
        str | None, typer.Option("--region", metavar="NAME", help="Region with stress, for criterion and crack.")
    ] = None,
    workers: Annotated[int, typer.Option("--workers", help="Processes that share the variants.")] = 1,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder; by default ./SCENE-map.")
    ] = None,
    quiet: QuietOption = False,
) -> None:
    """Map the regimes of fretting over normal load and amplitude: all loads with all amplitudes, in memory.

    Example: `eigencontact map fretting-mode-1 --load "5 N:20 N:6" --amplitude "0.1 um:2 um:8"`
    """
    with refusals():
        from eigencontact.app import load_scene
        from eigencontact.scene.inline_table import inline_table
        from eigencontact.sweeps.fretting_map import fretting_map as evaluate

        rules = [f"--{name} must be keys and values, {example}" for name, example in _EXAMPLES.items()]
        loaded = load_scene(scene, changes or [])
        answer = evaluate(
            loaded,
            load=load,
            amplitude=amplitude,
            criterion=None if criterion is None else inline_table(criterion, rules[0]),
            crack=None if crack is None else {k.replace("-", "_"): v for k, v in inline_table(crack, rules[1]).items()},
            region=region,
            workers=workers,
            folder=output or Path(f"{loaded.label}-map"),
        )
    if not quiet:
        for line in [*answer.lines(), *(f"{path}  {text}" for path, text in answer.files.items())]:
            typer.echo(line)
