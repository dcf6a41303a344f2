"""Bodies that are not homogeneous: a cluster of balls under a contact, a coated sphere, and the price of stiffness.

``inclusion-cluster`` is the bundled scene, 86 x 86 x 31 cells: everything but pictures, in a fresh process.
``coated-sphere`` presses a sphere on the coating of the bundled scene of that name and on the bare substrate, by the
same solver on the same grid, n x n cells: after the first solve, which samples the coefficients, what is left is the
solve itself. ``ratio r`` solves for the eigenstrain in all cells of the balls of the cluster when they are r times as
stiff as the matrix, and compares an iteration with one application of the bare operator. ``ball r, degree 4`` and
``ball r, 8 cells a radius`` press on one ball of r times the stiffness (0 is a void), 0.3 contact radii large and 1.5
of its own deep; the error is that of the pressure above it, by degree 7 on the same grid, in Hertz pressures, its time
that of the processor. ``stress of degree 4`` is the set-up of one such ball and its stress at 1e5 points.
"""

from __future__ import annotations

from functools import cache
from statistics import median
from typing import Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial, timed
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.reporting.table import Column

__all__ = ["BALLS", "BENCHMARK", "CASES", "METHODS", "RATIOS", "measure"]

#: Stiffness of the balls by that of the matrix.
RATIOS = (0.0, 0.1, 0.5, 2.0, 10.0, 100.0, 1e6)
#: One ball by its names: material and degree, None for cells, of `eigencontact_verification.benchmarks.degrees`.
BALLS = {
    f"ball {ratio}, {way}": (material, degree)
    for ratio, material in (("0", "void"), ("2", "ratio 2"), ("10", "ratio 10"))
    for way, degree in (("degree 4", 4), ("8 cells a radius", None))
}
_STRESS = "stress of degree 4"
CASES = ("inclusion-cluster", "coated-sphere", *(f"ratio {ratio:g}" for ratio in RATIOS), *BALLS, _STRESS)
METHODS = ours(
    "tolerance 1e-6, double precision, exact half-space",
    "pyfftw", "scipy.fft", "eigencontact.app", "eigencontact.solvers.equivalent_inclusions",
)  # fmt: skip
#: Cells of the cluster along (z, y, x), and their edge.
_BOX, _EDGE = (31, 86, 86), 1.0
#: Balls in cells: radius, distance, number along x and y and along z. Those of the bundled scene.
_RADIUS, _SPACING, _ALONG, _DEEP = 3.0, 8.0, 11, 4


def measure(_: Code, task: Task) -> Sample:
    """Measure one case in this process, which is a fresh one."""
    if task.case == "inclusion-cluster":
        return _cluster(task)
    if task.case == "coated-sphere":
        return _coated(task)
    if task.case in BALLS:
        return _ball(*BALLS[task.case])
    if task.case == _STRESS:
        return _stress(task)
    return _ratio(task, float(task.case.split()[1]))


def _cluster(task: Task) -> Sample:
    import eigencontact as ec

    changes = ["output.pictures=false", f"numerics.threads={task.threads}"]

    def judge(result: Any) -> dict[str, Any]:
        last = {name: int(result.dataset[name][-1]) for name in ("inclusion_iterations", "coupling_iterations")}
        result.dataset.close()
        rounds, iterations = last["coupling_iterations"], last["inclusion_iterations"]
        return {"cells": int(np.prod(_BOX)), "iterations": iterations, "rounds": rounds}

    return Trial(call=lambda: ec.run(ec.load_scene("inclusion-cluster", changes)), judge=judge).run(task, warm=0)


def _coated(task: Task) -> Sample:
    """Solve on the coating and on the substrate alone by turns."""
    from eigencontact.app import load_scene, plan
    from eigencontact.execution.blocks.contact import normal_options
    from eigencontact.model.kernels import PairCoefficients
    from eigencontact.solvers.control import Control
    from eigencontact.solvers.normal import NormalSolver

    scene = load_scene("coated-sphere", [f"grid.cells={task.n}", "grid.size=['8 um', '8 um']", "stress=[]"])
    planned = plan(scene)
    options = normal_options(scene.numerics)
    interface = planned.model.interface
    assert interface is not None
    medium, influence = interface.solids[0], interface.influences["p"]
    assert medium is not None
    bodies = {"coated": medium, "bare": medium.deep_material}  # type: ignore[union-attr]
    solvers = {
        name: NormalSolver(planned.grid, PairCoefficients(influence, (body, None), "z"), options)
        for name, body in bodies.items()
    }
    y, x = planned.grid.axes()
    separation, control = interface.separation(x, y), Control(normal_load=scene.steps[0].normal_load)
    first: dict[str, float] = {}
    again: dict[str, list[float]] = {name: [] for name in solvers}
    counts: dict[str, int] = {}
    for turn in range(task.warm + 3):
        for name, solver in solvers.items():
            solution, seconds, _ = timed(lambda s=solver: s.solve(separation, control))  # type: ignore[misc]
            counts[name] = solution.report.convolutions
            if turn:
                again[name].append(seconds)
            else:
                first[name] = seconds
    coated, bare = (median(again[name]) for name in ("coated", "bare"))
    return {
        "status": "ok",
        "cells": task.n**2,
        "setup_s": first["coated"] - coated,
        "first_s": coated,
        "against": coated / bare,
        "applications": counts["coated"],
        "bare_applications": counts["bare"],
    }


def _ratio(task: Task, ratio: float) -> Sample:
    from eigencontact.core.material import Material
    from eigencontact.solvers.cells import Cells
    from eigencontact.solvers.equivalent_inclusions import InhomogeneousCells
    from eigencontact.solvers.mean_stress import MeanVolumeField
    from eigencontact_plugins.laws.isotropic import Isotropic
    from eigencontact_plugins.shapes.cuboid import Cuboid

    matrix = Material(young_modulus=1.0, poisson_ratio=0.3)
    inside = _balls()
    cells = Cells(first=(0.0, 0.0, 0.5 * _EDGE), pitch=(_EDGE,) * 3, shape=_BOX)
    cell = Cuboid(center=(0.0, 0.0, 0.5), edges=(1.0, 1.0, 1.0))

    @cache
    def system() -> InhomogeneousCells:
        constants: dict[str, Any] = {"poisson_ratio": matrix.poisson_ratio, "shear_modulus": matrix.shear_modulus}
        operator = MeanVolumeField(cell, cells, cells, **constants, threads=task.threads, applications=100)
        return InhomogeneousCells(operator, matrix, [Isotropic(young_modulus=ratio, poisson_ratio=0.3)], inside)

    load = np.zeros((6, *_BOX))
    z = cells.centres(2)[:, None, None]
    load[2], load[0], load[1] = -1.0, -0.6 * np.exp(-z / 15.0), -0.6 * np.exp(-z / 15.0)  # about as under a contact

    def judge(answer: Any) -> dict[str, Any]:
        report = answer.report
        return {
            "cells": int(np.prod(_BOX)),
            "inside": int(np.count_nonzero(inside)),
            "iterations": report.iterations,
            "residual": report.residual,
            "solver_applications": report.applications,
            "bare_s": median(timed(lambda: system().operator.apply(answer.eigenstrain))[1] for _ in range(3)),
        }

    trial = Trial(setup=system, call=lambda: system().solve(load, tolerance=1e-6), judge=judge)
    sample = trial.run(task, warm=0)
    return sample | {"per_application": sample["first_s"] / sample["solver_applications"] / sample["bare_s"]}


def _ball(material: str, degree: int | None) -> Sample:
    from eigencontact_verification.benchmarks.degrees import pressure

    depth, cells = 1.5, 8
    pressure(material, depth, 4, None if degree is None else 0)  # imports, and what the program remembers
    value, seconds = pressure(material, depth, cells, degree)
    right, _ = pressure(material, depth, cells, 7)
    if value is None or right is None:
        return {"status": "failed", "reason": "did not converge"}
    return {"status": "ok", "first_s": seconds, "error": abs(value - right)}


def _stress(task: Task) -> Sample:
    from eigencontact import make
    from eigencontact.core.material import Material
    from eigencontact.halfspace.moments import moment_field
    from eigencontact.solvers.polynomial_inclusions import PolynomialInclusions
    from eigencontact_plugins.laws.isotropic import Isotropic

    matrix, degree = Material(young_modulus=1.0, poisson_ratio=0.3), 4
    ball: Any = make("sphere", center=(0.0, 0.0, 1.5), radius=1.0)
    points = np.random.default_rng(0).uniform((-3.0, -3.0, 0.0), (3.0, 3.0, 4.0), (100_000, 3)).T

    @cache
    def system() -> PolynomialInclusions:
        law = Isotropic(young_modulus=2.0, poisson_ratio=0.3)
        return PolynomialInclusions([ball], matrix, [law], [degree], threads=task.threads)

    def call() -> Any:
        load = np.zeros((6, system().points.shape[1]))
        load[2] = -1.0 - 0.1 * system().points[0]
        eigenstrain = system().solve(system().moments(load)).eigenstrain[..., 0]
        return moment_field(
            ball, eigenstrain, tuple(points), degree=degree, poisson_ratio=matrix.poisson_ratio, quantity="stress",
            threads=task.threads,
        )  # fmt: skip

    return Trial(setup=system, call=call, judge=lambda _: {"points": points.shape[1]}).run(task)


def _balls() -> Any:
    """1 in cells whose middle lies in a ball of the cluster, 0 in others, ``(nz, ny, nx)``."""
    nz, ny, nx = _BOX
    z, y, x = (np.arange(n) + 0.5 for n in (nz, ny, nx))

    def away(at: Any, count: int, middle: float) -> Any:
        centres = middle + _SPACING * (np.arange(count) - 0.5 * (count - 1))
        return np.abs(at[:, None] - centres).min(axis=1)

    deep = away(z, _DEEP, _RADIUS + 0.5 * _SPACING * (_DEEP - 1))
    squared = deep[:, None, None] ** 2 + away(y, _ALONG, 0.5 * ny)[None, :, None] ** 2
    return (squared + away(x, _ALONG, 0.5 * nx)[None, None, :] ** 2 <= _RADIUS**2).astype(int)


BENCHMARK = Benchmark(
    name="inhomogeneity",
    help="clusters, coatings, stiffness ratios",
    measure=measure,
    medians=("against", "per_application"),
    methods=METHODS,
    cases=CASES,
    sizes=(256,),
    unit="CELLS-OF-COATED-SPHERE",
    columns=(
        Column("case", "case"),
        Column("cells", "cells", "d"),
        Column("inhomogeneous", "inside", "d"),
        Column("set-up [s]", "setup_s", ".2g"),
        Column("solve [s]", "first_s", ".3g"),
        Column("rounds with the contact", "rounds", "d"),
        Column("Krylov iterations", "iterations", "d"),
        Column("error", "error", ".1e"),
        Column("iteration / bare operator", "per_application", ".2f"),
        Column("solve / homogeneous solve", "against", ".2f"),
        Column("peak [MB]", "peak_bytes", ".0f", scale=1e-6),
        Column("processes", "processes", "d", brief=False),
    ),
)
