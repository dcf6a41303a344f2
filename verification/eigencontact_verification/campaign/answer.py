"""Answers of a map in words: totals, and the range in which a model agrees."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

from eigencontact_verification.campaign.figure import axes_of_map, quantities_of
from eigencontact_verification.reporting.verdict import WORDS, percent
from eigencontact_verification.studies.study import number_of, plain

if TYPE_CHECKING:
    from eigencontact_verification.campaign.campaign import Campaign
    from eigencontact_verification.campaign.finding import JudgedPoint

__all__ = ["answers", "totals"]


def totals(campaign: Campaign, points: Sequence[JudgedPoint]) -> str:
    """Numbers of points and verdicts in sentences, claims first."""
    inside = [finding.word for point in points for finding in point.findings if finding.claimed]
    broken = sum(word in ("disagrees", "failed") for word in inside)
    verdicts = [finding.word for point in points for finding in point.findings]
    counts = ", ".join(f"{verdicts.count(word)} {word}" for word in reversed(WORDS) if verdicts.count(word))
    claims = [f"{point.name} where {point.expect}" for point in campaign.quantities if point.expect]
    claim = ", ".join([f"where {campaign.expect}" if campaign.expect else "everywhere", *claims])
    agree = inside.count("agrees")
    if not inside:
        return f"{len(points)} points, {len(verdicts)} verdicts: {counts}. Agreement is claimed nowhere."
    last = f"{broken} disagree or failed" if broken else "none disagrees"
    return (
        f"{len(points)} points, {len(verdicts)} verdicts: {counts}. Agreement is claimed {claim}: "
        f"{len(inside)} verdicts, of which {agree} agree, {len(inside) - agree - broken} are inconclusive, {last}."
    )


def answers(campaign: Campaign, points: Sequence[JudgedPoint]) -> list[str]:
    """For each quantity: from which value of the parameter across, or up to which, every point agrees.

    Only points from that value to the end of the axis count, so that an island of agreement is no answer. Empty where
    the parameter across has no order.
    """
    x, y, panel_axes = axes_of_map(campaign, points)
    parameters = [name for name in (y, *panel_axes) if name is not None]
    groups: dict[tuple[str, tuple[Any, ...]], list[tuple[float, str]]] = {}
    for point in points:
        at = number_of(point.point.values.get(x))
        if not isinstance(at, int | float):
            return []
        key = tuple(point.point.values.get(name) for name in parameters)
        for finding in point.findings:
            groups.setdefault((finding.quantity, key), []).append((at, finding.word))
    levels = list(dict.fromkeys(key for _, key in groups))
    lines = []
    for name, key in product(quantities_of(campaign, points), levels):
        course = sorted(groups.get((name, key), []))
        if len(course) < 2:
            continue
        where = ", ".join(f"{parameter} = {plain(value)}" for parameter, value in zip(parameters, key, strict=True))
        lines.append(f"{name}{f', {where}' if where else ''}: {_span(course, x)}")
    return [f"Within {percent(campaign.tolerance)} (or the tolerance of its own):", *lines] if lines else []


def _span(course: Sequence[tuple[float, str]], x: str) -> str:
    agree = [word == "agrees" for _, word in course]
    if all(agree):
        return f"everywhere, {x} = {plain(course[0][0])} to {plain(course[-1][0])}"
    upper = next((k for k in range(len(agree)) if all(agree[k:])), len(agree))
    lower = next((k for k in range(len(agree), 0, -1) if all(agree[:k])), 0)
    ranges = []
    if lower:
        ranges.append(f"up to {x} = {plain(course[lower - 1][0])}")
    if upper < len(course):
        ranges.append(f"from {x} = {plain(course[upper][0])}")
    return " and ".join(ranges) or "nowhere at an end of the axis"
