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

#: Least number of points whose stress is read, and whose bounds are computed, at once: their arrays fit the cache.
_CHUNK = 1_200
#: Number of points with the largest bounds that are evaluated first, and its growth from batch to batch.
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
    value = largest_first(criterion, region.at, region.places.shape[1], threads, chunk=-(-_CHUNK // row) * row)
    if settings.distance:
        missing = np.isneginf(value).reshape(region.shape)
        depth = f"{region.region}_z"
        if settings.method != "volume" and depth in region.dims:  # the column below the hot spot is enough
            hot = np.zeros(value.size, dtype=bool)
            hot[value.argmax()] = True
            missing &= hot.reshape(region.shape).any(axis=region.dims.index(depth), keepdims=True)
        value[missing.ravel()] = checked_damage(criterion, region.at(missing.ravel())).value
        return float(value_near(region, value, settings.distance, settings.method) / criterion.limit)
    return float(value.max() / criterion.limit)


def largest_first(
    criterion: FatigueCriterion, at: Callable[[Any], StressCycle], count: int, threads: int = 1, chunk: int = _CHUNK
) -> FloatArray:
    """Damage parameters ``(count,)`` of the points that can have the largest value; minus infinity elsewhere.

    The points are evaluated in the order of their upper bounds (`HasUpperBound`) until no bound reaches the largest
    value. The largest value and its first point are therefore those of a search over all points. A criterion without
    bounds is evaluated at all points. `at` reads the stress of a selection of the `count` points. The bounds of
    a `chunk` of points are computed at once.
    """
    if not isinstance(criterion, HasUpperBound):
        return checked_damage(criterion, at(slice(None))).value
    where, bound = f"upper_bound of fatigue criterion {criterion.key!r}", np.empty(count)

    def read_bounds(points: Any) -> StressCycle:
        cycle = at(points)
        values = real_answer(criterion.upper_bound(cycle), where)
        if values.shape != bound[points].shape or not np.all(np.isfinite(values)):
            raise PluginError(f"{where} must be finite, of shape {bound[points].shape} (got shape {values.shape})")
        bound[points] = values
        return cycle

    in_parallel(threads, [partial(read_bounds, slice(start, start + chunk)) for start in range(0, count, chunk)])
    value, best = np.full(count, -np.inf), -np.inf
    order, start, batch = np.argsort(-bound), 0, _FIRST

    def reach_best(points: IntArray) -> NDArray[np.bool_]:
        return bound[points] >= best - _ROUND_OFF * abs(best)

    while (points := order[start : start + batch])[reach_best(points)].size:
        points = points[reach_best(points)]
        cycle = read_bounds(points)  # the bounds of few points may be closer
        start, batch, candidates = start + batch, batch * _GROWTH, reach_best(points)
        if not candidates.any():
            continue
        points = points[candidates]
        value[points] = checked_damage(criterion, cycle.at(candidates)).value
        excess = value[points] - bound[points] - _ROUND_OFF * np.abs(bound[points])
        if excess.max() > 0.0:
            worst = points[excess.argmax()]
            raise PluginError(f"{where} must be at least the damage, {value[worst]:.9g} (got {bound[worst]:.9g})")
        best = max(best, float(value[points].max()))
    return value
