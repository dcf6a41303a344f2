"""Many regions at once: point sources wherever they hold, the shapes' own potentials only near by.

Beyond a distance a shape is a few points (a sphere is one, everywhere outside), further away fewer. All of them are
summed over all field points in one compiled loop. What is left are pairs of a region and a point close to it: equal
shapes hand theirs in together, and pairs that look alike, as those of a regular array on a grid do, are evaluated once.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import fields, replace
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.parallel import available_threads
from eigencontact.core.places import place_field
from eigencontact.core.tensors import from_mandel, to_mandel
from eigencontact.errors import require
from eigencontact.halfspace.points import field_at_points
from eigencontact.halfspace.potentials import HasFarField, HasPotentials, PointSources
from eigencontact.halfspace.theorem import QUANTITIES

__all__ = ["cloud_sources", "field_of_cloud", "uses_point_sources"]

FloatArray = NDArray[np.float64]

# A shape whose far field takes more points than this is cheaper by its own formulas.
_MOST_SOURCES = 800


def uses_point_sources(shape: HasPotentials) -> bool:
    """Whether a shape in a cloud is replaced by its point sources beyond their distance."""
    return cloud_sources(shape) is not None


def cloud_sources(shape: HasPotentials) -> PointSources | None:
    """Point sources that replace a shape in a cloud beyond their distance; None where its own formulas are cheaper."""
    if find_spec("numba") is None or not isinstance(shape, HasFarField):
        return None
    far = shape.far_field()
    return far if len(far.positions) <= _MOST_SOURCES else None


def field_of_cloud(
    shapes: Sequence[HasPotentials],
    eigenstrains: FloatArray,
    points: tuple[FloatArray, FloatArray, FloatArray],
    *,
    poisson_ratio: float,
    quantity: str,
    space: str = "half",
    threads: int | None = None,
) -> FloatArray:
    """Sum of the fields of many regions, each with its own uniform eigenstrain.

    Parameters
    ----------
    shapes : sequence of HasPotentials
        The regions; they do not influence each other (prescribed eigenstrain).
    eigenstrains : (len(shapes), 6)
        Mandel eigenstrains [-].
    points, poisson_ratio, quantity, space, threads
        As for `eigencontact.halfspace.points.field_at_points`.

    Returns
    -------
    (3, n) or (6, n)
        Displacement [m], or Mandel strain, or Mandel stress in units of the shear modulus.
    """
    require(len(shapes) == len(eigenstrains), "cloud", "eigenstrains", len(eigenstrains), f"{len(shapes)} rows")
    x, y, z = (np.ascontiguousarray(values, dtype=float) for values in points)
    out = np.zeros((QUANTITIES[quantity], x.size))
    given: dict[str, Any] = {"poisson_ratio": poisson_ratio, "quantity": quantity, "threads": threads}
    if len(shapes) == 1:
        return field_at_points(shapes[0], eigenstrains[0], (x, y, z), space=space, **given)
    distant: dict[int, PointSources] = {}
    groups: dict[Hashable, list[int]] = {}
    for number, shape in enumerate(shapes):
        far = cloud_sources(shape)
        if far is not None:
            distant[number] = far
            groups.setdefault((_likeness(shape), eigenstrains[number].tobytes()), []).append(number)
        else:
            out += field_at_points(shape, eigenstrains[number], (x, y, z), space=space, **given)
    if distant:
        finder = _Finder(x, y, z)
        sources = _Sources(list(distant.values()), [eigenstrains[number] for number in distant])
        # Neighbours in space are neighbours in the sum, so that a block of points can do with few sources.
        order = finder.order if sources.many_levels else slice(None)
        out[:, order] += _sum_of_sources(sources, (x[order], y[order], z[order]), space=space, **given)
        for members in groups.values():
            _mend_near(shapes, members, eigenstrains[members[0]], distant, finder, space, given, out)
    return out


class _Sources:
    """Point sources of regions, as tables for the compiled sums."""

    def __init__(self, regions: Sequence[PointSources], eigenstrains: Sequence[FloatArray]) -> None:
        rows, levels, starts = [], [], [0]
        total = 0
        for finest, eigenstrain in zip(regions, eigenstrains, strict=True):
            for far in finest.levels:
                spread_out = np.sqrt(((far.positions - far.center) ** 2).sum(axis=1).max())
                least = (0.9 * (far.distance - spread_out)) ** 2  # closer than any point at which they hold
                count = len(far.volumes)
                columns = [far.positions, far.volumes, far.spreads, np.full(count, least)]
                rows.append(np.column_stack([*columns, np.tile(from_mandel(eigenstrain), (count, 1))]))
                levels.append((far.distance**2, total, total + count))
                total += count
            starts.append(len(levels))
        self.rows, self.levels = np.concatenate(rows), np.array(levels, dtype=float)
        self.centers, self.starts = np.array([far.center for far in regions], dtype=float), np.array(starts)
        self.many_levels = len(levels) > len(regions)


def _sum_of_sources(
    sources: _Sources,
    points: tuple[FloatArray, FloatArray, FloatArray],
    *,
    space: str,
    poisson_ratio: float,
    quantity: str,
    threads: int | None,
) -> FloatArray:
    """Compiled sum over point sources; strain follows from stress, for there is no eigenstrain out there."""
    import numba

    from eigencontact.halfspace.cloud_kernels import sum_displacement, sum_stress

    nu = float(poisson_ratio)
    rows = sources.rows.copy()
    rows[:, 3] *= (1.0 if quantity == "displacement" else 2.0) / (8.0 * np.pi * (1.0 - nu))
    half = True if space == "half" else None
    tables = (rows, sources.centers, sources.starts, sources.levels)
    numba.set_num_threads(min(threads or available_threads(), numba.config.NUMBA_NUM_THREADS))
    out = np.zeros((QUANTITIES[quantity], points[0].size))
    if quantity == "displacement":
        sum_displacement(*points, *tables, nu, half, out)
        return out
    sum_stress(*points, *tables, nu, half, out)
    if quantity == "strain":
        out[:3] -= nu / (1.0 + nu) * out[:3].sum(axis=0)
        out *= 0.5
    return to_mandel(out)


def _likeness(shape: Any) -> Hashable:
    """What two shapes share that differ by a shift only; a shape that does not say is like nothing else."""
    place = place_field(type(shape))
    if place is None:
        return id(shape)
    values = [(item.name, repr(getattr(shape, item.name))) for item in fields(shape) if item.name != place]
    return (type(shape), *values)


def _mend_near(
    shapes: Sequence[HasPotentials],
    members: Sequence[int],
    eigenstrain: FloatArray,
    distant: Mapping[int, PointSources],
    finder: _Finder,
    space: str,
    given: dict[str, Any],
    out: FloatArray,
) -> None:
    """Replace the point sources of like regions by the regions at the points near them, and likewise their images."""
    canonical, far = shapes[members[0]], distant[members[0]]
    found = [finder.within(distant[member].center, far.distance) for member in members]
    index = np.concatenate(found)
    if index.size:
        offsets = [finder.points[near] - distant[member].center for near, member in zip(found, members, strict=True)]
        relative = np.concatenate(offsets)
        first = inverse = np.arange(len(relative))
        if len(members) > 1:  # offsets that agree to round-off are one: regular arrays on a grid share their work
            rounded = np.round(relative / (1e-12 * far.distance))
            _, first, inverse = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
        field = _mend(canonical, far, eigenstrain, relative[first] + far.center, ("full",), given)
        for component, values in enumerate(field):
            out[component] += np.bincount(index, weights=values[inverse.ravel()], minlength=out.shape[1])
    if space == "half":
        for member in members:
            far = distant[member]
            near = finder.within(far.center * (1.0, 1.0, -1.0), far.distance)
            if near.size:
                mend = _mend(shapes[member], far, eigenstrain, finder.points[near], ("half", "full"), given)
                out[:, near] += mend


def _mend(
    shape: HasPotentials,
    far: PointSources,
    eigenstrain: FloatArray,
    at: FloatArray,
    spaces: tuple[str, ...],
    given: dict[str, Any],
) -> FloatArray:
    """Field of a region minus that of its point sources; of two spaces the first minus the second, the image's part."""
    points = (np.ascontiguousarray(at[:, 0]), np.ascontiguousarray(at[:, 1]), np.ascontiguousarray(at[:, 2]))
    finest = _Sources([replace(far, coarser=None)], [eigenstrain])
    parts = [
        field_at_points(shape, eigenstrain, points, space=space, **given)
        - _sum_of_sources(finest, points, space=space, **given)
        for space in spaces
    ]
    return parts[0] - parts[1] if len(parts) == 2 else parts[0]


class _Finder:
    """Finds the points close to a place."""

    def __init__(self, x: FloatArray, y: FloatArray, z: FloatArray) -> None:
        from scipy.spatial import cKDTree

        self.points = np.column_stack([x, y, z])
        self._tree = cKDTree(self.points, balanced_tree=False, compact_nodes=False)

    @property
    def order(self) -> NDArray[np.intp]:
        """Indices of the points, neighbours in space next to each other."""
        return np.asarray(self._tree.indices)

    def within(self, place: FloatArray, distance: float) -> NDArray[np.intp]:
        """Indices of points strictly closer than `distance`."""
        found = np.array(self._tree.query_ball_point(place, distance), dtype=np.intp)
        if not found.size:
            return found
        offsets = self.points[found] - place
        return np.sort(found[np.einsum("ij,ij->i", offsets, offsets) < distance**2])
