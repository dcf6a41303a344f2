"""Half-spaces that are not exact: fields of eigenstrain by image and pressure, and by Fourier series."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eigencontact.execution.cells import CellStrain
from eigencontact.execution.eigenstrain import Sum
from eigencontact.planning.field_parts import FieldPart
from eigencontact.planning.kernels import installed_influence
from eigencontact.planning.lower_fidelities import ALIASES, ImagePressurePart
from eigencontact.planning.plan import Plan
from eigencontact.solvers.eigenstrain_periodic import PeriodicHalfSpace
from eigencontact.solvers.image_pressure import ImagePressure, reflected

__all__ = ["ImagePressureFields", "PeriodicFields"]

FloatArray = NDArray[np.float64]


class ImagePressureFields:
    """Full space, its mirror image, and the pressure that is left."""

    def __init__(self, plan: Plan, part: FieldPart) -> None:
        assert isinstance(part, ImagePressurePart)
        body = plan.half_space(part.body)
        self._part = part
        self._here, self._image, self._surface = (Sum(plan, parts) for parts in (part.here, part.image, part.surface))
        kernel = installed_influence(plan.registry, "p")
        self._scheme = ImagePressure(grid=plan.grid, kernel=kernel, material=body, threads=plan.scene.numerics.threads)

    def __call__(self, time: float) -> FloatArray:
        """Field at one time, ``(3 or 6, *lattice.shape)``."""
        lattice, quantity = self._part.lattice, self._part.quantity
        load = 2.0 * self._surface(time)[2, 0]
        image = self._image(time)
        if lattice.points is None:
            image = image[:, ::-1]
        out = self._here(time) + reflected(quantity, image)
        if lattice.points is None:
            self._scheme.add_pressure(out, quantity, load, lattice.origin, lattice.depths)
        else:
            x, y, z = lattice.flat_points()
            self._scheme.add_pressure_at(out, quantity, load, (x, y, z))
        return out


class PeriodicFields:
    """Fourier series over the window, for one box of cells."""

    def __init__(self, plan: Plan, part: FieldPart) -> None:
        body = plan.half_space(part.body)
        assert part.group is not None
        self._part, self._grid, self._body = part, plan.grid, body
        self._strain = CellStrain(part.group, plan.grid)
        (first, row, column), (layers, rows, columns), (dz, _, _) = (
            part.group.lattice.first, part.group.lattice.shape, part.group.lattice.edges,
        )  # fmt: skip
        self._rows = (row + np.arange(rows)) % plan.grid.ny
        self._columns = (column + np.arange(columns)) % plan.grid.nx
        self._space = PeriodicHalfSpace(
            grid=plan.grid,
            interfaces=dz * (first + np.arange(layers + 1.0)),
            poisson_ratio=body.poisson_ratio,
            aliases=ALIASES,
            threads=plan.scene.numerics.threads,
        )

    def __call__(self, time: float) -> FloatArray:
        """Field at one time, ``(3 or 6, nz, ny, nx)``; what lies outside the window comes in on its other side."""
        strain = self._strain(time)
        window = np.zeros((*strain.shape[:2], *self._grid.shape))
        rows = np.zeros((*strain.shape[:2], self._grid.ny, strain.shape[3]))
        np.add.at(rows.swapaxes(0, 2), self._rows, strain.swapaxes(0, 2))
        np.add.at(window.swapaxes(0, 3), self._columns, rows.swapaxes(0, 3))
        lattice, quantity = self._part.lattice, self._part.quantity
        values = self._space.apply(
            window, quantity, depths=lattice.depths, target=lattice.target, origin=lattice.origin
        )
        return values * (self._body.shear_modulus if quantity == "stress" else 1.0)
