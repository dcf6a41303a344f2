"""Work of the mean eigenstrain of many inclusions on the functions of other inclusions, by sums over point sources.

Distant inclusions act by their mean eigenstrain. The field is evaluated at a few points of each target, with the part
of each function up to the second degree; the neglected part falls faster with distance by one power per degree. In
clusters of 50 balls (stiffness ratio 10, and voids), at least 4 radii apart, the error of the eigenstrain is 3e-4 to
6e-4 of the largest at degree 2 and 6e-4 to 1e-3 at degree 4. It is below the predicted error of these degrees (1e-2 to
2e-2, 7e-4 to 1.3e-3). First moments of the sources in addition reduced the error of degree 4 only to 5e-4 and 8e-4,
because the neglected field of higher functions dominates.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import TYPE_CHECKING, cast

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.halfspace.cloud import _Sources, _sum_of_sources, cloud_sources
from eigencontact.halfspace.potentials import PointSources
from eigencontact.halfspace.region_means import averaging_points

if TYPE_CHECKING:
    from eigencontact.solvers.polynomial_inclusions import PolynomialInclusions

__all__ = ["DistantWork"]

#: Degree of a function up to which the points of an inclusion integrate its products with a field of up to the third
#: degree exactly. They are not accurate for moments of higher functions.
_SMOOTHED_DEGREE = 2


class DistantWork:
    """Sums for one arrangement of inclusions; all must have point sources."""

    def __init__(self, system: PolynomialInclusions) -> None:
        self._system = system
        rules = [averaging_points(shape) for shape in system.regions]
        self._points = [points for points, _ in rules]
        self._starts = np.cumsum([0, *(len(points) for points in self._points)])
        self._sources = [cast("PointSources", cloud_sources(shape)) for shape in system.regions]
        self._weights: dict[Hashable, FloatArray] = {}
        self._means: dict[Hashable, FloatArray] = {}
        for number, (points, weights) in enumerate(rules):
            kind, basis = system.kinds[number], system.bases[number]
            if kind not in self._weights:
                values = self._smoothed(number, points)
                self._weights[kind] = values[: basis.size] * (weights * basis.volume)
                self._means[kind] = values @ weights

    def work(self, amplitudes: FloatArray, uniform: FloatArray) -> FloatArray:
        """Work on every function, ``(unknowns,)``, by amplitudes and uniform eigenstrains ``(6, inclusions)``."""
        system = self._system
        means = [
            np.concatenate((system.of(amplitudes, number), uniform[:, number])) @ self._means[kind]
            for number, kind in enumerate(system.kinds)
        ]
        stress = self._summed(self._sources, np.array(means), np.concatenate(self._points).T, system.threads)
        out = np.empty(system.size)
        for number, kind in enumerate(system.kinds):
            target_stress = stress[:, self._starts[number] : self._starts[number + 1]]
            start, end = system.starts[number : number + 2]
            out[start:end] = np.tensordot(self._weights[kind], target_stress, 2)
        return out

    def shares(self, source: int, targets: Sequence[int]) -> list[FloatArray]:
        """Contribution of one source to the work on some targets, ``(n, n + 6)`` by its functions."""
        kinds = self._system.kinds
        points = np.concatenate([self._points[target] for target in targets]).T
        by_unit = np.array([self._summed([self._sources[source]], unit[None], points, 1) for unit in np.eye(6)])
        ends = np.cumsum([len(self._points[target]) for target in targets])
        return [
            np.einsum("nim,uim->nu", self._weights[kinds[target]], target_stress) @ self._means[kinds[source]].T
            for target, target_stress in zip(targets, np.split(by_unit, ends[:-1], axis=2), strict=True)
        ]

    def _smoothed(self, number: int, points: FloatArray) -> FloatArray:
        """Low-degree part of the eigenstrain of each function at points of an inclusion, ``(n + 6, 6, points)``."""
        basis, shape = self._system.bases[number], self._system.shapes[number]
        degree = min(basis.degree, _SMOOTHED_DEGREE)
        places, weights = shape.density_rule((basis.degree + 3, basis.degree + 3, 2 * basis.degree + 6))
        low, full = shape.densities(degree, *places.T), shape.densities(basis.degree, *places.T)
        onto = np.linalg.solve((low * weights) @ low.T, (low * weights) @ full.T)
        values = np.einsum("nid,ed,em->nim", basis.eigenstrain, onto, shape.densities(degree, *points.T), optimize=True)
        return np.asarray(values)

    def _summed(
        self, sources: Sequence[PointSources], strains: FloatArray, points: FloatArray, threads: int | None
    ) -> FloatArray:
        x, y, z = (np.ascontiguousarray(values) for values in points)
        return _sum_of_sources(
            _Sources(sources, strains), (x, y, z), poisson_ratio=self._system.matrix.poisson_ratio, quantity="stress",
            space=self._system.space, threads=threads,
        )  # fmt: skip
