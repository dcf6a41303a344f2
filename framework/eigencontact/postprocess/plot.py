"""One picture of results, as axes for further use or as a file."""

from __future__ import annotations

import json
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact.errors import SceneError, nearest, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from matplotlib.axes import Axes

    from eigencontact.results.stored import Results
    from eigencontact.viz.chosen import Picture

__all__ = ["FORMATS", "draw_chosen", "opened", "plot"]

#: Formats of pictures.
FORMATS = ("png", "pdf", "svg")
#: Dots per inch that a picture may have.
DOTS = (20, 2400)


def plot(
    results: Any,
    field: str | None = None,
    *,
    component: str | None = None,
    step: int | None = None,
    region: str | None = None,
    zoom: str | Sequence[Any] | None = None,
    cmap: str | None = None,
    style: str = "screen",
) -> Axes:
    """Draw one field of results.

    Parameters
    ----------
    results : str, Path, xarray.Dataset or RunResult
        A folder of results or its ``results.nc``, or the value returned by `open_results`, `region` or a run.
    field : str, optional
        Any field of the results: ``"pressure"``, ``"shear"``, ``"gap"``, ``"stress"``, ``"von-mises"``,
        ``"plastic-strain"``, …; the message about an unknown name lists all names. The name of a standard picture is
        also valid: ``"worn-profiles"``. By default the pressure, or the equivalent stress of a region.
    component : str, optional
        ``"xz"`` of a stress, or ``"1"`` for its largest principal value; ``"x"`` of a displacement or of a traction.
    step : int, optional
        Number of the load step, from 1; the last by default.
    region : str, optional
        Name of a region of the run, ``"surface"``, or ``"along-x"`` or ``"along-y"`` for a profile on the surface
        through the middle of the contact; by default the surface where the field lies there, else the first region that
        has it.
    zoom : str or pairs of numbers, optional
        Visible range along the horizontal and the vertical: ``"-6 um:6 um, 0:8 um"``, or pairs of numbers [m].
    cmap : str, optional
        Colour map of matplotlib; by default one for readers with colour blindness.
    style : str
        ``"screen"``, ``"paper"`` (8.4 cm or 17 cm wide, letters of 8 points, thin lines) or ``"talk"``.

    Returns
    -------
    matplotlib.axes.Axes
        Axes of a new figure of pyplot, which notebooks show; ``axes.figure`` is the figure with its colour bar, and
        ``axes.figure.savefig("name.pdf")`` stores it. Lengths and values have the units of the labels.

    Raises
    ------
    SceneError, ResultsError
        An unknown argument, with the nearest valid choice; results that are missing or damaged.

    Examples
    --------
    >>> from eigencontact import load_scene, run
    >>> changes = ["grid.cells-per-contact-radius=12", "stress.0.depth-cells=20"]
    >>> axes = plot(run(load_scene("hertz", changes)), "stress", component="xz", zoom="-9 um:9 um, 0:9 um")
    >>> axes.get_xlabel(), axes.get_ylabel()
    ('x [µm]', 'z [µm]')
    """
    from eigencontact.viz.looks import figure_look, finish, look_of, shown_figures

    look = look_of(style)
    options = {"component": component, "region": region, "zoom": zoom, "cmap": cmap}
    with opened(results) as dataset, figure_look(look), shown_figures():
        figure = _picture_of(dataset, field, step, options).figure
        finish(figure)
    axes: Axes = figure.axes[0]
    return axes


def draw_chosen(
    results: str | Path,
    output: Path | None = None,
    *,
    field: str | None = None,
    step: int | None = None,
    region: str | None = None,
    kind: str | None = None,
    dpi: int | None = None,
    style: str = "screen",
    **options: Any,
) -> dict[Path, str]:
    """Store one picture; returns its file and a description. Further arguments are those of `plot`.

    `output` is a file with an ending of `FORMATS`, or a folder, by default that of the results. `region` may also be
    the text of a table of a new region, which has a ``=``. `kind` is the format, by default that of the file, else PNG;
    `dpi` the dots per inch, by default those of the style.
    """
    from eigencontact.postprocess.stored_run import region as new_region
    from eigencontact.results.atomic import writable_folder
    from eigencontact.results.ownership import refuse_foreign_file
    from eigencontact.results.reader import results_file
    from eigencontact.viz.looks import figure_look, look_of
    from eigencontact.viz.style import save

    look, source = look_of(style), results_file(results)
    ending = output.suffix.lower().removeprefix(".") if output is not None else ""
    has_format = ending in FORMATS
    kind = format_of(kind, ending if has_format else None)
    dataset_or_path: Any = results
    if region is not None and "=" in region:
        dataset_or_path, region, step = new_region(results, region, step=step), None, None
        region = next(iter(json.loads(dataset_or_path.attrs["regions"])))
    with opened(dataset_or_path) as dataset, figure_look(look):
        picture = _picture_of(dataset, field, step, {"region": region, **options})
        number = int(dataset["step"][-1]) if step is None else step
        after = f"-step-{number}" if dataset.sizes["step"] > 1 and step is not None else ""
        folder = output or source.parent
        file = output if has_format and output is not None else folder / f"{picture.name}{after}.{kind}"
        refuse_foreign_file(file)
        writable_folder(file.parent)
        save(picture.figure, file, dpi_of(dpi))
    return {file: picture.sentence}


def format_of(kind: str | None, ending: str | None = None) -> str:
    """Format of pictures; the extension of a file must agree with it.

    Raises
    ------
    SceneError
        An unknown one, with the nearest.
    """
    formats = ", ".join(map(repr, FORMATS))
    if kind is not None and kind not in FORMATS:
        raise SceneError(f"format must be one of {formats} (got {shown(kind)}){nearest(str(kind), FORMATS)}")
    if kind and ending and kind != ending:
        raise SceneError(f"format must be that of the file, {ending!r} (got {kind!r}); leave it out")
    return kind or ending or FORMATS[0]


def dpi_of(dpi: int | None) -> int | None:
    """Dots per inch.

    Raises
    ------
    SceneError
        Fewer or more than a picture may have.
    """
    low, high = DOTS
    if dpi is not None and not low <= dpi <= high:
        raise SceneError(f"dpi must be within {low} and {high} (got {dpi})")
    return dpi


@contextmanager
def opened(results: Any) -> Iterator[Results]:
    """Results of a path, a dataset or a run."""
    from eigencontact.results.stored import open_stored

    if isinstance(results, str | Path):
        with open_stored(results) as dataset:
            yield dataset
        return
    dataset = getattr(results, "dataset", results)
    if not (hasattr(dataset, "data_vars") and "regions" in getattr(dataset, "attrs", {})):
        raise SceneError(
            f"results must be a folder, a dataset of this package, or what a run returned (got {shown(results)})"
        )
    yield dataset


def _picture_of(dataset: Results, field: str | None, step: int | None, options: dict[str, Any]) -> Picture:
    from eigencontact.postprocess.stored_run import place_of
    from eigencontact.viz.chosen import chosen_picture

    return chosen_picture(dataset, field, step=-1 if step is None else place_of(dataset, step), **options)
