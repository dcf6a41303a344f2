"""No material: a void."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import Component, LinearLaw, hookimpl

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["Void"]

FloatArray = NDArray[np.float64]


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
def eigencontact_register() -> Iterable[type[Component]]:
    """Register the void."""
    return [Void]
