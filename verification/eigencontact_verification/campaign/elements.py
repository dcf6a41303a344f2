"""Judge of a campaign: finite elements, under the tractions of each run, or with a contact of their own.

The verdict of a map asks how far the run is from the truth, its cells included. What the run says of its own error (see
`crosscheck.case.error_key`) is therefore no part of the uncertainty here, as it is where a code is verified. Runs with
error bars have their numbers compared too, with the bar beside the error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.errors import EigencontactError
from eigencontact_verification.campaign.finding import JudgedPoint, MapFinding
from eigencontact_verification.crosscheck.judge import JudgedCase, judge
from eigencontact_verification.crosscheck.run import Limits, in_processes, run_cases
from eigencontact_verification.crosscheck.store import Store
from eigencontact_verification.reporting.verdict import largest, word_of

if TYPE_CHECKING:
    from eigencontact.engines.cluster import Cluster
    from eigencontact_verification.campaign.campaign import Campaign
    from eigencontact_verification.campaign.runs import Point
    from eigencontact_verification.crosscheck.case import Case, Gap, Profile
    from eigencontact_verification.crosscheck.run import Executor, Progress

__all__ = ["CasesOf", "cases_for", "executor_for", "judge_by_elements", "plugins_of"]

#: Cases of a folder of results, and what cannot be judged of it.
CasesOf = Callable[[Path], "tuple[Sequence[Case], Sequence[Gap]]"]


def cases_for(campaign: Campaign, *, coarse: bool) -> CasesOf:
    """Return the function that makes the cases of a run for the judge of a campaign."""
    quick = coarse or not campaign.full_meshes
    from eigencontact_verification.audit import cases_of, contact_cases_of

    return partial(contact_cases_of if campaign.judge == "contact" else cases_of, quick=quick)


def executor_for(
    plugins: Iterable[str], *, workers: int = 1, cluster: Cluster | None = None, memory: float | None = None
) -> Executor:
    """Processes within limits of memory [byte], or a cluster, for the solutions; both load the plugin files."""
    if cluster is None:
        limits = Limits() if memory is None else Limits(memory=memory)
        return partial(in_processes, workers=workers, limits=limits, plugins=tuple(plugins))
    from eigencontact_verification.crosscheck.cluster import on_cluster

    return partial(on_cluster, engine=cluster, plugins=tuple(plugins))


def plugins_of(points: Sequence[Point]) -> list[str]:
    """Plugin files of the scenes of points."""
    scenes = [point.model.variant.scene for point in points]
    files = (str(path.resolve()) for scene in scenes if scene is not None for path in scene.plugin_files)
    return list(dict.fromkeys(files))


@dataclass(kw_only=True, eq=False)
class _Question:
    """A point with its cases, or the reason where it has none."""

    point: Point
    cases: list[Case] = field(default_factory=list)
    gaps: list[str] = field(default_factory=list)
    failed: str = ""
    folder: Path = Path()


def judge_by_elements(
    campaign: Campaign, points: Sequence[Point], folder: Path, *, cases_of: CasesOf, executor: Executor,
    progress: Progress | None = None,
) -> list[JudgedPoint]:  # fmt: skip
    """Verdicts of points from the runs in the folder ``runs``; solutions are stored in the folder ``solutions``.

    See `cases_for` and `executor_for`; `progress` learns of the solutions.
    """
    questions = [_question_of(point, folder / "runs", cases_of) for point in points]
    cases = [case for question in questions for case in question.cases]
    solved = run_cases(cases, Store(folder / "solutions"), executor=executor, progress=progress)
    by_key = {outcome.case.key: judge(outcome) for outcome in solved}
    return [_judged(campaign, question, [by_key[case.key] for case in question.cases]) for question in questions]


def _question_of(point: Point, runs: Path, cases_of: CasesOf) -> _Question:
    """Cases of a point, named after it."""
    if point.model.failed:
        return _Question(point=point, failed=point.model.failed)
    label = point.model.variant.label
    try:
        point_cases, gaps = cases_of(runs / label)
    except (EigencontactError, ValueError, OSError) as problem:
        return _Question(point=point, failed=" ".join(str(problem).split()))
    reasons = [f"{gap.what}: {gap.reason}" for gap in gaps]
    failed = "" if point_cases else f"nothing of it can be judged: {'; '.join(reasons) or 'no reason is given'}"
    cases = [replace(case, name=f"{label}_{case.name}") for case in point_cases]
    return _Question(point=point, cases=cases, gaps=reasons, failed=failed, folder=runs / label)


def _judged(campaign: Campaign, question: _Question, cases: Sequence[JudgedCase]) -> JudgedPoint:
    tolerance, claimed = campaign.tolerance, campaign.claimed(question.point.model.names)
    if question.failed:
        nothing = MapFinding(
            quantity="all", word="failed", reason=question.failed, tolerance=tolerance, claimed=claimed
        )
        return JudgedPoint(point=question.point, findings=(nothing,), gaps=tuple(question.gaps))
    groups: dict[str, list[tuple[JudgedCase, Profile]]] = {}
    for case in cases:
        for profile in case.case.profiles:
            name = profile.name if campaign.judge == "contact" else profile.quantity
            groups.setdefault(name, []).append((case, profile))
    numbers = {finding.quantity: finding for finding in _numbers(question.folder, cases, tolerance, claimed=claimed)}
    of_steps = {name for name, group in groups.items() if any(profile.along.size > 1 for _, profile in group)}
    findings = tuple(
        _finding(name, group, tolerance, claimed=claimed)
        for name, group in groups.items()
        if name in of_steps or name not in numbers
    )
    findings += tuple(
        replace(finding, quantity=f"{name} at the end") if name in of_steps else finding
        for name, finding in numbers.items()
    )
    solves = [(task, outcome) for case in cases for task, outcome in case.outcomes if task.level is not None]
    finest = _sum(outcome.seconds for task, outcome in solves if task.level == 2 and task.outer == "fixed")
    return JudgedPoint(
        point=question.point, findings=findings, gaps=tuple(question.gaps), reference_seconds=finest,
        all_seconds=_sum(outcome.seconds for _, outcome in solves),
        reference_memory=largest(outcome.memory for _, outcome in solves),
    )  # fmt: skip


def _finding(name: str, group: Sequence[tuple[JudgedCase, Profile]], tolerance: float, *, claimed: bool) -> MapFinding:
    """Worst of all profiles of a name; errors are parts of the largest value of all."""
    judged_profiles = [(case, profile) for case, profile in group if profile.name in case.estimates]
    if len(judged_profiles) < len(group):
        reasons = {row.reason for case, _ in group for row in case.rows if row.word == "failed"}
        return MapFinding(
            quantity=name, word="failed", reason="; ".join(sorted(reasons)), tolerance=tolerance, claimed=claimed
        )
    values = [(case.judged[profile.name], case.estimates[profile.name]) for case, profile in judged_profiles]
    scale = max(float(np.abs(reference.value).max()) for _, reference in values)
    if not scale > 0.0:
        return MapFinding(quantity=name, word="failed", reason="zero everywhere", tolerance=tolerance, claimed=claimed)
    error, uncertainty = 0.0, 0.0
    for judged, reference in values:
        judged_error: Any = reference.parts.get("judged", 0.0)
        error = _larger(error, float(np.abs(judged - reference.value).max()) / scale)
        uncertainty = _larger(uncertainty, float((reference.uncertainty - judged_error).max()) / scale)
    word, reason = word_of(error, uncertainty, tolerance)
    return MapFinding(
        quantity=name, word=word, reason=reason, tolerance=tolerance, claimed=claimed, error=error,
        uncertainty=uncertainty, scale=scale,
    )  # fmt: skip


def _numbers(folder: Path, cases: Sequence[JudgedCase], tolerance: float, *, claimed: bool) -> Iterator[MapFinding]:
    """Numbers of a run with error bars, with the verdict of `eigencontact verify`."""
    from eigencontact_verification.audit.numbers import compared_numbers
    from eigencontact_verification.audit.stored import bars_of, read_step
    from eigencontact_verification.crosscheck.comparison import Comparison

    bars = bars_of(folder)
    compared, _ = compared_numbers(read_step(folder), bars, cases) if bars else ([], [])
    for row in (row for case in compared for row in case.rows):
        assert isinstance(row, Comparison)
        scale = abs(row.simulation)
        yield MapFinding(
            quantity=row.profile, word=row.word, reason=row.reason, tolerance=tolerance, claimed=claimed,
            error=abs(row.error) / scale, uncertainty=row.u_fe / scale, value=row.simulation, reference=row.reference,
            scale=scale, run_error=row.u_sa / scale,
        )  # fmt: skip


def _larger(first: float, second: float) -> float:
    """Larger of two numbers; nan counts as the largest."""
    return float(np.maximum(first, second))


def _sum(values: Iterable[float | None]) -> float | None:
    numbers = [value for value in values if value is not None]
    return sum(numbers) if numbers else None
