"""Warnings about wear: shifts instead of travel, slopes, jumps over cycles, layers and regions below the surface."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from eigencontact.core.cautions import Caution
from eigencontact.core.grid import Box
from eigencontact.core.units import readable
from eigencontact.model.model import Model
from eigencontact.model.resolution import percent
from eigencontact.model.sources import Inhomogeneity
from eigencontact.results.records import StepRecord
from eigencontact.scene.wear import Wear

__all__ = ["shift_by_radius", "shift_that_wears", "wear_cautions", "worn_bodies"]

#: Shift relative to the contact radius that causes a warning: the scar is then 9 % too short.
_SHORT = 0.1
#: Worn depth relative to the contact radius that causes a warning about slopes: they cause strains of the same order.
_DEEP = 0.1
#: Error of the worn volume by jumps of prescribed size, and distance to the window's edge relative to the contact, in
#: cells.
_JUMPS, _GROWN = 1e-2, 0.05
#: Error by the assumption of uniform layers that causes a warning.
_UNEVEN = 0.01
#: Relative difference of the pressure after a slide from the pressure during it that causes a warning.
_LAGS = 0.03
#: Allowed worn depth above a fixed region, relative to the depth of the region.
_STAYS = 0.05


def shift_by_radius(model: Model) -> float:
    """Largest shift divided by the expected contact radius along it; 0 without a shift.

    Infinite if no contact is expected.
    """
    expected = model.window.expected
    extent = (0.0, 0.0) if expected is None else expected.extent
    ratios = [0.0]
    for name, side in zip(("shift_x", "shift_y"), extent, strict=True):
        largest = max((abs(getattr(ramp, name) or 0.0) for ramp in model.scene.ramps), default=0.0)
        if largest:
            ratios.append(2.0 * largest / side if side else float("inf"))
    return max(ratios)


def shift_that_wears(model: Model) -> Iterator[Caution]:
    """Warning about a shift of wearing surfaces that is probably meant as travel."""
    ratio = shift_by_radius(model)
    if _SHORT < ratio < np.inf and model.interface is not None and not model.interface.measured:
        error = ratio / (1.0 + ratio)
        words = (
            f"the shift reaches {percent(ratio)} of the contact radius, more than {percent(_SHORT)}, but a shift does "
            f"not move the contact: the scar is {percent(error)} shorter along the shift than that of a "
            "moving contact, and too deep in its middle; use travel-x or travel-y to move the contact"
        )
        yield Caution("shift", words, error)


def wear_cautions(
    table: Wear, model: Model, last: StepRecord, history: Sequence[Mapping[str, float]]
) -> Iterator[Caution]:
    """Warnings about worn slopes, large jumps over cycles, and a contact near the window's edge."""
    for row in history:
        radius = float(np.sqrt(row["contact_area_counted"] / np.pi))
        if row["max_worn_depth"] > _DEEP * radius > 0:
            deepest = readable(max(later["max_worn_depth"] for later in history), "m")
            words = (
                f"the worn depth reaches {deepest}: from load step {row['step']:.0f} on it exceeds "
                f"{readable(_DEEP * radius, 'm')}, {percent(_DEEP)} of the contact radius {readable(radius, 'm')}, "
                "so that slopes are not small, as half-spaces assume"
            )
            yield Caution("worn-slopes", words)
            break
    error, allowed = last.scalars["wear_error"], table.error or _JUMPS
    if error > allowed:
        remedy = "a smaller wear.jump-error" if table.error else "a smaller wear.cycles-per-update, or wear.jump-error"
        late = abs(last.scalars["update_error"])
        if late > 0.5 * error:
            remedy = "wear.update = 'increment', or reduce the wear of a cycle"
        words = (
            f"the estimated error of the worn volume is {percent(error)}, more than {percent(allowed)}, by skipped "
            f"cycles and by surfaces that move once per cycle ({percent(late)}); set {remedy}"
        )
        yield Caution("wear-jumps", words, error)
    box = Box.around(last.fields["pressure"] > 0)
    if box is not None and not model.periodic:
        ny, nx = last.fields["pressure"].shape
        sides = ((box.x0, nx - box.x1), (box.y0, ny - box.y1))
        near = min(min(sides[axis]) for axis in model.grid.ended_axes)
        if 0 < near <= max(1.0, _GROWN * max(box.shape)):
            words = (
                f"the worn contact ends {near} cell{'s' if near > 1 else ''} before the edge of the window; a run "
                "whose contact reaches the edge fails: more wear needs a larger grid.size"
            )
            yield Caution("worn-window", words)


def worn_bodies(model: Model, last: StepRecord, history: Sequence[Mapping[str, float]]) -> Iterator[Caution]:
    """Warnings about unevenly worn layers, and about regions that do not move with the worn surface."""
    error = max((row.get("layer_error") or 0.0 for row in history), default=0.0)
    if error >= _UNEVEN:
        words = (
            "the kernels use the mean thickness of worn layers in the contact: the responses of the most and the least "
            f"worn column differ from it by {percent(error)}; describe the layers by cells to resolve this"
        )
        yield Caution("worn-layers", words, error)
    lag = last.scalars.get("wear_lag", 0.0)
    if lag >= _LAGS:
        words = (
            f"the interiors of the bodies are updated only after the wear of a slide: the pressure of this wear in the "
            f"last step differs by {percent(lag)} from the final pressure; increase the increments"
        )
        yield Caution("worn-increments", words, lag)
    yield from _left_behind(model, last)


def _left_behind(model: Model, last: StepRecord) -> Iterator[Caution]:
    """Warning about the first region that does not move with the surface: only regions of linear laws in cells move."""
    for source in model.sources:
        worn = last.fields.get(f"worn_depth_{source.body}")
        rises = isinstance(source, Inhomogeneity) and source.lattice is not None and source.law.linear
        if worn is None or rises:
            continue
        worn_depth, depth = float(worn.max()), source.shape.bounds[1][2]
        if worn_depth > _STAYS * depth:
            words = (
                f"body {source.body} has a worn depth of up to {readable(worn_depth, 'm')}, but {source.name!r}, which "
                f"extends to {readable(depth, 'm')}, keeps its depth: eigenstrain, whole inclusions and the state of "
                "laws do not move with the worn surface"
            )
            yield Caution("worn-regions", words, worn_depth / depth)
            return
