"""The command `eigencontact plot`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from eigencontact.command_help import JsonOption, QuietOption, refusals
from eigencontact.postprocess.options import ResultsArgument

__all__ = ["plot"]


def plot(
    results: ResultsArgument,
    *,
    field: Annotated[
        str | None, typer.Option("--field", metavar="NAME", help="Draw one picture of a field: `stress`, `pressure`.")
    ] = None,
    component: Annotated[
        str | None, typer.Option("--component", metavar="NAME", help="Component of a vector or tensor: `x`, `xz`, `1`.")
    ] = None,
    region: Annotated[
        str | None,
        typer.Option("--region", metavar="NAME", help="Name of a region of the run, or the table of a new region."),
    ] = None,
    step: Annotated[int | None, typer.Option("--step", metavar="N", help="Load step to draw, from 1.")] = None,
    zoom: Annotated[
        str | None, typer.Option("--zoom", metavar="RANGES", help="Visible range: `-6 um:6 um, 0:8 um`.")
    ] = None,
    cmap: Annotated[str | None, typer.Option("--cmap", metavar="NAME", help="Colour map of matplotlib.")] = None,
    style: Annotated[
        str, typer.Option("--style", metavar="NAME", help="`screen`, `paper` (8.4 cm or 17 cm wide) or `talk`.")
    ] = "screen",
    kind: Annotated[
        str | None, typer.Option("--format", metavar="NAME", help="`png`, `pdf` or `svg`; by default PNG.")
    ] = None,
    dpi: Annotated[int | None, typer.Option("--dpi", metavar="N", help="Dots per inch of PNG pictures.")] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Folder, or file of one picture; by default the results'."),
    ] = None,
    vtk: Annotated[bool, typer.Option(help="Also write VTK files for ParaView, if all pictures are drawn.")] = True,
    animation: Annotated[
        bool, typer.Option("--animation", help="Also draw the history as an animation (GIF).")
    ] = False,
    mp4: Annotated[bool, typer.Option("--mp4", help="Write the animation as MP4; needs the program ffmpeg.")] = False,
    quiet: QuietOption = False,
    as_json: JsonOption = False,
) -> None:
    """Draw pictures and write VTK files from stored results; with `--field`, or the name of a region, one picture.

    One picture, for a column of a paper:
    `eigencontact plot hertz --field stress --component xz --region section --style paper -o shear.pdf`

    With a table as `--region` the stress, strain or displacement in a region that the run did not have, without solving
    again: `eigencontact plot hertz --region 'name = "below", shape = "plane", normal = "z", position = "50 um"'`
    """
    with refusals():
        single = field is not None or (region is not None and "=" not in region)
        options = {"component": component, "zoom": zoom, "cmap": cmap}
        if single:
            from eigencontact.postprocess.plot import draw_chosen

            _refuse({"--animation": animation or mp4}, "all pictures, without --field and without the name of a region")
            files = draw_chosen(
                results, output, field=field, region=region, step=step, kind=kind, dpi=dpi, style=style, **options
            )
        else:
            from eigencontact.postprocess import stored_run
            from eigencontact.postprocess.plot import dpi_of, format_of

            _refuse({f"--{name}": value for name, value in options.items()}, "--field, or the name of a region")
            files = stored_run.draw(
                results,
                output,
                vtk=vtk,
                table=region,
                step=step,
                animation="mp4" if mp4 else animation,
                kind=format_of(kind),
                dpi=dpi_of(dpi),
                style=style,
            )
    if as_json:
        typer.echo(json.dumps({str(path): text for path, text in files.items()}, indent=2))
    elif not quiet:
        for path, text in files.items():
            typer.echo(f"{path}  {text}")


def _refuse(options: dict[str, object], rule: str) -> None:
    """Refuse options that lack a required option."""
    from eigencontact.errors import SceneError

    for name, value in options.items():
        if value:
            raise SceneError(f"{name} must be given with {rule} (got it alone)")
