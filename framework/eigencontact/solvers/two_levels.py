"""Stress in a box of cells, a part of which (the patch) is divided into finer cells.

Outside the patch every cell has an eigenstrain, and inside it every fine cell. In a rim of the patch, one coarse cell
wide, fine cells carry the eigenstrain of their coarse cell. The field of the coarse box is accurate far from its
sources. The fine box adds the difference in the field of the patch:

    σ_fine = A_f e_f + I (A_c e_c - A_p e_p),    σ_rim = mean of σ_fine over each coarse cell.

A_c, A_f and A_p give the mean stress in cells of the coarse box, of the fine patch and of the coarse patch. The
difference in brackets is the field of the eigenstrain outside the patch, which is smooth inside the rim. I interpolates
means over coarse cells to means over fine cells. Its transpose W, times the ratio of volumes, distributes eigenstrain
of fine cells to coarse ones: e_p = W e_f. The interpolation preserves the means over coarse cells. A uniform
eigenstrain in a coarse cell therefore stays unchanged, and eigenstrain keeps its total and its moments up to the
fourth. The operator of both levels is symmetric because each of its parts is symmetric.

References
----------
W. Hackbusch 1984, Local defect correction method and domain decomposition techniques, Computing Suppl. 5, 89.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.errors import require
from eigencontact.solvers.eigenstrain import VolumeField

__all__ = ["TwoLevels", "interpolation"]

Place = tuple[slice, slice, slice]

#: Number of coarse intervals along each axis for the interpolation of a value.
_WIDTH = 5


def interpolation(count: int, ratio: int) -> FloatArray:
    """Means over fine intervals from means over `count` coarse ones, ``(count * ratio, count)``, by polynomials.

    The polynomial of an interval has the means of the interval and of its nearest neighbours, five in all if there are
    as many.

    Examples
    --------
    >>> edges = np.arange(6.0)
    >>> coarse, fine = (np.diff(x**5) / np.diff(x) for x in (edges, np.linspace(0.0, 5.0, 11)))
    >>> np.allclose(interpolation(5, 2) @ coarse, fine)
    True
    """
    width = min(_WIDTH, count)
    out = np.zeros((count, ratio, count))
    for cell in range(count):
        first = min(max(cell - width // 2, 0), count - width)
        coarse = _powers(np.arange(first - cell, first - cell + width + 1.0), width)
        fine = _powers(np.arange(ratio + 1.0) / ratio, width)
        out[cell, :, first : first + width] = np.linalg.solve(coarse.T, fine.T).T
    return out.reshape(count * ratio, count)


def _powers(edges: FloatArray, count: int) -> FloatArray:
    """Means of the first powers, from 0, over intervals."""
    powers = np.arange(1, count + 1)
    return np.asarray(np.diff(edges[:, None] ** powers, axis=0) / powers / np.diff(edges)[:, None])


class TwoLevels:
    """Stress in the cells of both levels.

    Parameters
    ----------
    coarse, patch, fine : VolumeField
        Operators from cells to the same cells: of the whole coarse box, of the coarse cells of the patch, and of its
        fine cells.
    inner : (slice, slice, slice)
        Coarse cells of the patch inside the rim, along z, y, x.

    Attributes
    ----------
    place : (slice, slice, slice)
        Position of the patch in the coarse box.
    ratio : int
        Number of fine cells along an edge of a coarse cell.
    applications : int
        Number of computations of the stress.
    """

    def __init__(self, coarse: VolumeField, patch: VolumeField, fine: VolumeField, inner: Place) -> None:
        self._coarse, self._patch, self._fine, self._inner = coarse, patch, fine, inner
        box, patch_box = coarse.source, patch.source
        first = [round((p - w) / d) for p, w, d in zip(patch_box.first, box.first, box.pitch, strict=True)][::-1]
        inside = all(k >= 0 and k + n <= m for k, n, m in zip(first, patch_box.shape, box.shape, strict=True))
        require(inside, "cells", "patch", patch_box.shape, f"within the box of {box.shape} cells")
        self.place: Place = tuple(slice(k, k + n) for k, n in zip(first, patch_box.shape, strict=True))  # type: ignore[assignment]
        self.ratio = fine.source.shape[0] // patch_box.shape[0]
        self._along = [interpolation(n, self.ratio) for n in patch_box.shape]
        self.applications = 0
        self._last: tuple[FloatArray, FloatArray, FloatArray, FloatArray] | None = None

    def interpolated(self, coarse: FloatArray) -> FloatArray:
        """Means over fine cells ``(..., nz, ny, nx)`` of the patch from means over all coarse cells."""
        return _mapped(coarse[..., *self.place], self._along)

    def spread(self, fine: FloatArray) -> FloatArray:
        """Eigenstrain ``(6, nz, ny, nx)`` of all coarse cells that represents the fine cells."""
        out = np.zeros((len(fine), *self._coarse.source.shape))
        out[:, *self.place] = _mapped(fine, [matrix.T / self.ratio for matrix in self._along])
        return out

    def means(self, fine: FloatArray) -> FloatArray:
        """Means ``(..., nz, ny, nx)`` over the coarse cells of the patch."""
        r, shape = self.ratio, self._patch.source.shape
        split = fine.reshape(*fine.shape[:-3], *(m for n in shape for m in (n, r)))
        return np.asarray(split.mean(axis=(-5, -3, -1)))

    def put_means(self, values: FloatArray, fine: FloatArray) -> None:
        """Write means over the fine cells inside the rim to an array of all coarse cells."""
        values[..., *self.place][..., *self._inner] = self.means(fine)[..., *self._inner]

    def stress(self, coarse: FloatArray, fine: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Mean stress [Pa] in coarse and in fine cells by their eigenstrain, each ``(6, nz, ny, nx)``.

        Coarse cells inside the rim and fine cells of the rim must have zero eigenstrain. Their stress in the result is
        meaningless.
        """
        last = self._last
        if last is None or not (np.array_equal(last[0], coarse) and np.array_equal(last[1], fine)):
            last = self._last = coarse.copy(), fine.copy(), *self._stress(coarse, fine)
        return last[2], last[3]

    def _stress(self, coarse: FloatArray, fine: FloatArray) -> tuple[FloatArray, FloatArray]:
        self.applications += bool(coarse.any() or fine.any())
        around = coarse[:, *self.place]
        total = coarse + self.spread(fine) if fine.any() else coarse
        of_coarse = _applied(self._coarse, total)
        of_fine = self.interpolated(of_coarse)
        if fine.any() or around.any():
            missing = _applied(self._fine, fine + self._repeated(around))
            missing -= _mapped(_applied(self._patch, total[:, *self.place]), self._along)
            of_fine += missing
            of_coarse[:, *self.place] += self.means(missing)
        return of_coarse, of_fine

    def _repeated(self, coarse: FloatArray) -> FloatArray:
        for axis in (-3, -2, -1):
            coarse = np.repeat(coarse, self.ratio, axis=axis)
        return coarse


def _mapped(values: FloatArray, along: list[FloatArray]) -> FloatArray:
    """Values ``(..., nz, ny, nx)`` mapped by a matrix along each axis."""
    return np.asarray(np.einsum("Kk,Jj,Ii,...kji->...KJI", *along, values, optimize=True))


def _applied(operator: Any, eigenstrain: FloatArray) -> FloatArray:
    return np.array(operator.apply(eigenstrain), dtype=float) if eigenstrain.any() else np.zeros_like(eigenstrain)
