"""Means of a field over the cells around the points, by the same sums as values at the points.

Values at the cell centres are nearly insensitive to an eigenstrain that alternates from cell to cell. An equation for
the eigenstrain therefore needs means. The exact operator from eigenstrain to mean stress in the same cells is symmetric
and never releases energy. The operator to values at the centres releases energy (its eigenvalues of the wrong sign
reach 10 % of the largest in a box of 5 x 5 x 5 cubes), so that an equation for soft cells may have no useful solution.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.halfspace.endless import EndlessCell
from eigencontact.halfspace.forms import Kernel
from eigencontact.halfspace.potentials import HasCornerPotentials
from eigencontact.solvers.eigenstrain import VolumeField

__all__ = ["MeanVolumeField"]

# Gauss points along the shortest edge of a cell.
_FEWEST = 2
# Most Gauss points along the longest edge of a cell.
_MOST = 5


class MeanVolumeField(VolumeField):
    """A `VolumeField` whose values are means over cells around the target points.

    The field of the cells themselves is averaged over Gauss points (2 x 2 x 2 in a cube, up to 5 along the long edges
    of flat cells) when the kernels are sampled. Set-up takes longer, an application does not. The field of the mirror
    images, which is multiplied by powers of the depth, is averaged along x and y only; along z it is smooth, except for
    cells at the surface.
    """

    def _tables(
        self,
        cell: HasCornerPotentials,
        group: Sequence[Kernel],
        nodes: tuple[NDArray[Any], NDArray[Any], NDArray[Any]],
        *,
        far: bool,
    ) -> NDArray[np.float64]:
        edges = [axis[1] - axis[0] for axis in nodes]
        rules = [_rule(float(edge / min(edges))) for edge in edges]
        if isinstance(cell, EndlessCell):
            rules = [_rule(float(edge / min(edges[0], edges[2]))) for edge in edges]
            rules[1] = [(0.0, 1.0)]
        if group[0][0] == "image":
            rules[2] = [(0.0, 1.0)]
        out = np.zeros((len(group), *(axis.size - 1 for axis in nodes)))
        for (x, weight_x), (y, weight_y), (z, weight_z) in product(*rules):
            shifted = [axis + offset * edge for axis, offset, edge in zip(nodes, (x, y, z), edges, strict=True)]
            tables = super()._tables(cell, group, (shifted[0], shifted[1], shifted[2]), far=far)
            out += np.multiply(tables, weight_x * weight_y * weight_z, out=tables)
        return out


def _rule(slenderness: float) -> list[tuple[float, float]]:
    """Points and weights on (-1/2, 1/2) along an edge, by the ratio of its length to the shortest edge."""
    count = min(_MOST, max(_FEWEST, int(np.ceil(slenderness - 1e-9)) + 1))
    points, weights = np.polynomial.legendre.leggauss(count)
    return [(0.5 * float(point), 0.5 * float(weight)) for point, weight in zip(points, weights, strict=True)]
