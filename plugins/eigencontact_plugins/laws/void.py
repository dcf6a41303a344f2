"""No material: a void."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, LinearLaw, hookimpl

__all__ = ["Void"]


@dataclass(frozen=True, kw_only=True)
class Void(LinearLaw):
    """No material at all: it carries no stress."""

    key: ClassVar[str] = "void"
    references: ClassVar[tuple[str, ...]] = ("T. Mura 1987, Micromechanics of Defects in Solids, section 22",)
    isotropic: ClassVar[bool] = True

    def stiffness_matrix(self) -> FloatArray:
        """See `LinearLaw.stiffness_matrix`."""
        return np.zeros((6, 6))

    @property
    def words(self) -> str:
        """See `ConstitutiveLaw.words`."""
        return "nothing (a void)"


@hookimpl
def eigencontact_register() -> list[type[LinearLaw]]:
    """Register the void."""
    return [Void]
