"""Predicted time of the influence coefficients of layered bodies, from two tables timed on the spot."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from time import perf_counter
from typing import Any

import numpy as np

from eigencontact.convolution.backends import available_threads
from eigencontact.core.tensors import COMPONENTS
from eigencontact.planning.blocks import Cost
from eigencontact.planning.kernels import Solid
from eigencontact.plugin import HasWavenumberResponse, LayeredMedium, SurfaceInfluence

__all__ = ["layered_sampling_seconds", "layered_stress_cost", "layered_surface_cost"]

#: Tables of displacement that a contact samples: the grids from coarse to fine, and the whole window.
_TABLES = 5
#: A table of one component of displacement takes about this share of one of six components of stress.
_SURFACE = 0.5
#: Memory held while a table is found, for each of its points [bytes].
_POINT_BYTES = 300.0


@cache
def _table_seconds(influence: SurfaceInfluence, medium: LayeredMedium, *, periodic: bool) -> tuple[float, float]:
    """Time of one table of six stress coefficients, whatever its size, and of each of its points [s]."""
    sample: Any = influence.sample
    depth = medium.interfaces[0] if medium.interfaces else 1.0
    if periodic:
        assert isinstance(influence, HasWavenumberResponse)
        answer: Any = influence.wavenumber_response
        k = np.linspace(0.0, 8.0 / depth, 48)
        answer("stress", COMPONENTS, k[None, :2], k[:2, None], 0.5 * depth, medium)
        began = perf_counter()
        answer("stress", COMPONENTS, k[None, :], k[:, None], 0.5 * depth, medium)
        return 0.0, (perf_counter() - began) / k.size**2
    cell, times = depth / 20.0, []
    for n in (2, 8, 144):  # the first also loads what is needed
        x = np.arange(n) * cell
        began = perf_counter()
        sample("stress", COMPONENTS, x, x, 0.5 * depth, (0.5 * cell, 0.5 * cell), medium)
        times.append(perf_counter() - began)
    return times[1], max(times[2] - times[1], 0.0) / 144**2


def layered_sampling_seconds(influence: SurfaceInfluence, medium: LayeredMedium, *, periodic: bool) -> float:
    """Measured time of six stress coefficients of a layered medium at one lattice point [s]."""
    return _table_seconds(influence, medium, periodic=periodic)[1]


def layered_surface_cost(
    influences: Iterable[SurfaceInfluence],
    bodies: Sequence[Solid | None],
    shape: tuple[int, int],
    box: tuple[int, int],
    *,
    periodic: bool,
) -> Cost:
    """Tables of surface displacement, one of each influence, beyond those of homogeneous bodies."""
    lattice = (shape[0] + box[0]) * (shape[1] + box[1]) / (1 if periodic else 4)
    seconds, held = 0.0, 0.0
    for influence in influences:
        for medium in {body for body in bodies if isinstance(body, LayeredMedium)}:
            fixed, point = _table_seconds(influence, medium, periodic=periodic)
            seconds += _SURFACE * (_TABLES * fixed + lattice * point)
            held = _POINT_BYTES * lattice
    return Cost(seconds_once=seconds, transient=held)


def layered_stress_cost(
    influence: SurfaceInfluence,
    body: Solid | None,
    *,
    tables: int,
    periodic: bool,
    threads: int | None,
    anew: bool = False,
) -> Cost:
    """Tables of stress, whatever their size; their points are counted with those of homogeneous bodies.

    `anew` is for tables that are sampled at every step.
    """
    if not isinstance(body, LayeredMedium):
        return Cost()
    seconds = tables * _table_seconds(influence, body, periodic=periodic)[0]
    seconds /= 0.75 * min(threads or available_threads(), max(1, tables))
    return Cost(seconds_per_step=seconds) if anew else Cost(seconds_once=seconds)
