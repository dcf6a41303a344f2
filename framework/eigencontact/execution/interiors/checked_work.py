"""Work of prescribed eigenstrain on the functions of whole inhomogeneities, with refined quadrature rules."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.execution.routes.prescribed import PrescribedField
from eigencontact.execution.routes.subsurface import Subsurface
from eigencontact.model.regions import RegionLattice

if TYPE_CHECKING:
    from eigencontact.solvers.polynomial_inclusions import PolynomialInclusions

__all__ = ["CheckedWork"]

#: Numbers of points of the rules in each direction, relative to the first rule.
_FACTORS = (1.0, 1.5, 2.25, 3.5)
#: Accepted error of the eigenstrain, relative to the largest eigenstrain by this work.
_ACCEPTED = 1e-5


class CheckedWork:
    """Work of prescribed eigenstrain.

    A region with an edge close to an inhomogeneity needs more points. At the first load step with eigenstrain the rules
    are refined until two of them agree; the finer one is kept.

    Parameters
    ----------
    system : PolynomialInclusions
        System of the inhomogeneities; its rules are refined.
    subsurface : Subsurface
        Subsurface with prescribed eigenstrain.

    Attributes
    ----------
    present : (unknowns,)
        Work on every function [J].
    error : float
        Difference of the eigenstrain by the two finest rules, relative to the largest eigenstrain by this work alone.
    """

    def __init__(self, system: PolynomialInclusions, subsurface: Subsurface) -> None:
        self._system, self._subsurface = system, subsurface
        self._field = self._field_of_prescribed()
        self._checked = False
        self.present, self.error = np.zeros(system.size), 0.0

    def begin(self, time: float) -> None:
        """Set the time."""
        self.present = self._at(time)
        if not self._checked and self.present.any():
            self._check(time)

    def _check(self, time: float) -> None:
        self._checked = True
        system, zero_field = self._system, np.zeros_like(self.present)
        amplitudes = system.solve(self.present).amplitudes
        for factor in _FACTORS[1:]:
            before = amplitudes
            system.refine_rules(factor)
            self._field = self._field_of_prescribed()
            self.present = self._at(time)
            amplitudes = system.solve(self.present, start=before).amplitudes
            largest = system.difference(amplitudes, zero_field).max()
            self.error = float(system.difference(amplitudes, before).max() / largest) if largest else 0.0
            if self.error <= _ACCEPTED:
                break

    def _field_of_prescribed(self) -> PrescribedField:
        empty = np.empty(0)
        points = RegionLattice(
            target=(0, 0), origin=(0.0, 0.0), x=empty, y=empty, depths=empty, points=self._system.points.T.copy()
        )
        return self._subsurface.prescribed_field("stress", points)

    def _at(self, time: float) -> FloatArray:
        return self._system.moments(self._field.at(time).reshape(6, -1))
