"""What layers add to closed half-space kernels: a smooth field, computed at two resolutions.

The wavenumber response of this remainder decays with exp(-ks). It goes to space along `layered_waves` and
`layered_hankel` on nodes, and over rectangles by `layered_cells`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.symmetry import parity
from eigencontact.halfspace.layered_cells import StretchedNodes
from eigencontact.halfspace.layered_hankel import LogGrid
from eigencontact.halfspace.layered_waves import DIRECTIONS, AxisResponse, angular_orders

__all__ = ["SmoothField"]

FloatArray = NDArray[np.float64]

# For a resolution of 1: spacing of ln k and of the stretched coordinate of the nodes, and the range of k.
LOG_STEP = 0.07
NODE_STEP = 0.12
LOWEST = 1e-14
HIGHEST = 50.0


@dataclass(frozen=True)
class SmoothField:
    """Field of a point traction whose wavenumber response decays with exp(-ks).

    Parameters
    ----------
    response : callable
        All components `names`, Mandel, for waves of the traction with wavevectors on the axes.
    traction : "p", "q_x" or "q_y"
    names : sequence of str
        What `response` returns.
    components : sequence of str
        Those wanted.
    scale : float
        Length s [m].
    slowest : float
        Length [m] over which the response at small k still changes: the longest one in it.
    reach : float
        Largest coordinate of a rectangle's edge [m].
    resolution : float
        Factor on the density of all grids; the range of wavenumbers widens with it, so that two resolutions that agree
        vouch for the range too.
    """

    response: AxisResponse
    traction: str
    names: Sequence[str]
    components: Sequence[str]
    scale: float
    slowest: float
    reach: float
    resolution: float
    nodes: StretchedNodes = field(init=False)
    values: list[FloatArray] = field(init=False)
    parities: list[tuple[int, int]] = field(init=False)

    def __post_init__(self) -> None:
        nodes = StretchedNodes(self.scale, self.reach, NODE_STEP / self.resolution)
        grid = LogGrid(
            scale=self.scale,
            distance=max(1.5 * float(nodes.x[-1]), self.slowest),
            step=LOG_STEP / self.resolution,
            lowest=LOWEST / self.resolution**4,
            highest=HIGHEST * self.resolution,
        )
        k = grid.wavenumbers
        # The nodes are the same in x and y: half of the distances are enough.
        row, column = np.triu_indices(nodes.x.size)
        to_space = grid.onto(np.hypot(nodes.x[row], nodes.x[column]))
        object.__setattr__(self, "nodes", nodes)
        object.__setattr__(self, "parities", [parity(name, DIRECTIONS[self.traction]) for name in self.components])
        angle = np.arctan2(nodes.x[:, None], nodes.x[None, :])
        found = []
        orders_of = angular_orders(self.response, self.traction, self.names, self.components, k)
        for (in_y, _), orders in zip(self.parities, orders_of, strict=True):
            wave = np.cos if in_y > 0 else np.sin
            total = np.zeros(angle.shape)
            for order, amplitude in orders.items():
                radial = np.empty(angle.shape)
                radial[row, column] = radial[column, row] = to_space(k * amplitude, order)
                total += radial * wave(order * angle) if order else radial
            found.append(total)
        object.__setattr__(self, "values", found)

    def weights(self, centres: FloatArray, half_width: float) -> dict[int, FloatArray]:
        """Weights of the integrals over intervals about `centres`, for even and odd functions; see `StretchedNodes`."""
        return self.nodes.integrals(centres - half_width, centres + half_width)

    def on_lattice(self, x: FloatArray, y: FloatArray, half_widths: tuple[float, float]) -> FloatArray:
        """Integrals over the rectangles about a lattice of centres, ``(len(components), ny, nx)``."""
        across, along = self.weights(x, half_widths[0]), self.weights(y, half_widths[1])
        return np.array(
            [along[in_y] @ G @ across[in_x].T for G, (in_y, in_x) in zip(self.values, self.parities, strict=True)]
        )

    def at_points(self, x: FloatArray, y: FloatArray, half_widths: tuple[float, float]) -> FloatArray:
        """Integrals over the rectangles about points ``(m,)``, ``(len(components), m)``."""
        out = np.empty((len(self.components), x.size))
        block = max(1, 4_000_000 // self.nodes.x.size)
        for start in range(0, x.size, block):
            part = slice(start, start + block)
            across, along = self.weights(x[part], half_widths[0]), self.weights(y[part], half_widths[1])
            for row, (G, (in_y, in_x)) in enumerate(zip(self.values, self.parities, strict=True)):
                out[row, part] = np.einsum("pj,pj->p", along[in_y] @ G, across[in_x])
        return out
