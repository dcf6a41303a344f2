"""Route for shapes with potentials: closed forms at the points; many shapes are summed as a cloud of point sources."""

from __future__ import annotations

from functools import cached_property
from typing import cast

import numpy as np

from eigencontact.convolution.pace import timed
from eigencontact.core.array_types import FloatArray
from eigencontact.core.parallel import working_threads
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.routes.route import Route
from eigencontact.halfspace.potentials import HasFarField, HasPotentials
from eigencontact.model.sources import Source

__all__ = ["ClosedForms"]


#: Smallest number of closed forms that are summed as a cloud of point sources, if this is exact.
_CLOUD = 16
#: Number of points for the timing of the closed form of a shape, spread over the requested points.
_SAMPLE = 1024
#: Gain by a second thread: about eighty short numpy calls per chunk wait for the interpreter.
_GAIN = 0.2
#: Seconds per pair of a point source and a field point on one thread, and seconds to load the compiled loop.
_PAIR, _LOAD = 2e-8, 0.5
#: Fraction of the pairs that remain if distant regions contribute by expansions.
_EXPANDED = 0.06

_TIMES: dict[tuple[object, ...], float] = {}


class ClosedForms(Route):
    """Field of a uniform eigenstrain in each of some shapes, ``(6, n)``, or of degree 0 as stored, ``(6, 1, n)``."""

    @property
    def words(self) -> str:
        """See `Route.words`."""
        return self.sources[0].how

    @property
    def cost(self) -> Cost:
        """See `Route.cost`; only the field is stored, so every step costs the same."""
        count, workers = int(np.prod(self.lattice.shape)), working_threads(self.half_space.threads, _GAIN)
        memory = 8.0 * count * (3 if self.quantity == "displacement" else 6) * 3 + 2e6
        if len(self.sources) >= _CLOUD:
            seconds = sum(self._cloud_pace(source) for source in self.sources)
            return Cost(memory=memory, seconds_per_step=_LOAD + count * seconds / workers)
        seconds = sum(self._point_pace(source) for source in self.sources)
        return Cost(memory=memory, seconds_per_step=count * seconds / workers + 1e-3 * len(self.sources))

    def _cloud_pace(self, source: Source) -> float:
        """Time per point on one thread [s] for one of many shapes: point sources far away, potentials near it."""
        from eigencontact.halfspace.cloud import cloud_sources, is_large, relaxed

        shape = cast("HasPotentials", source.shape)
        if cloud_sources(shape) is None:
            return self._point_pace(source)
        finest, points = cast("HasFarField", shape).far_field(), self._some_points()
        tolerance, expanded = self.half_space.numerics.cloud_tolerance, np.inf
        if is_large(len(self.sources), int(np.prod(self.lattice.shape)), tolerance):
            finest = relaxed(finest, tolerance)
            expanded = finest.reach + self._node_radius(tolerance) if self._expands else np.inf
        distance, above = (
            np.linalg.norm([x - c for x, c in zip(points, finest.center * (1.0, 1.0, side), strict=True)], axis=0)
            for side in (1.0, -1.0)
        )
        used = np.full(distance.size, len(finest.volumes))
        for far in reversed(finest.levels):
            used[distance >= far.distance] = len(far.volumes)
        shares = np.where(distance > expanded, _EXPANDED, 1.0)
        images = 0.0 if self.half_space.full else 2.0 * float(np.mean(above < finest.distance))
        near = float(np.mean(distance < finest.distance)) + images
        return float((used * shares).mean()) * _PAIR + (near * self._point_pace(source) if near else 0.0)

    @cached_property
    def _expands(self) -> bool:
        """Whether distant regions contribute by expansions."""
        from eigencontact.halfspace.cloud import cloud_sources, expansions_pay

        regions = [cloud_sources(cast("HasPotentials", source.shape)) for source in self.sources]
        return expansions_pay([far for far in regions if far is not None], int(np.prod(self.lattice.shape)))

    def _node_radius(self, tolerance: float) -> float:
        """Distance [m] from which the expansion of a region is valid at the smallest nodes of points."""
        from eigencontact.halfspace.expansions import APART, expansion_size

        points = self._some_points()
        room = float(np.prod([np.ptp(values) for values in points])) / int(np.prod(self.lattice.shape))
        return (1.0 + 1.0 / APART) * float(np.cbrt(2.0 * expansion_size(tolerance) * room))

    def _point_pace(self, source: Source) -> float:
        """Measured time per point on one thread [s]; equal shapes at similar points are timed once."""
        mandel = source.uniform_eigenstrain(1.0)
        key = (type(source.shape), self.quantity, self.half_space.space, tuple(mandel != 0), self.lattice.shape)
        if key not in _TIMES:
            points, strain = self._some_points(), mandel if mandel.any() else np.ones(6)
            _TIMES[key] = timed(lambda: self._at(source, strain, points, threads=1)) / points[0].size
        return _TIMES[key]

    def _some_points(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        return self.lattice.flat_points(stride=max(1, int(np.prod(self.lattice.shape)) // _SAMPLE))

    def _at(
        self, source: Source, strain: FloatArray, points: tuple[FloatArray, FloatArray, FloatArray], threads: int | None
    ) -> FloatArray:
        from eigencontact.halfspace.points import field_at_points

        return field_at_points(
            cast("HasPotentials", source.shape), strain, points, poisson_ratio=self.half_space.material.poisson_ratio,
            quantity=self.quantity, space=self.half_space.space, threads=threads,
        )  # fmt: skip

    def field(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Route.field`."""
        points, threads = self.lattice.flat_points(), self.half_space.numerics.threads
        eigenstrain = eigenstrain.reshape(6, -1)
        if len(self.sources) >= _CLOUD:
            from eigencontact.halfspace.cloud import field_of_cloud

            values = field_of_cloud(
                [cast("HasPotentials", source.shape) for source in self.sources], eigenstrain.T, points,
                poisson_ratio=self.half_space.material.poisson_ratio, quantity=self.quantity,
                space=self.half_space.space, threads=threads, tolerance=self.half_space.numerics.cloud_tolerance,
            )  # fmt: skip
        else:
            values = np.zeros((3 if self.quantity == "displacement" else 6, points[0].size))
            for source, strain in zip(self.sources, eigenstrain.T, strict=True):
                values += self._at(source, strain, points, threads)
        if self.quantity == "stress":
            values *= self.half_space.material.shear_modulus
        return values[list(self.rows)].reshape(self.shape)
