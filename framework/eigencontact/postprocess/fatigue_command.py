"""The command `eigencontact fatigue`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from eigencontact import completion
from eigencontact.command_help import JsonOption, QuietOption, refusals

__all__ = ["fatigue", "parameters_of", "steps_of"]


def fatigue(
    results: Annotated[
        Path,
        typer.Argument(
            help="A folder of results, or its results.nc.", metavar="RESULTS", autocompletion=completion.results
        ),
    ],
    *,
    criterion: Annotated[
        str, typer.Option("--criterion", metavar="NAME", help="`crossland`, `findley`, `dang-van`, …")
    ],
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Parameter of the criterion: `--set slope=0.3`; repeatable."),
    ] = None,
    region: Annotated[
        str | None, typer.Option("--region", metavar="NAME", help="Name of a region, or the table of a new region.")
    ] = None,
    cycle: Annotated[
        str,
        typer.Option("--cycle", metavar="STEPS", help="`last` (closed cycle), `all`, or first and last step: `11:51`."),
    ] = "last",
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
    plugin: Annotated[
        list[Path] | None,
        typer.Option("--plugin", metavar="FILE", help="File with a criterion of your own; repeatable."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder; by default that of the results.")
    ] = None,
    quiet: QuietOption = False,
    as_json: JsonOption = False,
) -> None:
    """Find where a crack starts: a fatigue criterion over one cycle in a region of stored results.

    Example: `eigencontact fatigue RUN --criterion crossland --set slope=0.3 --set limit-amplitude="250 MPa"`

    `eigencontact plugins crossland` lists the parameters of a criterion.
    """
    with refusals():
        from eigencontact.postprocess.fatigue import fatigue as evaluate
        from eigencontact.results.reader import results_file
        from eigencontact.scene.installed import add_plugin_files

        add_plugin_files(plugin or [])
        found = evaluate(
            results,
            {"type": criterion, **parameters_of(changes or [])},
            region=region,
            cycle=steps_of(cycle),
            distance=distance,
            method=method,  # type: ignore[arg-type]
            life=None if life is None else _table(life, "--life"),
            folder=output or results_file(results).parent,
        )
    if as_json:
        typer.echo(json.dumps(found.summary, indent=2, default=str))
    elif not quiet:
        for line in [*found.lines(), *(f"{path}  {text}" for path, text in found.files.items())]:
            typer.echo(line)


def parameters_of(changes: list[str]) -> dict[str, Any]:
    """Parameters of a component from `key=value` texts."""
    from eigencontact.errors import SceneError

    out: dict[str, Any] = {}
    for change in changes:
        key, equals, text = change.partition("=")
        if not equals or not key.strip():
            raise SceneError(f"--set must be KEY=VALUE (got {change!r})")
        try:
            out[key.strip()] = float(text)
        except ValueError:
            out[key.strip()] = text.strip().strip("\"'")
    return out


def _table(text: str, option: str) -> dict[str, Any]:
    """Table of keys and values between commas, written as in a scene."""
    import tomllib

    from eigencontact.errors import SceneError

    try:
        return dict(tomllib.loads(f"table = {{ {text.strip().strip('{}')} }}")["table"])
    except tomllib.TOMLDecodeError as problem:
        raise SceneError(f"{option} must be keys and values, key = value, ... (got {text!r}: {problem})") from None


def steps_of(text: str) -> Any:
    """A word, or the numbers of two steps; others are refused where the steps are known."""
    first, colon, last = text.partition(":")
    return (int(first), int(last)) if colon and first.strip().isdigit() and last.strip().isdigit() else text
