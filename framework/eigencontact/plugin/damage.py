"""The kind *damage law*: the part of its stiffness that a material has lost."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin.component import Component

__all__ = ["DamageLaw", "PlasticDamage"]

FloatArray = NDArray[np.float64]


class DamageLaw(Component, ABC):
    """Stiffness is ``(1 - D)`` times that of the sound material; see `PlasticDamage` for what D follows from."""

    kind: ClassVar[str] = "damage-law"


class PlasticDamage(DamageLaw):
    """Damage by plastic strain."""

    @abstractmethod
    def damage(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Damage and its slope.

        Parameters
        ----------
        p : (n,)
            Equivalent plastic strain [-], zero or positive.

        Returns
        -------
        D, slope : (n,)
            D in [0, 1), zero at p = 0, never falling, and its derivative by p.
        """
