"""The kind *geometry*: the initial separation of two surfaces."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar, Protocol, runtime_checkable

from eigencontact.core.arrays import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.plugin.component import Component

__all__ = ["Geometry", "HasNativeGrid", "HasReferencePressure"]


class Geometry(Component, ABC):
    """Separation of the two surfaces before loading, positive where there is a gap.

    Examples
    --------
    >>> import numpy as np
    >>> class Wedge(Geometry):
    ...     key = "wedge"
    ...     def separation(self, x, y):
    ...         return 0.1 * np.abs(x) + 0 * y
    >>> Wedge().separation(np.array([[-1.0, 0.0, 2.0]]), np.array([[0.0]])).tolist()
    [[0.1, 0.0, 0.2]]
    """

    kind: ClassVar[str] = "geometry"

    @abstractmethod
    def separation(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Separation h(x, y) [m] at points that broadcast against each other, e.g. ``(1, nx)`` and ``(ny, 1)``.

        The smallest value over the plane is 0 by convention for bodies of revolution (first touch at approach 0);
        a measured surface may have any datum.
        """


@runtime_checkable
class HasReferencePressure(Protocol):
    """Optional ability of a geometry: closed form of its frictionless elastic contact, for comparison."""

    def reference_pressure(
        self, x: FloatArray, y: FloatArray, normal_load: float, contact_modulus: float
    ) -> FloatArray:
        """Closed-form contact pressure [Pa] of this geometry alone, without tilt, at points that broadcast."""
        ...


@runtime_checkable
class HasNativeGrid(Protocol):
    """Optional ability of a geometry: the grid of its measurement, used with ``grid = "auto"``.

    The optional class attribute ``larger_window``, a phrase such as ``"measure a larger patch"``, is the remedy in the
    message about a contact at the edge of this grid.
    """

    def native_grid(self) -> Grid:
        """Grid of the measurement."""
        ...
