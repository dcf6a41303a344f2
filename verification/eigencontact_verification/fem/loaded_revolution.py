"""Loaded bodies of revolution by axisymmetric finite elements: the mean over the angle of their fields.

The contract is that of every engine for `LoadedBody`: `solve_loaded` gives displacement and stress at points.
"""

from __future__ import annotations

import resource
import time
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.fem.axisymmetric import (
    AxisymmetricLayer,
    AxisymmetricModel,
    AxisymmetricRegion,
    AxisymmetricSolution,
    solve_axisymmetric,
)
from eigencontact_verification.fem.axisymmetric_cells import CellField, CellPressure
from eigencontact_verification.fem.axisymmetric_mesh import Fit
from eigencontact_verification.fem.axisymmetric_model import Contains
from eigencontact_verification.fem.loaded_body import Cells, LoadedBody
from eigencontact_verification.fem.model import Region
from eigencontact_verification.fem.revolution import of_revolution
from eigencontact_verification.fem.section_recovery import recovered

__all__ = ["RevolutionSolution", "model_of", "of_revolution", "solve_loaded"]

FloatArray = NDArray[np.float64]
Point = tuple[float, float]

#: Elements of the coarse mesh; the fine one has sixteen times as many and eight unknowns for each.
ELEMENTS = 1100
#: Radius and depth of the mesh over the size of what lies and loads within, and over the distance of watched points.
_REACH, _WATCHED = 40.0, 3.0
#: Coarse elements across the loaded radius, half a region, a layer; a layer asks for no less than a part of the load.
_LOADED, _REGION, _LAYER, _THIN = 10.0, 4.0, 2.0, 1 / 30
_GROWTH = 1.45


@dataclass(frozen=True, kw_only=True)
class RevolutionSolution:
    """Fields of a loaded body of revolution.

    Attributes
    ----------
    solution : AxisymmetricSolution
        About the axis at the origin.
    axis : (x, y)
        Where the axis is.
    unknowns : int
        Of the linear system.
    seconds : float
        Time for mesh, assembly and solution.
    memory : int
        Largest memory of the process so far [bytes].
    """

    solution: AxisymmetricSolution
    axis: Point
    unknowns: int
    seconds: float
    memory: int

    def _centred(self, points: ArrayLike) -> FloatArray:
        return np.atleast_2d(np.asarray(points, dtype=float)) - (*self.axis, 0.0)

    def displacement(self, points: ArrayLike) -> FloatArray:
        """Displacement (n, 3) at points (n, 3)."""
        return self.solution.displacement(self._centred(points))

    def stress(self, points: ArrayLike) -> FloatArray:
        """Stress (n, 3, 3) at points (n, 3), recovered on the point's side of every boundary."""
        return recovered(self.solution, self._centred(points))


def solve_loaded(
    body: LoadedBody, *, level: Literal[0, 1, 2], outer: Literal["fixed", "free"], watched: ArrayLike
) -> RevolutionSolution:
    """Solve a body of revolution; `watched` are the points (n, 3) where fields will be read.

    Raises
    ------
    ValueError
        If the body is not of revolution.

    Examples
    --------
    >>> from eigencontact_verification.fem.loaded_body import Tractions
    >>> edges = np.linspace(-1.0, 1.0, 41)
    >>> middles = (edges[1:] + edges[:-1]) / 2
    >>> r = np.hypot(middles, middles[:, None])
    >>> pressure = np.sqrt(np.maximum(0.0, 1.0 - r**2 / 0.64))
    >>> load = Tractions(x=edges, y=edges, values=np.stack([0 * r, 0 * r, pressure]))
    >>> body = LoadedBody(young_modulus=1.0, poisson_ratio=0.0, tractions=load)
    >>> found = solve_loaded(body, level=0, outer="fixed", watched=[[0.0, 0.0, 0.0]])
    >>> round(float(found.displacement([[0.0, 0.0, 0.0]])[0, 2]) / (np.pi * 0.8 / 2), 2)  # Hertz's under the centre
    1.0
    """
    start = time.perf_counter()
    model, axis = model_of(body, watched=watched)
    solution = solve_axisymmetric(replace(model, divisions=2**level, outer=outer))
    return RevolutionSolution(
        solution=solution,
        axis=axis,
        unknowns=solution.unknowns,
        seconds=time.perf_counter() - start,
        memory=1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
    )


def model_of(body: LoadedBody, *, watched: ArrayLike) -> tuple[AxisymmetricModel, Point]:
    """Axisymmetric model of a loaded body, with the coarse mesh of its family, and the axis.

    Raises
    ------
    ValueError
        If the body is not of revolution.
    """
    axis_and_scatter = of_revolution(body)
    if axis_and_scatter is None:
        raise ValueError(
            "body must be of revolution about a vertical axis (got one that is not); use fem.loaded_solid.solve_loaded"
        )
    axis = axis_and_scatter.axis
    points = np.atleast_2d(np.asarray(watched, dtype=float)) - (*axis, 0.0)
    layers = tuple(
        AxisymmetricLayer(thickness=x.thickness, young_modulus=x.young_modulus, poisson_ratio=x.poisson_ratio)
        for x in body.layers
    )
    discs = _pressure(body, axis)
    cells = tuple(x for x in (_field(x, axis) for x in body.cells) if x is not None)
    interfaces = np.cumsum([layer.thickness for layer in layers]) if layers else np.zeros(0)
    regions = _regions(body.regions, axis, interfaces)

    sizes = [disc.radius / _LOADED for disc in discs]
    for region in regions:
        low, high = region.bounds
        sizes.append(min((high[0] - low[0]) * (1 if low[0] == 0 else 0.5), (high[1] - low[1]) / 2) / _REGION)
    sizes += [min(block.bounds[1][0] / _LOADED, float(block.z[-1] - block.z[0]) / 6) for block in cells]
    loaded = min(sizes, default=np.inf) * _LOADED
    sizes += [max(layer.thickness / _LAYER, loaded * _THIN) for layer in layers] if sizes else []
    extents = [disc.radius for disc in discs] + [x for region in regions for x in region.bounds[1]]
    extents += [x for block in cells for x in block.bounds[1]] + [float(x) for x in interfaces[-1:]]
    if not sizes:
        raise ValueError("body must bear a load or an eigenstrain (got none); its displacement is zero")
    far = max(_REACH * max(extents), _WATCHED * float(np.linalg.norm(points, axis=1).max()))
    model = AxisymmetricModel(
        young_modulus=body.young_modulus,
        poisson_ratio=body.poisson_ratio,
        reach=far,
        fine=min(*sizes, far),
        regions=regions,
        discs=discs,
        layers=layers,
        cells=cells,
        far_field=True,
        growth=_GROWTH,
        lines=((), tuple(float(x) for x in interfaces)),
    )
    while model.grid().nodes.shape[2] > ELEMENTS and model.fine < 0.2 * max(extents):
        model = replace(model, fine=1.12 * model.fine)
    return model, axis


def _pressure(body: LoadedBody, axis: Point) -> tuple[CellPressure, ...]:
    load = body.tractions
    if load is None or not np.any(load.values[2]):
        return ()
    return (CellPressure(x=load.x - axis[0], y=load.y - axis[1], values=load.values[2]),)


def _field(cells: Cells, axis: Point) -> CellField | None:
    """Mean over the angle of the rows that hold something."""
    rows = np.any(cells.eigenstrain != 0, axis=(0, 1, 3, 4))
    if cells.stiffness_factor is not None:
        rows |= np.any(cells.stiffness_factor != 1, axis=(1, 2))
    if not np.any(rows):
        return None
    used = slice(int(np.flatnonzero(rows)[0]), int(np.flatnonzero(rows)[-1]) + 1)
    return CellField.averaged(
        cells.x - axis[0],
        cells.y - axis[1],
        cells.z[used.start : used.stop + 1],
        cells.eigenstrain[:, :, used],
        None if cells.stiffness_factor is None else cells.stiffness_factor[used],
    )


def _regions(regions: tuple[Region, ...], axis: Point, interfaces: FloatArray) -> tuple[AxisymmetricRegion, ...]:
    """Regions in (r, z), fitted wherever a fitted mesh can be made."""
    out: list[AxisymmetricRegion] = []
    boxes: list[tuple[Point, Point]] = []
    for k, region in enumerate(regions):
        flat = _flat(region, axis)
        low, high = flat.bounds
        r, z = (np.linspace(low[i], high[i], 42)[1:-1] for i in (0, 1))
        box = bool(np.all(flat.contains(*np.meshgrid(r, z))))
        gap = low[1] > 1e-9 * (high[1] - low[1])
        if not box and gap:
            around = Fit(contains=flat.contains, low=low, high=high, mark=k).box
            apart = all(np.any(np.less_equal(a[1], around[0])) or np.any(np.less_equal(around[1], a[0])) for a in boxes)
            crossed = np.any((interfaces > around[0][1]) & (interfaces < around[1][1]))
            if apart and not crossed:
                flat = replace(flat, fitted=True)
                boxes.append(around)
        out.append(flat)
    return tuple(out)


def _flat(region: Region, axis: Point) -> AxisymmetricRegion:
    """The region in (r, z); one that just touches the surface is moved down by a millionth of its height."""
    low, high = region.bounds
    height, top = high[2] - low[2], max(low[2], 0.0)
    radius = (high[0] - low[0]) / 2

    def section(r: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        r, z = np.broadcast_arrays(r, z)
        inside = region.contains(axis[0] + np.ascontiguousarray(r), np.full(r.shape, axis[1]), np.ascontiguousarray(z))
        return np.asarray(inside, dtype=bool)

    touches = abs(low[2]) <= 1e-9 * height and not np.any(section(np.array([0.02, 0.1, 0.5]) * radius, np.full(3, 0.0)))
    shift = 1e-6 * height if touches else 0.0
    hollow = not np.any(section(np.zeros(64), top + (np.arange(64) + 0.5) / 64 * (high[2] - top)))
    inner = _inner_radius(section, radius, top, high[2]) if hollow else 0.0
    return AxisymmetricRegion(
        contains=lambda r, z: section(r, z - shift),
        bounds=((inner, top + shift), (radius, high[2] + shift)),
        eigenstrain=(float(region.eigenstrain[0, 0]), float(region.eigenstrain[2, 2])),
        young_modulus=region.young_modulus,
        poisson_ratio=region.poisson_ratio,
    )


def _inner_radius(section: Contains, radius: float, top: float, bottom: float) -> float:
    """Radius that a ring begins at, found on a lattice and just inside of it."""
    r = np.linspace(0.0, radius, 513)
    z = top + (np.arange(65) + 0.5) / 65 * (bottom - top)
    inside = np.any(section(r[:, None], z), axis=1)
    return float(r[max(int(np.flatnonzero(inside)[0]) - 1, 0)]) if np.any(inside) else 0.0
