"""Matrices of influence coefficients between boxes of one grid: shear to tangential displacement, and cross terms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from eigencontact.convolution import Convolver, Layout, Spectrum
from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Box, Grid
from eigencontact.solvers.operator import Coefficients, Compliance, layout_between, offsets, sampled
from eigencontact.solvers.preconditioner import Circulant
from eigencontact.solvers.solution import SolverOptions

__all__ = ["MatrixOperator", "Pair", "ParityCoefficients"]

#: (direction of the displacement, direction of the traction): ``("x", "y")``.
Pair = tuple[str, str]

_MAX_OPERATORS = 4


class ParityCoefficients(Coefficients, Protocol):
    """Influence coefficients of one response to one traction [m/Pa], with their parity."""

    @property
    def parity(self) -> tuple[int, int]:
        """Parity (in y, in x)."""


class MatrixOperator:
    """Displacements by tractions, several of each, on one grid.

    Parameters
    ----------
    grid : Grid
        Cells.
    coefficients : mapping of (str, str) to ParityCoefficients
        Keyed by directions of displacement and traction; missing pairs are zero.
    targets, sources : str
        Directions of the displacements and of the tractions, in the order of the arrays: ``"xy"``.
    options : SolverOptions
        Periodic window, precision and threads.
    """

    def __init__(
        self,
        grid: Grid,
        coefficients: Mapping[Pair, ParityCoefficients],
        targets: str,
        sources: str,
        options: SolverOptions,
    ) -> None:
        self.grid, self.targets, self.sources = grid, targets, sources
        self.options = options
        self._coefficients = {
            pair: coefficients[pair] for pair in coefficients if pair[0] in targets and pair[1] in sources
        }
        self._tables: dict[Pair, FloatArray] = {}
        self._unit: float | None = None
        self._operators: dict[tuple[Box, Box], tuple[Convolver, list[list[Spectrum | None]]]] = {}
        self._preconditioners: dict[Box, Any] = {}
        self._diagonal: dict[str, Compliance] = {}
        #: Number of computations of all displacements.
        self.applications = 0

    def apply(self, tractions: FloatArray, source: Box, target: Box) -> FloatArray:
        """Displacements on a box ``(len(targets), ny, nx)`` by the tractions on another ``(len(sources), ny, nx)``."""
        if (source, target) not in self._operators:
            if len(self._operators) >= _MAX_OPERATORS:
                self._operators.pop(next(iter(self._operators)))
            self._operators[source, target] = self._make(source, target)
        convolver, kernels = self._operators[source, target]
        self.applications += 1
        return np.asarray(convolver.apply(tractions, kernels), dtype=float)

    def unit(self) -> float:
        """Displacement of one cell by a unit traction along the first direction [m/Pa]."""
        if self._unit is None:
            pair = (self.targets[0], self.sources[0])
            self._unit = float(sampled(self._coefficients[pair], self.grid, 1, 1)[0, 0])
        return self._unit

    def _make(self, source: Box, target: Box) -> tuple[Convolver, list[list[Spectrum | None]]]:
        if self.options.periodic:  # shifts between boxes of a period are cyclic; the whole window costs the same
            layout = Layout(self.grid.shape, self.grid.shape, periodic=True)
        else:
            layout = layout_between(source, target)
        kernels = [
            [self._spectrum((i, j), layout) if (i, j) in self._coefficients else None for j in self.sources]
            for i in self.targets
        ]
        return Convolver(layout, precision=self.options.precision, threads=self.options.threads), kernels

    def _spectrum(self, pair: Pair, layout: Layout) -> Spectrum:
        parity = self._coefficients[pair].parity
        if self.options.periodic:
            ky, kx = layout.wavenumbers(self.grid.dy, self.grid.dx)
            response = self._coefficients[pair].response(kx[None, :], ky[:, None])
            return layout.spectrum_from_response(response, parity, precision=self.options.precision)
        y, x = offsets(layout)
        table = self._table(pair, int(y.max()) + 1, int(x.max()) + 1)
        if not (layout.y.symmetric and layout.x.symmetric):
            sign_y = np.sign(layout.y.lattice) if parity[0] < 0 else np.ones(y.size)
            sign_x = np.sign(layout.x.lattice) if parity[1] < 0 else np.ones(x.size)
            table = table[np.ix_(y, x)] * (sign_y[:, None] * sign_x[None, :])
        return layout.spectrum(table, parity, precision=self.options.precision)

    def _table(self, pair: Pair, ny: int, nx: int) -> FloatArray:
        """Coefficients at the offsets 0..ny-1, 0..nx-1 in cells, sampled once for the window.

        Values depend in the last bit on the number of offsets sampled together. With fewer offsets at first, a resumed
        run would differ from one that had smaller contacts before.
        """
        table = self._tables.get(pair, np.empty((0, 0)))
        if table.shape[0] < ny or table.shape[1] < nx:
            rows, columns = max(ny, self.grid.ny), max(nx, self.grid.nx)
            table = self._tables[pair] = sampled(self._coefficients[pair], self.grid, rows, columns)
        return table[:ny, :nx]

    def precondition(self, displacements: FloatArray, box: Box) -> FloatArray:
        """Approximate inverse of the diagonal terms on a box, in units of one over `unit`."""
        if box not in self._preconditioners:
            self._preconditioners.clear()
            inverses = []
            for direction in self.sources:
                if direction not in self._diagonal:
                    options = replace(self.options, precision="double")
                    self._diagonal[direction] = Compliance(self.grid, self._coefficients[direction, direction], options)
                compliance = self._diagonal[direction]
                inverse = Circulant(compliance, box).inverse
                inverses.append((inverse, compliance.unit / self.unit()))
            self._preconditioners[box] = inverses
        corrections = [
            np.asarray(inverse(field), dtype=float) / ratio
            for field, (inverse, ratio) in zip(displacements, self._preconditioners[box], strict=True)
        ]
        return np.stack(corrections)
