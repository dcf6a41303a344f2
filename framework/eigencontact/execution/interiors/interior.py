"""What an interior is to the contact above it, and to the regions that look at it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.tractions import Traction, side
from eigencontact.execution.blocks.block import Part
from eigencontact.execution.blocks.contact import Fields
from eigencontact.execution.blocks.increment import Increment
from eigencontact.plugin import ConstitutiveLaw
from eigencontact.results.records import HistoryRecord

__all__ = ["Interior", "Outgrown", "by_direction", "eigenstrain_name", "loads"]

Remembered = Mapping[str, HistoryRecord]


class Outgrown(Exception):
    """An interior needs more cells than it has.

    Attributes
    ----------
    interior, larger : Interior
        The one that does not suffice, and another to take its place, not yet started.
    """

    def __init__(self, interior: Interior, larger: Interior) -> None:
        super().__init__(f"interior of body {interior.body} has too few cells")
        self.interior, self.larger = interior, larger


class Interior(Part):
    """Something below the surface of one body.

    Attributes
    ----------
    body : int
        1 or 2.
    responds : bool
        Whether it answers the tractions.
    remembers : frozenset of str
        Names of what is stored of its state: those of `remembered`.
    is_beside : bool
        Whether it answers another interior of its body.
    estimates_degree : bool
        Whether `normal_displacement_by_less` tells something.
    """

    body: int = 1
    responds: bool = True
    remembers: frozenset[str] = frozenset()
    estimates_degree: bool = False
    is_beside: bool = False

    def start(self) -> None:
        """Build the operators."""

    @abstractmethod
    def begin(self, increment: Increment, last: Remembered) -> None:
        """Take up the state of the last accepted increment, as it was stored; at rest `last` is empty.

        Raises
        ------
        Outgrown
            The state fills more cells than this interior has.
        """

    def adopted(self) -> Remembered:
        """What was remembered by an earlier run, as this interior would; it begins with that."""
        return {}

    @property
    def unknown(self) -> FloatArray:
        """What is iterated on from outside; empty where an image is the whole answer to the tractions."""
        return np.zeros(0)

    def answer_as_a_whole(self) -> bool:
        """Start the increment again, and be iterated on no more in it; False where that was so, or cannot be."""
        return False

    def take(self, unknown: FloatArray) -> None:
        """Put the unknown."""

    @abstractmethod
    def displacement(self, directions: str) -> dict[str, FloatArray]:
        """Displacement of the surfaces by the present state, by direction [m]; along them body 1 less body 2."""

    def image(self, tractions: Fields, tolerance: float) -> tuple[FloatArray, float]:
        """Where these tractions would put the unknown, and the relative residual of the present one.

        Without an unknown the interior answers here, to the tolerance, and what it displaces follows.
        """
        raise NotImplementedError

    def remembered(self) -> dict[str, HistoryRecord]:
        """What must be stored of the present state, for the next increment and for other regions."""
        return {}

    def flowed(self, before: Remembered, after: Remembered) -> bool:  # noqa: ARG002
        """Whether cells remember, after an increment, other than before it."""
        return False

    def distance(self, state: Remembered, reference: Remembered) -> float:  # noqa: ARG002
        """Difference of the strains of two states under the present load, relative to the strain by that load."""
        return 0.0

    @property
    def tries_elastic(self) -> bool:
        """Whether an increment often leaves the unknown as it is: the contact is then solved to the end at once."""
        return False

    def trouble(self) -> str:
        """Words for where the last image differs most from the unknown, and what may help; none by default."""
        return ""

    def check(self) -> None:
        """Look whether the interior can stand for the state that it converged to.

        Raises
        ------
        Outgrown
            Outermost cells, which were to stay elastic, did not.
        """

    def normal_displacement_by_less(self) -> tuple[float, Sequence[FloatArray]]:
        """Normal displacement of its surface as it would be with one degree of freedom less, and with two.

        Returns
        -------
        float
            Factor from the change by the last degree to that by all higher ones; 0 where an interior tells nothing.
        sequence of (ny, nx)
            Displacement into the body [m] less the present one.
        """
        return 0.0, ()

    def states(self) -> Iterator[tuple[ConstitutiveLaw, Mapping[str, FloatArray], float, FloatArray | float]]:
        """Of the present state, by law: what its cells remember, the volume of one [m^3], and its share of each."""
        yield from ()

    def scalars(self) -> dict[str, float]:
        """Numbers of the work since `begin`; those of several interiors are summed, residuals compared."""
        return {}


def eigenstrain_name(body: int, *, beside: bool = False) -> str:
    """Name under which the equivalent eigenstrain of a body is remembered; `beside` of wholes beside its cells."""
    return f"whole_eigenstrain_{body}" if beside else f"equivalent_eigenstrain_{body}"


def by_direction(body: int, directions: Sequence[str], rows: FloatArray) -> dict[str, FloatArray]:
    """Displacement of one body ``(n, ny, nx)`` as its share in that of both, by direction."""
    return {name: side(body, name) * row for name, row in zip(directions, rows, strict=True)}


def loads(body: int, tractions: Sequence[Traction], fields: Fields) -> list[FloatArray]:
    """Tractions on one body, in their order, from surface fields of both."""
    return [side(body, item.direction) * fields[item.field] for item in tractions]
