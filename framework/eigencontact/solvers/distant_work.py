"""Work of the mean eigenstrain of many inclusions on the functions of each other, by sums over point sources.

What is far acts by its mean eigenstrain: what higher degrees add falls faster by a power of the distance per degree.
Its stress is taken at a few points of each target, which is exact there up to degree 5 with the weights.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import TYPE_CHECKING, cast

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.halfspace.cloud import _Sources, _sum_of_sources, cloud_sources
from eigencontact.halfspace.potentials import HasPotentials
from eigencontact.halfspace.region_means import averaging_points

if TYPE_CHECKING:
    from eigencontact.solvers.polynomial_inclusions import PolynomialInclusions

__all__ = ["DistantWork"]


class DistantWork:
    """Sums over one arrangement of inclusions, all with point sources."""

    def __init__(self, system: PolynomialInclusions) -> None:
        self._system = system
        shapes = [cast("HasPotentials", shape) for shape in system.shapes]
        self._far = [cloud_sources(shape) for shape in shapes]
        rules = [averaging_points(shape) for shape in shapes]
        self._points = [points for points, _ in rules]
        self._starts = np.cumsum([0, *(len(points) for points in self._points)])
        self._weights: dict[Hashable, FloatArray] = {}
        for number, (points, weights) in enumerate(rules):
            if system.kinds[number] not in self._weights:
                basis, shape = system.bases[number], system.shapes[number]
                densities = shape.densities(basis.degree, *points.T) * weights * basis.volume
                self._weights[system.kinds[number]] = np.einsum("nid,dm->nim", basis.unknowns, densities)

    def work(self, means: FloatArray) -> FloatArray:
        """Work on every function, ``(unknowns,)``, by mean eigenstrains ``(n, 6)``."""
        stress = self._summed(list(range(len(means))), means, np.concatenate(self._points).T, self._system.threads)
        out = np.empty(self._system.size)
        for number, kind in enumerate(self._system.kinds):
            here = stress[:, self._starts[number] : self._starts[number + 1]]
            start, end = self._system.starts[number : number + 2]
            out[start:end] = np.tensordot(self._weights[kind], here, 2)
        return out

    def shares(self, source: int, targets: Sequence[int]) -> list[FloatArray]:
        """Share of one source in the work on each of some targets, ``(n, n + 6)`` by its functions."""
        points = np.concatenate([self._points[target] for target in targets]).T
        by_unit = np.array([self._summed([source], unit[None], points, 1) for unit in np.eye(6)])
        ends = np.cumsum([len(self._points[target]) for target in targets])
        mean = self._system.bases[source].mean
        return [
            np.einsum("nim,uim->nu", self._weights[self._system.kinds[target]], part) @ mean
            for target, part in zip(targets, np.split(by_unit, ends[:-1], axis=2), strict=True)
        ]

    def _summed(self, sources: list[int], strains: FloatArray, points: FloatArray, threads: int | None) -> FloatArray:
        x, y, z = (np.ascontiguousarray(values) for values in points)
        regions = [far for source in sources if (far := self._far[source]) is not None]
        return _sum_of_sources(
            _Sources(regions, strains), (x, y, z), poisson_ratio=self._system.matrix.poisson_ratio, quantity="stress",
            space=self._system.space, threads=threads,
        )  # fmt: skip
