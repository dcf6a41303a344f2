"""Interface of an interior for the contact above it and for regions."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.tractions import Traction, side
from eigencontact.execution.blocks.block import PlanItem
from eigencontact.execution.blocks.contact import Fields
from eigencontact.execution.blocks.increment import Increment
from eigencontact.plugin import ConstitutiveLaw
from eigencontact.results.records import HistoryRecord

__all__ = ["Interior", "Outgrown", "by_direction", "eigenstrain_name", "loads"]

Records = Mapping[str, HistoryRecord]


class Outgrown(Exception):
    """Error: an interior needs more cells.

    Attributes
    ----------
    interior, larger : Interior
        The interior with too few cells, and a larger one that replaces it, not yet started.
    """

    def __init__(self, interior: Interior, larger: Interior) -> None:
        super().__init__(f"interior of body {interior.body} has too few cells")
        self.interior, self.larger = interior, larger


class Interior(PlanItem):
    """Eigenstrain below the surface of one body.

    Attributes
    ----------
    body : int
        1 or 2.
    responds : bool
        Whether the eigenstrain depends on the tractions.
    state_names : frozenset of str
        Names of the stored state variables: the keys of `state_records`.
    is_beside : bool
        Whether the eigenstrain depends on another interior of the same body.
    estimates_degree : bool
        Whether `normal_displacement_by_less` returns an estimate.
    """

    body: int = 1
    responds: bool = True
    state_names: frozenset[str] = frozenset()
    estimates_degree: bool = False
    is_beside: bool = False

    def start(self) -> None:
        """Build the operators."""

    @abstractmethod
    def begin(self, increment: Increment, last: Records) -> None:
        """Set the state of the last accepted increment from its record; an empty `last` is the rest state.

        Raises
        ------
        Outgrown
            The state needs more cells than this interior has.
        """

    def adopted(self) -> Records:
        """Stored variables of an earlier run in the form of this interior, as its initial state."""
        return {}

    @property
    def unknown(self) -> FloatArray:
        """Unknown of the coupled iteration; empty if one `image` is the exact response to the tractions."""
        return np.zeros(0)

    def answer_as_a_whole(self) -> bool:
        """Restart the increment with a direct solution, without coupled iteration; False if that is not possible."""
        return False

    def take(self, unknown: FloatArray) -> None:
        """Set the unknown."""

    @abstractmethod
    def displacement(self, directions: str) -> dict[str, FloatArray]:
        """Surface displacement by the present state, by direction [m]; along the surface body 1 minus body 2."""

    def image(self, tractions: Fields, tolerance: float) -> tuple[FloatArray, float]:
        """New value of the unknown under these tractions, and the relative residual of the present value.

        An interior without an unknown solves for its eigenstrain here, to the tolerance; `displacement` then uses it.
        """
        raise NotImplementedError

    def state_records(self) -> dict[str, HistoryRecord]:
        """Variables of the present state to store, for the next increment and for regions."""
        return {}

    def flowed(self, before: Records, after: Records) -> bool:  # noqa: ARG002
        """Whether an increment has changed the internal variables of the cells."""
        return False

    def distance(self, state: Records, reference: Records) -> float:  # noqa: ARG002
        """Difference of the strains of two states under the present load, relative to the strain by this load."""
        return 0.0

    @property
    def tries_elastic(self) -> bool:
        """Whether most increments leave the unknown unchanged; the contact is then first solved to the tolerance."""
        return False

    def trouble(self) -> str:
        """Text about the cell with the largest residual, and a remedy; empty by default."""
        return ""

    def check(self) -> None:
        """Check that the interior can represent the converged state.

        Raises
        ------
        Outgrown
            The law is not elastic in the outermost cells.
        """

    def normal_displacement_by_less(self) -> tuple[float, Sequence[FloatArray]]:
        """Normal surface displacement with a polynomial degree lower by one, and by two.

        Returns
        -------
        float
            Factor from the change by the last degree to the change by all higher degrees; 0 without an estimate.
        sequence of (ny, nx)
            Displacement into the body [m] minus the present one.
        """
        return 0.0, ()

    def states(self) -> Iterator[tuple[ConstitutiveLaw, Mapping[str, FloatArray], float, FloatArray | float]]:
        """Present state by law: internal variables of its cells, volume of a cell [m^3], and fraction of each cell."""
        yield from ()

    def scalars(self) -> dict[str, float]:
        """Numbers of the work since `begin`; several interiors are summed, with the largest residual."""
        return {}


def eigenstrain_name(body: int, *, beside: bool = False) -> str:
    """Name of the stored equivalent eigenstrain of a body; `beside` for whole inhomogeneities with cells."""
    return f"whole_eigenstrain_{body}" if beside else f"equivalent_eigenstrain_{body}"


def by_direction(body: int, directions: Sequence[str], rows: FloatArray) -> dict[str, FloatArray]:
    """Displacement of one body ``(n, ny, nx)`` as its contribution to that of both bodies, by direction."""
    return {name: side(body, name) * row for name, row in zip(directions, rows, strict=True)}


def loads(body: int, tractions: Sequence[Traction], fields: Fields) -> list[FloatArray]:
    """Tractions on one body, in their order, from surface fields of both."""
    return [side(body, item.direction) * fields[item.field] for item in tractions]
