"""How whole inhomogeneities are resolved: by the degree of a polynomial."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator

from eigencontact.scene.checks import in_range
from eigencontact.scene.table import Table

__all__ = ["HIGHEST_DEGREE", "Whole"]

#: Degree up to which potentials of polynomials keep their digits and matrices stay small (582 unknowns each).
HIGHEST_DEGREE = 12


class Whole(Table):
    """Inhomogeneities as wholes, each with an eigenstrain that is a polynomial.

    Parameters
    ----------
    whole : int or "auto"
        Degree of the polynomial; ``"auto"`` takes for each the least whose foretold error is within `error`.
    error : float
        Error of the stress in them that is allowed, in parts of what the load causes there.
    """

    whole: Literal["auto"] | Annotated[int, AfterValidator(in_range(0, HIGHEST_DEGREE, "[-]"))]
    error: Annotated[float, AfterValidator(in_range(1e-8, 0.5, "[-]"))] = 1e-3

    @property
    def is_asked(self) -> bool:
        """Whether an error is asked for: given, or the one that ``"auto"`` aims at."""
        return self.whole == "auto" or "error" in self.model_fields_set
