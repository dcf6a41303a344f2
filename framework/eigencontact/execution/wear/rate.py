"""Wear rate of a cycle in each cell: a part proportional to the pressure, and a constant part."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.plugin import WearLaw, WearState
from eigencontact.plugin.wear import checked_depth

__all__ = ["Rate", "energy_of", "filled", "quotient", "rate_of"]


#: Steps of both axes that mirror a field.
_MIRRORS = tuple((slice(None, None, y), slice(None, None, x)) for y in (1, -1) for x in (1, -1))
#: Relative change of pressure, shear and energy for the derivative of a law.
_NUDGE = 1e-4


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Rate:
    """Worn depth per cycle, or per increment.

    Attributes
    ----------
    pressed : (ny, nx)
        Depth per pressure [m/(Pa cycle)].
    steady : (ny, nx)
        Depth independent of the pressure [m/cycle].
    """

    pressed: FloatArray
    steady: FloatArray

    def depth(self, pressure: FloatArray) -> FloatArray:
        """Worn depth of one cycle under a pressure [m]."""
        return self.pressed * pressure + self.steady

    @property
    def nonzero(self) -> bool:
        """Whether the rate is nonzero in any cell."""
        return bool(self.pressed.any() or self.steady.any())


def rate_of(law: WearLaw, state: WearState) -> Rate:
    """Rate by a law: proportional to the pressure in cells with a final pressure, constant elsewhere."""
    depth, loaded = checked_depth(law, state), state.pressure > 0
    slope = quotient(depth, state.pressure, loaded)
    if not law.linear_in_pressure and depth.any():
        names = ("pressure", "shear", "energy")
        nudged = replace(state, **{name: (1.0 + _NUDGE) * getattr(state, name) for name in names})
        change = np.maximum(checked_depth(law, nudged) - depth, 0.0)
        # Beyond a threshold the wear grows faster than in proportion to the pressure. The slope is limited, so that no
        # lower pressure gives negative wear.
        slope = np.minimum(quotient(change, _NUDGE * state.pressure, loaded), slope)
        return filled(Rate(pressed=slope, steady=np.maximum(depth - slope * state.pressure, 0.0)), loaded)
    return filled(Rate(pressed=slope, steady=np.where(loaded, 0.0, depth)), loaded)


def filled(rate: Rate, loaded: NDArray[np.bool_]) -> Rate:
    """Rate with the pressure-proportional part also in cells without contact: that of the nearest cell in contact."""
    return replace(rate, pressed=_nearest(rate.pressed, loaded))


def energy_of(added: FloatArray, depth: FloatArray, energy: FloatArray, cycles: float) -> FloatArray:
    """Work of friction [J/m²] for an added worn depth.

    Parameters
    ----------
    added : (ny, nx)
        Depth [m].
    depth, energy : (ny, nx)
        Worn depth and friction work of a solved cycle. Their ratio is constant; cells without wear have the energy
        itself.
    cycles : float
        Number of cycles of the added depth.
    """
    worn = depth > 0
    ratio = _nearest(quotient(energy, depth, worn), worn)
    return np.where(worn | (added > 0), ratio * added, cycles * energy)


def quotient(values: FloatArray, by: FloatArray, where: NDArray[np.bool_]) -> FloatArray:
    """Quotient at some cells, 0 elsewhere."""
    return np.divide(values, by, out=np.zeros_like(values), where=where)


def _nearest(values: FloatArray, valid: NDArray[np.bool_]) -> FloatArray:
    """Values with those of the nearest valid cell in all other cells.

    Of several cells at the same distance the search takes one by its order. The mean over the mirrored fields makes the
    result of a symmetric field symmetric.
    """
    if valid.all() or not valid.any():
        return values
    from scipy.ndimage import distance_transform_edt

    mirrored = []
    for mirror in _MIRRORS:
        rows, columns = distance_transform_edt(~valid[mirror], return_distances=False, return_indices=True)
        mirrored.append(values[mirror][rows, columns][mirror])
    return np.asarray(0.25 * ((mirrored[0] + mirrored[3]) + (mirrored[1] + mirrored[2])))
