"""Stress of an axisymmetric model at points, recovered from where it is most exact.

Strain is an order more exact at the 2 x 2 Gauss points of quadratic elements than elsewhere (Barlow). What is
interpolated from there is what planes z = const leave continuous, e_rr, e_tt, s_zz and s_rz: interfaces, and faces of
stored cells, at which eigenstrain steps. The point's own moduli and eigenstrain give the other components. On the
tensor part of the mesh cubics in r and z interpolate; beside fitted and cut regions a cubic in both is fitted to the
nearest Gauss points on the point's own side. Where moduli are uniform on each side, as in the cross-check,
`recovered_section_stress` fits such cubics to stress itself at every point.

References
----------
J. Barlow 1976, Int. J. Numer. Methods Eng. 10, 243-251; O. C. Zienkiewicz and J. Z. Zhu 1992, ibid. 33, 1331-1364.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from eigencontact_verification.fem.axisymmetric import AxisymmetricSolution
from eigencontact_verification.fem.model import lame
from eigencontact_verification.fem.recovery import COUNT, OFFSETS, stencil

__all__ = ["fitted", "recovered", "recovered_section_stress", "section_gauss_points"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Gauss points to which a cubic in (r, z) with its ten coefficients is fitted, and the candidates for them.
_NEAREST, _CANDIDATES = 30, 400
#: Powers of r and z of its terms.
_POWERS = tuple((i, j) for i in range(4) for j in range(4 - i))


def recovered(solution: AxisymmetricSolution, points: FloatArray) -> FloatArray:
    """Stress (n, 3, 3) at Cartesian points (n, 3), off the boundaries of the regions."""
    r, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
    side_of_points = _side(solution, r, z)
    rs, wr = stencil(solution.grid.lines[0], r, mirrored=True)
    zs, wz = stencil(solution.grid.lines[1], z, breaks=solution.model.interfaces())
    rs, zs = (np.where(np.isnan(places), places[:, :1], places) for places in (rs, zs))
    shape = (r.size, COUNT, COUNT)
    sample_r, sample_z = np.broadcast_to(rs[:, :, None], shape), np.broadcast_to(zs[:, None, :], shape)
    beside = _curved(solution, np.abs(sample_r), sample_z)
    beside |= _side(solution, np.abs(sample_r), sample_z) != side_of_points[:, None, None]
    scattered = np.any(beside, axis=(1, 2))
    continuous = np.empty((4, r.size))
    tensor = np.flatnonzero(~scattered)
    if tensor.size:
        values = _continuous(solution, sample_r[tensor].ravel(), sample_z[tensor].ravel())
        values = values.reshape(4, tensor.size, COUNT, COUNT)
        continuous[:, tensor] = np.einsum("ni,nj,cnij->cn", wr[tensor], wz[tensor], values)
    outside_tensor = np.flatnonzero(scattered)
    if outside_tensor.size:
        continuous[:, outside_tensor] = _fitted(
            solution, r[outside_tensor], z[outside_tensor], side_of_points[outside_tensor]
        )
    return _whole(solution, points, continuous)


def _side(solution: AxisymmetricSolution, r: FloatArray, z: FloatArray) -> IntArray:
    """Number of the layers above, and a bit for every region that holds the point."""
    model = solution.model
    side = np.searchsorted(model.interfaces(), z).astype(np.int64)
    for k, region in enumerate(model.regions):
        side += np.where(np.asarray(region.contains(r, z), dtype=bool), 1 << (8 + k), 0)
    return side


def _curved(solution: AxisymmetricSolution, r: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
    """Whether points lie in the box of a fitted region."""
    out = np.zeros(r.shape, dtype=bool)
    for fit in solution.model.fits():
        low, high = fit.box
        out |= (r > low[0]) & (r < high[0]) & (z > low[1]) & (z < high[1])
    return out


def _continuous(solution: AxisymmetricSolution, r: FloatArray, z: FloatArray) -> FloatArray:
    """e_rr, e_tt, s_zz, s_rz (4, n); beyond the axis, r < 0, the shear has the other sign."""
    strain, material, _ = solution.strain(np.stack([np.abs(r), 0 * r, z], axis=1))
    lam, shear = lame(material[0], material[1])
    elastic = strain - material[2:]
    normal = lam * elastic[:3].sum(axis=0) + 2 * shear * elastic[2]
    return np.stack([strain[0], strain[1], normal, np.where(r < 0, -1.0, 1.0) * 2 * shear * elastic[3]])


def _whole(solution: AxisymmetricSolution, points: FloatArray, continuous: FloatArray) -> FloatArray:
    """Stress (n, 3, 3) from what is continuous and the point's own constants."""
    _, material, turn = solution.strain(points)
    lam, shear = lame(material[0], material[1])
    radial, hoop = continuous[0] - material[2], continuous[1] - material[3]
    along = (continuous[2] - lam * (radial + hoop)) / (lam + 2 * shear)
    mean = lam * (radial + hoop + along)
    polar = np.zeros((3, 3, len(points)))
    polar[0, 0], polar[1, 1], polar[2, 2] = mean + 2 * shear * radial, mean + 2 * shear * hoop, continuous[2]
    polar[0, 2] = polar[2, 0] = continuous[3]
    frame = np.zeros_like(polar)
    frame[0, 0], frame[1, 0], frame[0, 1], frame[1, 1], frame[2, 2] = turn[0], turn[1], -turn[1], turn[0], 1.0
    return np.asarray(np.einsum("ian,abn,jbn->nij", frame, polar, frame))


def _fitted(solution: AxisymmetricSolution, r: FloatArray, z: FloatArray, side_of_points: IntArray) -> FloatArray:
    """Continuous components, (4, n), by cubics through the nearest Gauss points on the same side."""
    nodes = solution.grid.nodes
    gauss, element = section_gauss_points(nodes)
    side = _side(solution, np.abs(gauss[:, 0]), gauss[:, 1])

    def values(chosen: IntArray) -> FloatArray:
        return _continuous(solution, gauss[chosen, 0], gauss[chosen, 1])

    return fitted(values, nodes, gauss, element, side, np.stack([r, z], axis=1), side_of_points)


def fitted(
    values: Callable[[IntArray], FloatArray], nodes: FloatArray, gauss: FloatArray, element: IntArray, side: IntArray,
    at: FloatArray, side_of_points: IntArray,
) -> FloatArray:  # fmt: skip
    """Values (k, n) at points by cubics through the nearest Gauss points on the same side, by least squares.

    Parameters
    ----------
    values : callable
        Values (k, m) at the Gauss points of numbers (m,).
    nodes : (2, 9, elements) float64
    gauss, element, side : (g, 2) float64, (g,) int64, (g,) int64 or bool
        Gauss points, their elements, and a number for the side that each lies on.
    at, side_of_points : (n, 2) float64, (n,) int64 or bool
        Points, and the side that each lies on.
    """
    columns: list[FloatArray] = [np.empty(0)] * len(at)
    for key in np.unique(side_of_points):
        chosen, targets = np.flatnonzero(side == key), np.flatnonzero(side_of_points == key)
        places = at[targets]
        near = chosen[cKDTree(gauss[chosen]).query(places, k=min(_CANDIDATES, chosen.size))[1].reshape(len(places), -1)]
        spread = np.stack([np.linalg.cholesky(np.cov(nodes[:, :, e])) for e in element[near[:, 0]]])
        mirrored = gauss[near[:, 0], 0] * nodes[0, 8, element[near[:, 0]]] < 0
        spread = np.where(mirrored[:, None, None], spread * np.array([[-1.0], [1.0]]), spread)
        local = np.linalg.solve(spread[:, None], (gauss[near] - places[:, None])[..., None])[..., 0]
        nearest = np.argsort(np.hypot(local[..., 0], local[..., 1]), axis=1)[:, :_NEAREST]
        local, near = np.take_along_axis(local, nearest[..., None], axis=1), np.take_along_axis(near, nearest, axis=1)
        distance = np.hypot(local[..., 0], local[..., 1])
        size = distance[:, -1:]
        local, weight = local / size[..., None], np.exp(-2.0 * (distance / size) ** 2)[..., None]
        table = values(near.ravel())
        matrix = np.stack([local[..., 0] ** i * local[..., 1] ** j for i, j in _POWERS], axis=-1)
        solved = np.linalg.pinv(weight * matrix) @ (weight * np.moveaxis(table.reshape(len(table), *near.shape), 0, -1))
        for k, value in zip(targets, solved[:, 0], strict=True):
            columns[k] = value
    return np.stack(columns, axis=1)


def section_gauss_points(nodes: FloatArray) -> tuple[FloatArray, IntArray]:
    """Gauss points ``(m, 2)`` (r, z) of an axisymmetric mesh, on both sides of the axis, and the element of each.

    Parameters
    ----------
    nodes : (2, 9, elements) array
        Corners, middles of edges, centre.
    """
    lattice = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1))
    places = []
    for s in OFFSETS:
        for t in OFFSETS:
            first, second = ((2 * (x - 0.5) * (x - 1), 4 * x * (1 - x), 2 * x * (x - 0.5)) for x in (s, t))
            places.append(np.einsum("ane,n->ea", nodes, np.array([first[i] * second[j] for i, j in lattice])))
    gauss = np.concatenate(places)
    # beyond the axis, so that points near it have neighbours
    return np.concatenate([gauss, gauss * (-1.0, 1.0)]), np.tile(np.arange(nodes.shape[2]), 2 * len(places))


def recovered_section_stress(
    solution: AxisymmetricSolution,
    points: FloatArray,
    *,
    side: Callable[[FloatArray, FloatArray, FloatArray], NDArray[Any]],
) -> FloatArray:
    """Stress ``(n, 3, 3)`` at points ``(n, 3)`` of the plane y = 0, by cubics fitted to all of its components.

    Parameters
    ----------
    solution : AxisymmetricSolution
        Of `eigencontact_verification.fem.axisymmetric`.
    points : (n, 3) array
        Places off the boundaries of the sources, y = 0.
    side : callable
        Numbers at x, y, z that tell sides of boundaries apart; each point takes part of its own side only.
    """
    gauss, element = section_gauss_points(solution.grid.nodes)
    gauss_points = np.insert(gauss, 1, 0.0, axis=1)

    def values(chosen: IntArray) -> FloatArray:
        return solution.stress(gauss_points[chosen]).reshape(-1, 9).T

    sides = np.asarray(side(*gauss_points.T)), np.asarray(side(*points.T))
    stress = fitted(values, solution.grid.nodes, gauss, element, sides[0], points[:, [0, 2]], sides[1])
    return stress.T.reshape(-1, 3, 3)
