"""Cells with a constitutive law: each eigenstrain satisfies the law of its cell under the stress of the others.

The stress of a cell is ``σ = σ_f + A e``: the part by the other cells, and the part by its own eigenstrain e. Its
strain is ``M σ + e``, with the compliance M of the matrix. The law must return σ for the strain minus the prestrain:
six equations for e in each cell, solved by Newton's method with the tangent of the law. An `AnsweringLaw` computes e
itself, with the response of a ball instead of A. This suffices for cells of any shape, because the local update need
not be exact.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.core.material import Material
from eigencontact.core.parallel import available_threads, in_parallel
from eigencontact.core.products import product
from eigencontact.errors import NotConverged, NotUnique
from eigencontact.solvers.cell_conditions import compliance
from eigencontact.solvers.law_answers import Answer, AnsweringLaw, Law, answer_of, cell_answer_of, place_of, refuse

__all__ = ["Around", "LawCells", "Variables"]

Variables = dict[str, FloatArray]


class Around(Protocol):
    """Matrix around a cell; see `eigencontact.plugin.Surroundings`."""

    @property
    def shear_stiffness(self) -> float:
        """Reduction of deviatoric stress in a ball per unit of its own eigenstrain [Pa]."""

    @property
    def bulk_stiffness(self) -> float:
        """Reduction of mean stress in a ball per unit of its own mean eigenstrain [Pa]."""


#: Largest number of Newton steps per sweep.
_STEPS = 40
#: Largest number of halvings of a Newton step.
_HALVINGS = 12
#: Residual that counts as round-off, relative to the stress.
_ROUND_OFF = 1e-11
#: Cells per call of a law if only its stress is stored.
_CHUNK = 16384
#: Cells per call of a law with `cell_answer`: for 274 000 cells, fewer cost more calls, and more exceed a cache.
_ANSWER_CHUNK = 16384
#: Allowed round-off of the strain in stress: a law much stiffer than the matrix computes strains by small differences.
_ROUNDINGS = 16.0 * np.finfo(float).eps


class LawCells:
    """Some cells of a box, by law.

    Parameters
    ----------
    matrix : Material
        Surrounding material.
    self_stress : (6, 6)
        Stress in a cell by its own eigenstrain [Pa].
    groups : sequence of (law, cells)
        Flat indices of the cells of each law.
    around : Around, optional
        Matrix for laws with `cell_answer` (`AnsweringLaw`); without it this method is not used.
    shape : (int, int, int), optional
        Shape of the box, for messages.
    threads : int, optional
        For laws with `cell_answer`; by default all cores available to this process.
    """

    def __init__(
        self,
        matrix: Material,
        self_stress: FloatArray,
        groups: Sequence[tuple[Law, NDArray[np.intp]]],
        around: Around | None = None,
        shape: tuple[int, int, int] | None = None,
        threads: int | None = None,
    ) -> None:
        self._around, self._shape, self._threads = around, shape, threads or available_threads()
        self.self_stress, self.compliance, self.modulus = self_stress, compliance(matrix), 2.0 * matrix.shear_modulus
        self.cells = np.concatenate([cells for _, cells in groups]) if groups else np.zeros(0, dtype=np.intp)
        stops = np.cumsum([0, *(cells.size for _, cells in groups)])
        self.groups = [
            (law, slice(int(a), int(b))) for (law, _), a, b in zip(groups, stops[:-1], stops[1:], strict=True)
        ]

    def answer(
        self,
        eigenstrain: FloatArray,
        stress: FloatArray,
        prestrain: FloatArray,
        before: Sequence[Mapping[str, FloatArray]],
        steps: Sequence[Any],
    ) -> tuple[FloatArray, list[Variables]]:
        """Eigenstrain of each cell under the present eigenstrain of the others, and its history variables.

        Parameters
        ----------
        eigenstrain, stress, prestrain : (6, n)
            Present values of the cells: eigenstrain [-], total stress [Pa], and prestrain.
        before, steps
            For each law: variables before the increment, and positions and time of the evaluation.

        Raises
        ------
        NotConverged
            A cell has no solution; the message has its position and law.
        PluginError
            A law returns an invalid response; see `eigencontact.solvers.law_answers`.
        """
        out, variables = np.empty_like(eigenstrain), []
        for (law, cells), records, step in zip(self.groups, before, steps, strict=True):
            e, s, fixed = eigenstrain[:, cells], stress[:, cells], prestrain[:, cells]
            with self._naming_cells(law, cells, step):
                if self._around is not None and isinstance(law, AnsweringLaw):
                    variables.append(self._cell_answers(law, out[:, cells], e, s, fixed, records, step))
                    continue
                foreign = s - product(self.self_stress, e)
                solution = _newton(_Question(self, law, foreign, fixed, records, step), e)
                out[:, cells] = solution.eigenstrain
                variables.append(solution.answer.variables)
        return out, variables

    def _cell_answers(
        self,
        law: Law,
        out: FloatArray,
        eigenstrain: FloatArray,
        stress: FloatArray,
        prestrain: FloatArray,
        records: Mapping[str, FloatArray],
        step: Any,
    ) -> Variables:
        """Write the responses of a law for its cells to `out`, chunk by chunk; returns their history variables."""
        count = out.shape[1]
        after = {name: np.empty((variable.components, count)) for name, variable in law.variables.items()}
        several: list[int] = []

        def ask(chunk: slice) -> None:
            ball = self._ball(eigenstrain[:, chunk])
            ball += stress[:, chunk]
            before = {name: values[:, chunk] for name, values in records.items()}
            try:
                response = cell_answer_of(law, ball, prestrain[:, chunk], self._around, before, step.of(chunk))
            except NotUnique as problem:
                if not len(problem.points):
                    raise
                several.extend(chunk.start + int(point) for point in problem.points)
                return
            out[:, chunk] = response[0]
            for name, values in response[1].items():
                after[name][:, chunk] = values

        in_parallel(self._threads, [partial(ask, chunk) for chunk in _pieces(count, _ANSWER_CHUNK)])
        if several:
            raise NotUnique(f"{len(several)} points have more than one answer", sorted(several))
        return after

    def words(self, law: Law, cell: int, step: Any) -> str:
        """Description of a cell: number among the cells of the law, index in the box, and position."""
        cells = next(cells for candidate, cells in self.groups if candidate is law)
        index = int(self.cells[cells][cell])
        where = index if self._shape is None else tuple(int(n) for n in np.unravel_index(index, self._shape))
        return f"cell {where}{'' if self._shape is None else ' (layer, row, column)'} {place_of(cell, step)}"

    @contextmanager
    def _naming_cells(self, law: Law, cells: slice, step: Any) -> Iterator[None]:
        """Add the cells without a unique solution, and remedies, to the error message."""
        try:
            yield
        except NotUnique as problem:
            if not len(problem.points):
                raise
            count, first = len(problem.points), self.words(law, int(problem.points[0]), step)
            raise NotUnique(
                f"constitutive law {law.key!r} softens so fast that {count} of {cells.stop - cells.start} cells have "
                f"no unique answer, first {first}; {law.advice}",
                problem.points,
            ) from None

    def misfit(
        self,
        eigenstrain: FloatArray,
        stress: FloatArray,
        prestrain: FloatArray,
        before: Sequence[Mapping[str, FloatArray]],
        steps: Sequence[Any],
    ) -> float:
        """Largest difference between the stress of the cells and the stress of their laws at their strain [Pa].

        A stress outside the yield surface is such a difference, so the result includes the yield condition. See
        `answer` for the parameters.
        """
        strain = product(self.compliance, stress) + eigenstrain - prestrain
        worst = 0.0
        for (law, cells), records, step in zip(self.groups, before, steps, strict=True):
            count = cells.stop - cells.start
            for chunk in _pieces(count, _CHUNK):
                cells_of_chunk = slice(cells.start + chunk.start, cells.start + chunk.stop)
                variables = {name: value[:, chunk] for name, value in records.items()}
                response = answer_of(law, strain[:, cells_of_chunk], variables, step.of(chunk))
                difference = np.linalg.norm(response.stress - stress[:, cells_of_chunk], axis=0)
                worst = max(worst, float(np.where(response.finite, difference, np.inf).max()))
        return worst

    def _ball(self, eigenstrain: FloatArray) -> FloatArray:
        """Stress reduction of a ball by its own eigenstrain [Pa]."""
        assert self._around is not None
        shear, bulk = self._around.shear_stiffness, self._around.bulk_stiffness
        out = shear * eigenstrain
        out[:3] += (bulk - shear) / 3.0 * eigenstrain[:3].sum(axis=0)
        return out


@dataclass(frozen=True, slots=True, eq=False)
class _Question:
    """Equations of the cells of one law."""

    body: LawCells
    law: Law
    foreign: FloatArray
    prestrain: FloatArray
    before: Mapping[str, FloatArray]
    step: Any

    def at(self, eigenstrain: FloatArray) -> _State:
        """Response of the law at the strain under an eigenstrain."""
        stress = self.foreign + product(self.body.self_stress, eigenstrain)
        strain = product(self.body.compliance, stress) + eigenstrain - self.prestrain
        answer = answer_of(self.law, strain, self.before, self.step)
        residual = answer.stress - stress
        error = np.where(answer.finite, np.linalg.norm(residual, axis=0), np.inf)
        return _State(eigenstrain, strain, answer, residual, error)

    def limit(self, state: _State) -> FloatArray:
        """Residual that counts as round-off."""
        sizes = [np.linalg.norm(tensor, axis=0) for tensor in (state.eigenstrain, self.prestrain, self.foreign)]
        strain = sizes[0] + sizes[1] + sizes[2] / self.body.modulus
        stiffness = np.linalg.norm(state.answer.tangent, axis=(1, 2))
        scale = np.maximum.reduce([self.body.modulus * sizes[0], self.body.modulus * sizes[1], sizes[2]])
        return np.asarray(_ROUND_OFF * scale + _ROUNDINGS * stiffness * strain + np.finfo(float).tiny)


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    """Eigenstrain of the cells, and the difference between the stress of their law and their stress."""

    eigenstrain: FloatArray
    strain: FloatArray
    answer: Answer
    residual: FloatArray
    error: FloatArray


def _pieces(count: int, size: int) -> list[slice]:
    return [slice(first, min(first + size, count)) for first in range(0, count, size)]


def _newton(question: _Question, start: FloatArray) -> _State:
    """Solve all cells of a law by Newton's method."""
    body, state = question.body, question.at(start.copy())
    for _ in range(_STEPS):
        refuse(question.law, state.strain, state.answer, question.step)
        jacobian = state.answer.tangent @ (body.compliance @ body.self_stress + np.eye(6)) - body.self_stress
        if np.all(state.error <= question.limit(state)):
            # If the sign of the determinant has changed, it was zero in between: another solution branches off there.
            several = np.flatnonzero(np.linalg.slogdet(jacobian)[0] <= 0.0)
            if several.size:
                raise NotUnique(f"{several.size} points have more than one answer", several.tolist())
            return state
        try:
            change = -np.linalg.solve(jacobian, state.residual.T[..., None])[..., 0].T
        except np.linalg.LinAlgError:
            raise NotConverged(
                f"constitutive law {question.law.key!r}: cells are so soft that their strain is not determined; "
                f"take smaller load steps"
            ) from None
        state = _nearer(question, state, np.asarray(change))
    worst = int(np.argmax(state.error / question.limit(state)))
    raise NotConverged(
        f"constitutive law {question.law.key!r} found no stress for the strain {place_of(worst, question.step)} in "
        f"{_STEPS} steps; take smaller load steps, or where it softens {question.law.advice}"
    )


def _nearer(question: _Question, state: _State, change: FloatArray) -> _State:
    """Newton step, halved in the cells where it does not reduce the residual, except within round-off."""
    fraction, enough = np.ones(change.shape[1]), np.maximum(state.error, question.limit(state))
    for _ in range(_HALVINGS):
        trial = question.at(state.eigenstrain + fraction * change)
        worse = ~(trial.error <= enough)
        if not worse.any():
            break
        fraction = np.where(worse, 0.5 * fraction, fraction)
    return trial
