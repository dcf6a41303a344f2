"""Field of the eigenstrain in a box of cells on a much finer lattice over a small part of the box.

The field of cells near the part is summed exactly: a fine lattice consists of lattices with the pitch of the cells,
shifted by fractions of a cell, with one convolution each. The field of all other cells is smooth there. It is computed
once with the pitch of the cells, and interpolated.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from eigencontact.core.array_types import FloatArray
from eigencontact.errors import require
from eigencontact.halfspace.potentials import HasCornerPotentials
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.eigenstrain import VolumeField

__all__ = ["close_up"]

#: Distance from the points, in the longest edge of a cell, within which cells are summed exactly. The field of all
#: other cells is interpolated, with an error of about 1e-5 of its largest value.
_REACH = 6
#: Points on each side beyond the part, for the interpolation.
_MORE = 3
#: Degree of the interpolation.
_DEGREE = 5


def close_up(
    cell: HasCornerPotentials,
    source: Cells,
    eigenstrain: ArrayLike,
    target: Cells,
    *,
    poisson_ratio: float,
    quantity: str = "stress",
    space: str = "half",
    shear_modulus: float = 1.0,
    threads: int | None = None,
) -> FloatArray:
    """Field on a fine lattice.

    Parameters
    ----------
    cell : HasCornerPotentials
        Shape of the cells: the cuboid.
    source : Cells
        Cells that carry the eigenstrain.
    eigenstrain : (6, nz, ny, nx)
        Mandel eigenstrain [-].
    target : Cells
        Points; along each axis the pitch is that of the cells divided by a whole number.
    poisson_ratio, quantity, space, shear_modulus, threads
        See `eigencontact.solvers.eigenstrain.VolumeField`.

    Returns
    -------
    (3 or 6, tz, ty, tx)
        Displacement, or Mandel strain or stress. On faces between cells strain and stress are the means of both sides.

    Raises
    ------
    SceneError
        A pitch does not divide the cells, or points are in the surface above cells at the surface.
    """
    strain = np.asarray(eigenstrain, dtype=float)
    require(strain.shape == (6, *source.shape), "close-up", "eigenstrain", strain.shape, f"(6, *{source.shape})")
    finer = _finer(source, target)
    options: dict[str, Any] = {
        "poisson_ratio": poisson_ratio,
        "quantity": quantity,
        "space": space,
        "shear_modulus": shear_modulus,
        "threads": threads,
        "applications": float(np.prod(finer)),
    }
    out = np.zeros((3 if quantity == "displacement" else 6, *target.shape))
    near, far_strain = _split(source, target, strain)
    if far_strain.any():
        out += _interpolated(cell, source, far_strain, target, options)
    if near is None:
        return out
    near_cells = Cells(
        first=tuple(source.first[a] + near[2 - a].start * source.pitch[a] for a in range(3)),
        pitch=source.pitch,
        shape=tuple(where.stop - where.start for where in near),
    )
    inner = strain[(slice(None), *near)]
    for shift in product(*(range(min(n, count)) for n, count in zip(finer, target.shape, strict=True))):
        where = tuple(slice(begin, None, n) for begin, n in zip(shift, finer, strict=True))
        points = Cells(
            first=tuple(target.first[a] + shift[2 - a] * target.pitch[a] for a in range(3)),  # type: ignore[arg-type]
            pitch=source.pitch,
            shape=tuple(-(-(n - begin) // m) for n, begin, m in zip(target.shape, shift, finer, strict=True)),  # type: ignore[arg-type]
        )
        out[(slice(None), *where)] += VolumeField(cell, near_cells, points, **options).apply(inner)
    return out


def _finer(source: Cells, target: Cells) -> tuple[int, int, int]:
    """Refinement of the points along (z, y, x)."""
    ratio = np.divide(source.pitch, target.pitch)
    multiples = np.maximum(1, np.rint(ratio))
    good = np.allclose(ratio, multiples, rtol=1e-9, atol=0.0)
    require(good, "close-up", "pitch of points", target.pitch, f"{source.pitch} divided by whole numbers [m]")
    return int(multiples[2]), int(multiples[1]), int(multiples[0])


def _split(source: Cells, target: Cells, strain: FloatArray) -> tuple[tuple[slice, slice, slice] | None, FloatArray]:
    """Part (z, y, x) of the cells near the points with eigenstrain, or None; and the eigenstrain of all other cells."""
    slices = []
    for axis in (2, 1, 0):
        points, edge, count = target.centres(axis), source.pitch[axis], source.shape[2 - axis]
        reach = int(np.ceil(_REACH * max(source.pitch) / edge))
        begin = int(np.floor((points[0] - source.first[axis]) / edge + 0.5)) - reach
        end = int(np.floor((points[-1] - source.first[axis]) / edge + 0.5)) + reach + 1
        slices.append(slice(min(max(begin, 0), count), min(max(end, 0), count)))
    near = (slices[0], slices[1], slices[2])
    far_strain = strain.copy()
    far_strain[(slice(None), *near)] = 0.0
    carried = np.any(strain[(slice(None), *near)] != 0.0, axis=0)
    if not carried.any():
        return None, far_strain
    tight = [np.flatnonzero(carried.any(axis=tuple({0, 1, 2} - {axis}))) for axis in range(3)]
    z, y, x = (
        slice(where.start + int(hit[0]), where.start + int(hit[-1]) + 1) for where, hit in zip(near, tight, strict=True)
    )
    return (z, y, x), far_strain


def _interpolated(
    cell: HasCornerPotentials, source: Cells, strain: FloatArray, target: Cells, options: dict[str, Any]
) -> FloatArray:
    """Field of cells far from the points, by splines through its values at points with the pitch of the cells."""
    from scipy.interpolate import make_interp_spline

    first, shape = [], []
    for axis in range(3):
        points, edge = target.centres(axis), source.pitch[axis]
        begin = int(np.floor((points[0] - source.first[axis]) / edge)) - _MORE
        end = int(np.ceil((points[-1] - source.first[axis]) / edge)) + _MORE + 1
        if axis == 2 and options["space"] == "half":
            begin = max(begin, -int(np.floor(source.first[axis] / edge + 1e-9)))
        first.append(source.first[axis] + begin * edge)
        shape.append(end - begin)
    coarse = Cells(first=(first[0], first[1], first[2]), pitch=source.pitch, shape=(shape[2], shape[1], shape[0]))
    out = np.asarray(VolumeField(cell, source, coarse, **options).apply(strain), dtype=float)
    for axis in range(3):
        along = 3 - axis
        degree = min(_DEGREE, out.shape[along] - 1)
        out = make_interp_spline(coarse.centres(axis), out, k=degree, axis=along)(target.centres(axis))
    return out
