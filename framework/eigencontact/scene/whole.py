"""Degree of the polynomial of whole inhomogeneities."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator

from eigencontact.scene.checks import in_range
from eigencontact.scene.table import Table

__all__ = ["HIGHEST_DEGREE", "Whole", "uniform_or_given"]

#: Degree up to which potentials of polynomials keep their digits and matrices stay small (582 unknowns each).
HIGHEST_DEGREE = 12
#: Error that ``"auto"`` aims at where none is given.
_ALLOWED = 1e-3


def uniform_or_given(value: object) -> object:
    """Convert ``"whole"`` to degree 0."""
    return {"whole": 0} if value == "whole" else value


class Whole(Table):
    """Whole inhomogeneities, each with one polynomial eigenstrain.

    Parameters
    ----------
    whole : int or "auto"
        Degree of the polynomial, 0 for a uniform eigenstrain; ``"auto"`` chooses for each region the smallest degree
        whose predicted error is within `error`.
    error : float, optional
        Largest error of the stress in the regions, relative to the stress by the load: 0.001 by default for ``"auto"``.
        The program refuses a degree that does not reach a prescribed error.
    """

    whole: Literal["auto"] | Annotated[int, AfterValidator(in_range(0, HIGHEST_DEGREE, "[-]"))]
    error: Annotated[float, AfterValidator(in_range(1e-8, 0.5, "[-]"))] | None = None

    @property
    def is_asked(self) -> bool:
        """Whether there is an allowed error: prescribed, or the default of ``"auto"``."""
        return self.whole == "auto" or self.error is not None

    @property
    def allowed(self) -> float:
        """Allowed error."""
        return _ALLOWED if self.error is None else self.error
