"""Error against time and memory: finite elements and the semi-analytical ways, on one problem.

A unit cube whose middle lies 1.5 edges below the surface stretches along z, nu = 0.3. Asked for is the displacement of
the surface on 16 x 16 points of a quadrant up to four edges away. The judge is quadrature of Mindlin's solution over
the faces of the cube, which shares no code with either. The grid of the semi-analytical ways has four cells an edge and
a window of 16 edges; the finite-element models are quarter models with fixed outer faces.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.benchmarks import fidelity
from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial
from eigencontact_verification.benchmarks.codes import Code
from eigencontact_verification.benchmarks.measure import FloatArray, largest_error
from eigencontact_verification.reporting.table import Column, Row

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


__all__ = ["BENCHMARK", "METHODS", "MODELS", "POINTWISE", "draw", "measure", "points", "truth"]

DEPTH = 1.5
#: Cells along an edge, and points along each side of the quadrant.
CELLS, SIDE = 4, 16
STRAIN = np.diag([0.0, 0.0, 1.0])
#: Half width and depth of the finite-element body [edges].
REACH = 30.0
#: Element order and elements along the cube's edge, by name.
MODELS = {
    f"FE, {word}, h = 1/{parts}": (order, parts)
    for order, word, sizes in ((1, "linear", (2, 4, 8)), (2, "quadratic", (1, 2, 4)))
    for parts in sizes
}
POINTWISE = "closed form at the points"
METHODS = {
    POINTWISE: Code(
        name=POINTWISE,
        distribution="eigencontact",
        modules=("eigencontact.library.inclusions", "eigencontact.halfspace.points"),
        settings="inclusion_field",
    ),
    **{
        name: replace(code, settings=f"{code.settings}; 64 x 64 x 4 cells")
        for name, code in fidelity.METHODS.items()
        if name != "exact, single"
    },
    **{
        name: Code(
            name=name,
            distribution="scikit-fem",
            modules=("skfem", "pyamg", "eigencontact_verification.fem.solve"),
            settings=f"quarter of a block of {REACH:g} edges, graded",
        )
        for name in MODELS
    },
}


def points() -> FloatArray:
    """Middles of the cells of a quadrant of the surface (n, 3) [edges]."""
    line = (np.arange(SIDE) + 0.5) / CELLS
    y, x = np.meshgrid(line, line, indexing="ij")
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])


@cache
def truth() -> FloatArray:
    """Displacement at the points (n, 3) by quadrature of Mindlin's solution."""
    from eigencontact_verification.oracles import cuboid_quadrature, mindlin

    integrals = cuboid_quadrature.moments(points(), (0.0, 0.0, DEPTH), (1.0, 1.0, 1.0))
    return mindlin.displacement(integrals, STRAIN, fidelity.POISSON_RATIO)


def _closed_form(_: Task) -> tuple[FloatArray, int]:
    from eigencontact import inclusion_field
    from eigencontact_plugins.shapes.cuboid import Cuboid

    cube = Cuboid(center=(0.0, 0.0, DEPTH), edges=(1.0, 1.0, 1.0))
    nu = fidelity.POISSON_RATIO
    return inclusion_field(cube, STRAIN, points(), young_modulus=1.0, poisson_ratio=nu), SIDE * SIDE


def _on_grid(name: str, task: Task) -> tuple[FloatArray, int]:
    n = 16 * CELLS
    case = fidelity.Case(name="cube", cells=(CELLS, CELLS), top=(DEPTH - 0.5) * CELLS)
    problem = fidelity.Problem(case=case, n=n, threads=task.threads)
    strain = np.zeros((6, CELLS, n, n))
    inner = slice((n - CELLS) // 2, (n + CELLS) // 2)
    strain[2, :, inner, inner] = 1.0
    field = fidelity.BUILDERS[name](problem, "displacement")(strain)[:, 0] / CELLS  # lengths there are cells
    quadrant = slice(n // 2, n // 2 + SIDE)
    return field[:, quadrant, quadrant].reshape(3, -1).T, strain[0].size


def _elements(name: str, _: Task) -> tuple[FloatArray, int]:
    from eigencontact_verification.fem.model import Model, Region
    from eigencontact_verification.fem.solve import solve

    low, high = (-0.5, -0.5, DEPTH - 0.5), (0.5, 0.5, DEPTH + 0.5)

    def contains(x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        return np.asarray((abs(x) <= 0.5) & (abs(y) <= 0.5) & (abs(z - DEPTH) <= 0.5))

    order, divisions = MODELS[name]
    model = Model(
        young_modulus=1.0,
        poisson_ratio=fidelity.POISSON_RATIO,
        regions=(Region(contains=contains, bounds=(low, high), eigenstrain=STRAIN),),
        reach=REACH,
        symmetry=("even", "even"),
        fine=1.0 / divisions,
        order=order,
    )
    solution = solve(model)
    return solution.displacement(points()), solution.unknowns


def _way(name: str) -> Callable[[Task], tuple[FloatArray, int]]:
    if name == POINTWISE:
        return _closed_form
    builder = _elements if name in MODELS else _on_grid
    return lambda task: builder(name, task)


def measure(code: Code, task: Task) -> Sample:
    """Solve once in a fresh process, set-up included, and judge."""

    def judge(answer: tuple[FloatArray, int]) -> dict[str, Any]:
        displacement, unknowns = answer
        return {"unknowns": unknowns, "error": largest_error(displacement, truth())}

    return Trial(call=lambda: _way(code.name)(task), judge=judge).run(task, warm=0)


def draw(rows: list[Row], path: Path) -> None:
    """Error against time and against memory, finite elements joined by lines of equal order."""
    from eigencontact.viz.style import COLOURS, new_figure, paper_style, save

    families = ("FE, linear", "FE, quadratic")
    with paper_style():
        figure = new_figure(7.2, 3.4)
        panels: Any = figure.subplots(1, 2, sharey=True)
        for axes, (key, scale, label) in zip(
            panels,
            (("first_s", 1.0, "Time, set-up included [s]"), ("peak_bytes", 1e-6, "Peak memory [MB]")),
            strict=True,
        ):
            for colour, marker, family in zip(COLOURS[1:], "s^", families, strict=False):
                members = [row for row in rows if row["code"].startswith(family) and row[key]]
                x = [scale * row[key] for row in members]
                axes.plot(x, [row["error"] for row in members], marker=marker, color=colour, label=family)
            semi_analytical = [row for row in rows if not row["code"].startswith("FE") and row[key]]
            for mark, row in zip("oDvP*Xd", semi_analytical, strict=False):
                place = scale * row[key]
                axes.plot(place, row["error"], mark, color=COLOURS[0], markerfacecolor="white", label=row["code"])
            axes.set(xscale="log", yscale="log", xlabel=label)
        panels[0].set_ylabel("Largest error / largest displacement")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
        save(figure, path)


BENCHMARK = Benchmark(
    name="trade",
    help="finite elements against the semi-analytical ways",
    measure=measure,
    worst=("error",),
    methods=METHODS,
    ours=tuple(METHODS),
    draw=draw,
    columns=(
        Column("way", "code"),
        Column("unknowns or cells", "unknowns", "d"),
        Column("error", "error", ".1e"),
        Column("time, set-up included [s]", "first_s", ".2g"),
        Column("peak [MB]", "peak_bytes", ".0f", scale=1e-6),
        Column("processes", "processes", "d", brief=False),
    ),
)
