"""Contribution of layers to closed half-space kernels: a smooth field at some depths, at several resolutions.

The wavenumber response of this remainder decays with exp(-ks). It goes to space along `layered_waves` and
`layered_hankel` on nodes, and over rectangles by `layered_cells`. The nodes and the transform depend on lengths alone:
all depths, all components and all tractions of a band of depths share them.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.products import product
from eigencontact.halfspace.layered_cells import StretchedNodes, Weights
from eigencontact.halfspace.layered_hankel import LogGrid
from eigencontact.halfspace.layered_waves import AxisResponse, radial_functions, turned

__all__ = ["RESOLUTIONS", "NodalField", "SmoothField"]

#: Resolutions are raised by these factors until two agree.
RESOLUTIONS = (1.0, 1.4, 2.0, 2.8, 4.0)
# For a resolution of 1: spacing of ln k, exponent of the accuracy of the nodes, and the range of k. For one coating of
# twice the modulus two resolutions then differ by some 1e-10 of the largest value; the finer one is right to 1e-13.
LOG_STEP = 0.14
DIGITS = 32.0
LOWEST = 1e-14
HIGHEST = 50.0


@dataclass(frozen=True)
class NodalField:
    """Values on nodes in one quadrant, all components, Mandel."""

    nodes: StretchedNodes
    #: ``(components, nz, n, n)`` in y and x.
    values: FloatArray
    #: Parity of each component (in y, in x).
    parities: list[tuple[int, int]]

    def on_cells(
        self, rows: list[int], number: int, x: FloatArray, y: FloatArray, half_widths: tuple[float, float]
    ) -> FloatArray:
        """Integrals over the rectangles about a lattice of centres at one depth, ``(len(rows), ny, nx)``."""
        across, along = self._weights(x, y, half_widths)
        out = np.empty((len(rows), y.size, x.size))
        for target, row in zip(out, rows, strict=True):
            in_y, in_x = self.parities[row]
            target[:] = product(product(along[in_y], self.values[row, number]), across[in_x].T)
        return out

    def _weights(self, x: FloatArray, y: FloatArray, half_widths: tuple[float, float]) -> tuple[Weights, Weights]:
        """Weights of the integrals along x, and along y; for a strip the same at all y."""
        across = self.nodes.integrals(x, half_widths[0])
        return across, self.nodes.integrals(y, half_widths[1]) if half_widths[1] < np.inf else self.nodes.strips(y.size)

    def moments(
        self, x: FloatArray, y: FloatArray, half_widths: tuple[float, float], load: FloatArray
    ) -> dict[tuple[int, int], FloatArray]:
        """Load ``(ny, nx)`` on the rectangles of `on_cells`, brought to the nodes: ``(n, n)`` for each parity.

        The sum of its products with nodal values is that with `on_cells`, at any depth, for any component.
        """
        across, along = self._weights(x, y, half_widths)
        halves = {in_x: product(load, weights) for in_x, weights in across.items()}
        return {(in_y, in_x): product(along[in_y].T, halves[in_x]) for in_y, in_x in set(self.parities)}

    def about_points(
        self, rows: list[int], number: int, x: FloatArray, y: FloatArray, half_widths: tuple[float, float]
    ) -> FloatArray:
        """Integrals over the rectangles about points ``(m,)`` at one depth, ``(len(rows), m)``."""
        out = np.empty((len(rows), x.size))
        block = max(1, 1_000_000 // self.nodes.count)
        for start in range(0, x.size, block):
            chunk = slice(start, start + block)
            across, along = self._weights(x[chunk], y[chunk], half_widths)
            for target, row in zip(out, rows, strict=True):
                in_y, in_x = self.parities[row]
                target[chunk] = np.einsum("pj,pj->p", product(along[in_y], self.values[row, number]), across[in_x])
        return out


@dataclass(frozen=True)
class SmoothField:
    """Field of a point traction at depths whose wavenumber response decays with exp(-ks).

    Parameters
    ----------
    response : callable
        For waves of the traction with wavevectors on the axes.
    traction : "p", "q_x" or "q_y"
    quantity : "displacement" or "stress"
    scale : float
        Length s [m], the smallest of the depths'.
    longest : float
        Length [m] over which the response at small k still changes.
    extent : float
        Largest coordinate of a rectangle's edge, stretched: asinh(x/s) [-].
    """

    response: AxisResponse
    traction: str
    quantity: str
    scale: float
    longest: float
    extent: float
    _radial: dict[float, FloatArray] = field(init=False, repr=False, compare=False, default_factory=dict)

    @property
    def nbytes(self) -> int:
        """Memory of the computed functions."""
        return sum(radial.nbytes for radial in list(self._radial.values()))

    def at(self, resolution: float) -> NodalField:
        """Field on nodes."""
        return self.of(self.radial(resolution), resolution)

    def radial(self, resolution: float) -> FloatArray:
        """Radial functions of the field, ``(functions, nz, m)``; computed once.

        The m distances are those of the nodes in half a quadrant: x and y have the same nodes. The density of all grids
        rises with `resolution`, and the range of wavenumbers widens with it, so that two resolutions that agree vouch
        for the range too.
        """
        if resolution not in self._radial:
            nodes, reach = self._nodes(resolution), self.scale * np.sinh(self.extent)
            grid = LogGrid(
                scale=self.scale,
                distance=max(1.5 * reach, self.longest),
                step=LOG_STEP / resolution,
                lowest=LOWEST / resolution**4,
                highest=HIGHEST * resolution,
            )
            functions, orders = radial_functions(self.response, self.traction, self.quantity, grid.wavenumbers)
            row, column = np.triu_indices(nodes.count)
            distances = np.hypot(nodes.x[row], nodes.x[column])
            self._radial[resolution] = np.array(grid.fields(functions, orders, distances))
        return self._radial[resolution]

    def of(self, radial: FloatArray, resolution: float) -> NodalField:
        """Field on nodes from its functions of the distance at this resolution."""
        nodes = self._nodes(resolution)
        row, column = np.triu_indices(nodes.count)
        square = np.empty((*radial.shape[:2], nodes.count, nodes.count))
        square[:, :, row, column] = square[:, :, column, row] = radial
        return NodalField(nodes, *turned(square, self.traction, self.quantity, nodes.x))

    def _nodes(self, resolution: float) -> StretchedNodes:
        return StretchedNodes.enough(self.scale, self.extent, DIGITS * resolution)
