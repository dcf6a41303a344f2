"""A sphere of another material below a pressure, by equivalent inclusions: cell by cell, and with one eigenstrain.

Nothing of the finite elements is used here: the load's stress comes from the installed influence of pressure, cell by
cell of a grid on the surface, and every field is that of the matrix alone with the equivalent eigenstrain in it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.case import Quantity

__all__ = ["Cellwise", "OneEigenstrain", "Sphere", "by_cells", "by_one_eigenstrain"]

FloatArray = NDArray[np.float64]

#: Samples each way in a cell of the pressure, whose mean over the cell is wanted.
_SAMPLES = 8
#: Gauss points along the radius, along the polar angle and around the axis, for means over the sphere.
_RADIAL, _POLAR, _AROUND = 5, 6, 8
#: Values on a lattice that a cubic goes through along each axis.
_STENCIL = 4
#: Cells of the pressure across the contact radius where the sphere is not cut into cells.
_PRESSURE_CELLS = 128


@dataclass(frozen=True, kw_only=True)
class Sphere:
    """The problem: matrix with E = 1, load p0 √(1 - r²/a²) with a = 1 about the axis through the sphere's centre.

    Parameters
    ----------
    depth, radius : float
        Of the sphere, its centre below the middle of the load.
    poisson_ratio : float
        Of the matrix.
    young_modulus_inside, poisson_ratio_inside : float
        Of the sphere; Young's modulus 0 is a void.
    pressure : float
        p0; 0 without load.
    prestrain : float
        Expansion of the sphere by itself, the same in all directions.
    """

    depth: float
    radius: float
    poisson_ratio: float
    young_modulus_inside: float
    poisson_ratio_inside: float
    pressure: float
    prestrain: float

    @property
    def centre(self) -> tuple[float, float, float]:
        """Of the sphere."""
        return 0.0, 0.0, self.depth

    @property
    def stiffness(self) -> FloatArray:
        """Mandel stiffness of the sphere, (6, 6)."""
        young, nu = self.young_modulus_inside, self.poisson_ratio_inside
        out = young / (1 + nu) * np.eye(6)
        out[:3, :3] += young * nu / ((1 + nu) * (1 - 2 * nu))
        return out

    @property
    def matrix(self) -> Any:
        """Material around the sphere."""
        from eigencontact.core.material import Material

        return Material(young_modulus=1.0, poisson_ratio=self.poisson_ratio)


@dataclass(frozen=True, kw_only=True, eq=False)
class Cellwise:
    """Equivalent eigenstrain of every cell of a box.

    Attributes
    ----------
    box : eigencontact.solvers.cells.Cells
    eigenstrain : (6, nz, ny, nx)
        Mandel eigenstrain.
    matrix : Material
        Of the homogeneous half-space that it acts in.
    """

    box: Any
    eigenstrain: FloatArray
    matrix: Any

    def field(self, points: FloatArray, quantity: Quantity) -> FloatArray:
        """Change of the field by the sphere: displacement ``(n, 3)`` or stress ``(n, 3, 3)`` at points ``(n, 3)``.

        By the operators of the code on the lattice of the cells' centres, and cubics between its points; points closer
        than three cells to the boundary that the cells make are spoilt by its steps.
        """
        from eigencontact.core.tensors import to_matrix
        from eigencontact.model.installed import installed_cell
        from eigencontact.scene.installed import installed_plugins
        from eigencontact.solvers.cells import Cells
        from eigencontact.solvers.eigenstrain import VolumeField
        from eigencontact.solvers.eigenstrain_planes import PlaneFields

        cell = installed_cell(installed_plugins())((0.0, 0.0, 1.0), (1.0, 1.0, 1.0))
        box, nu, surface = self.box, self.matrix.poisson_ratio, not points[:, 2].any()
        place = (points - np.array(box.first)) / np.array(box.pitch)
        start = np.floor(place).astype(int) - _STENCIL // 2 + 1
        start[:, 2] = np.maximum(start[:, 2], np.ceil(1e-6 - box.first[2] / box.pitch[2]))  # below the surface
        low, high = start.min(axis=0), start.max(axis=0) + _STENCIL
        nx, ny, nz = (int(count) for count in high - low)
        if surface:
            shift = (float(low[1]), float(low[0]))
            operator: Any = PlaneFields(
                cell, box, target=(ny, nx), origin=shift, depths=[0.0], poisson_ratio=nu, quantity="displacement"
            )
            place, start, low = place * (1, 1, 0), start * (1, 1, 0), low * (1, 1, 0)
        else:
            x, y, z = (float(box.first[axis] + low[axis] * box.pitch[axis]) for axis in range(3))
            target = Cells(first=(x, y, z), pitch=box.pitch, shape=(nz, ny, nx))
            operator = VolumeField(
                cell, box, target, poisson_ratio=nu, quantity=quantity, shear_modulus=self.matrix.shear_modulus
            )
        values = np.asarray(operator.apply(self.eigenstrain))
        (wx, ix), (wy, iy), (wz, iz) = (_cubic(place[:, axis], start[:, axis], low[axis]) for axis in range(3))
        if surface:
            wz, iz = np.ones((len(points), 1)), np.zeros((len(points), 1), dtype=int)
        field = np.einsum(
            "ni,nj,nk,cnkji->cn", wx, wy, wz,
            values[:, iz[:, :, None, None], iy[:, None, :, None], ix[:, None, None, :]], optimize=True,
        )  # fmt: skip
        return np.ascontiguousarray(field.T) if quantity == "displacement" else np.asarray(to_matrix(field))


def _cubic(place: FloatArray, start: NDArray[Any], low: Any) -> tuple[FloatArray, NDArray[Any]]:
    """Weights ``(n, 4)`` of Lagrange's cubics, and the numbers of the points they belong to, counted from `low`."""
    nodes = start[:, None] + np.arange(_STENCIL)
    weights = np.ones(nodes.shape)
    for i in range(_STENCIL):
        for j in range(_STENCIL):
            if i != j:
                weights[:, i] *= (place - nodes[:, j]) / (i - j)
    return weights, nodes - low


@dataclass(frozen=True, kw_only=True, eq=False)
class OneEigenstrain:
    """One uniform equivalent eigenstrain in the whole sphere.

    Attributes
    ----------
    shape : inclusion shape
        The sphere.
    eigenstrain : (6,)
        Mandel eigenstrain.
    matrix : Material
        Of the homogeneous half-space that it acts in.
    parts, remainder : list of inclusion shapes, (n, 6)
        Parts of the sphere, and the Mandel eigenstrain that each would still add by itself: what one value for the
        whole sphere cannot fulfil. Its mean is zero.
    """

    shape: Any
    eigenstrain: FloatArray
    matrix: Any
    parts: list[Any]
    remainder: FloatArray

    def field(self, points: FloatArray, quantity: Quantity) -> FloatArray:
        """Change of the field by the sphere; see `Cellwise.field`. No lattice, and any points."""
        return self._of([self.shape], self.eigenstrain[None], points, quantity)

    def correction(self, points: FloatArray, quantity: Quantity) -> FloatArray:
        """Field of what is left, outside the sphere: how far `field` is from that of a varying eigenstrain, about."""
        return self._of(self.parts, self.remainder, points, quantity)

    def _of(self, shapes: list[Any], strains: FloatArray, points: FloatArray, quantity: Quantity) -> FloatArray:
        from eigencontact import inclusion_field
        from eigencontact.core.tensors import to_matrix

        return np.asarray(
            inclusion_field(
                shapes,
                to_matrix(strains.T),
                points,
                young_modulus=self.matrix.young_modulus,
                poisson_ratio=self.matrix.poisson_ratio,
                quantity=quantity,
            )
        )


def _pressure(problem: Sphere, pitch: float, count: int) -> tuple[Any, FloatArray]:
    """Grid with so many cells each way, and Hertz's pressure on it: means over the cells, of the right resultant."""
    from eigencontact.core.grid import Grid

    grid = Grid(nx=count, ny=count, dx=pitch, dy=pitch)
    inner = ((np.arange(_SAMPLES) + 0.5) / _SAMPLES - 0.5) * pitch
    x = (grid.x[:, None] + inner).ravel()
    fine = problem.pressure * np.sqrt(np.maximum(0.0, 1.0 - x[:, None] ** 2 - x**2))
    pressure = fine.reshape(count, _SAMPLES, count, _SAMPLES).mean(axis=(1, 3))
    if problem.pressure:
        pressure *= 2 / 3 * np.pi * problem.pressure / (pressure.sum() * grid.cell_area)
    return grid, pressure


def _kernel(problem: Sphere) -> Any:
    from eigencontact.model.installed import installed_influence
    from eigencontact.model.kernels import StressCoefficients
    from eigencontact.scene.installed import installed_plugins

    return StressCoefficients(installed_influence(installed_plugins(), "p"), problem.matrix)


def _lattice(problem: Sphere, across: int) -> tuple[Any, NDArray[np.bool_]]:
    """Box of cells with `across` of them along a diameter, and which are inside: together as large as the sphere."""
    from eigencontact.solvers.cells import Cells

    along = (np.arange(across) + 0.5) * 2.0 / across - 1.0
    inside = along[:, None, None] ** 2 + along[:, None] ** 2 + along**2 < 1.0
    pitch = problem.radius * float((4 / 3 * np.pi / np.count_nonzero(inside)) ** (1 / 3))
    low = -0.5 * (across - 1) * pitch
    return Cells(first=(low, low, problem.depth + low), pitch=(pitch,) * 3, shape=(across,) * 3), inside


def by_cells(problem: Sphere, across: int) -> Cellwise:
    """Solve for the eigenstrain of the cells whose centre lies in the sphere, `across` of them along a diameter."""
    from eigencontact.core.grid import Box
    from eigencontact.model.installed import installed_cell
    from eigencontact.scene.installed import installed_plugins
    from eigencontact.solvers.equivalent_inclusions import InhomogeneousCells
    from eigencontact.solvers.mean_stress import MeanVolumeField
    from eigencontact.solvers.subsurface import SubsurfaceStress

    matrix, (box, inside) = problem.matrix, _lattice(problem, across)
    cell = installed_cell(installed_plugins())((0.0, 0.0, 1.0), (1.0, 1.0, 1.0))
    operator = MeanVolumeField(
        cell, box, box, poisson_ratio=matrix.poisson_ratio, shear_modulus=matrix.shear_modulus, applications=100
    )
    applied = np.zeros((6, *box.shape))
    if problem.pressure:
        count = max(2 * int(np.ceil(1.0 / box.pitch[0])), across)
        count += (count - across) % 2  # so that centres of both lattices are above each other
        grid, pressure = _pressure(problem, box.pitch[0], count)
        loaded, shift = Box.around(pressure > 0), (count - across) / 2
        assert loaded is not None
        load = SubsurfaceStress(
            grid, [_kernel(problem)], source=loaded, target=(across, across), origin=(shift, shift),
            depths=box.centres(2),
        )  # fmt: skip
        applied = load.apply([pressure])
    prestrain = np.zeros_like(applied)
    prestrain[:3] = problem.prestrain * inside
    cells = InhomogeneousCells(operator, matrix, [problem.stiffness], inside.astype(int))
    solution = cells.solve(applied, prestrain)
    return Cellwise(box=box, eigenstrain=solution.eigenstrain, matrix=matrix)


def by_one_eigenstrain(problem: Sphere) -> OneEigenstrain:
    """Solve for the eigenstrain with which the mean stress of the sphere is that of its material: six equations."""
    from eigencontact import make
    from eigencontact.halfspace.points import field_at_points
    from eigencontact.solvers.polynomial_inclusions import PolynomialInclusions

    matrix = problem.matrix
    shape = make("sphere", kind="inclusion-shape", center=problem.centre, radius=problem.radius)
    points, weights = _inside(problem)
    applied = _applied(problem, points)
    places = (points[:, 0], points[:, 1], points[:, 2])
    caused = matrix.shear_modulus * np.stack(
        [
            field_at_points(shape, unit, places, poisson_ratio=matrix.poisson_ratio, quantity="stress")
            for unit in np.eye(6)
        ],
        axis=1,
    )
    # C_i (M_m σ + ε* - ε_p) = σ, scaled so that neither a void nor a rigid sphere has large entries
    around = replace(problem, young_modulus_inside=1.0, poisson_ratio_inside=problem.poisson_ratio).stiffness
    scale = np.linalg.inv(problem.stiffness + 2.0 * matrix.shear_modulus * np.eye(6))
    stress, strain = scale @ (problem.stiffness @ np.linalg.inv(around) - np.eye(6)), scale @ problem.stiffness
    prestrain = np.array([problem.prestrain] * 3 + [0.0] * 3)
    answer = np.linalg.inv(stress @ (caused @ weights) + strain)  # of the sphere by itself
    solver = PolynomialInclusions([shape], matrix, [problem.stiffness], [0])
    load = solver.moments(_applied(problem, np.ascontiguousarray(solver.points.T)))
    eigenstrain = np.asarray(solver.solve(load, prestrain[:, None]).eigenstrain[:, 0, 0])
    total = applied + np.einsum("cun,u->cn", caused, eigenstrain)
    remainder = -answer @ (stress @ total + (strain @ (eigenstrain - prestrain))[:, None])
    columns = [
        make("sphere", kind="inclusion-shape", center=tuple(point), radius=problem.radius * weight ** (1 / 3))
        for point, weight in zip(points.tolist(), weights.tolist(), strict=True)
    ]
    return OneEigenstrain(shape=shape, eigenstrain=eigenstrain, matrix=matrix, parts=columns, remainder=remainder.T)


def _applied(problem: Sphere, points: FloatArray) -> FloatArray:
    """Stress of the load at points ``(n, 3)`` of the matrix, ``(6, n)``."""
    from eigencontact.solvers.subsurface import stress_at_points

    if not problem.pressure:
        return np.zeros((6, len(points)))
    grid, pressure = _pressure(problem, 2.0 / _PRESSURE_CELLS, _PRESSURE_CELLS)
    return stress_at_points(grid, [_kernel(problem)], [pressure], points)


def _inside(problem: Sphere) -> tuple[FloatArray, FloatArray]:
    """Points ``(n, 3)`` and weights ``(n,)`` of a rule for means over the sphere; the weights add up to 1."""
    t, w = np.polynomial.legendre.leggauss(_RADIAL)
    c, v = np.polynomial.legendre.leggauss(_POLAR)
    turn = (np.arange(_AROUND) + 0.5) * 2.0 * np.pi / _AROUND
    r, cosine, angle = (m.ravel() for m in np.meshgrid(problem.radius * (t + 1) / 2, c, turn, indexing="ij"))
    weights = np.einsum("i,j,k->ijk", w * (t + 1) ** 2, v, np.ones(_AROUND)).ravel()
    sine = np.sqrt(1.0 - cosine**2)
    points = np.stack([r * sine * np.cos(angle), r * sine * np.sin(angle), problem.depth + r * cosine], axis=1)
    return points, weights / weights.sum()
