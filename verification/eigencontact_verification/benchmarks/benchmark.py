"""What a benchmark is, the loop that measures a code in its process, and the row that the processes make.

A benchmark says what is set up, what is called, what the answer is worth, and the columns of its table; the loop and
the medians stand here.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from statistics import median
from typing import TYPE_CHECKING, Any

from eigencontact_verification.benchmarks.clock import timed
from eigencontact_verification.reporting.memory import PeakMemory
from eigencontact_verification.reporting.table import Column, Row

if TYPE_CHECKING:
    from eigencontact_verification.benchmarks.codes import Code
    from eigencontact_verification.benchmarks.task import Sample, Task

__all__ = ["Benchmark", "Trial", "once", "one_and_all"]


@dataclass(frozen=True, kw_only=True)
class Trial:
    """What one process does with one code at one size.

    Attributes
    ----------
    call : callable
        What a user waits for. The first call counts apart: it pays for what the code remembers.
    judge : callable
        Values of the sample that tell what the answer of the first call is worth.
    setup : callable, optional
        What is timed by itself before the first call; `call` finds it done.
    floors : callable
        Made after the first call, so that it takes no memory of the code's: by name, what is timed in turn with
        further calls, each as a function that returns wall times [s].
    floor : callable
        What becomes of the times of a floor; by default their median.
    always : int
        Further calls that are made even where the time of the task is over. Floors are then timed after them only.
    """

    call: Callable[[], Any]
    judge: Callable[[Any], dict[str, Any]]
    setup: Callable[[], object] | None = None
    floors: Callable[[], Mapping[str, Callable[[], list[float]]]] = dict
    floor: Callable[[list[float]], float | list[float]] = median
    always: int = 0
    began: float = field(default_factory=time.perf_counter)

    def run(self, task: Task, *, warm: int | None = None) -> Sample:
        """Set up, call once cold and `warm` times more, by default as often as the task says; then judge."""
        warm, memory = task.warm if warm is None else warm, PeakMemory()
        sample: Sample = {"status": "ok"}
        if self.setup:
            sample["setup_s"] = timed(self.setup)[1]
        answer, first, cpu = timed(self.call)
        sample |= {"first_s": first, "first_cpu_s": cpu, "peak_bytes": memory.peak(), "peak_reset": memory.reset}
        floors, again = self.floors(), list[float]()
        times = {name: [] if self.always else measure() for name, measure in floors.items()}
        while len(again) < max(warm, self.always) and (len(again) < self.always or self._left(task) > 2 * first):
            again.append(timed(self.call)[1])
            for name, measure in floors.items():
                times[name] += measure()
        sample |= {"again_s": again} | {f"{name}_s": self.floor(values) for name, values in times.items()}
        return sample | self.judge(answer)

    def _left(self, task: Task) -> float:
        return self.began + task.budget - time.perf_counter()


def once(call: Callable[[], object]) -> list[float]:
    """Wall time [s] of one call: a floor that takes long enough for one."""
    return [timed(call)[1]]


def one_and_all(
    name: str, threads: int, floor: Callable[[int], list[float]]
) -> Mapping[str, Callable[[], list[float]]]:
    """Return a floor on one thread and on all threads of a task, as ``NAME_1`` and ``NAME_threads``."""
    return {f"{name}_1": partial(floor, 1), f"{name}_threads": partial(floor, threads)}


#: What a sample says besides numbers; campaigns tell it below the table.
_WORDS = ("status", "version", "settings", "peak_reset")


@dataclass(frozen=True, kw_only=True)
class Benchmark:
    """One problem that codes, or ways of computing, are timed and judged by.

    Attributes
    ----------
    name, help : str
        What is typed, and one line on it.
    measure : callable
        ``measure(code, task) -> sample``, in a fresh process; mostly a `Trial`.
    columns : sequence of Column
        Of its table.
    floors : sequence of str
        Names of the floors that the first call and further ones are divided by.
    medians, worst : sequence of str
        Values of which the median of the processes, or the largest, belongs in the row, as that of times and that of
        memory do; of others it is the value of the last process.
    derive : callable
        ``derive(task, row)``: what else belongs in the row.
    remarks : callable
        Sentences on all rows.
    methods : mapping of str to Code, optional
        Ways of computing by name; by default the codes of `eigencontact_verification.benchmarks.codes`.
    ours, peers : sequence of str
        What is run by default, and what else on request.
    cases : sequence of str
        What is measured one after the other.
    sizes : sequence of int
        Default sizes; where it is one, a run takes one; where it is none, there is nothing to choose.
    unit : str
        What a size counts.
    depths : int
        Default number of depths; 0 where there are none to choose.
    draw : callable, optional
        Draws all rows to a file.
    """

    name: str
    help: str
    measure: Callable[[Any, Task], Sample]
    columns: Sequence[Column]
    floors: Sequence[str] = ()
    medians: Sequence[str] = ()
    worst: Sequence[str] = ()
    derive: Callable[[Task, Row], Row] = lambda *_: {}
    remarks: Callable[[list[Row]], list[str]] = lambda _: []
    methods: Mapping[str, Code] | None = None
    ours: Sequence[str] = ("eigencontact",)
    peers: Sequence[str] = ()
    cases: Sequence[str] = ("",)
    sizes: Sequence[int] = ()
    unit: str = "N"
    depths: int = 0
    draw: Callable[[list[Row], Any], None] | None = None

    def summarise(self, task: Task, samples: list[Sample]) -> Row:
        """One row of the table from the processes of one code, size and case; None where no process tells a value."""
        row: Row = {name: getattr(task, name) for name in ("case", "code", "n", "depths", "threads", "precision")}
        row["processes"] = len(samples)
        for name, value in samples[-1].items():
            if name.endswith("_s") or name in self.medians:
                values = _known(samples, name)
                row[name] = median(values) if values else None
                row[f"{name.removesuffix('_s')}_min_s"] = min(values, default=None)
            elif name in ("peak_bytes", *self.worst):
                row[name] = max(_known(samples, name), default=None)
            elif name not in _WORDS:
                row[name] = value
        shares = [s["first_cpu_s"] / s["first_s"] for s in samples if "first_cpu_s" in s]
        row["cores"] = median(shares) if shares else None
        for floor in self.floors:
            for call in ("first", "again"):
                ratios = [median(times) / s[f"{floor}_s"] for s in samples if (times := _known([s], f"{call}_s"))]
                row[f"{call}_per_{floor}"] = median(ratios) if ratios else None
        return row | self.derive(task, row)


def _known(samples: list[Sample], name: str) -> list[Any]:
    """Values of all processes in one list, without those that are not known."""
    values = [s.get(name) for s in samples]
    return [v for value in values if value is not None for v in (value if isinstance(value, list) else [value])]
