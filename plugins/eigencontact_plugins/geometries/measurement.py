"""Reader of measured surfaces: NumPy files, text with a matrix or rows x y z, and files that SurfaceTopography opens.

Every reader returns the heights of the file, ``(ny, nx)`` with NaN for missing points, and the distances between points
and the units if the file contains them. An error has one line: ``topography.file must be ...``.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import TEXT_FILES, FloatArray, SceneError, read_arrays
from eigencontact_plugins.geometries.text_header import Header, read_header
from eigencontact_plugins.geometries.text_table import read_table

__all__ = ["Measurement", "read_measurement"]

GALLERY = "gallery:"
FIELD = "topography.file"


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurement:
    """Heights on a regular raster.

    Attributes
    ----------
    heights : (ny, nx) float64
        NaN where missing; rows run along y, columns along x.
    spacing : (float, float) or None
        Distance of the points along x and y, in lateral units; None if the file does not contain it.
    height_unit, lateral_unit : float or None
        Metres per unit of the heights, and of the spacing; None if the file does not contain it.
    fixed : bool
        False if these units are only a convention of the format; a scene may then prescribe others.
    """

    heights: FloatArray
    spacing: tuple[float, float] | None = None
    height_unit: float | None = None
    lateral_unit: float | None = None
    fixed: bool = True


def read_measurement(file: str) -> Measurement:
    """Read `file`: a path, or ``gallery:NAME`` for a file of the bundled gallery."""
    path = _locate(file)
    suffix = path.suffix.lower()
    if suffix in (".npy", ".npz"):
        measurement = _read_numpy(path, file)
    elif suffix in TEXT_FILES and not _is_foreign(path):
        measurement = _read_text(path, file)
    else:
        measurement = _read_instrument(path, file)
    heights = measurement.heights
    if heights.ndim != 2 or min(heights.shape) < 2:
        raise _refusal("heights on a raster of at least 2 x 2 points", file, f"its shape is {heights.shape}")
    if np.isinf(heights).any():
        raise _refusal("finite heights", file, f"{np.isinf(heights).sum()} are infinite; mark missing points with NaN")
    if np.isnan(heights).all():
        raise _refusal("a measurement with heights", file, "every point is missing")
    return measurement


def _refusal(rule: str, file: str, reason: str) -> SceneError:
    return SceneError(f"{FIELD} must be {rule} (got {file!r}); {reason}")


def _locate(file: str) -> Path:
    if file.startswith(GALLERY):
        folder, name = Path(str(files("eigencontact"))) / "gallery", file.removeprefix(GALLERY)
        names = sorted(p.name for p in folder.glob("*") if p.suffix in (".npy", ".npz", *TEXT_FILES))
        if name not in names:
            raise _refusal("a file of the gallery", file, f"the gallery holds {', '.join(names) or 'none'}")
        return folder / name
    path = Path(file)
    if not path.is_file():
        raise _refusal("an existing file", file, "a relative path counts from the folder of the scene")
    return path


def _read_numpy(path: Path, file: str) -> Measurement:
    arrays = read_arrays(FIELD, str(path))
    names = [name for name in arrays if name not in ("dx", "dy")]
    if "heights" not in names and len(names) != 1:
        listed = ", ".join(arrays) or "nothing"
        raise _refusal("an archive with the array 'heights', or with one array", file, f"it holds {listed}")
    heights = arrays["heights" if "heights" in names else names[0]]
    steps = [arrays[name] for name in ("dx", "dy") if name in arrays]
    if not steps:
        return Measurement(heights=heights)
    dx, dy = steps[0], steps[-1]
    if dx.size != 1 or dy.size != 1:
        reason = f"their shapes are {dx.shape} and {dy.shape}"
        raise _refusal("an archive with one number each for dx and dy", file, reason)
    spacing = (float(dx.item()), float(dy.item()))
    return Measurement(heights=heights, spacing=spacing, height_unit=1.0, lateral_unit=1.0, fixed=False)


def _is_foreign(path: Path) -> bool:
    """Whether a text file comes from a program with its own scaling of numbers."""
    with path.open("rb") as stream:
        begin = stream.read(2000).lower()
    return any(mark in begin for mark in (b"wyko ascii", b"bit2nm", b"wsxm"))


def _read_text(path: Path, file: str) -> Measurement:
    """Read three columns as coordinates, unless the header has the width of the window; otherwise read a matrix."""
    table = read_table(path, lambda rule, reason: _refusal(rule, file, reason))
    header = read_header(table.header, lambda rule, reason: _refusal(rule, file, reason))
    lengths = [*header.spacing, *header.size]
    if table.numbers.shape[1] == 3 and lengths == [None] * 4:
        return _from_columns(table.numbers, header, file)
    _refuse_labels(table.numbers, file)
    ny, nx = table.numbers.shape
    spacing = tuple(
        step if step is not None or size is None else size / number
        for step, size, number in zip(header.spacing, header.size, (nx, ny), strict=True)
    )
    dx, dy = spacing[0] or spacing[1], spacing[1] or spacing[0]
    return Measurement(
        heights=table.numbers,
        spacing=None if dx is None or dy is None else (dx, dy),
        height_unit=header.height_unit,
        lateral_unit=header.lateral_unit,
    )


def _refuse_labels(numbers: FloatArray, file: str) -> None:
    """Refuse a matrix with coordinates in its first row and column, which would be read as heights."""
    first = [numbers[0, 1:], numbers[1:, 0]]
    even = [line.size > 1 and np.allclose(np.diff(line), line[1] - line[0], rtol=1e-6, atol=0) for line in first]
    if np.isnan(numbers[0, 0]) and all(even) and all(line[1] != line[0] for line in first):
        raise _refusal("a matrix of heights alone", file, "its first row and column are coordinates; remove them")


def _from_columns(table: FloatArray, header: Header, file: str) -> Measurement:
    """Three columns x, y, z with rows in any order; points of the raster without a row are missing."""
    x, y, z = table.T
    (ix, nx, dx), (iy, ny, dy) = _raster(x, "x", file), _raster(y, "y", file)
    if 10 * x.size < nx * ny:
        raise _refusal("a regular raster", file, f"{x.size} points lie scattered over {nx} x {ny} places")
    place = iy * nx + ix
    repeated = place.size - np.unique(place).size
    if repeated:
        raise _refusal("a raster with one height a point", file, f"{repeated} rows repeat a point")
    heights = np.full(ny * nx, np.nan)
    heights[place] = z
    return Measurement(
        heights=heights.reshape(ny, nx),
        spacing=(dx, dy),
        height_unit=header.height_unit,
        lateral_unit=header.lateral_unit,
    )


def _raster(values: FloatArray, axis: str, file: str) -> tuple[NDArray[np.intp], int, float]:
    """Index of each coordinate on its axis, number of levels and their distance; refuses uneven levels."""
    if not np.isfinite(values).all():
        raise _refusal("a raster with finite coordinates", file, f"{axis} holds {np.sum(~np.isfinite(values))} others")
    order = np.sort(values)
    gaps = np.diff(order)
    gaps = gaps[gaps > 0.1 * gaps.max(initial=0.0)]  # smaller gaps are round-off of one coordinate
    if gaps.size == 0:
        raise _refusal("heights on a raster of at least 2 x 2 points", file, f"all {axis} are equal")
    typical = np.median(gaps)
    typical = gaps[np.abs(gaps - typical) < 0.5 * typical].mean()  # a missing row or column causes a double gap
    span = float(order[-1] - order[0])
    levels = round(span / typical) + 1
    step = span / (levels - 1)
    position = (values - order[0]) / step
    index = np.rint(position).astype(np.intp)
    if np.abs(position - index).max() > 0.05:
        reason = f"steps along {axis} go from {gaps.min():.6g} to {gaps.max():.6g}; resample it to equal steps first"
        raise _refusal("a regular raster", file, reason)
    return index, levels, step


def _read_instrument(path: Path, file: str) -> Measurement:
    """Measurement from a format of SurfaceTopography: the first height channel, in the units of the file if any."""
    try:
        from SurfaceTopography import open_topography
    except ImportError as problem:
        reason = "for formats of instruments: pip install eigencontact[topography]"
        raise _refusal(f"a .npy, .npz or text file ({', '.join(TEXT_FILES)})", file, reason) from problem
    try:
        with open_topography(str(path)) as reader:
            points, extent = reader.default_channel.nb_grid_pts, reader.default_channel.physical_sizes
            topography = reader.topography() if extent else reader.topography(physical_sizes=points)
            in_metres = topography.unit is not None
            if in_metres:
                topography = topography.to_unit("m")
            heights: FloatArray = np.ma.filled(np.ma.asarray(topography.heights(), dtype=float), np.nan)
            steps = [float(size / number) for size, number in zip(topography.physical_sizes, points, strict=True)]
    except Exception as problem:  # each reader raises errors of its own types
        reason = (str(problem).strip().splitlines() or [type(problem).__name__])[0]
        raise _refusal("a format that SurfaceTopography reads", file, reason) from problem
    spacing, unit = (steps[0], steps[-1]) if extent else None, 1.0 if in_metres else None
    heights = np.ascontiguousarray(heights.T)
    return Measurement(heights=heights, spacing=spacing, height_unit=unit, lateral_unit=unit)
