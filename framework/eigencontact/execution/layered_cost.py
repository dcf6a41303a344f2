"""Predicted time of the influence coefficients of layered bodies, from a few of them timed on the spot."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from time import perf_counter
from typing import Any

import numpy as np

from eigencontact.core.parallel import available_threads
from eigencontact.core.tensors import COMPONENTS
from eigencontact.execution.block import Cost
from eigencontact.model.kernels import Solid
from eigencontact.model.model import Model
from eigencontact.plugin import HasWavenumberResponse, LayeredMedium, SurfaceInfluence
from eigencontact.scene.schema import Numerics

__all__ = ["layered_sampling_seconds", "layered_stress_cost", "layered_surface_cost"]

#: Tables of displacement that a contact samples: the grids from coarse to fine, and the whole window.
_TABLES = 5
#: Memory held while a table is found, for each of its points [bytes].
_POINT_BYTES = 300.0
#: Depths of the fields that are timed: two numbers tell what each depth takes.
_DEPTHS = (9, 33)


@dataclass(frozen=True, slots=True)
class _Pace:
    """Times [s]: of a field whatever its depths, of each depth more, of each table at it, of each point of a table."""

    field: float = 0.0
    depth: float = 0.0
    table: float = 0.0
    point: float = 0.0


@cache
def _stress_pace(influence: SurfaceInfluence, medium: LayeredMedium, *, periodic: bool) -> _Pace:
    """Six stress coefficients at depths through the layers."""
    depth = medium.interfaces[-1] if medium.interfaces else 1.0
    if periodic:
        assert isinstance(influence, HasWavenumberResponse)
        answer: Any = influence.wavenumber_response
        k = np.linspace(0.0, 8.0 / depth, 48)
        answer("stress", COMPONENTS, k[None, :2], k[:2, None], 0.5 * depth, medium)
        seconds, _ = _seconds(answer, "stress", COMPONENTS, k[None, :], k[:, None], 0.5 * depth, medium)
        return _Pace(point=seconds / k.size**2)
    cell = depth / 20.0
    x, half_widths = np.arange(144) * cell, (0.5 * cell, 0.5 * cell)
    layered: Any = influence  # the influence that knows layers goes with such a body
    times = []
    for count in (2, *_DEPTHS):  # the first also loads what is needed
        depths = np.linspace(0.0, 2.5 * depth, count)
        seconds, field = _seconds(layered.at_depths, "stress", COMPONENTS, depths, half_widths, x[-1], medium)
        times.append(seconds)
    # Near the surface a closed kernel is sampled too: a mean over depths.
    numbers = range(0, _DEPTHS[1], 4)
    small, large = (
        sum(_seconds(field.on_lattice, k, x[:n], x[:n])[0] for k in numbers) / len(numbers) for n in (8, 144)
    )
    per_depth = max(times[2] - times[1], 0.0) / (_DEPTHS[1] - _DEPTHS[0])
    whole = max(times[1] - _DEPTHS[0] * per_depth, 0.0)
    return _Pace(field=whole, depth=per_depth, table=small, point=max(large - small, 0.0) / x.size**2)


@cache
def _surface_pace(influence: SurfaceInfluence, medium: LayeredMedium, *, periodic: bool) -> _Pace:
    """One component of the displacement of the surface."""
    if periodic:
        return _Pace(point=_stress_pace(influence, medium, periodic=True).point / 3.0)
    cell = (medium.interfaces[-1] if medium.interfaces else 1.0) / 20.0
    sample: Any = influence.sample
    times = []
    # The first also loads what is needed; then a field of another window, and tables of other cells in that window.
    for n, part in ((24, 1.0), (96, 1.0), (96, 0.99), (8, 12.0)):
        x = np.arange(n) * part * cell
        half_widths = (0.5 * part * cell, 0.5 * part * cell)
        times.append(_seconds(sample, "displacement", ("z",), x, x, 0.0, half_widths, medium)[0])
    _, first, large, small = times
    return _Pace(field=max(first - large, 0.0), table=small, point=max(large - small, 0.0) / 96**2)


def _seconds(call: Any, *arguments: object) -> tuple[float, Any]:
    began = perf_counter()
    found = call(*arguments)
    return perf_counter() - began, found


def layered_sampling_seconds(influence: SurfaceInfluence, medium: LayeredMedium, *, periodic: bool) -> float:
    """Measured time of six stress coefficients of a layered medium at one lattice point [s]."""
    return _stress_pace(influence, medium, periodic=periodic).point


def layered_surface_cost(model: Model, tractions: Iterable[str]) -> Cost:
    """Tables of surface displacement of layered bodies, one of each influence, beyond those of homogeneous ones."""
    shape, box = model.grid.shape, model.contact_box
    lattice = (shape[0] + box[0]) * (shape[1] + box[1]) / (1 if model.periodic else 4)
    seconds, held = 0.0, 0.0
    for name, count in Counter(tractions).items():
        for medium in {body for body in model.bodies if isinstance(body, LayeredMedium)}:
            pace = _surface_pace(model.influences[name], medium, periodic=model.periodic)
            seconds += pace.field + count * (_TABLES * pace.table + lattice * pace.point)
            held = _POINT_BYTES * lattice
    return Cost(seconds_once=seconds, transient=held)


def layered_stress_cost(
    influence: SurfaceInfluence, body: Solid, tables: int, numerics: Numerics, *, anew: bool = False
) -> Cost:
    """Tables of stress, whatever their size; their points are counted with those of homogeneous bodies.

    `anew` is for tables that are sampled at every step.
    """
    if not isinstance(body, LayeredMedium):
        return Cost()
    pace = _stress_pace(influence, body, periodic=numerics.boundary == "periodic")
    found = pace.field + tables * pace.depth
    sampled = tables * pace.table / (0.75 * min(numerics.threads or available_threads(), max(1, tables)))
    return Cost(seconds_once=found, seconds_per_step=sampled) if anew else Cost(seconds_once=found + sampled)
