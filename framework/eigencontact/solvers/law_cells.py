"""Cells that obey a law of any kind: each finds the eigenstrain with which it bears what the others do to it.

The stress of a cell is ``σ = σ_f + A e``: what the others cause, and its own eigenstrain e by the answer A of a cell
alone. Its strain is ``M σ + e``, M the compliance of the matrix. The law must give σ for the strain less the
prestrain: six equations for e in each cell, solved by Newton's method with the tangent of the law.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.material import Material
from eigencontact.errors import NotConverged
from eigencontact.solvers.cell_conditions import compliance

__all__ = ["Law", "LawCells", "Remembered"]

FloatArray = NDArray[np.float64]
Remembered = dict[str, FloatArray]

#: Newton steps of one sweep, halvings of one of them, and residual that is round-off, in parts of the stress.
_STEPS, _HALVINGS, _ROUND_OFF = 40, 12, 1e-11


class Law(Protocol):
    """What is asked of a constitutive law; see `eigencontact.plugin.ConstitutiveLaw`."""

    def update(self, strain: FloatArray, before: Mapping[str, FloatArray], step: Any) -> Any:
        """Stress, tangent and variables after."""
        ...


class LawCells:
    """Some cells of a box, by law.

    Parameters
    ----------
    matrix : Material
        The material around.
    alone : (6, 6)
        Stress in a cell by its own eigenstrain [Pa].
    groups : sequence of (law, cells)
        Flat indices of the cells of each law.
    """

    def __init__(self, matrix: Material, alone: FloatArray, groups: Sequence[tuple[Law, NDArray[np.intp]]]) -> None:
        self._alone, self._compliance = alone, compliance(matrix)
        self._size = 2.0 * matrix.shear_modulus
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
    ) -> tuple[FloatArray, list[Remembered]]:
        """Eigenstrain that each cell would take, the others as they are, and what it would then remember.

        Parameters
        ----------
        eigenstrain, stress, prestrain : (6, n)
            Of the cells as they are: eigenstrain [-], total stress [Pa], and eigenstrain of the cells' own.
        before, steps
            For each law: variables before the increment, and where and when it is asked.

        Raises
        ------
        NotConverged
            A cell without answer; its number and law are named.
        """
        foreign = stress - self._alone @ eigenstrain
        out, remembered = np.empty_like(eigenstrain), []
        for (law, cells), known, step in zip(self.groups, before, steps, strict=True):
            found, after = self._solve(law, foreign[:, cells], eigenstrain[:, cells], prestrain[:, cells], known, step)
            out[:, cells] = found
            remembered.append(after)
        return out, remembered

    def _solve(
        self,
        law: Law,
        foreign: FloatArray,
        start: FloatArray,
        prestrain: FloatArray,
        before: Mapping[str, FloatArray],
        step: Any,
    ) -> tuple[FloatArray, Remembered]:
        e = start.copy()
        response, residual = self._ask(law, foreign, e, prestrain, before, step)
        scale = np.maximum(np.linalg.norm(foreign, axis=0), self._size * np.linalg.norm(e, axis=0))
        scale += np.finfo(float).tiny
        for _ in range(_STEPS):
            error: FloatArray = np.sqrt(np.sum(residual * residual, axis=0))
            if np.all(error <= _ROUND_OFF * scale):
                return e, dict(response.variables)
            tangent = np.asarray(response.tangent)
            by_cell = tangent if tangent.ndim == 2 else np.moveaxis(tangent, 2, 0)
            jacobian = by_cell @ (self._compliance @ self._alone + np.eye(6)) - self._alone
            jacobian = np.broadcast_to(jacobian, (e.shape[1], 6, 6))
            change: FloatArray = -np.linalg.solve(jacobian, residual.T[..., None])[..., 0].T.astype(float)
            e, response, residual = self._shortened(law, foreign, e, change, error, prestrain, before, step)
        worst = int(np.argmax(np.linalg.norm(residual, axis=0) / scale))
        raise NotConverged(
            f"constitutive law {getattr(law, 'key', law)!r} found no stress for the strain of cell {worst} of "
            f"{e.shape[1]} in {_STEPS} steps; take smaller load steps"
        )

    def _shortened(
        self,
        law: Law,
        foreign: FloatArray,
        e: FloatArray,
        change: FloatArray,
        error: FloatArray,
        prestrain: FloatArray,
        before: Mapping[str, FloatArray],
        step: Any,
    ) -> tuple[FloatArray, Any, FloatArray]:
        """Newton's step, halved in the cells where it does not lower the residual."""
        part = np.ones(e.shape[1])
        for _ in range(_HALVINGS):
            trial = e + part * change
            response, residual = self._ask(law, foreign, trial, prestrain, before, step)
            worse = ~(np.linalg.norm(residual, axis=0) <= error)
            if not worse.any():
                break
            part = np.where(worse, 0.5 * part, part)
        return trial, response, residual

    def _ask(
        self,
        law: Law,
        foreign: FloatArray,
        e: FloatArray,
        prestrain: FloatArray,
        before: Mapping[str, FloatArray],
        step: Any,
    ) -> tuple[Any, FloatArray]:
        """Answer of the law to the strain under an eigenstrain, and how far its stress is from that of the cell."""
        stress = foreign + self._alone @ e
        response = law.update(self._compliance @ stress + e - prestrain, before, step)
        return response, np.asarray(response.stress) - stress
