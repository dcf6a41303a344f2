"""Files of a report: each one names this package, and replaces no file of another origin."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from eigencontact import __version__
from eigencontact.results.atomic import replacing, writable_folder
from eigencontact.results.ownership import refuse_foreign_file

__all__ = ["GENERATOR", "open_folder", "report_names", "write_json", "write_report_files", "write_text"]

#: Name and version that every file of a report carries.
GENERATOR = f"eigencontact {__version__}"
_AGAIN = "the same command reuses what is finished"


def report_names(stem: str = "report") -> dict[str, str]:
    """Names of the files of a report by format."""
    return {"json": f"{stem}.json", "markdown": f"{stem}.md", "html": f"{stem}.html"}


def open_folder(folder: Path, names: Iterable[str]) -> None:
    """Make a folder for a report; refuse one in which a file of another origin has a name that the report needs.

    Raises
    ------
    ResultsError
        A foreign file, or a folder that cannot be made or written.
    """
    for name in names:
        refuse_foreign_file(folder / name)
    writable_folder(folder)


def write_text(path: Path, text: str) -> None:
    """Write a text file, complete or not at all."""
    with replacing(path, path.name, lasting=False, consequence=_AGAIN) as sink:
        sink.write(text.encode())


def write_json(path: Path, data: Mapping[str, Any], *, default: Callable[[Any], Any] | None = None) -> None:
    """Write data as JSON, with the generator as its first key."""
    content = {"generator": GENERATOR, **data}
    write_text(path, json.dumps(content, indent=2, ensure_ascii=False, default=default) + "\n")


def write_report_files(
    folder: Path, data: Mapping[str, Any], *, markdown: str, html: str = "", stem: str = "report",
    default: Callable[[Any], Any] | None = None,
) -> dict[str, Path]:  # fmt: skip
    """Write a report as JSON, Markdown and, if there is one, as an HTML page; return the files by format.

    Parameters
    ----------
    folder : Path
        Made where missing.
    data : mapping
        Content of the JSON file.
    markdown, html : str
        Texts of the other two files.
    stem : str
        Name of the files without the ending.
    default : callable, optional
        Converts values that JSON does not know.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = {form: folder / name for form, name in report_names(stem).items() if form != "html" or html}
    write_json(files["json"], data, default=default)
    write_text(files["markdown"], f"{markdown.rstrip()}\n\n<!-- generator: {GENERATOR} -->\n")
    if html:
        write_text(files["html"], html)
    return files
