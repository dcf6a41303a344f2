"""The command `eigencontact tradeoff`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from eigencontact_verification.commands.options import AsJson, Errors, Quiet, leave

if TYPE_CHECKING:
    from eigencontact_verification.tradeoff.study import Study

__all__ = ["tradeoff"]


def tradeoff(
    scene: Annotated[
        str, typer.Argument(help="A TOML file, or the name of a bundled scene (see `gallery`).", metavar="SCENE")
    ],
    *,
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Change a value of the scene; repeatable."),
    ] = None,
    only: Annotated[
        list[str] | None, typer.Option("--only", metavar="KEY", help="Vary only this: `--only grid`; repeatable.")
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Half the cells in each direction; the reference has those of the scene.")
    ] = False,
    reference: Annotated[
        float | None,
        typer.Option("--reference", metavar="FACTOR", min=0.1, help="Factor on the cells for the reference (2)."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder; by default ./SCENE-tradeoff.")
    ] = None,
    time: Annotated[
        float, typer.Option("--time", metavar="S", min=1.0, help="Longest time of a variant; slower ones are left out.")
    ] = 600.0,
    memory: Annotated[
        float, typer.Option("--memory", metavar="GB", min=0.1, help="A variant predicted to need more is left out.")
    ] = 4.0,
    repeat: Annotated[
        int, typer.Option("--repeat", metavar="N", min=1, help="Processes for each variant; the median time counts.")
    ] = 1,
    errors: Errors = False,
    plan: Annotated[bool, typer.Option("--plan", help="List the variants with predicted time and memory.")] = False,
    markdown: Annotated[bool, typer.Option("--markdown", help="Print Markdown instead of a table.")] = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Compare fidelities of one scene: error, time and memory, and the fronts that none beats.

    The scene decides the variants: grid, precision and tolerance of a contact, coupling with friction, treatment
    of the half-space, cells of inclusions and of what yields, error of plastic steps and of cycles that are left out,
    layers that are exact or cells, sums over many inclusions. Each is solved in a process of its own, one after the
    other, and compared with a reference that has the finest of everything. With --errors, scene and reference also
    estimate their own errors.

    Exit codes: 0 done (read what failed), 1 nothing to compare, 2 wrong input, 130 interrupted.

    Example: `eigencontact tradeoff hertz --quick --only grid`
    """
    from rich.console import Console

    from eigencontact import app
    from eigencontact.core.text_table import print_table
    from eigencontact.errors import EigencontactError, ResultsError
    from eigencontact_verification.reporting.files import open_folder
    from eigencontact_verification.tradeoff import report
    from eigencontact_verification.tradeoff.study import predict, study
    from eigencontact_verification.tradeoff.variant import Fidelities, variants

    console = Console(highlight=False)
    try:
        planned = app.plan(app.load_scene(scene, changes or []))
        _check(planned, only or [])
    except (EigencontactError, ValueError) as problem:
        leave(str(problem), getattr(problem, "exit_code", 2))
    fidelities = Fidelities(coarser=(0.25,), base=0.5, reference=1.0) if quick else Fidelities()
    if reference is not None:
        fidelities = Fidelities(coarser=fidelities.coarser, base=fidelities.base, reference=reference)
    resolved = planned.scene.resolved()
    predictions = predict(resolved, variants(planned, fidelities, only or []))
    if plan:
        if as_json:
            typer.echo(json.dumps(report.plan_data(predictions), indent=2))
        else:
            print_table(report.plan_table(predictions), console)
        return

    def tell(text: str) -> None:
        if not (quiet or as_json or markdown):
            typer.echo(text, err=True)

    folder = output or Path(f"{planned.name}-tradeoff")
    try:
        open_folder(folder, ("tradeoff.json", "tradeoff.md", "tradeoff.png"))
        result = study(
            planned.name, resolved, predictions, limit=time, memory=1e9 * memory, repeat=repeat, tell=tell,
            with_bars=errors or planned.scene.output.errors,
        )  # fmt: skip
        files = _write(result, folder)
    except (EigencontactError, ValueError, OSError) as problem:
        leave(str(problem), problem.exit_code if isinstance(problem, ResultsError) else 1)
    except KeyboardInterrupt:
        leave("interrupted; nothing is kept", 130)
    if as_json or markdown:
        typer.echo(files["json" if as_json else "markdown"].read_text(encoding="utf-8"), nl=False)
    elif not quiet:
        print_table(report.study_table(result, console.width), console)
        for line in report.remarks(result):
            typer.echo(line)
        typer.echo(f"\nin {folder.resolve()}: {', '.join(file.name for file in files.values())}")
    raise typer.Exit(0 if any(row.error is not None for row in result.rows) else 1)


def _check(planned: Any, only: list[str]) -> None:
    from eigencontact.errors import nearest
    from eigencontact_verification.tradeoff.variant import keys_of

    keys = keys_of(planned)
    for key in only:
        if key not in keys:
            raise ValueError(
                f"--only must be one of {', '.join(keys)} (got {key!r}){nearest(key, keys)}; "
                "the scene determines these settings"
            )


def _write(result: Study, folder: Path) -> dict[str, Path]:
    """Table, data and picture of a study."""
    from eigencontact_verification.reporting.files import write_report_files
    from eigencontact_verification.reporting.machine import facts
    from eigencontact_verification.tradeoff.figure import draw
    from eigencontact_verification.tradeoff.report import as_data, as_markdown

    files = write_report_files(folder, as_data(result, facts()), markdown=as_markdown(result), stem="tradeoff")
    files["picture"] = folder / "tradeoff.png"
    draw(result, files["picture"])
    return files
