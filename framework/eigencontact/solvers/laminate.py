r"""Law of a cell that a boundary cuts: two materials in flat layers, each with its own strain, stress and memory.

Of the cell a share f is of the first material, the rest of the second, and n is the normal of the boundary between
them. The strain in the plane of the boundary and the traction on it are continuous:

    ε_1 = ε + (1-f) [a],    ε_2 = ε - f [a],    [a] = sym(a n),    (σ_1 - σ_2) n = 0,    σ = f σ_1 + (1-f) σ_2.

The jump a, three equations, is found by Newton's method. The energy is that of a real field, so that two materials
whose tangents are definite make one whose tangent is. A material that is less than some hundredths of the cell may flow
along n at no cost as long as the other one is soft: slivers are better merged.

References
----------
G. W. Milton 2002, The Theory of Composites, chapter 9 (laminates).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.tensors import INDICES, SQRT2
from eigencontact.errors import NotConverged
from eigencontact.solvers.law_answers import Answer, Law, answer_of, place_of, refuse

__all__ = ["BESIDE", "Cut", "Laminate"]

#: What follows the name of a variable of the second material where the first has one of that name.
BESIDE = "_beside"
#: Most Newton steps for the jump, and most halvings of one.
_STEPS, _HALVINGS = 40, 12
#: Difference of the tractions that is round-off, in parts of stiffness times strain.
_ROUND_OFF = 1e-14


class Cut(Protocol):
    """Points, as `eigencontact.plugin.LawStep` has them, and how a boundary cuts their cells."""

    x: FloatArray
    y: FloatArray
    z: FloatArray
    #: Share of the first material, ``(n,)``.
    fraction: FloatArray
    #: Unit normal of the boundary, ``(3, n)``.
    normal: FloatArray
    #: Prestrain of the first material less that of the second, ``(6, n)`` [-].
    difference: FloatArray


class _Response(NamedTuple):
    """See `eigencontact.plugin.Response`."""

    stress: FloatArray
    tangent: FloatArray
    variables: Mapping[str, FloatArray]


@dataclass(frozen=True, eq=False)
class Laminate:
    """Two laws as one.

    Attributes
    ----------
    first, second : Law
        Linear laws whose constants depend on the place included.
    """

    first: Law
    second: Law

    @property
    def key(self) -> str:
        """Name in messages."""
        return f"{self.first.key} beside {self.second.key}"

    @property
    def advice(self) -> str:
        """Advice where the materials soften."""
        return str((self.first if self.first.variables else self.second).advice)

    @property
    def averaged(self) -> Mapping[str, float]:
        """No neighbourhoods."""
        return {}

    @property
    def variables(self) -> dict[str, Any]:
        """What both remember: those of the second under the name that `names` gives."""
        second, names = self.second.variables, self._names
        return {**self.first.variables, **{name: second[own] for own, name in names.items()}}

    @property
    def _names(self) -> dict[str, str]:
        """Stored names of the variables of the second material."""
        return {name: name + BESIDE if name in self.first.variables else name for name in self.second.variables}

    def parts(self, variables: Mapping[str, FloatArray]) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
        """Variables of each material by its own names."""
        first = {name: variables[name] for name in self.first.variables}
        return first, {own: variables[name] for own, name in self._names.items()}

    def update(self, strain: FloatArray, before: Mapping[str, FloatArray], step: Cut) -> _Response:
        """Stress, tangent and variables for the mean strain less the mean prestrain, ``(6, n)``.

        Raises
        ------
        NotConverged
            No jump makes the tractions equal.
        """
        question = _Question(self, strain, self.parts(before), step)
        jump = np.zeros((3, strain.shape[1]))
        state = question.at(jump)
        for _ in range(_STEPS):
            for law, asked, answer in zip((self.first, self.second), state.strains, state.answers, strict=True):
                refuse(law, asked, answer, step)
            if np.all(state.error <= state.limit):
                return question.response(state)
            state = question.nearer(state)
        worst = int(np.argmax(state.error / state.limit))
        raise NotConverged(
            f"constitutive law {self.key!r} found no common traction {place_of(worst, step)} in {_STEPS} steps; "
            "take smaller load steps"
        )


class _State(NamedTuple):
    """Jump in each cell, and how far the tractions of the two materials differ."""

    jump: FloatArray
    strains: tuple[FloatArray, FloatArray]
    answers: tuple[Answer, Answer]
    difference: FloatArray
    error: FloatArray
    limit: FloatArray


class _Question:
    """Equations of the cells of one laminate."""

    def __init__(
        self, law: Laminate, strain: FloatArray, before: tuple[dict[str, FloatArray], dict[str, FloatArray]], step: Cut
    ) -> None:
        places = step.x, step.y, step.z
        self._laws = [part.at(*places) if part.linear else part for part in (law.first, law.second)]  # type: ignore[attr-defined]
        self._law, self._strain, self._before, self._step = law, strain, before, step
        self._share = step.fraction
        self._across = jump_strains(step.normal.T)

    def at(self, jump: FloatArray) -> _State:
        """Both laws under a jump ``(3, n)``."""
        relative = np.einsum("nij,jn->in", self._across, jump) - self._step.difference
        strains = self._strain + (1.0 - self._share) * relative, self._strain - self._share * relative
        first, second = (
            answer_of(law, strain, before, self._step)
            for law, strain, before in zip(self._laws, strains, self._before, strict=True)
        )
        difference = np.einsum("nij,in->jn", self._across, first.stress - second.stress)
        error = np.where(first.finite & second.finite, np.linalg.norm(difference, axis=0), np.inf)
        limit = np.finfo(float).tiny + _ROUND_OFF * sum(
            np.linalg.norm(answer.tangent, axis=(1, 2)) * np.linalg.norm(asked, axis=0)
            for answer, asked in zip((first, second), strains, strict=True)
        )
        return _State(jump, strains, (first, second), difference, error, np.asarray(limit))

    def nearer(self, state: _State) -> _State:
        """Newton's step, halved in the cells where it does not lower the difference, unless to round-off."""
        try:
            change = -np.linalg.solve(self._acoustic(state), state.difference.T[..., None])[..., 0].T
        except np.linalg.LinAlgError:
            raise NotConverged(
                f"constitutive law {self._law.key!r}: both materials flow along their boundary; take smaller load steps"
            ) from None
        fraction, enough = np.ones(change.shape[1]), np.maximum(state.error, state.limit)
        for _ in range(_HALVINGS):
            trial = self.at(state.jump + fraction * change)
            worse = ~(trial.error <= np.maximum(enough, trial.limit))
            if not worse.any():
                break
            fraction = np.where(worse, 0.5 * fraction, fraction)
        return trial

    def _acoustic(self, state: _State) -> FloatArray:
        """Derivative of the difference of tractions by the jump, ``(n, 3, 3)``."""
        f, (first, second) = self._share[:, None, None], state.answers
        return self._across.swapaxes(1, 2) @ ((1.0 - f) * first.tangent + f * second.tangent) @ self._across

    def response(self, state: _State) -> _Response:
        """Of the cells as a whole."""
        f, (first, second) = self._share[:, None, None], state.answers
        unlike = first.tangent - second.tangent
        moved = np.linalg.solve(self._acoustic(state), self._across.swapaxes(1, 2) @ unlike)
        tangent = f * first.tangent + (1.0 - f) * second.tangent - f * (1.0 - f) * unlike @ self._across @ moved
        stress = self._share * first.stress + (1.0 - self._share) * second.stress
        names = self._law._names
        variables = {**first.variables, **{names[own]: values for own, values in second.variables.items()}}
        return _Response(stress, np.moveaxis(tangent, 0, 2), variables)


def jump_strains(normals: FloatArray) -> FloatArray:
    """Mandel strain sym(a n) by the jump a, ``(n, 6, 3)``, for unit normals ``(n, 3)``; transposed, stress to traction.

    Examples
    --------
    >>> jump_strains(np.array([[0.0, 0.0, 1.0]]))[0, 2].tolist()
    [0.0, 0.0, 1.0]
    """
    out = np.zeros((len(normals), 6, 3))
    for row, (i, j) in enumerate(INDICES):
        weight = 0.5 if i == j else 0.5 * SQRT2
        out[:, row, i] += weight * normals[:, j]
        out[:, row, j] += weight * normals[:, i]
    return out
