"""Postprocessing of stored results: open, draw, evaluate another region; nothing is solved again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from eigencontact.errors import SceneError, shown
from eigencontact.results.reader import open_results, results_file
from eigencontact.scene.installed import installed_plugins

if TYPE_CHECKING:
    import xarray

    from eigencontact.results.stored import Results

__all__ = ["draw", "open_results", "region"]


def draw(
    results: str | Path,
    folder: str | Path | None = None,
    *,
    vtk: bool = False,
    table: Mapping[str, Any] | str | None = None,
    step: int | None = None,
    animation: Literal[False, True, "gif", "mp4"] = False,
    kind: str = "png",
    dpi: int | None = None,
    style: str = "screen",
) -> dict[Path, str]:
    """Draw pictures, and optionally an animation and VTK files, of stored results; returns files and descriptions.

    Parameters
    ----------
    results, folder : str or Path
        A folder of results or its ``results.nc``; where the files go, by default beside them. Files of others there are
        never replaced (`eigencontact.results.ownership`).
    table : mapping or str, optional
        Another region: its fields are found, stored and drawn, and nothing else; see `region`.
    step : int, optional
        Number of the load step to draw, from 1.
    animation : bool or str
        Whether to draw the history as an animation, a GIF; ``"mp4"`` takes the program ffmpeg.
    kind, dpi, style : str, int, str
        Format, dots per inch and style of the pictures; see `eigencontact.postprocess.plot`.
    """
    from eigencontact.results.atomic import of_this_version, writable_folder
    from eigencontact.results.ownership import refuse_foreign
    from eigencontact.results.stored import open_stored
    from eigencontact.viz.figures import draw_all
    from eigencontact.viz.looks import figure_look, look_of

    look = look_of(style)
    source = results_file(results)
    target = Path(folder) if folder is not None else source.parent
    stored: dict[Path, str] = {}
    with open_stored(results) if table is None else region(results, table, step=step, folder=target) as dataset:
        names = list(json.loads(dataset.attrs["regions"]))
        if table is not None:
            stored[target / _region_file(names[0])] = "the fields of the region, with coordinates, units and provenance"
        refuse_foreign(target, names, summary=False, pictures=kind, vtk=vtk, animation=bool(animation))
        writable_folder(target)
        chosen = None if step is None or table is not None else place_of(dataset, step)
        with of_this_version(source):
            captions = {}
            if animation:  # refused before anything is drawn
                from eigencontact.viz.animation import animate

                captions = animate(dataset, target, animation)
            with figure_look(look):
                captions |= draw_all(dataset, target, chosen, solid=vtk, kind=kind, dpi=dpi)
            files = {target / name: text for name, text in captions.items()}
            if vtk:
                from eigencontact.viz.vtk import write_vtk

                files |= dict.fromkeys(write_vtk(dataset, target), "fields for ParaView")
    return stored | files


def _region_file(name: str) -> str:
    return f"region-{name}.nc"


def place_of(dataset: Results, step: int) -> int:
    """Position of a stored step."""
    steps = [int(number) for number in dataset["step"].values]
    if step not in steps:
        raise SceneError(f"step must be one that is stored, {steps[0]} to {steps[-1]} (got {step})")
    return steps.index(step)


def region(
    results: str | Path,
    table: Mapping[str, Any] | str,
    *,
    step: int | None = None,
    folder: str | Path | None = None,
) -> xarray.Dataset:
    """Stress, strain or displacement in another region of a finished run, without a new solution.

    Parameters
    ----------
    results : str or Path
        A folder of results or its ``results.nc``.
    table : mapping or str
        Table like ``[[stress]]`` of a scene, or its text: ``'shape = "plane", depth-max = "2 mm"'``.
    step : int, optional
        Number of the load step, from 1; the last by default. With inhomogeneities or laws, an earlier step needs a run
        with ``output.history = "all"``.
    folder : str or Path, optional
        Folder for ``region-<name>.nc``, a results file with this region; by default nothing is stored.

    Returns
    -------
    xarray.Dataset
        Dataset like that of results, with only this region.

    Raises
    ------
    SceneError, ResultsError
        An invalid region; a step that is not stored, or whose internal variables are not stored.

    Examples
    --------
    >>> import tempfile, eigencontact as ec
    >>> small = ["stress=[]", "grid.cells-per-contact-radius=8", "output.pictures=false", "output.vtk=false"]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     ec.run(ec.load_scene("hertz", small), folder).dataset.close()
    ...     with ec.region(folder, 'name = "deep", shape = "line", start = [0, 0, 0], end = [0, 0, "9 um"]') as data:
    ...         print(f"{float(data.deep_von_mises.max()) / 1e9:.1f} GPa")
    5.2 GPa
    """
    from eigencontact.postprocess.revisit import region_table, revisit
    from eigencontact.results.atomic import writable_folder
    from eigencontact.results.join import dataset_of, join_steps
    from eigencontact.results.ownership import refuse_foreign_file
    from eigencontact.results.stepfile import step_part

    if not isinstance(table, str | Mapping):
        raise SceneError(f"region must be a table like those of [[stress]], or its text (got {shown(table)})")
    request = region_table(table) if isinstance(table, str) else table
    info, record = revisit(results_file(results), request, installed_plugins(), step)
    step_data = step_part(info, record, copied=False)
    if folder is None:
        return dataset_of([step_data])
    target = Path(folder) / _region_file(next(iter(record.regions)))
    refuse_foreign_file(target)
    writable_folder(target.parent)
    join_steps(target, [step_data])
    return open_results(target)
