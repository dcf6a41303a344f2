"""The command `eigencontact crack`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from eigencontact import completion
from eigencontact.command_help import JsonOption, QuietOption, refusals
from eigencontact.postprocess.fatigue_command import steps_of

__all__ = ["crack"]


def crack(
    results: Annotated[
        Path,
        typer.Argument(
            help="A folder of results, or its results.nc.", metavar="RESULTS", autocompletion=completion.results
        ),
    ],
    *,
    start: Annotated[
        Path | None,
        typer.Option("--from", metavar="FILE", help="`fatigue-….json` of `eigencontact fatigue`: place, plane, cycle."),
    ] = None,
    at: Annotated[
        str | None, typer.Option("--at", metavar="LENGTH", help="Place of the mouth along the section: `0.28 mm`.")
    ] = None,
    angle: Annotated[
        str | None,
        typer.Option("--angle", metavar="ANGLE", help="From the inward normal, positive towards the axis: `20 deg`."),
    ] = None,
    long_crack_range: Annotated[
        str | None,
        typer.Option("--long-crack-range", metavar="K", help="Threshold of long cracks: `'5 MPa*m^0.5'`."),
    ] = None,
    limit_range: Annotated[
        str | None,
        typer.Option("--limit-range", metavar="STRESS", help="Fatigue limit, a range (twice the amplitude)."),
    ] = None,
    curve: Annotated[
        str, typer.Option("--curve", metavar="NAME", help="Threshold: `el-haddad` or `kitagawa-takahashi`.")
    ] = "el-haddad",
    compare: Annotated[
        str, typer.Option("--compare", metavar="NAME", help="Range: `effective` (both modes) or `opening` (mode I).")
    ] = "effective",
    region: Annotated[str | None, typer.Option("--region", metavar="NAME", help="Section with stress.")] = None,
    cycle: Annotated[
        str | None,
        typer.Option("--cycle", metavar="STEPS", help="`last` (closed cycle), `all`, or first and last step: `11:51`."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder; by default that of the results.")
    ] = None,
    quiet: QuietOption = False,
    as_json: JsonOption = False,
) -> None:
    """Find whether a crack from the surface stops: stress intensity factors over a cycle against a threshold.

    Example: `eigencontact crack RUN --from RUN/fatigue-findley-section.json --long-crack-range '5 MPa*m^0.5'
    --limit-range '400 MPa'`
    """
    with refusals():
        from eigencontact.postprocess.crack import crack as evaluate
        from eigencontact.results.reader import results_file

        answer = evaluate(
            results,
            at=at,
            angle=angle,
            start=None if start is None else _summary(start),
            threshold=_threshold(long_crack_range, limit_range, curve),
            compare=compare,  # type: ignore[arg-type]
            region=region,
            cycle=None if cycle is None else steps_of(cycle),
            folder=output or results_file(results).parent,
        )
    if as_json:
        typer.echo(json.dumps(answer.summary, indent=2, default=str))
    elif not quiet:
        for line in [*answer.lines(), *(f"{path}  {text}" for path, text in answer.files.items())]:
            typer.echo(line)


def _summary(path: Path) -> dict[str, Any]:
    from eigencontact.errors import SceneError

    try:
        summary: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as problem:
        raise SceneError(f"--from must be a JSON file of eigencontact fatigue (got {str(path)!r}: {problem})") from None
    return summary


def _threshold(long_crack_range: str | None, limit_range: str | None, curve: str) -> dict[str, str] | None:
    ranges = {"long-crack-range": long_crack_range, "limit-range": limit_range}
    table = {key: value for key, value in ranges.items() if value is not None}
    return {**table, "curve": curve} if table else None
