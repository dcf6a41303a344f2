"""Stress and strain at points in and near regions of another material, by the constants at each point."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import BoolArray, FloatArray
from eigencontact.core.material import Material
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.fields.within_regions import Content, Points, number_at, stiffness_beside
from eigencontact.execution.routes.cell_strain import Place
from eigencontact.execution.routes.route import Route
from eigencontact.execution.routes.subsurface import Subsurface
from eigencontact.model.overlaps import bounds_meet
from eigencontact.model.regions import RegionLattice
from eigencontact.model.sources import Inhomogeneity, Source
from eigencontact.solvers.beside_boundaries import Between, continued, outer_stress, outward
from eigencontact.solvers.cell_conditions import compliance
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.compatible_stress import CompatibleStress

__all__ = ["MaterialPoints", "cost_beside"]

Room = tuple[tuple[int, int], tuple[int, int], tuple[int, int]]

#: Smallest relative difference of stiffness from the body for which the eigenstrain determines the stress of a region.
_DIFFERENT = 0.02
#: A region is stiff if its stiffness exceeds that of the body by this factor for every strain.
_STIFF = 3.0
#: Largest number of cells of a region with compatible stress (seconds, 100 MB); larger regions keep the stress of the
#: cells.
_MOST = 200_000
#: Bytes per point: eight neighbouring cells, their weights, and up to eight cells that contain the point.
_OF_POINT = 192.0
#: Cells outside the box that the interpolation between cell centres may need.
_ROOM = 2


class _Region(NamedTuple):
    """Region with stress from its eigenstrain.

    Attributes
    ----------
    points : (n,)
        Points in the region, as numbers among the points near the cells.
    place, share
        Cells of the region with one more on each side, and the fraction of the region in each cell.
    stress_of_strain : (6, 6)
        Stress per difference of eigenstrain and prestrain [Pa].
    compliance : (6, 6) or None
        Compliance [1/Pa]; None if the strain does not follow from the stress: in voids, and in other prescribed
        eigenstrain.
    compatible : CompatibleStress or None
        Projection that makes the stress of a stiff region compatible.
    """

    source: Inhomogeneity
    points: NDArray[np.intp]
    place: Place
    share: FloatArray
    stress_of_strain: FloatArray
    compliance: FloatArray | None
    compatible: CompatibleStress | None


class MaterialPoints:
    """Points of one lattice, in and near the regions of a body.

    Parameters
    ----------
    subsurface : Subsurface
        Subsurface with inhomogeneities in cells.
    content : Content
        Region and share of each cell.
    points : three of (n,)
        x, y, z [m].
    """

    def __init__(self, subsurface: Subsurface, content: Content, points: Points) -> None:
        half_space, lattice = subsurface.half_space, subsurface.box.lattice
        self._cells, self._room = _with_room(subsurface)
        self._subsurface, self._half_space, self._sources = subsurface, half_space, subsurface.inhomogeneities
        self._number, self._share = (np.pad(values, self._room) for values in content)
        self._flush = not half_space.full and lattice.first[0] == 0
        self._near = _points_in(self._cells, points)
        points = (points[0][self._near], points[1][self._near], points[2][self._near])
        self._between = Between(self._cells, points)
        self._regions: list[_Region] = []
        self._outside = self._split(points, subsurface.prescribed)

    @property
    def needs_correction(self) -> bool:
        """Whether any point needs a correction of its stress."""
        return bool(self._regions or self._outside.size)

    def _split(self, points: Points, prescribed: Sequence[Source]) -> NDArray[np.intp]:
        """Set up the regions that contain points, and the points outside all regions near a cut boundary."""
        number, share, between = self._number.ravel(), self._share.ravel(), self._between
        point_region, own_share = number[between.on], share[between.on]
        inside = number_at(self._sources, points)  # also in slivers that the cells leave out
        at = np.where(
            (point_region == 0).all(axis=0) & (number[between.about] == inside).any(axis=0), inside, point_region[0]
        )
        in_region = (own_share == 1.0).all(axis=0) | (inside == at)
        in_region &= (at > 0) & ((point_region == point_region[0]).all(axis=0))
        about = share[between.about]
        cut = np.asarray(((about > 0.0) & (about < 1.0)).any(axis=0))
        for region in np.unique(at[in_region]).tolist():
            mine = in_region & (at == region)
            material_region = self._region(self._sources[region - 1], region, mine, cut, prescribed)
            if material_region is not None:
                self._regions.append(material_region)
        interpolated = (
            (number[between.about] >= 0).all(axis=0) & (point_region >= 0).all(axis=0) & (own_share < 1.0).all(axis=0)
        )
        return np.flatnonzero(interpolated & cut & (inside == 0))

    def _region(
        self, source: Inhomogeneity, number: int, inside: BoolArray, cut: BoolArray, prescribed: Sequence[Source]
    ) -> _Region | None:
        """Points of a region: all of them if its stress is made compatible, otherwise those next to a cut cell."""
        stiffness = _stiffness(source, self._half_space.material)
        if stiffness is None:
            return None
        place = tuple(slice(max(span.start - 1, 0), span.stop + 1) for span in self._places[number])
        share = np.where(self._number[place] == number, self._share[place], 0.0)
        ratio = stiffness @ compliance(self._half_space.material)
        stiff = np.linalg.eigvals(ratio).real.min() >= _STIFF and np.count_nonzero(share) <= _MOST
        without_prescribed = not any(bounds_meet(source, prescribed_source) for prescribed_source in prescribed)
        # A region of whole cells has no self-balanced stress of this kind.
        projected = stiff and without_prescribed and bool(((share > 0.0) & (share < 1.0)).any())
        points = np.flatnonzero(inside if projected else inside & cut)
        if not points.size:
            return None
        compatible = CompatibleStress(share, stiffness, self._cells.pitch) if projected else None
        soft = None if source.is_empty or not without_prescribed else np.linalg.inv(stiffness)
        stress_of_strain = np.linalg.solve(np.eye(6) - ratio, stiffness)
        return _Region(source, points, place, share, stress_of_strain, soft, compatible)  # type: ignore[arg-type]

    @cached_property
    def _places(self) -> dict[int, Place]:
        """Part of the lattice in each region."""
        from scipy.ndimage import find_objects

        slices = find_objects(np.maximum(self._number, 0))
        return {number: place for number, place in enumerate(slices, 1) if place is not None}

    def amend(
        self, fields: dict[str, FloatArray], cell_stress: FloatArray | None, eigenstrain: FloatArray, time: float
    ) -> None:
        """Replace stress and strain at points of the regions, and the stress near boundaries that cut cells.

        Parameters
        ----------
        fields : dict of (6, ...) arrays
            ``"stress"`` [Pa] and ``"strain"`` by all causes, or one of them; the method replaces the values.
        cell_stress : (6, n), optional
            Stress by the computed eigenstrain alone [Pa].
        eigenstrain : (6, nz, ny, nx)
            Eigenstrain of the cells, prestrain included [-].
        """
        amended = {name: fields[name].reshape(6, -1).copy() for name in ("stress", "strain") if name in fields}
        padded = np.pad(eigenstrain, ((0, 0), *self._room))
        if cell_stress is not None and self._outside.size:
            where = self._near[self._outside]
            outer = self._between.values(self._outer(eigenstrain, padded), self._outside)
            amended["stress"][:, where] += outer - cell_stress[:, where]
        field = np.zeros_like(padded)
        for region in self._regions:
            self._fill(field, region, padded, time)
            stress, where = self._between.values(field, region.points), self._near[region.points]
            if "stress" in amended:
                amended["stress"][:, where] = stress
            if "strain" in amended and region.compliance is not None:
                prestrain = region.source.uniform_eigenstrain(time)
                amended["strain"][:, where] = region.compliance @ stress + prestrain[:, None]
        fields |= {name: values.reshape(fields[name].shape) for name, values in amended.items()}

    def _fill(self, field: FloatArray, region: _Region, eigenstrain: FloatArray, time: float) -> None:
        """Write the stress of a region [Pa] to its cells of a field, and to the neighbouring cells needed there."""
        share, where = region.share, (slice(None), *region.place)
        strain = np.where(share > 0.0, eigenstrain[where] / np.where(share > 0.0, share, 1.0), 0.0)
        prestrain = region.source.uniform_eigenstrain(time).reshape(6, 1, 1, 1)
        stress = np.einsum("ij,jzyx->izyx", region.stress_of_strain, strain - prestrain)
        if region.compatible is not None:
            stress = region.compatible.of(stress)
        neighbours = np.zeros(self._cells.shape, dtype=bool)
        neighbours.reshape(-1)[self._between.about[:, region.points]] = True
        partial_cells = np.flatnonzero(neighbours[region.place] & (share < 1.0))
        if partial_cells.size:
            stress.reshape(6, -1)[:, partial_cells] = continued(stress, share**2, partial_cells)
        field[where] = stress

    def _outer(self, eigenstrain: FloatArray, padded: FloatArray) -> FloatArray:
        """Stress [Pa] by the eigenstrain in the surrounding body, at the cell centres around the points outside."""
        place, route = self._middles
        out = np.zeros((6, *self._cells.shape))
        where = (slice(None), *place)
        values, local_eigenstrain = route.field(eigenstrain), padded[where]
        normal = self._normals[where].reshape(3, -1)
        stress = outer_stress(
            values.reshape(6, -1), local_eigenstrain.reshape(6, -1), normal, self._half_space.material
        )
        out[where] = stress.reshape(local_eigenstrain.shape)
        return out

    @cached_property
    def _middles(self) -> tuple[Place, Route]:
        """Part of the lattice around the points outside, and the route from the eigenstrain to its cell centres."""
        about = np.unravel_index(np.unique(self._between.about[:, self._outside]), self._cells.shape)
        k, j, i = (slice(int(axis.min()), int(axis.max()) + 1) for axis in about)
        lattice = _middles_in(self._subsurface, self._cells, (k, j, i))
        return (k, j, i), self._subsurface.route("stress", lattice)

    @cached_property
    def _normals(self) -> FloatArray:
        """Outward normals of the region in each cell."""
        out = np.zeros((3, *self._cells.shape))
        for number, place in self._places.items():
            cells = self._number[place] == number
            share, flush = np.where(cells, self._share[place], 0.0), self._flush and place[0].start == 0
            out[(slice(None), *place)] += np.where(cells, outward(share, self._cells.pitch, flush=flush), 0.0)
        return out


def cost_beside(subsurface: Subsurface, points: Points) -> Cost:
    """Cost of the stress at cell centres around points: zero if all regions fill their bounds."""
    if not any(_is_cut(source) for source in subsurface.inhomogeneities):
        return Cost()
    cells, _ = _with_room(subsurface)
    near = _points_in(cells, points)
    if not near.size:
        return Cost()
    place = []
    for axis in (2, 1, 0):
        placed, count = (points[axis][near] - cells.first[axis]) / cells.pitch[axis], cells.shape[2 - axis]
        place.append(slice(max(int(np.floor(placed.min())), 0), min(int(np.ceil(placed.max())) + 1, count)))
    route = subsurface.route("stress", _middles_in(subsurface, cells, (place[0], place[1], place[2])))
    return route.cost + Cost(memory=_OF_POINT * near.size)


def _points_in(cells: Cells, points: Points) -> NDArray[np.intp]:
    """Indices of the points in a box of cells."""
    near = [
        (at >= first - 0.5001 * d) & (at <= first + (count - 0.4999) * d)
        for at, first, d, count in zip(points, cells.first, cells.pitch, cells.shape[::-1], strict=True)
    ]
    return np.flatnonzero(np.logical_and.reduce(near))


def _with_room(subsurface: Subsurface) -> tuple[Cells, Room]:
    """Cells of the box with a margin below the surface, and the number of added cells on either side along z, y, x."""
    half_space, layer = subsurface.half_space, subsurface.box.lattice.first[0]
    box, top = subsurface.box.cells(half_space.grid), _ROOM if half_space.full else min(_ROOM, layer)
    room = ((top, _ROOM), (_ROOM, _ROOM), (_ROOM, _ROOM))
    x, y, z = (at - before * d for at, (before, _), d in zip(box.first, room[::-1], box.pitch, strict=True))
    nz, ny, nx = (n + sum(margins) for n, margins in zip(box.shape, room, strict=True))
    return Cells(first=(x, y, z), pitch=box.pitch, shape=(nz, ny, nx)), room


def _middles_in(subsurface: Subsurface, cells: Cells, place: Place) -> RegionLattice:
    """Centres of a part of the cells, as the points of a region."""
    k, j, i = place
    row, column = (at - _ROOM for at in subsurface.box.lattice.first[1:])
    x, y, z = (cells.centres(axis)[span] for axis, span in enumerate((i, j, k)))
    return RegionLattice(
        target=(y.size, x.size), origin=(float(row + j.start), float(column + i.start)), x=x, y=y, depths=z
    )  # fmt: skip


def _is_cut(source: Inhomogeneity) -> bool:
    """Whether the boundary of a region cuts cells, because the region does not fill its bounds."""
    low, high = (np.array(corner) for corner in source.shape.bounds)
    parts = np.array(list(product((1e-3, 1.0 - 1e-3), repeat=3)))
    return not np.all(source.shape.contains(*(low + parts * (high - low)).T))


def _stiffness(source: Inhomogeneity, matrix: Material) -> FloatArray | None:
    """Mandel stiffness of a region with uniform constants and prestrain; None if equal to that of the body."""
    stiffness = stiffness_beside(source, matrix)
    return stiffness[0] if stiffness is not None and np.abs(stiffness[1] - 1.0).min() >= _DIFFERENT else None
