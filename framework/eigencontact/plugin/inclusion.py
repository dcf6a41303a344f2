"""The kinds *inclusion shape* and *eigenstrain field*: region and value of the stress-free strain."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.arrays import FloatArray
from eigencontact.plugin.component import Component

__all__ = ["EigenstrainField", "InclusionShape"]

Point = tuple[float, float, float]


class InclusionShape(Component, ABC):
    """A bounded region of the body, z >= 0, that may carry an eigenstrain.

    A shape defines two members; the framework then divides the region into cuboids with volume fractions. With ``phi``
    and ``psi`` (`HasPotentials`) the field of a uniform eigenstrain is exact; ``chi`` (`HasMirrorPotential`) and
    ``far_field`` (`HasFarField`) make it faster and more accurate at a distance. The framework computes displacement,
    strain and stress, and handles the free surface, grids and materials.

    Examples
    --------
    >>> class Bar(InclusionShape):
    ...     key, references = "bar", ("elementary",)
    ...     bounds = ((-1.0, -1.0, 2.0), (1.0, 1.0, 3.0))
    ...     def contains(self, x, y, z):
    ...         return (np.abs(x) <= 1) & (np.abs(y) <= 1) & (np.abs(z - 2.5) <= 0.5)
    >>> from eigencontact import inclusion_field
    >>> steel = {"young_modulus": 210e9, "poisson_ratio": 0.3}
    >>> bool(inclusion_field(Bar(), 1e-3 * np.eye(3), [[0, 0, 0]], **steel)[0, 2] < 0)  # it lifts the surface
    True
    """

    kind: ClassVar[str] = "inclusion-shape"

    @property
    def method(self) -> str:
        """Method of the potentials in the text of `explain`; a class attribute is enough."""
        return "closed form"

    @property
    @abstractmethod
    def bounds(self) -> tuple[Point, Point]:
        """Lowest and highest coordinates ``((x, y, z), (x, y, z))`` of the region [m], as tight as is easy."""

    @abstractmethod
    def contains(self, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie in the region; x, y, z [m] broadcast against each other."""


class EigenstrainField(Component, ABC):
    """Eigenstrain (stress-free strain) as a function of place and time.

    Attributes
    ----------
    uniform : bool
        Class attribute; True if the value does not depend on the position, so that a shape with potentials needs no
        cells.

    Examples
    --------
    >>> class Swelling(EigenstrainField):
    ...     key, references = "swelling", ("elementary",)
    ...     def eigenstrain(self, x, y, z, time):
    ...         x, y, z = np.broadcast_arrays(x, y, z)
    ...         return np.array([1e-3 * np.exp(-z)] * 3 + [0 * z] * 3)
    >>> Swelling().eigenstrain(np.zeros(2), 0.0, np.array([0.0, 1.0]), 1.0).shape
    (6, 2)
    """

    kind: ClassVar[str] = "eigenstrain-field"
    uniform: ClassVar[bool] = False

    @abstractmethod
    def eigenstrain(self, x: FloatArray, y: FloatArray, z: FloatArray, time: float) -> FloatArray:
        """Mandel eigenstrain ``(6, ...)`` [-] at points [m] that broadcast; `time` counts load steps: 1 ends the first.

        Expansion is positive. ``yz, xz, xy`` carry a factor sqrt(2) over the tensor components (`COMPONENTS`).
        """

    @property
    def varies(self) -> bool:
        """Whether the value changes with time."""
        return False
