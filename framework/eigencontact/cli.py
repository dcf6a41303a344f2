"""Command line: run, explain, plugins, gallery, plot, cache, new-plugin, and commands of installed packages.

A package adds one with an entry point of the group ``eigencontact.commands``: its name is that of the command, its
value a function that Typer reads, in a module that imports little, because ``--help`` loads it. See `_Commands`.
"""

from __future__ import annotations

import gc
import json
import sys
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Annotated, Any

import typer

from eigencontact import completion
from eigencontact.command_help import (
    PANELS,
    HelpfulCommand,
    HelpfulGroup,
    JsonOption,
    QuietOption,
    panel_of,
    refusals,
)
from eigencontact.errors import PluginError
from eigencontact.hooks.guard import plugin_code, reason_of
from eigencontact.postprocess.command import plot
from eigencontact.postprocess.shakedown_command import shakedown
from eigencontact.skeleton import TEMPLATES

__all__ = ["main"]

COMMANDS = "eigencontact.commands"


class _Commands(HelpfulGroup):
    """Own commands and those of installed packages; a command is loaded when it runs or shows its help."""

    def list_commands(self, ctx: Any) -> list[str]:
        built_in = super().list_commands(ctx)
        names = [*built_in, *sorted({point.name for point in entry_points(group=COMMANDS)} - set(built_in))]
        order = [name for panel in PANELS.values() for name in panel]
        return sorted(names, key=lambda name: order.index(name) if name in order else len(order))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        command: Any = super().get_command(ctx, cmd_name)
        points = list(entry_points(group=COMMANDS, name=cmd_name)) if command is None else []
        command = _loaded(points[0]) if points else command
        if command is not None:
            command.rich_help_panel = panel_of(cmd_name)
        return command


def _loaded(point: EntryPoint) -> Any:
    """Command of another package; if its import fails, a command that reports the failure."""
    package = f"{point.dist.name} {point.dist.version}" if point.dist else point.value
    group = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode="markdown")
    try:
        with plugin_code(reason_of, passing=()):
            settings = {"help_option_names": ["-h", "--help"]}
            group.command(point.name, cls=HelpfulCommand, context_settings=settings)(point.load())
            return typer.main.get_command(group)
    except PluginError as problem:
        reason = f"cannot be loaded from {package}: {problem}"
        group = typer.Typer(add_completion=False)

        @group.command(point.name, help=reason, context_settings={"ignore_unknown_options": True})
        def _broken(words: Annotated[list[str] | None, typer.Argument(hidden=True)] = None) -> None:  # noqa: ARG001
            typer.echo(f"eigencontact: command '{point.name}' {reason}", err=True)
            raise typer.Exit(2)

        return typer.main.get_command(group)


app = typer.Typer(
    name="eigencontact",
    cls=_Commands,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Semi-analytical contact mechanics: exact half-space kernels, FFT convolution, constrained solvers.",
    epilog=(
        "Exit codes: 0 done, 1 failure, 2 refused input or plugin, 3 not converged, 4 window too small, "
        "5 results cannot be written or read, 6 a cluster cannot be used, 130 interrupted (continue with --resume)."
    ),
)

SceneArgument = Annotated[
    str,
    typer.Argument(
        help="A TOML file, or the name of a bundled scene (see `gallery`).",
        metavar="SCENE",
        autocompletion=completion.scenes,
    ),
]
ErrorsOption = Annotated[
    bool, typer.Option("--errors", help="Estimate the error of every number and field from coarser runs.")
]
AccuracyOption = Annotated[
    str | None,
    typer.Option(
        "--accuracy",
        metavar="ERROR",
        help="Error that the main results may have, `1%`; for single numbers see `schema accuracy`.",
    ),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a value: `--set body1.poisson-ratio=0.4`; repeatable."),
]


@app.callback(invoke_without_command=True)
def _root(*, version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False) -> None:
    if version:
        from eigencontact import __version__

        typer.echo(__version__)
        raise typer.Exit


@app.command(cls=HelpfulCommand)
def run(
    scene: SceneArgument,
    *,
    changes: SetOption = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder for results; by default ./SCENE.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue an interrupted run of the same scene.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace results of another run there.")] = False,
    errors: ErrorsOption = False,
    accuracy: AccuracyOption = None,
    quiet: QuietOption = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Print a line for each load step: iterations, residuals, times.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Solve a scene and write results, summary and pictures to a folder.

    Example: `eigencontact run hertz -o hertz --set steps.normal-load="1 N"`
    """
    from eigencontact import app as calls
    from eigencontact.progress import progress
    from eigencontact.viz.painter import painter_of

    current_folder = Path.cwd()  # before a plugin can change it
    with refusals(interrupted="accepted steps are kept, continue with --resume"):
        loaded = calls.load_scene(scene, changes or [])
        with painter_of(loaded.numerics.threads, pictures=loaded.output.pictures) as painter:
            planned = calls.plan(loaded)
            folder = current_folder / (planned.name if output is None else output)
            with progress(
                enabled=verbose or not (quiet or as_json), verbose=verbose, unit=planned.grid.unit
            ) as watcher:
                result = calls.run(
                    planned, folder, resume=resume, overwrite=overwrite, errors=errors, accuracy=accuracy,
                    watcher=watcher, painter=painter,
                )  # fmt: skip
    for problem in result.problems:
        typer.echo(f"eigencontact: {problem}", err=True)
    if as_json:
        typer.echo(json.dumps(result.summary, indent=2))
    elif not quiet:
        from eigencontact.postprocess.run_text import print_run

        print_run(planned.name, result)


@app.command(cls=HelpfulCommand)
def explain(
    scene: SceneArgument,
    *,
    changes: SetOption = None,
    errors: ErrorsOption = False,
    accuracy: AccuracyOption = None,
    as_json: JsonOption = False,
) -> None:
    """Describe a scene before the run: model, kernels, memory, time, and omitted effects with reasons.

    Example: `eigencontact explain hertz --accuracy 1%` foretells the runs that lead to an error of 1 %.
    """
    from eigencontact import app as calls

    with refusals():
        loaded = calls.load_scene(scene, changes or [])
        if not as_json:
            typer.echo(calls.explain(loaded, accuracy=accuracy, errors=errors))
            return
        planned = calls.plan(loaded)
        typer.echo(json.dumps({**planned.to_dict(), **calls.foretold(planned, accuracy, errors=errors)}, indent=2))


@app.command(cls=HelpfulCommand)
def plugins(
    key: Annotated[
        str | None,
        typer.Argument(
            help="Show parameters and sources of one plugin or file.", autocompletion=completion.plugin_keys
        ),
    ] = None,
    *,
    as_json: JsonOption = False,
) -> None:
    """List installed plugins by kind, with their packages, and plugins that failed to load.

    Example: `eigencontact plugins torus.py` tests your plugin file.
    """
    from eigencontact.listing import file_data, plugin_data, plugin_text
    from eigencontact.scene.installed import installed_plugins

    with refusals():
        of_file = key is not None and key.endswith(".py")
        data = file_data(installed_plugins(), Path(str(key))) if of_file else plugin_data(installed_plugins(), key)
        typer.echo(json.dumps(data, indent=2) if as_json else plugin_text(data, detailed=key is not None))


@app.command(cls=HelpfulCommand)
def schema(
    table: Annotated[
        str | None,
        typer.Argument(help="Show one table: `numerics`, `steps.impacts`.", autocompletion=completion.tables),
    ] = None,
    *,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print JSON; for the whole scene a JSON Schema for editors.")
    ] = False,
    plugin: Annotated[
        list[Path] | None, typer.Option("--plugin", metavar="FILE", help="A plugin file of your own; repeatable.")
    ] = None,
) -> None:
    """List all keys of a scene with meaning, unit, choices and default.

    Example: `eigencontact schema --json > scene.schema.json`, and in the first line of a scene
    `#:schema ./scene.schema.json`, so that an editor completes keys.
    """
    from eigencontact.hooks.files import with_files
    from eigencontact.reference.command import schema_text
    from eigencontact.scene.installed import installed_plugins

    with refusals():
        typer.echo(schema_text(with_files(installed_plugins(), plugin or []), table, as_json=as_json))


gallery = typer.Typer(
    help="List the bundled scenes, or print one of them.", invoke_without_command=True, cls=HelpfulGroup
)
app.add_typer(gallery, name="gallery")


@gallery.callback()
def _gallery(context: typer.Context, *, as_json: JsonOption = False) -> None:
    if context.invoked_subcommand is not None:
        return
    from eigencontact.listing import gallery_data

    data = gallery_data()
    if as_json:
        typer.echo(json.dumps(data, indent=2))
        return
    width = max(len(name) for name in data)
    for name, title in data.items():
        typer.echo(f"{name:<{width}}  {title}")
    typer.echo("\n`eigencontact run NAME` solves one; `eigencontact gallery show NAME > my.toml` copies one.")


@gallery.command("show", cls=HelpfulCommand)
def _show(
    name: Annotated[str, typer.Argument(help="Name of a bundled scene.", autocompletion=completion.bundled)],
) -> None:
    """Print the TOML text of a bundled scene."""
    from eigencontact.scene.loader import bundled_text

    with refusals():
        typer.echo(bundled_text(name), nl=False)


@gallery.command("run", hidden=True, context_settings={"ignore_unknown_options": True})
def _run_of_gallery(words: Annotated[list[str] | None, typer.Argument(hidden=True)] = None) -> None:
    """Name the command that solves a bundled scene."""
    command = " ".join(["eigencontact run", *(words or ["NAME"])])
    typer.echo(f"eigencontact: gallery must list or show scenes (got run); `{command}` solves one", err=True)
    raise typer.Exit(2)


app.command(cls=HelpfulCommand)(plot)
app.command(cls=HelpfulCommand)(shakedown)


@app.command("cache", cls=HelpfulCommand)
def _cache(
    *,
    clear: Annotated[bool, typer.Option("--clear", help="Remove all tables.")] = False,
    limit: Annotated[
        str | None, typer.Option("--limit", metavar="SIZE", help='Limit the size from now on: `--limit "2 GB"`.')
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Show, clear or limit the stored tables of influence coefficients. Runs compute missing tables again.

    The variable EIGENCONTACT_CACHE selects another folder, or switches the tables off (`EIGENCONTACT_CACHE=off`).
    """
    from eigencontact.listing import cache_data, cache_text

    with refusals():
        data = cache_data(clear=clear, limit=limit)
    typer.echo(json.dumps(data, indent=2) if as_json else cache_text(data))


@app.command("new-plugin", cls=HelpfulCommand)
def new_plugin(
    name: Annotated[str, typer.Argument(help="Name of the plugin in scenes: lower case, hyphens.", metavar="NAME")],
    *,
    kind: Annotated[
        str,
        typer.Option(
            "--kind",
            metavar="KIND",
            help=f"One of {', '.join(TEMPLATES)}.",
            autocompletion=completion.kinds,
        ),
    ] = "inclusion-shape",
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Folder of the package; by default ./eigencontact-NAME."),
    ] = None,
    file: Annotated[
        bool, typer.Option("--file", help="Write only NAME.py, for the key `plugins` of scenes; -o names another file.")
    ] = False,
) -> None:
    """Write a new plugin as a package or as one file. It registers and passes its tests without changes.

    Example: `eigencontact new-plugin hollow-ball --file`, then `eigencontact check hollow_ball.py`
    """
    from eigencontact.skeleton import write_file, write_package

    with refusals():
        if file:
            path = write_file(name, kind=kind, path=output)
            typer.echo(f'{path}: one {kind}; run `eigencontact check {path}`, name it in a scene: plugins = ["{path}"]')
            return
        typer.echo(write_package(name, kind=kind, folder=output).next_steps())


def main() -> None:
    """Run the command line; the console script's entry point."""
    gc.set_threshold(20_000)  # importing makes many objects, all of which stay: looking through them takes 50 ms
    app(prog_name="eigencontact", args=sys.argv[1:])


if __name__ == "__main__":
    main()
