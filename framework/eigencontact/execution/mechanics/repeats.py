"""First guesses of increments that a load history repeats.

A body that yields settles under cycles: the change of the unknowns in an increment differs from the change in the same
increment a cycle earlier by about a thousandth, and by less with every cycle. An increment that repeats therefore
starts with three results of the earlier increment:

- the change of the unknowns, as first guess;
- the tractions, as start of the contact solution;
- the differences of the rounds, which describe how the residual depends on the unknowns.

The iteration meets the same tolerance from any guess.

The prescribed values at the start and end of an increment identify it. Of the first increment of a kind only this key
is stored, so that a history without repeats stores nothing else. Guesses begin with the fourth increment of a kind:
before, the body has not settled, and they save little.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.execution.blocks.contact import ContactAnswer
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.blocks.surface import Surface
from eigencontact.solvers.joint_anderson import JointAnderson

__all__ = ["Change", "Repeat", "Repeats"]

#: Memory limit of all guesses [byte]; guesses beyond it are not stored.
_MOST = 256_000_000
#: Change of the separation, relative to its range, up to which surfaces count as those of the earlier increment: a worn
#: surface changes less in a cycle, a geometry that rolls by a cell more.
_SEPARATION_TOLERANCE = 1e-3
#: Approximate number of surface fields in the solution of a contact.
_FIELDS = 30


@dataclass(frozen=True, slots=True)
class Change:
    """Nonzero changes of one unknown in an increment.

    Attributes
    ----------
    entries, values : (n,)
        Flat indices and values of the change.
    older : Change or None
        Change in the previous cycle.
    along_line : bool
        Whether linear extrapolation from both predicts this change better than the previous change alone.
    """

    entries: NDArray[np.intp]
    values: FloatArray
    older: Change | None = None
    along_line: bool = False

    @classmethod
    def of(cls, change: FloatArray, last: Change | None) -> Change:
        """Change of an increment; `last` is that of the cycle before."""
        flat = change.ravel()
        entries = np.flatnonzero(flat)
        if last is None:
            return cls(entries, flat[entries])
        errors = []
        for along_line in (False, True):
            error = -flat
            last.add(error, along_line=along_line)
            errors.append(float(np.linalg.norm(error)))
        return cls(entries, flat[entries], replace(last, older=None), along_line=errors[1] < errors[0])

    def add(self, values: FloatArray, *, along_line: bool) -> None:
        """Add the guess of the next change to flat values."""
        values[self.entries] += self.values
        if along_line and self.older is not None:
            values[self.entries] += self.values
            values[self.older.entries] -= self.older.values

    def end_from(self, start: FloatArray) -> FloatArray:
        """Guess of the unknown at the end of an increment that begins with `start`."""
        out = start.ravel().copy()
        self.add(out, along_line=self.along_line)
        return out.reshape(start.shape)

    @property
    def nbytes(self) -> int:
        """Memory of the change and of the one before."""
        return self.entries.nbytes + self.values.nbytes + (0 if self.older is None else self.older.nbytes)


@dataclass(frozen=True, kw_only=True, slots=True)
class Repeat:
    """Results of an increment that serve as start of the same increment a cycle later.

    Attributes
    ----------
    surface : Surface
        Surfaces of the contact.
    answer : ContactAnswer
        Solution of the contact.
    changes : tuple of Change
        Changes of the swept unknowns.
    mixer : JointAnderson or None
        Acceleration with the differences of the rounds; None if it would take too much memory.
    first, cold : float
        Residual of the first round, with a guess and without.
    """

    surface: Surface
    answer: ContactAnswer
    changes: tuple[Change, ...]
    mixer: JointAnderson | None
    first: float
    cold: float

    @property
    def flowed(self) -> bool:
        """Whether the unknowns changed."""
        return any(change.entries.size for change in self.changes)

    @property
    def nbytes(self) -> int:
        """Approximate memory."""
        cells = 0 if self.surface.separation is None else self.surface.separation.nbytes
        vectors = 0 if self.mixer is None else self.mixer.nbytes
        return _FIELDS * cells + vectors + sum(change.nbytes for change in self.changes)


class Repeats:
    """Repeated increments, identified by the prescribed values at their start and end."""

    def __init__(self) -> None:
        self._end: Hashable = None
        self._records: dict[Hashable, Repeat | None] = {}

    def of(self, increment: Increment) -> Repeat | None:
        """Earlier solution of the increment; None if there is none, or if it has been stored only once."""
        repeat = self._records.get((self._end, _end_of(increment)))
        if repeat is None or any(change.older is None for change in repeat.changes):
            return None
        return repeat if _alike(repeat.surface, increment.surface) else None

    def forget(self, increment: Increment) -> None:
        """Remove the earlier solution of an increment, because its guess did not converge."""
        self._records.pop((self._end, _end_of(increment)), None)

    def store(
        self, increment: Increment, answer: ContactAnswer, changes: Sequence[FloatArray], mixer: JointAnderson,
        first: float,
    ) -> None:  # fmt: skip
        """Store the solution of an increment that repeats an earlier one; of other increments note only the key."""
        end = _end_of(increment)
        key, self._end = (self._end, end), end
        if key not in self._records:
            self._records[key] = None
            return
        last = self._records.pop(key)
        before = (None,) * len(changes) if last is None else last.changes
        mixer.restart()
        repeat = Repeat(
            surface=increment.surface, answer=answer, mixer=mixer, first=first,
            cold=first if last is None else last.cold,
            changes=tuple(Change.of(change, older) for change, older in zip(changes, before, strict=True)),
        )  # fmt: skip
        left = _MOST - sum(record.nbytes for record in self._records.values() if record is not None)
        if repeat.nbytes > left:
            repeat = replace(repeat, mixer=None)
        self._records[key] = repeat if repeat.nbytes <= left else None


def _end_of(increment: Increment) -> Hashable:
    """Prescribed values at the end of an increment."""
    bulk = tuple(sorted(increment.bulk[1].items()))
    return increment.control, increment.tangential, bulk, increment.surface.slide


def _alike(earlier: Surface, surface: Surface) -> bool:
    """Whether the surfaces are equal up to the wear of a cycle."""
    if earlier.separation is None or surface.separation is None or earlier.solids != surface.solids:
        return False
    difference = np.abs(surface.separation - earlier.separation).max()
    return bool(difference <= _SEPARATION_TOLERANCE * np.ptp(surface.separation))
