"""Elasticity given as a matrix."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import Component, LinearLaw, Stress, checked_stiffness, hookimpl

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["GivenStiffness"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class GivenStiffness(LinearLaw):
    """Any elasticity, in scene axes.

    Parameters
    ----------
    stiffness : (6, 6)
        Mandel stiffness [Pa] (rows and columns xx, yy, zz, √2 yz, √2 xz, √2 xy: the shear entries of a Voigt matrix
        times 2, its mixed ones times √2): symmetric, without negative eigenvalues; zero is a void.
    """

    key: ClassVar[str] = "stiffness"
    references: ClassVar[tuple[str, ...]] = ("M. M. Mehrabadi, S. C. Cowin 1990, Q. J. Mech. Appl. Math. 43, 15",)

    stiffness: tuple[tuple[Stress, ...], ...]

    def __post_init__(self) -> None:
        ragged = len({len(row) for row in self.stiffness}) > 1
        given = checked_stiffness(self.key, "stiffness", [[0.0]] if ragged else self.stiffness)
        object.__setattr__(self, "stiffness", tuple(map(tuple, given.tolist())))

    def stiffness_matrix(self) -> FloatArray:
        """See `LinearLaw.stiffness_matrix`."""
        return np.array(self.stiffness)


@hookimpl
def eigencontact_register() -> Iterable[type[Component]]:
    """Register elasticity given as a matrix."""
    return [GivenStiffness]
