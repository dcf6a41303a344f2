"""Stored results as VTK files for ParaView and pyvista.

Coordinates are those of the results, in metres and unchanged: the surface is z = 0 and z **increases into the body**.
In a viewer whose z points up the body therefore lies above the surface; rotate the camera, not the data. Surface
fields are cell values (a cell of the grid is a cell of the image), sub-surface fields are point values. Stress and
strain are stored as VTK orders symmetric tensors: xx, yy, zz, xy, yz, xz. Each file says which version of this package
wrote it: a field array ``eigencontact``, a comment in collections.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact import __version__
from eigencontact.core.field_error import error_name
from eigencontact.core.names import SURFACE
from eigencontact.core.tensors import COMPONENTS, from_mandel
from eigencontact.errors import ResultsError
from eigencontact.results.atomic import reason, replacing
from eigencontact.results.stored import open_stored
from eigencontact.viz import vtk_xml

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from eigencontact.results.stored import Results
    from eigencontact.viz.vtk_xml import Mesh

__all__ = ["write_vtk"]

#: Where the six components of a symmetric tensor in VTK's order stand among ours.
_REORDER = [COMPONENTS.index(name) for name in vtk_xml.COMPONENTS]
#: Surface vectors, stored by their components, that VTK gets as vectors too; a component that a run leaves out is 0.
_VECTORS = ("residual_displacement", "displacement", "shear", "slip")
#: Those of them that lie in the surface.
_IN_PLANE = ("shear", "slip")


def write_vtk(results: Results | Path | str, folder: Path) -> list[Path]:
    """Write every step of stored results as VTK files into a folder, which is made if missing.

    Returns
    -------
    list of Path
        ``surface_0001.vti`` and so on; per region ``<region>_0001`` as ``.vti`` (evenly spaced), ``.vtr`` (spaced
        otherwise), or ``.vtp`` (lines, points); per body that remembers ``cells_<body>_<step>.vti``; and for each
        series a ``.pvd`` that ParaView opens as a whole, with the time of the load history.

    Raises
    ------
    ResultsError
        When the results cannot be read or the folder cannot be written.
    """
    if isinstance(results, (str, Path)):
        with open_stored(results) as dataset:
            return write_vtk(dataset, folder)
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ResultsError(
            f"folder {folder} must be a folder that can be written (got: {reason(error)}); choose another"
        ) from error
    regions = json.loads(results.attrs["regions"])
    files: list[Path] = []
    surface = [SURFACE] if any(v.attrs.get("role") == "field" for v in results.variables.values()) else []
    steps = [int(step) for step in results["step"].values]
    times = dict(zip(steps, map(float, results["time"].values), strict=True))
    for name in (*surface, *regions):
        meshes = (
            _surface(results, at) if name == SURFACE else _region(results, name, regions[name], at)
            for at in range(len(steps))
        )
        files += _series(folder, name, times, steps, meshes)
    for body in (1, 2):
        if f"cells_{body}_z" in results:
            history_steps = [int(step) for step in results["history_step"].values]
            cells = (_cells(results, body, at) for at in range(len(history_steps)))
            files += _series(folder, f"cells_{body}", times, history_steps, cells)
    return files


def _series(folder: Path, name: str, times: dict[int, float], steps: list[int], meshes: Iterable[Mesh]) -> list[Path]:
    """Write a file for each of some steps, and their collection with the times of the load history."""
    series = [_save(mesh, folder, f"{name}_{step:04d}") for step, mesh in zip(steps, meshes, strict=True)]
    collection = folder / f"{name}.pvd"
    with replacing(collection, f"collection {collection.name}") as sink:
        sink.write(_collection([times[step] for step in steps], series).encode())
    return [*series, collection]


def _cells(dataset: Results, body: int, at: int) -> Mesh:
    """Image of the cells of a body with their history fields; six components form a tensor."""
    axes = [np.asarray(dataset[f"cells_{body}_{axis}"].values, dtype=float) for axis in "xyz"]
    edges = [float(axis[1] - axis[0]) if axis.size > 1 else 2.0 * abs(float(axis[0])) for axis in axes]
    corner = [float(axis[0]) - 0.5 * edge for axis, edge in zip(axes, edges, strict=True)]
    mesh = vtk_xml.image([axis.size + 1 for axis in axes], edges, corner)
    for name, variable in dataset.data_vars.items():
        if variable.attrs.get("role") != "history" or f"cells_{body}_z" not in variable.dims:
            continue
        values = np.asarray(variable[at].values)
        tensor = values.ndim == 4 and len(values) == len(COMPONENTS)
        rows = values.reshape(*values.shape[: values.ndim - 3], -1).T
        mesh.cell_data[str(name)] = from_mandel(rows.T).T[:, _REORDER] if tensor else rows
        if tensor:
            mesh.tensors.add(str(name))
    return mesh


def _surface(dataset: Results, at: int) -> Mesh:
    """Image of one layer of cells in z = 0 with the surface fields."""
    dx, dy = (float(edge) for edge in np.atleast_1d(dataset.attrs["cell_size"]))
    origin = (float(dataset["x"][0]) - 0.5 * dx, float(dataset["y"][0]) - 0.5 * dy, 0.0)
    ny, nx = dataset.sizes["y"], dataset.sizes["x"]
    mesh = vtk_xml.image((nx + 1, ny + 1, 1), (dx, dy, 1.0), origin)
    for name, variable in dataset.data_vars.items():
        if variable.attrs.get("role") == "field" or (
            variable.attrs.get("role") == "error" and variable.dims[1:] == ("y", "x")
        ):
            mesh.cell_data[str(name)] = np.asarray(variable[at].values).ravel()
    for vector in _VECTORS:
        components = [f"{vector}_{axis}" for axis in "xyz"]
        plane = [mesh.cell_data[component] for component in components[:2] if component in mesh.cell_data]
        if plane and (vector in _IN_PLANE or components[2] in mesh.cell_data):
            zero = np.zeros(nx * ny)
            mesh.cell_data[vector] = np.column_stack([mesh.cell_data.get(component, zero) for component in components])
    return mesh


def _region(dataset: Results, name: str, described: dict[str, Any], at: int) -> Mesh:
    """Mesh of a region with its fields as point values."""
    coords = {axis: np.asarray(dataset[f"{name}_{axis}"].values, dtype=float) for axis in "xyz"}
    if described["dims"] == ["point"]:
        size = dataset.sizes[f"{name}_point"]
        where = np.column_stack([coords[axis] * np.ones(size) for axis in "xyz"])
        mesh = (vtk_xml.lines if described["shape"] == "line" and size > 1 else vtk_xml.points)(where)
    else:
        mesh = _lattice(*(np.atleast_1d(coords[axis]) for axis in "xyz"))
    # VTK counts x fastest, then y, then z: the C order of arrays (z, y, x), whichever of them are single.
    quantities = {quantity: quantity for quantity in described["fields"]}
    quantities |= {error_name(quantity): quantity for quantity in described["fields"]}
    for stored, quantity in quantities.items():
        if f"{name}_{stored}" not in dataset:
            continue
        values = np.asarray(dataset[f"{name}_{stored}"][at].values)
        if quantity in ("stress", "strain"):
            mesh.point_data[stored] = values.reshape(len(values), -1)[_REORDER].T
            mesh.tensors.add(stored)
        elif quantity in ("principal", "displacement"):
            mesh.point_data[stored] = values.reshape(len(values), -1).T
        else:
            mesh.point_data[stored] = values.ravel()
    return mesh


def _lattice(x: NDArray[Any], y: NDArray[Any], z: NDArray[Any]) -> Mesh:
    """Image where the points are evenly spaced along all axes, otherwise a rectilinear grid."""
    steps = [np.diff(axis) for axis in (x, y, z)]
    if all(step.size == 0 or (step[0] > 0 and np.ptp(step) <= 1e-9 * np.abs(step[0])) for step in steps):
        # Even from the ends, so that the last point has no accumulated rounding.
        spacing = [float(np.ptp(axis)) / (axis.size - 1) if axis.size > 1 else 1.0 for axis in (x, y, z)]
        return vtk_xml.image((x.size, y.size, z.size), spacing, (float(x[0]), float(y[0]), float(z[0])))
    return vtk_xml.rectilinear(x, y, z)


def _save(mesh: Mesh, folder: Path, stem: str) -> Path:
    """Write a mesh; the file appears complete or not at all."""
    target = folder / f"{stem}{mesh.suffix}"
    # Complete or absent; not to outlive a loss of power, as the results do, from which the file can be written again.
    with replacing(target, target.name, lasting=False) as sink:
        mesh.write(sink)
    return target


def _collection(times: list[float], series: list[Path]) -> str:
    """XML of a ParaView collection: one file for each time."""
    rows = "\n".join(
        f'    <DataSet timestep="{time!r}" group="" part="0" file={vtk_xml.quoted(path.name)}/>'
        for time, path in zip(times, series, strict=True)
    )
    return f"""<?xml version="1.0"?>
<!-- eigencontact {__version__} -->
<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">
  <Collection>
{rows}
  </Collection>
</VTKFile>
"""
