"""Predicted time of the influence coefficients of layered bodies, with the measured time of the medium's response.

The predicted times are those of new tables; reading a table from disk takes a tenth of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from functools import cache
from typing import Any

import numpy as np

from eigencontact.convolution.pace import timed
from eigencontact.core.parallel import available_threads
from eigencontact.core.tensors import COMPONENTS
from eigencontact.execution.blocks.block import Cost
from eigencontact.halfspace.media import response_at_depths
from eigencontact.model.kernels import Solid
from eigencontact.model.window import Window
from eigencontact.plugin import LayeredMedium
from eigencontact.scene.schema import Numerics

__all__ = ["layered_sampling_seconds", "layered_stress_cost", "layered_surface_cost"]

#: Number of displacement tables of a contact: one for each grid from coarse to fine, and one for the whole window.
_TABLES = 5
#: Memory during the computation of a table, per point [bytes].
_POINT_BYTES = 300.0
#: Times [s]: fixed part of a field; each depth; each table at a depth; each point of a stress table and of a
#: displacement table. They agree within a factor of 2 with measurements on one and four layers, moduli 0.05 to 1000, 1
#: to 128 depths, and cells of 1/30 to 1/250 of a thickness. A shallow stress table takes 0.12 us per point, a deep one
#: 0.02 us.
_FIELD, _DEPTH, _TABLE, _STRESS_POINT, _POINT = 2e-2, 1.3e-3, 2e-4, 4e-8, 2.5e-8
#: Number of waves and depths in the timing of a medium. A field needs about 1300 waves at two resolutions, each with
#: half of the components.
_WAVES, _FIELD_WAVES, _DEPTHS = 256, 1300, 8


@cache
def _depth_seconds(medium: Any) -> float:
    """Time of a field per depth, mostly for the response of the medium."""
    reach = medium.interfaces[-1] if medium.interfaces else 1.0
    waves = np.geomspace(1e-3, 50.0, _WAVES) / reach, np.zeros(_WAVES)
    depths = np.linspace(0.0, 2.5 * reach, _DEPTHS)
    answer = timed(lambda: response_at_depths(medium, "stress", COMPONENTS, "p", waves, depths, "below"), 2)
    return _DEPTH + 0.5 * answer / _DEPTHS * _FIELD_WAVES / _WAVES


@cache
def _periodic_point(medium: LayeredMedium) -> float:
    """Time of six stress amplitudes of one wave."""
    depth = medium.interfaces[-1] if medium.interfaces else 1.0
    k = np.linspace(0.0, 8.0 / depth, 48)
    answer = timed(lambda: medium.response("stress", COMPONENTS, "p", k[None, :], k[:, None], 0.5 * depth), 2)
    return answer / k.size**2


def layered_sampling_seconds(medium: LayeredMedium, *, periodic: bool) -> float:
    """Time of six stress coefficients of a layered medium at one lattice point [s]."""
    return _periodic_point(medium) if periodic else _STRESS_POINT


def layered_surface_cost(
    solids: Iterable[Solid | None], window: Window, tractions: Iterable[str], *, periodic: bool
) -> Cost:
    """Cost of the surface displacement tables of layered bodies, for traction names with a kernel each."""
    shape, box = window.grid.shape, window.box
    lattice = (shape[0] + box[0]) * (shape[1] + box[1]) / (1 if periodic else 4)
    media = {body for body in solids if isinstance(body, LayeredMedium)}
    seconds, memory = 0.0, 0.0
    for count in Counter(tractions).values():
        for medium in media:
            if periodic:
                seconds += count * lattice * _periodic_point(medium) / 3.0
            else:
                seconds += _FIELD + _depth_seconds(medium) + count * (_TABLES * _TABLE + lattice * _POINT)
            memory = _POINT_BYTES * lattice
    return Cost(seconds_once=seconds, transient=memory)


def layered_stress_cost(body: Solid, tables: int, numerics: Numerics, *, every_step: bool = False) -> Cost:
    """Predicted cost of the stress tables of a layered body, without the cost per point.

    The points cost as much as those of homogeneous bodies. `every_step` is for tables that are sampled in every step.
    """
    if not isinstance(body, LayeredMedium) or numerics.boundary == "periodic":
        return Cost()
    field_seconds = _FIELD + tables * _depth_seconds(body)
    table_seconds = tables * _TABLE / (0.75 * min(numerics.threads or available_threads(), max(1, tables)))
    return (
        Cost(seconds_once=field_seconds, seconds_per_step=table_seconds)
        if every_step
        else Cost(seconds_once=field_seconds + table_seconds)
    )
