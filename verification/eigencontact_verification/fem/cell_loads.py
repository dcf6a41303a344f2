"""Tractions, eigenstrain and damage that are uniform in boxes, on tensor-product meshes whose lines lie elsewhere.

Boxes and elements are both products of intervals: the integral of a shape function or of its slope over a box is a
product of integrals along x, y and z, which are cubics. Nothing is sampled, so the mesh need not follow the boxes.

In an element whose moduli vary (a region cuts it, or damage) eigenstrain and what damage leaves enter by their exact
means over the sub-cells of `assembly`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.fem.assembly import CELLS, Material, gather, hooke
from eigencontact_verification.fem.loaded_body import Cells, Tractions
from eigencontact_verification.fem.mesh import Grid

__all__ = ["cell_state", "cells_load", "damaged", "integrals", "overlaps", "traction_cells_load"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
_PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
_PLACE = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])


def overlaps(line: FloatArray, edges: FloatArray) -> FloatArray:
    """Length that each interval of a line shares with each interval of the edges, (line - 1, edges - 1)."""
    low = np.maximum(line[:-1, None], edges[None, :-1])
    return np.asarray(np.maximum(np.minimum(line[1:, None], edges[None, 1:]) - low, 0.0))


def integrals(line: FloatArray, edges: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Integrals of the three quadratic shape functions of each element, and of their slopes, over each interval.

    Parameters
    ----------
    line : (n + 1,) array
        Ends of the elements.
    edges : (m + 1,) array
        Ends of the intervals.

    Returns
    -------
    values, slopes : (n, 3, m) arrays

    Examples
    --------
    >>> values, slopes = integrals(np.array([0.0, 1.0]), np.array([-1.0, 0.5, 2.0]))
    >>> values.sum(axis=(0, 1)).round(12).tolist(), slopes.sum(axis=1).round(12).tolist()
    ([0.5, 0.5], [[0.0, 0.0]])
    """
    size = np.diff(line)[:, None]
    low = np.clip((edges[None, :-1] - line[:-1, None]) / size, 0.0, 1.0)
    high = np.clip((edges[None, 1:] - line[:-1, None]) / size, 0.0, 1.0)

    def shapes(s: FloatArray) -> FloatArray:
        return np.stack([1 - 3 * s + 2 * s * s, 4 * s - 4 * s * s, 2 * s * s - s], axis=1)

    def primitives(s: FloatArray) -> FloatArray:
        return np.stack([s - 1.5 * s**2 + 2 / 3 * s**3, 2 * s**2 - 4 / 3 * s**3, 2 / 3 * s**3 - 0.5 * s**2], axis=1)

    return size[:, None] * (primitives(high) - primitives(low)), shapes(high) - shapes(low)


def _to_nodes(values: FloatArray) -> FloatArray:
    """Sum what elements (n, 3, m) give to the nodes of a line, (2 n + 1, m)."""
    out = np.zeros((2 * len(values) + 1, values.shape[2]))
    for place in range(3):
        out[place : place + 2 * len(values) : 2] += values[:, place]
    return out


def traction_cells_load(grid: Grid, tractions: Tractions) -> FloatArray:
    """Nodal forces of the tractions, (nodes, 3)."""
    x, y = (_to_nodes(integrals(grid.lines[a], edges)[0]) for a, edges in enumerate((tractions.x, tractions.y)))
    load = np.zeros((len(grid.nodes), 3))
    load[: len(x) * len(y)] = (y @ tractions.values @ x.T).reshape(3, -1).T
    return load


def _edges(cells: Cells) -> tuple[FloatArray, FloatArray, FloatArray]:
    return cells.x, cells.y, cells.z


def cells_load(grid: Grid, stuff: Material, boxes: Sequence[Cells]) -> FloatArray:
    """Nodal forces of the eigenstrain of boxes in elements that are uniform, (nodes, 3): ``∫ (C : e*)_ab dphi/dx_b``.

    Elements that are cut have it in their eigenstress, from `damaged`.
    """
    load = np.zeros((len(grid.nodes), 3))
    whole = np.ones(grid.elements, dtype=bool)
    whole[stuff.cut] = False
    for cells in boxes:
        if not cells.eigenstrain.any():
            continue
        strain = np.stack([cells.eigenstrain[a, b] for a, b in _PAIRS])
        along = [integrals(line, edges) for line, edges in zip(grid.lines, _edges(cells), strict=True)]
        # only elements that a box touches
        spans = []
        for values, _ in along:
            hit = np.flatnonzero(np.abs(values).sum(axis=(1, 2)) > 0)
            spans.append(slice(int(hit[0]), int(hit[-1]) + 1) if hit.size else slice(0, 0))
        nx, ny, nz = (span.stop - span.start for span in spans)
        number = np.arange(grid.elements).reshape(grid.shape[::-1])[spans[2], spans[1], spans[0]].ravel()
        lam, mu = (whole[number] * modulus[number] for modulus in (stuff.lam, stuff.mu))
        a, b, c = grid.local.T
        force = np.zeros((number.size, len(grid.local), 3))
        for derived in range(3):
            x, y, z = (
                along[axis][int(axis == derived)][spans[axis]].reshape(-1, along[axis][0].shape[2]) for axis in range(3)
            )
            moment = np.tensordot(np.matmul(y, strain @ x.T), z, axes=(1, 1))  # (6, 3 ny, 3 nx, 3 nz)
            moment = moment.reshape(6, ny, 3, nx, 3, nz, 3)[:, :, b, :, a, :, c]  # local nodes come first
            moment = np.moveaxis(moment, (4, 2, 3), (0, 1, 2)).reshape(number.size, len(grid.local), 6)
            force[..., derived] += lam[:, None] * moment[..., :3].sum(axis=-1)
            for component in range(3):
                force[..., component] += 2 * mu[:, None] * moment[..., _PLACE[component, derived]]
        load += gather(grid, grid.element_nodes[number], force)
    return load


def _means(grid: Grid, cells: Cells, values: FloatArray, outside: float) -> tuple[IntArray, FloatArray]:
    """Elements that boxes touch, and means of values (..., nz, ny, nx) in their sub-cells (elements, sub, ...)."""
    shares, spans = [], []
    for line, edges in zip(grid.lines, _edges(cells), strict=True):
        fine = np.interp(np.arange(CELLS * (line.size - 1) + 1) / CELLS, np.arange(line.size), line)
        share = overlaps(fine, edges) / np.diff(fine)[:, None]
        hit = np.flatnonzero(share.sum(axis=1) > 0)
        span = slice(int(hit[0]) // CELLS, int(hit[-1]) // CELLS + 1) if hit.size else slice(0, 0)
        spans.append(span)
        shares.append(share[CELLS * span.start : CELLS * span.stop])
    x, y, z = shares
    mean = np.matmul(y, (values - outside) @ x.T)
    mean = np.moveaxis(np.tensordot(mean, z, axes=(-3, 1)), -1, -3) + outside
    nx, ny, nz = (span.stop - span.start for span in spans)
    lead = values.shape[:-3]
    mean = mean.reshape(*lead, nz, CELLS, ny, CELLS, nx, CELLS)
    n = len(lead)
    # element (z, y, x), then sub-cells with x slowest, as in `assembly`
    mean = mean.transpose(n, n + 2, n + 4, n + 5, n + 3, n + 1, *range(n)).reshape(nx * ny * nz, CELLS**3, *lead)
    number = np.arange(grid.elements).reshape(grid.shape[::-1])[spans[2], spans[1], spans[0]].ravel()
    return number, mean


def damaged(grid: Grid, stuff: Material, boxes: Sequence[Cells]) -> Material:
    """Moduli with what damage leaves of them, and the eigenstrain of boxes in the elements that are cut."""
    for cells in boxes:
        if cells.stiffness_factor is None:
            continue
        number, stiffness = _means(grid, cells, cells.stiffness_factor, 1.0)
        varied = number[np.ptp(stiffness, axis=1) > 1e-12]
        stuff = _cut_more(stuff, varied)
        factor = np.ones((grid.elements, 1))
        factor[number, 0] = stiffness.mean(axis=1)
        row = np.full(grid.elements, -1)
        row[number] = np.arange(number.size)
        sub_cells = np.ones((stuff.cut.size, CELLS**3))
        touched = row[stuff.cut] >= 0
        sub_cells[touched] = stiffness[row[stuff.cut[touched]]]
        cut_lam, cut_mu = sub_cells * stuff.cut_lam, sub_cells * stuff.cut_mu
        lam, mu = factor[:, 0] * stuff.lam, factor[:, 0] * stuff.mu
        lam[stuff.cut], mu[stuff.cut] = cut_lam.mean(axis=1), cut_mu.mean(axis=1)
        stuff = Material(
            lam=lam, mu=mu, eigenstress=factor[:, :, None] * stuff.eigenstress, cut=stuff.cut, cut_lam=cut_lam,
            cut_mu=cut_mu, cut_eigenstress=sub_cells[:, :, None, None] * stuff.cut_eigenstress,
        )  # fmt: skip
    for cells in boxes:
        if not stuff.cut.size or not cells.eigenstrain.any():
            continue
        number, strain = _means(grid, cells, cells.eigenstrain, 0.0)
        row = np.full(grid.elements, -1)
        row[number] = np.arange(number.size)
        hit = np.flatnonzero(row[stuff.cut] >= 0)
        stuff.cut_eigenstress[hit] += hooke(stuff.cut_lam[hit], stuff.cut_mu[hit], strain[row[stuff.cut[hit]]])
    return stuff


def _cut_more(stuff: Material, elements: IntArray) -> Material:
    """Material with more of its elements in sub-cells."""
    new = np.setdiff1d(elements, stuff.cut)
    if not new.size:
        return stuff
    cut = np.concatenate([stuff.cut, new])
    order = np.argsort(cut)
    count = CELLS**3

    def joined(sub_cells: FloatArray, wholes: FloatArray) -> FloatArray:
        more = np.repeat(wholes[new][:, None], count, axis=1)
        return np.concatenate([sub_cells, more])[order]

    return Material(
        lam=stuff.lam, mu=stuff.mu, eigenstress=stuff.eigenstress, cut=cut[order],
        cut_lam=joined(stuff.cut_lam, stuff.lam), cut_mu=joined(stuff.cut_mu, stuff.mu),
        cut_eigenstress=joined(stuff.cut_eigenstress, stuff.eigenstress),
    )  # fmt: skip


def cell_state(boxes: Sequence[Cells], points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Factor of the moduli (n,), and the eigenstrain (n, 3, 3) of boxes, at points (n, 3)."""
    stiffness, strain = np.ones(len(points)), np.zeros((len(points), 3, 3))
    for cells in boxes:
        at = [np.searchsorted(edges, points[:, axis], side="right") - 1 for axis, edges in enumerate(_edges(cells))]
        inside = np.logical_and.reduce([(i >= 0) & (i < e.size - 1) for i, e in zip(at, _edges(cells), strict=True)])
        x, y, z = (i[inside] for i in at)
        strain[inside] += np.moveaxis(cells.eigenstrain[:, :, z, y, x], -1, 0)
        if cells.stiffness_factor is not None:
            stiffness[inside] *= cells.stiffness_factor[z, y, x]
    return stiffness, strain
