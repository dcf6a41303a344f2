"""Regions that are cut into cells: the eigenstrain of every cell at a time, and its field at the points of a region."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.grid import Grid
from eigencontact.errors import EigencontactError, PluginError, require
from eigencontact.planning.cell_groups import CellGroup
from eigencontact.planning.cells import installed_cell
from eigencontact.planning.field_parts import FieldPart, space_of, volume_layers
from eigencontact.planning.plan import Plan
from eigencontact.planning.regions import RegionLattice
from eigencontact.planning.sources import Patch, Source
from eigencontact.solvers.cells import Cells

__all__ = ["CellFields", "CellStrain", "values_of"]

FloatArray = NDArray[np.float64]


class CellFields:
    """Field of a group of cells at the points of a region, by the way that the plan chose; built when first asked."""

    def __init__(self, plan: Plan, part: FieldPart) -> None:
        body = plan.half_space(part.body)
        assert part.group is not None
        self._plan, self._part, self._group = plan, part, part.group
        cell = installed_cell(plan.registry)
        self._cell = cell((0.0, 0.0, 0.5), (1.0, 1.0, 1.0))
        self._body, self._space = body, space_of(plan.scene.numerics)
        self._strain = CellStrain(self._group, plan.grid)
        z, y, x = self._group.lattice.axes(plan.grid)
        dz, dy, dx = self._group.lattice.edges
        self._source = Cells(
            first=(float(x[0]), float(y[0]), float(z[0])), pitch=(dx, dy, dz), shape=self._group.lattice.shape
        )
        self._operators: list[tuple[Any, Any]] = []

    def __call__(self, time: float) -> FloatArray:
        """Field at one time, ``(3 or 6, *lattice.shape)``."""
        return self.of(self._strain(time))

    def of(self, strain: FloatArray) -> FloatArray:
        """Field of an eigenstrain of the cells ``(6, nz, ny, nx)``, ``(3 or 6, *lattice.shape)``."""
        if self._part.route == "close-up":
            return self._close_up(strain)
        if not self._operators:
            self._operators = self._build()
        count = 3 if self._part.quantity == "displacement" else 6
        out = np.empty((count, *self._part.lattice.shape))
        for place, operator in self._operators:
            values = operator.apply(strain)
            out[:, place] = values[:, :, 0, 0] if self._part.lattice.points is not None else values
        return out

    def _build(self) -> list[tuple[Any, Any]]:
        """Operators, and the part of the points (depths of a lattice, numbers of scattered points) that each serves."""
        lattice, first = self._part.lattice, self._group.lattice.first
        if lattice.points is not None:
            return [self._column(lattice.points, where) for where in _columns(lattice.points)]
        origin = (lattice.origin[0] - first[1], lattice.origin[1] - first[2])
        inner = volume_layers(self._part)
        if self._part.route == "planes" or inner is None:
            return [(slice(None), self._planes(lattice.target, origin, lattice.depths + 0.0))]
        start, count = inner
        found: list[tuple[Any, Any]] = [(slice(-count, None), self._volume(lattice, start, count))]
        if count < lattice.depths.size:
            found.append((slice(0, 1), self._planes(lattice.target, origin, np.zeros(1))))
        return found

    def _close_up(self, strain: FloatArray) -> FloatArray:
        """Field on points finer than the cells; its operators serve once."""
        lattice, numerics = self._part.lattice, self._plan.scene.numerics
        (dx, dy, dz), (my, mx), depths = self._source.pitch, lattice.finer, lattice.depths
        apart = dz / max(1, round(dz / float(np.diff(depths).min()))) if depths.size > 1 else dz
        if not np.allclose(np.diff(depths), apart, rtol=1e-6, atol=0.0) or depths[0] <= 0.0:
            out = np.empty((3 if self._part.quantity == "displacement" else 6, *lattice.shape))
            for (rows, columns), part in lattice.shifted:
                first = self._group.lattice.first
                origin = (part.origin[0] - first[1], part.origin[1] - first[2])
                out[:, :, rows, columns] = self._planes(part.target, origin, depths + 0.0).apply(strain)
            return out
        from eigencontact.solvers.close_up import close_up

        target = Cells(
            first=(float(lattice.x[0]), float(lattice.y[0]), float(depths[0])),
            pitch=(dx / mx, dy / my, apart),
            shape=lattice.shape,  # type: ignore[arg-type]
        )
        return close_up(
            self._cell,
            self._source,
            strain,
            target,
            poisson_ratio=self._body.poisson_ratio,
            quantity=self._part.quantity,
            space=self._space,
            shear_modulus=self._body.shear_modulus,
            threads=numerics.threads,
        )

    def _column(self, points: FloatArray, where: NDArray[np.intp]) -> tuple[Any, Any]:
        """Operator for points one above the other."""
        x, y = points[where[0], :2]
        (x0, y0, _), (dx, dy, _) = self._source.first, self._source.pitch
        return where, self._planes((1, 1), (float((y - y0) / dy), float((x - x0) / dx)), points[where, 2] + 0.0)

    def _planes(self, target: tuple[int, int], origin: tuple[float, float], depths: FloatArray) -> Any:
        from eigencontact.solvers.eigenstrain_planes import PlaneFields

        numerics = self._plan.scene.numerics
        return PlaneFields(
            self._cell,
            self._source,
            target=target,
            origin=origin,
            depths=depths,
            poisson_ratio=self._body.poisson_ratio,
            quantity=self._part.quantity,
            space=self._space,
            shear_modulus=self._body.shear_modulus,
            precision=numerics.precision,
            threads=numerics.threads,
        )

    def _volume(self, lattice: RegionLattice, start: float, count: int) -> Any:
        from eigencontact.solvers.eigenstrain import VolumeField

        numerics = self._plan.scene.numerics
        target = Cells(
            first=(float(lattice.x[0]), float(lattice.y[0]), start),
            pitch=self._source.pitch,
            shape=(count, *lattice.target),
        )
        return VolumeField(
            self._cell,
            self._source,
            target,
            poisson_ratio=self._body.poisson_ratio,
            quantity=self._part.quantity,
            space=self._space,
            shear_modulus=self._body.shear_modulus,
            precision=numerics.precision,
            threads=numerics.threads,
        )


def _columns(points: FloatArray) -> list[NDArray[np.intp]]:
    """Numbers of the points that lie one above the other, for every place of the surface."""
    _, column = np.unique(points[:, :2], axis=0, return_inverse=True)
    order = np.argsort(column.ravel(), kind="stable")
    return np.split(order, np.flatnonzero(np.diff(column.ravel()[order])) + 1)


class CellStrain:
    """Mandel eigenstrain of a group of sources in its cells: the value at the middle times the fraction inside."""

    def __init__(self, group: CellGroup, grid: Grid) -> None:
        self._group, self._grid = group, grid

    def __call__(self, time: float) -> FloatArray:
        """``(6, nz, ny, nx)`` at one time [-]."""
        total = np.zeros((6, *self._group.lattice.shape))
        z, y, x = self._group.lattice.axes(self._grid)
        for source, (box, fractions) in zip(self._group.sources, self._fractions, strict=True):
            part = total[:, box[0], box[1], box[2]]
            part += fractions * values_of(source, x[box[2]], y[box[1]], z[box[0]], time)
        return total

    @cached_property
    def _fractions(self) -> list[tuple[tuple[slice, slice, slice], FloatArray]]:
        """Part of the box that a source takes, and the fraction of each of its cells inside."""
        from eigencontact.halfspace.voxels import Voxels, volume_fractions

        found = []
        for source in self._group.sources:
            assert source.lattice is not None
            start = np.subtract(source.lattice.first, self._group.lattice.first)
            box = tuple(slice(int(a), int(a) + n) for a, n in zip(start, source.lattice.shape, strict=True))
            if isinstance(source.shape, Patch):
                fractions = np.ones(source.lattice.shape)
            else:
                axes = source.lattice.axes(self._grid)
                low = [float(axis[0]) - 0.5 * edge for axis, edge in zip(axes, source.lattice.edges, strict=True)]
                fractions = volume_fractions(
                    source.shape, Voxels(low[::-1], source.lattice.edges[::-1], source.lattice.shape)
                )
                rule = f"fine enough to find {source.name!r}"
                require(fractions.any(), source.where, "cells", source.lattice.shape[::-1], rule)
            found.append(((box[0], box[1], box[2]), fractions))
        return found


def values_of(source: Source, x: FloatArray, y: FloatArray, z: FloatArray, time: float) -> FloatArray:
    """Mandel eigenstrain of a source's field at the points of three axes, ``(6, nz, ny, nx)``."""
    shape = (6, z.size, y.size, x.size)
    try:
        values = source.field.eigenstrain(x[None, None, :], y[None, :, None], z[:, None, None], time)
        values = np.broadcast_to(np.asarray(values, dtype=float), shape)
    except EigencontactError:
        raise
    except Exception as problem:
        raise PluginError(
            f"{source.where}: eigenstrain field {source.field.key!r} must return numbers of shape {shape} "
            f"(got {type(problem).__name__}: {problem})"
        ) from problem
    require(np.all(np.isfinite(values)), source.where, "eigenstrain", "NaN or infinity", "finite in every cell")
    return np.asarray(values)
