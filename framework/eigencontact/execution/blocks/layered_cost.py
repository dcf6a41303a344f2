"""Predicted time of the influence coefficients of layered bodies, with the measured time of the medium's response.

The counts are those of tables that are computed: ones that are kept on disk take a tenth of it.
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

#: Tables of displacement that a contact samples: the grids from coarse to fine, and the whole window.
_TABLES = 5
#: Memory held while a table is found, for each of its points [bytes].
_POINT_BYTES = 300.0
#: Times [s] of a field whatever its depths, of each depth more, of each table at it, of each point of a table of stress
#: and of displacement: within a factor of 2 those of one and of four layers, moduli 0.05 to 1000, 1 to 128 depths,
#: cells of 1/30 to 1/250 of a thickness. A table of stress that is shallow takes 0.12 us a point, a deep one 0.02.
_FIELD, _DEPTH, _TABLE, _STRESS_POINT, _POINT = 2e-2, 1.3e-3, 2e-4, 4e-8, 2.5e-8
#: Waves and depths that a medium is timed with. A field asks for some 1300 waves at two resolutions, and for half of
#: the components at each.
_WAVES, _ASKED, _DEPTHS = 256, 1300, 8


@cache
def _depth_seconds(medium: Any) -> float:
    """Time of a field for each depth, mostly the response of the medium."""
    reach = medium.interfaces[-1] if medium.interfaces else 1.0
    waves = np.geomspace(1e-3, 50.0, _WAVES) / reach, np.zeros(_WAVES)
    depths = np.linspace(0.0, 2.5 * reach, _DEPTHS)
    answer = timed(lambda: response_at_depths(medium, "stress", COMPONENTS, "p", waves, depths, "below"), 2)
    return _DEPTH + 0.5 * answer / _DEPTHS * _ASKED / _WAVES


@cache
def _periodic_point(medium: LayeredMedium) -> float:
    """Time of six amplitudes of stress of one wave."""
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
    """Tables of surface displacement of layered bodies, for tractions with a kernel each."""
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


def layered_stress_cost(body: Solid, tables: int, numerics: Numerics, *, anew: bool = False) -> Cost:
    """Predicted cost of the stress tables of a layered body, without that of their points.

    The cost of the points is that of homogeneous bodies. `anew` is for tables that are sampled at every step.
    """
    if not isinstance(body, LayeredMedium) or numerics.boundary == "periodic":
        return Cost()
    field_seconds = _FIELD + tables * _depth_seconds(body)
    table_seconds = tables * _TABLE / (0.75 * min(numerics.threads or available_threads(), max(1, tables)))
    return (
        Cost(seconds_once=field_seconds, seconds_per_step=table_seconds)
        if anew
        else Cost(seconds_once=field_seconds + table_seconds)
    )
