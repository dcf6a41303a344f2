"""What influence coefficients cost, from a few tables timed on the spot, for homogeneous and layered bodies."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from time import perf_counter
from typing import Any

import numpy as np

from eigencontact.convolution import Layout
from eigencontact.convolution.pace import speed, timed
from eigencontact.core.material import Material
from eigencontact.core.parallel import available_threads
from eigencontact.core.tensors import COMPONENTS
from eigencontact.execution.block import Cost
from eigencontact.model.kernels import Solid
from eigencontact.model.model import Model
from eigencontact.plugin import LayeredMedium, SurfaceInfluence
from eigencontact.scene.schema import Numerics

__all__ = ["layered_surface_cost", "layered_tables_cost", "sampling_seconds", "spectra_cost"]

#: Tables of displacement that a contact samples: the grids from coarse to fine, and the whole window.
_TABLES = 5
#: A table of one component of displacement takes about this share of one of six components of stress.
_SURFACE = 0.5
#: Memory held while a table is found, for each of its points [bytes].
_POINT_BYTES = 300.0


def sampling_seconds(influence: SurfaceInfluence, body: Solid, *, periodic: bool = False) -> float:
    """Measured time of six stress coefficients at one lattice point [s]."""
    if isinstance(body, LayeredMedium):
        return _layered_table(influence, body, periodic=periodic)[1]
    return _homogeneous_point(influence, body)


@cache
def _homogeneous_point(influence: SurfaceInfluence, body: Material) -> float:
    x = np.arange(96.0)
    return timed(lambda: influence.sample("stress", COMPONENTS, x, x, 1.0, (0.5, 0.5), body)) / x.size**2


@cache
def _layered_table(influence: SurfaceInfluence, medium: LayeredMedium, *, periodic: bool) -> tuple[float, float]:
    """Time of one table of six stress coefficients, whatever its size, and of each of its points [s]."""
    sample: Any = influence.sample
    depth = medium.interfaces[0] if medium.interfaces else 1.0
    if periodic:
        answer: Any = influence.wavenumber_response  # type: ignore[attr-defined]
        k = np.linspace(0.0, 8.0 / depth, 48)
        answer("stress", COMPONENTS, k[None, :2], k[:2, None], 0.5 * depth, medium)
        seconds = timed(lambda: answer("stress", COMPONENTS, k[None, :], k[:, None], 0.5 * depth, medium), 1)
        return 0.0, seconds / k.size**2
    cell, times = depth / 20.0, []
    for n in (2, 8, 144):  # the first also loads what is needed
        x = np.arange(n) * cell
        began = perf_counter()
        sample("stress", COMPONENTS, x, x, 0.5 * depth, (0.5 * cell, 0.5 * cell), medium)
        times.append(perf_counter() - began)
    return times[1], max(times[2] - times[1], 0.0) / 144**2


def layered_surface_cost(model: Model, tractions: Iterable[str]) -> Cost:
    """Tables of surface displacement of layered bodies, one of each influence, beyond those of homogeneous ones."""
    shape, box = model.grid.shape, model.contact_box
    lattice = (shape[0] + box[0]) * (shape[1] + box[1]) / (1 if model.periodic else 4)
    seconds, held = 0.0, 0.0
    for name in tractions:
        for medium in {body for body in model.bodies if isinstance(body, LayeredMedium)}:
            fixed, point = _layered_table(model.influences[name], medium, periodic=model.periodic)
            seconds += _SURFACE * (_TABLES * fixed + lattice * point)
            held = _POINT_BYTES * lattice
    return Cost(seconds_once=seconds, transient=held)


def layered_tables_cost(influence: SurfaceInfluence, body: Solid, tables: int, numerics: Numerics) -> Cost:
    """Tables of stress in a layered body, whatever their size; their points are counted with `spectra_cost`."""
    if not isinstance(body, LayeredMedium):
        return Cost()
    seconds = tables * _layered_table(influence, body, periodic=numerics.boundary == "periodic")[0]
    return Cost(seconds_once=seconds / (0.75 * min(numerics.threads or available_threads(), max(1, tables))))


def spectra_cost(
    layout: Layout, depths: int, sampling: float, numerics: Numerics, *, kernels: int = 6, tractions: int = 1
) -> Cost:
    """So many components at so many depths: coefficients and spectra once, then one inverse transform each.

    Parameters
    ----------
    layout : Layout
        From the loaded box to the target points.
    sampling : float
        Time of six coefficients at one lattice point [s].
    tractions : int
        Components of traction that cause it, each with coefficients of its own.
    """
    pace, real = speed(numerics.precision, numerics.threads), (8 if numerics.precision == "double" else 4)
    y, x = layout.y, layout.x
    lattice = y.lattice.size * x.lattice.size
    stored = x.half * (y.half if y.symmetric else y.length) * (1 if y.symmetric and x.symmetric else 2)
    outputs = kernels * depths
    values = outputs * y.targets * x.targets * 8.0
    workers = min(numerics.threads or available_threads(), max(1, depths))
    once = depths * sampling * lattice * kernels / 6 / (0.75 * workers) + outputs * (stored * 5e-9 + 8e-5)
    once *= tractions
    share = 0.1 + 0.1 * min(1.0, 2.0 * y.targets / y.length)  # the forward transform serves all outputs
    step = outputs * (pace.convolution(y.length, x.length) - pace.per_call) * share + outputs * 8e-5 + 1e-8 * values
    step += (tractions - 1) * outputs * stored * 4e-9  # products of spectra
    memory = tractions * outputs * stored * real + 4.0 * values + workers * lattice * 8.0 * 3 * kernels
    return Cost(memory=memory, seconds_once=once, seconds_per_step=step)
