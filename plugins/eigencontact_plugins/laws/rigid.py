"""Material without strain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, LinearLaw, SceneError, hook_for

__all__ = ["Rigid"]


@dataclass(frozen=True, kw_only=True)
class Rigid(LinearLaw):
    """Rigid material: no strain except the prestrain; the surrounding body may translate and rotate it.

    The stress inside rigid cells is less accurate than their effect on the surrounding body, because of the stepped
    boundary of the cells.
    """

    key: ClassVar[str] = "rigid"
    references: ClassVar[tuple[str, ...]] = ("T. Mura 1987, Micromechanics of Defects in Solids, section 22",)
    isotropic: ClassVar[bool] = True
    words: ClassVar[str] = "a rigid material"

    def stiffness_matrix(self) -> FloatArray:
        """Infinite; see `LinearLaw.stiffness_matrix`."""
        raise SceneError(f"{self.key} must be used by its factors, because its stiffness is infinite")

    def factors(self, shear_modulus: float) -> tuple[FloatArray, FloatArray]:  # noqa: ARG002
        """See `LinearLaw.factors`."""
        return np.zeros((6, 6)), np.eye(6)


eigencontact_register = hook_for(Rigid)
