"""Inhomogeneities of one body in cells, each with its own eigenstrain."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.convolution import Layout
from eigencontact.core.array_types import FloatArray
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.block import Cost
from eigencontact.execution.blocks.contact import Fields
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.blocks.precision import INNER, settled, volume_round_off
from eigencontact.execution.blocks.sampling import sampling_seconds, spectra_cost
from eigencontact.execution.interiors.interior import Records, loads
from eigencontact.execution.interiors.material_cells import MaterialCells
from eigencontact.execution.interiors.responding import Responding
from eigencontact.execution.routes.route import Pace
from eigencontact.execution.routes.subsurface import Subsurface
from eigencontact.model.boxes import CellBox
from eigencontact.model.kernels import KernelUse
from eigencontact.model.matrix_law import matrix_law
from eigencontact.model.sources import Lattice
from eigencontact.model.whole_degrees import functions_up_to
from eigencontact.plugin import ConstitutiveLaw, HasCellAnswer, LinearLaw

if TYPE_CHECKING:
    from eigencontact.core.grid import Grid
    from eigencontact.execution.interiors.beside_cells import BesideCells
    from eigencontact.solvers.cells import Cells as LatticeOfCells
    from eigencontact.solvers.flowing_part import Window
    from eigencontact.solvers.mean_stress import MeanVolumeField

__all__ = ["Cells"]


#: Allowed worn depth, in cell heights, above a fixed box that begins below the surface.
_BURIED = 0.5
#: Typical Krylov iterations per solve, and typical rounds between the solve and the contact, for the cost.
_ITERATIONS, _ROUNDS = 15, 8
#: Applications of the operator per step, without and with a contact.
_WITHOUT_CONTACT, _WITH_CONTACT = _ITERATIONS, (_ITERATIONS + 4) * (1.0 + 0.3 * (_ROUNDS - 1))
#: Factor on the applications if some cells are empty: a void near the surface takes 340 under its contact.
_EMPTY = 5.0
#: Seconds per component of the stress, function of a whole inclusion, and point.
_FUNCTION = 3e-7
#: Time of mean kernels relative to kernels at points. Seconds per step and cell of a law without a `cell_answer`: 30
#: sweeps of 4 us (11760 damaged cells under a contact).
_MEANS, _ANSWER = 6.0, 1.2e-4


class Cells(Responding):
    """Equivalent eigenstrain of the cells of one box.

    Parameters
    ----------
    subsurface : Subsurface
        Subsurface with inhomogeneities in cells.
    directions : str
        Directions of the surface displacement, out of ``"xyz"``.

    Attributes
    ----------
    beside : BesideCells or None
        Interaction with the whole inhomogeneities of the same body.
    """

    def __init__(self, subsurface: Subsurface, directions: str) -> None:
        self._box = subsurface.box
        self.beside: BesideCells | None = None
        super().__init__(subsurface, directions, self._box.centres(subsurface.half_space.grid))
        self._settle_precision()
        self._kernels, count = subsurface.kernels, len(self.sources)
        self.reason = f"equivalent eigenstrain of {count} inhomogeneit{'ies' if count != 1 else 'y'}"
        if subsurface.recedes:
            self.reason += ", which rise as the surface recedes"
        self._declare()

    def _settle_precision(self) -> None:
        lattice, pitch = self._box.lattice, (self._grid.dx, self._grid.dy)
        half_space, share = self._half_space, (INNER if self._tractions else 1.0)
        self._numerics, precisions = settled(
            self._numerics, f"mean stress in cells of body {self.body}",
            lambda: volume_round_off(half_space, "stress", pitch, lattice), share=share,
        )  # fmt: skip
        self._half_space = replace(half_space, numerics=self._numerics)
        self.precisions = (*precisions, *(self._surface.precisions if self._surface is not None else ()))

    @property
    def _applications(self) -> float:
        """Typical applications of the operator in one step."""
        usual = _WITH_CONTACT if self._kernels else _WITHOUT_CONTACT
        return usual * (_EMPTY if any(source.is_empty for source in self.sources) else 1.0)

    def _seconds_of_laws(self) -> float:
        """Predicted time per step of laws whose cells are solved by Newton's method with `update`."""
        slow = [source for source in self.sources if not isinstance(source.law, (LinearLaw, HasCellAnswer))]
        return _ANSWER * sum(source.lattice.cells for source in slow if source.lattice is not None)

    def _declare(self) -> None:
        """Set cost and kernels."""
        (nz, ny, nx), (_, row, column) = self._box.lattice.shape, self._box.lattice.first
        key = str(getattr(self._half_space.cell, "key", "cell"))
        label = f"eigenstrain of {self._box.names}"
        uses = [KernelUse("mean stress (6 components)", label, key, self._box.words, 58)]
        # The solver stores two vectors of six components per iteration.
        cost = self._operator_cost(self._box.lattice) + Cost(
            memory=8.0 * 12 * self._box.lattice.cells * _ITERATIONS, seconds_per_step=self._seconds_of_laws()
        )
        layout = Layout(self._grid.shape, (ny, nx), (row, column))
        for item, influence in zip(self._tractions, self._subsurface.influences, strict=True):
            seconds = 8.0 * sampling_seconds(influence, self._half_space.material)
            cost += spectra_cost(layout, nz, seconds, self._numerics)
            uses.append(
                KernelUse("mean stress (6 components)", f"traction {item.name}", influence.key, self._box.words, nz)
            )
            uses.append(KernelUse(f"mean displacement {item.direction}", label, influence.key, "surface", nz))
        if self._surface is not None:
            cost += self._surface.cost
            words = f"displacement {', '.join(self._centres)}"
            uses.append(KernelUse(words, label, key, f"surface, {self._surface.words}"))
        if self._subsurface.wholes is not None:
            cost += self._beside_wholes(self._subsurface.wholes)
        self.kernels = tuple(uses)
        self.cost = cost if self._prescribed is None else cost + self._prescribed.cost

    def _operator_cost(self, lattice: Lattice) -> Cost:
        """Cost of the mean stress in the cells of a lattice by their eigenstrain."""
        nz, *across = lattice.shape
        volume = Pace.of(self._half_space, "stress").volume(lattice, (across[0], across[1]), (0.0, 0.0), nz)
        return Cost(
            memory=volume.memory,
            seconds_once=_MEANS * volume.seconds_once,  # their Gauss points share nodes
            seconds_per_step=volume.seconds_per_step * self._applications,
        )

    def _beside_wholes(self, wholes: Subsurface) -> Cost:
        """Cost of the tables of stress in the cells by each function of whole inhomogeneities."""
        degrees = [source.degree.degree for source in wholes.inhomogeneities if source.degree is not None]
        values = sum(6 * functions_up_to(degree) * self._box.lattice.cells for degree in degrees)
        seconds = _FUNCTION * values
        return Cost(
            memory=8.0 * 1.5 * values, seconds_once=seconds, seconds_per_step=1e-9 * self._applications * values
        )

    @property
    def box(self) -> CellBox:
        """Box of the cells."""
        return self._box

    @property
    def grid(self) -> Grid:
        """Grid with the columns of the cells."""
        return self._grid

    @property
    def operator(self) -> MeanVolumeField:
        """Mean stress in the cells by their eigenstrain."""
        return self._operator

    def start(self) -> None:
        """See `Interior.start`."""
        from eigencontact.solvers.mean_surface import MeanStressKernel, SurfaceAndCells

        precision, threads = self._numerics.precision, self._numerics.threads
        often = self._applications * self._half_space.steps
        cells, grid = self._box.cells(self._grid), self._grid
        self._operator = self._field_in(cells)
        self._places = self._box.centres(grid).flat_points()
        self._content = MaterialCells(self._box, self.sources, grid, matrix_law(self._half_space.material))
        self._worn_depth = np.zeros(grid.shape)
        self._fill()
        self._joint = None
        if self._kernels:
            kernels = [MeanStressKernel(kernel, cells.pitch[2]) for kernel in self._kernels]
            directions = "".join(item.direction for item in self._tractions)
            self._joint = SurfaceAndCells(
                grid, kernels, directions, cells, precision=precision, threads=threads, applications=often
            )

    def _field_in(self, cells: LatticeOfCells) -> MeanVolumeField:
        """Mean stress in some cells by their eigenstrain."""
        from eigencontact.solvers.mean_stress import MeanVolumeField

        often = self._applications * self._half_space.steps
        return MeanVolumeField(
            self._half_space.cell, cells, cells, precision=self._numerics.precision, applications=often,
            **self._half_space.options("stress"),
        )  # fmt: skip

    def _fill(self) -> None:
        """Build the equations of the present content of the cells; the operators do not change."""
        from eigencontact.solvers.equivalent_inclusions import InhomogeneousCells

        linear = self._content.linear
        self._system = InhomogeneousCells(
            self._operator,
            self._half_space.material,
            [_of_box(law, self._places) for law in linear.laws],
            linear.index,
            fraction=linear.fraction,
            beside=linear.beside,
            normal=linear.normal,
        )

    def begin(self, increment: Increment, last: Records) -> None:
        """See `Interior.begin`; inclusions move up by the worn depth of the surface above them."""
        worn_depth = increment.surface.worn_depths.get(self.body, self._worn_depth)
        if not np.array_equal(worn_depth, self._worn_depth):
            self._refuse_buried(float(worn_depth.max()))
            self._worn_depth = worn_depth
            if not self._box.lattice.first[0]:
                self._content.rise(worn_depth)
                self._fill()
        super().begin(increment, last)

    def _refuse_buried(self, worn_depth: float) -> None:
        """Refuse wear that would raise the content of a box above its cells."""
        layers, height = self._box.lattice.first[0], self._box.lattice.edges[0]
        if layers and worn_depth > _BURIED * height:
            raise SceneError(
                f"worn depth of body {self.body} must stay below {_BURIED:g} of the cell height of {height:.3g} m if "
                f"all inclusions are below the surface (got {worn_depth:.3g} m above {self._box.names}, with {layers} "
                "layers of cells above); set a larger numerics.inclusion-pitch, or add an inclusion at the surface "
                "with the constants of the body"
            )

    def prestrain(self, time: float) -> FloatArray:
        """See `Responding.prestrain`."""
        return self._content.prestrain(time)

    def applied(self, tractions: Fields) -> FloatArray:
        """See `Responding.applied`."""
        nz, ny, nx = self._content.shape
        return self.applied_in((slice(0, nz), slice(0, ny), slice(0, nx)), tractions)

    def applied_in(self, window: Window, tractions: Fields) -> FloatArray:
        """`applied` in a part of the box."""
        layers, *columns = window
        if self._joint is not None and tractions and any(field.any() for field in tractions.values()):
            # The values at centres need the means of both neighbours.
            wide = slice(max(layers.start - 1, 0), min(layers.stop + 1, self._content.shape[0]))
            contact_stress = self._joint.stress(loads(self.body, self._tractions, tractions), wide)
            inside = slice(layers.start - wide.start, layers.stop - wide.start)
            total = np.ascontiguousarray(self.at_centres(contact_stress, wide)[:, inside, *columns])
        else:
            total = np.zeros((6, *(span.stop - span.start for span in window)))
        if self._prescribed is not None:
            total += self._prescribed.at(self._time)[:, *window]
        if self._bulk is not None:
            total += self._bulk.reshape(6, 1, 1, 1)
        if self.beside is not None:
            total += self.beside.stress()[:, *window]
        return total

    def at_centres(self, means: FloatArray, layers: slice | None = None) -> FloatArray:  # noqa: ARG002
        """Values at the cell centres from means ``(..., nz, ny, nx)``; cells of linear laws keep the means.

        The means are those of all layers, or of `layers`.
        """
        return means

    def solve(self, applied: FloatArray, prestrain: FloatArray, tolerance: float) -> Any:
        """See `Responding.solve`."""
        return self._system.solve(
            applied, prestrain, start=self.eigenstrain, tolerance=tolerance,
            max_iterations=self._numerics.max_iterations, progress=self.progress,
        )  # fmt: skip

    def mean_displacement(self, eigenstrain: FloatArray) -> FloatArray:
        """See `Responding.mean_displacement`."""
        assert self._joint is not None
        return self._joint.displacement(self.at_centres(eigenstrain))


class _OfCells:
    """Law whose constants depend on the place, in the cells of a box."""

    def __init__(self, law: ConstitutiveLaw, places: tuple[FloatArray, FloatArray, FloatArray]) -> None:
        self._law, self._places = law, places

    def of_cells(self, index: NDArray[np.intp]) -> Any:
        """See `ElasticityOfCells`."""
        x, y, z = (axis[index] for axis in self._places)
        return self._law.at(x, y, z)


def _of_box(law: ConstitutiveLaw, places: tuple[FloatArray, FloatArray, FloatArray]) -> Any:
    """Elastic constants of a law in a box, by the centres of its cells."""
    return _OfCells(law, places) if law.varies else law
