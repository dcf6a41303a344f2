"""Base of all routes, and the half-space of their fields."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from math import ceil, log2
from typing import Any, ClassVar

import numpy as np

from eigencontact.convolution import Layout
from eigencontact.convolution.pace import Speed, speed, timed
from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.core.parallel import available_threads, working_threads
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.precision import Precision
from eigencontact.halfspace.endless import EndlessCell
from eigencontact.hooks.registry import Registry
from eigencontact.model.boxes import CellBox
from eigencontact.model.installed import CellMaker, installed_cell
from eigencontact.model.regions import RegionLattice
from eigencontact.model.sources import Lattice, Source
from eigencontact.scene.schema import Numerics

__all__ = ["CellRoute", "HalfSpace", "Pace", "Route"]


#: Seconds of interpreter time, independent of sizes, per kernel of a group of layers and per spectrum. Fitted to
#: sections of 31 and 61 depths through boxes of 8 to 21 layers; their 40 000 spectra took 10 s, the estimate by points
#: alone was 3 s.
_CALLS, _SPECTRUM = 1.5e-4, 6e-5
#: Components of each quantity.
_ROWS = {"displacement": 3, "strain": 6, "stress": 6}


@dataclass(frozen=True, kw_only=True)
class HalfSpace:
    """Homogeneous body below the surface, and the settings of its fields.

    Attributes
    ----------
    body : int
        1 or 2.
    full : bool
        Whether the body has no free surface.
    steps : int
        Number of steps in which the fields are computed.
    """

    body: int
    material: Material
    grid: Grid
    numerics: Numerics
    registry: Registry
    full: bool = False
    steps: int = 1

    @property
    def space(self) -> str:
        """Name of the space in `eigencontact.halfspace`."""
        return "full" if self.full else "half"

    @property
    def threads(self) -> int:
        """Threads for the computation."""
        return self.numerics.threads or available_threads()

    @cached_property
    def maker(self) -> CellMaker:
        """Maker of cells."""
        return installed_cell(self.registry)

    @property
    def cell(self) -> Any:
        """One cell, below the surface."""
        cell = self.maker((0.0, 0.0, 0.5), (1.0, 1.0, 1.0))
        return EndlessCell(cell) if self.grid.line else cell

    def options(self, quantity: str) -> dict[str, Any]:
        """Common arguments of operators on cells."""
        return {
            "poisson_ratio": self.material.poisson_ratio,
            "quantity": quantity,
            "space": self.space,
            "shear_modulus": self.material.shear_modulus,
            "threads": self.numerics.threads,
        }


class Route(ABC):
    """Field of the eigenstrain of some regions at the points of a lattice; linear, set up at its first use.

    Attributes
    ----------
    quantity : str
        ``"displacement"`` [m], ``"strain"`` [-] or ``"stress"`` [Pa].
    sources : tuple of Source
        The regions, all in one body.
    rows : tuple of int
        Requested components; all by default.
    note : str
        Remark on the values; may be empty.
    steps : bool
        Class attribute: whether stress and strain are discontinuous between cells, like the eigenstrain.
    """

    note: str = ""
    steps: ClassVar[bool] = False

    def __init__(
        self,
        half_space: HalfSpace,
        sources: Sequence[Source],
        quantity: str,
        lattice: RegionLattice,
        rows: tuple[int, ...] | None = None,
    ) -> None:
        self.half_space, self.sources, self.quantity, self.lattice = half_space, tuple(sources), quantity, lattice
        self.rows = tuple(range(_ROWS[quantity])) if rows is None else rows

    @property
    @abstractmethod
    def cost(self) -> Cost:
        """Cost of the set-up, and of the application in every step."""

    @property
    def precisions(self) -> Sequence[Precision]:
        """See `PlanItem`."""
        return ()

    @property
    @abstractmethod
    def words(self) -> str:
        """Description of the method."""

    @abstractmethod
    def field(self, eigenstrain: FloatArray) -> FloatArray:
        """Field of Mandel eigenstrains ``(6, ...)`` of each region or cell, ``(rows, *lattice.shape)``."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the field."""
        return (len(self.rows), *self.lattice.shape)


class CellRoute(Route):
    """A route from the eigenstrain in a box of cells."""

    def __init__(
        self,
        half_space: HalfSpace,
        box: CellBox,
        quantity: str,
        lattice: RegionLattice,
        rows: tuple[int, ...] | None = None,
    ) -> None:
        super().__init__(half_space, box.sources, quantity, lattice, rows)
        self.box = box


@dataclass(frozen=True, slots=True)
class Pace:
    """Time and memory of the kernels of one quantity.

    Attributes
    ----------
    real, image : int
        Kernels of the cells themselves, and of their mirror images.
    sampling : float
        Seconds for all of them at one node on one thread.
    fft : Speed
        Speed of convolutions in the plane.
    workers : float
        Effective number of threads.
    """

    real: int
    image: int
    sampling: float
    fft: Speed
    workers: float
    bytes_of_a_number: int

    @staticmethod
    def of(half_space: HalfSpace, quantity: str) -> Pace:
        """Count the kernels of a quantity and time them on a small lattice."""
        numerics = half_space.numerics
        real, image, sampling = _kernels(half_space.cell, quantity, half_space.material.poisson_ratio, half_space.space)
        return Pace(
            real=real,
            image=image,
            sampling=sampling,
            fft=speed(numerics.precision, numerics.threads),
            workers=working_threads(half_space.threads),
            bytes_of_a_number=8 if numerics.precision == "double" else 4,
        )

    def planes(
        self, cells: Lattice, target: tuple[int, int], origin: tuple[float, float], planes: int, components: int
    ) -> Cost:
        """Cost of tables and spectra for every plane and layer, and of the transforms per step."""
        layout = Layout(cells.shape[1:], target, origin)
        y, x, layers = layout.y, layout.x, cells.shape[0]
        nodes = (y.lattice.size + 1) * (x.lattice.size + 1) * 1.15 + 30
        points = y.length * x.length
        stored = x.half * (y.half if y.symmetric else y.length) * (1 if y.symmetric and x.symmetric else 2)
        spectra = planes * components * layers * 5.5
        transform = (self.fft.convolution(y.length, x.length) - self.fft.per_call) / 2
        kernels = self.real + self.image
        tables = planes * layers * nodes * (self.sampling + 0.5e-9 * components * 6 * kernels / 3)
        # Calls in sequence: for each group of layers, and for each spectrum.
        calls = planes * ceil(layers / 8) * kernels * _CALLS + spectra * _SPECTRUM
        once = (tables + spectra * stored * 6e-9) / self.workers + calls
        step = 6 * layers * transform + planes * components * transform + spectra * (points * 1.2e-9 + 4e-6)
        memory = spectra * stored * self.bytes_of_a_number + 8.0 * planes * components * target[0] * target[1] * 2
        memory += 6.0 * layers * points * self.bytes_of_a_number * 1.5
        memory += self.workers * 8.0 * nodes * 9 * kernels * 1.5
        return Cost(memory=memory, seconds_once=once, seconds_per_step=step)

    def volume(self, cells: Lattice, target: tuple[int, int], origin: tuple[float, float], planes: int) -> Cost:
        """Cost of kernel tables and spectra on the padded box, and of the transforms in space per step."""
        layout = Layout(cells.shape[1:], target, origin)
        y, x, layers = layout.y, layout.x, cells.shape[0]
        depth = layers + planes
        folded = y.symmetric and x.symmetric
        nodes = (y.lattice.size + 1) * (x.lattice.size + 1) * (depth + 1)
        octant = x.half * (y.half if folded else y.length) * (depth / 2 + 1 if folded else depth)
        kernels = self.real + 2 * self.image if folded else 2 * (self.real + self.image)
        points = y.length * x.length * depth
        once = nodes * self.sampling / self.workers
        once += kernels * octant * 1.5e-8 * log2(max(depth, 2)) / self.workers
        step = 23 * self.fft.per_point * points * log2(max(points, 2)) * 0.7 + 1e-3
        memory = kernels * octant * self.bytes_of_a_number + 8.0 * 12 * planes * target[0] * target[1]
        memory += 16.0 * x.half * 6 * max(layers * cells.shape[1], planes * target[0])
        memory += min(3e8, 8.0 * nodes * (self.real + self.image))
        return Cost(memory=memory, seconds_once=once, seconds_per_step=step)


@cache
def _timed_kernels(cell: Any, kernels: tuple[Any, ...]) -> float:
    from eigencontact.solvers.potential_tables import kernel_groups, sample_tables

    nodes = np.asarray(np.arange(17) + 0.5, dtype=float)
    groups = list(kernel_groups(list(kernels), nodes.size**3))

    def sample() -> None:
        for group in groups:
            sample_tables(cell, group, (nodes, nodes, nodes), threads=1)

    return timed(sample, 2) / nodes.size**3


def _kernels(cell: Any, quantity: str, nu: float, space: str) -> tuple[int, int, float]:
    """Kernels of the cells, of their images, and seconds for all at one node."""
    from eigencontact.solvers.potential_tables import cell_kernels, response_of

    kernels = cell_kernels(response_of(cell, quantity, nu, space))
    image = sum(whose == "image" for whose, *_ in kernels)
    return len(kernels) - image, image, _timed_kernels(cell, tuple(kernels))
