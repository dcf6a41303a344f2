"""Which resolution of an inhomogeneity gives which accuracy: a ball under a contact, by degree and by cells.

A rigid sphere presses above the middle of a ball of 0.3 Hertz contact radii. The judged value is the pressure in the
middle of the contact, the most sensitive one. Each resolution is compared with degree 12, or 10 from 1.5 radii below
the surface on, on the same grid, so errors are those of the inhomogeneity alone. Cells share the columns of the grid:
a grid for each of their sizes; degrees run on that of 8 cells a radius. On the other grids degree 8 is corrected by its
error on this one. Seconds are those of the processor for a whole run in memory on one thread, after an earlier run in
the same process: other work on the machine hardly changes them.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, timed
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.benchmarks.degree_scenes import PRESSURE, RADIUS, E, scene_of
from eigencontact_verification.reporting.table import Column, Row

__all__ = ["BENCHMARK", "CELLS", "DEGREES", "measure", "pressure"]

DEGREES, CELLS = (0, 2, 3, 4, 5, 6, 7, 8), (4, 8, 12)
DEPTHS = (1.02, 1.05, 1.2, 1.5, 2.0, 3.0)
MATERIALS: dict[str, dict[str, Any]] = {
    "void": {"void": True},
    **{f"ratio {ratio:g}": {"young-modulus": ratio * E, "poisson-ratio": 0.3} for ratio in (0.5, 2.0, 10.0)},
}
METHODS = ours("tolerance 1e-6, one thread, in memory", "pyfftw", "scipy.fft", "eigencontact.app")
#: Radius of the ball in contact radii, and cells a radius of the grid that degrees run on.
_BALL, _CELLS = 0.3, 8
#: Degree that judges, closer to the surface than a depth in radii and from it on.
_DEEP, _REFERENCES = 1.5, (12, 10)


def pressure(material: str, depth: float, cells: int, degree: int | None = None) -> tuple[float | None, float | None]:
    """Pressure in the middle in Hertz pressures, and processor seconds; None where a run does not converge.

    Parameters
    ----------
    material : str
        One of `MATERIALS`.
    depth : float
        Of the middle of the ball in its radii.
    cells : int
        Of the grid per radius of the ball.
    degree : int, optional
        None for cells as high as they are wide.
    """
    import eigencontact as ec
    from eigencontact.errors import NotConverged

    pitch = _BALL * RADIUS / cells
    across = 2 * round(1.3 * cells / _BALL) + 1
    by_cells = {"inclusion-resolution": "cells", "inclusion-pitch": pitch}
    resolution = by_cells if degree is None else {"inclusion-resolution": {"whole": degree}}
    ball = {
        "type": "sphere",
        "center": [0.0, 0.0, depth * _BALL * RADIUS],
        "radius": _BALL * RADIUS,
        "material": MATERIALS[material],
    }
    scene = scene_of([ball], {**resolution, "tolerance": 1e-6}, across)
    scene["grid"] = {"cells": across, "size": [across * pitch] * 2}
    try:
        result, _wall, seconds = timed(partial(ec.run, scene))
    except NotConverged:
        return None, None
    return float(result.dataset["pressure"][-1].values[across // 2, across // 2]) / PRESSURE, seconds


def measure(_code: Code, task: Task) -> Sample:
    """All resolutions of one case."""
    material, _, depth = task.case.rpartition(", ")
    reference = _REFERENCES[float(depth) >= _DEEP]
    results: dict[str, tuple[tuple[float | None, float | None], float | None]] = {}
    pressure(material, float(depth), _CELLS, min(DEGREES))
    right = pressure(material, float(depth), _CELLS, reference)[0]
    for degree in DEGREES:
        results[f"degree {degree}"] = pressure(material, float(depth), _CELLS, degree), right
    highest = results[f"degree {max(DEGREES)}"][0][0]
    for cells in CELLS:
        highest_of_cells = highest if cells == _CELLS else pressure(material, float(depth), cells, max(DEGREES))[0]
        corrected = (
            None if highest_of_cells is None or right is None or highest is None else highest_of_cells + right - highest
        )
        results[f"cells {cells}"] = pressure(material, float(depth), cells), corrected
    sample: Sample = {"status": "ok", "material": material, "depth": float(depth), "right": right}
    for name, ((value, seconds), correct) in results.items():
        missed = None if value is None or correct is None else abs(value - correct)
        sample |= {name: missed, f"{name}_s": seconds}
    return sample


def draw(rows: list[Row], file: Path) -> None:
    """Error against seconds: one panel for each depth, one colour for each material."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    depths = sorted({row["depth"] for row in rows})
    figure, axes = plt.subplots(
        1, len(depths), figsize=(2.6 * len(depths), 3.9), sharey=True, sharex=True, squeeze=False, layout="constrained"
    )
    for panel, depth in zip(axes[0], depths, strict=True):
        for number, material in enumerate(MATERIALS):
            row = next((row for row in rows if (row["depth"], row["material"]) == (depth, material)), None)
            if row is not None:
                for kind, line, sizes in (("degree", "o-", DEGREES), ("cells", "s--", CELLS)):
                    measured = [size for size in sizes if row[f"{kind} {size}"] is not None]
                    seconds, errors = ([row[f"{kind} {size}{end}"] for size in measured] for end in ("_s", ""))
                    panel.loglog(seconds, errors, line, color=f"C{number}", mfc="w" if kind == "cells" else None, ms=4)
        panel.set(title=f"d / r = {depth:g}", xlabel="processor seconds of the run")
        panel.grid(alpha=0.3)
    axes[0, 0].set(ylabel="error of p(0) / Hertz pressure", ylim=(1e-7, 5.0))
    handles = [plt.Line2D([], [], color=f"C{number}", label=name) for number, name in enumerate(MATERIALS)]
    handles.append(plt.Line2D([], [], color="k", marker="o", ls="-", label=f"degree {', '.join(map(str, DEGREES))}"))
    cells = f"{', '.join(map(str, CELLS))} cells a radius"
    handles.append(plt.Line2D([], [], color="k", marker="s", ls="--", mfc="w", label=cells))
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    figure.savefig(file, dpi=150)
    plt.close(figure)


def _columns(kind: str, sizes: Sequence[int], unit: str) -> list[Column]:
    return [Column(f"{kind} {size}{unit}" if unit else f"{kind} {size}", f"{kind} {size}", ".1e") for size in sizes]


BENCHMARK = Benchmark(
    name="degrees",
    help="a ball under a contact, by the degree of its eigenstrain and by cells",
    measure=measure,
    methods=METHODS,
    cases=tuple(f"{material}, {depth:g}" for material in MATERIALS for depth in DEPTHS),
    draw=draw,
    columns=(
        Column("ball", "material"),
        Column("d / r", "depth", "g"),
        Column("p(0) / Hertz", "right", ".4f"),
        *_columns("degree", DEGREES, ""),
        *_columns("cells", CELLS, " / r"),
        *(Column(f"degree {degree} [s]", f"degree {degree}_s", ".2f") for degree in DEGREES[1:]),
        *(Column(f"cells {cells} / r [s]", f"cells {cells}_s", ".2f") for cells in CELLS),
    ),
)
