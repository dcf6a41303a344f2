"""Files of numbers on a lattice: NumPy archives, NetCDF, columns of text, with error messages of one line.

Arrays that are held in memory (`core.held_arrays`) are read as those of an archive.

Components read them when they are made. `read_gridded` gives values at the points of ascending axes; `read_arrays` and
`read_columns` give what a file holds to those who look at it in another way.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from eigencontact.core.array_files import StoredArray, arrays_of_file, held_array
from eigencontact.core.array_types import FloatArray
from eigencontact.core.held_arrays import PREFIX, arrays_of
from eigencontact.core.units import parse_quantity
from eigencontact.errors import SceneError

__all__ = ["TEXT_FILES", "FileArrays", "GriddedData", "read_arrays", "read_columns", "read_gridded"]

#: Endings of files of text.
TEXT_FILES = (".txt", ".csv", ".tsv", ".dat", ".xyz", ".asc")


@dataclass(frozen=True, kw_only=True, eq=False)
class GriddedData:
    """Values at the points of a lattice.

    Attributes
    ----------
    names : tuple of str
        Axes in the order of the arrays: ``("z", "y", "x")``.
    axes : tuple of (n,) float64
        Ascending coordinates along each [m].
    values : mapping of str to (..., nz, ny, nx) float64
        Finite, in SI units; components first.
    """

    names: tuple[str, ...]
    axes: tuple[FloatArray, ...]
    values: Mapping[str, FloatArray]

    @property
    def shape(self) -> tuple[int, ...]:
        """Points along each axis."""
        return tuple(axis.size for axis in self.axes)

    def at(
        self,
        name: str,
        *points: ArrayLike,
        method: Literal["linear", "nearest"] = "linear",
        outside: Literal["border", "zero"] = "border",
    ) -> FloatArray:
        """Values ``(..., points)`` between the points of the lattice.

        Parameters
        ----------
        name : str
            Which values.
        *points : arrays
            Coordinates along each axis, in the order of `names` [m]; they broadcast against each other.
        method : {"linear", "nearest"}
            Linear between neighbours along each axis, or the nearest point's.
        outside : {"border", "zero"}
            Beyond the lattice: the value at its border, or 0.
        """
        from scipy.interpolate import RegularGridInterpolator

        places = [np.asarray(point, dtype=float) for point in points]
        if outside == "border":
            places = [np.clip(place, axis[0], axis[-1]) for place, axis in zip(places, self.axes, strict=True)]
        values = self.values[name]
        leading = values.ndim - len(self.axes)
        nodes_last = np.moveaxis(values, range(leading), range(-leading, 0))
        interpolated = RegularGridInterpolator(
            self.axes, nodes_last, method=method, bounds_error=False, fill_value=0.0
        )(np.stack(np.broadcast_arrays(*places), axis=-1))
        return np.moveaxis(np.asarray(interpolated, dtype=float), range(-leading, 0), range(leading))


def read_gridded(
    where: str,
    file: str,
    values: Mapping[str, str],
    *,
    axes: Sequence[str] = ("z", "y", "x"),
    components: Mapping[str, int] | None = None,
    unit: float = 1.0,
) -> GriddedData:
    """Values at the points of a lattice, from a file.

    Parameters
    ----------
    where : str
        The field that names the file, for messages: ``"coulomb-map.file"``.
    file : str
        ``.npz`` or NetCDF with arrays of these names; or text with columns: one for each axis, in the order x, y, z,
        and one for each of the values; rows in any order, one for each point of the lattice.
    values : mapping of str to str
        Names of the values, and their SI units: ``{"young_modulus": "Pa", "poisson_ratio": "1"}``. Each is of the shape
        of the lattice, or one number that holds everywhere.
    axes : sequence of str
        Names of the axes, in the order of the arrays; NetCDF, which names them, may have another order.
    components : mapping of str to int, optional
        Values that may have so many components in front.
    unit : float
        Metres per unit of the axes. What NetCDF says of the unit of a variable, of values too, counts instead.

    Raises
    ------
    SceneError
        ``<where> must be <rule> (got <file>); <reason>``: no such file, one that cannot be read, names that it lacks,
        axes that are not ascending, values of another shape; numbers that are complex, text, NaN or infinite.

    Examples
    --------
    >>> from eigencontact.core.held_arrays import hold
    >>> kept = hold(x=[0.0, 1.0], y=[0.0, 1.0], depth=[[0.0, 2.0], [4.0, 6.0]])  # in place of a file
    >>> data = read_gridded("map.file", kept.name, {"depth": "m"}, axes=("y", "x"))
    >>> data.at("depth", [0.5], [0.5]).tolist()
    [3.0]
    """
    names = tuple(axes)
    if Path(file).suffix.lower() in TEXT_FILES:
        source = _lattice_of_columns(where, file, names, tuple(values))
    else:
        source = _arrays_of(where, file)
    missing = [name for name in (*names, *values) if name not in source]
    if missing:
        raise _refusal(
            where, f"a file with {' and '.join(missing)}", file, f"it holds {', '.join(source) or 'nothing'}"
        )
    coordinates = []
    rule = f"a file with {', '.join(names)} of two numbers or more each, finite and ascending [m]"
    for name in names:
        if len(source[name].shape) != 1:
            raise _refusal(where, rule, file, f"{name} is not")
        axis = _in_si(where, file, name, source[name], "m", unit)
        if not (axis.size > 1 and bool(np.all(np.diff(axis) > 0)) and np.isfinite(axis).all()):
            raise _refusal(where, rule, file, f"{name} is not")
        coordinates.append(axis)
    shape = tuple(axis.size for axis in coordinates)
    arrays = {}
    for name, symbol in values.items():
        array_of_name = source[name].ordered(names)
        allowed = [shape, *([(components[name], *shape)] if components and name in components else [])]
        if array_of_name.shape not in (*allowed, ()):
            rule = f"a file with {name} of shape ({', '.join(names)}) = {' or '.join(map(str, allowed))}, or one number"
            raise _refusal(where, rule, file, f"{name} has the shape {array_of_name.shape}")
        array = _in_si(where, file, name, array_of_name, symbol, 1.0)
        wrong = ~np.isfinite(array)
        if wrong.any():
            reason = f"{int(wrong.sum())} of {array.size} are not, the first is {float(array[wrong][0])!r}"
            raise _refusal(where, f"a file with finite {name} [{symbol}]", file, reason)
        arrays[name] = np.broadcast_to(array, shape) if array.shape == () else array
    return GriddedData(names=names, axes=tuple(coordinates), values=arrays)


class FileArrays(Mapping[str, FloatArray]):
    """Arrays of a file by name, read on demand.

    One that is no array of real numbers, or that does not fit into memory, is refused with `SceneError`.
    """

    def __init__(self, where: str, file: str) -> None:
        self._where, self._file, self._arrays = where, file, _arrays_of(where, file)

    def __getitem__(self, name: str) -> FloatArray:
        return _real(self._where, self._file, name, self._arrays[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)


def read_arrays(where: str, file: str) -> FileArrays:
    """Arrays of a ``.npz`` or NetCDF file, by name; that of a ``.npy`` file has the name ``""``.

    Raises
    ------
    SceneError
        No such file, or one that cannot be read.
    """
    return FileArrays(where, file)


def read_columns(where: str, file: str, names: Sequence[str]) -> list[FloatArray]:
    """Columns of a text file, one for each name; ``#`` begins a comment; blanks, commas or semicolons separate numbers.

    Raises
    ------
    SceneError
        No such file, no row, or rows that are not so many numbers.
    """
    rule = f"a text file with rows {' '.join(names)}"
    try:
        with _existing(where, file).open(encoding="utf-8") as lines:
            row = next((line for line in lines if line.strip() and not line.lstrip().startswith("#")), "")
        if not row:
            raise _refusal(where, rule, file, "it holds no row")
        delimiter = next((mark for mark in ",;" if mark in row), None)
        table = np.loadtxt(file, delimiter=delimiter, comments="#", ndmin=2, usecols=range(len(names)))
    except (OSError, ValueError) as problem:
        raise _refusal(where, f"{rule} that can be read", file, _first_line(problem)) from problem
    return list(table.T)


def _arrays_of(where: str, file: str) -> dict[str, StoredArray]:
    if file.startswith(PREFIX):
        return _in_memory(where, file)
    path = _existing(where, file)
    with _readable(where, file):
        return arrays_of_file(path)


@contextmanager
def _readable(where: str, file: str) -> Iterator[None]:
    """Refuse an unreadable file with one kind of error; readers raise many kinds for foreign files."""
    try:
        yield
    except Exception as problem:
        rule = f"a readable .npy, .npz, NetCDF or text ({', '.join(TEXT_FILES)}) file"
        raise _refusal(where, rule, file, _first_line(problem)) from problem


def _in_memory(where: str, file: str) -> dict[str, StoredArray]:
    arrays = arrays_of(file)
    if arrays is None:
        reason = "arrays of a library call are gone with its result, and with the process; give them again, or a file"
        raise _refusal(where, "arrays that are held in memory", file, reason)
    return {name: held_array(values) for name, values in arrays.items()}


def _lattice_of_columns(
    where: str, file: str, names: tuple[str, ...], values: tuple[str, ...]
) -> dict[str, StoredArray]:
    columns = dict(zip((*sorted(names), *values), read_columns(where, file, (*sorted(names), *values)), strict=True))
    levels = {name: np.unique(columns[name], return_inverse=True) for name in names}
    shape = tuple(levels[name][0].size for name in names)
    place = np.ravel_multi_index([levels[name][1] for name in names], shape)
    rows = columns[names[0]].size
    if rows != np.prod(shape) or np.unique(place).size != rows:
        counts = " and ".join(f"{size} different {name}" for name, size in sorted(zip(names, shape, strict=True)))
        rule = f"a lattice with one row for every combination of its {', '.join(sorted(names))}"
        raise _refusal(where, rule, file, f"{rows} rows name {counts}")
    order = np.argsort(place)
    arrays = {name: held_array(columns[name][order].reshape(shape)) for name in values}
    return {name: held_array(levels[name][0]) for name in names} | arrays


def _in_si(where: str, file: str, name: str, array: StoredArray, symbol: str, factor: float) -> FloatArray:
    """Real numbers in SI units, by the unit in the file, or else multiplied by `factor`."""
    if array.unit and not (symbol == "1" and array.unit in ("1", "-", "dimensionless")):
        try:
            factor = float(parse_quantity(f"1 {array.unit}", symbol, f"{name} in units"))
        except ValueError as problem:
            raise _refusal(where, f"a file with {name} in units of {symbol}", file, f"it says {problem}") from problem
    return _real(where, file, name, array) * factor


def _real(where: str, file: str, name: str, array: StoredArray) -> FloatArray:
    if array.dtype.kind not in "fiu":
        raise _refusal(where, "an array of real numbers", file, f"{name or 'its type'} is {array.dtype}")
    if reason := array.too_large:
        rule = "a file whose arrays fit into memory"
        raise _refusal(where, rule, file, f"{name or 'it'} has the shape {array.shape} and fills {reason}")
    with _readable(where, file):
        return np.array(array.load(), dtype=float)


def _existing(where: str, file: str) -> Path:
    path = Path(file)
    if not path.is_file():
        raise _refusal(where, "an existing file", file, "a relative path counts from the folder of the scene")
    return path


def _refusal(where: str, rule: str, file: str, reason: str) -> SceneError:
    return SceneError(f"{where} must be {rule} (got {file!r}); {reason}")


def _first_line(problem: BaseException) -> str:
    line = (str(problem).strip().splitlines() or [type(problem).__name__])[0]
    return "it holds no numbers of NumPy" if "magic string" in line else line
