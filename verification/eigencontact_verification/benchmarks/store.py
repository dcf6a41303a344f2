"""Storing: what a step costs, and layouts of the results file against that which is used.

The fields are closed forms: three of a contact without friction, eleven of one with partial slip. ``used`` is the
writer of the package, at each step and at the end. The other ways write the same arrays with h5py alone, at the end:
``whole`` as one piece each, ``bands`` of rows of 1 MB without those that are zero, ``squares`` of 256 x 256 cells
likewise, ``lzf`` and ``gzip`` bands compressed after a byte shuffle. Each ends with the file on the disk, as far as the
system tells.
"""

from __future__ import annotations

import os
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial
from eigencontact_verification.benchmarks.codes import Code
from eigencontact_verification.reporting.table import Column

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray


__all__ = ["BENCHMARK", "LAYOUTS", "fields_of", "measure", "write"]

#: Layouts by name: cells along the sides of a chunk, and its compression by h5py.
LAYOUTS: dict[str, dict[str, Any]] = {
    "whole": {},
    "bands": {"band": 2**17},
    "squares": {"square": 256},
    "lzf": {"band": 2**17, "compression": "lzf", "shuffle": True},
    "gzip": {"band": 2**17, "compression": "gzip", "compression_opts": 1, "shuffle": True},
}
_STEPS = 51
#: Cells along a side and steps by name of the case; several steps are those with friction.
_CASES = {
    "72 x 72": (72, 1),
    "72 x 72, friction, 51 steps": (72, _STEPS),
    "512 x 512, friction, 51 steps": (512, _STEPS),
    "4096 x 4096": (4096, 1),
}
#: Side of the window in contact radii, radius of the stick circle in them.
_WINDOW, _STICK = 3.5, 0.7


def fields_of(n: int, step: int, *, friction: bool) -> dict[str, NDArray[np.float64]]:
    """Surface fields of a step: pressure by Hertz, gap and deflection; with friction shear, slip and its work."""
    x = (np.arange(n) - 0.5 * (n - 1)) * (_WINDOW / n)
    squared = x**2 + x[:, None] ** 2
    pressure = np.sqrt(np.maximum(0.0, 1.0 - squared))
    fields = {
        "pressure": pressure,
        "gap": np.maximum(0.0, squared - 1.0) ** 1.5,
        "displacement_z": 1.0 / np.sqrt(1.0 + squared),
    }
    if friction:
        stick = _STICK + 0.2 * step / _STEPS
        shear = pressure - stick * np.sqrt(np.maximum(0.0, 1.0 - squared / stick**2))
        slip = np.where((squared < 1.0) & (squared > stick**2), squared - stick**2, 0.0)
        zone = np.where(pressure > 0, np.where(slip > 0, 1.0, 2.0), 0.0)
        fields |= {"shear_x": shear, "slip_x": slip, "slip_distance": step * slip}
        fields |= {"dissipated_energy_density": step * slip * shear, "contact_zone": zone}
        fields |= {"displacement_x": 0.3 * fields["displacement_z"], "shear_bound": 0.5 * pressure}
    return fields


def write(path: Path, steps: list[Mapping[str, NDArray[np.float64]]], layout: Mapping[str, Any]) -> None:
    """Write the fields of all steps with h5py alone."""
    import h5py  # type: ignore[import-not-found,import-untyped,unused-ignore]

    layout = dict(layout)
    band, square = layout.pop("band", 0), layout.pop("square", 0)
    with path.open("w+b", buffering=0) as raw:
        with h5py.File(raw, "w") as file:
            for name, first in steps[0].items():
                ny, nx = first.shape
                rows, columns = (min(square, ny), min(square, nx)) if square else (max(1, min(ny, band // nx)), nx)
                chunks = (1, rows, columns) if band or square else None
                variable = file.create_dataset(name, (len(steps), ny, nx), "f8", chunks=chunks, **layout)
                for at, fields in enumerate(steps):
                    _fill(variable, at, fields[name], rows if chunks else ny, columns)
        os.fsync(raw.fileno())


def _fill(variable: Any, at: int, field: NDArray[np.float64], rows: int, columns: int) -> None:
    ny, nx = field.shape
    for row in range(0, ny, rows):
        for column in range(0, nx, columns):
            block = field[row : row + rows, column : column + columns]
            if variable.chunks is None or block.any():
                variable[at, row : row + rows, column : column + columns] = block


def _stored(folder: Path, n: int, steps: list[Mapping[str, NDArray[np.float64]]]) -> list[float]:
    """Store them as a run does; wall time of each step, then of the end."""
    from eigencontact.core.grid import Grid
    from eigencontact.results.records import RunInfo, StepRecord
    from eigencontact.results.store import ResultStore

    info = RunInfo(
        title="", name="benchmark", grid=Grid(nx=n, ny=n, dx=1.0, dy=1.0), scene_toml="", scene_hash="0" * 64,
        versions={}, references=(), contact_modulus=None, steps=len(steps),
    )  # fmt: skip
    store, times = ResultStore.create(folder, info), []
    for index, fields in enumerate(steps, 1):
        began = perf_counter()
        store.write_step(StepRecord(index=index, time=float(index), scalars={"normal_load": 1.0}, fields=dict(fields)))
        times.append(perf_counter() - began)
    began = perf_counter()
    store.finish()
    return [*times, perf_counter() - began]


def measure(code: Code, task: Task) -> Sample:
    """Measure one way of storing in this process, which is a fresh one."""
    n, count = _CASES[task.case]
    steps: list[Any] = [fields_of(n, step, friction=count > 1) for step in range(1, count + 1)]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run" / "results.nc"
        path.parent.mkdir()

        def call() -> list[float]:
            if code.name == "used":
                return _stored(path.parent, n, steps)
            write(path, steps, LAYOUTS[code.name])
            return []

        def judge(times: list[float]) -> dict[str, Any]:
            import h5py  # type: ignore[import-not-found,import-untyped,unused-ignore]

            began = perf_counter()
            with h5py.File(path, "r") as file:
                equal = all(np.array_equal(file[name][-1], values) for name, values in steps[-1].items())
            return {
                "step_ms": 1e3 * float(np.median(times[:-1])) if times else None,
                "read_ms": 1e3 * (perf_counter() - began),
                "same": equal,
                "size_mb": 1e-6 * path.stat().st_size,
            }

        return Trial(call=call, judge=judge).run(task, warm=0)


def _code(name: str) -> Code:
    modules = ("h5py", "eigencontact.results.store") if name == "used" else ("h5py",)
    return Code(name=name, distribution="eigencontact", modules=modules, settings=f"{name} of `{__name__}`")


BENCHMARK = Benchmark(
    name="store",
    help="storing steps, and layouts of the results file",
    measure=measure,
    medians=("step_ms", "read_ms"),
    methods={name: _code(name) for name in ("used", *LAYOUTS)},
    ours=("used", *LAYOUTS),
    cases=tuple(_CASES),
    columns=(
        Column("case", "case"),
        Column("layout", "code"),
        Column("a step [ms]", "step_ms", ".2g"),
        Column("all [ms]", "first_s", ".3g", scale=1e3),
        Column("last step read [ms]", "read_ms", ".2g"),
        Column("file [MB]", "size_mb", ".3g"),
        Column("same to the bit", "same"),
    ),
)
