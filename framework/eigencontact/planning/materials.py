"""Elastic constants of inhomogeneities, from their tables and from maps in files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.elasticity import (
    VOID,
    Cubic,
    Elasticity,
    GivenStiffness,
    Isotropic,
    IsotropicField,
    TransverselyIsotropic,
)
from eigencontact.errors import EigencontactError, SceneError, require
from eigencontact.planning.sources import Source

__all__ = ["MaterialMap", "elasticity_of"]

FloatArray = NDArray[np.float64]

_KINDS: dict[str, Any] = {
    "isotropic": Isotropic,
    "cubic": Cubic,
    "transversely-isotropic": TransverselyIsotropic,
    "stiffness": GivenStiffness,
}
_AXES, _CONSTANTS = ("z", "y", "x"), ("young_modulus", "poisson_ratio")


@dataclass(frozen=True, eq=False)
class MaterialMap:
    """Isotropic constants at the points of a lattice: linear between them, those of its border outside.

    Attributes
    ----------
    axes : (z, y, x)
        Ascending [m].
    values : (nz, ny, nx, 2)
        E [Pa], ν [-].
    """

    axes: tuple[FloatArray, FloatArray, FloatArray]
    values: FloatArray

    def at(self, z: FloatArray, y: FloatArray, x: FloatArray) -> IsotropicField:
        """Constants at the points of three axes."""
        from scipy.interpolate import RegularGridInterpolator

        held = [np.clip(at, axis[0], axis[-1]) for at, axis in zip((z, y, x), self.axes, strict=True)]
        points = np.stack(np.meshgrid(*held, indexing="ij"), axis=-1)
        found = np.asarray(RegularGridInterpolator(self.axes, self.values)(points), dtype=float)
        return IsotropicField(young_modulus=found[..., 0], poisson_ratio=found[..., 1])


def elasticity_of(source: Source) -> Elasticity | MaterialMap:
    """Elastic constants of an inhomogeneity.

    Raises
    ------
    SceneError
        Constants that no stable material has; a file that cannot be read.
    """
    table = source.material
    assert table is not None
    if table.type == "void":
        return VOID
    try:
        if table.file is not None:
            return _read(table.file)
        found: Elasticity = _KINDS[table.type](**table.constants)
    except EigencontactError as problem:
        raise SceneError(f"{source.where}.material: {problem}") from None
    return found


def _read(file: str) -> MaterialMap:
    require(Path(file).is_file(), "map", "file", file, "an existing file")
    data = _arrays(file)
    missing = [name for name in (*_AXES, *_CONSTANTS) if name not in data]
    require(not missing, "map", "file", file, f"a file with {', '.join(missing)}")
    axes = tuple(np.asarray(data[name], dtype=float) for name in _AXES)
    good = all(axis.ndim == 1 and axis.size > 1 and np.all(np.diff(axis) > 0) for axis in axes)
    require(good, "map", "file", file, "with x, y, z of two ascending numbers and more [m]")
    shape = tuple(axis.size for axis in axes)
    values = [np.asarray(data[name], dtype=float) for name in _CONSTANTS]
    right = all(item.shape in (shape, ()) for item in values)
    require(right, "map", "file", file, f"with young_modulus and poisson_ratio of shape (z, y, x) = {shape}")
    IsotropicField(young_modulus=values[0], poisson_ratio=values[1])  # refuses values without meaning
    both = np.stack([np.broadcast_to(item, shape) for item in values], axis=-1)
    return MaterialMap((axes[0], axes[1], axes[2]), both)


def _arrays(file: str) -> dict[str, Any]:
    try:
        if file.endswith(".npz"):
            with np.load(file) as data:
                return dict(data)
        import xarray

        with xarray.open_dataset(file) as data:
            return {str(name): variable.values for name, variable in data.variables.items()}
    except (OSError, ValueError) as problem:
        first = str(problem).strip().split("\n")[0]
        raise SceneError(f"map.file must be a readable .npz or NetCDF file (got {file!r}): {first}") from problem
