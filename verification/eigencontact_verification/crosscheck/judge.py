"""From the solutions of a case to a verdict on each component of each profile."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from eigencontact_verification.crosscheck.case import Case, Fields, Profile, error_key
from eigencontact_verification.crosscheck.run import Solved
from eigencontact_verification.crosscheck.worker import Outcome, Task
from eigencontact_verification.fem.uncertainty import Estimate, Verdict, estimate, verdicts
from eigencontact_verification.reporting.verdict import WORDS, Finding, largest, worst

__all__ = ["SOURCES", "Coverage", "JudgedCase", "Row", "coverage", "judge"]

#: Origin of each part of an uncertainty, in words.
SOURCES = {
    "discretisation": "the mesh of the finite elements",
    "truncation": "the outer faces of the finite elements",
    "iteration": "the solver of the finite elements",
    "judged": "the cells of the semi-analytical model",
}


@dataclass(frozen=True, kw_only=True)
class Row(Finding):
    """Verdict on one component of one profile.

    Attributes
    ----------
    subject, case, profile, component : str
        What is judged.
    difference : float or None
        Largest |SA - FE|, as `uncertainty` a part of the field's largest value on the profile.
    discretisation, truncation : float or None
        Largest parts of the uncertainty, on the same scale.
    ratio : float or None
        Largest difference over uncertainty at one point.
    order : float or None
        Observed order of convergence; None where the meshes do not differ.
    credible : bool
        Whether the order is believed.
    """

    subject: str
    case: str
    profile: str
    component: str
    difference: float | None = None
    discretisation: float | None = None
    truncation: float | None = None
    ratio: float | None = None
    order: float | None = None
    credible: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class JudgedCase:
    """A case with its verdicts, and what the figures show.

    Attributes
    ----------
    case : Case
    rows : tuple of Row
        By profile and component.
    outcomes : tuple of (Task, Outcome)
        How the solutions went.
    judged : dict
        Semi-analytical values by name of profile; empty if that failed.
    estimates : dict
        Reference by name of profile; empty if a solution failed.
    """

    case: Case
    rows: tuple[Row, ...]
    outcomes: tuple[tuple[Task, Outcome], ...]
    judged: Fields
    estimates: dict[str, Estimate]

    @property
    def word(self) -> str:
        """Worst verdict."""
        return worst(row.word for row in self.rows)


def judge(solved: Solved, *, limit: float = 0.02) -> JudgedCase:
    """Verdicts of a case; where a solution is missing every component has failed, which is no agreement."""
    case = solved.case
    missing = [f"{task.label}: {outcome.reason}" for task, outcome in solved.outcomes if outcome.fields is None]
    values = {(task.level, task.outer): outcome.fields for task, outcome in solved.outcomes if outcome.fields}
    judged = values.get((None, "fixed")) or {}
    if missing:
        rows = [
            Row(
                subject=case.subject, case=case.name, profile=profile.name, quantity=profile.quantity,
                component=component, word="failed", reason="; ".join(missing),
            )
            for profile in case.profiles
            for component in profile.components
        ]  # fmt: skip
        return JudgedCase(case=case, rows=tuple(rows), outcomes=solved.outcomes, judged=judged, estimates={})
    estimates, rows = {}, []
    for profile in case.profiles:
        coarse, medium, fine = (values[level, "fixed"][profile.name] for level in (0, 1, 2))
        reference = estimate(
            coarse, medium, fine, ratio=case.ratio, formal_order=profile.formal_order,
            other_outer=values[case.bracket_level, "free"][profile.name], other_level=case.bracket_level,
        )  # fmt: skip
        if error_key(profile.name) in judged:
            error = judged[error_key(profile.name)]
            reference = replace(
                reference, uncertainty=reference.uncertainty + error, parts=reference.parts | {"judged": error}
            )
        estimates[profile.name] = reference
        results = verdicts(
            judged[profile.name], reference, limit=limit, small=case.small,
            scale=_size_of_field(values[2, "fixed"], case, profile),
        )  # fmt: skip
        for k, (component, result) in enumerate(zip(profile.components, results, strict=True)):
            rows.append(_row(case, profile, component, result, reference, k, limit))
    return JudgedCase(case=case, rows=tuple(rows), outcomes=solved.outcomes, judged=judged, estimates=estimates)


def _size_of_field(fine: Fields, case: Case, profile: Profile) -> float:
    """Largest value of the profile's quantity in the whole case: the field whose parts the profiles are.

    What a material remembers is a field of its own for every variable.
    """
    alike = [candidate.name for candidate in case.profiles if candidate.quantity == profile.quantity]
    alike = [profile.name] if profile.quantity == "strain" else alike
    return max(float(np.max(np.abs(fine[name]))) for name in alike)


def _row(
    case: Case, profile: Profile, component: str, verdict: Verdict, reference: Estimate, k: int, limit: float
) -> Row:
    contributions = {name: float(np.max(values[:, k])) for name, values in reference.parts.items()}
    reason = verdict.reason
    if verdict.word == "inconclusive" and _finite(verdict.uncertainty):
        reason += _cause(case, max(contributions, key=lambda name: contributions[name]), contributions, verdict, limit)
    return Row(
        subject=case.subject, case=case.name, profile=profile.name, quantity=profile.quantity, component=component,
        word=verdict.word, reason=reason, difference=_share(verdict.difference, verdict.scale),
        uncertainty=_share(verdict.uncertainty, verdict.scale), ratio=_finite(verdict.ratio),
        discretisation=_share(contributions["discretisation"], verdict.scale),
        truncation=_share(contributions["truncation"], verdict.scale), scale=_finite(verdict.scale),
        order=_finite(float(reference.order[k])), credible=bool(reference.credible[k]),
    )  # fmt: skip


def _cause(case: Case, source: str, contributions: Mapping[str, float], verdict: Verdict, limit: float) -> str:
    """Largest part of an uncertainty that allows no verdict, and what a user can do about it."""
    share = _share(contributions[source], verdict.scale)
    sentence = f"; its largest part is {SOURCES[source]}" + ("" if share is None else f" ({100 * share:.2g} %)")
    excess = verdict.uncertainty / (limit * verdict.scale) if verdict.scale > 0.0 else 1.0
    remedy = case.remedy(source, excess)
    return f"{sentence}; {remedy}" if remedy else sentence


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _share(value: float, scale: float) -> float | None:
    return _finite(value / scale) if scale > 0.0 else None


@dataclass(frozen=True, kw_only=True)
class Coverage:
    """All verdicts on one component of one quantity of one kernel.

    Attributes
    ----------
    subject, quantity, component : str
    word : str
        Worst of the verdicts.
    counts : dict
        Number of profiles by verdict.
    difference, uncertainty : float or None
        Largest of all profiles that were solved, as parts of the field.
    """

    subject: str
    quantity: str
    component: str
    word: str
    counts: dict[str, int]
    difference: float | None
    uncertainty: float | None


def coverage(rows: Iterable[Row]) -> list[Coverage]:
    """Kernel × quantity × component, in the order of the rows."""
    groups: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        groups.setdefault((row.subject, row.quantity, row.component), []).append(row)
    return [
        Coverage(
            subject=subject, quantity=quantity, component=component, word=worst(row.word for row in of),
            counts={word: sum(row.word == word for row in of) for word in WORDS},
            difference=largest(row.difference for row in of), uncertainty=largest(row.uncertainty for row in of),
        )
        for (subject, quantity, component), of in groups.items()
    ]  # fmt: skip
