"""What the cells of a box of inhomogeneities are made of, and the prestrain in them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.elasticity import VOID, Cubic, Elasticity, GivenStiffness, Isotropic, TransverselyIsotropic
from eigencontact.core.grid import Grid
from eigencontact.errors import EigencontactError, SceneError
from eigencontact.execution.cells import CellStrain, values_of
from eigencontact.planning.cell_groups import CellGroup
from eigencontact.planning.sources import Source

__all__ = ["MaterialCells", "elasticity_of"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int_]

#: A share of a cell smaller than this is left out.
_LEAST = 1e-3


def elasticity_of(source: Source) -> Elasticity:
    """Elastic constants of an inhomogeneity of one material.

    Raises
    ------
    SceneError
        Constants that no stable material has.
    """
    table = source.material
    assert table is not None
    if table.type == "void":
        return VOID
    kinds: dict[str, Any] = {
        "isotropic": Isotropic,
        "cubic": Cubic,
        "transversely-isotropic": TransverselyIsotropic,
        "stiffness": GivenStiffness,
    }
    try:
        found: Elasticity = kinds[table.type](**table.constants)
    except EigencontactError as problem:
        raise SceneError(f"{source.where}.material: {problem}") from None
    return found


class MaterialCells:
    """Content of the cells of one box; where inhomogeneities overlap the later one wins.

    Attributes
    ----------
    materials : list of Elasticity
        Each once.
    index, beside : (nz, ny, nx) of int
        Number (from 1; 0 is the matrix) of the material, other than the matrix, that fills most of a cell, and of that
        beside it.
    fraction : (nz, ny, nx)
        Share of the first.
    normal : (3, nz, ny, nx)
        Across the boundary in cut cells.
    """

    def __init__(self, box: CellGroup, grid: Grid) -> None:
        self._box, self._grid, self._strain = box, grid, CellStrain(box, grid)
        self.shape = box.lattice.shape
        numbers = self._numbers()
        left = np.ones(self.shape)
        shares = np.zeros((2, *self.shape))
        names, self._owner = np.zeros((2, *self.shape), dtype=int), np.full(self.shape, -1)
        for member in reversed(range(len(box.sources))):
            place, inside = self._strain.fractions[member]
            share = np.minimum(inside, 1.0) * left[place]
            left[place] -= share
            most = _add(shares[:, *place], names[:, *place], share, numbers[member])
            self._owner[place][most] = member
        own, other = shares
        kept = own > _LEAST
        self.index = np.where(kept, names[0], 0)
        with_other = kept & (other > left) & (other > _LEAST)
        self.beside = np.where(with_other, names[1], 0)
        whole = np.where(with_other, own + other, 1.0)
        self.fraction = np.where(kept, np.minimum(own / whole, 1.0), 1.0)
        self.fraction[self.fraction > 1.0 - _LEAST] = 1.0
        self._owner[~kept] = -1
        self.normal = self._gradient(left)

    def _numbers(self) -> list[int]:
        """Number of the material of each source."""
        known: dict[str, int] = {}
        self.materials: list[Elasticity] = []
        numbers = []
        for source in self._box.sources:
            assert source.material is not None
            name = source.material.model_dump_json()
            if name not in known:
                self.materials.append(elasticity_of(source))
                known[name] = len(self.materials)
            numbers.append(known[name])
        return numbers

    def _gradient(self, left: FloatArray) -> FloatArray:
        """Gradient of the share of the matrix, which is all there is beyond the box."""
        padded = np.pad(left, 1, constant_values=1.0)
        if self._box.lattice.first[0] == 0:
            padded[0] = padded[1]
        inner = slice(1, -1)
        dz, dy, dx = self._box.lattice.edges
        along_z = (padded[2:, inner, inner] - padded[:-2, inner, inner]) / dz
        along_y = (padded[inner, 2:, inner] - padded[inner, :-2, inner]) / dy
        along_x = (padded[inner, inner, 2:] - padded[inner, inner, :-2]) / dx
        return np.stack([along_x, along_y, along_z]) * min(dx, dy, dz)

    def prestrain(self, time: float) -> FloatArray:
        """Mandel prestrain ``(6, nz, ny, nx)`` of the inhomogeneity that fills most of a cell, zero in the matrix."""
        out = np.zeros((6, *self.shape))
        z, y, x = self._box.lattice.axes(self._grid)
        for member, (source, (place, _)) in enumerate(zip(self._box.sources, self._strain.fractions, strict=True)):
            mine = self._owner[place] == member
            part = out[:, *place]
            part[:, mine] = values_of(source, x[place[2]], y[place[1]], z[place[0]], time)[:, mine]
        return out


def _add(shares: FloatArray, names: IntArray, share: FloatArray, number: int) -> NDArray[np.bool_]:
    """Add shares of one material to the two largest of each cell; where it is now the largest."""
    first = (names[0] == number) & (share > 0)
    second = (names[1] == number) & (share > 0)
    new = ~first & ~second & (share > shares[1])
    grew = first & (share > shares[0])
    shares[0] += np.where(first, share, 0.0)
    shares[1] = np.where(new, share, shares[1] + np.where(second, share, 0.0))
    names[1][new] = number
    swap = shares[1] > shares[0]
    shares[:, swap] = shares[::-1, swap]
    names[:, swap] = names[::-1, swap]
    return np.asarray(swap | grew)
