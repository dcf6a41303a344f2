r"""Law of a cell cut by a boundary: two materials, each with its own strain, stress and internal variables.

Material 1 fills a fraction f of the cell, material 2 the rest. With the jump d of their strains,

    ε_1 = ε + (1-f) d,    ε_2 = ε - f d,    σ_1 - σ_2 + K d = 0,    σ = f σ_1 + (1-f) σ_2,

and K = T (I - M T)^-1, with the compliance M of the matrix and T as in `eigencontact.solvers.cell_conditions`. For
linear laws these equations give the conditions there. For flat layers K is infinite except for ``d = sym(a n)``; this
means equal tractions on the boundary of normal n and equal strains in its plane. Newton's method solves the six
equations for d. They are the conditions of a minimum of the energy with ``f (1-f) d K d / 2``, so that two materials
with positive definite tangents give a positive definite tangent of the cell.

References
----------
G. W. Milton 2002, The Theory of Composites, chapter 9 (laminates); R. Hill 1965, J. Mech. Phys. Solids 13, 89 (K).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.material import Material
from eigencontact.errors import NotConverged
from eigencontact.solvers.cell_conditions import compliance, constraint_of_cut
from eigencontact.solvers.law_answers import Answer, Law, answer_of, place_of, refuse

__all__ = ["BESIDE", "Cut", "Laminate", "resistance"]

#: Suffix for a variable of the second material, if the first has a variable of the same name.
BESIDE = "_beside"
#: Largest number of Newton steps for the jump, and of halvings of one step.
_STEPS, _HALVINGS = 40, 12
#: Residual that counts as round-off, relative to stiffness times strain.
_ROUND_OFF = 1e-14


class Cut(Protocol):
    """Points as in `eigencontact.plugin.LawStep`, with the boundary in their cells."""

    x: FloatArray
    y: FloatArray
    z: FloatArray
    #: Fraction of the first material, ``(n,)``.
    fraction: FloatArray
    #: K [Pa], ``(6, 6, n)``.
    resistance: FloatArray
    #: Prestrain of the first material minus that of the second, ``(6, n)`` [-].
    difference: FloatArray
    #: Last strain, jump and derivative of the jump, written by the law; empty at first.
    last_response: dict[str, FloatArray]


class _Response(NamedTuple):
    """See `eigencontact.plugin.Response`."""

    stress: FloatArray
    tangent: FloatArray
    variables: Mapping[str, FloatArray]


@dataclass(frozen=True, eq=False)
class Laminate:
    """Two laws combined to one.

    Attributes
    ----------
    first, second : Law
        Laws of the materials; linear laws with constants that depend on position are allowed.
    """

    first: Law
    second: Law

    @property
    def key(self) -> str:
        """Name in messages."""
        return f"{self.first.key} beside {self.second.key}"

    @property
    def advice(self) -> str:
        """Advice for materials that soften."""
        return str((self.first if self.first.variables else self.second).advice)

    @property
    def averaged(self) -> Mapping[str, float]:
        """No variables with neighbourhood means."""
        return {}

    @property
    def variables(self) -> dict[str, Any]:
        """Variables of both materials, those of the second under their `stored` names."""
        second = self.second.variables
        return {**self.first.variables, **{name: second[law_name] for law_name, name in self.stored.items()}}

    @property
    def stored(self) -> dict[str, str]:
        """Stored name of each variable of the second material."""
        return {name: name + BESIDE if name in self.first.variables else name for name in self.second.variables}

    def parts(self, variables: Mapping[str, FloatArray]) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
        """Variables of each material by its own names."""
        first = {name: variables[name] for name in self.first.variables}
        return first, {law_name: variables[name] for law_name, name in self.stored.items()}

    def update(self, strain: FloatArray, before: Mapping[str, FloatArray], step: Cut) -> _Response:
        """Stress, tangent and variables for the mean strain minus the mean prestrain, ``(6, n)``.

        Raises
        ------
        NotConverged
            The iteration for the jump does not converge.
        """
        question = _Question(self, strain, self.parts(before), step)
        state = question.at(question.start())
        for _ in range(_STEPS):
            for law, law_strain, answer in zip((self.first, self.second), state.strains, state.answers, strict=True):
                refuse(law, law_strain, answer, step)
            if np.all(state.error <= state.limit):
                return question.response(state)
            state = question.nearer(state)
        worst = int(np.argmax(state.error / state.limit))
        raise NotConverged(
            f"constitutive law {self.key!r} found no strains of its parts {place_of(worst, step)} in {_STEPS} steps; "
            "take smaller load steps"
        )


def resistance(matrix: Material, normals: FloatArray) -> FloatArray:
    """K [Pa] of cut cells ``(6, 6, n)``, by the normals of the boundaries in them ``(3, n)``; zero if unknown."""
    constraint = constraint_of_cut(matrix, normals.T)
    give = np.eye(6) - compliance(matrix) @ constraint
    out = np.linalg.solve(give.swapaxes(1, 2), constraint.swapaxes(1, 2)).T
    return np.asarray(out, dtype=float)


class _State(NamedTuple):
    """Jump of the strains in each cell, and the residual of its condition."""

    jump: FloatArray
    strains: tuple[FloatArray, FloatArray]
    answers: tuple[Answer, Answer]
    residual: FloatArray
    error: FloatArray
    limit: FloatArray


class _Question:
    """Equations of the cells of one laminate."""

    def __init__(
        self, law: Laminate, strain: FloatArray, before: tuple[dict[str, FloatArray], dict[str, FloatArray]], step: Cut
    ) -> None:
        places = step.x, step.y, step.z
        self._laws: list[Any] = [law.first, law.second]
        self._laws = [phase.at(*places) if phase.linear else phase for phase in self._laws]
        self._law, self._strain, self._before, self._step = law, strain, before, step
        self._share, self._resistance = step.fraction, np.moveaxis(step.resistance, 2, 0)

    def start(self) -> FloatArray:
        """Start for the jump, extrapolated from the last one; within an increment the strain changes less and less."""
        if not self._step.last_response:
            return np.zeros_like(self._strain)
        strain, jump, moved = (self._step.last_response[name] for name in ("strain", "jump", "moved"))
        return np.asarray(jump - np.einsum("nij,jn->in", moved, self._strain - strain))

    def at(self, jump: FloatArray) -> _State:
        """Response of both laws for a jump ``(6, n)``."""
        relative = jump - self._step.difference
        strains = self._strain + (1.0 - self._share) * relative, self._strain - self._share * relative
        first, second = (
            answer_of(law, strain, before, self._step)
            for law, strain, before in zip(self._laws, strains, self._before, strict=True)
        )
        residual = first.stress - second.stress + np.einsum("nij,jn->in", self._resistance, jump)
        error = np.where(first.finite & second.finite, np.linalg.norm(residual, axis=0), np.inf)
        stiff = (first.tangent, strains[0]), (second.tangent, strains[1]), (self._resistance, jump)
        scale = sum(np.linalg.norm(matrix, axis=(1, 2)) * np.linalg.norm(tensor, axis=0) for matrix, tensor in stiff)
        return _State(jump, strains, (first, second), residual, error, np.finfo(float).tiny + _ROUND_OFF * scale)

    def nearer(self, state: _State) -> _State:
        """Newton step, halved in the cells where it does not reduce the residual, except within round-off."""
        try:
            change = -np.linalg.solve(self._jacobian(state), state.residual.T[..., None])[..., 0].T
        except np.linalg.LinAlgError:
            raise NotConverged(
                f"constitutive law {self._law.key!r}: parts of cells are so soft that their strain is not determined; "
                "take smaller load steps"
            ) from None
        fraction, enough = np.ones(change.shape[1]), np.maximum(state.error, state.limit)
        for _ in range(_HALVINGS):
            trial = self.at(state.jump + fraction * change)
            worse = ~(trial.error <= np.maximum(enough, trial.limit))
            if not worse.any():
                break
            fraction = np.where(worse, 0.5 * fraction, fraction)
        return trial

    def _jacobian(self, state: _State) -> FloatArray:
        f, (first, second) = self._share[:, None, None], state.answers
        return np.asarray((1.0 - f) * first.tangent + f * second.tangent + self._resistance)

    def response(self, state: _State) -> _Response:
        """Response of the cells as a whole."""
        f, (first, second) = self._share[:, None, None], state.answers
        unlike = first.tangent - second.tangent
        moved = np.asarray(np.linalg.solve(self._jacobian(state), unlike), dtype=float)
        self._step.last_response.update(strain=self._strain, jump=state.jump, moved=moved)
        tangent = f * first.tangent + (1.0 - f) * second.tangent - f * (1.0 - f) * unlike @ moved
        stress = self._share * first.stress + (1.0 - self._share) * second.stress
        second_variables = {self._law.stored[law_name]: values for law_name, values in second.variables.items()}
        return _Response(stress, np.moveaxis(tangent, 0, 2), {**first.variables, **second_variables})
