"""Fields of an eigenstrain that is uniform in each cell of a box, on a lattice of points, by FFT in space.

The field at target k by the eigenstrain in cell k' is a sum of two kinds of kernels, times powers 0, 1, 2 of the
target's depth: kernels of the offset k - k' (the cell itself), and kernels that depend on k + k' along z (its mirror
image above the surface).

References
----------
R. D. Mindlin 1936, doi:10.1063/1.1745385; R. D. Mindlin and D. H. Cheng 1950, J. Appl. Phys. 21, 926; Y. P. Chiu 1978,
J. Appl. Mech. 45, 302; S. Liu and Q. Wang 2005, J. Appl. Mech. 72, 871 (FFT over cuboids); S. Liu, X. Jin, Z. Wang,
L. M. Keer and Q. Wang 2012, Int. J. Plasticity 35, 135 (half-space by convolution and correlation).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.convolution.volume import VolumeConvolver
from eigencontact.convolution.volume_layout import VolumeKernels, VolumeLayout
from eigencontact.convolution.weighted_sums import WeightedSums
from eigencontact.core.array_types import FloatArray
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.errors import require
from eigencontact.halfspace.forms import INSIDE, Kernel
from eigencontact.halfspace.potentials import HasCornerPotentials
from eigencontact.halfspace.theorem import QUANTITIES
from eigencontact.solvers.cells import Cells, offset_in_cells, snapped
from eigencontact.solvers.potential_tables import (
    Forms,
    cell_kernels,
    far_apart,
    kernel_groups,
    nodes_around,
    parity_of,
    response_of,
    sample_tables,
    symmetry,
    unit_of_length,
)

__all__ = ["VolumeField", "check_request", "local_matrix"]


class VolumeField:
    """Stress, strain or displacement in a box by the eigenstrain in a box of cells; the spectra are computed once.

    Parameters
    ----------
    cell : HasCornerPotentials
        Shape of the cells: the cuboid.
    source, target : Cells
        Cells with eigenstrain, and points of the same pitch, anywhere in z >= 0. Memory is four times larger if the
        points are not on the cell centres along x or y.
    poisson_ratio : float
        In (-1, 0.5].
    quantity : {"stress", "strain", "displacement"}
        Stress [Pa] and total strain as Mandel vectors, displacement (x, y, z) [m].
    space : {"half", "full"}
        With or without the free surface z = 0.
    shear_modulus : float
        [Pa]; for stress.
    precision : {"double", "single"}
        Single precision halves memory; its error grows with the square of the number of layers from the surface on:
        3.4e-6 of the largest value for 8 layers of cubes, 1.6e-5 for 16, 3.2e-4 for 64; below the surface layers
        1.5e-7.
    threads : int, optional
        Cores to use; by default all cores available to this process.
    applications : float
        Expected number of applications: see `eigencontact.convolution.VolumeConvolver`.

    Notes
    -----
    Memory: 58 complex kernels for stress in a half-space (15 in full space) on an octant of the padded box, about
    ``58 * 16 * (nx + 1) * (ny + 1) * (nz + 1)`` bytes. One application makes 6 + 17 transforms along z, and 6 + 6 along
    y and x. Stress and strain on a face between cells are the means of both sides, on an edge the mean of the cells
    around it.
    """

    def __init__(
        self,
        cell: HasCornerPotentials,
        source: Cells,
        target: Cells,
        *,
        poisson_ratio: float,
        quantity: str = "stress",
        space: str = "half",
        shear_modulus: float = 1.0,
        precision: str = "double",
        threads: int | None = None,
        applications: float = 10.0,
    ) -> None:
        check_request(source, target, quantity, space)
        flush = space == "half" and source.flush and abs(target.first[2]) <= 1e-9 * target.pitch[2]
        rule = "below the surface where cells reach it (ask for the plane z = 0 by PlaneFields)"
        require(not flush or quantity == "displacement", "volume", "first target depth", target.first[2], rule)
        self.source, self.target, self.quantity = source, target, quantity
        self.poisson_ratio, self.shear_modulus = poisson_ratio, shear_modulus
        self.layout = VolumeLayout(source.shape, target.shape, offset_in_cells(source, target))
        self._scale, self._unit = scale_of(quantity, shear_modulus, source), unit_of_length(source.pitch)
        self._threads = threads or available_threads()
        forms = response_of(cell, quantity, poisson_ratio, space)
        self._local = self._scale * local_matrix(forms)
        self._kernels = self._sampled(cell, forms, precision)
        depths = target.centres(2) / self._unit
        self._convolver = VolumeConvolver(self._sums(forms), depths, threads=threads, applications=applications)

    def _sampled(self, cell: HasCornerPotentials, forms: Forms, precision: str) -> VolumeKernels:
        layout, unit, pitch = self.layout, self._unit, self.source.pitch
        kernels = cell_kernels(forms)
        images = [origin == "image" for origin, *_ in kernels]
        store = VolumeKernels(layout, [parity_of(kernel) for kernel in kernels], images, precision=precision)
        x, y = nodes_around(layout.x.lattice, pitch[0], unit), nodes_around(layout.y.lattice, pitch[1], unit)
        real = nodes_around(layout.z.lattice, pitch[2], unit)
        lowest = snapped((self.source.first[2] + self.target.first[2]) / pitch[2])
        image = nodes_around(lowest + layout.lattice_sum, pitch[2], unit)
        numbers = {kernel: number for number, kernel in enumerate(kernels)}
        far = far_apart(self.source, self.target.first, [float(self.target.centres(axis)[-1]) for axis in range(3)])
        # If x and y are alike, half of the kernels follow from the others by exchange of x and y.
        alike = layout.folded and np.array_equal(x, y)
        twins = {k: _turned(k) for k in kernels if alike and _turned(k) in numbers and _turned(k) < k}
        sampled = [kernel for kernel in kernels if kernel not in twins]
        for group in kernel_groups(sampled, 8 * x.size * y.size * max(real.size, image.size)):
            nodes = x, y, (image if group[0][0] == "image" else real)
            tables = self._tables(cell, group, nodes, far=far)
            tasks = [
                partial(store.fill, numbers[kernel], table, self._scale)
                for kernel, table in zip(group, tables, strict=True)
            ]
            in_parallel(self._threads, tasks)
        in_parallel(self._threads, [partial(store.turn, numbers[k], numbers[twin]) for k, twin in twins.items()])
        return store

    def _tables(
        self,
        cell: HasCornerPotentials,
        group: Sequence[Kernel],
        nodes: tuple[NDArray[Any], NDArray[Any], NDArray[Any]],
        *,
        far: bool,
    ) -> FloatArray:
        singular = self.quantity != "displacement"
        return sample_tables(cell, group, nodes, threads=self._threads, extended=far, singular=singular)

    def _sums(self, forms: Forms) -> WeightedSums:
        numbers = {kernel: number for number, kernel in enumerate(cell_kernels(forms))}
        table: dict[tuple[int, int], dict[tuple[int, int], float]] = {}
        for output, row in enumerate(forms):
            for source, form in enumerate(row):
                for power, kernel, value in form:
                    if kernel != INSIDE:
                        table.setdefault((output, power), {})[numbers[kernel], source] = value
        return WeightedSums(
            self._kernels,
            table,
            sources=[symmetry("strain", component) for component in range(6)],
            outputs=[symmetry(self.quantity, component) for component in range(QUANTITIES[self.quantity])],
        )

    @property
    def kernels(self) -> int:
        """Number of stored spectra."""
        return len(self._kernels)

    @property
    def nbytes(self) -> int:
        """Memory of spectra and buffers."""
        return self._kernels.nbytes + self._convolver.nbytes

    def apply(self, eigenstrain: ArrayLike) -> NDArray[np.floating]:
        """Field of the Mandel eigenstrain ``(6, nz, ny, nx)`` [-], ``(3 or 6, tz, ty, tx)``."""
        strain = np.asarray(eigenstrain)
        expected = (6, *self.source.shape)
        require(strain.shape == expected, "volume", "eigenstrain", strain.shape, f"of shape {expected}")
        out = self._convolver.apply(strain)
        if self._local.any():
            add_local(out, self._local, strain, self.layout.origin)
        return out


def _turned(kernel: Kernel) -> Kernel:
    """Kernel with x and y exchanged; valid because the potentials of a cell treat all axes alike."""
    origin, name, (x, y, z) = kernel
    return origin, name, (y, x, z)


def check_request(source: Cells, target: Cells, quantity: str, space: str) -> None:
    """Refuse invalid combinations of arguments."""
    require(quantity in QUANTITIES, "volume", "quantity", quantity, f"one of {', '.join(QUANTITIES)}")
    require(space in ("half", "full"), "volume", "space", space, "'half' or 'full'")
    if space == "half":
        top = source.first[2] - 0.5 * source.pitch[2]
        require(top >= -1e-9 * source.pitch[2], "volume", "source", top, "in z >= 0 [m]")
        require(target.first[2] >= -1e-9 * target.pitch[2], "volume", "target", target.first[2], "in z >= 0 [m]")


def scale_of(quantity: str, shear_modulus: float, cells: Cells) -> float:
    """Factor from the units of the kernels."""
    return {"stress": shear_modulus, "strain": 1.0, "displacement": unit_of_length(cells.pitch)}[quantity]


def local_matrix(forms: Forms) -> FloatArray:
    """Coefficients of the eigenstrain at the point itself, ``(outputs, 6)``: -C of the stress."""
    return np.array([[sum(value for _, kernel, value in form if kernel == INSIDE) for form in row] for row in forms])


def add_local(
    out: NDArray[np.floating], local: FloatArray, strain: NDArray[np.floating], origin: FloatArray | tuple[float, ...]
) -> None:
    """Add the local contribution of the eigenstrain at the points; on a face, half from either side."""
    taps = [
        _taps(points, cells, start)
        for points, cells, start in zip(out.shape[1:], strain.shape[1:], origin, strict=True)
    ]
    for z, source_z, weight_z in taps[0]:
        for y, source_y, weight_y in taps[1]:
            for x, source_x, weight_x in taps[2]:
                weight = weight_z * weight_y * weight_x
                values = np.tensordot(weight * local, strain[:, source_z, source_y, source_x], 1)
                out[:, z, y, x] += values


def _taps(points: int, cells: int, start: float) -> list[tuple[slice, slice, float]]:
    """Targets, the cells that contain them, and weights: one cell, or two with half a weight for targets on faces."""
    fraction = start - np.floor(start)
    lower = int(np.floor(start))
    if fraction == 0.5:  # noqa: SIM108
        shifts = [(lower, 0.5), (lower + 1, 0.5)]
    else:
        shifts = [(lower if fraction < 0.5 else lower + 1, 1.0)]
    taps = []
    for shift, weight in shifts:
        first, stop = max(0, -shift), min(points, cells - shift)
        if first < stop:
            taps.append((slice(first, stop), slice(first + shift, stop + shift), weight))
    return taps
