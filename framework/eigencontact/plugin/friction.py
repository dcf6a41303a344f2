"""The kind *friction law*: the largest shear traction at a point of the contact."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.arrays import FloatArray
from eigencontact.plugin.answers import checked_answer
from eigencontact.plugin.component import Component
from eigencontact.plugin.materials import SUBSTRATE, only_substrate

__all__ = ["FrictionLaw", "FrictionState", "checked_shear_bound"]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FrictionState:
    """State of the contact that a friction law reads. Arrays are read-only.

    Attributes
    ----------
    pressure : (ny, nx) float64
        Contact pressure at the end of the present increment [Pa], compression positive, 0 out of contact.
    x : (1, nx) float64
        Centres of the cells along x [m].
    y : (ny, 1) float64
        Centres of the cells along y [m].
    slip_distance : (ny, nx) float64
        Slip distance of each point in contact, up to the start of the increment [m].
    time : float
        End of the increment, in load steps: 1 ends the first.
    material : (ny, nx) int, or (1, 1)
        Exposed material, a number of `materials`; 0 is the substrate.
    materials : tuple of str
        Names by number, if a law names materials (`NamesMaterials`) or surfaces wear.

    Examples
    --------
    >>> cells = np.zeros((2, 3))
    >>> state = FrictionState(pressure=cells + 1e9, x=cells, y=cells, slip_distance=cells, time=1.0)
    >>> state.materials
    ('substrate',)
    """

    pressure: FloatArray
    x: FloatArray
    y: FloatArray
    slip_distance: FloatArray
    time: float
    material: NDArray[np.intp] = field(default_factory=only_substrate)
    materials: tuple[str, ...] = (SUBSTRATE,)


class FrictionLaw(Component, ABC):
    """Largest shear traction at each point of the contact: the point slips at this bound and sticks below it.

    The law defines only the magnitude of the shear traction. The solver computes the stick zone, the slip, and the
    direction of the shear, which opposes the slip.

    Examples
    --------
    >>> class RunsIn(FrictionLaw):
    ...     key = "runs-in"
    ...     def shear_bound(self, state):
    ...         return (0.2 + 0.3 * np.exp(-state.slip_distance / 1e-6)) * state.pressure
    >>> fresh = np.zeros((1, 2))
    >>> state = FrictionState(pressure=fresh + 1e9, x=fresh, y=fresh, slip_distance=fresh, time=1.0)
    >>> RunsIn().shear_bound(state).tolist()
    [[500000000.0, 500000000.0]]
    """

    kind: ClassVar[str] = "friction-law"

    @abstractmethod
    def shear_bound(self, state: FrictionState) -> FloatArray:
        """Shear bound ``(ny, nx)`` [Pa]: finite, zero or positive.

        Values out of contact, where ``state.pressure`` is 0, are not used. The solver calls the law several times
        within an increment, with increasingly accurate pressures, so the law must not store anything: its history is in
        the state.
        """


def checked_shear_bound(law: FrictionLaw, state: FrictionState) -> FloatArray:
    """Shear bound of a law ``(ny, nx)`` [Pa], 0 out of contact; refused unless finite and not negative in contact.

    Raises
    ------
    PluginError
        A result of another shape, or with numbers that are negative or not finite.
    """
    loaded = state.pressure > 0
    bound = checked_answer(law, "shear_bound", "Pa", state, loaded, "points of the contact")
    return np.where(loaded, bound, 0.0)
