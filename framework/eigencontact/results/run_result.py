"""Result of a run: summary, dataset, files and times."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    import xarray

    from eigencontact.results.memory import MemoryStore
    from eigencontact.results.store import ResultStore
    from eigencontact.results.stored import Results

__all__ = ["RunResult"]


@dataclass(frozen=True, kw_only=True)
class RunResult:
    """Result of a run.

    Attributes
    ----------
    summary : dict
        The contents of ``summary.json``.
    dataset : xarray.Dataset
        Everything stored, with coordinates, units and provenance; opened, or put together, when first asked for.
    folder : Path or None
        Where it is stored; None for a run in memory.
    files : dict of str to str
        Name of each file written and what it shows.
    problems : tuple of str
        Stored steps that a resumed run found damaged and computed again.
    seconds : float
        Wall time of it all, that of a plan included [s]; ``seconds_by_block`` of the summary says what took it.
    """

    summary: dict[str, Any]
    folder: Path | None
    files: dict[str, str] = field(default_factory=dict)
    problems: tuple[str, ...] = ()
    seconds: float = 0.0
    _store: ResultStore | MemoryStore = field(repr=False)

    @cached_property
    def dataset(self) -> xarray.Dataset:  # noqa: D102 - an attribute to its users, described above
        return self._store.dataset()

    def stored(self) -> AbstractContextManager[Results]:
        """Stored variables in a ``with`` block; of a run in memory before its `dataset` is asked for."""
        return self._store.opened()

    def _repr_html_(self) -> str:
        from eigencontact.core.html_table import html_table
        from eigencontact.core.units import time_in_words
        from eigencontact.results.summary import headlines

        numbers = self.summary
        rows = [("steps", str(numbers["steps"])), *headlines(numbers)]
        rows += [("wall time", time_in_words(self.seconds)), ("folder", str(self.folder or "none: in memory"))]
        return html_table(numbers["title"] or numbers["name"], rows, _cautions(numbers["warnings"]))

    def course(self) -> str:
        """Loads, motions, stick, work of friction and wear through the steps, as a small table of text.

        Examples
        --------
        >>> import eigencontact as ec
        >>> few = ["stress=[]", "grid.cells-per-contact-radius=10", "steps.increments=2"]
        >>> print(ec.run(ec.load_scene("hertz", few)).course())
          step   load  approach  radius  pressure
                   mN        nm      um       GPa
             1  325.0     219.8   4.728     6.702
             2  650.0     348.8   6.015     8.452
        """
        from eigencontact.results.course import course_table

        return course_table(self.summary["history"], self.summary["units"])


def _cautions(warnings: Iterable[Mapping[str, Any]]) -> str:
    """Warnings of a run in one text."""
    return "; ".join(str(warning["words"]) for warning in warnings)
