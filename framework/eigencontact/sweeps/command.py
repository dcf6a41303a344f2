"""The command `eigencontact sweep`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from eigencontact import completion
from eigencontact.command_help import refusals
from eigencontact.engines.options import ClusterAddress, TaskMemory, TaskThreads

__all__ = ["sweep"]


def sweep(
    scene: Annotated[
        str,
        typer.Argument(
            help="A scene, or a TOML file with `scene` and a table `vary`.",
            metavar="SCENE",
            autocompletion=completion.scenes,
        ),
    ],
    *,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary",
            metavar="KEY=VALUES",
            help="A key of the scene and its values: a list, `key=a,b,c`; `n` evenly spaced values, `key=from:to:n`; "
            "or `n` values of equal ratio, `key=from:to:n:log`. A comma separates values. Repeatable.",
        ),
    ] = None,
    pairs: Annotated[bool, typer.Option("--pairs", help="Vary the keys together, not in all combinations.")] = False,
    changes: Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a value.")] = None,
    field: Annotated[
        list[str] | None,
        typer.Option("--field", metavar="NAME", help="Surface field to store of all variants: `pressure`."),
    ] = None,
    scalar: Annotated[
        list[str] | None, typer.Option("--scalar", metavar="NAME", help="Result to draw: `max_pressure`; repeatable.")
    ] = None,
    shared_grid: Annotated[bool, typer.Option("--shared-grid", help="One window for all variants.")] = False,
    workers: Annotated[int, typer.Option("--workers", help="Processes that share the variants.")] = 1,
    cluster: ClusterAddress = None,
    memory: TaskMemory = None,
    threads: TaskThreads = None,
    pictures: Annotated[bool, typer.Option("--pictures", help="Also draw the pictures of each variant.")] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace the results of another sweep in the folder.")
    ] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder; by default ./SCENE-sweep.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print files and failures as JSON.")] = False,
) -> None:
    """Run every variant of a scene: one dataset, one table and a figure for each result.

    Re-running resumes: finished variants are reused. A failed variant is reported and recorded; the others continue.

    Example: `eigencontact sweep hertz --vary steps.normal-load="0.1 N:10 N:7:log" --vary geometry.radius="1 mm,2 mm"`
    """
    with refusals(" ", interrupted="the same command resumes and reuses finished variants"):
        options = {
            "pairs": pairs, "fields": field, "scalars": scalar, "pictures": pictures, "overwrite": overwrite,
            "grid": "shared" if shared_grid else None, "workers": workers,
        }  # fmt: skip
        given_options = {
            name: value for name, value in options.items() if value not in (None, []) and value is not False
        }
        _run(scene, vary, changes or [], output, (cluster, memory, threads), given_options, as_json=as_json)


def _run(
    scene: str, vary: list[str] | None, changes: list[str], output: Path | None,
    cluster: tuple[str | None, float | None, int | None], options: dict[str, Any], *, as_json: bool,
) -> None:  # fmt: skip
    """Run a sweep with options, on a cluster with an address, memory and threads of a task."""
    import json

    from eigencontact.app import load_scene
    from eigencontact.engines.cluster import cluster_of
    from eigencontact.sweeps.sweep import read_sweep_file
    from eigencontact.sweeps.sweep import sweep as run_sweep

    is_file = Path(scene).is_file()
    description: dict[str, Any] = {"scene": scene, "vary": vary or []}
    if not vary and is_file:
        description = read_sweep_file(Path(scene))
    loaded = load_scene(description.pop("scene"), changes)
    folder = output or Path(f"{Path(scene).stem if is_file else loaded.label}-sweep")

    def say(line: str) -> None:
        typer.echo(line, err=True)

    engine = cluster_of(*cluster, say=say)
    with _progress(enabled=not as_json) as tell:
        result = run_sweep(
            loaded, description.pop("vary"), folder, cluster=engine, report_progress=tell, say=None if as_json else say,
            **{**description, **options},
        )  # fmt: skip
    if as_json:
        content = {"folder": str(folder)}
        content |= {name: getattr(result, name) for name in ("files", "failed", "warnings", "problems")}
        typer.echo(json.dumps(content, indent=2))
    else:
        _report(result)
    if result.failed:
        raise typer.Exit(1)


@contextmanager
def _progress(*, enabled: bool) -> Iterator[Any]:
    """Bar on a terminal, else one line for each variant."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from eigencontact.core.units import time_in_words
    from eigencontact.progress import draws_in_place

    if not enabled:
        yield None
        return
    if not draws_in_place(sys.stderr):
        yield lambda outcome, finished, total: typer.echo(
            f"variant {finished} of {total}: {outcome.failed or time_in_words(outcome.seconds)}", err=True
        )
        return
    columns = (TextColumn("variants"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as display:
        task = display.add_task("variants", total=None)
        yield lambda outcome, finished, total: display.update(task, completed=finished, total=total)  # noqa: ARG005


def _report(result: Any) -> None:
    from rich.console import Console
    from rich.table import Table

    from eigencontact.core.text_table import print_table
    from eigencontact.sweeps.gather import warnings_in_words

    console = Console(highlight=False)
    files = Table.grid(padding=(0, 2))
    for name, text in result.files.items():
        files.add_row(f"  {name}", text)
    console.print(f"in {result.folder.resolve()}:", soft_wrap=True)
    print_table(files, console)
    for line in warnings_in_words(result.warnings, result.dataset["failed"].size):
        typer.echo(line)
    for label, problem in result.problems.items():
        typer.echo(f"eigencontact: variant {label}: {problem}", err=True)
    for label, reason in result.failed.items():
        typer.echo(f"eigencontact: variant {label} failed: {reason}", err=True)
