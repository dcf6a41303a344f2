"""Sub-surface stress in a coated body against that in the substrate alone, by the same operators on the same grid.

A coating of twice the modulus, as thick as the contact radius, in n x n cells over four contact radii; pressure and, in
the cases with friction, shear along x and y. ``planes`` are the depths of a volume down to 2.5 thicknesses, ``section``
the same depths under the line y = 0, ``line`` 64 points of the axis. A step is a second call with the same loads. The
coated body is set up twice: with an empty folder of kept tables, and with what the first time has left there.
"""

from __future__ import annotations

import os
from functools import cache
from statistics import median
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any
from unittest.mock import patch

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, timed
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.benchmarks.measure import FloatArray
from eigencontact_verification.reporting.table import Column, Row

if TYPE_CHECKING:
    from collections.abc import Callable


__all__ = ["BENCHMARK", "CASES", "METHODS", "measure"]

CASES = tuple(f"{shape}, {loads}" for shape in ("planes", "section", "line") for loads in ("pressure", "friction"))
METHODS = ours(
    "double precision, exact half-space; coefficients agree to 1e-9 between two resolutions",
    "pyfftw", "scipy.fft", "scipy.special", "eigencontact.app", "eigencontact.solvers.subsurface",
)  # fmt: skip
#: Points of the line.
_POINTS = 64
#: Names the folder of kept tables; versions before there was one take no notice.
VARIABLE = "EIGENCONTACT_CACHE"


def measure(_: Code, task: Task) -> Sample:
    """Set up and apply by turns: on the coated body from nothing and with kept tables, and on the bare one."""
    times: dict[str, list[float]] = {}
    for turn in range(1 + task.warm):
        with TemporaryDirectory() as folder, patch.dict(os.environ, {VARIABLE: folder}):
            for name in ("coated", "kept", "bare"):
                call, loads = _stress(task, "bare" if name == "bare" else "coated")
                first = timed(lambda c=call, q=loads: c(q))[1]  # type: ignore[misc]
                again = timed(lambda c=call, q=loads: c(q))[1]  # type: ignore[misc]
                if turn:
                    times.setdefault(f"{name}_setup_s", []).append(max(first - again, 0.0))
                    times.setdefault(f"{name}_step_s", []).append(again)
    return {"status": "ok", **{name: median(values) for name, values in times.items()}}


def _stress(task: Task, body: str) -> tuple[Callable[[list[FloatArray]], FloatArray], list[FloatArray]]:
    """Function from loads to stress, whose first call sets the operator up, and the loads; lengths in thicknesses."""
    from eigencontact.core.grid import Box, Grid
    from eigencontact.model.bodies import influence_for
    from eigencontact.model.kernels import StressCoefficients
    from eigencontact.plugin import Material
    from eigencontact.scene.installed import installed_plugins
    from eigencontact.solvers.subsurface import SubsurfaceStress, stress_at_points
    from eigencontact_plugins.layered.stack import BondedLayers, Layer, Substrate

    shape, friction = task.case.split(", ")
    grid = Grid(nx=task.n, ny=task.n, dx=4.0 / task.n, dy=4.0 / task.n)
    solid: Any = Material(young_modulus=1.0, poisson_ratio=0.3)
    if body == "coated":
        layer = Layer(thickness=1.0, young_modulus=2.0, poisson_ratio=0.3)
        solid = BondedLayers(layers=(layer,), substrate=Substrate(young_modulus=1.0, poisson_ratio=0.3))
    pressure = np.sqrt(np.maximum(1.0 - grid.x[None] ** 2 - grid.y[:, None] ** 2, 0.0))
    loads = [pressure, 0.3 * pressure, 0.1 * pressure * grid.x] if friction == "friction" else [pressure]
    tractions = ("p", "q_x", "q_y")[: len(loads)]
    kernels = [StressCoefficients(influence_for(installed_plugins(), name, (solid, None)), solid) for name in tractions]
    depths = np.linspace(0.0, 2.5, _POINTS if shape == "line" else task.depths)
    if shape == "line":
        points = np.stack([np.zeros(_POINTS), np.zeros(_POINTS), depths], axis=1)
        return lambda q: stress_at_points(grid, kernels, q, points, threads=task.threads), loads
    box = Box.around(pressure > 0)
    assert box is not None
    target, origin = (grid.shape, (0.0, 0.0))
    if shape == "section":
        target, origin = (1, task.n), (0.5 * (task.n - 1), 0.0)
    operator = cache(
        lambda: SubsurfaceStress(
            grid, kernels, source=box, target=target, origin=origin, depths=depths, precision=task.precision,
            threads=task.threads,
        )
    )  # fmt: skip
    return lambda q: operator().apply(q), loads


def _ratios(task: Task, row: Row) -> Row:
    """First and further steps against those of the bare body."""
    first = {name: row[f"{name}_setup_s"] + row[f"{name}_step_s"] for name in ("coated", "kept", "bare")}
    ratios = {"first": first["coated"] / first["bare"], "first_kept": first["kept"] / first["bare"]}
    ratios |= {"again": row["coated_step_s"] / row["bare_step_s"]}
    return ratios | ({"depths": _POINTS} if task.case.startswith("line") else {})


BENCHMARK = Benchmark(
    name="layers",
    help="stress in a coated body against the bare one",
    measure=measure,
    derive=_ratios,
    methods=METHODS,
    cases=CASES,
    sizes=(256,),
    depths=32,
    columns=(
        Column("case", "case"),
        Column("N", "n", "d"),
        Column("depths", "depths", "d"),
        Column("set-up, coated [s]", "coated_setup_s", ".2g"),
        Column("set-up, kept [s]", "kept_setup_s", ".2g"),
        Column("set-up, bare [s]", "bare_setup_s", ".2g"),
        Column("step, coated [s]", "coated_step_s", ".2g"),
        Column("step, bare [s]", "bare_step_s", ".2g"),
        Column("first step / bare", "first", ".2f"),
        Column("the same, kept", "first_kept", ".2f"),
        Column("further steps / bare", "again", ".2f"),
        Column("processes", "processes", "d", brief=False),
    ),
)
