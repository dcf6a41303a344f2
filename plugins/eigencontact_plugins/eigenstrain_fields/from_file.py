"""Eigenstrain on a regular lattice, read from a file."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import DataFile, EigenstrainField, SceneError, hookimpl, real_array, require, to_mandel
from eigencontact_plugins.eigenstrain_fields.values import TimedField

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["FromFile"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class FromFile(TimedField):
    """Eigenstrain at the points of a lattice, linear between them and zero outside.

    Parameters
    ----------
    file : str
        ``.npz``, or NetCDF (``.nc``), with ``x``, ``y``, ``z`` [m], ascending, and ``eigenstrain`` [-]: tensor
        components xx, yy, zz, yz, xz, xy ``(6, nz, ny, nx)``, or one isotropic value ``(nz, ny, nx)``.
    variable : str
        Name of the eigenstrain in the file.
    times, factors : tuple of float
        History; see `TimedField`.
    """

    key: ClassVar[str] = "from-file"
    references: ClassVar[tuple[str, ...]] = ("T. Mura, Micromechanics of Defects in Solids (1987), section 1",)

    file: DataFile
    variable: str = "eigenstrain"

    def __post_init__(self) -> None:
        super().__post_init__()
        require(Path(self.file).is_file(), self.key, "file", self.file, "an existing file")
        _ = self._lattice  # read and checked now, not in the middle of a run

    @cached_property
    def _lattice(self) -> tuple[tuple[FloatArray, FloatArray, FloatArray], FloatArray]:
        """Axes (z, y, x), and Mandel values ``(nz, ny, nx, 6)``."""
        data = self._read()
        names = ("z", "y", "x")
        missing = [name for name in (*names, self.variable) if name not in data]
        require(not missing, self.key, "file", self.file, f"a file with {', '.join(missing)}")
        rule = "with x, y, z of two ascending numbers and more [m], finite"
        axes = tuple(real_array(data[name], self.key, "file", f"an axis {name} in {self.file!r}") for name in names)
        good = all(
            axis.ndim == 1 and axis.size > 1 and np.all(np.diff(axis) > 0) and np.isfinite(axis[[0, -1]]).all()
            for axis in axes
        )
        require(good, self.key, "file", self.file, rule)
        values = real_array(data[self.variable], self.key, "file", f"a lattice of {self.variable} in {self.file!r}")
        shape = tuple(axis.size for axis in axes)
        require(
            values.shape in (shape, (6, *shape)) and bool(np.all(np.isfinite(values))),
            self.key,
            "file",
            self.file,
            f"with finite {self.variable} of shape {(6, *shape)} or {shape} (it is {values.shape})",
        )
        plain = values if values.ndim == 4 else np.multiply.outer(np.array([1.0, 1, 1, 0, 0, 0]), values)
        return (axes[0], axes[1], axes[2]), np.moveaxis(to_mandel(plain), 0, -1)

    def _read(self) -> dict[str, Any]:
        try:
            if self.file.endswith(".npz"):
                with Path(self.file).open("rb") as stream, np.load(stream, allow_pickle=False) as data:
                    return dict(data)
            import xarray

            with xarray.open_dataset(self.file) as data:
                return {str(name): variable.values for name, variable in data.variables.items()}
        except Exception as problem:  # the readers raise errors of many kinds for files that are none of their own
            first = (str(problem).strip().splitlines() or [type(problem).__name__])[0]
            raise SceneError(
                f"{self.key}.file must be a readable .npz or NetCDF file (got {self.file!r}): {first}"
            ) from problem

    def at(self, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Mandel eigenstrain at factor 1; see `TimedField`."""
        from scipy.interpolate import RegularGridInterpolator

        axes, values = self._lattice
        inside = RegularGridInterpolator(axes, values, bounds_error=False, fill_value=0.0)
        points = np.stack(np.broadcast_arrays(z, y, x), axis=-1)
        return np.moveaxis(np.asarray(inside(points), dtype=float), -1, 0)


@hookimpl
def eigencontact_register() -> Iterable[type[EigenstrainField]]:
    """Register the field from a file."""
    return [FromFile]
