"""Regions of another material at points of a body: their cells, voids and softer laws."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.errors import SceneError
from eigencontact.execution.routes.cell_strain import place_in
from eigencontact.model.boxes import CellBox
from eigencontact.model.regions import RegionLattice
from eigencontact.model.sources import Inhomogeneity
from eigencontact.solvers.cell_conditions import compliance

if TYPE_CHECKING:
    from eigencontact.solvers.within_cells import WithinCells

__all__ = ["Content", "Points", "content_of", "empty_points", "number_at", "read_by_own_laws", "stiffness_beside"]

#: A region counts as softer if its stiffness is below this fraction of the body's for every strain.
_SOFTER = 1.0 - 1e-9

#: Smaller fractions of a cell are neglected, as in `eigencontact.execution.interiors.material_cells`.
_LEAST = 1e-3

Points = tuple[FloatArray, FloatArray, FloatArray]


class Content(NamedTuple):
    """Regions in the cells of a box, ``(nz, ny, nx)``.

    Attributes
    ----------
    number : array of int
        Number (from 1) of the region in a cell, 0 without a region. -1 marks cells with several regions, or with a
        region of variable stiffness.
    share : array
        Fraction of the cell inside the region.
    """

    number: NDArray[np.int_]
    share: FloatArray

    @property
    def whole(self) -> NDArray[np.int_]:
        """Number of the region with uniform stiffness that fills a cell completely, otherwise 0."""
        return np.where((self.number > 0) & (self.share == 1.0), self.number, 0)


def content_of(box: CellBox, sources: Sequence[Inhomogeneity], grid: Grid, points: Points) -> Content:
    """Content of the cells; cells count as empty if no point is in or next to their region."""
    from eigencontact.execution.interiors.material_cells import share_of

    number, filled = np.zeros(box.lattice.shape, dtype=int), np.zeros(box.lattice.shape)
    for name, source in enumerate(sources, 1):
        assert source.lattice is not None
        if not _near(source, points, 2.0 * max(source.lattice.edges)).size:
            continue
        share = share_of(sources, name - 1, grid)
        place = place_in(box, source.lattice)
        occupied, whole = share > _LEAST, share > 1.0 - _LEAST
        single_material = (whole | (number[place] == 0)) & (source.uniform_law is not None)
        number[place] = np.where(occupied, np.where(single_material, name, -1), number[place])
        filled[place] = np.where(occupied, np.where(whole, 1.0, share), filled[place])
    return Content(number, filled)


def number_at(sources: Sequence[Inhomogeneity], points: Points) -> NDArray[np.int_]:
    """Number (from 1) of the region that contains each point, ``(n,)``, or 0; the later region counts in overlaps."""
    out = np.zeros(points[0].size, dtype=int)
    for number, source in enumerate(sources, 1):
        where = _near(source, points)
        if where.size:
            x, y, z = (axis[where] for axis in points)
            out[where[source.shape.contains(x, y, z)]] = number
    return out


def empty_points(sources: Sequence[Inhomogeneity], lattice: RegionLattice) -> NDArray[np.bool_] | None:
    """Whether points of a lattice are in a void, ``(n,)``, the later region in overlaps; None without voids."""
    if not any(source.is_empty for source in sources):
        return None
    empty = np.array([False, *(source.is_empty for source in sources)])
    out = empty[number_at(sources, lattice.flat_points())]
    return out if out.any() else None


def read_by_own_laws(
    stress: FloatArray,
    within: WithinCells,
    eigenstrain: FloatArray,
    sources: Sequence[Inhomogeneity],
    matrix: Material,
    time: float,
) -> None:
    """Replace the stress in softer regions by the stress of their law, C_i (M σ + ε* - ε_p).

    The ratio of the stiffnesses, below one here, then reduces the discretization error of the stress. In stiffer
    regions it would increase the error, so their stress is not changed.

    Parameters
    ----------
    stress : (6, n)
        Stress by all causes at the points of `within` [Pa]; the function changes it.
    eigenstrain : (6, nz, ny, nx)
        Eigenstrain ε* of the cells, prestrain ε_p included [-].
    """
    stiffnesses = {n: tensor for n, source in enumerate(sources, 1) if (tensor := _softer(source, matrix)) is not None}
    if not stiffnesses:
        return
    where, number, smooth = within.inside(eigenstrain)
    strain = compliance(matrix) @ stress[:, where] + smooth
    for region, stiffness in stiffnesses.items():
        mask = number == region
        prestrain = sources[region - 1].uniform_eigenstrain(time)
        stress[:, where[mask]] = stiffness @ (strain[:, mask] - prestrain[:, None])


def stiffness_beside(source: Inhomogeneity, matrix: Material) -> tuple[FloatArray, FloatArray] | None:
    """Finite Mandel stiffness of a region with one law, its prestrain, and its six ratios to the body's."""
    law = source.uniform_law
    if law is None or not source.field.uniform:
        return None
    try:
        stiffness = law.stiffness_matrix()
    except SceneError:  # it is not finite
        return None
    ratios = np.linalg.eigvals(stiffness @ compliance(matrix)).real
    return stiffness, np.asarray(ratios, dtype=float)


def _softer(source: Inhomogeneity, matrix: Material) -> FloatArray | None:
    """Mandel stiffness of a region with uniform stiffness below that of the body, otherwise None."""
    stiffness = stiffness_beside(source, matrix)
    return stiffness[0] if stiffness is not None and stiffness[1].max() < _SOFTER else None


def _near(source: Inhomogeneity, points: Points, room: float = 0.0) -> NDArray[np.intp]:
    """Indices of the points within the bounds of a region, with a margin."""
    low, high = source.shape.bounds
    inside = [(lo - room <= at) & (at <= hi + room) for lo, at, hi in zip(low, points, high, strict=True)]
    return np.flatnonzero(np.logical_and.reduce(inside))
