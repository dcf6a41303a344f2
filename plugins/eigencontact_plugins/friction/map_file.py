"""Reading a map of the coefficient of friction: NumPy archives and x-y-value text."""

from __future__ import annotations

import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import SceneError

__all__ = ["FrictionMap", "read_map"]

FloatArray = NDArray[np.float64]
_TEXT = (".txt", ".csv", ".dat", ".xyz")


@dataclass(frozen=True, kw_only=True, eq=False)
class FrictionMap:
    """Coefficients at the points of a lattice.

    Attributes
    ----------
    x, y : (nx,), (ny,) float64
        Ascending coordinates, at least two each; in the unit of the file.
    values : (ny, nx) float64
        Coefficients [-], zero or positive.
    """

    x: FloatArray
    y: FloatArray
    values: FloatArray

    def at(self, x: FloatArray, y: FloatArray, method: Literal["linear", "nearest"]) -> FloatArray:
        """Values ``(ny, nx)`` at points that broadcast; NaN further out than half a step from the outermost points."""
        from scipy.interpolate import RegularGridInterpolator

        outside = _beyond(self.x, x) | _beyond(self.y, y)
        inner = np.broadcast_arrays(np.clip(y, *self.y[[0, -1]]), np.clip(x, *self.x[[0, -1]]))
        found = RegularGridInterpolator((self.y, self.x), self.values, method=method)(np.stack(inner, axis=-1))
        return np.where(outside, np.nan, found)


def _beyond(axis: FloatArray, values: FloatArray) -> NDArray[np.bool_]:
    """Whether coordinates lie more than half a step outside an axis; round-off of a step counts as inside."""
    low, high = 0.5 * (1 + 1e-9) * (axis[1] - axis[0]), 0.5 * (1 + 1e-9) * (axis[-1] - axis[-2])
    return np.asarray((values < axis[0] - low) | (values > axis[-1] + high))


def read_map(where: str, file: str, unit: float) -> FrictionMap:
    """Map of a file; `where` names the law in messages, `unit` is metres per unit of the file's coordinates."""
    path = Path(file)
    if not path.is_file():
        raise _refusal(where, "an existing file", file, "a relative path counts from the folder of the scene")
    try:
        x, y, values = _read_archive(path, where) if path.suffix == ".npz" else _read_text(path, where)
    except (OSError, EOFError, zipfile.BadZipFile, zlib.error, ValueError) as problem:
        reason = (str(problem).strip().splitlines() or [type(problem).__name__])[0]
        rule = f".npz, or text with columns x y coefficient ({', '.join(_TEXT)}), that can be read"
        raise _refusal(where, rule, file, reason) from problem
    good = all(axis.ndim == 1 and axis.size > 1 and bool(np.all(np.diff(axis) > 0)) for axis in (x, y))
    if not (good and np.isfinite(x).all() and np.isfinite(y).all()):
        raise _refusal(where, "a map with finite x and y, two ascending numbers each or more", file, "these are not")
    if values.shape != (y.size, x.size):
        rule = f"a map of shape {(y.size, x.size)}, rows along y"
        raise _refusal(where, rule, file, f"coefficient has the shape {values.shape}")
    wrong = ~(np.isfinite(values) & (values >= 0))
    if wrong.any():
        reason = f"{int(wrong.sum())} of {values.size} are not, the first is {float(values[wrong][0])!r}"
        raise _refusal(where, "a map of coefficients that are zero or positive, and finite [-]", file, reason)
    return FrictionMap(x=x * unit, y=y * unit, values=values)


def _refusal(where: str, rule: str, file: str, reason: str) -> SceneError:
    return SceneError(f"{where}.file must be {rule} (got {file!r}); {reason}")


def _read_archive(path: Path, where: str) -> tuple[FloatArray, FloatArray, FloatArray]:
    with path.open("rb") as stream, np.load(stream, allow_pickle=False) as data:
        missing = [name for name in ("x", "y", "coefficient") if name not in data]
        if missing:
            reason = f"it holds {', '.join(data) or 'nothing'}"
            raise _refusal(where, f"an archive with {' and '.join(missing)}", str(path), reason)
        x, y, values = (_real(data[name], name) for name in ("x", "y", "coefficient"))
    return x, y, values


def _real(values: NDArray[np.float64], name: str) -> FloatArray:
    if values.dtype.kind not in "fiu":
        raise ValueError(f"{name} is of type {values.dtype}")
    return np.array(values, dtype=float)


def _read_text(path: Path, where: str) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Three columns, rows in any order; every point of the lattice has one row."""
    with path.open(encoding="utf-8") as lines:
        row = next((line for line in lines if line.strip() and not line.lstrip().startswith("#")), "")
    if not row:
        raise _refusal(where, "a text file with rows x y coefficient", str(path), "it holds no row")
    delimiter = next((mark for mark in ",;" if mark in row), None)
    x, y, values = np.loadtxt(path, delimiter=delimiter, comments="#", ndmin=2, unpack=True, usecols=(0, 1, 2))
    levels = [np.unique(part) for part in (x, y)]
    nx, ny = (level.size for level in levels)
    place = np.searchsorted(levels[1], y) * nx + np.searchsorted(levels[0], x)
    if x.size != nx * ny or np.unique(place).size != x.size:
        reason = f"{x.size} rows name {nx} different x and {ny} different y"
        raise _refusal(where, "a lattice with one row for every pair of its x and y", str(path), reason)
    out = np.empty(nx * ny)
    out[place] = values
    return levels[0], levels[1], out.reshape(ny, nx)
