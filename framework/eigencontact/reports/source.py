"""Source of a report: stored results of a finished or unfinished run, with summary and plan."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from eigencontact.results.atomic import DAMAGE, of_this_version, read_json
from eigencontact.results.join import join_unfinished, stored_files
from eigencontact.results.ownership import RESULTS, SUMMARY
from eigencontact.results.reader import results_file
from eigencontact.results.stored import open_stored

if TYPE_CHECKING:
    from eigencontact.results.stored import Results

__all__ = ["Source", "opened"]


@dataclass(frozen=True, kw_only=True)
class Source:
    """Open results of a run: path of the results file, stored steps, and whether the run is finished.

    `summary` holds the contents of ``summary.json``; it is empty where there is none of this run.
    """

    file: Path
    dataset: Results
    finished: bool
    summary: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def steps(self) -> list[int]:
        """Numbers of the stored steps."""
        return [int(number) for number in self.dataset["step"].values]

    @property
    def expected(self) -> int:
        """Planned number of steps of the whole history."""
        return int(self.dataset.attrs["load_steps"])

    @property
    def title(self) -> str:
        """Title of the scene, or its name."""
        return str(self.dataset.attrs.get("title") or self.dataset.attrs["name"])

    @property
    def scene_text(self) -> str:
        """Scene as TOML, with all defaults."""
        return str(self.dataset.attrs["scene"])

    @cached_property
    def scene(self) -> dict[str, Any]:
        """Tables of the scene."""
        return tomllib.loads(self.scene_text)

    @cached_property
    def plan(self) -> dict[str, Any]:
        """Plan as text, by paragraph; empty in results of versions that did not store it."""
        return dict(json.loads(self.dataset.attrs.get("plan", "{}")))

    @property
    def versions(self) -> dict[str, str]:
        """Versions of packages and plugins."""
        return dict(json.loads(self.dataset.attrs["versions"]))

    @property
    def references(self) -> list[str]:
        """Sources to cite for the run."""
        return [line for line in str(self.dataset.attrs["references"]).splitlines() if line.strip()]


@contextmanager
def opened(results: str | Path) -> Iterator[Source]:
    """Open the results of a run, a folder or its ``results.nc``; of an unfinished run its stored steps.

    `ResultsError` when there is nothing, or a file that is damaged or not ours.
    """
    from jinja2 import TemplateError

    folder = _folder(results)
    if folder is not None and stored_files(folder):
        with TemporaryDirectory(prefix="eigencontact-report-") as copy_folder:
            joined = Path(copy_folder) / RESULTS
            join_unfinished(folder, joined)
            with open_stored(joined) as dataset:
                yield Source(file=folder / RESULTS, dataset=dataset, finished=False)
        return
    file = results_file(results)
    with open_stored(file) as dataset:
        summary = read_json(file.parent / SUMMARY)
        if summary.get("scene_hash") != str(dataset.attrs.get("scene_hash")):  # of another scene
            summary = {}
        with of_this_version(file, (*DAMAGE, TemplateError)):  # the template finds no name that it shows
            yield Source(file=file, dataset=dataset, finished=True, summary=summary)


def _folder(results: str | Path) -> Path | None:
    """Folder of a path."""
    try:
        path = Path(results)
        return path if path.is_dir() else path.parent if path.name == RESULTS else None
    except (OSError, TypeError, ValueError):  # `results_file` says what is wrong with it
        return None
