"""The kind *damage law*: the lost fraction of the stiffness of a material."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.core.arrays import FloatArray
from eigencontact.core.quantities import Length
from eigencontact.errors import require
from eigencontact.plugin.component import Component

__all__ = ["DamageLaw", "PlasticDamage", "StrainDamage"]


@dataclass(frozen=True, kw_only=True)
class DamageLaw(Component, ABC):
    """Damage law: the stiffness is ``(1 - D)`` times that of the undamaged material, with D of a non-decreasing number.

    The number is the equivalent plastic strain for a `PlasticDamage` law, and the largest equivalent strain so far for
    a `StrainDamage` law. A law for both derives from both classes.

    Parameters
    ----------
    length : float, optional
        Radius [m] of the average of the number, of which D is a function; without it D follows from the number at the
        point.

    Examples
    --------
    >>> class Sudden(StrainDamage):
    ...     key = "sudden"
    ...     def damage(self, driven):
    ...         late = np.maximum(driven - 1e-3, 0)
    ...         return 1 - np.exp(-late / 1e-3), np.where(late > 0, np.exp(-late / 1e-3) / 1e-3, 0)
    >>> Sudden().damage(np.array([1e-3, 2e-3]))[0].round(3).tolist()
    [0.0, 0.632]
    """

    kind: ClassVar[str] = "damage-law"

    length: Length | None = None

    @abstractmethod
    def damage(self, driven: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Damage and its slope.

        Parameters
        ----------
        driven : (n,)
            Number that drives the damage [-], zero or positive.

        Returns
        -------
        D, slope : (n,)
            D in [0, 1), zero at 0, never falling, and its derivative.
        """

    def averaged(self, name: str) -> dict[str, float]:
        """`ConstitutiveLaw.averaged` of a material whose variable `name` drives the damage.

        Raises
        ------
        SceneError
            An invalid length.
        """
        if self.length is None:
            return {}
        require(0 < self.length < np.inf, self.key, "length", self.length, "positive and finite [m]")
        return {name: self.length}


class PlasticDamage(DamageLaw):
    """Damage by plastic strain: the argument of `DamageLaw.damage` is the equivalent plastic strain.

    Examples
    --------
    >>> class Steady(PlasticDamage):
    ...     key = "steady"
    ...     def damage(self, driven):
    ...         return np.minimum(2 * driven, 0.5), np.where(driven < 0.25, 2.0, 0.0)
    >>> Steady().damage(np.array([0.1, 0.9]))[0].tolist()
    [0.2, 0.5]
    """


class StrainDamage(DamageLaw):
    """Damage by strain: the argument of `DamageLaw.damage` is the largest equivalent strain so far.

    D is zero up to a positive strain: the material is elastic below it.

    Examples
    --------
    >>> class Brittle(StrainDamage):
    ...     key = "brittle-once"
    ...     def damage(self, driven):
    ...         beyond = driven > 1e-3
    ...         late = np.where(beyond, driven, 1e-3)
    ...         return 1 - 1e-3 / late, np.where(beyond, 1e-3 / late**2, 0.0)
    >>> Brittle().damage(np.array([5e-4, 2e-3]))[0].tolist()
    [0.0, 0.5]
    """
