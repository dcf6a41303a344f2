"""Loads on the outer faces of a block: the field of the tractions, as point forces on the half-space.

Far away a patch of tractions is its point forces on a homogeneous half-space (Boussinesq, Cerruti), here those of at
most `BLOCKS` x `BLOCKS` parts of the loaded cells, so that moments and eccentric shear are in it. *Fixed* faces get
their displacement, *free* faces their traction. Layers, regions and eigenstrain add a field that decays faster and
that only the difference between the two shows.

The rigid motion of a free block is settled by reciprocity: beyond the faces two fields that decay do the same work on
each other, so that the tractions of a unit force or couple at the origin do the same work on the displacement of the
block as on that of the point forces. Then what the assumed tractions lack is of second order in the displacement under
the load.

References
----------
K. L. Johnson 1985, Contact Mechanics, eqs. 3.18 and 3.75 (displacement; stress follows by Hooke's law from complex
steps, so that there is no second formula to be wrong). J. N. Lyness, C. B. Moler 1967, SIAM J. Numer. Anal. 4, 202.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.assembly import gather
from eigencontact_verification.fem.loaded_body import Tractions
from eigencontact_verification.fem.mesh import Grid
from eigencontact_verification.fem.model import Model, lame

__all__ = ["BLOCKS", "PointForces", "far_field", "outer_loads", "unit_loads"]

FloatArray = NDArray[np.float64]

BLOCKS = 8
_STEP = 1e-20
_GAUSS = 4


@dataclass(frozen=True, kw_only=True, eq=False)
class PointForces:
    """Forces on the surface of a homogeneous half-space.

    Attributes
    ----------
    young_modulus, poisson_ratio : float
        Of the half-space.
    places : (n, 2) array
        x, y.
    forces : (n, 3) array
        On the body.
    """

    young_modulus: float
    poisson_ratio: float
    places: FloatArray
    forces: FloatArray

    def _at(self, x: NDArray[Any], y: NDArray[Any], z: NDArray[Any]) -> NDArray[Any]:
        n = 1 - 2 * self.poisson_ratio
        _, mu = lame(self.young_modulus, self.poisson_ratio)
        u = np.zeros((3, x.size), dtype=np.result_type(x, y, z))
        for place, (f, g, p) in zip(self.places, self.forces, strict=True):
            a, b = x - place[0], y - place[1]
            R = np.sqrt(a * a + b * b + z * z)
            inverse, sum_ = 1 / R, 1 / (R + z)
            cube, steep = inverse**3, n * inverse * sum_
            along = f * a + g * b  # the shear force times the distance along it
            common = along * (cube - steep * sum_)
            straight = inverse + n * sum_
            radial = p * (z * cube - steep)
            u[0] += f * straight + a * (common + radial)
            u[1] += g * straight + b * (common + radial)
            u[2] += along * (z * cube + steep) + p * (z * z * cube + (1 + n) * inverse)
        return u / (4 * np.pi * mu)

    def displacement(self, points: FloatArray) -> FloatArray:
        """Displacement (n, 3) at points (n, 3) off the forces."""
        x, y, z = np.asarray(points, dtype=float).T
        return self._at(x, y, z).T

    def stress(self, points: FloatArray) -> FloatArray:
        """Stress (n, 3, 3) at points (n, 3) off the forces."""
        scale = float(np.abs(points).max())
        slope = np.empty((len(points), 3, 3))
        for axis in range(3):
            moved = np.asarray(points, dtype=complex).T.copy()
            moved[axis] += 1j * _STEP * scale
            slope[:, :, axis] = self._at(*moved).imag.T / (_STEP * scale)
        lam, mu = lame(self.young_modulus, self.poisson_ratio)
        trace = lam * np.trace(slope, axis1=1, axis2=2)[:, None, None] * np.eye(3)
        return np.asarray(trace + mu * (slope + slope.swapaxes(1, 2)))


def far_field(tractions: Tractions | None, young_modulus: float, poisson_ratio: float) -> PointForces:
    """Point forces of the loaded cells, in parts of equal numbers of cells, each at the centre of its tractions."""
    places, forces = [], []
    if tractions is not None and tractions.values.any():
        force = tractions.values * np.diff(tractions.y)[:, None] * np.diff(tractions.x)
        weight = np.sqrt((force**2).sum(axis=0))
        x, y = ((e[1:] + e[:-1]) / 2 for e in (tractions.x, tractions.y))
        columns, rows = (np.flatnonzero(weight.any(axis=a)) for a in (0, 1))
        groups = [
            np.array_split(np.arange(hit[0], hit[-1] + 1), min(BLOCKS, hit[-1] + 1 - hit[0])) for hit in (columns, rows)
        ]
        for j in groups[1]:
            for i in groups[0]:
                block = np.ix_(j, i)
                if total := float(weight[block].sum()):
                    places.append((weight[block].sum(axis=0) @ x[i] / total, weight[block].sum(axis=1) @ y[j] / total))
                    forces.append(force[:, j][:, :, i].sum(axis=(1, 2)))
    return PointForces(
        young_modulus=young_modulus,
        poisson_ratio=poisson_ratio,
        places=np.array(places).reshape(-1, 2),
        forces=np.array(forces).reshape(-1, 3),
    )


def unit_loads(model: Model) -> list[PointForces]:
    """Forces and couples at the origin, one for each rigid motion that the planes of symmetry leave."""
    d = model.reach / 20
    x, y, z = np.eye(3)
    middle, along_x, along_y = np.zeros((1, 2)), np.array([(d, 0.0), (-d, 0.0)]), np.array([(0.0, d), (0.0, -d)])
    loads = (  # places, forces, and their symmetry in x and y
        (middle, x[None], ("odd", "even")),
        (middle, y[None], ("even", "odd")),
        (middle, z[None], ("even", "even")),
        (along_x, np.array([z, -z]), ("odd", "even")),
        (along_y, np.array([z, -z]), ("even", "odd")),
        (along_x, np.array([y, -y]), ("odd", "odd")),
    )
    return [
        PointForces(young_modulus=model.young_modulus, poisson_ratio=model.poisson_ratio, places=places, forces=forces)
        for places, forces, kinds in loads
        if all(plane in ("none", kind) for plane, kind in zip(model.symmetry, kinds, strict=True))
    ]


def _outer_faces(model: Model) -> Iterator[tuple[int, int]]:
    """Axis and end (0 low, -1 high) of the sides and the bottom."""
    yield from ((axis, -1) for axis in range(3))
    yield from ((axis, 0) for axis, kind in enumerate(model.symmetry) if kind == "none")


def outer_loads(model: Model, grid: Grid, fields: list[PointForces]) -> FloatArray:
    """Nodal forces of the tractions that fields have on sides and bottom, (fields, nodes, 3)."""
    nodes, weights = np.polynomial.legendre.leggauss(_GAUSS)
    u, v = (m.ravel() for m in np.meshgrid((nodes + 1) / 2, (nodes + 1) / 2, indexing="ij"))
    weight = np.outer(weights, weights).ravel() / 4
    load = np.zeros((len(fields), len(grid.nodes), 3))
    for axis, end in _outer_faces(model):
        at = np.insert(np.stack([u, v], axis=1), axis, 0.0 if end == 0 else 1.0, axis=1)
        shapes = weight[:, None] * grid.shapes(at)[0]
        elements = np.arange(grid.elements).reshape(grid.shape[::-1]).take(end, axis=2 - axis).ravel()
        points = (grid.low[elements][:, None] + at * grid.size[elements][:, None]).reshape(-1, 3)
        area = np.delete(grid.size[elements], axis, axis=1).prod(axis=1)
        sign = -1.0 if end == 0 else 1.0
        for number, field in enumerate(fields):
            traction = sign * field.stress(points)[:, :, axis].reshape(len(elements), -1, 3)
            force = np.einsum("e,qi,eqa->eia", area, shapes, traction, optimize=True)
            load[number] += gather(grid, grid.element_nodes[elements], force)
    return load
