"""Plan of a run: the model of a scene, its blocks in order of execution, and omitted effects."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from eigencontact.core.cautions import Caution, LeftOut
from eigencontact.core.grid import Grid
from eigencontact.core.numbers import Number, by_name
from eigencontact.execution.blocks.block import Block, Cost, PlanItem
from eigencontact.execution.blocks.conclusion import Conclusion
from eigencontact.execution.blocks.precision import Precision
from eigencontact.model.kernels import KernelUse
from eigencontact.model.model import Model
from eigencontact.scene.schema import Numerics, Scene
from eigencontact.solvers.contact_growth import ContactGrowth

__all__ = ["Plan"]


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Everything decided before anything is computed.

    Attributes
    ----------
    model : Model
        Physical model of the scene.
    blocks : list of Block
        In order of execution.
    conclusions : sequence of Conclusion
        What follows from all steps, after the last.
    left_out : sequence of LeftOut
        Effects that are not modelled, and why.
    cautions : sequence of Caution
        Warnings about limited accuracy that are known before the numbers are computed.
    seconds_planned : float
        Wall time that the decisions took [s].
    """

    model: Model
    blocks: Sequence[Block]
    left_out: Sequence[LeftOut]
    conclusions: Sequence[Conclusion] = ()
    cautions: Sequence[Caution] = ()
    seconds_planned: float = 0.0

    @property
    def scene(self) -> Scene:
        """Scene of the plan."""
        return self.model.scene

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self.scene.label

    @property
    def numerics(self) -> Numerics:
        """Fidelity and effort."""
        return self.scene.numerics

    @property
    def grid(self) -> Grid:
        """Grid of the window."""
        return self.model.grid

    @property
    def steps(self) -> int:
        """Number of increments that will be solved; a guess where cycles are skipped."""
        return self.model.steps

    @property
    def growth(self) -> ContactGrowth | None:
        """Growth of the contact radius; None if no load step is even in the radius."""
        return self.model.window.growth

    @property
    def parts(self) -> list[PlanItem]:
        """Parts of all blocks, in order, and conclusions."""
        return [*(item for block in self.blocks for item in block.parts), *self.conclusions]

    @property
    def kernels(self) -> list[KernelUse]:
        """All influence coefficients of the run."""
        return [kernel for block in self.blocks for kernel in block.kernels]

    @property
    def numbers(self) -> dict[str, Number]:
        """All scalars of a step or the run, by name, in order of execution."""
        parts = (*self.blocks, *self.conclusions)
        return by_name(self._declared(number for item in parts for number in item.numbers))

    @property
    def observed(self) -> dict[str, Number]:
        """Numbers of the observers, by name."""
        return by_name(self._declared(number for observer in self.model.observers for number in observer.numbers))

    def _declared(self, numbers: Iterable[Number]) -> Iterable[Number]:
        """Numbers, per length in a line contact."""
        return (number.per_length() for number in numbers) if self.grid.line else numbers

    @property
    def precisions(self) -> list[Precision]:
        """Precision of each operator if the scene leaves the choice to the plan; equal ones once."""
        return list(dict.fromkeys(precision for item in self.parts for precision in item.precisions))

    @property
    def cost(self) -> Cost:
        """Predicted memory [bytes] beyond the libraries, and time."""
        return sum((item.cost for item in (*self.blocks, *self.conclusions)), Cost())

    @property
    def seconds(self) -> float:
        """Predicted wall time of all steps [s]."""
        return self.cost.seconds_once + self.steps * self.cost.seconds_per_step

    def explain(self) -> str:
        """Return the plan in words."""
        from eigencontact.planning.explain import explain

        return explain(self)

    def _repr_html_(self) -> str:
        from eigencontact.core.html_table import html_table
        from eigencontact.core.units import readable, time_in_words

        grid = self.grid
        rows = [
            ("cells", f"{grid.nx} x {grid.ny} of {' x '.join(readable(edge, 'm') for edge in grid.edges)}"),
            ("load steps", str(self.steps)),
            ("blocks", ", ".join(block.name for block in self.blocks)),
            ("kernels", str(sum(kernel.count for kernel in self.kernels))),
            ("memory, predicted", readable(float(self.cost.peak), "B")),
            ("time, predicted", time_in_words(self.seconds)),
            *(("left out", f"{effect.effect}: {effect.reason}") for effect in self.left_out),
        ]
        return html_table(self.scene.title or self.name, rows)

    def to_dict(self) -> dict[str, object]:
        """Return the plan as plain data for JSON."""
        from eigencontact.planning.explain import as_data

        return as_data(self)
