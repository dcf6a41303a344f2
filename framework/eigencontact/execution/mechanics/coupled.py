"""Coupled solution of a contact and the interiors below it, by fixed-point iteration with acceleration.

Let S be the compliance of the bodies without inhomogeneities and R the additional compliance of the inhomogeneities. A
round has three steps:

1. It solves the contact on bodies of compliance (1 + θ) S, with an offset o of the surface.
2. It solves the interiors under the tractions t of this contact.
3. It computes the offset R t - θ S t, for which the contact would have been correct.

The factor θ is the middle of the estimated range of R relative to S; the changes between rounds give the estimates.
Errors then shrink by a fixed factor for any set of cells in contact, for stiff (-1 < R / S < 0) and for soft
inhomogeneities (R / S > 0, any size). While the set of cells in contact does not change, Anderson acceleration combines
the last rounds. The tolerance of the solves in a round follows the smallest error so far; the accepted solution meets
the tolerance of the scene.

The eigenstrain of a swept interior is an unknown of the iteration together with the offset.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.numbers import accumulate, by_name
from eigencontact.core.tractions import ALONG
from eigencontact.errors import NotConverged
from eigencontact.execution.blocks.contact import Contact, ContactAnswer
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.blocks.precision import INNER
from eigencontact.execution.interiors.interior import Interior
from eigencontact.execution.mechanics.repeats import Repeat, Repeats
from eigencontact.results.records import HistoryRecord
from eigencontact.scene.schema import Numerics
from eigencontact.solvers.anderson import Anderson
from eigencontact.solvers.joint_anderson import JointAnderson

__all__ = ["Coupled", "Solution"]


#: Largest number of rounds, and the same if every interior is swept: softening under friction takes a hundred rounds.
_ROUNDS, _ROUNDS_SWEPT = 60, 150
#: Tolerance of the first round, and tolerance of later rounds relative to the last change.
_LOOSEST, _SHARE = 1e-3, 0.01
#: The same if every interior is swept: 0.3 in place of 0.03 takes 1.6 times as many sweeps.
_LOOSEST_SWEPT, _SHARE_SWEPT = 1e-2, 0.03
_TIGHTEST = 1e-13
#: Largest number of passes between wholes and cells of one body without tractions: the residual falls by more than a
#: factor of 3 per pass.
_PASSES = 12
#: Allowed residual after these passes, in tolerances.
_AGREED = 10.0
#: Rounds in the Anderson combination; bound of the additional compliance of the inhomogeneities, relative to the
#: bodies.
_DEPTH, _EXTREME = 8, 64.0
#: Tolerance of the first round from a guess, relative to the residual of the guess a cycle earlier; and largest ratio
#: of the residual with a guess to the one without, for which the differences of the earlier cycle are reused.
_GUESSED, _CLOSER = 0.1, 0.1
#: Largest allowed ratio of the error after a round to the error before it.
_SHRINKS = 0.9
#: Displacements along the surface are relative to their own size, but to no less than this part of the normal one.
_ALONG = 0.05


@dataclass(frozen=True, kw_only=True, slots=True)
class Solution:
    """Solution of an increment.

    Attributes
    ----------
    contact : ContactAnswer or None
        Solution of the contact; None if the scene has no contact.
    displacement : mapping of str to (ny, nx)
        Surface displacement by the interiors, in all requested directions [m].
    records : mapping of str to HistoryRecord
        State variables of the interiors.
    scalars : mapping of str to float
        Numbers of the iteration.
    """

    contact: ContactAnswer | None
    displacement: dict[str, FloatArray]
    records: dict[str, HistoryRecord]
    scalars: dict[str, float] = field(default_factory=dict)


class Coupled:
    """Contact (optional) coupled with interiors.

    Parameters
    ----------
    contact : Contact or None
    interiors : sequence of Interior
    numerics : Numerics
        Tolerance and precision.
    directions : str
        Directions in which the surface displacement is requested.
    shape : (int, int)
        Shape of surface fields.
    """

    def __init__(
        self,
        contact: Contact | None,
        interiors: Sequence[Interior],
        numerics: Numerics,
        directions: str,
        shape: tuple[int, int],
    ) -> None:
        self._contact, self._interiors, self._directions, self._shape = contact, interiors, directions, shape
        self._tolerance = numerics.tolerance
        # Round-off of single precision exceeds the margin below the tolerance of a scene.
        share = 1.0 if numerics.precision == "single" else INNER
        self._least = max(share * numerics.tolerance, _TIGHTEST)
        self._responding = [interior for interior in interiors if interior.responds]
        self._repeats = Repeats()

    def at_rest(self, increment: Increment) -> Solution:
        """Interiors without load, at the start of the first step; None if they have no effect."""
        adopted = {name: record for interior in self._interiors for name, record in interior.adopted().items()}
        if not self._responding and (self._contact is None or self._contact.directions == "z"):
            return Solution(contact=None, displacement={}, records=adopted)
        for interior in self._interiors:
            interior.begin(increment.at_start(), adopted)
        return self._solve_interiors()

    def solve(self, increment: Increment, memory: Any, before: Solution) -> Solution:
        """Solve one increment.

        Parameters
        ----------
        increment : Increment
            Prescribed values.
        memory : object
            State of the contact.
        before : Solution
            State at the start: stored variables of the interiors, and their surface displacement.

        Raises
        ------
        NotConverged
            The increment is too large, or has no solution.
        """
        for interior in self._interiors:
            interior.begin(increment, before.records)
        if self._contact is None:
            return self._solve_interiors()
        if not self._responding:
            offset = self._displaced(self._contact.directions)
            answer = self._contact.solve(increment, memory, offset)
            return self._solution(answer, dict(answer.counts))
        if (repeat := self._repeats.of(increment)) is not None:
            try:
                return self._iterated(self._contact, increment, memory, repeat)
            except NotConverged:
                self._repeats.forget(increment)
            for interior in self._interiors:
                interior.begin(increment, before.records)
        try:
            return self._iterated(self._contact, increment, memory)
        except NotConverged:
            stubborn = [interior for interior in self._responding if not interior.answer_as_a_whole()]
            if len(stubborn) == len(self._responding):
                raise
        for interior in stubborn:
            interior.begin(increment, before.records)
        return self._iterated(self._contact, increment, memory)

    def _solve_interiors(self) -> Solution:
        """Solve the interiors without tractions; only wholes and cells of one body interact then."""
        passes = _PASSES if any(interior.is_beside for interior in self._responding) else 1
        for interior in self._responding * passes:
            mixer = Anderson(_DEPTH)
            for number in range(1, _ROUNDS + 1):
                image, residual = interior.image({}, self._tolerance)
                if residual <= self._tolerance:
                    break
                if number == _ROUNDS:
                    raise NotConverged(
                        f"interior of body {interior.body}: residual {residual:.1e} after {number} sweeps (tolerance "
                        f"{self._tolerance:.1e}){interior.trouble()}; use smaller steps or a larger tolerance"
                    )
                interior.take(mixer.next(interior.unknown, image))
        if passes > 1:
            left = max((interior.image({}, self._tolerance)[1] for interior in self._responding), default=0.0)
            if left > _AGREED * self._tolerance:
                raise NotConverged(
                    f"interiors of one body: residual {left:.1e} after {passes} passes without a contact (tolerance "
                    f"{_AGREED * self._tolerance:.1e}); use a larger tolerance, or one kind of cells"
                )
        return self._solution(None, {})

    def _solution(self, answer: ContactAnswer | None, scalars: dict[str, float]) -> Solution:
        for interior in self._interiors:
            interior.check()
            accumulate(by_name(interior.numbers), scalars, interior.scalars())
        records = {name: item for interior in self._interiors for name, item in interior.state_records().items()}
        return Solution(
            contact=answer, displacement=self._displaced(self._directions), records=records, scalars=scalars
        )  # fmt: skip

    def _displaced(self, directions: str) -> dict[str, FloatArray]:
        """Displacement of the surfaces by all interiors, by direction."""
        displacements = [interior.displacement(directions) for interior in self._interiors]
        return (
            {name: np.sum([displacement[name] for displacement in displacements], axis=0) for name in directions}
            if displacements
            else {}
        )

    def _iterated(self, contact: Contact, increment: Increment, memory: Any, repeat: Repeat | None = None) -> Solution:
        """Iterate contact and interiors until the residual meets the tolerance, from an earlier solution if given."""
        names, mixer, history, counts = contact.directions, JointAnderson(_DEPTH), _ComplianceRatio(), Counter[str]()
        swept = [interior for interior in self._interiors if interior.unknown.size]
        whole = [interior for interior in self._interiors if not interior.unknown.size]
        answering = any(interior.responds for interior in whole)
        loosest, tolerance_ratio = (_LOOSEST, _SHARE) if answering else (_LOOSEST_SWEPT, _SHARE_SWEPT)
        if swept and all(interior.tries_elastic for interior in swept):
            loosest = self._least
        # Unknowns: the displacement by all interiors with a direct response, and the unknowns of the swept interiors.
        offset = self._stacked(whole, names)
        share, best, last, loaded = 0.0, np.inf, np.inf, None
        starts, answer, first = [interior.unknown for interior in swept], None, np.inf
        if repeat is not None:
            answer = repeat.answer
            for interior, start, change in zip(swept, starts, repeat.changes, strict=True):
                interior.take(change.end_from(start))
            if repeat.flowed:
                loosest = float(np.clip(_GUESSED * repeat.first, self._least, _LOOSEST_SWEPT))
        number, residual = 0, np.inf
        for number in range(1, (_ROUNDS if answering else _ROUNDS_SWEPT) + 1):
            inner = float(np.clip(tolerance_ratio * best, self._least, loosest))
            fields = dict(zip(names, offset + self._stacked(swept, names), strict=True))
            answer = contact.solve(increment, memory, fields, softer=share, tolerance=inner, start=answer)
            counts.update(answer.counts)
            images = [interior.image(answer.tractions, inner) for interior in (*whole, *swept) if interior.responds]
            images = images[len(images) - len(swept) :]
            current = _Round(
                traction=np.stack([answer.tractions[ALONG[name].field] for name in names]),
                elastic=np.stack([answer.displacement[name] for name in names]),
                residual=self._stacked(whole, names),
            )
            image, scales = current.residual - share * current.elastic, current.scales(names.index("z"))
            changed = float(np.max(np.abs(image - offset).max(axis=(1, 2)) / scales))
            residual = max([changed, *(left for _, left in images)])
            best = min(best, residual)
            if number == 1:
                first = residual
                if repeat is not None and repeat.mixer is not None and first <= _CLOSER * repeat.cold:
                    mixer = repeat.mixer
            if increment.progress is not None:
                increment.progress("contact and inhomogeneities", residual, self._tolerance)
            if residual <= self._tolerance and inner <= self._tolerance:
                if not answering:
                    changes = [interior.unknown - start for interior, start in zip(swept, starts, strict=True)]
                    self._repeats.store(increment, answer, changes, mixer, first)
                scalars = dict(counts) | {"coupling_iterations": float(number), "coupling_residual": residual}
                return self._solution(answer, scalars)
            if not np.isfinite(residual):
                break
            loosest = _LOOSEST if answering else _LOOSEST_SWEPT
            if residual <= self._tolerance and not answering:
                continue  # swept interiors keep their values: only the contact must be solved to the tolerance
            # Softening of the bodies requires an offset for every displacement by the tractions.
            softness = history.share(current) if answering and set(names) >= set(answer.displacement) else 0.0
            pressed = answer.tractions["pressure"] > 0
            moved = loaded is None or not np.array_equal(pressed, loaded)
            guess = [offset, *(interior.unknown for interior in swept)]
            answers = [image, *(tractions for tractions, _ in images)]
            if answering and (softness != share or moved or residual > last):
                mixer, share = JointAnderson(_DEPTH), softness
                mixed = [current.residual - share * current.elastic, *answers[1:]]
            else:
                sizes = [scales[:, None, None], *_by_body(swept, answers[1:])]
                mixed = mixer.next(guess, answers, sizes)
            offset = mixed[0]
            for interior, values in zip(swept, mixed[1:], strict=True):
                interior.take(values)
            last, loaded = residual, pressed
        raise NotConverged(
            f"contact and inhomogeneities: residual {residual:.1e} after {number} rounds "
            f"(tolerance {self._tolerance:.1e}){''.join(interior.trouble() for interior in self._responding)}; "
            "use smaller load steps or a larger tolerance"
        )

    def _stacked(self, interiors: Sequence[Interior], names: str) -> FloatArray:
        """Displacement of the surfaces by some interiors, ``(len(names), ny, nx)``."""
        displacements = [interior.displacement(names) for interior in interiors]
        if not displacements:
            return np.zeros((len(names), *self._shape))
        return np.asarray(np.sum([[displacement[name] for name in names] for displacement in displacements], axis=0))


def _by_body(interiors: Sequence[Interior], unknowns: Sequence[FloatArray]) -> list[FloatArray]:
    """Largest unknown of each interior and of all others in its body, if their onsets of yielding may differ."""
    largest = [
        (interior.body, max(values.max(), -values.min())) for interior, values in zip(interiors, unknowns, strict=True)
    ]
    return [np.max([size for body, size in largest if body == body_number]) for body_number, _ in largest]


@dataclass(frozen=True, slots=True)
class _Round:
    """Tractions of an iteration, and the surface displacement by tractions and interiors, ``(k, ny, nx)``."""

    traction: FloatArray
    elastic: FloatArray
    residual: FloatArray

    def scales(self, normal: int) -> FloatArray:
        """Scale of the total displacement for each component [m]; `normal` is the row along z."""
        total = np.abs(self.elastic + self.residual).max(axis=(1, 2))
        sizes = np.maximum(total, np.abs(self.residual).max(axis=(1, 2)))
        return np.asarray(np.maximum(sizes, max(_ALONG * float(sizes[normal]), np.finfo(float).tiny)))


class _ComplianceRatio:
    """Compliance of the interiors relative to the bodies, estimated from changes between iterations."""

    def __init__(self) -> None:
        self._last: _Round | None = None
        self._ratios: list[float] = []

    def share(self, current: _Round) -> float:
        """Fraction of the bodies' compliance to add in the contact: middle of the estimated range, in few steps."""
        before, self._last = self._last, current
        if before is not None:
            change = current.traction - before.traction
            work = float(np.sum(change * (current.elastic - before.elastic)))
            added = float(np.sum(change * (current.residual - before.residual)))
            if work > 0.0 and abs(added) < _EXTREME * work:
                self._ratios.append(added / work)
        if not self._ratios:
            return 0.0
        middle = max(1.0 + 0.5 * (min(self._ratios) + max(self._ratios)), 1.0 / _EXTREME)
        softer = float(2.0 ** (0.5 * round(2.0 * np.log2(middle))))
        # A round leaves |R - θ S| / (1 + θ) S of an error. A θ that is rounded down may not reduce errors of the
        # largest ratio.
        if 1.0 + max(self._ratios) > (1.0 + _SHRINKS) * softer:
            softer *= 2.0**0.5
        return softer - 1.0
