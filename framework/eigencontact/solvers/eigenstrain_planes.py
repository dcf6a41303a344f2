"""Fields of an eigenstrain in a box of cells on few planes: FFT in the plane, one kernel for each plane and layer.

The layers are summed in Fourier space. One plane therefore needs six forward transforms per layer and one inverse
transform per component. Depths are arbitrary. On the surface the displacement is the residual displacement of a
contact.

References
----------
R. D. Mindlin and D. H. Cheng 1950, J. Appl. Phys. 21, 926; Y. P. Chiu 1978, J. Appl. Mech. 45, 302; S. Liu and Q. Wang
2005, J. Appl. Mech. 72, 871.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.convolution import Convolver, Layout, Spectrum
from eigencontact.core.array_types import FloatArray
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.errors import require
from eigencontact.halfspace.forms import Kernel, reduced
from eigencontact.halfspace.potentials import HasCornerPotentials
from eigencontact.halfspace.theorem import QUANTITIES
from eigencontact.solvers.cells import Cells, snapped
from eigencontact.solvers.eigenstrain import add_local, check_request, local_matrix, scale_of
from eigencontact.solvers.potential_tables import (
    ON_FACE,
    Forms,
    cell_kernels,
    far_apart,
    kernel_groups,
    nodes_around,
    response_of,
    sample_tables,
    seen_from_inside,
    symmetry,
    unit_of_length,
)

__all__ = ["PlaneFields"]

# Number of layers sampled together; they share their corners.
_LAYERS = 8
# Nodes of several planes sampled together: for few numbers the calls dominate the time.
_TOGETHER = 100_000


class PlaneFields:
    """Stress, strain or displacement on planes z = const by the eigenstrain in a box of cells; spectra computed once.

    Parameters
    ----------
    cell : HasCornerPotentials
        Shape of the cells: the cuboid.
    source : Cells
        Cells that carry the eigenstrain.
    target : (int, int)
        Number of points along (y, x) of each plane, with the pitch of the cells.
    origin : (float, float)
        Position of target (0, 0) relative to cell (0, 0), in cells along (y, x); any real numbers.
    depths : (n_planes,) [m]
        Arbitrary depths, 0 included. Stress and strain on a face between layers are the means of both sides, on the
        surface the limits from inside.
    poisson_ratio : float
        In (-1, 0.5].
    quantity : {"stress", "strain", "displacement"}
        Stress [Pa] and total strain as Mandel vectors, displacement (x, y, z) [m].
    components : sequence of int, optional
        Requested components; by default all.
    space : {"half", "full"}
        With or without the free surface z = 0.
    shear_modulus : float
        [Pa]; for stress.
    precision, threads, applications
        See `eigencontact.convolution.Convolver`.
    """

    def __init__(
        self,
        cell: HasCornerPotentials,
        source: Cells,
        *,
        target: tuple[int, int],
        origin: tuple[float, float] = (0.0, 0.0),
        depths: ArrayLike,
        poisson_ratio: float,
        quantity: str = "stress",
        components: Sequence[int] | None = None,
        space: str = "half",
        shear_modulus: float = 1.0,
        precision: str = "double",
        threads: int | None = None,
        applications: float = 10.0,
    ) -> None:
        self.depths = np.atleast_1d(np.asarray(depths, dtype=float))
        lattice = Cells(first=(*source.first[:2], float(self.depths.min())), pitch=source.pitch, shape=(1, *target))
        check_request(source, lattice, quantity, space)
        count = QUANTITIES[quantity]
        self.components = tuple(range(count)) if components is None else tuple(components)
        rule = f"indices below {count}, each once"
        right = set(self.components) <= set(range(count)) and len(set(self.components)) == len(self.components)
        require(right, "planes", "components", self.components, rule)
        self.source, self.quantity, self.space = source, quantity, space
        self._origin = tuple(snapped(value) for value in origin)
        self._layout = Layout(source.shape[1:], target, (self._origin[0], self._origin[1]))
        self._scale, self._unit = scale_of(quantity, shear_modulus, source), unit_of_length(source.pitch)
        forms = tuple(response_of(cell, quantity, poisson_ratio, space)[k] for k in self.components)
        self._local = self._scale * local_matrix(forms)
        self._convolver = Convolver(self._layout, precision=precision, threads=threads, applications=applications)
        self._threads, self._precision = threads or available_threads(), precision
        layers = range(0, source.shape[0], _LAYERS)
        #: Spectra ``[plane][component][layer][eigenstrain component]``.
        self._spectra: list[list[list[list[Spectrum | None]]]] = [
            [[[None] * 6 for _ in range(source.shape[0])] for _ in forms] for _ in self.depths
        ]
        tasks = [
            partial(self._fill, cell, forms, planes, first, far=far)
            for first in layers
            for planes, far in self._batches(first)
        ]
        in_parallel(self._threads, tasks)

    def _batches(self, first: int) -> Iterator[tuple[list[int], bool]]:
        """Planes that are sampled together for some layers, and whether all layers are far from these planes."""
        dz, alike = self.source.pitch[2], dict[tuple[bool, bool], list[int]]()
        layers = snapped(self.source.first[2] / dz) + np.arange(first, self._stop(first), dtype=np.float64)
        for plane, depth in enumerate(snapped(float(depth) / dz) for depth in self.depths):
            alike.setdefault((depth == 0, self._far(layers * dz, depth * dz)), []).append(plane)
        size = self._layout.x.lattice.size * self._layout.y.lattice.size * (_LAYERS + 1)
        most = max(1, _TOGETHER // size)
        for (_, far), planes in alike.items():
            for begin in range(0, len(planes), most):
                yield planes[begin : begin + most], far

    def _stop(self, first: int) -> int:
        return min(first + _LAYERS, self.source.shape[0])

    def _fill(self, cell: HasCornerPotentials, forms: Forms, planes: list[int], first: int, *, far: bool) -> None:
        """Compute the spectra of some layers for some planes, which are all in the surface or all below it."""
        dx, dy, dz = self.source.pitch
        layers = snapped(self.source.first[2] / dz) + np.arange(first, self._stop(first), dtype=np.float64)
        depths = [snapped(float(self.depths[plane]) / dz) for plane in planes]
        flush = depths[0] == 0 and self.space == "half"
        if flush and self.quantity == "displacement":  # displacement is continuous: half of the kernels suffice
            forms = tuple(tuple(form.on_surface().replaced(reduced) for form in row) for row in forms)
        x, y = (
            nodes_around(lattice, pitch, self._unit)
            for lattice, pitch in ((self._layout.x.lattice, dx), (self._layout.y.lattice, dy))
        )
        # Offsets of the cells (not images) decrease with the layer number: they are sampled in reverse order.
        offsets = {
            "image": [depth + layers for depth in depths],
            "real": [(depth - layers)[::-1] for depth in depths],
        }
        kernels = cell_kernels(forms)
        shape = (len(planes), layers.size, x.size - 1, y.size - 1)
        tables = np.empty((len(kernels), *shape))
        inside = np.arange(len(planes) * (layers.size + 1) - 1) % (layers.size + 1) != layers.size
        for group in kernel_groups(kernels, 8 * x.size * y.size * (_LAYERS + 1) * len(planes)):
            origin = group[0][0]
            z = np.concatenate([nodes_around(offset, dz, self._unit) for offset in offsets[origin]])
            if flush:
                z = seen_from_inside(z)
            singular = self.quantity != "displacement"
            table = sample_tables(cell, group, (x, y, z), threads=1, extended=far, singular=singular)
            for kernel, values in zip(group, table, strict=True):
                by_plane = np.moveaxis(values[..., inside].reshape(*shape[2:], *shape[:2]), (2, 3), (0, 1))
                tables[kernels.index(kernel)] = by_plane if origin == "image" else by_plane[:, ::-1]
        weights = self._scale * np.array(
            [_weights(forms, kernels, float(self.depths[plane]) / self._unit) for plane in planes]
        )
        for row, component in enumerate(self.components):
            for strain in range(6):
                self._keep(planes, first, (row, strain), component, _combined(weights[:, row, strain], tables))

    def _keep(
        self, planes: list[int], first: int, place: tuple[int, int], component: int, tables: FloatArray | None
    ) -> None:
        """Store spectra of one component by one component of the eigenstrain, ``(planes, layers, nx, ny)``."""
        if tables is None:
            return
        (row, strain), count = place, tables.shape[1]
        parity = _parity(self.quantity, component, strain)
        spectra = self._layout.spectra(
            tables.reshape(-1, *tables.shape[2:]).transpose(0, 2, 1), parity, precision=self._precision
        )
        for number, spectrum in enumerate(spectra):
            self._spectra[planes[number // count]][row][first + number % count][strain] = spectrum

    def _far(self, layers: FloatArray, depth: float) -> bool:
        """Whether all cells of some layers are far from all points of a plane."""
        low = [self.source.first[k] + self._origin[1 - k] * self.source.pitch[k] for k in (0, 1)]
        ty, tx = self._layout.target
        high = [low[0] + (tx - 1) * self.source.pitch[0], low[1] + (ty - 1) * self.source.pitch[1]]
        cells = replace(
            self.source,
            first=(*self.source.first[:2], float(layers[0])),
            shape=(layers.size, *self.source.shape[1:]),
        )
        return far_apart(cells, [*low, depth], [*high, depth])

    @property
    def kernels(self) -> int:
        """Number of stored spectra."""
        return sum(s is not None for plane in self._spectra for row in plane for layer in row for s in layer)

    @property
    def nbytes(self) -> int:
        """Memory of spectra and buffers."""
        spectra = [s for plane in self._spectra for row in plane for layer in row for s in layer if s is not None]
        return sum(s.nbytes for s in spectra) + self._convolver.nbytes

    def apply(self, eigenstrain: ArrayLike) -> NDArray[np.floating]:
        """Field of the Mandel eigenstrain ``(6, nz, ny, nx)`` [-], ``(n_components, n_planes, ty, tx)``."""
        strain = np.asarray(eigenstrain)
        expected = (6, *self.source.shape)
        require(strain.shape == expected, "planes", "eigenstrain", strain.shape, f"of shape {expected}")
        nz = self.source.shape[0]
        planes = strain.reshape(6 * nz, *self.source.shape[1:])
        active = [number for number, plane in enumerate(planes) if plane[0, 0] or plane.any()]
        shape = (self.depths.size, len(self.components), *self._layout.target)
        if not active:
            return np.zeros((shape[1], shape[0], *shape[2:]), np.float64)
        sources = planes if len(active) == len(planes) else planes[active]
        rows = [[row[n % nz][n // nz] for n in active] for plane in self._spectra for row in plane]
        out = np.moveaxis(self._convolver.apply(sources, rows).reshape(shape), 0, 1)
        if self._local.any():
            for plane, depth in enumerate(self.depths):
                inside = self._layers_at(float(depth))
                if inside:
                    mixed = np.sum([weight * strain[:, layer] for layer, weight in inside], axis=0)
                    add_local(out[:, plane : plane + 1], self._local, mixed[:, None], (0.0, *self._origin))
        return out

    def _layers_at(self, depth: float) -> list[tuple[int, float]]:
        """Layers at a depth, with weights: two with half a weight on a face, the first layer for z = 0."""
        dz = self.source.pitch[2]
        # Same rounding as for the tables: both must find the same faces.
        place = snapped(depth / dz) - snapped(self.source.first[2] / dz)
        surface = self.space == "half" and snapped(depth / dz) == 0
        distances = np.abs(place - np.arange(self.source.shape[0]))
        face = np.abs(distances - 0.5) < ON_FACE
        weights = np.where(face, 1.0 if surface else 0.5, 1.0)
        return [(int(layer), float(weights[layer])) for layer in np.flatnonzero(face | (distances < 0.5))]


def _weights(forms: Forms, kernels: Sequence[Kernel], depth: float) -> FloatArray:
    """Coefficients at one depth, ``(outputs, 6, kernels)``."""
    numbers = {kernel: number for number, kernel in enumerate(kernels)}
    out = np.zeros((len(forms), 6, len(kernels)))
    for row, columns in enumerate(forms):
        for column, form in enumerate(columns):
            for power, kernel, value in form:
                if kernel in numbers:
                    out[row, column, numbers[kernel]] += value * depth**power
    return out


def _combined(weights: FloatArray, tables: FloatArray) -> FloatArray | None:
    """Sum of tables ``(kernels, planes, ...)`` with weights ``(planes, kernels)``; None if all weights are zero."""
    used = np.flatnonzero(weights.any(axis=0))
    if not used.size:
        return None
    factors = weights.T.reshape(*weights.T.shape, *[1] * (tables.ndim - 2))
    total = factors[used[0]] * tables[used[0]]
    for kernel in used[1:]:
        total += factors[kernel] * tables[kernel]
    return np.asarray(total)


def _parity(quantity: str, component: int, strain: int) -> tuple[int, int]:
    y, x = (a * b for a, b in zip(symmetry(quantity, component), symmetry("strain", strain), strict=True))
    return y, x
