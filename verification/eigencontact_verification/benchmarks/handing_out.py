"""Costs of a sweep on a cluster beyond its runs: variants refused before they run, on workers of this machine.

``python -m eigencontact_verification.benchmarks.handing_out [--variants 2000 20000] [--workers 2] [--markdown FILE]``
prints the costs at two numbers of variants, and the extrapolation to 10⁵ by the straight line through both.
"""

from __future__ import annotations

import argparse
import json
import pickle
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eigencontact.sweeps.axes import Axis
    from eigencontact.sweeps.runner import Outcome
    from eigencontact.sweeps.variants import Variant

__all__ = ["Cost", "main", "measure", "written"]

#: Variants at the beginning that are not timed: workers import what they need.
_FIRST = 100
#: Number of variants that is extrapolated to.
_COUNT = 100_000
#: A run that leaves what a variant leaves, in a moment.
_SMALL = ["stress=[]", "grid.cells=32", 'grid.size="30 um"', "output.pictures=false", "output.vtk=false"]


@dataclass(frozen=True, kw_only=True)
class Cost:
    """One measured cost, with its unit and its value by number of variants."""

    name: str
    unit: str
    values: dict[int, float]

    def at(self, count: int) -> float:
        """Value at a number of variants, by the straight line through the smallest and the largest that were measured.

        Examples
        --------
        >>> Cost(name="time", unit="s", values={10: 3.0, 30: 7.0}).at(100)
        21.0
        """
        low = min(self.values)
        return self.values[low] + self.slope * (count - low)

    @property
    def slope(self) -> float:
        """Cost of one more variant."""
        low, high = min(self.values), max(self.values)
        return (self.values[high] - self.values[low]) / (high - low)


def measure(counts: Sequence[int], workers: int) -> list[Cost]:
    """Costs of sweeps of these numbers of variants; each number is a sweep of its own."""
    from eigencontact.app import load_scene, run

    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "one"
        summary = json.dumps(run(load_scene("hertz", _SMALL), place).summary, default=str)
        files = [path for path in place.rglob("*") if path.is_file()]
        stored, number = sum(path.stat().st_size for path in files), len(files) + 1  # its mark beside them
    _of_gathering(2, summary)  # imports what is needed
    by_number: dict[tuple[str, str], dict[int, float]] = {}
    for count in counts:
        costs = {**_of_handing(count, workers), **_of_gathering(count, summary)}
        costs["stored in folders of variants", "MB"] = 1e-6 * stored * count
        costs["files in folders of variants", "1"] = float(number * count)
        for name, value in costs.items():
            by_number.setdefault(name, {})[count] = value
    return [Cost(name=cost, unit=unit, values=values) for (cost, unit), values in by_number.items()]


def _variants(count: int) -> tuple[list[Axis], list[Variant], float]:
    """Axes and variants, and the time of making them [s]."""
    from eigencontact.app import load_scene
    from eigencontact.sweeps.axes import axes_of
    from eigencontact.sweeps.variants import variants_of

    axes = axes_of({"steps.normal-load": {"from": 0.1, "to": 1.0, "count": count}})
    scene, began = load_scene("hertz"), perf_counter()
    variants = variants_of(scene, axes, pairs=False, pictures=False)
    return axes, variants, perf_counter() - began


def _of_handing(count: int, workers: int) -> dict[tuple[str, str], float]:
    """Costs of handing variants out that do nothing, and of bringing back that they did."""
    from eigencontact.core.memory import resident_bytes
    from eigencontact.engines.cluster import Cluster
    from eigencontact.sweeps.runner import outcomes

    _, variants, seconds = _variants(count + _FIRST)
    trivial, within, back = [replace(variant, refused="trivial") for variant in variants], 0.0, list[object]()
    began, paused = perf_counter(), 0.0
    with tempfile.TemporaryDirectory() as folder:
        for count_done, outcome in enumerate(outcomes(trivial, Path(folder), engine=Cluster(f"local:{workers}")), 1):
            if count_done == _FIRST:
                began, within, paused = perf_counter(), 0.0, resident_bytes()
            within += outcome.seconds
            back.append(outcome)
        wall, paused = perf_counter() - began, resident_bytes() - paused
    return {
        ("variants made by the command", "s"): seconds * count / len(variants),
        ("handed out and brought back", "s"): wall,
        ("the same, time of workers beyond the runs", "s"): wall * workers - within,
        ("memory of scheduler and command meanwhile, more", "MB"): 1e-6 * paused,
        ("sent to workers, pickled", "MB"): 1e-6 * count * len(pickle.dumps(variants[0])),
    }


def _of_gathering(count: int, summary: str) -> dict[tuple[str, str], float]:
    """Costs of the dataset and the table of all numbers, each variant with those of a real run."""
    from eigencontact.core.memory import resident_bytes
    from eigencontact.sweeps.gather import as_csv, gathered
    from eigencontact.sweeps.runner import Outcome
    from eigencontact.sweeps.sweep import _as_netcdf

    axes, variants, _ = _variants(count)
    memory_before = resident_bytes()
    outcomes: list[Outcome] = [Outcome(variant.place, json.loads(summary), {}, "", 0.0) for variant in variants]
    memory_before, back = resident_bytes() - memory_before, len(pickle.dumps(outcomes[0]))
    began = perf_counter()
    dataset = gathered(axes, variants, outcomes, "cost", pairs=False)
    brought = perf_counter() - began
    table = as_csv(axes, variants, outcomes)
    stored = _as_netcdf(dataset)
    return {
        ("brought back from workers, pickled", "MB"): 1e-6 * count * back,
        ("held by the command until the end", "MB"): 1e-6 * memory_before,
        ("gathered into one dataset", "s"): brought,
        ("dataset and table written", "s"): perf_counter() - began - brought,
        ("sweep.nc and sweep.csv", "MB"): 1e-6 * (len(stored) + len(table.encode())),
    }


def written(costs: Sequence[Cost], workers: int) -> str:
    """Costs as a table of Markdown, with the machine."""
    from eigencontact_verification.reporting.machine import describe, facts

    counts = sorted(costs[0].values)
    head = ["", *(f"{count} variants" for count in counts), f"one more, from {counts[0]} to {counts[-1]}"]
    head.append("10⁵, by the line")
    rows = [f"| {' | '.join(head)} |", f"|---|{'---:|' * (len(head) - 1)}"]
    for cost in costs:
        unit = "" if cost.unit == "1" else f" {cost.unit}"
        more = (
            f"{cost.slope:.3g}" if cost.unit == "1" else f"{1e3 * cost.slope:.3g} {'ms' if cost.unit == 's' else 'kB'}"
        )
        cells = [*(f"{cost.values[count]:.3g}{unit}" for count in counts), more, f"{cost.at(_COUNT):.3g}{unit}"]
        rows.append(f"| {cost.name} | {' | '.join(cells)} |")
    return "\n".join([*rows, "", f"On {workers} workers of one machine. Measured {describe(facts())}."])


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print, and write where wanted."""
    from eigencontact_verification.reporting.table import check_section, replace_section

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--variants", type=int, nargs=2, default=(2000, 20000), help="two numbers of variants")
    parser.add_argument("--workers", type=int, default=2, help="processes of this machine")
    parser.add_argument("--markdown", type=Path, help="file with the markers of benchmark:handing-out")
    options = parser.parse_args(arguments)
    if options.variants[0] == options.variants[1] or min(options.variants) < 1:
        parser.error(f"--variants must be two different positive numbers (got {options.variants})")
    if options.markdown is not None:
        check_section(options.markdown, "handing-out")
    text = written(measure(options.variants, options.workers), options.workers)
    print(text)
    if options.markdown is not None:
        replace_section(options.markdown, "handing-out", text)


if __name__ == "__main__":
    main()
