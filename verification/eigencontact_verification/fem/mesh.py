"""Graded tensor-product meshes of hexahedra, aligned with the axes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import skfem
from numpy.typing import NDArray
from skfem.refdom import RefHex

from eigencontact_verification.fem.model import Model

__all__ = ["Grid", "build_grid", "graded_lines"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Places where the grading of one segment is tabulated: dense at its ends, where anchors begin.
_HALF = np.geomspace(1e-8, 0.5, 3000)
_TABLE = np.concatenate(([0.0], _HALF, 1 - _HALF[-2::-1], [1.0]))


def graded_lines(
    low: float,
    high: float,
    *,
    breaks: tuple[float, ...],
    anchors: tuple[tuple[float, float], ...],
    fine: float,
    growth: float,
    refine: int = 1,
) -> FloatArray:
    """Coordinates of mesh lines from low to high.

    Parameters
    ----------
    low, high : float
        Ends of the axis.
    breaks : tuple of float
        Places between the ends where a line has to fall.
    anchors : tuple of (float, float)
        Intervals where edges are `fine` long; away from them an edge is longer by the factor `growth` than the one
        before it.
    fine, growth : float
        Edge length at the anchors, and ratio of neighbours.
    refine : int
        Parts of every edge.

    Returns
    -------
    (n + 1,) array
        Ascending. Lines of ``refine = 1`` are among those of every other `refine`.

    Notes
    -----
    Edges follow ``h(t) = fine + ln(growth) dist(t, anchors)``: line k of a segment is where the integral of 1/h is
    k/n of the whole. The edges of a segment are shorter than h asks for, since n is a whole number.

    Examples
    --------
    >>> graded_lines(0.0, 2.0, breaks=(1.0,), anchors=((0.0, 2.0),), fine=0.5, growth=1.3).tolist()
    [0.0, 0.5, 1.0, 1.5, 2.0]
    """
    tiny = 1e-9 * (high - low)
    ends = [low]
    for place in sorted(breaks):
        if ends[-1] + tiny < place < high - tiny:
            ends.append(place)
    ends.append(high)
    stretches = [np.array([low])]
    for start, stop in pairwise(ends):
        t = start + (stop - start) * _TABLE
        distance = np.min([np.maximum(np.maximum(a - t, t - b), 0.0) for a, b in anchors], axis=0)
        density = 1 / (fine + np.log(growth) * distance)
        count = np.concatenate(([0.0], np.cumsum((density[1:] + density[:-1]) / 2 * np.diff(t))))
        number = max(1, int(np.ceil(count[-1] - 1e-6))) * refine
        lines = np.interp(np.arange(1, number + 1) / number * count[-1], count, t)
        lines[-1] = stop
        stretches.append(lines)
    return np.concatenate(stretches)


@dataclass(frozen=True, kw_only=True)
class Grid:
    """Mesh of boxes, its elements of one kind, and the numbers of their nodes.

    Attributes
    ----------
    lines : (x, y, z) of arrays
        Coordinates of the mesh lines; element (i, j, k) has the number ``(k ny + j) nx + i``.
    order : int
        1: 8 nodes, 2: 27 nodes (triquadratic).
    """

    lines: tuple[FloatArray, FloatArray, FloatArray]
    order: int

    @cached_property
    def shape(self) -> tuple[int, int, int]:
        """Elements along x, y, z."""
        x, y, z = (line.size - 1 for line in self.lines)
        return x, y, z

    @property
    def elements(self) -> int:
        """Number of elements."""
        return int(np.prod(self.shape))

    @cached_property
    def element(self) -> Any:
        """Scalar element of scikit-fem."""
        return skfem.ElementHex1() if self.order == 1 else skfem.ElementHex2()

    @cached_property
    def low(self) -> FloatArray:
        """Lowest corner of every element, (elements, 3)."""
        return self._of_elements([line[:-1] for line in self.lines])

    @cached_property
    def size(self) -> FloatArray:
        """Edges of every element, (elements, 3)."""
        return self._of_elements([np.diff(line) for line in self.lines])

    @staticmethod
    def _of_elements(along: list[FloatArray]) -> FloatArray:
        z, y, x = np.meshgrid(along[2], along[1], along[0], indexing="ij")
        return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)

    @cached_property
    def mesh(self) -> Any:
        """Mesh of scikit-fem whose reference coordinates run along x, y, z in every element."""
        z, y, x = np.meshgrid(self.lines[2], self.lines[1], self.lines[0], indexing="ij")
        nx, ny, _ = self.shape
        first = np.arange(self.elements)
        i, j, k = first % nx, first // nx % ny, first // (nx * ny)
        corners = [((k + c) * (ny + 1) + j + b) * (nx + 1) + i + a for a, b, c in RefHex.p.T.astype(int)]
        return skfem.MeshHex(np.stack([x.ravel(), y.ravel(), z.ravel()]), np.stack(corners))

    @cached_property
    def axes(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Coordinates of the nodes along x, y, z; the nodes are their tensor product."""
        x, y, z = (
            line if self.order == 1 else np.interp(np.arange(2 * line.size - 1) / 2, np.arange(line.size), line)
            for line in self.lines
        )
        return x, y, z

    @cached_property
    def element_nodes(self) -> IntArray:
        """Nodes of every element, (elements, 8 or 27), in scikit-fem's local order."""
        nx, ny, _ = self.shape
        mx, my, _ = (axis.size for axis in self.axes)
        first = np.arange(self.elements)
        start = (first % nx, first // nx % ny, first // (nx * ny))
        a, b, c = (self.order * s[:, None] + p for s, p in zip(start, self.local.T, strict=True))
        return np.asarray((c * my + b) * mx + a)

    @property
    def local(self) -> IntArray:
        """Places of an element's nodes along x, y, z, (8 or 27, 3), from 0 to order."""
        return np.asarray(np.rint(self.order * self.element.doflocs), dtype=np.int64)

    @cached_property
    def nodes(self) -> FloatArray:
        """Coordinates of the nodes, (nodes, 3), sorted by z, then y, then x."""
        z, y, x = np.meshgrid(*self.axes[::-1], indexing="ij")
        return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)

    def shapes(self, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Shape functions and their reference gradients.

        Parameters
        ----------
        at : (points, 3) array
            Reference coordinates in [0, 1].

        Returns
        -------
        (points, local nodes), (points, local nodes, 3) arrays
        """
        pairs = [self.element.lbasis(at.T, i) for i in range(len(self.element.doflocs))]
        values = [np.broadcast_to(value, at.shape[:1]) for value, _ in pairs]
        slopes = [np.stack([np.broadcast_to(d, at.shape[:1]) for d in slope], axis=-1) for _, slope in pairs]
        return np.stack(values, axis=1), np.stack(slopes, axis=1)


def build_grid(model: Model) -> Grid:
    """Mesh of a model: lines on the bounds of regions, edges of patches and interfaces of layers."""
    breaks: list[list[float]] = [[0.0], [0.0], []]  # a full model has the mesh of its halves
    anchors: list[list[tuple[float, float]]] = [[], [], [(0.0, 0.0)]]
    lows = [-model.reach if kind == "none" else 0.0 for kind in model.symmetry] + [0.0]
    boxes = [tuple(zip(*region.bounds, strict=True)) for region in model.regions]
    boxes += [tuple(zip((*patch.low, 0.0), (*patch.high, 0.0), strict=True)) for patch in model.patches]
    for box in boxes:
        for axis, (a, b) in enumerate(box):
            breaks[axis] += [a, b]
            if b >= lows[axis]:
                anchors[axis].append((max(a, lows[axis]), b))
    breaks[2] += np.cumsum([layer.thickness for layer in model.layers]).tolist()
    for axis in (0, 1):
        if not boxes:
            anchors[axis] = [(0.0, 0.0)]
        if not anchors[axis]:
            raise ValueError(
                f"Model.symmetry[{axis}] must leave a source in the mesh (got all of them on the other side)"
            )
    x, y, z = (
        graded_lines(
            lows[axis],
            model.reach,
            breaks=tuple(breaks[axis]),
            anchors=tuple(anchors[axis]),
            fine=model.fine,
            growth=model.growth,
            refine=model.refine,
        )
        for axis in range(3)
    )
    return Grid(lines=(x, y, z), order=model.order)
