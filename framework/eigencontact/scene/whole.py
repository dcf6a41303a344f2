"""How whole inhomogeneities are resolved: by the degree of a polynomial."""

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
    """What ``"whole"`` stands for: degree 0."""
    return {"whole": 0} if value == "whole" else value


class Whole(Table):
    """Inhomogeneities as wholes, each with an eigenstrain that is a polynomial.

    Parameters
    ----------
    whole : int or "auto"
        Degree of the polynomial, 0 for a uniform eigenstrain; ``"auto"`` takes for each the least whose foretold error
        is within `error`.
    error : float, optional
        Error of the stress in them that is allowed, in parts of what the load causes there: ``"auto"`` aims at 0.001 by
        default; a degree that misses the error that is given is refused.
    """

    whole: Literal["auto"] | Annotated[int, AfterValidator(in_range(0, HIGHEST_DEGREE, "[-]"))]
    error: Annotated[float, AfterValidator(in_range(1e-8, 0.5, "[-]"))] | None = None

    @property
    def is_asked(self) -> bool:
        """Whether an error is asked for: given, or the one that ``"auto"`` aims at."""
        return self.whole == "auto" or self.error is not None

    @property
    def allowed(self) -> float:
        """Error that is asked for."""
        return _ALLOWED if self.error is None else self.error
