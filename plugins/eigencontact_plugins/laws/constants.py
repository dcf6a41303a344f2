"""Isotropic constants of a law, by default those of the body."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from eigencontact.plugin import ConstitutiveLaw, SceneError, Stress, require

__all__ = ["BodyConstants"]


@dataclass(frozen=True, kw_only=True)
class BodyConstants(ConstitutiveLaw):
    """Base of isotropic laws with the constants of the body by default.

    Parameters
    ----------
    young_modulus, poisson_ratio : float, optional
        E [Pa], positive and finite, and ν [-] in (-1, 0.5); by default those of the body.
    """

    isotropic: ClassVar[bool] = True

    young_modulus: Stress | None = None
    poisson_ratio: float | None = None

    def __post_init__(self) -> None:
        E, nu = self.young_modulus, self.poisson_ratio
        require(E is None or 0 < E < np.inf, self.key, "young_modulus", E, "positive and finite [Pa]")
        require(nu is None or -1 < nu < 0.5, self.key, "poisson_ratio", nu, "in (-1, 0.5) [-]")

    def of_body(self, young_modulus: float, poisson_ratio: float) -> Self:
        """See `ConstitutiveLaw.of_body`."""
        return replace(
            self,
            young_modulus=young_modulus if self.young_modulus is None else self.young_modulus,
            poisson_ratio=poisson_ratio if self.poisson_ratio is None else self.poisson_ratio,
        )

    @property
    def _young_and_poisson(self) -> tuple[float, float]:
        """E [Pa] and ν [-]; refuses a law without its own constants and without a body."""
        E, nu = self.young_modulus, self.poisson_ratio
        if E is None or nu is None:
            name = "young-modulus" if E is None else "poisson-ratio"
            raise SceneError(f"{self.key}.{name} must be given (got none), or the law must be used in a body")
        return E, nu
