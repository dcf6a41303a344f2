"""Patch of finer cells around the inclusions of a body: its position in the cells of the body, and its own cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from eigencontact.core.grid import Grid
from eigencontact.model.sources import Inhomogeneity, Lattice, Patch

__all__ = ["divided", "divided_grid", "divided_members", "inner_bounds", "inner_of", "with_patch"]

#: Cells of the body beside its inclusions that are divided as well, and outermost cells of the patch that are not.
_MARGIN, _RIM = 2, 1


def with_patch(source: Inhomogeneity) -> Inhomogeneity:
    """Inclusion whose cells include the margin and the rim of its patch, below the surface."""
    lattice = source.lattice
    if lattice is None or source.guessed:
        return source
    more = _MARGIN + _RIM
    above = min(more, lattice.first[0])
    (k, j, i), (nz, ny, nx) = lattice.first, lattice.shape
    first, shape = (k - above, j - more, i - more), (nz + above + more, ny + 2 * more, nx + 2 * more)
    return replace(source, lattice=Lattice(first, shape, lattice.edges))


def inner_of(patch: Lattice) -> tuple[slice, slice, slice]:
    """Cells of a patch within its rim, along z, y, x; the surface has no rim."""
    nz, ny, nx = patch.shape
    return slice(_RIM if patch.first[0] else 0, nz - _RIM), slice(_RIM, ny - _RIM), slice(_RIM, nx - _RIM)


def inner_bounds(patch: Lattice, grid: Grid) -> Patch:
    """Region within the rim of a patch."""
    axes = [axis[place] for axis, place in zip(patch.axes(grid), inner_of(patch), strict=True)][::-1]
    edges = patch.edges[::-1]
    low = tuple(float(axis[0] - 0.5 * edge) for axis, edge in zip(axes, edges, strict=True))
    high = tuple(float(axis[-1] + 0.5 * edge) for axis, edge in zip(axes, edges, strict=True))
    return Patch(((low[0], low[1], low[2]), (high[0], high[1], high[2])))


def divided(lattice: Lattice, ratio: int) -> Lattice:
    """The same position in finer cells, on the columns of a finer grid."""
    (k, j, i), (nz, ny, nx), (dz, dy, dx) = lattice.first, lattice.shape, lattice.edges
    shape = (nz * ratio, ny * ratio, nx * ratio)
    return Lattice((k * ratio, j * ratio, i * ratio), shape, (dz / ratio, dy / ratio, dx / ratio))


def divided_grid(grid: Grid, ratio: int) -> Grid:
    """Grid of the same window with cells so many times finer."""
    return replace(grid, nx=grid.nx * ratio, ny=grid.ny * ratio, dx=grid.dx / ratio, dy=grid.dy / ratio)


def divided_members(members: Sequence[Inhomogeneity], patch: Lattice, inner: Patch, ratio: int) -> list[Inhomogeneity]:
    """Inhomogeneities of a body in the finer cells of a patch; the body's own law fills all cells inside the rim."""
    fine = divided(patch, ratio)
    first = [place.start * ratio for place in inner_of(patch)]
    shape = [(place.stop - place.start) * ratio for place in inner_of(patch)]
    (k, j, i), (nz, ny, nx) = (int(a + b) for a, b in zip(fine.first, first, strict=True)), shape
    within = Lattice((k, j, i), (nz, ny, nx), fine.edges)
    out = []
    for source in members:
        if source.guessed:
            out.append(
                Inhomogeneity(
                    name=source.name, where=source.where, key=source.key, body=source.body, shape=inner,
                    field=source.field, law=source.law, lattice=within,
                )
            )  # fmt: skip
        else:
            assert source.lattice is not None
            out.append(replace(source, lattice=divided(source.lattice, ratio)))
    return out
