"""Predicted time of influence coefficients from timed samples, for homogeneous and layered bodies."""

from __future__ import annotations

from functools import cache

import numpy as np

from eigencontact.convolution import Layout
from eigencontact.convolution.pace import speed, timed
from eigencontact.core.material import Material
from eigencontact.core.parallel import available_threads, working_threads
from eigencontact.core.tensors import COMPONENTS
from eigencontact.execution.blocks.block import Cost
from eigencontact.model.kernels import Solid
from eigencontact.plugin import LayeredMedium, SurfaceInfluence
from eigencontact.scene.schema import Numerics

__all__ = ["sampling_seconds", "section_cost", "spectra_cost", "tables_of_images"]


def tables_of_images(numerics: Numerics) -> float:
    """Ratio of the time of a coefficient table to that of one rectangle: measured 17 to 30 for images along y."""
    return 25.0 if numerics.repeats_y else 1.0


def sampling_seconds(influence: SurfaceInfluence, body: Solid, *, periodic: bool = False) -> float:
    """Measured time of six stress coefficients at one lattice point [s]."""
    if isinstance(body, LayeredMedium):
        from eigencontact.execution.blocks.layered_cost import layered_sampling_seconds

        return layered_sampling_seconds(body, periodic=periodic)
    return _homogeneous_point(influence, body)


@cache
def _homogeneous_point(influence: SurfaceInfluence, body: Material) -> float:
    x = np.arange(96.0)
    return timed(lambda: influence.sample("stress", COMPONENTS, x, x, 1.0, (0.5, 0.5), body)) / x.size**2


def spectra_cost(
    layout: Layout, depths: int, sampling: float, numerics: Numerics, *, kernels: int = 6, tractions: int = 1
) -> Cost:
    """Cost of `kernels` components at all depths: coefficients and spectra once, then one inverse transform each.

    Parameters
    ----------
    layout : Layout
        From the loaded box to the target points.
    sampling : float
        Time of six coefficients at one lattice point [s].
    tractions : int
        Number of traction components, each with coefficients of its own.
    """
    pace, real = speed(numerics.precision, numerics.threads), (8 if numerics.precision == "double" else 4)
    y, x = layout.y, layout.x
    lattice = y.lattice.size * x.lattice.size
    stored = x.half * (y.half if y.symmetric else y.length) * (1 if y.symmetric and x.symmetric else 2)
    outputs = kernels * depths
    values = outputs * y.targets * x.targets * 8.0
    workers = min(numerics.threads or available_threads(), max(1, depths))
    once = depths * sampling * lattice * kernels / 6 / working_threads(workers) + outputs * (stored * 5e-9 + 8e-5)
    once *= tractions
    share = 0.1 + 0.1 * min(1.0, 2.0 * y.targets / y.length)  # the forward transform serves all outputs
    step = outputs * (pace.convolution(y.length, x.length) - pace.per_call) * share + outputs * 8e-5 + 1e-8 * values
    step += (tractions - 1) * outputs * stored * 4e-9  # products of spectra
    memory = tractions * outputs * stored * real + 4.0 * values + workers * lattice * 8.0 * 3 * kernels
    return Cost(memory=memory, seconds_once=once, seconds_per_step=step)


def section_cost(layout: Layout, depths: int, sampling: float, numerics: Numerics, *, tractions: int = 1) -> Cost:
    """Cost of six components on one row of points at `depths` depths; see `spectra_cost`.

    The factors of a step were measured on sections through contacts of 32 to 256 cells and of lines, those
    of the set-up on contacts of 64 to 512 cells (`eigencontact.solvers.section_stress`).
    """
    real = 8 if numerics.precision == "double" else 4
    axes = (layout.y, layout.x)
    across, row = axes if layout.target[0] == 1 else axes[::-1]
    midway = abs(2.0 * across.origin - (across.sources - 1)) < 1e-9  # half of the rows are images of the others
    rows = across.sources // 2 + 1 if midway else across.sources
    outputs, stored = 6 * depths, rows * row.half * (1 if row.symmetric else 2)
    workers = working_threads(min(numerics.threads or available_threads(), max(1, depths)))
    once = tractions * (depths * sampling * rows * row.lattice.size + outputs * (stored * 5e-9 + 3e-5)) / workers
    step = outputs * (tractions * stored * 1.7e-9 + 2e-6) / workers
    memory = tractions * (outputs * stored * real + 6.0 * stored * 48) + 16.0 * outputs * row.targets
    return Cost(memory=memory, seconds_once=once, seconds_per_step=step)
