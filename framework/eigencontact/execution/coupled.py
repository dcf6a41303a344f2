"""Contact and inhomogeneities solved together: each needs what the other does to the surface, or to the inside.

Let S be the compliance of the bodies without inhomogeneities and R what those add. A round solves the contact on bodies
of the compliance (1 + θ) S under an offset o of the surface, then the inhomogeneities under its tractions t, and gives
the offset R t - θ S t that would have been right. The share θ is the middle of the values of R relative to S that
changes from round to round have shown: errors then shrink by a fixed factor whatever cells are in contact, for stiff
(-1 < R / S < 0) and for soft inhomogeneities (R / S > 0, up to any size). Between changes of the contact Anderson's
combination of the last rounds speeds it up. Tolerances of the solves in a round follow the smallest error so far; what
is accepted is solved to the tolerance of the scene.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.material import Material
from eigencontact.errors import NotConverged
from eigencontact.execution.contact import NormalContact
from eigencontact.execution.friction import FrictionalContactRunner
from eigencontact.execution.inhomogeneities import Inhomogeneities, SolvedResidualDisplacement
from eigencontact.execution.runners import Runner, State, build_runner
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
_LOOSEST, _SHARE, _INNER = 1e-3, 0.01, 0.3
#: Rounds that Anderson's combination keeps; bound of the compliance that inhomogeneities may add or take away.
_DEPTH, _EXTREME = 8, 64.0
_TRACTIONS = {"x": "shear_x", "y": "shear_y", "z": "pressure"}
#: Displacements along the surface are measured by their own size, but not by less than this part of the normal one.
_ALONG = 0.05
_TIGHTEST = 1e-13
#: Scalars that are summed over rounds.
_SPENT = ("iterations", "convolutions", "tangential_convolutions", "solve_seconds")
_ADDED = ("slip_x", "slip_y")


class CoupledRunner:
    """A contact over inhomogeneities. What a step needs of the last one is taken from its stored record alone."""

    def __init__(self, plan: Plan, runners: Sequence[tuple[Block, Runner]]) -> None:
        self._plan, self._numerics, self._grid = plan, plan.scene.numerics, plan.grid
        self._contacts: dict[float, NormalContact | FrictionalContactRunner]
        for block, runner in runners:
            if isinstance(runner, Inhomogeneities):
                self._inside = runner
            elif isinstance(runner, SolvedResidualDisplacement):
                self._surface = runner
            else:
                assert isinstance(runner, NormalContact | FrictionalContactRunner)
                self._contacts, self._block = {0.0: runner}, block
                self._names = sorted(name for name in block.requires if name.startswith("residual_displacement"))
        self._frictional = plan.friction is not None
        # Bodies can be softened where every displacement that the contact models is offset.
        elastic = all(body is None or isinstance(body, Material) for body in plan.bodies)
        self._softens = elastic and (not self._frictional or len(self._names) == 3)

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
        if not self._frictional:  # the way to a load does not matter: the half is but a start
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

    def _iterate(self, state: State, start: FloatArray) -> None:
        """Rounds until the displacement that goes in comes out."""
        tolerance, best = self._numerics.tolerance, np.inf
        # Single precision has nothing to spare below the tolerance of a scene.
        least = max(tolerance if self._numerics.precision == "single" else _INNER * tolerance, _TIGHTEST)
        mixer, spent, seen = Anderson(_DEPTH), dict.fromkeys(_SPENT, 0.0), _Seen()
        offset, share, last, loaded = start, 0.0, np.inf, None
        for number in range(1, _ROUNDS + 1):
            inner = float(np.clip(_SHARE * best, least, _LOOSEST))
            answer = self._round(state, offset, share, inner)
            for name in _SPENT:
                spent[name] += state.scalars.get(name, 0.0)
            image = answer.residual - share * answer.elastic
            scales = self._scales(answer)
            residual = float(np.max(np.abs(image - offset).max(axis=(1, 2)) / scales))
            best = min(best, residual)
            if state.progress is not None:
                state.progress("contact and inhomogeneities", residual, tolerance)
            if residual <= tolerance and inner <= tolerance:
                self._accept(state, answer, number, residual, spent)
                return
            if not np.isfinite(residual):
                break
            now, wanted = state.fields["pressure"] > 0, seen.share(answer) if self._softens else 0.0
            if wanted != share or residual > last or loaded is None or not np.array_equal(now, loaded):
                mixer, share = Anderson(_DEPTH), wanted
                offset = answer.residual - share * answer.elastic
            else:
                unit = scales[:, None, None]
                offset = mixer.next(offset / unit, image / unit) * unit
            last, loaded = residual, now
        raise NotConverged(
            f"contact and inhomogeneities: residual {residual:.1e} after {number} rounds "
            f"(tolerance {tolerance:.1e}); use smaller load steps or a larger tolerance"
        )

    def _round(self, state: State, offset: FloatArray, share: float, inner: float) -> _Answer:
        """Contact on softer bodies with an offset in the gap, and what the inhomogeneities make of it."""
        trial = self._trial(state, offset, share)
        contact = self._softened(share)
        if isinstance(contact, NormalContact):
            contact.attempt(trial, inner)
        else:
            contact(trial)
        for name, values in trial.fields.items():
            if name not in self._names:
                state.fields[name] = values / (1.0 + share) if name.startswith("displacement") else values
        state.scalars |= trial.scalars
        self._inside.solve(state, inner)
        self._surface(state)
        fields = state.fields
        return _Answer(
            traction=np.stack([fields[_TRACTIONS[name[-1]]] for name in self._names]),
            elastic=np.stack([fields[f"displacement_{name[-1]}"] for name in self._names]),
            residual=np.stack([fields[name] for name in self._names]),
        )

    def _trial(self, state: State, offset: FloatArray, share: float) -> State:
        """The step as it is for softer bodies: what they displace more was offset before, too."""
        fields = {**state.fields, **dict(zip(self._names, offset, strict=True))}
        last = state.previous
        if share and last is not None:
            moved = dict(last.fields)
            for name in self._names:
                elastic = last.fields[f"displacement_{name[-1]}"]
                moved[name] = last.fields[name] - share * elastic
                moved[f"displacement_{name[-1]}"] = (1.0 + share) * elastic
            last = replace(last, fields=moved)
        return replace(state, fields=fields, previous=last)

    def _softened(self, share: float) -> NormalContact | FrictionalContactRunner:
        """Contact of bodies that are softer by a share."""
        if share not in self._contacts:
            bodies = tuple(
                replace(body, young_modulus=body.young_modulus / (1.0 + share)) if isinstance(body, Material) else None
                for body in self._plan.bodies
            )
            runner = build_runner(replace(self._plan, bodies=(bodies[0], bodies[1])), self._block)
            assert isinstance(runner, NormalContact | FrictionalContactRunner)
            self._contacts[share] = runner
        return self._contacts[share]

    def _scales(self, answer: _Answer) -> FloatArray:
        """Size of the total displacement for each component of the residual one [m]."""
        total = np.abs(answer.elastic + answer.residual).max(axis=(1, 2))
        sizes = np.maximum(total, np.abs(answer.residual).max(axis=(1, 2)))
        normal = float(sizes[self._names.index("residual_displacement_z")])
        return np.asarray(np.maximum(sizes, max(_ALONG * normal, np.finfo(float).tiny)))

    def _accept(self, state: State, answer: _Answer, rounds: int, residual: float, spent: Mapping[str, float]) -> None:
        """Keep the last round, whose pressure, gap and shear are the contact's under what it causes."""
        if not self._frictional and not self._numerics.allow_contact_at_edge:
            refuse_edge(state.fields["pressure"], self._grid)
        state.fields |= dict(zip(self._names, answer.residual, strict=True))
        state.scalars |= {name: value for name, value in spent.items() if name in state.scalars}
        state.scalars["coupling_iterations"] = state.scalars.get("coupling_iterations", 0.0) + rounds
        state.scalars["coupling_residual"] = max(residual, state.scalars.get("coupling_residual", 0.0))


@dataclass(frozen=True, slots=True)
class _Answer:
    """Tractions of a round, and the displacement of the surface by them and by the inhomogeneities, ``(k, ny, nx)``."""

    traction: FloatArray
    elastic: FloatArray
    residual: FloatArray


class _Seen:
    """Compliance of the inhomogeneities relative to that of the bodies, as changes from round to round show it."""

    def __init__(self) -> None:
        self._last: _Answer | None = None
        self._found: list[float] = []

    def share(self, answer: _Answer) -> float:
        """Part of the bodies' compliance to solve the contact with more: the middle of the range, in few steps."""
        before, self._last = self._last, answer
        if before is not None:
            change = answer.traction - before.traction
            work = float(np.sum(change * (answer.elastic - before.elastic)))
            found = float(np.sum(change * (answer.residual - before.residual)))
            if work > 0.0 and abs(found) < _EXTREME * work:
                self._found.append(found / work)
        if not self._found:
            return 0.0
        middle = max(1.0 + 0.5 * (min(self._found) + max(self._found)), 1.0 / _EXTREME)
        return float(2.0 ** (0.5 * round(2.0 * np.log2(middle)))) - 1.0


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
