"""Largest damage parameter of a region, evaluated only at points that can have the largest value."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray, IntArray
from eigencontact.core.arrays import real_answer
from eigencontact.core.parallel import in_parallel
from eigencontact.errors import PluginError
from eigencontact.execution.fields.critical_distance import value_near
from eigencontact.execution.fields.stress_cycle import CycleOfRegion
from eigencontact.plugin.fatigue import FatigueCriterion, HasUpperBound, StressCycle, checked_damage
from eigencontact.scene.fatigue import CriticalDistance

__all__ = ["largest_first", "utilisation_of"]

#: Points at least whose stress is read, and whose bounds are computed, at once: their arrays fit the cache.
_PART = 1_200
#: Points with the largest bounds that are evaluated first, and the growth of the parts that follow.
_FIRST, _GROWTH = 16, 4
#: Round-off of a bound and of a damage parameter, as a part.
_ROUND_OFF = 1e-9


def utilisation_of(
    criterion: FatigueCriterion, region: CycleOfRegion, settings: CriticalDistance, threads: int = 1
) -> float:
    """Largest damage parameter of a region over its limit, or that at the critical distance from there.

    Raises
    ------
    SceneError
        The critical distance reaches out of the region.
    PluginError
        The criterion returns no damage parameter, or an upper bound that is too small.
    """
    row = region.shape[-1] if region.shape else 1
    value = largest_first(criterion, region.at, region.places.shape[1], threads, part=-(-_PART // row) * row)
    if settings.distance:
        asked = np.isneginf(value).reshape(region.shape)
        depth = f"{region.region}_z"
        if settings.method != "volume" and depth in region.dims:  # the column below the hot spot is enough
            hot = np.zeros(value.size, dtype=bool)
            hot[value.argmax()] = True
            asked &= hot.reshape(region.shape).any(axis=region.dims.index(depth), keepdims=True)
        value[asked.ravel()] = checked_damage(criterion, region.at(asked.ravel())).value
        return float(value_near(region, value, settings.distance, settings.method) / criterion.limit)
    return float(value.max() / criterion.limit)


def largest_first(
    criterion: FatigueCriterion, at: Callable[[Any], StressCycle], points: int, threads: int = 1, part: int = _PART
) -> FloatArray:
    """Damage parameters ``(points,)`` of the points that can have the largest value; minus infinity elsewhere.

    The points are evaluated in the order of their upper bounds (`HasUpperBound`) until no bound reaches the largest
    value. The largest value and its first point are therefore those of a search over all points. A criterion without
    bounds is evaluated at all points. `at` reads the stress of some points, of a `part` of all points at once.
    """
    if not isinstance(criterion, HasUpperBound):
        return checked_damage(criterion, at(slice(None))).value
    where, bound = f"upper_bound of fatigue criterion {criterion.key!r}", np.empty(points)

    def ask(some: Any) -> StressCycle:
        cycle = at(some)
        values = real_answer(criterion.upper_bound(cycle), where)
        if values.shape != bound[some].shape or not np.all(np.isfinite(values)):
            raise PluginError(f"{where} must be finite, of shape {bound[some].shape} (got shape {values.shape})")
        bound[some] = values
        return cycle

    in_parallel(threads, [partial(ask, slice(start, start + part)) for start in range(0, points, part)])
    value, best = np.full(points, -np.inf), -np.inf
    order, start, count = np.argsort(-bound), 0, _FIRST

    def able(some: IntArray) -> NDArray[np.bool_]:
        return bound[some] >= best - _ROUND_OFF * abs(best)

    while (some := order[start : start + count])[able(some)].size:
        some = some[able(some)]
        cycle = ask(some)  # the bounds of few points may be closer
        start, count, still = start + count, count * _GROWTH, able(some)
        if not still.any():
            continue
        some = some[still]
        value[some] = checked_damage(criterion, cycle.at(still)).value
        excess = value[some] - bound[some] - _ROUND_OFF * np.abs(bound[some])
        if excess.max() > 0.0:
            worst = some[excess.argmax()]
            raise PluginError(f"{where} must be at least the damage, {value[worst]:.9g} (got {bound[worst]:.9g})")
        best = max(best, float(value[some].max()))
    return value
