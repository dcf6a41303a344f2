"""The kind *hardening law*: growth and motion of the yield surface with plastic strain."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

from eigencontact.core.arrays import FloatArray
from eigencontact.plugin.component import Component

__all__ = ["HardeningLaw", "IsotropicHardening", "KinematicHardening"]


class HardeningLaw(Component, ABC):
    """Hardening of a plastic law; derive from `IsotropicHardening` or `KinematicHardening`.

    Examples
    --------
    >>> import numpy as np
    >>> class Straight(IsotropicHardening):
    ...     key = "straight"
    ...     def flow_stress(self, p):
    ...         return 1e9 + 5e9 * p, 0 * p + 5e9
    >>> Straight().flow_stress(np.array([0.0, 0.1]))[0].tolist()
    [1000000000.0, 1500000000.0]
    """

    kind: ClassVar[str] = "hardening-law"

    def of_material(self, young_modulus: float) -> HardeningLaw:  # noqa: ARG002
        """Law in a material with this Young's modulus [Pa]; by default the law itself."""
        return self


class IsotropicHardening(HardeningLaw):
    """Size of the yield surface: flow stress as a function of the equivalent plastic strain.

    Examples
    --------
    >>> import numpy as np
    >>> class Perfect(IsotropicHardening):
    ...     key = "never-harder"
    ...     def flow_stress(self, p):
    ...         return 0 * p + 1e9, 0 * p
    >>> Perfect().flow_stress(np.zeros(2))[0].tolist()
    [1000000000.0, 1000000000.0]
    """

    @abstractmethod
    def flow_stress(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Yield stress, and its slope.

        Parameters
        ----------
        p : (n,)
            Equivalent plastic strain [-], zero or positive.

        Returns
        -------
        flow_stress, slope : (n,)
            Flow stress in uniaxial tension, positive, and its derivative by p, both [Pa]. The slope may be negative.
        """


class KinematicHardening(HardeningLaw):
    """Back-stress X, the centre of the yield surface.

    A plastic strain dε_p, with the equivalent strain dp, changes X to ``θ(dp) (X + (2/3) C dε_p)``.

    Attributes
    ----------
    modulus : float
        C [Pa], zero or positive; a field, or a property.

    Examples
    --------
    >>> import numpy as np
    >>> class Fading(KinematicHardening):
    ...     key, modulus = "fading", 20e9
    ...     def recall(self, dp):
    ...         stays = 1 / (1 + 100 * dp)
    ...         return stays, -100 * stays**2
    >>> Fading().recall(np.array([0.0, 0.01]))[0].tolist()
    [1.0, 0.5]
    """

    modulus: float

    @abstractmethod
    def recall(self, dp: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Remaining fraction of the back-stress, and its derivative.

        Parameters
        ----------
        dp : (n,)
            Increment of the equivalent plastic strain [-], zero or positive.

        Returns
        -------
        theta, slope : (n,)
            θ in (0, 1], 1 at dp = 0, and its derivative by dp.
        """
