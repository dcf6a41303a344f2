"""Interface of a contact for the bodies below it: tractions from a load and a displacement of the surface."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from eigencontact.core.array_types import FloatArray
from eigencontact.core.numbers import Number
from eigencontact.execution.blocks.block import Part
from eigencontact.execution.blocks.increment import Increment
from eigencontact.results.records import StepRecord
from eigencontact.scene.schema import Numerics
from eigencontact.solvers.control import Control
from eigencontact.solvers.solution import NormalOptions
from eigencontact.solvers.tangential.control import TangentialControl

__all__ = ["COUPLING_RESIDUAL", "Contact", "ContactAnswer", "Fields", "normal_options", "scaled_forces"]

Fields = Mapping[str, FloatArray]
_Control = TypeVar("_Control", Control, TangentialControl)

_FORCES = ("normal_load", "moment_x", "moment_y", "tangential_load_x", "tangential_load_y", "torsion_moment")


#: Of contacts whose displacements are joined, and of contacts over interiors.
COUPLING_RESIDUAL = Number(
    name="coupling_residual", unit="1",
    meaning="last relative change of the displacement in the coupled iteration", role="certificate",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactAnswer:
    """A solved increment.

    Attributes
    ----------
    tractions : mapping of str to (ny, nx)
        By surface field: ``pressure`` and, with friction, ``shear_x``, ``shear_y`` [Pa].
    displacement : mapping of str to (ny, nx)
        What they displace, by direction [m]: along z both bodies summed, along the surface body 1 less body 2.
    memory : object
        What the next increment needs of this one.
    solution : object
        For the contact itself.
    spent : mapping of str to float
        Iterations and convolutions.
    """

    tractions: Fields
    displacement: Fields
    memory: Any
    solution: Any
    spent: Mapping[str, float]


class Contact(Part):
    """Two bodies in contact.

    Attributes
    ----------
    directions : str
        Of ``"xyz"``: along which a displacement of the surfaces by anything but the tractions matters.
    fields : frozenset of str
        Surface fields that it gives.
    requires : frozenset of str
        Quantities that it needs.
    accumulated : frozenset of str
        See `Block`.
    """

    directions: str = "z"
    fields: frozenset[str] = frozenset()
    requires: frozenset[str] = frozenset({"separation"})
    accumulated: frozenset[str] = frozenset()

    def start(self) -> None:
        """Build the solver."""

    @abstractmethod
    def recall(self, last: StepRecord | None, offset: Fields, bulk: Mapping[str, float]) -> Any:
        """State of the contact after the last accepted step, from its stored record; before the first step at rest.

        `offset` holds what displaced the surfaces besides the tractions at that time, by direction, and `bulk` the
        bulk stress of the bodies [Pa], by name.
        """

    @abstractmethod
    def solve(
        self,
        increment: Increment,
        memory: Any,
        offset: Fields,
        *,
        softer: float = 0.0,
        tolerance: float | None = None,
        start: ContactAnswer | None = None,
    ) -> ContactAnswer:
        """Solve one increment.

        Parameters
        ----------
        increment : Increment
            What is prescribed.
        memory : object
            Of the state at its start.
        offset : mapping of str to (ny, nx)
            Displacement of the surfaces by anything but the tractions, by direction [m].
        softer : float
            The bodies are softer by this part: ``(1 + θ) S`` in place of the compliance S. Since that of tractions t
            is S of ``(1 + θ) t``, loads and the bound of the shear are scaled, and the solver stays what it is.
        tolerance : float, optional
            Instead of that of the numerics.
        start : ContactAnswer, optional
            An answer near by.

        Raises
        ------
        NotConverged, SceneError
            No half result is returned.
        """

    @abstractmethod
    def pressed(
        self,
        control: Control,
        separation: FloatArray,
        fields: Fields,
        springs: FloatArray | None,
        start: FloatArray | None,
    ) -> FloatArray:
        """Pressure ``(ny, nx)`` [Pa] under displaced surfaces, with all other state unchanged.

        Parameters
        ----------
        control : Control
            What is prescribed along the normal.
        separation : (ny, nx)
            With all that moves the surfaces but tractions [m].
        fields : mapping of str to (ny, nx)
            Of a step near by: its shear stays.
        springs : (ny, nx), optional
            Compliance on top of that of the bodies [m/Pa].
        start : (ny, nx), optional
            A pressure near by [Pa].
        """

    @property
    @abstractmethod
    def softness(self) -> float:
        """Displacement of the centre of a cell by a unit pressure on it [m/Pa]."""

    @abstractmethod
    def results(self, answers: Sequence[ContactAnswer]) -> tuple[dict[str, FloatArray], dict[str, float]]:
        """Fields and scalars of a load step that was solved in one increment or more."""


def normal_options(numerics: Numerics) -> NormalOptions:
    """Options of the normal solver from the numerics of a scene; the edge is looked at when a step is accepted."""
    return NormalOptions(
        tolerance=numerics.tolerance,
        max_iterations=numerics.max_iterations,
        precision=numerics.precision,
        threads=numerics.threads,
        periodic=numerics.boundary == "periodic",
        allow_contact_at_edge=True,
    )


def scaled_forces(control: _Control, factor: float) -> _Control:
    """Control with scaled forces and moments; prescribed displacements do not change."""
    forces = {name: getattr(control, name, None) for name in _FORCES}
    return replace(control, **{name: factor * value for name, value in forces.items() if value is not None})
