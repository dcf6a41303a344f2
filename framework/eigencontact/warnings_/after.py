"""Warnings about the accuracy of finished results."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np

from eigencontact.core.cautions import Caution
from eigencontact.core.grid import Box
from eigencontact.core.units import readable
from eigencontact.execution.blocks.block import Block
from eigencontact.model.model import Model
from eigencontact.model.resolution import FINE, percent
from eigencontact.model.sources import Patch
from eigencontact.results.records import RegionRecord, StepRecord
from eigencontact.scene.holding import held_steps
from eigencontact.scene.spacing import spaced_by_radius
from eigencontact.scene.whole import Whole
from eigencontact.warnings_.before import coarse_contact, foreseen, from_nothing

__all__ = ["noticed"]

#: Share of the contact that slips: more than this all at once, from less than that, is a jump.
_FULL_SLIP, _PARTIAL_SLIP = 0.999, 0.5
#: Cells within which a place counts as on an edge.
_NEAR = 1.5
#: Errors of a contact with friction that yields, by the number n of increments of its loading. Displacement along the
#: surface that stays: largest error n by its largest value, increments even in the radius and in the load. Work of
#: friction: excess by load and approach, times n to the power. With 'fretting-mode-2-plastic' on 8 cells to a radius,
#: against 128 increments: 2.5, 1.0, 1.4 and .8 of the first for n = 8, 16, 32 and 64 at a coefficient of 0.5, and .6 to
#: .3 at 0.2; 6 and .8 of the second at n = 16; of the third .037, .034, .033 and .077 at 0.5, .038, .043, .043 and .040
#: at 0.2.
_ALONG_RADIUS, _ALONG_EVEN, _EXCESS, _ORDER = 1.2, 6.0, 0.04, 2.5
#: Such an error that is not warned of.
_PLASTIC = 0.05
#: Error of the eigenstrain of whole inhomogeneities that is not warned of where the scene allows none in particular.
_DEGREE = 0.05

Row = Mapping[str, float]


def noticed(model: Model, blocks: Sequence[Block], last: StepRecord, history: Sequence[Row]) -> tuple[Caution, ...]:
    """Warnings of a finished run: those of its results, and predicted ones that the results do not replace.

    Parameters
    ----------
    model : Model
        Of the scene.
    blocks : sequence of Block
        Of its plan.
    last : StepRecord
        The last accepted step.
    history : sequence of mapping
        Scalars of every step, in order.
    """
    cautions = [*_contact(model, last), *_slip(model, history), *_slow_place(model, last)]
    cautions += [*_degree(model, last), *_taken_for_elastic(model, history), *_plastic_steps(model, history)]
    cautions += [caution for block in blocks for caution in block.noticed(model, last, history)]
    codes = {caution.code for caution in cautions} - {"load-steps"}
    return (*(caution for caution in foreseen(model, blocks) if caution.code not in codes), *cautions)


def _contact(model: Model, last: StepRecord) -> Iterator[Caution]:
    """A computed contact with few cells; one within fewer than two may be of any size."""
    box = Box.around(last.fields["pressure"] > 0) if "pressure" in last.fields else None
    if box is None or model.interface is None or model.interface.measured:
        return
    loaded = np.count_nonzero(last.fields["pressure"] > 0)
    high, wide = box.shape
    cells = float(np.sqrt(loaded / np.pi * min(high, wide) / max(high, wide)))
    if 2.0 <= cells < 0.95 * FINE:
        yield coarse_contact(cells)


def _slip(model: Model, history: Sequence[Row]) -> Iterator[Caution]:
    """Warn about load steps that are too large for the motion, and slip annuli narrower than a cell."""
    if model.friction is None:
        return
    for before, after in pairwise(history):
        # by a sliding-distance they are not
        moved = any(before[name] != after[name] for name in ("shift_magnitude", "twist"))
        if (
            moved
            and before["slip_fraction"] < _PARTIAL_SLIP
            and after["slip_fraction"] > _FULL_SLIP
            and before["normal_load"] > 0
        ):
            words = (
                f"in load step {after['step']:.0f} the slipping part of the contact rises from "
                f"{percent(before['slip_fraction'])} to all of it in one increment: the work of friction in between is "
                "not resolved; increase the increments of the step"
            )
            yield Caution("load-steps", words)
            break
    loaded = [row for row in history if row["tangential_load"] > 0 or row["torsion_moment"]]
    rings = [row["slip_fraction"] * np.sqrt(row["contact_area_counted"] / np.pi) for row in loaded]
    width = max(rings, default=np.inf) / (2.0 * max(model.grid.edges))
    if width < 1.0:
        words = (
            f"the slip annulus is at most {width:.2g} cells wide: stick radius, work of friction and loops are not "
            "resolved; use finer cells"
        )
        yield Caution("slip-cells", words)


def _degree(model: Model, last: StepRecord) -> Iterator[Caution]:
    """Whole inhomogeneities whose degree does not reach the error that the scene allows."""
    whole, error = model.numerics.inclusion_resolution, last.scalars.get("inclusion_degree_error", 0.0)
    if isinstance(whole, Whole) and error > (whole.allowed if whole.is_asked else _DEGREE):
        words = (
            f"the degree of whole inhomogeneities is too low: the estimated error of their eigenstrain is "
            f"{percent(error)}; set a higher degree, or allow this error"
        )
        if error >= 1.0:
            words = (
                "the degree of whole inhomogeneities does not resolve their eigenstrain: the estimated error exceeds "
                "the eigenstrain; set a higher degree, or use cells"
            )
        yield Caution("inclusion-degree", words, error)


def _taken_for_elastic(model: Model, history: Sequence[Row]) -> Iterator[Caution]:
    """Cells of bodies with a law that were chosen for a smaller pressure than the contact has."""
    bodies, contact = model.bodies.laws, model.window.expected
    if not bodies or contact is None:
        return
    from eigencontact.model.yielding import SAFETY

    reached, expected = max(row["max_pressure"] for row in history), contact.peak
    if reached > SAFETY * expected:
        words = (
            f"the largest pressure is {readable(reached, 'Pa')}, but the cells of the law of body "
            f"{' and body '.join(map(str, bodies))} were chosen for {readable(expected, 'Pa')}: yielding outside these "
            "cells is missing; add an inclusion with this law around them"
        )
        yield Caution("law-cells", words)


def _plastic_steps(model: Model, history: Sequence[Row]) -> Iterator[Caution]:
    """Errors of the slip of a contact with friction that yields in few increments."""
    steps = held_steps(model.scene.ramps)
    first = next(iter(from_nothing(steps)), None)
    flows = any(row.get("max_plastic_strain", 0.0) > 0.0 for row in history)
    if model.friction is None or first is None or not flows:
        return
    loading = [row for row in history if first < row["time"] <= first + 1]
    if not loading:
        return
    count = sum(row.get("substeps", 1.0) for row in loading)
    graded = model.window.growth is not None and first in spaced_by_radius(model.scene.steps, friction=True)[0]
    along = (_ALONG_RADIUS if graded else _ALONG_EVEN) / count
    end = loading[-1]
    excess = _EXCESS * end["normal_load"] * end["approach"] / count**_ORDER
    work = min(1.0, excess / end["dissipated_energy"]) if end["dissipated_energy"] > 0 else 0.0
    if max(along, work) > _PLASTIC:
        friction = f", that of the work of friction up to {percent(work)}" if work else ""
        words = (
            f"the yielding contact grows in {count:.0f} increments{' even in its radius' if graded else ''}: the "
            f"estimated error of its residual tangential displacement is {percent(min(1.0, along))}{friction}; "
            "increase the increments of the loading"
        )
        yield Caution("plastic-steps", words, min(1.0, max(along, work)))


def _slow_place(model: Model, last: StepRecord) -> Iterator[Caution]:
    """Warn if the largest von Mises stress lies at a place where it converges slowly or not at all."""
    regions = [region for region in last.regions.values() if "von_mises" in region.fields]
    if not regions:
        return
    region = max(regions, key=lambda record: float(record.fields["von_mises"].max()))
    place = _place_of_largest(region)
    where = ", ".join(readable(value, "m") for value in place)
    grid = model.grid
    edge = max(grid.edges)
    if model.friction is not None and place[2] < 0.5 * edge and _at_the_edge(model, last, place):
        words = (
            f"the largest von Mises stress, at ({where}), lies at the edge of a contact with friction, where it "
            "converges only with the square root of the cell size; compare with finer cells"
        )
        yield Caution("slow-place", words, number="max_von_mises", order=0.5)
    for source in model.sources:
        if source.body == region.body and not isinstance(source.shape, Patch) and _on_a_rim(source.shape, place, edge):
            words = (
                f"the largest von Mises stress, at ({where}), lies on an edge of {source.name!r}, where stress grows "
                "without limit with finer cells and closer points; compare stress at a fixed distance from the edge"
            )
            yield Caution("slow-place", words, number="max_von_mises")
            return


def _place_of_largest(region: RegionRecord) -> tuple[float, float, float]:
    values = region.fields["von_mises"]
    index = dict(zip(region.dims, np.unravel_index(int(np.argmax(values)), values.shape), strict=True))
    x, y, z = (np.asarray(region.coords[name], dtype=float) for name in "xyz")
    point = index.get("point")
    at = [
        axis[index[name] if point is None else point] if axis.ndim else axis
        for name, axis in zip("xyz", (x, y, z), strict=True)
    ]
    return float(at[0]), float(at[1]), float(at[2])


def _at_the_edge(model: Model, last: StepRecord, place: tuple[float, float, float]) -> bool:
    """Whether the cells within two cells of a point include cells in contact and cells outside it."""
    grid, loaded = model.grid, last.fields["pressure"] > 0
    j, i = (
        int(np.clip(round((at - axis[0]) / pitch), 0, axis.size - 1))
        for at, axis, pitch in (
            (place[1], grid.y, grid.dy),
            (place[0], grid.x, grid.dx),
        )
    )
    around = loaded[max(j - 2, 0) : j + 3, max(i - 2, 0) : i + 3]
    return bool(around.any() and not around.all())


def _on_a_rim(shape: object, place: tuple[float, float, float], edge: float) -> bool:
    """Whether a place is on two faces of the bounds of a region at once (never for bodies without edges)."""
    low, high = shape.bounds  # type: ignore[attr-defined]
    near = [min(abs(at - lo), abs(at - hi)) < _NEAR * edge for at, lo, hi in zip(place, low, high, strict=True)]
    within = all(lo - _NEAR * edge < at < hi + _NEAR * edge for at, lo, hi in zip(place, low, high, strict=True))
    return within and sum(near) >= 2
