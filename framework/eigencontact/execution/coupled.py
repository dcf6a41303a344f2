"""Contact and inhomogeneities solved together: each needs what the other does to the surface, or to the inside.

The unknown is the displacement of the surface by the equivalent eigenstrain. A round takes it, solves the contact, then
the inhomogeneities under that contact, and returns the displacement that they cause; Anderson's combination of the last
rounds makes it converge where the plain iteration grows (anything softer than half of the matrix). Tolerances of the
solves in a round follow the change that the last round made; what is accepted is solved to the tolerance of the scene.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from eigencontact.errors import NotConverged
from eigencontact.execution.contact import NormalContact
from eigencontact.execution.friction import FrictionalContactRunner
from eigencontact.execution.inhomogeneities import Inhomogeneities, SolvedResidualDisplacement
from eigencontact.execution.runners import Runner, State
from eigencontact.planning.blocks import Block
from eigencontact.planning.plan import Plan
from eigencontact.results.records import StepRecord
from eigencontact.solvers.anderson import Anderson
from eigencontact.solvers.coarse_to_fine import refuse_edge
from eigencontact.solvers.control import MODES as NORMAL_MODES
from eigencontact.solvers.control import Control
from eigencontact.solvers.tangential.control import MODES, TangentialControl

__all__ = ["CoupledRunner"]

FloatArray = NDArray[np.float64]

#: Rounds of one attempt, and times that a load step may be halved.
_ROUNDS, _HALVINGS = 60, 4
#: Tolerance of the first round, and of later ones as part of the last change; part of the tolerance in the end.
_LOOSEST, _SHARE, _INNER = 1e-2, 0.05, 0.3
#: Displacements along the surface are measured by their own size, but not by less than this part of the normal one.
_ALONG = 0.05
_TIGHTEST = 1e-13
#: Scalars that are summed over rounds.
_SPENT = ("iterations", "convolutions", "tangential_convolutions", "solve_seconds")
_ADDED = ("slip_x", "slip_y")


class CoupledRunner:
    """A contact over inhomogeneities. What a step needs of the last one is taken from its stored record alone."""

    def __init__(self, plan: Plan, runners: Sequence[tuple[Block, Runner]]) -> None:
        self._numerics, self._grid = plan.scene.numerics, plan.grid
        for block, runner in runners:
            if isinstance(runner, Inhomogeneities):
                self._inside = runner
            elif isinstance(runner, SolvedResidualDisplacement):
                self._surface = runner
            else:
                assert isinstance(runner, NormalContact | FrictionalContactRunner)
                self._contact = runner
                self._names = sorted(name for name in block.requires if name.startswith("residual_displacement"))

    def __call__(self, state: State) -> None:
        """Advance one step; see `Runner`."""
        began = perf_counter()
        before = state.previous.fields if state.previous is not None else self._at_rest(state)
        self._advance(state, [before[name] for name in self._names], 0)
        state.scalars["solve_seconds"] = perf_counter() - began

    def _at_rest(self, state: State) -> dict[str, FloatArray]:
        """Surface fields before the first step: by prestrain and prescribed eigenstrain alone."""
        rest = State(index=0, time=0.0, control=None, progress=state.progress)
        self._inside(rest)
        self._surface(rest)
        state.initial = rest.fields
        return rest.fields

    def _advance(self, state: State, start: list[FloatArray], depth: int) -> None:
        """One load step, or its halves where it is too large to converge."""
        given = dict(state.fields), dict(state.scalars)
        try:
            self._iterate(state, np.stack(start))
        except NotConverged:
            if depth == _HALVINGS:
                raise
        else:
            return
        state.fields, state.scalars = given
        half = self._half(state)
        self._advance(half, start, depth + 1)
        found = [half.fields[name] for name in self._names]
        if isinstance(self._contact, NormalContact):  # the way to a load does not matter: the half is but a start
            state.equivalent = half.equivalent
            state.fields["pressure"] = half.fields["pressure"]
            self._advance(state, found, depth + 1)
            return
        own, state.previous = state.previous, _record(half)
        self._advance(state, found, depth + 1)
        state.previous = own
        for name in _ADDED:
            if name in state.fields:
                state.fields[name] = state.fields[name] + half.fields[name] * (state.fields["pressure"] > 0)
        state.scalars["substeps"] += half.scalars["substeps"]

    def _half(self, state: State) -> State:
        """State in the middle of a step."""
        begin = {} if state.previous is None else state.previous.scalars
        time = 0.0 if state.previous is None else state.previous.time
        assert state.control is not None
        control = Control(**_middle(state.control, NORMAL_MODES, begin))
        tangential = None
        if state.tangential is not None:
            tangential = TangentialControl(**_middle(state.tangential, MODES, begin))
        return replace(
            state, time=0.5 * (time + state.time), control=control, tangential=tangential, fields=dict(state.fields),
            scalars=dict(state.scalars), equivalent={},
        )  # fmt: skip

    def _iterate(self, state: State, guess: FloatArray) -> None:
        """Rounds until the displacement that goes in comes out."""
        tolerance, residual = self._numerics.tolerance, np.inf
        least = max(_INNER * tolerance, _TIGHTEST)
        mixer, spent = Anderson(), dict.fromkeys(_SPENT, 0.0)
        for number in range(1, _ROUNDS + 1):
            inner = float(np.clip(_SHARE * residual, least, _LOOSEST))
            image = self._round(state, guess, inner)
            for name in _SPENT:
                spent[name] += state.scalars.get(name, 0.0)
            scales = self._scales(state, guess)
            residual = float(np.max(np.abs(image - guess).max(axis=(1, 2)) / scales))
            if state.progress is not None:
                state.progress("contact and inhomogeneities", residual, tolerance)
            if residual <= tolerance and inner <= tolerance:
                self._accept(state, guess, number, residual, spent)
                return
            if not np.isfinite(residual):
                break
            unit = scales[:, None, None]
            guess = mixer.next(guess / unit, image / unit) * unit if number > 1 else image
        raise NotConverged(
            f"contact and inhomogeneities: residual {residual:.1e} after {number} rounds "
            f"(tolerance {tolerance:.1e}); use smaller load steps or a larger tolerance"
        )

    def _round(self, state: State, guess: FloatArray, inner: float) -> FloatArray:
        """Displacement of the surface by what it causes."""
        state.fields |= dict(zip(self._names, guess, strict=True))
        if isinstance(self._contact, NormalContact):
            self._contact.attempt(state, inner)
        else:
            self._contact(state)
        self._inside.solve(state, inner)
        self._surface(state)
        return np.stack([state.fields[name] for name in self._names])

    def _scales(self, state: State, guess: FloatArray) -> FloatArray:
        """Size of the total displacement for each component of the residual one [m]."""
        sizes = []
        for name, values in zip(self._names, guess, strict=True):
            total = state.fields.get(f"displacement_{name[-1]}", 0.0) + values
            sizes.append(max(float(np.abs(total).max()), float(np.abs(values).max())))
        normal = sizes[self._names.index("residual_displacement_z")]
        floor = max(normal, np.finfo(float).tiny)
        return np.array([max(size, _ALONG * floor) for size in sizes])

    def _accept(
        self, state: State, guess: FloatArray, rounds: int, residual: float, spent: Mapping[str, float]
    ) -> None:
        """Keep the displacement that the contact was solved with: pressure, gap and shear belong to it."""
        state.fields |= dict(zip(self._names, guess, strict=True))
        if isinstance(self._contact, NormalContact) and not self._numerics.allow_contact_at_edge:
            refuse_edge(state.fields["pressure"], self._grid)
        state.scalars |= {name: value for name, value in spent.items() if name in state.scalars}
        state.scalars["coupling_iterations"] = state.scalars.get("coupling_iterations", 0.0) + rounds
        state.scalars["coupling_residual"] = max(residual, state.scalars.get("coupling_residual", 0.0))


def _middle(
    end: Control | TangentialControl, modes: tuple[tuple[str, str], ...], begin: Mapping[str, float]
) -> dict[str, float]:
    names = [name for pair in modes for name in pair]
    found = {name: getattr(end, name) for name in names if getattr(end, name) is not None}
    return {name: 0.5 * (begin.get(name, 0.0) + value) for name, value in found.items()}


def _record(state: State) -> StepRecord:
    """Middle of a step, as the step before that of its second half."""
    fields = {name: values for name, values in state.fields.items() if name != "separation"}
    return StepRecord(index=state.index, time=state.time, scalars=state.scalars, fields=fields)
