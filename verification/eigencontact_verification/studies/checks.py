"""Checks of a study: statements on its trend, and whether the numbers satisfy them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from eigencontact.errors import SceneError, shown
from eigencontact_verification.studies.formula import Context, evaluate
from eigencontact_verification.studies.study import Finished, Study

__all__ = ["Verdict", "verdicts"]


@dataclass(frozen=True)
class Verdict:
    """A check and its outcome."""

    check: str  #: statement in words
    holds: bool  #: whether the numbers satisfy it
    numbers: str  #: in words

    def to_dict(self) -> dict[str, Any]:
        """Table for JSON; the numbers are stored as ``found``."""
        return {"check": self.check, "holds": self.holds, "found": self.numbers}


def verdicts(study: Study, variants: Sequence[Finished]) -> list[Verdict]:
    """Verdict of each check of a study that its variants can tell of; the numbers are those that were read."""
    return [verdict for check in study.checks for verdict in _verdicts(check, variants)]


def _verdicts(check: Mapping[str, Any], variants: Sequence[Finished]) -> list[Verdict]:
    rule, along = check["is"], str(check.get("along", ""))
    chosen = [
        variant
        for variant in variants
        if "only" not in check or bool(evaluate(check["only"], Context(variant.names), "only"))
    ]
    numbers = [float(evaluate(check["number"], Context(variant.names), "check.number")) for variant in chosen]
    if isinstance(rule, list) and len(rule) == 2:
        claim = f"{check['number']} within {rule[0]:g} and {rule[1]:g}"
        holds = all(rule[0] <= number <= rule[1] for number in numbers)
        return [Verdict(claim, holds, _listed(numbers))] if numbers else []
    if rule not in ("rising", "falling") or not along:
        raise SceneError(f"check.is must be rising or falling with along, or two bounds (got {shown(rule)})")
    out, sign = [], 1.0 if rule == "rising" else -1.0
    groups: dict[Any, list[tuple[float, float]]] = {}
    for variant, number in zip(chosen, numbers, strict=True):
        other_values = tuple((name, value) for name, value in variant.values.items() if name != along)
        groups.setdefault(other_values, []).append((float(evaluate(along, Context(variant.names), "along")), number))
    for other_values, points in groups.items():
        if len(points) < 2:
            continue
        course = [number for _, number in sorted(points)]
        where = ", ".join(f"{name} = {value}" for name, value in other_values)
        claim = f"{check['number']} {rule} along {along}{f' at {where}' if where else ''}"
        out.append(Verdict(claim, all(sign * (b - a) > 0 for a, b in pairwise(course)), _listed(course)))
    return out


def _listed(numbers: Sequence[float]) -> str:
    return ", ".join(f"{number:.4g}" for number in numbers)
