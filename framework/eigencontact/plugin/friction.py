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
        Contact pressure at the end of the increment that is being solved [Pa], compression positive, 0 out of contact.
    x : (1, nx) float64
        Centres of the cells along x [m].
    y : (ny, 1) float64
        Centres of the cells along y [m].
    slip_distance : (ny, nx) float64
        Length of the path that each point has slipped in contact, up to the start of the increment [m].
    time : float
        End of the increment, in load steps: 1 ends the first.
    material : (ny, nx) int, or (1, 1)
        What is exposed: a number of `materials`; 0 is the substrate.
    materials : tuple of str
        Names by number. They are told where a law names materials (`NamesMaterials`), or surfaces wear.

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

    The law sets the size of the shear traction alone. That slip and shear point in opposite directions, where the
    surfaces stick and how far they slip is found by the solver.

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

        Values out of contact, where ``state.pressure`` is 0, are not used. The law is asked several times within an
        increment, with better and better pressures, and must keep no memory of that: what it may remember is in the
        state.
        """


def checked_shear_bound(law: FrictionLaw, state: FrictionState) -> FloatArray:
    """Shear bound of a law ``(ny, nx)`` [Pa], 0 out of contact; refused unless finite and not negative in contact.

    Raises
    ------
    PluginError
        The law answers with another shape, with numbers that are not finite, or with negative ones.
    """
    loaded = state.pressure > 0
    bound = checked_answer(law, "shear_bound", "Pa", state, loaded, "points of the contact")
    return np.where(loaded, bound, 0.0)
