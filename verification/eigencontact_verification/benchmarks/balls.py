"""Stress in and beside a ball of other constants, cut into cells, against Eshelby's closed form.

A ball of radius 1 um that lies anyhow on its cells, r times as stiff as the body, with a prestrain along x, in full
space. The stress is stored at points of the scene; errors are roots of mean squares by the largest exact stress.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.oracles.eshelby_sphere import isotropic_stiffness, sphere_in_body, stress_about_sphere
from eigencontact_verification.reporting.table import Column

__all__ = ["BENCHMARK", "RATIOS", "errors_of_ball", "measure"]

RATIOS = (0.01, 0.1, 2.0, 10.0, 100.0)
_YOUNG, _NU, _RADIUS, _STRAIN = 210e9, 0.3, 1e-6, 1e-3
_CENTER = np.array([0.21, -0.13, 3.0]) * _RADIUS
_PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


@cache
def _places(n: int) -> dict[str, Any]:
    """Points ``(150, 3)`` by name, in radii from the middle; "inner" and "outer" within half a cell of the boundary."""
    rng = np.random.default_rng(1)
    way, fraction = rng.normal(size=(150, 3)), rng.uniform(size=(150, 1))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    return {
        "core": way * 0.5 * fraction ** (1 / 3),
        "inside": way * (0.5 + 0.5 * fraction),
        "inner": way * (1.0 - fraction / n),
        "outer": way * (1.0 + fraction / n),
        "around": way * (1.0 + 0.4 * fraction),
    }


def _exact(ratio: float, points: Any) -> Any:
    """Stress ``(6, n)`` [Pa], plain components."""
    prestrain = np.diag([_STRAIN, 0.0, 0.0])
    inner, eigenstrain = sphere_in_body(
        isotropic_stiffness(ratio * _YOUNG, _NU), _YOUNG, _NU, np.zeros((3, 3)), prestrain
    )
    stress = np.repeat(inner[:, :, None], len(points), axis=2)
    outside = np.linalg.norm(points, axis=1) > 1.0
    stress[:, :, outside] = stress_about_sphere(eigenstrain, _YOUNG, _NU, points[outside])
    return np.array([stress[pair] for pair in _PAIRS])


def _size(stress: Any) -> Any:
    return np.sqrt((stress[:3] ** 2).sum(axis=0) + 2.0 * (stress[3:] ** 2).sum(axis=0))


def _stored(ratio: float, n: int, points: Any) -> Any:
    import eigencontact as ec

    pitch = 2.0 * _RADIUS / n
    ball = {
        "type": "sphere",
        "center": _CENTER.tolist(),
        "radius": _RADIUS,
        "material": {"young-modulus": ratio * _YOUNG, "poisson-ratio": _NU},
        "eigenstrain": [_STRAIN, 0.0, 0.0],
    }
    scene = {
        "body1": {"young-modulus": _YOUNG, "poisson-ratio": _NU},
        "grid": {"cells": 2 * (n // 2) + 8, "spacing": [pitch, pitch]},
        "numerics": {"half-space": "full-space", "inclusion-pitch": pitch},
        "inclusions": ball,
        "stress": {"name": "some", "shape": "points", "points": (points * _RADIUS + _CENTER).tolist()},
        "output": {"pictures": False},
    }
    return ec.run(scene).dataset.some_stress.values[-1]


def errors_of_ball(ratio: float, n: int) -> dict[str, float]:
    """Error of the stress at the points of each name, for `n` cells a diameter."""
    places = _places(n)
    points = np.concatenate(list(places.values()))
    exact = _exact(ratio, points)
    errors = _size(_stored(ratio, n, points) - exact) / _size(exact).max()
    groups = np.split(errors, len(places))
    return {name: float(np.sqrt(np.mean(group**2))) for name, group in zip(places, groups, strict=True)}


def measure(_: Code, task: Task) -> Sample:
    """Measure one ratio and number of cells."""
    ratio = float(task.case.split()[1])
    return Trial(call=lambda: errors_of_ball(ratio, task.n), judge=dict).run(task, warm=0)


BENCHMARK = Benchmark(
    name="balls",
    help="stress in and beside a ball in cells",
    measure=measure,
    methods=ours("full space, tolerance 1e-6", "pyfftw", "scipy.fft", "eigencontact.app"),
    cases=tuple(f"ratio {ratio:g}" for ratio in RATIOS),
    sizes=(8, 12, 16, 24),
    unit="CELLS-OF-DIAMETER",
    columns=(
        Column("case", "case"),
        Column("cells of diameter", "n", "d"),
        Column("up to half the radius", "core", ".2%"),
        Column("beyond, inside", "inside", ".2%"),
        Column("half a cell inside the boundary", "inner", ".2%"),
        Column("half a cell outside", "outer", ".2%"),
        Column("up to 0.4 radii outside", "around", ".2%"),
        Column("run [s]", "first_s", ".2g"),
    ),
)
