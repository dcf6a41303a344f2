"""Stress and strain at points in and near regions of other material, from the material at the point."""

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

#: The eigenstrain of a region tells its stress where no strain takes a stress so near to that of the body.
_DIFFERENT = 0.02
#: A region is stiff where every strain takes this many times the stress of the body.
_STIFF = 3.0
#: Cells of a region whose stress is made compatible: seconds and 100 MB; larger ones keep that of their cells.
_MOST = 200_000
#: Bytes for a point: eight cells about it, their weights, and the eight that it lies in.
_OF_POINT = 192.0
#: Cells beyond the box that points between middles may need.
_ROOM = 2


class _Region(NamedTuple):
    """Region whose stress follows from its eigenstrain.

    Attributes
    ----------
    points : (n,)
        Those in it, of the points near the cells.
    place, share
        Its cells with one more on each side, and its share of them.
    stress_of_strain : (6, 6)
        Stress by eigenstrain less prestrain [Pa].
    compliance : (6, 6) or None
        [1/Pa]; None where strain is not told: in voids, and where other eigenstrain is prescribed.
    compatible : CompatibleStress or None
        What makes the stress of a stiff region compatible.
    """

    source: Inhomogeneity
    points: NDArray[np.intp]
    place: Place
    share: FloatArray
    stress_of_strain: FloatArray
    compliance: FloatArray | None
    compatible: CompatibleStress | None


class MaterialPoints:
    """Points of one lattice in and near the regions of a body.

    Parameters
    ----------
    subsurface : Subsurface
        With inhomogeneities in cells.
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
    def any(self) -> bool:
        """Whether the stress of any point is to be amended."""
        return bool(self._regions or self._outside.size)

    def _split(self, points: Points, prescribed: Sequence[Source]) -> NDArray[np.intp]:
        """Set up the regions that contain points, and the points outside of all regions near a cut boundary."""
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
        """Points of a region: all of them if its stress is made compatible, else those next to a cut cell."""
        stiffness = _stiffness(source, self._half_space.material)
        if stiffness is None:
            return None
        place = tuple(slice(max(span.start - 1, 0), span.stop + 1) for span in self._places[number])
        share = np.where(self._number[place] == number, self._share[place], 0.0)
        ratio = stiffness @ compliance(self._half_space.material)
        stiff = np.linalg.eigvals(ratio).real.min() >= _STIFF and np.count_nonzero(share) <= _MOST
        without_prescribed = not any(bounds_meet(source, other) for other in prescribed)
        # Cells that fill a region wholly leave no such stress in it.
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
        self, fields: dict[str, FloatArray], caused: FloatArray | None, eigenstrain: FloatArray, time: float
    ) -> None:
        """Replace stress and strain at points of the regions, and the stress near boundaries that cut cells.

        Parameters
        ----------
        fields : dict of (6, ...) arrays
            ``"stress"`` [Pa] and ``"strain"`` of all causes, or one of them; replaced by amended ones.
        caused : (6, n), optional
            The part of the stress that the eigenstrain was computed to cause [Pa].
        eigenstrain : (6, nz, ny, nx)
            Of the cells, prestrain included [-].
        """
        amended = {name: fields[name].reshape(6, -1).copy() for name in ("stress", "strain") if name in fields}
        padded = np.pad(eigenstrain, ((0, 0), *self._room))
        if caused is not None and self._outside.size:
            where = self._near[self._outside]
            outer = self._between.values(self._outer(eigenstrain, padded), self._outside)
            amended["stress"][:, where] += outer - caused[:, where]
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
        """Write the stress of a region [Pa] to its cells of a field, and to neighbouring cells that its points need."""
        share, where = region.share, (slice(None), *region.place)
        strain = np.where(share > 0.0, eigenstrain[where] / np.where(share > 0.0, share, 1.0), 0.0)
        prestrain = region.source.uniform_eigenstrain(time).reshape(6, 1, 1, 1)
        stress = np.einsum("ij,jzyx->izyx", region.stress_of_strain, strain - prestrain)
        if region.compatible is not None:
            stress = region.compatible.of(stress)
        needed = np.zeros(self._cells.shape, dtype=bool)
        needed.reshape(-1)[self._between.about[:, region.points]] = True
        partial_cells = np.flatnonzero(needed[region.place] & (share < 1.0))
        if partial_cells.size:
            stress.reshape(6, -1)[:, partial_cells] = continued(stress, share**2, partial_cells)
        field[where] = stress

    def _outer(self, eigenstrain: FloatArray, padded: FloatArray) -> FloatArray:
        """Stress [Pa] by the eigenstrain in the body around, in the middles of cells about the points outside."""
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
        """Vectors out of the region of each cell."""
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
    """Numbers of the points in a box of cells."""
    near = [
        (at >= first - 0.5001 * d) & (at <= first + (count - 0.4999) * d)
        for at, first, d, count in zip(points, cells.first, cells.pitch, cells.shape[::-1], strict=True)
    ]
    return np.flatnonzero(np.logical_and.reduce(near))


def _with_room(subsurface: Subsurface) -> tuple[Cells, Room]:
    """Cells of the box and around it, below the surface, and the number added on either side along z, y, x."""
    half_space, layer = subsurface.half_space, subsurface.box.lattice.first[0]
    box, top = subsurface.box.cells(half_space.grid), _ROOM if half_space.full else min(_ROOM, layer)
    room = ((top, _ROOM), (_ROOM, _ROOM), (_ROOM, _ROOM))
    x, y, z = (at - before * d for at, (before, _), d in zip(box.first, room[::-1], box.pitch, strict=True))
    nz, ny, nx = (n + sum(margins) for n, margins in zip(box.shape, room, strict=True))
    return Cells(first=(x, y, z), pitch=box.pitch, shape=(nz, ny, nx)), room


def _middles_in(subsurface: Subsurface, cells: Cells, place: Place) -> RegionLattice:
    """Centres of a part of the cells as points of a region."""
    k, j, i = place
    row, column = (at - _ROOM for at in subsurface.box.lattice.first[1:])
    x, y, z = (cells.centres(axis)[span] for axis, span in enumerate((i, j, k)))
    return RegionLattice(
        target=(y.size, x.size), origin=(float(row + j.start), float(column + i.start)), x=x, y=y, depths=z
    )  # fmt: skip


def _is_cut(source: Inhomogeneity) -> bool:
    """Whether a region leaves out a corner of its bounds, so that its boundary cuts cells."""
    low, high = (np.array(corner) for corner in source.shape.bounds)
    parts = np.array(list(product((1e-3, 1.0 - 1e-3), repeat=3)))
    return not np.all(source.shape.contains(*(low + parts * (high - low)).T))


def _stiffness(source: Inhomogeneity, matrix: Material) -> FloatArray | None:
    """Mandel stiffness of a region with uniform stiffness and prestrain that differ from the body's; else None."""
    stiffness = stiffness_beside(source, matrix)
    return stiffness[0] if stiffness is not None and np.abs(stiffness[1] - 1.0).min() >= _DIFFERENT else None
