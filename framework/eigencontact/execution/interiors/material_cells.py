"""Content of the cells of inhomogeneities: laws, fractions of cut cells, normals of boundaries, prestrain."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.errors import require
from eigencontact.execution.interiors.boundaries import can_be_layer, steepest
from eigencontact.execution.routes.cell_strain import Place, fractions_in, place_in, values_of
from eigencontact.model.boxes import CellBox
from eigencontact.model.overlaps import bounds_meet
from eigencontact.model.sources import Inhomogeneity, Lattice, Patch
from eigencontact.plugin import ConstitutiveLaw

if TYPE_CHECKING:
    from eigencontact.halfspace.voxels import Region

__all__ = ["LinearContent", "MaterialCells", "risen", "share_of"]

IntArray = NDArray[np.int_]

#: Smaller fractions of a cell are neglected.
_LEAST = 1e-3
#: Smallest fraction for which a nonlinear law fills the whole cell, if a laminate cannot represent both laws.
_HALF = 0.5
#: Smaller fractions are merged with the other material of the cell: a thin sliver would flow along the boundary without
#: resistance.
_SLIVER = 0.05


@dataclass(frozen=True, slots=True)
class LinearContent:
    """Content of linear cells for the solver `InhomogeneousCells`; see `MaterialCells`."""

    laws: list[ConstitutiveLaw]
    index: IntArray
    beside: IntArray
    fraction: FloatArray
    normal: FloatArray


class MaterialCells:
    """Content of the cells of one box; the later inhomogeneity counts in overlaps.

    Attributes
    ----------
    laws : list of ConstitutiveLaw
        Laws, each listed once.
    index, beside : (nz, ny, nx) of int
        Number (from 1; 0 is the matrix) of the law with the largest fraction of a cell other than the matrix, and of
        the second law of the cell.
    fraction : (nz, ny, nx)
        Fraction of the first law.
    normal : (3, nz, ny, nx)
        Normal of the boundary in cut cells.
    cut : (nz, ny, nx) of bool
        Cells cut by a boundary of a nonlinear law; `cuts` lists them.

    Parameters
    ----------
    box, sources, grid
    matrix : ConstitutiveLaw, optional
        Law of the matrix beside nonlinear laws; without it nonlinear laws fill whole cells at the boundary.
    """

    def __init__(
        self, box: CellBox, sources: Sequence[Inhomogeneity], grid: Grid, matrix: ConstitutiveLaw | None = None
    ) -> None:
        self._box, self._sources, self._grid, self._matrix = box, sources, grid, matrix
        self.shape = box.lattice.shape
        self._numbers = self._numbered()
        self._new = [self._share(member) for member in range(len(sources))]
        self._risen: dict[int, FloatArray] = {}
        self._mix()
        for source, number, (place, share) in zip(sources, self._numbers, self._new, strict=True):
            filled = (self.index[place] == number) & (self.fraction[place] >= _HALF) & (share > _LEAST)
            if not source.law.linear and share.any():
                assert source.lattice is not None
                rule = f"fine enough for {source.name!r} to fill half of a cell: {source.law.key!r} has no part of one"
                require(filled.any(), source.where, "cells", source.lattice.shape[::-1], rule)

    def rise(self, worn_depth: FloatArray) -> None:
        """Move the content up by the worn depth ``(ny, nx)`` [m] of the surface since the start.

        Linear materials rise by that depth, column by column; material above the surface disappears. History-dependent
        laws stay in place.
        """
        self._risen = self._cells_risen(worn_depth)
        self._mix()

    def _cells_risen(self, worn_depth: FloatArray) -> dict[int, FloatArray]:
        """Rise of each linear source in its columns [cells]."""
        padded = np.zeros(self.shape[1:])
        (_, row, column), (ny, nx) = self._box.lattice.first, worn_depth.shape
        rows, columns = (np.arange(n) + first for n, first in zip(padded.shape, (row, column), strict=True))
        inside = np.ix_((rows >= 0) & (rows < ny), (columns >= 0) & (columns < nx))
        padded[inside] = worn_depth[np.ix_(rows[(rows >= 0) & (rows < ny)], columns[(columns >= 0) & (columns < nx)])]
        padded /= self._box.lattice.edges[0]
        return {
            member: padded[place[1:]] for member, (place, _) in enumerate(self._new) if self._sources[member].law.linear
        }

    def _risen_to(self, member: int, values: FloatArray) -> tuple[Place, FloatArray]:
        """Values in the cells of a source at their moved positions, and the new part of the box."""
        place = self._new[member][0]
        by = self._risen.get(member)
        if by is None or not by.any():
            return place, values
        whole = np.zeros((*values.shape[:-3], self.shape[0], *values.shape[-2:]))
        whole[..., place[0], :, :] = values
        return (slice(None), *place[1:]), risen(whole, by)

    def _mix(self) -> None:
        """Find the main and second material of each cell, and the boundary between them."""
        left = np.ones(self.shape)
        shares = np.zeros((2, *self.shape))
        names = np.zeros((2, *self.shape), dtype=int)
        for member, number in enumerate(self._numbers):
            place, share = self._risen_to(member, self._new[member][1])
            left[place] -= share
            _add(shares[:, *place], names[:, *place], share, number)
        first, second = shares
        filled = first > _LEAST
        self.index = np.where(filled, names[0], 0)
        mixed = filled & (second > left) & (second > _LEAST)
        self.beside = np.where(mixed, names[1], 0)
        self.fraction = np.where(filled, np.minimum(first / np.where(mixed, first + second, 1.0), 1.0), 1.0)
        self.fraction[self.fraction > 1.0 - _LEAST] = 1.0
        self.normal = self._gradient(left)
        self.cut = self._cut()

    def _cut(self) -> NDArray[np.bool_]:
        """Cells of two materials of which at least one is nonlinear, without slivers."""
        out = np.zeros(self.shape, dtype=bool)
        curved = np.array([False, *(not law.linear for law in self.laws)])
        if curved.any():
            layers = np.array([self._matrix is not None, *(can_be_layer(law) for law in self.laws)])
            out |= (self.index > 0) & (self.fraction >= _SLIVER) & (self.fraction <= 1.0 - _SLIVER)
            out &= (curved[self.index] | curved[self.beside]) & layers[self.index] & layers[self.beside]
        return out

    def cuts(self) -> Iterator[tuple[ConstitutiveLaw, ConstitutiveLaw, IntArray]]:
        """First and second law of cut cells, and the flat indices of these cells; composite laws by local law."""
        places = self._box.centres(self._grid).flat_points()
        names = np.stack([self.index, self.beside]).reshape(2, -1)
        for first, second in np.unique(names[:, self.cut.ravel()], axis=1).T:
            cut_by_pair = self.cut.ravel() & (names[0] == first) & (names[1] == second)
            for (first_law, first_cells), (second_law, second_cells) in product(
                *(self._laws_at(number, places) for number in (first, second))
            ):
                cells = np.flatnonzero(cut_by_pair & first_cells & second_cells)
                if cells.size:
                    yield first_law, second_law, cells

    def _laws_at(
        self, number: int, places: tuple[FloatArray, FloatArray, FloatArray]
    ) -> Sequence[tuple[ConstitutiveLaw, NDArray[np.bool_]]]:
        law = self.laws[number - 1] if number else self._matrix
        assert law is not None
        return law.laws_at(*places)

    def across(self, cells: IntArray) -> FloatArray:
        """Unit normals ``(3, n)`` of the boundaries in cut cells of one pair of laws, with arbitrary sign.

        In overlaps the boundary is that of the later region.
        """
        pair = {int(names.ravel()[cells[0]]) for names in (self.index, self.beside)}
        later = next(number for number in reversed(self._numbers) if number in pair)
        padded = np.zeros([count + 2 for count in self.shape])
        inner = padded[1:-1, 1:-1, 1:-1]
        for member in (member for member, number in enumerate(self._numbers) if number == later):
            place, share = self._risen_to(member, self._new[member][1])
            inner[place] += share
        if self._box.lattice.first[0] == 0:
            padded[0] = padded[1]
        return steepest(padded, self._box.lattice.edges)[:, cells]

    @property
    def linear(self) -> LinearContent:
        """Cells of linear laws, cut cells included; nonlinear laws fill whole cells, or are in `cuts`."""
        linear = [law for law in self.laws if law.linear]
        numbers = np.array([0, *(linear.index(law) + 1 if law in linear else 0 for law in self.laws)])
        nonlinear = self.cut | np.isin(self.index, [n for n, law in enumerate(self.laws, 1) if law not in linear])
        index = np.where(nonlinear, 0, numbers[self.index])
        return LinearContent(linear, index, numbers[self.beside], np.where(nonlinear, 1.0, self.fraction), self.normal)

    @property
    def nonlinear(self) -> list[tuple[ConstitutiveLaw, NDArray[np.bool_]]]:
        """Nonlinear laws, or their local laws, and the cells that they fill at least by half."""
        places = self._box.centres(self._grid).flat_points()
        groups = []
        for number, law in enumerate(self.laws, 1):
            filled = (self.index == number) & (self.fraction >= _HALF) & ~self.cut
            if not law.linear:
                groups += [(layer, filled & where.reshape(self.shape)) for layer, where in law.laws_at(*places)]
        return [(law, cells) for law, cells in groups if cells.any()]

    def rim(self, width: tuple[int, int, int] = (1, 1, 1)) -> NDArray[np.bool_]:
        """Outermost cells ``(nz, ny, nx)`` of the regions with estimated bounds; the surface does not count as a bound.

        A rim of several cells along z, y, x contains all neighbourhoods that extend beyond the bounds. A single row of
        infinite cells along y has no rim in that direction (0).
        """
        out = np.zeros(self.shape, dtype=bool)
        for source in self._sources:
            if source.guessed and source.lattice is not None:
                cells, (k, j, i) = out[place_in(self._box, source.lattice)], width
                cells[-k:] = cells[:, :, :i] = cells[:, :, -i:] = True
                if j:
                    cells[:, :j] = cells[:, -j:] = True
        return out

    def _share(self, member: int) -> tuple[Place, FloatArray]:
        """Part of the box of an inhomogeneity and its volume fractions, minus those of later inhomogeneities."""
        source = self._sources[member]
        assert source.lattice is not None
        return place_in(self._box, source.lattice), share_of(self._sources, member, self._grid)

    def _numbered(self) -> list[int]:
        """Number of the law of each source."""
        self.laws: list[ConstitutiveLaw] = []
        for source in self._sources:
            if source.law not in self.laws:
                self.laws.append(source.law)
        return [self.laws.index(source.law) + 1 for source in self._sources]

    def _gradient(self, left: FloatArray) -> FloatArray:
        """Gradient of the fraction of the matrix, which fills all cells outside the box."""
        padded = np.pad(left, 1, constant_values=1.0)
        if self._box.lattice.first[0] == 0:
            padded[0] = padded[1]
        inner = slice(1, -1)
        dz, dy, dx = self._box.lattice.edges
        along_z = (padded[2:, inner, inner] - padded[:-2, inner, inner]) / dz
        along_y = (padded[inner, 2:, inner] - padded[inner, :-2, inner]) / dy
        along_x = (padded[inner, inner, 2:] - padded[inner, inner, :-2]) / dx
        return np.stack([along_x, along_y, along_z]) * min(dx, dy, dz)

    def prestrain(self, time: float, number: int | None = None) -> FloatArray:
        """Mean Mandel prestrain ``(6, nz, ny, nx)`` of each cell; with `number` only the contribution of this law."""
        out = np.zeros((6, *self.shape))
        z, y, x = self._box.lattice.axes(self._grid)
        for member, (source, (place, share)) in enumerate(zip(self._sources, self._new, strict=True)):
            if number is None or number == self._numbers[member]:
                new = share * values_of(source, x[place[2]], y[place[1]], z[place[0]], time)
                where, values = self._risen_to(member, new)
                out[:, *where] += values
        return out

    def difference(self, cells: IntArray, time: float) -> FloatArray:
        """Prestrain of the first material minus that of the second ``(6, n)``, in cut cells of one pair of laws."""
        share, out = self.fraction.ravel()[cells], np.zeros((6, cells.size))
        for names, weight in ((self.index, share), (self.beside, share - 1.0)):
            out += self.prestrain(time, int(names.ravel()[cells[0]])).reshape(6, -1)[:, cells] / weight
        return out


def share_of(sources: Sequence[Inhomogeneity], member: int, grid: Grid) -> FloatArray:
    """Fraction of each cell that belongs to an inhomogeneity, ``(nz, ny, nx)``, minus later inhomogeneities.

    Raises
    ------
    SceneError
        The region is smaller than a cell, so that no cell contains a part of it.
    """
    source = sources[member]
    assert source.lattice is not None
    later = [successor.shape for successor in sources[member + 1 :] if bounds_meet(source, successor)]
    # The law of a body fills all cells of its lattice, which may be larger than the first estimate of its region.
    region = _filled(source.lattice, grid) if source.guessed else source.shape
    fractions = fractions_in(source, _Without(region, later) if later else region, grid)
    if not later:
        rule = f"fine enough to find {source.name!r}"
        require(fractions.any(), source.where, "cells", source.lattice.shape[::-1], rule)
    return np.minimum(fractions, 1.0)


def _filled(lattice: Lattice, grid: Grid) -> Patch:
    """Region of all cells of a lattice."""
    axes, edges = lattice.axes(grid)[::-1], lattice.edges[::-1]
    low = [float(axis[0] - 0.5 * edge) for axis, edge in zip(axes, edges, strict=True)]
    high = [float(axis[-1] + 0.5 * edge) for axis, edge in zip(axes, edges, strict=True)]
    return Patch(((low[0], low[1], low[2]), (high[0], high[1], high[2])))


@dataclass(frozen=True, slots=True)
class _Without:
    """Region minus later regions."""

    region: Region
    later: Sequence[Region]

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Bounds of the region."""
        return self.region.bounds

    def contains(self, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie in the region and in no later region."""
        inside = self.region.contains(x, y, z)
        for region in self.later:
            inside = inside & ~region.contains(x, y, z)
        return inside


def _add(shares: FloatArray, names: IntArray, share: FloatArray, number: int) -> None:
    """Add shares of one material to the two largest of each cell."""
    first = (names[0] == number) & (share > 0)
    second = (names[1] == number) & (share > 0)
    new = ~first & ~second & (share > shares[1])
    shares[0] += np.where(first, share, 0.0)
    shares[1] = np.where(new, share, shares[1] + np.where(second, share, 0.0))
    names[1][new] = number
    swap = shares[1] > shares[0]
    shares[:, swap] = shares[::-1, swap]
    names[:, swap] = names[::-1, swap]


def risen(values: FloatArray, by: FloatArray) -> FloatArray:
    """Means over the cells of columns ``(..., nz, ny, nx)`` after a rise by ``(ny, nx)`` cells.

    Values are uniform within a cell. Material above the first cell is lost, and zero follows below the last cell.

    Examples
    --------
    >>> risen(np.array([1.0, 1.0, 0.0]).reshape(3, 1, 1), np.array([[0.75]])).ravel()
    array([1.  , 0.25, 0.  ])
    """
    nz = values.shape[-3]
    whole = np.floor(by).astype(int)
    fraction = by - whole
    levels = np.arange(nz)[:, None, None] + whole
    padded = np.concatenate([values, np.zeros((*values.shape[:-3], 1, *values.shape[-2:]))], axis=-3)
    upper, lower = (
        np.take_along_axis(padded, np.broadcast_to(np.minimum(level, nz), (*values.shape[:-3], *levels.shape)), axis=-3)
        for level in (levels, levels + 1)
    )
    return np.asarray((1.0 - fraction) * upper + fraction * lower)
