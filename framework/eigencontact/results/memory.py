"""The results of a run that leaves nothing on the disk."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.results.history import HISTORY_STEP
from eigencontact.results.join import dataset_of, join_steps
from eigencontact.results.part import StoredPart, part_of
from eigencontact.results.stepfile import history_part, step_part
from eigencontact.results.stored import StoredArray

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    import xarray as xr
    from numpy.typing import NDArray

    from eigencontact.results.layout import Variable
    from eigencontact.results.records import RunInfo, StepRecord

__all__ = ["MemoryResults", "MemoryStore"]


#: First dimension of variables that change from step to step.
_STEPPED = (("step",), (HISTORY_STEP,))


@dataclass(slots=True)
class MemoryStore:
    """Steps of one run in memory, with the content of `eigencontact.results.store.ResultStore`; `info` is common."""

    info: RunInfo
    _steps: list[StoredPart] = field(default_factory=list)
    _histories: list[StoredPart] = field(default_factory=list)
    _rows: list[dict[str, Any]] = field(default_factory=list)

    def write_step(self, record: StepRecord) -> None:
        """Store a copy of an accepted step.

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
        """Scalars of every step in order; NaN where an earlier step lacks one."""
        missing_values = dict.fromkeys((name for row in self._rows for name in row), float("nan"))
        return [*(missing_values | row for row in self._rows[:-1]), last.row()]

    def join(self, path: Path) -> None:
        """Write the stored steps to a results file."""
        join_steps(path, self._steps, self._histories)

    def dataset(self) -> xr.Dataset:
        """Dataset like that of `eigencontact.results.reader.open_results`; the call releases the stored steps."""
        return dataset_of(self._steps, self._histories)

    def results(self) -> MemoryResults:
        """Variables of the stored steps, until the dataset is requested."""
        return MemoryResults(self._steps, self._histories)

    @contextmanager
    def opened(self) -> Iterator[MemoryResults]:
        """Variables of the stored steps in a ``with`` block, like those of a folder."""
        yield self.results()

    def append(self, variables: Iterable[Variable]) -> None:
        """Add variables over all steps, or of the whole run."""
        for variable in variables:
            if variable.dims[:1] not in _STEPPED:
                self._steps[-1].update(part_of({}, [variable]))
                continue
            parts = self._histories if variable.dims[0] == HISTORY_STEP else self._steps
            for at, step in enumerate(parts):
                step.update(part_of({}, [replace(variable, values=variable.values[at : at + 1])]))


class MemoryResults:
    """Variables of steps in memory, like those of `eigencontact.results.stored.open_stored` for a file."""

    def __init__(self, steps: list[StoredPart], histories: list[StoredPart]) -> None:
        history_variables = {name: _MemoryVariable(histories, name) for history in histories[-1:] for name in history}
        self.variables = history_variables | {name: _MemoryVariable(steps, name) for name in steps[-1]}
        self.attrs = dict(steps[-1].attrs)

    def __contains__(self, name: object) -> bool:
        return name in self.variables

    def __iter__(self) -> Iterator[str]:
        return iter(self.data_vars)

    def __getitem__(self, name: str) -> _MemoryVariable:
        return self.variables[name]

    @cached_property
    def sizes(self) -> dict[str, int]:
        """Length of every dimension."""
        return {dim: size for item in self.variables.values() for dim, size in zip(item.dims, item.shape, strict=True)}

    @property
    def data_vars(self) -> dict[str, _MemoryVariable]:
        """Variables that are not coordinates."""
        return {name: item for name, item in self.variables.items() if item.attrs.get("role") != "coordinate"}


class _MemoryVariable:
    """Variable of steps in memory; an index reads one step."""

    def __init__(self, steps: list[StoredPart], name: str) -> None:
        self._steps, self._name = steps, name
        self.attrs = steps[-1][name].attrs
        self.dims = tuple(self.attrs["dims"].split())

    @property
    def shape(self) -> tuple[int, ...]:
        """Length of each dimension."""
        inner = self._steps[-1][self._name].shape
        return (len(self._steps), *inner[1:]) if self.dims[:1] in _STEPPED else inner

    @property
    def ndim(self) -> int:
        """Number of dimensions."""
        return len(self.dims)

    def __float__(self) -> float:
        return float(self.values)

    def __getitem__(self, at: int) -> StoredArray:
        if self.dims[:1] not in _STEPPED:
            return StoredArray(np.asarray(self.values[at]))
        step = self._steps[at]
        return StoredArray(np.asarray(step[self._name][0]) if self._name in step else np.full(self.shape[1:], np.nan))

    @property
    def values(self) -> NDArray[Any]:
        """All values."""
        if self.dims[:1] not in _STEPPED:
            return np.asarray(self._steps[-1][self._name][...])
        return np.stack([self[at].values for at in range(len(self._steps))])
