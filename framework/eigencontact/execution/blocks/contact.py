"""Interface of a contact for the bodies below it: tractions from a load and a displacement of the surface."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from eigencontact.core.array_types import FloatArray
from eigencontact.core.numbers import Number
from eigencontact.execution.blocks.block import PlanItem
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


#: Residual of contacts with joint displacements, and of contacts over interiors.
COUPLING_RESIDUAL = Number(
    name="coupling_residual", unit="1",
    meaning="last relative change of the displacement in the coupled iteration", role="certificate",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactAnswer:
    """Solution of an increment.

    Attributes
    ----------
    tractions : mapping of str to (ny, nx)
        By surface field: ``pressure`` and, with friction, ``shear_x``, ``shear_y`` [Pa].
    displacement : mapping of str to (ny, nx)
        Surface displacement by the tractions, by direction [m]: sum of both bodies along z, body 1 minus body 2 along
        the surface.
    memory : object
        State for the next increment.
    solution : object
        Solution in the form of the contact; only the contact reads it.
    counts : mapping of str to float
        Iterations and convolutions used.
    """

    tractions: Fields
    displacement: Fields
    memory: Any
    solution: Any
    counts: Mapping[str, float]


class Contact(PlanItem):
    """Two bodies in contact.

    Attributes
    ----------
    directions : str
        Directions, out of ``"xyz"``, in which displacements by other causes than the tractions affect the contact.
    fields : frozenset of str
        Surface fields that the contact computes.
    requires : frozenset of str
        Quantities that the contact requires.
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

        `offset` is the surface displacement by other causes than the tractions at that time, by direction. `bulk` is
        the bulk stress of the bodies [Pa], by name.
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
            Prescribed values.
        memory : object
            State of the contact at the start of the increment.
        offset : mapping of str to (ny, nx)
            Surface displacement by other causes than the tractions, by direction [m].
        softer : float
            Factor θ of a softer body: the compliance is ``(1 + θ) S`` in place of S. The solver keeps S and instead
            scales loads and shear bound, because ``(1 + θ) S t`` is S applied to ``(1 + θ) t``.
        tolerance : float, optional
            Replaces the tolerance of the numerics.
        start : ContactAnswer, optional
            Solution of a similar increment.

        Raises
        ------
        NotConverged, SceneError
            The solve failed; a partial result is never returned.
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
            Prescribed values along the normal.
        separation : (ny, nx)
            Gap with all displacements except those by tractions [m].
        fields : mapping of str to (ny, nx)
            Fields of a similar step: its shear is kept.
        springs : (ny, nx), optional
            Compliance in addition to that of the bodies [m/Pa].
        start : (ny, nx), optional
            Pressure of a similar state [Pa].
        """

    @property
    @abstractmethod
    def softness(self) -> float:
        """Displacement of the centre of a cell by a unit pressure on it [m/Pa]."""

    @abstractmethod
    def results(self, answers: Sequence[ContactAnswer]) -> tuple[dict[str, FloatArray], dict[str, float]]:
        """Fields and scalars of a load step that was solved in one increment or more."""


def normal_options(numerics: Numerics) -> NormalOptions:
    """Options of the normal solver from the numerics; the window edge is checked when a step is accepted."""
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
