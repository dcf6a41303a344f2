"""Stress of hundreds of inclusions off the grid, each with its own eigenstrain, on 128 x 128 x 64 points.

Sums are hierarchical, to a tolerance of 1e-6 of the largest stress; on request (``--peers``) the sums without
expansions, to round-off, are measured beside them.

The inclusions sit in the cells of a coarse lattice, each moved at random within its cell, and do not overlap. The judge
is the sum over the inclusions one by one, by their own potentials, at some of the points.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial
from eigencontact_verification.benchmarks.codes import Code
from eigencontact_verification.benchmarks.measure import FloatArray, largest_error
from eigencontact_verification.reporting.table import Column

__all__ = ["BENCHMARK", "CASES", "METHODS", "POINTS", "lattice", "measure"]

#: Shapes of the inclusions.
CASES = ("spheres", "ellipsoids")
#: Field points along x, y and z.
POINTS = (128, 128, 64)
MATERIAL: dict[str, Any] = {"young_modulus": 210e9, "poisson_ratio": 0.3}
_KERNELS = ("cloud_kernels", "expansion_kernels")
METHODS = {
    name: Code(
        name=name,
        distribution="eigencontact",
        modules=("eigencontact.library.inclusions", *(f"eigencontact.halfspace.{kernels}" for kernels in _KERNELS)),
        settings=f"inclusion_field of a list of shapes, each with its own eigenstrain, tolerance {tolerance:g}",
    )
    for name, tolerance in (("eigencontact", 1e-6), ("one-by-one", 0.0))
}
# Points at which the judge sums.
_JUDGED = 200


def lattice(points: tuple[int, int, int]) -> FloatArray:
    """Points (n, 3) half a pitch below the surface and at every pitch beyond; the pitch is 1."""
    nx, ny, nz = points
    z, y, x = np.meshgrid(np.arange(nz) + 0.5, np.arange(ny) + 0.5, np.arange(nx) + 0.5, indexing="ij")
    return np.column_stack([x.ravel(), y.ravel(), z.ravel()])


def _inclusions(case: str, number: int, points: tuple[int, int, int]) -> tuple[list[Any], FloatArray]:
    """Shapes and their eigenstrains (number, 3, 3)."""
    from eigencontact import make

    rng, box = np.random.default_rng(number), np.array(points, dtype=float)
    counts = np.maximum(1, np.ceil(box * (number / box.prod()) ** (1 / 3))).astype(int)
    while counts.prod() < number:
        counts[np.argmax(box / counts)] += 1
    cell = box / counts
    places = rng.permutation(counts.prod())[:number]
    corners = np.column_stack(np.unravel_index(places, counts)) * cell
    radius = 0.3 * cell.min()
    centers = corners + radius + rng.random((number, 3)) * (cell - 2 * radius)
    shapes = [
        make("sphere", center=tuple(center), radius=radius)
        if case == "spheres"
        else make("ellipsoid", center=tuple(center), semi_axes=(radius, 0.7 * radius, 0.5 * radius))
        for center in centers
    ]
    strains = rng.standard_normal((number, 3, 3))
    return shapes, strains + strains.swapaxes(1, 2)


def measure(code: Code, task: Task, points: tuple[int, int, int] = POINTS) -> Sample:
    """Compute once in a fresh process, and judge."""
    from eigencontact import inclusion_field

    shapes, strains = _inclusions(task.case, task.n, points)
    at = lattice(points)

    def judge(field: FloatArray) -> dict[str, Any]:
        chosen = np.random.default_rng(1).choice(len(at), min(_JUDGED, len(at)), replace=False)
        expected = np.zeros((chosen.size, 3, 3))
        for shape, strain in zip(shapes, strains, strict=True):
            expected += inclusion_field(shape, strain, at[chosen], quantity="stress", **MATERIAL)
        return {"points": len(at), "error": largest_error(field[chosen], expected)}

    tolerance = 0.0 if code.name == "one-by-one" else 1e-6
    call = partial(inclusion_field, shapes, strains, at, quantity="stress", tolerance=tolerance, **MATERIAL)
    return Trial(call=call, judge=judge).run(task, warm=0)


BENCHMARK = Benchmark(
    name="cloud",
    help="hundreds of inclusions off the grid",
    measure=measure,
    worst=("error",),
    derive=lambda task, row: {"ns_per_pair": 1e9 * row["first_min_s"] / (task.n * row["points"])},
    methods=METHODS,
    peers=("one-by-one",),
    cases=CASES,
    sizes=(50, 500),
    unit="INCLUSIONS",
    columns=(
        Column("inclusions", "n", "d"),
        Column("sum", "code"),
        Column("shape", "case"),
        Column("points", "points", "d"),
        Column("stress, all set-up included [s]", "first_s", ".3g"),
        Column("min [s]", "first_min_s", ".3g", brief=False),
        Column("ns / inclusion and point", "ns_per_pair", ".3g"),
        Column("peak [MB]", "peak_bytes", ".0f", scale=1e-6),
        Column("difference from the sum one by one", "error", ".1e"),
        Column("processes", "processes", "d", brief=False),
    ),
)
