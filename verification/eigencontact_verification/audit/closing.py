"""What a judged displacement says of the contact: the gap where there is pressure, the overlap where there is none."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eigencontact_verification.audit.cases import AuditCase

if TYPE_CHECKING:
    from collections.abc import Iterable

    from eigencontact_verification.audit.stored import StoredStep
    from eigencontact_verification.crosscheck.judge import JudgedCase

__all__ = ["gap_in_words"]


def gap_in_words(stored: StoredStep, judged: Iterable[JudgedCase]) -> list[str]:
    """Sentences with the gap that finite elements leave under the stored pressure, and the overlap beside it.

    The gap of the elements is the stored one with their displacement in place of the stored one; an overlap is a gap
    below zero.
    """
    if "gap" not in stored.surface or "pressure" not in stored.surface:
        return []
    found: list[tuple[float, float, bool]] = []
    for one in judged:
        if not isinstance(one.case, AuditCase) or one.case.subject != stored.name:
            continue
        for line in one.case.lines:
            estimate = one.estimates.get(line.profile.name)
            if line.body or estimate is None or "u_z" not in line.profile.components:
                continue
            column = line.profile.components.index("u_z")
            gap = stored.surface["gap"][line.indices] + estimate.value[:, column] - line.values[:, column]
            touching = stored.surface["pressure"][line.indices] > 0.0
            band = estimate.uncertainty[:, column]
            found += [(float(g), float(b), bool(t)) for g, b, t in zip(gap, band, touching, strict=True)]
    if not found:
        return []
    depth = abs(stored.scalars.get("approach", 0.0))
    inside, outside = ([(gap, band) for gap, band, touching in found if touching is wanted] for wanted in (True, False))
    words = []
    if inside:
        largest, around = max(inside, key=lambda pair: abs(pair[0]))
        words.append(f"largest gap where there is pressure {_length(largest, depth)}, u_FE {_length(around, depth)}")
    if outside:
        least, around = min(outside)
        said = f"largest overlap where there is none {_length(-least, depth)}, u_FE {_length(around, depth)}"
        words.append(said if least < 0.0 else "no overlap where there is no pressure")
    return [f"{stored.name}, step {stored.step}, by finite elements under the stored tractions: {'; '.join(words)}."]


def _length(value: float, depth: float) -> str:
    part = f" ({100 * value / depth:.2g} % of the approach)" if np.isfinite(depth) and depth > 0.0 else ""
    return f"{value:.3g} m{part}"
