"""Checks of a stored step without finite elements, and the gap of the contact by the displacement of the elements.

The checks: balance, contact conditions, bounds of friction, history of the materials.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eigencontact_verification.audit.cases import AuditCase
from eigencontact_verification.crosscheck.case import Case, Fields, Level, Outer
from eigencontact_verification.crosscheck.judge import JudgedCase, Row

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from eigencontact_verification.audit.stored import StoredStep

__all__ = ["WithoutElements", "checked", "gap_in_words"]

#: A run promises its residuals to its tolerance; what follows from them may be so many times it.
_MARGIN = 10.0
#: Round-off of sums over all cells.
_ROUND_OFF = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class WithoutElements(Case):
    """Case of rows in a report that need no solution of their own."""

    def __post_init__(self) -> None:
        """Without profiles."""

    def reference(self, level: Level, outer: Outer) -> Fields:  # noqa: ARG002
        """Nothing."""
        return {}

    def judged(self) -> Fields:
        """Nothing."""
        return {}


def checked(stored: StoredStep) -> JudgedCase:
    """Rows of the checks of a step, as a case of their own."""
    name = f"step-{stored.step}-checks"
    rows = tuple(
        Row(
            subject=stored.name, case=name, profile=profile, quantity="check", component=component,
            word="agrees" if value <= allowed else "disagrees",
            reason=f"{value:.2g} of {allowed:.2g} allowed", difference=value, uncertainty=allowed,
        )
        for profile, component, value, allowed in _checks(stored)
    )  # fmt: skip
    case = WithoutElements(subject=stored.name, name=name, parameters={"step": stored.step}, quick=True, profiles=())
    return JudgedCase(case=case, rows=rows, outcomes=(), judged={}, estimates={})


def _checks(stored: StoredStep) -> Iterator[tuple[str, str, float, float]]:
    """Words, component, what was found and what is allowed, both relative."""
    tolerance = max(_MARGIN * stored.scene.numerics.tolerance, _ROUND_OFF)
    surface, scalars, window = stored.surface, stored.scalars, stored.window
    area = window.cell[0] * window.cell[1]
    pressure = surface.get("pressure")
    if pressure is not None and np.any(pressure):
        yield from _resultants(stored, area, tolerance)
        largest = float(pressure.max())
        yield "pressure is not negative", "p", float(max(0.0, -pressure.min())) / largest, tolerance
        if "gap" in surface and "approach" in scalars:
            yield from _complementarity(stored, tolerance)
    if "shear_bound" in surface and pressure is not None and np.any(pressure):
        yield from _friction(stored, tolerance)
    for name, values in stored.history.items():
        if name.startswith("plastic_strain_"):
            size = float(np.nanmax(np.abs(values), initial=0.0))
            if size > 0.0:
                trace = float(np.nanmax(np.abs(values[:3].sum(axis=0)))) / size
                yield "plastic strain keeps the volume", "tr e_p", trace, 1e-9
        if name.startswith("damage_"):
            outside = max(0.0, -float(np.nanmin(values)), float(np.nanmax(values)) - (1.0 - 1e-12))
            yield "damage is in [0, 1)", "D", outside, 0.0


def _resultants(stored: StoredStep, area: float, tolerance: float) -> Iterator[tuple[str, str, float, float]]:
    """Resultants of the tractions against the loads and moments that are stored."""
    surface, scalars, window = stored.surface, stored.scalars, stored.window
    force = float(surface["pressure"].sum()) * area
    for name, component, field in (
        ("normal_load", "F_z", "pressure"),
        ("tangential_load_x", "F_x", "shear_x"),
        ("tangential_load_y", "F_y", "shear_y"),
    ):
        if name in scalars and field in surface:
            yield (
                "resultant is the load",
                component,
                abs(surface[field].sum() * area - scalars[name]) / force,
                tolerance,
            )
    arms = {"moment_x": surface["pressure"] * window.y[:, None], "moment_y": -surface["pressure"] * window.x}
    reach = max(float(np.ptp(window.x)), float(np.ptp(window.y)))
    moved = any(stored.scalars.get(f"travel_{axis}", 0.0) != 0.0 for axis in "xy")
    for name, lever in arms.items():
        if name in scalars and not moved:
            difference = abs(float(lever.sum()) * area - scalars[name])
            yield "moment is the stored one", f"M_{name[-1]}", difference / (force * reach), tolerance


def _complementarity(stored: StoredStep, tolerance: float) -> Iterator[tuple[str, str, float, float]]:
    """No gap where there is pressure, no overlap elsewhere; both as parts of the approach."""
    gap, pressure = stored.surface["gap"], stored.surface["pressure"]
    depth = max(abs(stored.scalars["approach"]), float(np.abs(stored.surface.get("displacement_z", gap)).max()))
    if depth == 0.0:
        return
    touching = pressure > 0.0
    yield "no gap where there is pressure", "gap", float(np.abs(gap[touching]).max()) / depth, tolerance
    if not touching.all():
        yield "no overlap where there is none", "gap", max(0.0, -float(gap[~touching].min())) / depth, tolerance


def _friction(stored: StoredStep, tolerance: float) -> Iterator[tuple[str, str, float, float]]:
    """Shear within its bound, and against the slip where cells slip."""
    surface = stored.surface
    zero = np.zeros_like(surface["shear_bound"])
    shear = np.stack([surface.get("shear_x", zero), surface.get("shear_y", zero)])
    size, bound = np.hypot(*shear), surface["shear_bound"]
    largest = float(bound.max())
    if largest <= 0.0:
        return
    yield "shear is within its bound", "q", max(0.0, float((size - bound).max())) / largest, tolerance
    if "slip_x" not in surface or "contact_zone" not in surface or stored.scene.wear is not None:
        return  # where surfaces wear they slide a given distance, and the stored slip is what is left of it
    slip = np.stack([surface["slip_x"], surface.get("slip_y", zero)])
    speed = np.hypot(*slip)
    slipping = (surface["contact_zone"] == 1) & (speed > 1e-3 * speed.max(initial=0.0)) & (size > 0.0)
    if slipping.any():
        # body 1 slips on body 2 against the shear that acts on it: their product is less than minus their sizes by this
        power = (shear * slip).sum(axis=0)[slipping] + (size * speed)[slipping]
        ratio = float(np.abs(power).max() / (size * speed)[slipping].max())
        yield "shear is against the slip", "q", ratio, max(tolerance, 1e-3)


def gap_in_words(stored: StoredStep, judged: Iterable[JudgedCase]) -> list[str]:
    """Sentences with the gap that finite elements leave under the stored pressure, and the overlap beside it.

    The gap of the elements is the stored one with their displacement in place of the stored one; an overlap is a gap
    below zero.
    """
    if "gap" not in stored.surface or "pressure" not in stored.surface:
        return []
    gaps: list[tuple[float, float, bool]] = []
    for case in judged:
        if not isinstance(case.case, AuditCase) or case.case.subject != stored.name:
            continue
        for line in case.case.lines:
            estimate = case.estimates.get(line.profile.name)
            if line.body or estimate is None or "u_z" not in line.profile.components:
                continue
            column = line.profile.components.index("u_z")
            gap = stored.surface["gap"][line.indices] + estimate.value[:, column] - line.values[:, column]
            touching = stored.surface["pressure"][line.indices] > 0.0
            band = estimate.uncertainty[:, column]
            gaps += [(float(g), float(b), bool(t)) for g, b, t in zip(gap, band, touching, strict=True)]
    if not gaps:
        return []
    depth = abs(stored.scalars.get("approach", 0.0))
    inside, outside = ([(gap, band) for gap, band, touching in gaps if touching is state] for state in (True, False))
    words = []
    if inside:
        largest, around = max(inside, key=lambda pair: abs(pair[0]))
        words.append(f"largest gap where there is pressure {_length(largest, depth)}, u_FE {_length(around, depth)}")
    if outside:
        least, around = min(outside)
        sentence = f"largest overlap where there is none {_length(-least, depth)}, u_FE {_length(around, depth)}"
        words.append(sentence if least < 0.0 else "no overlap where there is no pressure")
    return [f"{stored.name}, step {stored.step}, by finite elements under the stored tractions: {'; '.join(words)}."]


def _length(value: float, depth: float) -> str:
    share = f" ({100 * value / depth:.2g} % of the approach)" if np.isfinite(depth) and depth > 0.0 else ""
    return f"{value:.3g} m{share}"
