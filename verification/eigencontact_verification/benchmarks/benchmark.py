"""Benchmarks: their description, the loop that measures a code in its process, and the row of all processes.

A benchmark has a set-up, a call, a judge of the answer, and the columns of its table; the loop and the medians stand
here.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from statistics import median
from typing import TYPE_CHECKING, Any, TypeVar

from eigencontact_verification.reporting.memory import PeakMemory
from eigencontact_verification.reporting.table import Column, Row

if TYPE_CHECKING:
    from eigencontact_verification.benchmarks.codes import Code

__all__ = ["Benchmark", "Sample", "Task", "Trial", "once", "one_and_all", "repeated", "timed"]

T = TypeVar("T")
#: Measurement of one process: JSON, with ``status`` "ok", "absent" or "failed" and a ``reason`` for the latter two.
Sample = dict[str, Any]


@dataclass(frozen=True, kw_only=True, slots=True)
class Task:
    """One code at one size in one process."""

    benchmark: str  #: name of one of those in `eigencontact_verification.benchmarks.catalogue`
    code: str  #: name for `eigencontact_verification.benchmarks.codes.find_code`
    n: int  #: cells along each side; inclusions of a cloud; cells per contact radius (plasticity)
    threads: int = 1  #: threads that the code may use
    precision: str = "double"  #: ``"double"`` or ``"single"``, for codes that have the choice
    warm: int = 2  #: calls after the first one in the same process
    budget: float = 120.0  #: wall time after which no further repeat begins [s]
    depths: int = 32  #: number of depths (stress and layers)
    case: str = ""  #: one of the cases of the benchmark
    rows: str = ""  #: folder with the stored rows of a benchmark that keeps them

    def to_json(self) -> str:
        """Text for the command line of the process."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> Task:
        """Read it back."""
        return cls(**json.loads(text))


def timed(call: Callable[[], T]) -> tuple[T, float, float]:
    """Return what `call` returned, its wall time [s] and the processor time of all threads [s]."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = call()
    return result, time.perf_counter() - wall, time.process_time() - cpu


def repeated(call: Callable[[], object], *, least: int = 3, seconds: float = 0.05) -> list[float]:
    """Wall times [s] of calls repeated at least `least` times and for at least `seconds`.

    Examples
    --------
    >>> len(repeated(lambda: None, least=2, seconds=0.0))
    2
    """
    times: list[float] = []
    while len(times) < least or sum(times) < seconds:
        times.append(timed(call)[1])
    return times


@dataclass(frozen=True, kw_only=True)
class Trial:
    """Calls of one code at one size in one process."""

    #: Call that a user waits for. The first call counts apart: it pays for what the code remembers.
    call: Callable[[], Any]
    #: Values of the sample from the answer of the first call, such as errors and counts.
    judge: Callable[[Any], dict[str, Any]]
    #: Set-up, timed by itself before the first call; `call` finds it done.
    setup: Callable[[], object] | None = None
    #: Functions that return wall times [s], by name, timed in turn with further calls. They are made after the first
    #: call, so that they take no memory of the code's.
    floors: Callable[[], Mapping[str, Callable[[], list[float]]]] = dict
    #: Number, or numbers, of the sample from the times of a floor.
    floor: Callable[[list[float]], float | list[float]] = median
    #: Least number of further calls, even past the time of the task. Floors are then timed after them only.
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
        while len(again) < max(warm, self.always) and (len(again) < self.always or self._remaining(task) > 2 * first):
            again.append(timed(self.call)[1])
            for name, measure in floors.items():
                times[name] += measure()
        sample |= {"again_s": again} | {f"{name}_s": self.floor(values) for name, values in times.items()}
        return sample | self.judge(answer)

    def _remaining(self, task: Task) -> float:
        return self.began + task.budget - time.perf_counter()


def once(call: Callable[[], object]) -> list[float]:
    """Wall time [s] of one call: a floor that takes long enough for one."""
    return [timed(call)[1]]


def one_and_all(
    name: str, threads: int, floor: Callable[[int], list[float]]
) -> Mapping[str, Callable[[], list[float]]]:
    """Return a floor on one thread and on all threads of a task, as ``NAME_1`` and ``NAME_threads``."""
    return {f"{name}_1": partial(floor, 1), f"{name}_threads": partial(floor, threads)}


#: Values of a sample that are no numbers; they stand below the table.
_WORDS = ("status", "version", "settings", "peak_reset")


@dataclass(frozen=True, kw_only=True)
class Benchmark:
    """One problem on which codes, or ways of computing, are timed and judged."""

    name: str  #: name on the command line
    help: str  #: one line on it
    measure: Callable[[Any, Task], Sample]  #: sample of a code and a task in a fresh process; mostly a `Trial`
    columns: Sequence[Column]  #: columns of its table
    floors: Sequence[str] = ()  #: floors by which the times of first and further calls are divided
    #: Values of which the row has the median of the processes, as of times, or the largest, as of memory; of all other
    #: values the row has that of the last process.
    medians: Sequence[str] = ()
    worst: Sequence[str] = ()
    derive: Callable[[Task, Row], Row] = lambda *_: {}  #: further values of the row
    remarks: Callable[[list[Row]], list[str]] = lambda _: []  #: sentences on all rows
    #: Ways of computing by name; by default the codes of `eigencontact_verification.benchmarks.codes`.
    methods: Mapping[str, Code] | None = None
    function: str = ""  #: attribute of a code that the benchmark calls; codes without it take no part
    ours: Sequence[str] = ("eigencontact",)  #: codes that run by default
    peers: Sequence[str] = ()  #: further codes on request
    cases: Sequence[str] = ("",)  #: cases, measured one after the other
    sizes: Sequence[
        int
    ] = ()  #: default sizes; a run takes one where there is one, and has no choice where there is none
    unit: str = "N"  #: unit of a size
    depths: int = 0  #: default number of depths; 0 where there are none to choose
    rows: bool = False  #: whether raw rows are kept in a folder, from which a later call goes on
    draw: Callable[[list[Row], Any], None] | None = None  #: function that draws all rows to a file

    def summarise(self, task: Task, samples: list[Sample]) -> Row:
        """One row of the table from the processes of one code, size and case; None where no process tells a value."""
        row: Row = {name: getattr(task, name) for name in ("case", "code", "n", "depths", "threads", "precision")}
        row["processes"] = len(samples)
        for name, value in samples[-1].items():
            if name.endswith("_s") or name in self.medians:
                values = _values(samples, name)
                row[name] = median(values) if values else None
                row[f"{name.removesuffix('_s')}_min_s"] = min(values, default=None)
            elif name in ("peak_bytes", *self.worst):
                row[name] = max(_values(samples, name), default=None)
            elif name not in _WORDS:
                row[name] = value
        shares = [s["first_cpu_s"] / s["first_s"] for s in samples if "first_cpu_s" in s]
        row["cores"] = median(shares) if shares else None
        for floor in self.floors:
            for call in ("first", "again"):
                ratios = [median(times) / s[f"{floor}_s"] for s in samples if (times := _values([s], f"{call}_s"))]
                row[f"{call}_per_{floor}"] = median(ratios) if ratios else None
        return row | self.derive(task, row)


def _values(samples: list[Sample], name: str) -> list[Any]:
    """Values of all processes in one list, without those that are not known."""
    values = [s.get(name) for s in samples]
    return [v for value in values if value is not None for v in (value if isinstance(value, list) else [value])]
