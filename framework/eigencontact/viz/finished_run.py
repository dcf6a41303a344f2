"""Pictures, animation and VTK files of a run that has just ended."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from eigencontact.core.stopwatch import Stopwatch
from eigencontact.results.stored import open_stored

if TYPE_CHECKING:
    from eigencontact.viz.painter import Painter

__all__ = ["draw_run"]


def draw_run(
    results: Path,
    folder: Path,
    stopwatch: Stopwatch,
    painter: Painter | None,
    *,
    pictures: bool,
    vtk: bool,
    animation: Literal[False, True, "gif", "mp4"],
) -> dict[str, str]:
    """Draw pictures and an animation and write VTK files of a finished run; returns files and descriptions."""
    files: dict[str, str] = {}
    if painter is not None and pictures:
        painter.begin(results, folder, solid=vtk)
    with open_stored(results) as dataset:
        if vtk:
            with stopwatch.on("files for ParaView"):
                from eigencontact.viz.vtk import write_vtk

                files |= {path.name: "fields for ParaView" for path in write_vtk(dataset, folder)}
        if animation:
            with stopwatch.on("animation"):
                from eigencontact.viz.animation import animate, subject_of

                files = (animate(dataset, folder, animation) if subject_of(dataset) else {}) | files
        if pictures:
            with stopwatch.on("pictures"):
                drawn = None if painter is None else painter.finish()
                if drawn is None:
                    from eigencontact.viz.figures import draw_all

                    drawn = draw_all(dataset, folder, solid=vtk)
                files = drawn | files
    return files
