"""Stiffness and loads on boxes: exact integrals of the reference element, scaled; cut elements by sub-cells.

In a box the gradient of a shape function is the reference gradient divided by the edges, so that the stiffness of a
homogeneous element is a sum of nine fixed matrices. An element that a region cuts is divided into `CELLS`^3 sub-cells,
whose moduli and eigenstress are means over `SAMPLES`^3 points each.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from eigencontact_verification.fem.mesh import Grid
from eigencontact_verification.fem.model import Model, lame

__all__ = [
    "CELLS",
    "SAMPLES",
    "Material",
    "eigenstrain_load",
    "face_weights",
    "gather",
    "hooke",
    "material",
    "point_state",
    "state",
    "stiffness",
    "traction_load",
]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

CELLS = 4
SAMPLES = 4


def point_state(model: Model, points: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Lamé's parameters and eigenstrain at points.

    Parameters
    ----------
    model : Model
        The body.
    points : (n, 3) array
        Places.

    Returns
    -------
    lambda, mu : (n,) arrays
        Moduli of the last region that has some of its own and contains the point, or else of the layer.
    eigenstrain : (n, 3, 3) array
        Sum over the regions that contain the point.
    """
    x, y, z = np.ascontiguousarray(points.T)
    young, nu = np.full(x.shape, float(model.young_modulus)), np.full(x.shape, float(model.poisson_ratio))
    bottom = sum(layer.thickness for layer in model.layers)
    for layer in reversed(model.layers):
        above = z < bottom
        young[above], nu[above] = layer.young_modulus, layer.poisson_ratio
        bottom -= layer.thickness
    strain = np.zeros((x.size, 3, 3))
    first, last = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.zeros(3))
    for region in model.regions:
        low, high = (np.asarray(corner) for corner in region.bounds)
        if (high < first).any() or (low > last).any():
            continue  # of hundreds of regions a chunk of points meets few
        within = [(low[k] <= along) & (along <= high[k]) for k, along in enumerate((x, y, z))]
        near = np.flatnonzero(within[0] & within[1] & within[2])
        hit = near[np.asarray(region.contains(x[near], y[near], z[near]), dtype=bool)]
        strain[hit] += region.eigenstrain
        if region.young_modulus is not None:
            young[hit] = region.young_modulus
        if region.poisson_ratio is not None:
            nu[hit] = region.poisson_ratio
    return *lame(young, nu), strain


def hooke(lam: FloatArray, mu: FloatArray, strain: FloatArray) -> FloatArray:
    """Stress ``lambda tr(e) I + 2 mu e`` of strains (..., 3, 3)."""
    trace = np.trace(strain, axis1=-2, axis2=-1)
    return np.asarray((lam * trace)[..., None, None] * np.eye(3) + 2 * mu[..., None, None] * strain)


@dataclass(frozen=True, kw_only=True)
class Material:
    """Moduli and eigenstress of every element, and of the sub-cells of elements that are cut.

    Attributes
    ----------
    lam, mu : (elements,) arrays
        Lamé's parameters; of cut elements the mean.
    eigenstress : (elements, 3, 3) array
        ``C : e*`` less the polarisation by the remote strain; of cut elements the mean.
    cut : (c,) int array
        Elements that are not uniform.
    cut_lam, cut_mu, cut_eigenstress : (c, CELLS**3), (c, CELLS**3), (c, CELLS**3, 3, 3) arrays
        The same in their sub-cells, the x index slowest.
    """

    lam: FloatArray
    mu: FloatArray
    eigenstress: FloatArray
    cut: IntArray
    cut_lam: FloatArray
    cut_mu: FloatArray
    cut_eigenstress: FloatArray


def _lattice(along: FloatArray) -> FloatArray:
    return np.stack(np.meshgrid(along, along, along, indexing="ij"), axis=-1).reshape(-1, 3)


def remote_strain(model: Model) -> FloatArray:
    """Strain of the matrix under the remote stress, (3, 3)."""
    if model.remote_stress is None:
        return np.zeros((3, 3))
    lam, mu = lame(model.young_modulus, model.poisson_ratio)
    stress = model.remote_stress
    return np.asarray((stress - lam * np.trace(stress) / (3 * lam + 2 * mu) * np.eye(3)) / (2 * mu))


def state(model: Model, points: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Lamé's parameters and eigenstress at points: ``C : (e* - e_remote) + s_remote``; stress is ``C : e`` less it."""
    lam, mu, strain = point_state(model, points)
    stress = hooke(lam, mu, strain - remote_strain(model))
    if model.remote_stress is not None:
        stress = stress + model.remote_stress
    return lam, mu, stress


def material(model: Model, grid: Grid) -> Material:
    """Sample the regions of a model on its mesh."""
    lam, mu, stress = state(model, grid.low + grid.size / 2)
    cut = []
    probes = _lattice(np.linspace(1e-7, 1 - 1e-7, CELLS + 1))
    for region in model.regions:
        low, high = (np.asarray(corner) for corner in region.bounds)
        tiny = 1e-9 * (high - low)
        near = np.flatnonzero(((grid.low < high - tiny) & (grid.low + grid.size > low + tiny)).all(axis=1))
        points = grid.low[near, None] + probes * grid.size[near, None]
        inside = np.asarray(region.contains(*np.moveaxis(points, -1, 0)), dtype=bool)
        inside &= ((points >= low) & (points <= high)).all(axis=-1)
        cut.append(near[inside.any(axis=1) & ~inside.all(axis=1)])
    mixed = np.unique(np.concatenate(cut)) if cut else np.empty(0, dtype=np.int64)
    cells = CELLS**3
    sampled: tuple[FloatArray, FloatArray, FloatArray] = (
        np.empty((mixed.size, cells)),
        np.empty((mixed.size, cells)),
        np.empty((mixed.size, cells, 3, 3)),
    )
    fine = _lattice((np.arange(SAMPLES) + 0.5) / (CELLS * SAMPLES))
    samples = (_lattice(np.arange(CELLS) / CELLS)[:, None] + fine).reshape(-1, 3)
    for start in range(0, mixed.size, 16):
        chunk = slice(start, start + 16)
        elements = mixed[chunk]
        points = (grid.low[elements, None] + samples * grid.size[elements, None]).reshape(-1, 3)
        for target, value in zip(sampled, state(model, points), strict=True):
            target[chunk] = value.reshape(elements.size, cells, SAMPLES**3, *value.shape[1:]).mean(axis=2)
    for whole, target in zip((lam, mu, stress), sampled, strict=True):
        whole[mixed] = target.mean(axis=1)
    return Material(
        lam=lam, mu=mu, eigenstress=stress, cut=mixed, cut_lam=sampled[0], cut_mu=sampled[1], cut_eigenstress=sampled[2]
    )


def _gauss(count: int) -> tuple[FloatArray, FloatArray]:
    """Gauss points and weights on [0, 1]^3."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return _lattice((nodes + 1) / 2), np.einsum("i,j,k->ijk", weights, weights, weights).ravel() / 8


@lru_cache(maxsize=4)
def _reference(order: int, cells: int) -> tuple[FloatArray, FloatArray]:
    """Integrals of reference gradients over sub-cells: products (cells^3, 3, 3, n, n) and gradients (cells^3, n, 3)."""
    grid = Grid(lines=(np.array([0.0, 1.0]),) * 3, order=order)
    points, weights = _gauss(order + 1)
    products, gradients = [], []
    for corner in _lattice(np.arange(cells) / cells):
        _, slopes = grid.shapes(corner + points / cells)
        products.append(np.einsum("q,qia,qjb->abij", weights / cells**3, slopes, slopes, optimize=True))
        gradients.append(np.einsum("q,qia->ia", weights / cells**3, slopes))
    return np.stack(products), np.stack(gradients)


def _neighbours(grid: Grid, axis: int) -> tuple[IntArray, IntArray]:
    """First and number of the nodes along one axis that share an element with each node of it."""
    place = np.arange(grid.axes[axis].size)
    last = grid.shape[axis] - 1
    low = np.clip((place - 1) // grid.order, 0, last) * grid.order
    high = (np.clip(place // grid.order, 0, last) + 1) * grid.order
    return low, high - low + 1


def _pattern(grid: Grid) -> tuple[IntArray, NDArray[np.int32]]:
    """Pointers and columns of coupled nodes in compressed form."""
    (x, nx), (y, ny), (z, nz) = (_neighbours(grid, axis) for axis in range(3))
    mx, my = grid.axes[0].size, grid.axes[1].size
    counts = (nz[:, None, None] * ny[:, None] * nx).ravel()
    pointer = np.concatenate(([0], np.cumsum(counts)))
    rows = np.repeat(np.arange(counts.size, dtype=np.int32), counts)
    offset = np.arange(pointer[-1]) - pointer[rows]
    i, j, k = rows % mx, rows // mx % my, rows // (mx * my)
    wide, tall = nx[i], ny[j]
    columns = ((z[k] + offset // (wide * tall)) * my + y[j] + offset // wide % tall) * mx + x[i] + offset % wide
    return pointer, columns.astype(np.int32)


@dataclass(frozen=True, kw_only=True)
class _Slab:
    """Products of gradients of the elements between two planes z = const, weighted with a modulus."""

    scale: FloatArray  # (elements, 3, 3)
    elements: slice
    inner: IntArray  # elements of the slab that are cut
    cut: IntArray  # the same, numbered among all that are cut
    whole: FloatArray  # reference products (3, 3, n, n)
    cells: FloatArray  # of the sub-cells (cells^3, 3, 3, n, n)

    def products(self, modulus: FloatArray, sub_cells: FloatArray, a: int, b: int) -> FloatArray:
        """Integrals ``modulus dphi_i/dx_a dphi_j/dx_b``, (elements, n, n)."""
        out = np.multiply.outer(modulus[self.elements] * self.scale[:, a, b], self.whole[a, b])
        if self.inner.size:
            inside = np.tensordot(sub_cells[self.cut], self.cells[:, a, b], axes=1)
            out[self.inner] = self.scale[self.inner, a, b, None, None] * inside
        return np.asarray(out)


def stiffness(grid: Grid, stuff: Material) -> sp.bsr_matrix:
    """Stiffness of all unknowns, 3 to a node, without constraints, as 3 x 3 blocks."""
    (whole,), _ = _reference(grid.order, 1)
    cells = _reference(grid.order, CELLS)[0] if stuff.cut.size else np.empty(0)
    pointer, columns = _pattern(grid)
    first, count = zip(*(_neighbours(grid, axis) for axis in range(3)), strict=True)
    data = np.zeros((columns.size, 3, 3))
    scale = grid.size.prod(axis=1)[:, None, None] / (grid.size[:, :, None] * grid.size[:, None, :])
    nx, ny, nz = grid.shape
    flat = np.arange(nx * ny)
    for layer in range(nz):
        elements = slice(layer * nx * ny, (layer + 1) * nx * ny)
        # where each pair of nodes of an element is in its row, whose columns are a box of nodes
        start = np.stack([flat % nx, flat // nx, np.full_like(flat, layer)], axis=1)
        at = np.moveaxis(grid.order * start[:, None] + grid.local, -1, 0)
        i, j, k = (at[a][:, None, :] - first[a][at[a]][:, :, None] for a in range(3))
        wide, tall = (count[a][at[a]][:, :, None] for a in (0, 1))
        where = pointer[grid.element_nodes[elements]][:, :, None] + (k * tall + j) * wide + i
        begin, end = int(where.min()), int(where.max()) + 1
        where = (where - begin).ravel()
        cut = np.flatnonzero((stuff.cut >= elements.start) & (stuff.cut < elements.stop))
        slab = _Slab(
            scale=scale[elements], elements=elements, inner=stuff.cut[cut] - elements.start, cut=cut, whole=whole,
            cells=cells,
        )  # fmt: skip
        laplace = sum(slab.products(stuff.mu, stuff.cut_mu, c, c) for c in range(3))
        for a in range(3):
            for b in range(3):
                value = slab.products(stuff.lam, stuff.cut_lam, a, b) + slab.products(stuff.mu, stuff.cut_mu, b, a)
                if a == b:
                    value += laplace
                data[begin:end, a, b] += np.bincount(where, weights=value.ravel(), minlength=end - begin)
    unknowns = 3 * len(grid.nodes)
    return sp.bsr_matrix((data, columns, pointer.astype(np.int32)), shape=(unknowns, unknowns))


def eigenstrain_load(grid: Grid, stuff: Material) -> FloatArray:
    """Nodal forces of the eigenstress, (nodes, 3): the integral of ``S_ab dphi/dx_b``."""
    _, (g,) = _reference(grid.order, 1)
    _, cells = _reference(grid.order, CELLS)
    turned = stuff.eigenstress / grid.size[:, None, :] * grid.size.prod(axis=1)[:, None, None]
    values = np.einsum("eab,ib->eia", turned, g)
    if stuff.cut.size:
        h = grid.size[stuff.cut]
        inner = stuff.cut_eigenstress / h[:, None, None, :] * h.prod(axis=1)[:, None, None, None]
        values[stuff.cut] = np.einsum("csab,sib->cia", inner, cells, optimize=True)
    return gather(grid, grid.element_nodes, values)


def face_weights(grid: Grid, axis: int, end: int) -> tuple[IntArray, FloatArray]:
    """Elements at one end of an axis (0 low, -1 high), and integrals of the shape functions over their outer faces.

    Returns
    -------
    (faces,) int array, (faces, local nodes) array
    """
    nodes, weights = np.polynomial.legendre.leggauss(grid.order + 1)
    u, v = (m.ravel() for m in np.meshgrid((nodes + 1) / 2, (nodes + 1) / 2, indexing="ij"))
    at = np.insert(np.stack([u, v], axis=1), axis, 0.0 if end == 0 else 1.0, axis=1)
    share = np.outer(weights, weights).ravel() / 4 @ grid.shapes(at)[0]
    elements = np.arange(grid.elements).reshape(grid.shape[::-1]).take(end, axis=2 - axis).ravel()
    area = np.delete(grid.size[elements], axis, axis=1).prod(axis=1)
    return elements, np.outer(area, share)


def traction_load(model: Model, grid: Grid) -> FloatArray:
    """Nodal forces of the patches, (nodes, 3)."""
    elements, weights = face_weights(grid, 2, 0)
    middle = (grid.low + grid.size / 2)[elements, :2]
    load = np.zeros((len(grid.nodes), 3))
    for patch in model.patches:
        hit = ((middle > patch.low) & (middle < patch.high)).all(axis=1)
        force = np.multiply.outer(weights[hit], np.asarray(patch.traction, dtype=float))
        load += gather(grid, grid.element_nodes[elements[hit]], force)
    return load


def gather(grid: Grid, nodes: IntArray, values: FloatArray) -> FloatArray:
    """Sum values (elements, local nodes, 3) at nodes (elements, local nodes), (nodes, 3)."""
    count = len(grid.nodes)
    return np.stack(
        [np.bincount(nodes.ravel(), weights=values[..., a].ravel(), minlength=count) for a in range(3)], axis=1
    )
