"""The command `eigencontact sweep`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from eigencontact import completion
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
    from eigencontact.errors import EigencontactError

    try:
        on = cluster, memory, threads
        _run(scene, vary or [], changes or [], output, as_json=as_json, workers=workers, on=on, options_given={
            "pairs": pairs, "fields": field or [], "scalars": scalar or [], "pictures": pictures,
            "overwrite": overwrite,
            "grid": "shared" if shared_grid else "own",
        })  # fmt: skip
    except EigencontactError as problem:
        typer.echo(f"eigencontact: {' '.join(str(problem).split())}", err=True)
        raise typer.Exit(problem.exit_code) from None
    except KeyboardInterrupt:
        typer.echo("eigencontact: interrupted; the same command resumes and reuses finished variants", err=True)
        raise typer.Exit(130) from None


def _run(
    scene: str, vary: list[str], changes: list[str], output: Path | None, *, as_json: bool, workers: int,
    on: tuple[str | None, float | None, int | None], options_given: dict[str, Any],
) -> None:  # fmt: skip
    import json

    from eigencontact.app import load_scene
    from eigencontact.engines.cluster import cluster_of
    from eigencontact.sweeps.sweep import read_sweep_file
    from eigencontact.sweeps.sweep import sweep as run_sweep

    description: dict[str, Any] = {"scene": scene, "vary": vary}
    if not vary and Path(scene).is_file():
        description = read_sweep_file(Path(scene))
    loaded = load_scene(description.pop("scene"), changes)
    folder = output or Path(f"{Path(scene).stem if Path(scene).is_file() else loaded.label}-sweep")
    options = {
        **description,
        **{name: value for name, value in options_given.items() if value not in (False, [], "own")},
    }

    def say(line: str) -> None:
        typer.echo(line, err=True)

    cluster = cluster_of(*on, say=say)
    with _progress(enabled=not as_json) as tell:
        result = run_sweep(
            loaded, options.pop("vary"), folder, workers=workers, cluster=cluster, told=tell,
            say=None if as_json else say, **options
        )  # fmt: skip
    if as_json:
        content = {"folder": str(folder)}
        content |= {name: getattr(result, name) for name in ("files", "failed", "warnings", "problems")}
        typer.echo(json.dumps(content, indent=2))
    else:
        _report(result)
    if result.failed:
        raise typer.Exit(1)


def _progress(*, enabled: bool) -> Any:
    """Bar on a terminal, else a line for each variant."""
    from contextlib import contextmanager

    @contextmanager
    def bar() -> Any:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        from eigencontact.core.units import time_in_words
        from eigencontact.progress import draws_in_place

        console = Console(stderr=True)
        if not enabled:
            yield None
            return
        if not draws_in_place(sys.stderr):
            yield lambda outcome, finished, total: typer.echo(
                f"variant {finished} of {total}: {outcome.failed or time_in_words(outcome.seconds)}", err=True
            )
            return
        columns = (TextColumn("variants"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        with Progress(*columns, console=console, transient=True) as display:
            task = display.add_task("variants", total=None)
            yield lambda outcome, finished, total: display.update(task, completed=finished, total=total)  # noqa: ARG005

    return bar()


def _report(result: Any) -> None:
    from rich.console import Console
    from rich.table import Table

    from eigencontact.core.text_table import print_table
    from eigencontact.sweeps.warned import warnings_in_words

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
