"""Arguments and options of the commands on stored results, and the output of a result."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from eigencontact import completion

if TYPE_CHECKING:
    from eigencontact.postprocess.answer import Answer

__all__ = [
    "CriterionOption",
    "CycleOption",
    "OutputOption",
    "PluginOption",
    "ResultsArgument",
    "parameters_of",
    "print_answer",
    "steps_of",
]

ResultsArgument = Annotated[
    Path,
    typer.Argument(
        help="A folder of results, or its results.nc.", metavar="RESULTS", autocompletion=completion.results
    ),
]
CriterionOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Parameter of the criterion: `--set slope=0.3`; repeatable."),
]
CycleOption = Annotated[
    str,
    typer.Option("--cycle", metavar="STEPS", help="`last` (closed cycle), `all`, or first and last step: `11:51`."),
]
PluginOption = Annotated[
    list[Path] | None,
    typer.Option("--plugin", metavar="FILE", help="File with a criterion of your own; repeatable."),
]
OutputOption = Annotated[
    Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder; by default that of the results.")
]


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


def steps_of(text: str) -> Any:
    """Steps by a word or by two numbers; refuses others if the steps are known."""
    first, colon, last = text.partition(":")
    return (int(first), int(last)) if colon and first.strip().isdigit() and last.strip().isdigit() else text


def print_answer(answer: Answer, *, quiet: bool, as_json: bool, table: str = "") -> None:
    """Print the summary as JSON, or the lines of a result, its table and its files."""
    if as_json:
        typer.echo(json.dumps(answer.summary, indent=2, default=str))
    elif not quiet:
        files = [f"{path}  {text}" for path, text in answer.files.items()]
        for line in [*answer.lines(), *([table] if table else []), *files]:
            typer.echo(line)
