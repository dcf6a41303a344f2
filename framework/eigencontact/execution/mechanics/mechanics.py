"""Block of the mechanics of a load step: contact and interiors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.numbers import Number, accumulate, by_name
from eigencontact.core.peaks import peak_of_means
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.block import Block, Cost, PlanItem, Run
from eigencontact.execution.blocks.contact import COUPLING_RESIDUAL, Contact, ContactAnswer
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.blocks.surface import Surface
from eigencontact.execution.interiors.interior import Interior, Outgrown
from eigencontact.execution.mechanics.coupled import Coupled, Solution
from eigencontact.execution.mechanics.degree_error import PRESSURE_ERROR, pressure_error
from eigencontact.execution.mechanics.halving import Halving
from eigencontact.model.exposed import Exposed
from eigencontact.model.interface import Interface
from eigencontact.model.kernels import Solids
from eigencontact.model.law_numbers import measured, numbers_of_laws
from eigencontact.model.model import Model
from eigencontact.model.window import Window
from eigencontact.plugin import ConstitutiveLaw
from eigencontact.scene.schema import Numerics
from eigencontact.scene.steps import Step as Ramp
from eigencontact.solvers.control import Control

if TYPE_CHECKING:
    from eigencontact.execution.routes.subsurface import Subsurface

__all__ = ["Mechanics", "RunningMechanics", "mechanics_of"]


#: Scalars of contacts, of surfaces displaced by eigenstrain, of bodies with laws, and of `numerics.plastic-error`.
_OF_CONTACT = (
    Number(
        name="substeps", unit="1", role="effort", over="sum",
        meaning="number of increments of the step after halving, for convergence or a prescribed accuracy",
    ),
    Number(name="solve_seconds", unit="s", meaning="wall time of the solver", role="effort", over="sum"),
)  # fmt: skip
_OF_INTERIORS = (
    Number(
        name="max_uplift", unit="m", meaning="largest uplift of the surface by eigenstrain, out of the body",
        headline=True, label="largest uplift of the surface",
    ),
    Number(
        name="max_sink", unit="m", meaning="largest sinking of the surface by eigenstrain, into the body",
        headline=True, label="largest sink of the surface",
    ),
)  # fmt: skip
_OF_COUPLING = (
    COUPLING_RESIDUAL,
    Number(
        name="coupling_iterations", unit="1", meaning="coupled iterations of contact and inhomogeneities",
        role="effort", over="sum",
    ),
)  # fmt: skip
_OF_LAWS = (
    Number(
        name="print_depth",
        unit="m",
        headline=True,
        meaning="depth of the residual imprint in the surfaces, by a parabola through the cell means",
    ),
    Number(
        name="pile_up",
        unit="m",
        meaning="height of the wall around the residual imprint, by a parabola through the cell means",
    ),
)
_PLASTIC_ERROR = Number(
    name="plastic_error", unit="1", role="error",
    meaning="estimated error of the strain of yielding cells by halving, relative to the strain of the load",
)  # fmt: skip


class Mechanics(Block):
    """Block of a contact, of interiors, or of both.

    Each run makes its own contact and interiors; those of the plan only state kernels and costs.

    Parameters
    ----------
    interface : Interface or None
        None without a contact.
    contact_of : callable
        Function from an interface to its contact.
    subsurfaces : sequence of Subsurface
        Subsurfaces with eigenstrain; at least one without a contact.
    directions : str
        Directions of the surface displacement by the interiors, out of ``"xyz"``.
    laws : sequence of ConstitutiveLaw
        Laws with stored numbers.
    grid : Grid
    numerics : Numerics
    """

    settles = True
    numbers: Sequence[Number] = (*_OF_CONTACT, *_OF_INTERIORS, *_OF_COUPLING, *_OF_LAWS, _PLASTIC_ERROR)

    def __init__(
        self, interface: Interface | None, contact_of: Callable[[Interface], Contact],
        subsurfaces: Sequence[Subsurface], directions: str, laws: Sequence[ConstitutiveLaw], grid: Grid,
        numerics: Numerics,
    ) -> None:  # fmt: skip
        self.interface, self.contact_of, self.subsurfaces = interface, contact_of, subsurfaces
        self.directions, self.laws, self.grid, self.numerics = directions, laws, grid, numerics
        contact, interiors = self._make()
        self.numbers = tuple(self._numbers(contact, interiors))
        self._parts: tuple[PlanItem, ...] = (*([] if contact is None else [contact]), *interiors)
        self.name, self.reason = self._parts[0].name, self._parts[0].reason
        self.kernels = [kernel for member in self._parts for kernel in member.kernels]
        self.cost = sum((member.cost for member in self._parts), Cost())
        self.requires = frozenset() if contact is None else contact.requires
        self.accumulated = frozenset() if contact is None else contact.accumulated
        lifts = {f"residual_displacement_{name}": "every scene with eigenstrain" for name in directions if interiors}
        surface = frozenset() if contact is None else contact.fields
        self.requesters = {**dict.fromkeys(sorted(surface), "every run"), **lifts}
        self.provides = surface | frozenset(lifts).union(*(interior.state_names for interior in interiors))

    @property
    def wholes_beside_cells(self) -> bool:
        """Whether a body has both whole inhomogeneities and cells."""
        return any(subsurface.beside for subsurface in self.subsurfaces)

    @property
    def parts(self) -> Sequence[PlanItem]:
        """See `Block.parts`."""
        return self._parts

    def _make(self) -> tuple[Contact | None, list[Interior]]:
        """Contact and interiors, not yet started."""
        contact = None if self.interface is None else self.contact_of(self.interface)
        return contact, interiors_of(self.subsurfaces, self.directions)

    def _numbers(self, contact: Contact | None, interiors: Sequence[Interior]) -> Iterator[Number]:
        """Scalars of the steps of a scene."""
        if contact is not None:
            yield from contact.numbers
        for interior in interiors:
            yield from interior.numbers
        if interiors and "z" in self.directions:
            yield from _OF_INTERIORS
        laws = numbers_of_laws(self.laws)
        yield from (*laws, *(_OF_LAWS if laws else ()))
        if contact is not None:
            yield from (*(_OF_COUPLING if any(interior.responds for interior in interiors) else ()), *_OF_CONTACT)
            if any(interior.estimates_degree for interior in interiors):
                yield PRESSURE_ERROR
        if self.numerics.plastic_error is not None:
            yield _PLASTIC_ERROR

    def start(self, run: Run) -> RunningMechanics:  # noqa: ARG002
        """See `Block.start`."""
        contact, interiors = self._make()
        for member in (contact, *interiors):
            if member is not None:
                member.start()
        return RunningMechanics(self, contact, interiors)

    def contact_for(self, solids: Solids) -> Contact:
        """Contact of other solids in the same interface."""
        assert self.interface is not None
        return self.contact_of(replace(self.interface, solids=solids))


class RunningMechanics:
    """Contact, interiors, or both together, in one run.

    A step is solved by one increment or by several, see `Halving`.

    Parameters
    ----------
    plan : Mechanics
    contact : Contact or None
        Contact, already started.
    interiors : sequence of Interior
        Interiors, already started; larger ones replace them when the cells must be extended.
    """

    def __init__(self, plan: Mechanics, contact: Contact | None, interiors: Sequence[Interior]) -> None:
        self._plan, self._grid, self._numerics, self._declared = plan, plan.grid, plan.numerics, by_name(plan.numbers)
        self._of_laws = tuple(number.name for number in numbers_of_laws(plan.laws))
        self._contact, self._interiors = contact, list(interiors)
        self._solids = None if plan.interface is None else plan.interface.solids
        self._directions = plan.directions if interiors else ""
        self._couple()

    def _couple(self) -> None:
        """Couple the contact with the present interiors."""
        if self._plan.wholes_beside_cells:
            from eigencontact.execution.interiors.beside_cells import join_wholes

            join_wholes(self._interiors)
        if any(subsurface.refined for subsurface in self._plan.subsurfaces):
            from eigencontact.execution.interiors.finer_cells import join_levels

            join_levels(self._interiors)
        self._coupled = Coupled(self._contact, self._interiors, self._numerics, self._directions, self._grid.shape)

    def _follow(self, solids: Solids | None) -> None:
        """Make a new contact if the layers of the solids have changed."""
        if solids is not None and solids != self._solids:
            self._solids, self._contact = solids, self._plan.contact_for(solids)
            self._contact.start()
            self._couple()

    def advance(self, step: Step) -> None:
        """See `Running.advance`."""
        began = perf_counter()
        self._follow(step.surface.solids)
        increments, halving = self._with_enough_cells(step)
        last = increments[-1]
        step.fields |= {f"residual_displacement_{name}": field for name, field in last.displacement.items()}
        step.history |= last.records
        scalars: dict[str, float] = {}
        for increment in increments:
            accumulate(self._declared, scalars, increment.scalars)
        for increment in halving.rejected:
            efforts = {n: value for n, value in increment.scalars.items() if self._declared[n].role == "effort"}
            accumulate(self._declared, scalars, efforts)
        answers = [increment.contact for increment in increments if increment.contact is not None]
        if self._contact is not None:
            self._store(step, self._contact, answers)
            if any(interior.estimates_degree for interior in self._interiors):
                displacement_z = last.displacement["z"]
                scalars[PRESSURE_ERROR.name] = pressure_error(self._contact, self._interiors, step, displacement_z)
            scalars["solve_seconds"] = perf_counter() - began
            scalars["substeps"] = len(increments)
        if self._numerics.plastic_error is not None:
            scalars["plastic_error"] = halving.error
        step.scalars |= scalars
        if "z" in last.displacement:
            displacement_z = last.displacement["z"]
            step.scalars["max_uplift"] = max(0.0, -float(displacement_z.min()))
            step.scalars["max_sink"] = max(0.0, float(displacement_z.max()))
        if self._of_laws:
            states = (state for interior in self._interiors for state in interior.states())
            step.scalars |= dict.fromkeys(self._of_laws, 0.0) | measured(states)
            imprint = last.displacement.get("z")
            step.scalars["print_depth"] = 0.0 if imprint is None else max(0.0, peak_of_means(imprint))
            step.scalars["pile_up"] = 0.0 if imprint is None else max(0.0, peak_of_means(-imprint))

    def pressed(
        self,
        surface: Surface,
        control: Control,
        fields: Mapping[str, FloatArray],
        springs: FloatArray | None,
        start: FloatArray | None,
    ) -> FloatArray:
        """Pressure under displaced surfaces, with unchanged interiors; see `Contact.pressed`.

        `fields` are those of a similar step; empty before the first step.
        """
        self._follow(surface.solids)
        assert self._contact is not None
        assert surface.separation is not None
        displacement_z = fields.get("residual_displacement_z")
        moved = surface.separation if displacement_z is None else surface.separation + displacement_z
        return self._contact.pressed(control, moved, fields, springs, start)

    def softness(self, solids: Solids | None) -> float:
        """Displacement of the centre of a cell by a unit pressure on it [m/Pa]; `solids` as in `Surface`."""
        self._follow(solids)
        assert self._contact is not None
        return self._contact.softness

    def _with_enough_cells(self, step: Step) -> tuple[list[Solution], Halving]:
        """Solved increments of the step, and their solver; the cells of the interiors are extended if necessary."""
        while True:
            try:
                increment = Increment.of(step)
                before = self._previous_state(step, increment)
                memory = None
                if self._contact is not None:
                    memory = self._contact.recall(step.previous, before.displacement, increment.bulk[0])
                halving = Halving(self._coupled, self._interiors, self._numerics.plastic_error)
                return halving.solve(increment, memory, before), halving
            except Outgrown as short:
                short.larger.start()
                self._interiors[self._interiors.index(short.interior)] = short.larger
                self._couple()

    def _store(self, step: Step, contact: Contact, answers: Sequence[ContactAnswer]) -> None:
        """Store fields and scalars of the contact; refuse a contact at the edge of the window."""
        from eigencontact.solvers.coarse_to_fine import refuse_edge

        fields, scalars = contact.results(answers)
        if self._numerics.boundary != "periodic" and not self._numerics.allow_contact_at_edge:
            refuse_edge(fields["pressure"], self._grid)
        step.fields |= fields
        step.scalars |= scalars

    def _previous_state(self, step: Step, increment: Increment) -> Solution:
        """State of the interiors before the step, from the record of the last step."""
        if step.previous is None:
            return self._coupled.at_rest(increment)
        fields, history = step.previous.fields, step.previous.history
        displaced = {name: fields[f"residual_displacement_{name}"] for name in self._directions}
        return Solution(contact=None, displacement=displaced, records=dict(history))


def mechanics_of(model: Model) -> Mechanics | None:
    """Mechanics block of a scene; None without contact and eigenstrain."""
    surface: Interface | None = model.interface
    subsurfaces: Sequence[Subsurface] = ()
    if model.sources:
        from eigencontact.execution.routes.subsurface import subsurfaces_of

        subsurfaces = subsurfaces_of(model)
    if surface is None and not subsurfaces:
        return None
    if surface is None and any(subsurface.beside for subsurface in subsurfaces):
        raise SceneError(
            'numerics.inclusion-resolution must be "cells" without a contact where some inhomogeneities of a body are '
            "no whole (got a degree); or leave those out"
        )
    everything = surface is None or model.scene.output.tangential_displacement or bool(surface.coupling.components)
    contact_of = partial(
        _contact_of, window=model.window, numerics=model.numerics, exposed=model.exposed, ramps=model.scene.ramps,
        coupled=bool(model.cells.inhomogeneities),
    )  # fmt: skip
    directions = "xyz" if everything else "z"
    return Mechanics(surface, contact_of, subsurfaces, directions, model.laws, model.grid, model.numerics)


def _contact_of(
    interface: Interface, *, window: Window, numerics: Numerics, exposed: Exposed | None, ramps: Sequence[Ramp],
    coupled: bool,
) -> Contact:  # fmt: skip
    """Contact of an interface; see `ContactWithFriction` for the parameters."""
    if interface.friction is not None:
        from eigencontact.execution.mechanics.friction_contact import ContactWithFriction

        return ContactWithFriction(interface, window, numerics, exposed, ramps, coupled=coupled)
    from eigencontact.execution.mechanics.normal_contact import NormalContact

    return NormalContact(interface, window, numerics, coupled=coupled)


def interiors_of(subsurfaces: Sequence[Subsurface], directions: str) -> list[Interior]:
    """Interiors of both bodies: prescribed eigenstrain first, then inhomogeneities."""
    interiors: list[Interior] = []
    for subsurface in subsurfaces:
        if subsurface.prescribed and not subsurface.beside:
            from eigencontact.execution.interiors.prescribed import PrescribedEigenstrain

            interiors.append(PrescribedEigenstrain(subsurface, directions))
    for subsurface in subsurfaces:
        if subsurface.inhomogeneities and subsurface.refined:
            from eigencontact.execution.interiors.finer_cells import two_levels

            interiors += two_levels(subsurface, directions)
        elif subsurface.inhomogeneities and subsurface.in_cells:
            from eigencontact.execution.interiors.cells import Cells
            from eigencontact.execution.interiors.swept_cells import SweptCells, should_sweep

            interiors.append((SweptCells if should_sweep(subsurface) else Cells)(subsurface, directions))
        elif subsurface.inhomogeneities:
            from eigencontact.execution.interiors.polynomial_wholes import PolynomialWholes

            interiors.append(PolynomialWholes(subsurface, directions))
    return interiors
