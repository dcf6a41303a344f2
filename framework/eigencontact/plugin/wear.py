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
        Slip distance in it [m].
    slip_amplitude : (ny, nx) float64
        Quarter of the slip distance of a cycle [m], half of the range of a reciprocating slip. 0 outside of cycles.
    energy : (ny, nx) float64
        Work of friction in it [J/m²]; 0 without friction.
    worn_depth : (ny, nx) float64
        Worn depth of both bodies together before it [m].
    total_energy : (ny, nx) float64
        Work of friction of all earlier increments, with skipped cycles [J/m²].
    material : (ny, nx) int
        Exposed material, a number of `materials`; 0 is the substrate.
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
        True if the depth is proportional to pressure, shear and energy together at constant slip: the update of the
        surface is then implicit. For other laws the solver computes the derivative by finite differences.
    needs_friction : bool
        True if the law uses shear or energy, which need friction.
    needs_cycles : bool
        True if the law uses the slip amplitude, which needs cycles.

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

        The law must not store anything: its history is in the state. Cells that are always out of contact have zero
        slip and energy in the state.
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
        A result of another shape, or with numbers that are negative or not finite.
    """
    return checked_answer(law, "depth", "m", state, np.ones(state.pressure.shape, dtype=bool), "cells")
