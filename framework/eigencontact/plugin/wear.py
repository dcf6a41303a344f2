"""The kind *wear law*: the depth that the surfaces lose by sliding."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.arrays import FloatArray
from eigencontact.plugin.answers import checked_answer
from eigencontact.plugin.component import Component
from eigencontact.plugin.materials import SUBSTRATE

__all__ = ["WearLaw", "WearState", "checked_depth"]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class WearState:
    """State of the contact that a wear law reads, of one load increment or one whole cycle. Arrays are read-only.

    Attributes
    ----------
    pressure : (ny, nx) float64
        Contact pressure [Pa] at its end, compression positive, 0 out of contact.
    shear : (ny, nx) float64
        Magnitude of the shear traction at its end [Pa]; 0 without friction.
    slip : (ny, nx) float64
        Length of the path slipped in it [m].
    slip_amplitude : (ny, nx) float64
        Quarter of that path in a cycle [m]: half of the way from one end of it to the other, there and back. 0 outside
        of cycles.
    energy : (ny, nx) float64
        Work of friction in it [J/m²]; 0 without friction.
    worn_depth : (ny, nx) float64
        Depth that both bodies together have lost before [m].
    total_energy : (ny, nx) float64
        Work of friction of all that came before, skipped cycles included [J/m²].
    material : (ny, nx) int
        What is exposed: a number of `materials`; 0 is the substrate.
    materials : tuple of str
        Names by number.
    x, y : (1, nx), (ny, 1) float64
        Centres of the cells [m].
    time : float
        Its end, in load steps with all cycles written out.

    Examples
    --------
    >>> one = np.ones((1, 1))
    >>> state = WearState(
    ...     pressure=1e9 * one, shear=np.ones((2, 1, 1)), slip=1e-6 * one, slip_amplitude=one, energy=one,
    ...     worn_depth=0 * one, total_energy=0 * one, material=one.astype(int), x=one, y=one, time=1.0,
    ... )
    >>> (1e-13 * state.pressure * state.slip).tolist()  # Archard's law
    [[1e-10]]
    """

    pressure: FloatArray
    shear: FloatArray
    slip: FloatArray
    slip_amplitude: FloatArray
    energy: FloatArray
    worn_depth: FloatArray
    total_energy: FloatArray
    material: NDArray[np.intp]
    x: FloatArray
    y: FloatArray
    time: float
    materials: tuple[str, ...] = (SUBSTRATE,)


class WearLaw(Component, ABC):
    """Worn depth of both bodies together by an increment or a cycle of sliding; the scene sets their shares.

    Attributes
    ----------
    linear_in_pressure : bool
        Whether the depth is in proportion to pressure, shear and energy together, at the slip that there was: the
        update of the surface is then implicit as it is. Of other laws the derivative is taken by a small change.
    needs_friction : bool
        Whether it looks at shear or energy: without friction there are none.
    needs_cycles : bool
        Whether it looks at the slip amplitude: only a cycle has one.

    Examples
    --------
    >>> class ByWork(WearLaw):
    ...     key, needs_friction = "by-work", True
    ...     def depth(self, state):
    ...         return state.energy / 1e13
    >>> one = np.ones((1, 1))
    >>> state = WearState(
    ...     pressure=one, shear=np.ones((2, 1, 1)), slip=one, slip_amplitude=one, energy=2e6 * one, worn_depth=0 * one,
    ...     total_energy=0 * one, material=one.astype(int), x=one, y=one, time=1.0,
    ... )
    >>> ByWork().depth(state).tolist()
    [[2e-07]]
    """

    kind: ClassVar[str] = "wear-law"
    linear_in_pressure: ClassVar[bool] = False
    needs_friction: ClassVar[bool] = False
    needs_cycles: ClassVar[bool] = False

    @abstractmethod
    def depth(self, state: WearState) -> FloatArray:
        """Worn depth ``(ny, nx)`` [m] of this increment or cycle: finite, zero or positive.

        The law must keep no memory: what it may remember is in the state. Cells out of contact through all of it have
        no slip and no energy in the state.
        """

    @property
    def volume_per_energy(self) -> float | None:
        """Worn volume per work of friction [m³/J] of a law with a constant ratio; else None."""
        return None


def checked_depth(law: WearLaw, state: WearState) -> FloatArray:
    """Worn depth of a law ``(ny, nx)`` [m]; refused unless finite and not negative.

    Raises
    ------
    PluginError
        The law answers with another shape, with numbers that are not finite, or with negative ones.
    """
    return checked_answer(law, "depth", "m", state, np.ones(state.pressure.shape, dtype=bool), "cells")
