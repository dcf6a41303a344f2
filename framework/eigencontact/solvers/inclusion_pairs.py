"""Interactions of whole inclusions: self, near pairs by all functions, distant pairs by mean eigenstrains."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from eigencontact.core.array_types import FloatArray
from eigencontact.halfspace.cloud import cloud_sources
from eigencontact.halfspace.moments import stress_integrals
from eigencontact.halfspace.region_means import is_ball
from eigencontact.solvers.distant_work import DistantWork
from eigencontact.solvers.inclusion_reach import counts_between

if TYPE_CHECKING:
    from eigencontact.solvers.polynomial_inclusions import PolynomialInclusions

__all__ = ["ALIKE", "InclusionPairs"]

#: Tolerance for equal offsets, in radii.
ALIKE = 1e-9
#: Smallest number of inclusions for which distant ones act by their mean eigenstrain; distance in radii of the largest.
_MIN_REGIONS, _NEAR_DISTANCE = 40, 5.0


@dataclass(slots=True)
class _Blocks:
    """Equal interactions: one matrix for many pairs of a target and a source."""

    matrix: FloatArray
    targets: list[int] = field(default_factory=list)
    sources: list[int] = field(default_factory=list)


class InclusionPairs:
    """Left side of the system for one arrangement of inclusions, ``∫ x_b : (τ_a - A x_a) dV``.

    Attributes
    ----------
    self_interaction : dict
        Self-interaction matrix ``(n, n + 6)`` by the key of an inclusion, with its image; the last six columns are
        those of uniform eigenstrains.
    """

    def __init__(self, system: PolynomialInclusions) -> None:
        self._system = system
        self.self_interaction: dict[Hashable, FloatArray] = {}
        self._distant = None
        if len(system.regions) > _MIN_REGIONS and all(cloud_sources(shape) is not None for shape in system.regions):
            self._distant = DistantWork(system)
        self._blocks = list(self._interactions().values())

    def apply(self, amplitudes: FloatArray, uniform: FloatArray) -> FloatArray:
        """Left side ``(unknowns,)`` for amplitudes and uniform eigenstrains ``(6, inclusions)``."""
        system, out = self._system, np.zeros(self._system.size)
        for block in self._blocks:
            rows, columns = block.matrix.shape[0], block.matrix.shape[1] - 6
            sources, targets = np.array(block.sources), np.array(block.targets)
            polynomial = amplitudes[system.starts[sources] + np.arange(columns)[:, None]]
            eigenstrains = np.concatenate((polynomial, uniform[:, sources]))
            np.add.at(out, system.starts[targets] + np.arange(rows)[:, None], block.matrix @ eigenstrains)
        if self._distant is not None:
            out -= self._distant.work(amplitudes, uniform)
        return out

    def _interactions(self) -> dict[Hashable, _Blocks]:
        """Matrices of near pairs, the self-interactions first; equal pairs are computed once."""
        blocks: dict[Hashable, _Blocks] = {}
        for number, basis in enumerate(self._system.bases):
            key = self._system.key_of(number)
            if key not in self.self_interaction:
                work = self._stress_work(number, number)[: basis.size]
                self.self_interaction[key] = -work
                self.self_interaction[key][:, : basis.size] += basis.work[:, : basis.size]
                blocks[key] = _Blocks(self.self_interaction[key])
            blocks[key].targets.append(number)
            blocks[key].sources.append(number)
        for target, source in self._near_pairs():
            self._add_pair(blocks, target, source)
        if self._distant is not None:
            self._take_out(blocks.values(), self._distant)
        return blocks

    def _near_pairs(self) -> list[tuple[int, int]]:
        """Pairs (lower, higher) that interact by all functions; other pairs interact by mean eigenstrains."""
        count = len(self._system.shapes)
        if self._distant is None:
            return [(target, source) for source in range(count) for target in range(source)]
        reach = _NEAR_DISTANCE * float(self._system.radii.max())
        tree = cKDTree(self._system.centers)
        pairs = {(int(low), int(high)) for low, high in tree.query_pairs(reach)}
        if self._system.space == "half":
            images = cKDTree(self._system.centers * (1.0, 1.0, -1.0)).query_ball_tree(tree, reach)
            pairs |= {(min(i, j), max(i, j)) for i, near in enumerate(images) for j in near if i != j}
        return sorted(pairs)

    @staticmethod
    def _take_out(blocks: Iterable[_Blocks], distant: DistantWork) -> None:
        """Subtract the near pairs from the sum over mean eigenstrains, which contains all pairs."""
        by_source: dict[int, list[_Blocks]] = {}
        for block in blocks:
            by_source.setdefault(block.sources[0], []).append(block)
        for source, members in by_source.items():
            shares = distant.shares(source, [block.targets[0] for block in members])
            for block, share in zip(members, shares, strict=True):
                block.matrix = block.matrix + share

    def _add_pair(self, blocks: dict[Hashable, _Blocks], target: int, source: int) -> None:
        """Add both directions of a pair: one matrix is the transpose of the other."""
        scale = ALIKE * max(self._system.radii[target], self._system.radii[source])
        offset = np.round((self._system.centers[source] - self._system.centers[target]) / scale)
        depth = round(self._system.centers[target, 2] / scale) if self._system.space == "half" else 0
        key = (self._system.kinds[target], self._system.kinds[source], offset.tobytes(), depth)
        forward_key, backward_key = (*key, "there"), (*key, "back")
        if forward_key not in blocks:
            work = -self._stress_work(target, source)
            blocks[forward_key] = _Blocks(work[: self._system.bases[target].size])
            blocks[backward_key] = _Blocks(np.ascontiguousarray(work[:, : self._system.bases[source].size].T))
        blocks[forward_key].targets.append(target)
        blocks[forward_key].sources.append(source)
        blocks[backward_key].targets.append(source)
        blocks[backward_key].sources.append(target)

    def _stress_work(self, target: int, source: int) -> FloatArray:
        """Integrals over the target of its functions with the stress of the source's functions, ``(n + 6, n + 6)``."""
        system = self._system
        first, second = system.bases[target], system.bases[source]
        distance = 2.0 * system.centers[source, 2] if target == source else self._distance(target, source)
        reach = system.halves[source] if target == source else system.radii[source]
        within = system.halves[target] if target == source else system.radii[target]
        degree = max(first.degree, second.degree)
        counts = counts_between(distance, within, reach, degree, own_field=target == source and system.space == "full")
        if is_ball(system.regions[target]):
            # External stress has terms r^l and r^(l+2) times harmonics of degree l; only l up to the degree of the
            # density contribute.
            counts = (degree + 3, *counts[1:])
            if target == source:
                counts = (*counts[:2], 2 * degree + 8)  # the image of a ball is axisymmetric about z
        points, weights = system.shapes[target].density_rule(counts)
        x, y, z = points.T
        densities = system.shapes[target].densities(first.degree, x, y, z)
        moments = stress_integrals(
            system.shapes[source], second.span, (x, y, z), densities * weights, degree=second.degree,
            poisson_ratio=system.matrix.poisson_ratio, space=system.space, threads=system.threads,
        )  # fmt: skip
        work = np.einsum("nid,kid->nk", first.span, moments, optimize=True)
        return np.asarray(first.mix @ work @ second.mix.T)

    def _distance(self, target: int, source: int) -> float:
        """Distance between the centres of two inclusions, or to the other's image if that is smaller."""
        offset = self._system.centers[source] - self._system.centers[target]
        gap = float(np.linalg.norm(offset))
        if self._system.space == "half":
            above = self._system.centers[source, 2] + self._system.centers[target, 2]
            gap = min(gap, float(np.hypot(np.hypot(offset[0], offset[1]), above)))
        return gap
