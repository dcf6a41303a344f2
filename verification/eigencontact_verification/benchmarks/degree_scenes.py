"""Random scenes with whole inhomogeneities below a contact, and the true errors of a degree beside the stated ones.

A rigid sphere presses on a body with one ball, two balls or an ellipsoid. Lengths are in Hertz contact radii of the
bare body, pressure in Hertz pressures. The truth is a much higher degree on the same grid, so the grid's own error is
no part of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from eigencontact_verification.benchmarks.measure import FloatArray

__all__ = ["KINDS", "PRESSURE", "RADIUS", "SOLVED", "E", "Errors", "judged", "random_scenes", "scene_of"]

KINDS = ("ball", "two balls", "ellipsoid")
E, NU, LOAD = 210e9, 0.3, 0.65
#: Radius of the sphere [m], of the contact without inhomogeneities [m], and the largest pressure of that one [Pa].
SPHERE = 105e-6
RADIUS = float((0.75 * LOAD * SPHERE / (E / (1 - NU**2))) ** (1 / 3))
PRESSURE = float(1.5 * LOAD / (np.pi * RADIUS**2))
#: Error in Hertz pressures, and in parts of the eigenstrain, that the tolerance of the solution leaves.
SOLVED = 1e-6
#: Cells at the edge of the contact that are not judged.
_EDGE = 2


@dataclass(frozen=True, kw_only=True, slots=True)
class Errors:
    """Errors of one degree.

    Attributes
    ----------
    pressure : (float, float)
        Stated and true, in Hertz pressures, two cells or more from the edge of the contact.
    eigenstrain : (float, float)
        Stated and true: root mean square over the worst inclusion in parts of that of the largest eigenstrain.
    foretold : (float, float)
        Before the run, and the true error of the eigenstrain of the worst inclusion in parts of the strain that the
        contact without inhomogeneities causes there.
    """

    pressure: tuple[float, float]
    eigenstrain: tuple[float, float]
    foretold: tuple[float, float]


def scene_of(inclusions: Sequence[dict[str, Any]], resolution: dict[str, Any], cells: int) -> dict[str, Any]:
    """Contact of a rigid sphere on a window of 2.6 contact radii."""
    return {
        "body1": {"young-modulus": E, "poisson-ratio": NU},
        "geometry": {"type": "sphere", "radius": SPHERE},
        "grid": {"cells": cells, "size": [2.6 * RADIUS, 2.6 * RADIUS]},
        "steps": {"normal-load": LOAD},
        "numerics": {"tolerance": 1e-7, "threads": 1, **resolution},
        "inclusions": list(inclusions),
        "output": {"pictures": False},
    }


def random_scenes(kind: str, count: int, seed: int = 2026) -> list[list[dict[str, Any]]]:
    """Inclusions of `count` scenes of a kind.

    Radii .1 to .5, ligament to the surface .1 to 3 radii (uniform in its logarithm), middle up to .6 from the axis;
    a fourth each void, rigid (1e6), softer (.1 to .6) and stiffer (1.6 to 10). A second ball lies .1 to 2 radii of the
    smaller from the first. Ellipsoids have axes of .5 to 1 times the largest, turned at random.
    """
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    return [_inclusions(rng, kind) for _ in range(count)]


def _inclusions(rng: np.random.Generator, kind: str) -> list[dict[str, Any]]:
    radius, angle = rng.uniform(0.1, 0.5), rng.uniform(0, 2 * np.pi)
    away, ligament = rng.uniform(0.0, 0.6), _between(rng, 0.1, 3.0)
    center = np.array([away * np.cos(angle), away * np.sin(angle), radius * (1.0 + ligament)])
    if kind == "ellipsoid":
        axes = radius * np.array([1.0, *rng.uniform(0.5, 1.0, 2)])
        turned = rng.uniform(-90.0, 90.0, 3).tolist()
        sizes = {"semi-axes": (axes * RADIUS).tolist(), "rotation": [f"{value} deg" for value in turned]}
        return [{"type": kind, "center": (center * RADIUS).tolist(), **sizes, "material": _material(rng)}]
    balls = [(center, radius)]
    while kind == "two balls" and len(balls) == 1:
        second, gap = rng.uniform(0.1, 0.5), _between(rng, 0.1, 2.0)
        way = rng.standard_normal(3)
        second_center = center + way / np.linalg.norm(way) * (radius + second + gap * min(radius, second))
        if second_center[2] > 1.1 * second:
            balls.append((second_center, second))
    return [
        {"type": "sphere", "center": (at * RADIUS).tolist(), "radius": size * RADIUS, "material": _material(rng)}
        for at, size in balls
    ]


def _matrix() -> Any:
    from eigencontact.core.material import Material

    return Material(young_modulus=E, poisson_ratio=NU)


def _between(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _material(rng: np.random.Generator) -> dict[str, Any]:
    choice = rng.integers(4)
    if choice == 0:
        return {"void": True}
    ratio = (1e6, _between(rng, 0.1, 0.6), _between(rng, 1.6, 10.0))[choice - 1]
    return {"young-modulus": ratio * E, "poisson-ratio": NU}


def judged(inclusions: Sequence[dict[str, Any]], degrees: Sequence[int], truth: int, cells: int) -> dict[int, Errors]:
    """Errors of degrees, by a run of degree `truth`."""
    runs = {degree: _Run.of(inclusions, degree, cells) for degree in (*degrees, truth)}
    right = runs.pop(truth)
    load = right.strain_of_load()
    return {degree: run.errors(right, load) for degree, run in runs.items()}


@dataclass(frozen=True, kw_only=True, slots=True)
class _Run:
    """Judged results of a run: pressure (ny, nx), eigenstrain (6, densities, n), errors; its shapes."""

    pressure: FloatArray
    eigenstrain: FloatArray
    stated: tuple[float, float]
    foretold: float
    shapes: Sequence[Any]
    degree: int

    @classmethod
    def of(cls, inclusions: Sequence[dict[str, Any]], degree: int, cells: int) -> _Run:
        import eigencontact as ec

        plan: Any = ec.plan(scene_of(inclusions, {"inclusion-resolution": {"whole": degree}}, cells))
        sources = plan.model.cells.inhomogeneities
        result = ec.run(plan)
        numbers, data = result.summary, result.dataset
        name = next(name for name in data if data[name].attrs.get("role") == "history")
        return cls(
            pressure=data["pressure"][-1].values / PRESSURE,
            eigenstrain=data[name][-1].values,
            stated=(numbers["degree_pressure_error"] / PRESSURE, numbers["inclusion_degree_error"]),
            foretold=max(source.degree.error for source in sources),
            shapes=[source.shape for source in sources],
            degree=degree,
        )

    def sizes(self, eigenstrain: FloatArray) -> FloatArray:
        """Root mean square over each inclusion of an eigenstrain (6, densities, n)."""
        out = []
        for number, shape in enumerate(self.shapes):
            points, weights = shape.density_rule((self.degree + 2, self.degree + 2, 2 * self.degree + 3))
            values = eigenstrain[..., number] @ shape.densities(self.degree, *points.T)
            out.append(np.sqrt((values**2).sum(axis=0) @ weights / weights.sum()))
        return np.array(out)

    def strain_of_load(self) -> FloatArray:
        """Root mean square over each inclusion of the strain of the bare body under the contact."""
        import eigencontact as ec
        from eigencontact.core.tensors import to_mandel
        from eigencontact.solvers.cell_conditions import compliance

        rules = [shape.density_rule((4, 4, 7)) for shape in self.shapes]
        points = np.concatenate([points for points, _ in rules])
        stress = {"name": "rule", "shape": "points", "points": points.tolist()}
        bare = scene_of([], {}, 41) | {"stress": [stress]}
        values = to_mandel(ec.run(bare).dataset["rule_stress"][-1].values.reshape(6, -1))
        strain = compliance(_matrix()) @ values
        out, first = [], 0
        for places, weights in rules:
            strain_of_rule = strain[:, first : first + len(places)]
            out.append(np.sqrt((strain_of_rule**2).sum(axis=0) @ weights / weights.sum()))
            first += len(places)
        return np.array(out)

    def errors(self, truth: _Run, load: FloatArray) -> Errors:
        """Errors of this run."""
        from scipy.ndimage import binary_erosion

        loaded = binary_erosion((self.pressure > 0.0) & (truth.pressure > 0.0), iterations=_EDGE)
        pressure = float(np.abs(self.pressure - truth.pressure)[loaded].max(initial=0.0))
        change = truth.eigenstrain.copy()
        change[:, : self.eigenstrain.shape[1]] -= self.eigenstrain
        missed = truth.sizes(change)
        return Errors(
            pressure=(self.stated[0], pressure),
            eigenstrain=(self.stated[1], float(missed.max() / truth.sizes(truth.eigenstrain).max())),
            foretold=(self.foretold, float((missed / load).max())),
        )
