"""Growth of the contact radius with load and approach, for increments of equal size in the radius.

For a gap with the mean h̄(r) over the directions around the middle of the contact, on a homogeneous half-space:

    approach(a) = a ∫_0^{π/2} h̄'(a sin θ) dθ
    load(a)     ∝ a² ∫_0^{π/2} h̄'(a sin θ) sin²θ dθ

For a sphere these are proportional to a² and a³, for a cone to a and a². In a line contact ``load(a) ∝ a ∫_0^{π/2}
h̄'(a sin θ) sin θ dθ``, proportional to a² for a cylinder. The approach of a line contact depends on a reference depth;
the approach of bodies of revolution is used instead. This accuracy suffices for increments: layers, eigenstrain and
yielding make them somewhat unequal, not wrong.

References
----------
I. N. Sneddon 1965, doi:10.1016/0020-7225(65)90019-4.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.solvers.contact_estimate import ContactEstimate
from eigencontact.solvers.control import Control

__all__ = ["ContactGrowth", "contact_growth"]

Separation = Callable[[FloatArray, FloatArray], FloatArray]

#: Number of radii in the table, ratio of the smallest to the largest, and number of directions with an increasing gap.
_RADII, _SMALLEST, _DIRECTIONS = 64, 1e-3, 12
#: Relative step of a difference quotient in the radius: exact for parabolas, equal relative error for any power.
_STEP = 1e-2
#: Decrease of the gap along a ray, relative to its rise at the largest radius, that counts as round-off.
_FLAT = 1e-9
#: Points per side of each square in the search for the smallest gap; ratio of the sizes of successive squares.
_PLACES, _SQUARES = 17, 7


@dataclass(frozen=True, slots=True)
class ContactGrowth:
    """Radii of a growing contact, and the loads and approaches at these radii.

    Attributes
    ----------
    radius : (n,)
        Contact radii, increasing [m].
    normal_load, approach : (n,)
        Loads [N] and approaches [m] at these radii.
    """

    radius: FloatArray
    normal_load: FloatArray
    approach: FloatArray

    def parts(
        self, control: Literal["normal_load", "approach"], begin: float, end: float, count: int
    ) -> tuple[float, ...]:
        """Ends of `count` increments of a ramp of load or approach, equal in the contact radius.

        Parameters
        ----------
        control : {"normal_load", "approach"}
            Prescribed quantity of the ramp.
        begin, end : float
            Values at the start and at the end [N] or [m].
        count : int
            Number of increments.

        Returns
        -------
        tuple of float
            Increasing values in (0, 1], the last 1; equal increments of the load itself if the radius is constant.

        Examples
        --------
        >>> radius = np.geomspace(1e-3, 1.0, 50)
        >>> growth = ContactGrowth(radius, 8.0 * radius**3, radius**2)
        >>> [round(fraction, 6) for fraction in growth.parts("normal_load", 0.0, 8.0, 2)]
        [0.125, 1.0]
        """
        samples: FloatArray = getattr(self, control)
        growing = samples > _FLAT**2 * samples[-1]
        samples, radius = np.log(samples[growing]), np.log(self.radius[growing])
        least = 0.0 if growing[0] else float(np.exp(radius[0]))

        def radius_at(value: float) -> float:
            return least if value <= 0.0 else float(np.exp(np.interp(np.log(value), samples, radius)))

        start, stop = radius_at(begin), radius_at(end)
        radii = start + (stop - start) * np.arange(count + 1) / count
        values = np.exp(np.interp(np.log(np.maximum(radii, np.exp(radius[0]) * _FLAT)), radius, samples))
        values[radii <= least] = 0.0
        ends = (values - begin) / (end - begin) if start != stop else radii
        if start == stop or np.any(np.diff(ends) <= 0.0):
            ends = np.arange(count + 1) / count
        return (*ends[1:-1].tolist(), 1.0)


def contact_growth(
    separation: Separation, contact: ContactEstimate, control: Control, grid: Grid | None = None
) -> ContactGrowth | None:
    """Growth of a contact with a gap that increases in all directions from one point; otherwise None.

    Parameters
    ----------
    separation : callable
        Gap [m] at points (x, y) [m].
    contact : ContactEstimate
        Largest contact of the load history.
    control : Control
        Control of the largest contact.
    grid : Grid, optional
        Cells of the window; strips make a line contact with two directions.
    """
    line = grid is not None and 1 not in grid.bounded_axes
    wide, high = contact.extent
    middle = _lowest(separation, contact)
    end = 0.5 * np.sqrt(wide * high)
    angles = np.array([0.0, np.pi]) if line else 2.0 * np.pi * (np.arange(_DIRECTIONS) + 0.5) / _DIRECTIONS

    def gap(r: FloatArray) -> FloatArray:
        """Gap relative to the middle along each direction, ``(directions, *r.shape)``."""
        turns = np.cos(angles), np.sin(angles)
        x, y = (at + np.multiply.outer(turn, r) for at, turn in zip(middle, turns, strict=True))
        return np.asarray(separation(x, y), dtype=float)

    radius = end * np.geomspace(_SMALLEST, 1.0, _RADII)
    along = gap(np.array([0.0, *radius]))
    rise = np.diff(along, axis=1)
    if not np.all(np.isfinite(along)) or np.any(rise < -_FLAT * np.ptp(along)) or np.all(rise <= 0.0):
        return None
    nodes, weights = np.polynomial.legendre.leggauss(32)
    theta, weights = 0.25 * np.pi * (nodes + 1.0), 0.25 * np.pi * weights
    at = np.multiply.outer(radius, np.sin(theta))
    slope = np.mean(gap(at * (1.0 + _STEP)) - gap(at * (1.0 - _STEP)), axis=0) / (2.0 * _STEP * at)
    approach = radius * (slope @ weights)
    load = (
        radius * (slope @ (weights * np.sin(theta))) if line else radius**2 * (slope @ (weights * np.sin(theta) ** 2))
    )
    if np.any(np.diff(approach) < 0.0) or np.any(np.diff(load) < 0.0):
        return None
    scale = 1.0 if control.normal_load is None else control.normal_load / float(load[-1])
    return ContactGrowth(radius, scale * load, approach)


def _lowest(separation: Separation, contact: ContactEstimate) -> tuple[float, float]:
    """Position (x, y) [m] of the smallest gap in a contact; of several, the one nearest to the centre."""
    x, y = 0.5 * (contact.x0 + contact.x1), 0.5 * (contact.y0 + contact.y1)
    wide, high = (0.5 * extent for extent in contact.extent)
    steps = np.linspace(-1.0, 1.0, _PLACES)
    distance = np.hypot(steps[:, None], steps)
    for _ in range(_SQUARES):
        gap = np.asarray(separation(x + wide * steps, (y + high * steps)[:, None]), dtype=float)
        lowest = np.where(gap <= np.min(gap), distance, np.inf)
        j, i = np.unravel_index(int(np.argmin(lowest)), gap.shape)
        x, y = x + wide * float(steps[i]), y + high * float(steps[j])
        wide, high = 2.0 * wide / (_PLACES - 1), 2.0 * high / (_PLACES - 1)
    return x, y
