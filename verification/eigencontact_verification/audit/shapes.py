"""Shapes of a scene as finite elements see them: what a later inclusion takes, what wear took off, which moduli."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from eigencontact.core.material import Material

__all__ = ["NotJudged", "Part", "moduli_of"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Triple = tuple[float, float, float]

#: Young's modulus of a void, in that of the body: enough to be nothing, and a system that can be solved.
VOID = 1e-6


class NotJudged(Exception):
    """Something that no finite-element model of ours stands for; its text is the reason."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Part:
    """Places of a region: its shape, without later ones, risen by what is worn off above it.

    A dataclass and no closure, because cases are sent to other processes.

    Attributes
    ----------
    shape : object
        With ``contains(x, y, z)`` and ``bounds``.
    later : tuple of object
        Shapes that take their room from this one.
    worn : (ny, nx) float64 or None
        Depth that is worn off [m].
    edges : (x, y)
        Edges of the cells of `worn`.
    """

    shape: Any
    later: tuple[Any, ...] = ()
    worn: FloatArray | None = None
    edges: tuple[FloatArray, FloatArray] | None = None

    def __call__(self, x: FloatArray, y: FloatArray, z: FloatArray) -> BoolArray:
        """Whether points lie in the region."""
        x, y, z = np.broadcast_arrays(x, y, z)
        if self.worn is not None and self.edges is not None:
            column = np.clip(np.searchsorted(self.edges[0], x) - 1, 0, self.worn.shape[1] - 1)
            row = np.clip(np.searchsorted(self.edges[1], y) - 1, 0, self.worn.shape[0] - 1)
            z = z + self.worn[row, column]
        inside = np.asarray(self.shape.contains(x, y, z), dtype=bool)
        for other in self.later:
            inside = inside & ~np.asarray(other.contains(x, y, z), dtype=bool)
        return inside

    @property
    def bounds(self) -> tuple[Triple, Triple]:
        """Box around the region, below the surface."""
        low, high = (tuple(float(value) for value in corner) for corner in self.shape.bounds)
        risen = 0.0 if self.worn is None else float(self.worn.max())
        top = max(low[2] - risen, 0.0)
        if top < 1e-9 * (high[2] - low[2]):
            top = 0.0
        return (low[0], low[1], top), (high[0], high[1], high[2])


def moduli_of(law: Any, body: Material) -> tuple[float, float]:
    """Young's modulus [Pa] and Poisson's ratio of a law where it is elastic; nearly no modulus of a void.

    Raises
    ------
    NotJudged
        A law that is not isotropic, differs from place to place, or closes its cracks.
    """
    from eigencontact.plugin import LinearLaw

    if law.varies:
        raise NotJudged(f"the law {getattr(law, 'key', '')!r} differs from place to place")
    if getattr(law, "crack_closure", False):
        raise NotJudged(f"the law {law.key!r} closes its cracks, which is no factor of the stiffness")
    if isinstance(law, LinearLaw):
        stiffness = np.asarray(law.stiffness_matrix(), dtype=float)
        if not law.isotropic:
            raise NotJudged(f"the law {law.key!r} is not isotropic")
        twice_shear, lame = float(stiffness[3, 3]), float(stiffness[0, 1])
        if twice_shear == 0.0:
            return VOID * body.young_modulus, body.poisson_ratio
        nu = lame / (2.0 * lame + twice_shear)
        return twice_shear * (1.0 + nu), nu
    told = getattr(law, "young_modulus", None), getattr(law, "poisson_ratio", None)
    if told[0] is None or told[1] is None:
        raise NotJudged(f"the law {law.key!r} does not tell its elastic constants")
    return float(told[0]), float(told[1])
