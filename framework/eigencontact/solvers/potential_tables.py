"""Derivatives of the potentials of one cell at many offsets: corner functions at lattice nodes, differenced."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache, partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.parallel import in_parallel
from eigencontact.halfspace.endless import EndlessCell
from eigencontact.halfspace.forms import INSIDE, Form, Kernel, reduced, reduced_in_plane
from eigencontact.halfspace.potentials import HasCornerPotentials
from eigencontact.halfspace.theorem import QUANTITIES, response
from eigencontact.solvers.cells import Cells

__all__ = [
    "ON_FACE",
    "Forms",
    "cell_kernels",
    "far_apart",
    "kernel_groups",
    "nodes_around",
    "parity_of",
    "reduced_response",
    "response_of",
    "sample_tables",
    "seen_from_inside",
    "symmetry",
    "unit_of_length",
]

Forms = tuple[tuple[Form, ...], ...]

# Distance of the four points around an edge from the edge, in the shortest edge of a cell.
_AROUND = 0.25
# Number of nodes evaluated together.
_CHUNK_NODES = 12_000
# Memory for tables held together [bytes].
_GROUP_BYTES = 300_000_000
# Distance in cells from which corner functions are evaluated in extended precision.
_FAR = 2.5
#: Distance in cells below which a point counts as being on a face.
ON_FACE = 1e-9
# Depth of a node in the surface: the limit from inside the body.
_BELOW_SURFACE = 1e-30


def unit_of_length(pitch: Sequence[float]) -> float:
    """Power of two near the longest edge of a cell [m]; in this unit all kernels are numbers of order one."""
    return float(2.0 ** np.round(np.log2(max(pitch))))


@lru_cache(maxsize=64)  # a run needs the same few responses in every plane, cell and estimate
def reduced_response(quantity: str, nu: float, space: str, *, in_plane: bool = False) -> Forms:
    """Forms of `eigencontact.halfspace.theorem.response` with the fewest kernels; `in_plane` for infinite cells."""
    forms = tuple(tuple(form.replaced(reduced) for form in row) for row in response(quantity, nu, space))
    return tuple(tuple(form.replaced(reduced_in_plane) for form in row) for row in forms) if in_plane else forms


def response_of(cell: HasCornerPotentials, quantity: str, nu: float, space: str) -> Forms:
    """Reduced response of a cell."""
    return reduced_response(quantity, nu, space, in_plane=isinstance(cell, EndlessCell))


def cell_kernels(forms: Forms) -> list[Kernel]:
    """Kernels needed for forms, without the indicator of the source."""
    return sorted({kernel for row in forms for form in row for _, kernel, _ in form if kernel != INSIDE})


def kernel_groups(kernels: Iterable[Kernel], table_bytes: int) -> Iterator[list[Kernel]]:
    """Kernels of one potential that are sampled together, within the memory for their tables."""
    most = max(1, _GROUP_BYTES // table_bytes)
    by_potential: dict[tuple[str, str], list[Kernel]] = {}
    for kernel in kernels:
        by_potential.setdefault(kernel[:2], []).append(kernel)
    for group in by_potential.values():
        count = -(-len(group) // most)
        size = -(-len(group) // count)
        for first in range(0, len(group), size):
            yield group[first : first + size]


def parity_of(kernel: Kernel) -> tuple[int, int, int]:
    """Parity along (z, y, x)."""
    x, y, z = (-1 if n % 2 else 1 for n in kernel[2])
    return z, y, x


def symmetry(quantity: str, component: int) -> tuple[int, int]:
    """Parity along (y, x) of a component: displacement x, y, z or Mandel tensor xx, yy, zz, yz, xz, xy."""
    if QUANTITIES[quantity] == 3:
        return ((1, -1), (-1, 1), (1, 1))[component]
    return ((1, 1), (1, 1), (1, 1), (-1, 1), (1, -1), (-1, -1))[component]


def sample_tables(
    cell: HasCornerPotentials,
    group: Sequence[Kernel],
    nodes: tuple[NDArray[Any], NDArray[Any], NDArray[Any]],
    *,
    threads: int,
    extended: bool = False,
    singular: bool = False,
) -> FloatArray:
    """Tables of kernels of one potential between neighbouring nodes.

    Parameters
    ----------
    cell : HasCornerPotentials
        Shape with the corner function.
    group : sequence of Kernel
        Kernels of one potential.
    nodes : three arrays
        Offsets of field point from corner along x, y, z, with one pitch between neighbours, in a unit of the order of
        the cell; one more than the tables have along each axis. Along z several such rows may follow each other; values
        between two rows are meaningless.
    threads : int
        Slabs are sampled in parallel.
    extended : bool
        Evaluate corner functions in `numpy.longdouble`, about three times slower: sums over the corners lose accuracy
        with the third power of the distance in cells.
    singular : bool
        Whether kernels are infinite on edges of cells, as those of stress and strain: nodes on an edge then have the
        mean of four points around it. The singularity is a logarithm. It remains at edges shared by four cells if the
        eigenstrain is not linear there, and it has no physical meaning.

    Returns
    -------
    (len(group), nx, ny, nz)
        Values at the offsets between the nodes.
    """
    x, y, z = (np.asarray(axis, np.longdouble if extended else np.float64) for axis in nodes)
    name, orders = group[0][1], [kernel[2] for kernel in group]
    out = np.empty((len(group), x.size - 1, y.size - 1, z.size - 1))
    planes = max(1, _CHUNK_NODES // (y.size * z.size))
    around = _AROUND * min(float(axis[1] - axis[0]) for axis in (x, y, z))

    def slab(first: int, stop: int) -> None:
        """Tables between the nodes `first` and `stop` along x, a few planes at a time, which fit into the cache."""
        last = np.empty((len(group), 0, y.size - 1, z.size - 1), x.dtype)
        for begin in range(first, stop + 1, planes):
            end = min(begin + planes, stop + 1)
            planes_of_nodes = x[begin:end], y, z
            values = cell.corner(name, orders, *_open(planes_of_nodes))
            if singular:
                _around_edges(values, partial(cell.corner, name, orders), planes_of_nodes, around)
            values = values[..., 1:] - values[..., :-1]
            values = values[:, :, 1:] - values[:, :, :-1]
            np.subtract(values[:, 1:], values[:, :-1], out=out[:, begin : end - 1], casting="same_kind")
            if last.shape[1]:
                np.subtract(values[:, 0], last[:, 0], out=out[:, begin - 1], casting="same_kind")
            last = values[:, -1:]

    bounds = np.linspace(0, x.size - 1, min(threads, x.size - 1) + 1).astype(int)
    in_parallel(threads, [partial(slab, *pair) for pair in pairwise(bounds.tolist())])
    return out


def _open(axes: Sequence[NDArray[Any]]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    x, y, z = axes
    return x[:, None, None], y[:, None], z


def _around_edges(
    values: NDArray[Any],
    corner: Callable[..., NDArray[Any]],
    axes: tuple[NDArray[Any], NDArray[Any], NDArray[Any]],
    distance: float,
) -> None:
    """Replace values at nodes on an edge (two zero coordinates) by the mean of four points around it."""
    zeros = [np.flatnonzero(axis == 0.0) for axis in axes]
    for first, second in ((0, 1), (0, 2), (1, 2)):
        if not (zeros[first].size and zeros[second].size):
            continue
        line, place = list(axes), list[Any]([slice(None)] * 3)
        for axis in (first, second):
            line[axis] = np.zeros_like(axes[axis][:1])
            place[axis] = zeros[axis] if axis == 2 else slice(zeros[axis][0], zeros[axis][0] + 1)
        mean = np.zeros(1)
        for moved in (first, second):
            for offset in (-distance, distance):
                neighbour = list(line)
                neighbour[moved] = line[moved] + offset
                mean = mean + 0.25 * corner(*_open(neighbour))
        values[:, place[0], place[1], place[2]] = mean


def nodes_around(offsets: FloatArray, pitch: float, unit: float) -> NDArray[np.longdouble]:
    """Nodes between and around ascending offsets in cells, in units of length; zero stays exact."""
    cells = np.append(offsets - 0.5, offsets[-1] + 0.5)
    cells[np.abs(cells) < ON_FACE] = 0.0
    return cells * np.longdouble(pitch / unit)


def seen_from_inside(nodes: NDArray[np.longdouble]) -> NDArray[np.longdouble]:
    """Nodes along z with zero replaced by the smallest depth."""
    return np.where(nodes == 0.0, np.longdouble(_BELOW_SURFACE), nodes)


def far_apart(source: Cells, low: Sequence[float], high: Sequence[float]) -> bool:
    """Whether all cells are so far from the box of points (x, y, z) that sums over corners lose accuracy.

    If some cell is near some point, its field is so large that the loss in the other terms does not matter.
    """
    gaps = []
    for axis in range(3):
        centres = source.centres(axis)
        gaps.append(max(low[axis] - centres[-1], centres[0] - high[axis]) / source.pitch[axis])
    return float(max(gaps)) > _FAR
