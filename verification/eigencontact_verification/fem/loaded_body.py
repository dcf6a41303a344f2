"""A half-space as the stored step of a run leaves it: constants, layers, regions, tractions, and what cells remember.

Plain numbers, which finite elements take as their own. Conventions as in `fem.model`: z into the body, the surface is
z = 0, stress positive in tension, eigenstrain positive in expansion. Any consistent units.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.model import Layer, Region

__all__ = ["Cells", "LoadedBody", "Tractions"]

FloatArray = NDArray[np.float64]


def _edges(where: str, edges: tuple[FloatArray, ...], shape: tuple[int, ...]) -> None:
    for axis, line in zip("xyz", edges, strict=False):
        if line.ndim != 1 or line.size < 2 or not np.all(np.diff(line) > 0):
            raise ValueError(f"{where}.{axis} must be rising edges of cells (got {line}); give one more than cells")
    expected = tuple(line.size - 1 for line in reversed(edges))
    if shape != expected:
        raise ValueError(f"{where} values must have {expected} cells (got {shape}); the last axis runs along x")


@dataclass(frozen=True, kw_only=True, eq=False)
class Tractions:
    """Uniform tractions on the cells of the surface; none outside of them.

    Attributes
    ----------
    x, y : (nx + 1,), (ny + 1,) float64
        Edges of the cells.
    values : (3, ny, nx) float64
        Force per area that acts on the body; a pressure p is ``(0, 0, p)``.
    """

    x: FloatArray
    y: FloatArray
    values: FloatArray

    def __post_init__(self) -> None:
        _edges("tractions", (self.x, self.y), self.values.shape[1:])

    @property
    def force(self) -> FloatArray:
        """Resultant on the body, (3,)."""
        return np.asarray(np.diff(self.y) @ self.values @ np.diff(self.x))


@dataclass(frozen=True, kw_only=True, eq=False)
class Cells:
    """Boxes below the surface, each with an eigenstrain and with what damage leaves of the stiffness.

    Attributes
    ----------
    x, y, z : (nx + 1,), (ny + 1,), (nz + 1,) float64
        Edges of the cells.
    eigenstrain : (3, 3, nz, ny, nx) float64
        Plastic strain, prestrain; adds to that of the regions.
    stiffness_factor : (nz, ny, nx) float64 or None
        Factor of the elastic constants, 1 - D; None: 1 everywhere.
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    eigenstrain: FloatArray
    stiffness_factor: FloatArray | None = None

    def __post_init__(self) -> None:
        edges = (self.x, self.y, self.z)
        _edges("cells", edges, self.eigenstrain.shape[2:])
        if self.stiffness_factor is not None:
            _edges("cells", edges, self.stiffness_factor.shape)
            if not np.all(self.stiffness_factor > 0):
                raise ValueError(
                    f"cells.stiffness_factor must be positive (got {self.stiffness_factor.min()}); limit the damage"
                )


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadedBody:
    """Half-space under given tractions.

    Attributes
    ----------
    young_modulus, poisson_ratio : float
        Of the body; under layers, of the substrate.
    layers : tuple of Layer
        From the surface downwards.
    regions : tuple of Region
        Inclusions; where they overlap eigenstrains add and the last one's constants count.
    tractions : Tractions or None
        On the surface.
    cells : tuple of Cells
        Their eigenstrains add; they do not overlap in `stiffness_factor`.
    """

    young_modulus: float
    poisson_ratio: float
    layers: tuple[Layer, ...] = ()
    regions: tuple[Region, ...] = ()
    tractions: Tractions | None = None
    cells: tuple[Cells, ...] = ()
