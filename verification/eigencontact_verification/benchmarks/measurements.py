"""Codes times sizes times fresh processes, with a limit on time and a word on everything that was left out."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from eigencontact_verification.benchmarks.catalogue import BENCHMARKS

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from eigencontact_verification.benchmarks.benchmark import Sample, Task
    from eigencontact_verification.reporting.table import Row

__all__ = ["Measurements", "measure_all"]


@dataclass(kw_only=True, slots=True)
class Measurements:
    """Measurements of one benchmark."""

    rows: list[Row] = field(default_factory=list)  #: one per code and size, for the table
    samples: list[Sample] = field(default_factory=list)  #: one per process, raw
    notes: list[str] = field(default_factory=list)  #: skipped codes and sizes, with the reason
    settings: dict[str, str] = field(default_factory=dict)  #: version and settings of each code that ran


def measure_all(
    template: Task,
    *,
    codes: Sequence[str],
    sizes: Sequence[int],
    repeats: int,
    limit: float,
    run: Callable[[Task, float], Sample],
    say: Callable[[str], None] = lambda _: None,
) -> Measurements:
    """Measure every code at every size, smallest first.

    Parameters
    ----------
    template : Task
        The task without code, size and budget.
    codes, sizes : sequence
        What to run; the processes of the codes alternate, so that a change of the machine's load meets all of them.
    repeats : int
        Fresh processes per code and size.
    limit : float
        Wall time per code and size [s]. A code that passes it is not run at larger sizes.
    run : callable
        ``run(task, limit)`` makes one sample, in a process of its own.
    say : callable
        Told what happens next.
    """
    out, stopped = Measurements(), set[str]()
    summarise = BENCHMARKS[template.benchmark].summarise
    for n in sorted(sizes):
        running = [code for code in codes if code not in stopped]
        by_code: dict[str, list[Sample]] = {code: [] for code in running}
        spent = dict.fromkeys(running, 0.0)
        for repeat in range(repeats):
            for code in running:
                remaining = limit - spent[code]
                if code in stopped or remaining * len(by_code[code]) < spent[code]:
                    continue  # another process would take about as long as those before
                say(f"N = {n}, {code}, process {repeat + 1} of {repeats}")
                began = time.perf_counter()
                sample = run(replace(template, code=code, n=n, budget=remaining / (repeats - repeat)), remaining)
                spent[code] += time.perf_counter() - began
                out.samples.append({"benchmark": template.benchmark, "code": code, "n": n, **sample})
                if sample["status"] == "ok":
                    by_code[code].append(sample)
                    version = sample.get("version")
                    out.settings[code] = f"{version}: {sample['settings']}" if version else sample["settings"]
                else:
                    _stop(out, stopped, code, n, sample, bool(by_code[code]))
        for code, samples in by_code.items():
            if samples:
                out.rows.append(summarise(replace(template, code=code, n=n), samples))
            if code not in stopped and spent[code] > limit:
                stopped.add(code)
                note = f"{code}: larger than N = {n} skipped, slower than the limit of {limit:.0f} s there"
                out.notes += [note] if n < max(sizes) else []
    return out


def _stop(out: Measurements, stopped: set[str], code: str, n: int, sample: Sample, has_row: bool) -> None:  # noqa: FBT001
    """Run `code` no more, and say why."""
    stopped.add(code)
    where = f"after the first processes at N = {n}" if has_row else f"from N = {n} on"
    if sample["status"] == "absent":
        out.notes.append(f"{code}: skipped, absent ({sample['reason']})")
    elif sample["status"] == "slow":
        out.notes.append(f"{code}: skipped {where}, slower than the limit ({sample['reason']})")
    else:
        out.notes.append(f"{code}: skipped {where}, failed ({sample['reason']})")
