"""Predicted memory and time of fields of eigenstrain, from counts of work and speeds measured on the spot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log2
from typing import cast

import numpy as np

from eigencontact.convolution import Layout
from eigencontact.core.material import Material
from eigencontact.core.parallel import available_threads
from eigencontact.halfspace.potentials import HasFarField, HasPotentials
from eigencontact.planning.blocks import Cost
from eigencontact.planning.cost import Speed, speed, timed
from eigencontact.planning.regions import RegionLattice
from eigencontact.planning.sources import Lattice, Source
from eigencontact.plugin import HasCornerPotentials
from eigencontact.scene.schema import Numerics

__all__ = ["CLOUD", "Pace", "closed_form_cost", "planes_cost", "volume_cost"]

#: From so many closed forms on they are summed as a cloud of point sources where that is exact.
CLOUD = 16
#: Points on which the closed form of a shape is timed, spread over those wanted.
_SAMPLE = 1024
#: Seconds of one pair of a point source and a field point on one thread; and once, to load the compiled loop.
_PAIR, _LOAD = 2e-8, 0.5

_KNOWN: dict[tuple[object, ...], float] = {}


def closed_form_cost(
    sources: Sequence[Source], quantity: str, lattice: RegionLattice, body: Material, space: str, threads: int | None
) -> Cost:
    """Shapes with potentials at the points of a region; the fields of all are added to one array."""
    count, workers = int(np.prod(lattice.shape)), 0.8 * (threads or available_threads())
    held = 8.0 * count * (3 if quantity == "displacement" else 6) * 3 + 2e6
    if len(sources) >= CLOUD:
        seconds = sum(_cloud_pace(source, quantity, lattice, body, space) for source in sources)
        return Cost(memory=held, seconds_once=_LOAD + count * seconds / workers)
    seconds = sum(_point_pace(source, quantity, lattice, body, space) for source in sources)
    return Cost(memory=held, seconds_once=count * seconds / workers + 1e-3 * len(sources))


def _cloud_pace(source: Source, quantity: str, lattice: RegionLattice, body: Material, space: str) -> float:
    """Time of one point on one thread [s], for one shape of many: point sources by distance, near by its potentials."""
    from eigencontact.halfspace.cloud import uses_point_sources

    shape = cast("HasPotentials", source.shape)
    if not uses_point_sources(shape):
        return _point_pace(source, quantity, lattice, body, space)
    finest = cast("HasFarField", shape).far_field()
    points = lattice.flat_points(every=max(1, int(np.prod(lattice.shape)) // _SAMPLE))
    distance, above = (
        np.linalg.norm([x - c for x, c in zip(points, finest.center * (1.0, 1.0, side), strict=True)], axis=0)
        for side in (1.0, -1.0)
    )
    used = np.full(distance.size, len(finest.volumes))
    for far in reversed(finest.levels):
        used[distance >= far.distance] = len(far.volumes)
    near = float(np.mean(distance < finest.distance)) + (
        2.0 * np.mean(above < finest.distance) if space == "half" else 0
    )
    own = near * _point_pace(source, quantity, lattice, body, space) if near else 0.0
    return float(used.mean()) * _PAIR + own


def _point_pace(source: Source, quantity: str, lattice: RegionLattice, body: Material, space: str) -> float:
    """Measured time of one point on one thread [s]; like shapes of a scene at like points are timed once."""
    mandel = source.uniform_eigenstrain(1.0)
    key = (type(source.shape), quantity, space, tuple(mandel != 0), lattice.shape)
    if key not in _KNOWN:
        from eigencontact.halfspace.points import field_at_points

        points = lattice.flat_points(every=max(1, int(np.prod(lattice.shape)) // _SAMPLE))
        shape, strain = cast("HasPotentials", source.shape), mandel if mandel.any() else np.ones(6)

        def evaluate() -> None:
            field_at_points(
                shape, strain, points, poisson_ratio=body.poisson_ratio, quantity=quantity, space=space, threads=1
            )

        _KNOWN[key] = timed(evaluate) / points[0].size
    return _KNOWN[key]


@dataclass(frozen=True, slots=True)
class Pace:
    """What the kernels of one quantity take.

    Attributes
    ----------
    real, image : int
        Kernels of the cells themselves, and of their mirror images.
    sampling : float
        Seconds for all of them at one node on one thread.
    fft : Speed
        Of convolutions in the plane.
    workers : float
        Threads, as far as they help.
    """

    real: int
    image: int
    sampling: float
    fft: Speed
    workers: float
    bytes_of_a_number: int

    @staticmethod
    def of(cell: HasCornerPotentials, quantity: str, nu: float, space: str, numerics: Numerics) -> Pace:
        """Count the kernels of a quantity and time them on a small lattice."""
        real, image, sampling = _kernels(cell, quantity, nu, space)
        return Pace(
            real=real,
            image=image,
            sampling=sampling,
            fft=speed(numerics.precision, numerics.threads),
            workers=0.8 * (numerics.threads or available_threads()),
            bytes_of_a_number=8 if numerics.precision == "double" else 4,
        )


def _kernels(cell: HasCornerPotentials, quantity: str, nu: float, space: str) -> tuple[int, int, float]:
    from eigencontact.solvers.potential_tables import cell_kernels, kernel_groups, reduced_response, sample_tables

    kernels = cell_kernels(reduced_response(quantity, nu, space))
    image = sum(whose == "image" for whose, *_ in kernels)
    key = (type(cell), tuple(kernels))
    if key not in _KNOWN:
        nodes = np.asarray(np.arange(17) + 0.5, dtype=float)
        groups = list(kernel_groups(kernels, nodes.size**3))

        def sample() -> None:
            for group in groups:
                sample_tables(cell, group, (nodes, nodes, nodes), threads=1)

        _KNOWN[key] = timed(sample, 2) / nodes.size**3
    return len(kernels) - image, image, _KNOWN[key]


def planes_cost(
    pace: Pace, cells: Lattice, target: tuple[int, int], origin: tuple[float, float], planes: int, components: int
) -> Cost:
    """Kernel tables and spectra for every plane and layer once; per step six transforms a layer, one an output."""
    layout = Layout(cells.shape[1:], target, origin)
    y, x, layers = layout.y, layout.x, cells.shape[0]
    nodes = (y.lattice.size + 1) * (x.lattice.size + 1) * 1.15 + 30
    points = y.length * x.length
    stored = x.half * (y.half if y.symmetric else y.length) * (1 if y.symmetric and x.symmetric else 2)
    spectra = planes * components * layers * 5.5
    transform = (pace.fft.convolution(y.length, x.length) - pace.fft.per_call) / 2
    tables = planes * layers * nodes * (pace.sampling + 0.5e-9 * components * 6 * (pace.real + pace.image) / 3)
    once = (tables + spectra * (stored * 6e-9 + 4e-5)) / pace.workers
    step = 6 * layers * transform + planes * components * transform + spectra * (points * 1.2e-9 + 4e-6)
    memory = spectra * stored * pace.bytes_of_a_number + 8.0 * planes * components * target[0] * target[1] * 2
    memory += 6.0 * layers * points * pace.bytes_of_a_number * 1.5
    memory += pace.workers * 8.0 * nodes * 9 * (pace.real + pace.image) * 1.5
    return Cost(memory=memory, seconds_once=once, seconds_per_step=step)


def volume_cost(pace: Pace, cells: Lattice, target: tuple[int, int], origin: tuple[float, float], planes: int) -> Cost:
    """Kernel tables and spectra on the padded box once; per step the transforms in space."""
    layout = Layout(cells.shape[1:], target, origin)
    y, x, layers = layout.y, layout.x, cells.shape[0]
    depth = layers + planes
    folded = y.symmetric and x.symmetric
    nodes = (y.lattice.size + 1) * (x.lattice.size + 1) * (depth + 1)
    octant = x.half * (y.half if folded else y.length) * (depth / 2 + 1 if folded else depth)
    kernels = pace.real + 2 * pace.image if folded else 2 * (pace.real + pace.image)
    points = y.length * x.length * depth
    once = nodes * pace.sampling / pace.workers + kernels * octant * 1.5e-8 * log2(max(depth, 2)) / pace.workers
    step = 23 * pace.fft.per_point * points * log2(max(points, 2)) * 0.7 + 1e-3
    memory = kernels * octant * pace.bytes_of_a_number + 8.0 * 12 * planes * target[0] * target[1]
    memory += 16.0 * x.half * 6 * max(layers * cells.shape[1], planes * target[0])
    memory += min(3e8, 8.0 * nodes * (pace.real + pace.image))
    return Cost(memory=memory, seconds_once=once, seconds_per_step=step)
