"""Values at the centres of cells from means over cells, by a stencil that is exact for quadratic fields.

The stress of tractions is a mean over each cell, and the displacement of the surface follows from means of the
eigenstrain. A law, however, acts at a point. If a field is smooth, its mean over a cell exceeds the value at the centre
by ``h²/24`` times the second derivative along each edge h. Second differences of the means approximate these
derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from eigencontact.core.array_types import BoolArray, FloatArray, IntArray
from eigencontact.core.parallel import in_parallel

__all__ = ["Faces", "centre_values", "linked_faces"]

Faces = tuple[BoolArray, BoolArray, BoolArray]

#: The mean of a parabola over an interval h exceeds its value at the centre by h²/24 times its second derivative.
_SHARE = 1.0 / 24.0


def linked_faces(groups: Sequence[IntArray], shape: tuple[int, int, int]) -> Faces | None:
    """Faces between neighbours of one group, along z, y, x; None without faces.

    Parameters
    ----------
    groups : sequence of (n,) int
        Flat indices of the cells of each group.
    shape : (nz, ny, nx)
        Shape of the box of cells.

    Returns
    -------
    tuple of bool arrays
        ``(nz - 1, ny, nx)``, ``(nz, ny - 1, nx)`` and ``(nz, ny, nx - 1)``, or None.
    """
    number = np.zeros(int(np.prod(shape)), dtype=np.int32)
    for group, cells in enumerate(groups, 1):
        number[cells] = group
    number = number.reshape(shape)
    along_z = (number[1:] == number[:-1]) & (number[1:] > 0)
    along_y = (number[:, 1:] == number[:, :-1]) & (number[:, 1:] > 0)
    along_x = (number[:, :, 1:] == number[:, :, :-1]) & (number[:, :, 1:] > 0)
    return (along_z, along_y, along_x) if along_z.any() or along_y.any() or along_x.any() else None


def centre_values(means: FloatArray, faces: Faces, threads: int = 1) -> FloatArray:
    """Values at the centres of cells, from means ``(..., nz, ny, nx)``: ``f_i - (1/24) Σ_j (f_j - f_i)``.

    The sum is over the neighbours j across `faces`. The map is symmetric, preserves uniform fields and the sum over all
    cells, and has eigenvalues from 1 to 1.5. Its transpose is the map itself. Stress of tractions at centres and
    displacement by eigenstrain at centres are therefore reciprocal. Threads share the fields along the first axes.

    Examples
    --------
    >>> edges = np.arange(5.0)
    >>> means = (np.diff(edges**3) / 3.0).reshape(1, 1, 4)
    >>> faces = linked_faces([np.arange(4)], (1, 1, 4))
    >>> centre_values(means, faces).ravel()[1:3]
    array([2.25, 6.25])
    """
    out = np.array(means, dtype=float, order="C")
    weights = [_SHARE if linked.all() else _SHARE * linked for linked in faces]

    def centre(index: tuple[int, ...]) -> None:
        """One field, which fits into the cache."""
        place = _place(means[index])
        field, into = means[index][place], out[index][place]
        for axis, weight in enumerate(weights):
            before = (slice(None),) * axis
            low, high = (*before, slice(None, -1)), (*before, slice(1, None))
            step = field[high] - field[low]
            step *= weight if isinstance(weight, float) else weight[place][tuple(slice(size) for size in step.shape)]
            into[low] -= step
            into[high] += step

    in_parallel(threads, [partial(centre, index) for index in np.ndindex(out.shape[:-3])])
    return out


def _place(field: FloatArray) -> tuple[slice, slice, slice]:
    """Box around all nonzero cells and their neighbours."""
    present, spans = field != 0.0, []
    for axes in ((1, 2), (0, 2), (0, 1)):
        cells = np.flatnonzero(present.any(axis=axes))
        spans.append(slice(max(int(cells[0]) - 1, 0), int(cells[-1]) + 2) if cells.size else slice(0))
    return spans[0], spans[1], spans[2]
