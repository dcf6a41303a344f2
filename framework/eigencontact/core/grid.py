"""Regular grids of rectangular cells on the surface z = 0."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.arrays import is_real, is_whole
from eigencontact.core.units import per_length
from eigencontact.errors import require

__all__ = ["Box", "Grid", "MakeGrid"]

Number = TypeVar("Number", int, float)
Pair = tuple[float, float]
#: Maker of cells: numbers along x and y, edges along x and y [m], middle of the window [m].
MakeGrid = Callable[[int, int, float, float, Pair], "Grid"]


@dataclass(frozen=True, slots=True)
class Box:
    """Half-open index box ``[y0:y1, x0:x1]`` of a grid."""

    y0: int
    y1: int
    x0: int
    x1: int

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the box."""
        return self.y1 - self.y0, self.x1 - self.x0

    @property
    def slices(self) -> tuple[slice, slice]:
        """The box as an index: ``field[box.slices]``."""
        return slice(self.y0, self.y1), slice(self.x0, self.x1)

    @property
    def cells(self) -> int:
        """Number of cells."""
        return (self.y1 - self.y0) * (self.x1 - self.x0)

    def covers(self, box: Box) -> bool:
        """Whether another box lies within this box."""
        return self.y0 <= box.y0 and box.y1 <= self.y1 and self.x0 <= box.x0 and box.x1 <= self.x1

    def union(self, box: Box) -> Box:
        """Smallest box that contains both boxes."""
        return Box(min(self.y0, box.y0), max(self.y1, box.y1), min(self.x0, box.x0), max(self.x1, box.x1))

    def grown(self, margin_y: int, margin_x: int, shape: tuple[int, int]) -> Box:
        """Return the box enlarged on all sides, clipped to a grid of `shape`."""
        return Box(
            max(0, self.y0 - margin_y),
            min(shape[0], self.y1 + margin_y),
            max(0, self.x0 - margin_x),
            min(shape[1], self.x1 + margin_x),
        )

    @staticmethod
    def around(mask: NDArray[np.bool_]) -> Box | None:
        """Smallest box with all true cells of `mask`; None without a true cell."""
        rows = np.flatnonzero(mask.any(axis=1))
        if rows.size == 0:
            return None
        columns = np.flatnonzero(mask.any(axis=0))
        return Box(int(rows[0]), int(rows[-1]) + 1, int(columns[0]), int(columns[-1]) + 1)


@dataclass(frozen=True, kw_only=True, slots=True)
class Grid:
    """Cells of the contact window; fields on it are arrays of shape ``(ny, nx)``, values at cell centres.

    Parameters
    ----------
    nx, ny : int
        Number of cells along x and y.
    dx, dy : float
        Edges of a cell [m].
    center : (float, float)
        Coordinates (x, y) of the middle of the window [m].
    line : bool
        Whether the cells are strips without end along y, in plane strain. There is one row of them, and 1 m of their
        length is counted: forces, areas and work are per metre.
    repeats_y : bool
        Whether the window repeats along y, and not along x: forces, areas and work are those of one period.

    Examples
    --------
    >>> grid = Grid(nx=4, ny=2, dx=1.0, dy=1.0)
    >>> grid.x.tolist(), grid.shape
    ([-1.5, -0.5, 0.5, 1.5], (2, 4))
    """

    nx: int
    ny: int
    dx: float
    dy: float
    center: tuple[float, float] = (0.0, 0.0)
    line: bool = False
    repeats_y: bool = False

    def __post_init__(self) -> None:
        for name in ("nx", "ny"):
            value = getattr(self, name)
            require(is_whole(value) and value >= 1, "grid", name, value, "a whole number, at least 1 [cells]")
        for name in ("dx", "dy"):
            value = getattr(self, name)
            require(is_real(value) and 0 < value < np.inf, "grid", name, value, "positive and finite [m]")
        if self.line:
            require(self.ny == 1, "grid", "ny", self.ny, "1 in a line contact [cells]")
            require(self.dy == 1.0, "grid", "dy", self.dy, "1 in a line contact, the length that is counted [m]")

    @property
    def shape(self) -> tuple[int, int]:
        """``(ny, nx)``: the shape of every field on this grid."""
        return self.ny, self.nx

    @property
    def x(self) -> FloatArray:
        """Cell centres along x, (nx,) [m]."""
        return np.asarray(self.center[0] + (np.arange(self.nx) - 0.5 * (self.nx - 1)) * self.dx, dtype=float)

    @property
    def y(self) -> FloatArray:
        """Cell centres along y, (ny,) [m]."""
        return np.asarray(self.center[1] + (np.arange(self.ny) - 0.5 * (self.ny - 1)) * self.dy, dtype=float)

    @property
    def cell_area(self) -> float:
        """Area of one cell [m^2]."""
        return self.dx * self.dy

    @property
    def half_widths(self) -> tuple[float, float]:
        """Half edges of a cell along x and y, infinite along y for strips [m]."""
        return 0.5 * self.dx, 0.5 * self.dy if 1 in self.bounded_axes else np.inf

    @property
    def edges(self) -> tuple[float, ...]:
        """Edges of a cell along x and y; for a strip only along x [m]."""
        return self._bounded((self.dx, self.dy))

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of cells along x and y; for strips only along x."""
        return self._bounded((self.nx, self.ny))

    @property
    def mean_edge(self) -> float:
        """Edge of a square with the area of a cell; of a strip that along x [m]."""
        return float(np.prod(self.edges) ** (1.0 / len(self.edges)))

    @property
    def size(self) -> tuple[float, float]:
        """Extent of the window along x and y [m]."""
        return self.nx * self.dx, self.ny * self.dy

    @property
    def sides(self) -> tuple[float, ...]:
        """Extents of the window along its bounded axes [m]."""
        return self._bounded(self.size)

    @property
    def bounded_axes(self) -> tuple[int, ...]:
        """Axes, of x, y and z, along which a region below the window is bounded: not y in a line contact."""
        return (0, 2) if self.line else (0, 1, 2)

    @property
    def ended_axes(self) -> tuple[int, ...]:
        """Axes, of x and y, along which the window is bounded: a contact at this edge lacks the cells outside."""
        return (0,) if self.repeats_y or self.line else (0, 1)

    def _bounded(self, pair: tuple[Number, Number]) -> tuple[Number, ...]:
        """Return the values of a pair along x and y for the bounded axes of the window."""
        return tuple(pair[axis] for axis in self.bounded_axes if axis < 2)

    def unit(self, unit: str) -> str:
        """Unit of a force, a work or an area on this grid: per length for strips; other units do not change.

        Examples
        --------
        >>> Grid.of(8, 8, 1.0, 1.0, line=True).unit("N")
        'N/m'
        """
        return per_length(unit, line=self.line)

    def axes(self) -> tuple[FloatArray, FloatArray]:
        """Return ``(y, x)`` shaped ``(ny, 1)`` and ``(1, nx)``, ready to broadcast [m]."""
        return self.y[:, None], self.x[None, :]

    def coarsened(self, factor_y: int, factor_x: int) -> Grid:
        """Return the grid of cells merged ``factor_y`` by ``factor_x``; drops remaining rows and columns."""
        nx, ny = self.nx // factor_x, self.ny // factor_y
        lost_x, lost_y = self.nx - nx * factor_x, self.ny - ny * factor_y
        center = (self.center[0] - 0.5 * lost_x * self.dx, self.center[1] - 0.5 * lost_y * self.dy)
        return self.with_cells(nx, ny, self.dx * factor_x, self.dy * factor_y, center)

    @classmethod
    def of(cls, nx: int, ny: int, dx: float, dy: float, center: Pair = (0.0, 0.0), *, line: bool = False) -> Grid:
        """Return a grid of rectangles, or of a row of strips at y = 0, which ignores `ny`, `dy` and the y centre.

        Examples
        --------
        >>> strips = Grid.of(8, 8, 0.5, 0.5, (1.0, 2.0), line=True)
        >>> strips.shape, strips.edges, strips.center
        ((1, 8), (0.5,), (1.0, 0.0))
        """
        if line:
            ny, dy, center = 1, 1.0, (center[0], 0.0)
        return cls(nx=nx, ny=ny, dx=dx, dy=dy, center=center, line=line)

    def with_cells(self, nx: int, ny: int, dx: float, dy: float, center: Pair) -> Grid:
        """Return a grid of other cells of the same kind: see `Grid.of`."""
        return replace(Grid.of(nx, ny, dx, dy, center, line=self.line), repeats_y=self.repeats_y)
