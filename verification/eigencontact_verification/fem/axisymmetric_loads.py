"""Loads of axisymmetric models: discs and stored cells of pressure, and what a point force does far away.

References
----------
K. L. Johnson 1985, Contact Mechanics, section 3.2 (quoted as J.).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from skfem import CellBasis

from eigencontact_verification.fem.axisymmetric_cells import CellPressure
from eigencontact_verification.fem.axisymmetric_model import Disc

__all__ = ["point_force_displacement", "point_force_stress", "surface_load"]

FloatArray = NDArray[np.float64]

#: Gauss points along the loaded edge of an element.
_EDGE_POINTS = 16
#: Gauss points each way in a cell of pressure: this many per edge of the mesh that it spans, and at least, at most.
_PER_EDGE, _LEAST, _MOST = 4, 6, 16
#: The same in cells within so many edges or cells of the axis, where circles are smaller than cells.
_AXIS, _AT_AXIS = 6.0, 40


def point_force_displacement(
    load: float, young_modulus: float, poisson_ratio: float, r: FloatArray, z: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """u_r and u_z of a normal point force on the surface of a half-space, off its point (Boussinesq; J. eq. 3.18)."""
    nu, R = poisson_ratio, np.hypot(r, z)
    scale = (1 + nu) * load / (2 * np.pi * young_modulus)
    u_r = scale * (r * z / R**3 - (1 - 2 * nu) * r / (R * (R + z)))
    return np.asarray(u_r), np.asarray(scale * (z * z / R**3 + 2 * (1 - nu) / R))


def point_force_stress(
    load: float, poisson_ratio: float, r: FloatArray, z: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """s_rr, s_zz and s_rz of the same force (Boussinesq; J. eq. 3.19)."""
    R, scale = np.hypot(r, z), load / (2 * np.pi)
    s_rr = scale * ((1 - 2 * poisson_ratio) / (R * (R + z)) - 3 * r * r * z / R**5)
    return np.asarray(s_rr), np.asarray(-3 * scale * z**3 / R**5), np.asarray(-3 * scale * r * z * z / R**5)


def _disc_load(disc: Disc, basis: CellBasis) -> FloatArray:
    """Load vector (without the factor 2 pi) of a disc of pressure, exact to round-off; Hertz's by r = a sin t."""
    mesh = basis.mesh
    facets = mesh.boundary_facets()
    ends = mesh.p[:, mesh.facets[:, facets]]
    loaded = np.all(ends[1] == 0, axis=0) & (ends[0].max(axis=0) <= disc.radius * (1 + 1e-12))
    facets = facets[loaded]
    ends = np.minimum(ends[0][:, loaded], disc.radius)
    x, w = np.polynomial.legendre.leggauss(_EDGE_POINTS)
    x, w = (x + 1) / 2, w / 2
    if disc.profile == "uniform":
        span = ends[1] - ends[0]
        r = ends[0] + span * x[:, None]
        weight = disc.pressure * r * w[:, None] * np.abs(span)
    else:
        turn = np.arcsin(ends / disc.radius)
        span = turn[1] - turn[0]
        t = turn[0] + span * x[:, None]
        r = disc.radius * np.sin(t)
        weight = disc.pressure * disc.radius * np.cos(t) ** 2 * r * w[:, None] * np.abs(span)
    s = (r - ends[0]) / (ends[1] - ends[0])
    load = np.zeros(basis.N)
    first, last = basis.nodal_dofs[1, mesh.facets[:, facets]]
    for dofs, shape in ((first, (1 - s) * (1 - 2 * s)), (last, s * (2 * s - 1)), (None, 4 * s * (1 - s))):
        np.add.at(load, basis.facet_dofs[1, facets] if dofs is None else dofs, (weight * shape).sum(axis=0))
    return load


def _cells_load(cells: CellPressure, basis: CellBasis) -> FloatArray:
    """Load of stored cells: the mean over the angle of their load on the shape functions.

    Gauss points in the cells: force and, because quadratic elements hold r^2, the second moment are exact.
    """
    mesh = basis.mesh
    facets = mesh.boundary_facets()
    ends = mesh.p[:, mesh.facets[:, facets]]
    facets = facets[np.all(ends[1] == 0, axis=0)]
    low = mesh.p[0, mesh.facets[:, facets]].min(axis=0)
    order = np.argsort(low)
    facets, low = facets[order], low[order]
    nodes = mesh.facets[:, facets]
    ends = mesh.p[0, nodes]
    edge = float(np.abs(np.diff(ends, axis=0))[0, low < cells.radius].min())
    count = int(np.clip(np.ceil(_PER_EDGE * cells.widest / edge), _LEAST, _MOST))
    near = _AXIS * max(edge, cells.widest)
    rules = (cells.points(count, beyond=near), cells.points(_AT_AXIS, within=near))
    r, weight = (np.concatenate(columns) for columns in zip(*rules, strict=True))
    k = np.clip(np.searchsorted(low, r, side="right") - 1, 0, low.size - 1)
    s = (r - ends[0, k]) / (ends[1, k] - ends[0, k])
    first, last = basis.nodal_dofs[1, nodes[:, k]]
    load = np.zeros(basis.N)
    middle = basis.facet_dofs[1, facets[k]]
    for dofs, shape in ((first, (1 - s) * (1 - 2 * s)), (last, s * (2 * s - 1)), (middle, 4 * s * (1 - s))):
        load += np.bincount(dofs, weights=weight * shape, minlength=basis.N)
    return load / (2 * np.pi)


def surface_load(disc: Disc | CellPressure, basis: CellBasis) -> FloatArray:
    """Load vector (without the factor 2 pi) of a pressure on the surface, from z = 0 into the body."""
    return _disc_load(disc, basis) if isinstance(disc, Disc) else _cells_load(disc, basis)
