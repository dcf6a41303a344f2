"""The results of a run that leaves nothing on the disk."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from eigencontact.results.join import dataset_of, join_steps
from eigencontact.results.stepfile import history_part, step_part

if TYPE_CHECKING:
    from pathlib import Path

    import xarray as xr

    from eigencontact.results.part import Part
    from eigencontact.results.records import RunInfo, StepRecord

__all__ = ["MemoryStore"]


@dataclass(slots=True)
class MemoryStore:
    """Steps of one run, as `eigencontact.results.store.ResultStore` would store them; `info` holds for all steps."""

    info: RunInfo
    _steps: list[Part] = field(default_factory=list)
    _histories: list[Part] = field(default_factory=list)
    _rows: list[dict[str, Any]] = field(default_factory=list)

    def write_step(self, record: StepRecord) -> None:
        """Keep a copy of an accepted step.

        Raises
        ------
        ResultsError
            When two results would bear one name, or a field does not fit its grid.
        """
        self._steps.append(step_part(self.info, record))
        if not self.info.every_history:
            self._histories.clear()
        if record.history:
            self._histories.append(history_part(self.info, record))
        self._rows.append(record.row())

    def history(self, last: StepRecord) -> list[dict[str, Any]]:
        """Scalars of every step in order; NaN where a step before the last has none of a name."""
        nothing = dict.fromkeys((name for row in self._rows for name in row), float("nan"))
        return [*(nothing | row for row in self._rows[:-1]), last.row()]

    def join(self, path: Path) -> None:
        """Write the stored steps to a results file."""
        join_steps(path, self._steps, self._histories)

    def dataset(self) -> xr.Dataset:
        """Dataset as `eigencontact.results.reader.open_results` returns it; the call releases the stored steps."""
        return dataset_of(self._steps, self._histories)
