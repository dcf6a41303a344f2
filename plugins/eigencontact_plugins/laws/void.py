"""No material: a void."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, LinearLaw, hook_for

__all__ = ["Void"]


@dataclass(frozen=True, kw_only=True)
class Void(LinearLaw):
    """Void: a region without material and stress."""

    key: ClassVar[str] = "void"
    references: ClassVar[tuple[str, ...]] = ("T. Mura 1987, Micromechanics of Defects in Solids, section 22",)
    isotropic: ClassVar[bool] = True
    words: ClassVar[str] = "nothing (a void)"

    def stiffness_matrix(self) -> FloatArray:
        """See `LinearLaw.stiffness_matrix`."""
        return np.zeros((6, 6))


eigencontact_register = hook_for(Void)
