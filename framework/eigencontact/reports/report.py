"""Report of a run or a sweep: one self-contained HTML page from stored results, without another solution."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from eigencontact.errors import SceneError, shown
from eigencontact.reports.source import opened
from eigencontact.results.ownership import REPORT, RESULTS

if TYPE_CHECKING:
    from eigencontact.reports.source import Source

__all__ = ["report"]

#: Parts of the page about a run: the anchor of each, and its name.
SECTIONS = {
    "top": "Summary",
    "pictures": "Pictures",
    "surface": "Surface in space",
    "numbers": "Numbers",
    "certificates": "Certificates",
    "scene": "Scene",
    "model": "What was modelled",
    "left-out": "What was left out",
    "times": "Times",
    "provenance": "Provenance",
    "references": "References",
}
#: Evenly spread rows of the table of steps at most; the last step and those where a number is largest come on top.
_ROWS = 200


def report(results: str | Path, file: str | Path | None = None) -> Path:
    """Write one HTML page about a run or a sweep, which needs no network and no other file.

    The page contains the scene, the model and its omitted effects, certificates and warnings, the numbers of all steps,
    the pictures, surface fields as rotatable height maps, times, versions, and the sources to cite. For an unfinished
    run it states this and shows the stored steps. For a sweep it contains the varied parameters, figures, the numbers
    of every variant, and the reasons of failures.

    Parameters
    ----------
    results : str or Path
        The folder of a run, or its ``results.nc``; or the folder of a sweep.
    file : str or Path, optional
        Path of the page; by default ``report.html`` in the folder of the results. It replaces an earlier report
        atomically, and never a file of another origin.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    SceneError
        When `file` cannot be the name of the page.
    ResultsError
        When there are no results, they are damaged, or the page cannot be stored.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import eigencontact as ec
    >>> quick = ["stress=[]", "grid.cells-per-contact-radius=8", "output.vtk=false", "output.pictures=false"]
    >>> with TemporaryDirectory() as folder:
    ...     _ = ec.run(ec.load_scene("hertz", quick), folder)
    ...     page = report(folder)
    ...     page.name, page.read_text(encoding="utf-8")[:15]
    ('report.html', '<!DOCTYPE html>')
    """
    from eigencontact.reports.page import page
    from eigencontact.reports.sweep import content_of, open_sweep
    from eigencontact.results.atomic import replacing
    from eigencontact.results.ownership import refuse_foreign_file

    swept = open_sweep(results)
    if swept is not None:
        target = _target(swept.folder / REPORT, file)
        refuse_foreign_file(target)
        text = page("sweep.html", swept.scene_text, content_of(swept))
    else:
        with opened(results) as source:
            name = REPORT if source.file.name == RESULTS else f"{source.file.stem}.html"
            target = _target(source.file.with_name(name), file)
            refuse_foreign_file(target)
            text = page("report.html", source.scene_text, _content(source))
    with replacing(target, "the report") as sink:
        sink.write(text.encode())
    return target


def _target(beside: Path, file: str | Path | None) -> Path:
    if file is None:
        return beside
    try:
        target = Path(file)
        allowed = target.suffix == ".html" and target.parent.is_dir()
    except (OSError, TypeError, ValueError):
        allowed = False
    if not allowed:
        got = shown(str(file))
        raise SceneError(f"the report must be a file .html in a folder that exists (got {got}); choose it with -o")
    return target


def _content(source: Source) -> dict[str, Any]:
    """Content of the template."""
    from eigencontact.core.numbers import ErrorBar
    from eigencontact.reports.charts import chart, in_words
    from eigencontact.reports.citations import as_bibtex, citations
    from eigencontact.reports.columns import answer, cards, columns, telling
    from eigencontact.reports.pictures import animation_of, pictures_of
    from eigencontact.reports.surfaces import surfaces

    run_columns = columns(source.dataset)
    numbers = telling(run_columns)
    pictures, anew = pictures_of(source)
    cited = citations(source.references)
    last = len(source.steps) - 1
    # Positions of steps that the table keeps on paper, and of all that it shows.
    printed = {0, last, *(column.at_largest for column in numbers if column.varies)}
    rows = sorted({*range(0, last, -(-(last + 1) // _ROWS)), *printed})
    return {
        "title": source.title,
        "sections": SECTIONS,
        "made_by": source.dataset.attrs["eigencontact_version"],
        "source": source,
        "answer": answer(run_columns, source.steps),
        "cards": cards(numbers),
        "field_errors": _field_errors(source),
        "errors": {name: ErrorBar.of_dict(table) for name, table in source.summary.get("errors", {}).items()},
        "rows": rows,
        "printed": printed,
        "numbers": numbers,
        "certificates": [column for column in run_columns if column.number.role in ("certificate", "error")],
        "effort": [column for column in run_columns if column.number.role == "effort"],
        "charts": [
            (column, chart(column, source.steps), in_words(column, source.steps)) for column in numbers if column.varies
        ],
        "pictures": pictures,
        "drawn_anew": anew,
        "animation": animation_of(source),
        "surfaces": surfaces(source.dataset),
        "citations": cited,
        "bibtex": as_bibtex(cited),
    }


def _field_errors(source: Source) -> list[tuple[str, str, str]]:
    """Name, error and main source of each field with estimated errors."""
    from eigencontact.core.field_error import FieldError

    tables = source.summary.get("field_errors", {})
    errors = {name: FieldError.of_dict(table) for name, table in tables.items() if name in source.dataset}
    return [(name, error.words(), error.source) for name, error in errors.items() if error.words()]
