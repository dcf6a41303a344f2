"""A study: plan every variant, solve one after the other, judge each by the reference."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from statistics import median
from typing import Any

from eigencontact.accuracy.changes import changed
from eigencontact_verification.tradeoff.errors import HEADLINES, errors
from eigencontact_verification.tradeoff.process import Solved, solve_fresh
from eigencontact_verification.tradeoff.variant import Variant

__all__ = ["Prediction", "Row", "Study", "fronts", "predict", "standing", "study"]

#: Prices by name, and their attributes of a row.
_PRICES = {"time": "seconds", "memory": "memory"}
_ROUNDING = 1.02


@dataclass(frozen=True, kw_only=True)
class Prediction:
    """Prediction of the planner for a variant; ``reason`` is that of its refusal."""

    variant: Variant
    cells: tuple[int, int] | None = None
    seconds: float | None = None
    memory: float | None = None
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One variant: predicted, measured, judged. Times in s, memory in bytes, errors relative.

    ``error`` is the first of ``errors`` that `HEADLINES` names; ``fronts`` names what it is not beaten in: "time",
    "memory".
    """

    prediction: Prediction
    status: str
    reason: str = ""
    seconds: float | None = None
    memory: float | None = None
    cells: tuple[int, int] | None = None
    errors: Mapping[str, float] = field(default_factory=dict)
    error: float | None = None
    fronts: tuple[str, ...] = ()
    bars: Mapping[str, float] = field(default_factory=dict)  #: error bars of scene and reference, named as `errors`

    @property
    def variant(self) -> Variant:
        """The variant."""
        return self.prediction.variant


@dataclass(frozen=True, kw_only=True)
class Study:
    """Rows of a study; the first one is the reference."""

    name: str  #: name of the scene
    headline: str  #: name of the error by which the rows are compared
    rows: tuple[Row, ...]
    note: str = ""  #: says where the reference could not be solved and another row stands in for it


def predict(resolved: Mapping[str, Any], variants: Sequence[Variant]) -> list[Prediction]:
    """Plan each variant without solving."""
    from eigencontact import app
    from eigencontact.errors import EigencontactError
    from eigencontact.planning.memory import run_bytes

    predictions = []
    scene = None
    for variant in variants:
        try:
            plan = app.plan(changed(resolved, variant.changes))
        except EigencontactError as problem:
            predictions.append(Prediction(variant=variant, reason=" ".join(str(problem).split())))
            continue
        scene = plan if variant.key == "scene" else scene
        affected = None if variant.fidelity is None else variant.fidelity.affected_part
        if affected is not None and scene is not None and affected(plan) == affected(scene):
            predictions.append(Prediction(variant=variant, reason="the plan is that of the scene"))
            continue
        memory = run_bytes(plan, stored=False)
        cells = (plan.grid.nx, plan.grid.ny)
        predictions.append(Prediction(variant=variant, cells=cells, seconds=plan.seconds, memory=memory))
    return predictions


def study(
    name: str,
    resolved: Mapping[str, Any],
    predictions: Sequence[Prediction],
    *,
    limit: float,
    memory: float,
    repeat: int = 1,
    with_bars: bool = False,
    solve: Callable[[Mapping[str, Any], float], Solved] | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> Study:
    """Solve and judge; a variant that is refused, fails or takes too long is a row with its reason.

    Parameters
    ----------
    resolved : mapping
        Tables of the scene.
    predictions : sequence of Prediction
        The first is the reference.
    limit, memory : float
        Time [s] and memory [byte] of one variant; one that the planner predicts above them does not start.
    repeat : int
        Processes for each variant: the median of their times, the largest of their peaks.
    with_bars : bool
        Whether scene and reference estimate their own errors, in the first of their processes, which then may take
        twice the limit. The coarser runs do not count in its time; they need less memory than the run itself.
    solve : callable
        Tables and limit to `Solved`; by default in a fresh process.
    tell : callable
        Called before each variant, with its words.

    Raises
    ------
    ValueError
        Nothing could be solved.
    """
    solve = solve or solve_fresh
    solved: list[Solved] = []
    rows: list[Row] = []
    for prediction in predictions:
        if reason := _refused(prediction, limit, memory):
            laps = [Solved(status="refused", reason=reason)]
        else:
            tell(f"{prediction.variant.key}: {prediction.variant.words}")
            tables = changed(resolved, prediction.variant.changes)
            barred = with_bars and prediction.variant.key in ("scene", "reference")
            first = {**tables, "output": {**tables["output"], "errors": True}} if barred else tables
            laps = [solve(first, limit * (2 if barred else 1)), *(solve(tables, limit) for _ in range(1, repeat))]
        solved.append(next((lap for lap in laps if lap.status != "ok"), laps[0]))
        rows.append(_row(prediction, solved[-1], laps))
    best, note = _reference(rows)
    reference = solved[best]
    for k, answer in enumerate(solved):
        if answer.status == "ok" and k != best:
            differences = errors(answer.numbers, answer.fields, reference.numbers, reference.fields)
            rows[k] = replace(rows[k], errors=differences)
    headline = next((name for name in HEADLINES if any(name in row.errors for row in rows)), HEADLINES[0])
    judged = [replace(row, error=row.errors.get(headline)) for row in rows]
    judged = [replace(row, fronts=mark) for row, mark in zip(judged, fronts(judged), strict=True)]
    judged.insert(0, judged.pop(best))
    return Study(name=name, headline=headline, rows=tuple(judged), note=note)


def standing(study: Study) -> list[str]:
    """Place of the scene as it stands on each front, or the variant that is as accurate at a lower price."""
    scene = next((row for row in study.rows if row.variant.key == "scene" and row.error is not None), None)
    if scene is None:
        return []
    sentences = []
    for word, name in _PRICES.items():
        front = sorted((row for row in study.rows if word in row.fronts), key=lambda row: getattr(row, name))
        if scene in front:
            place = f"point {front.index(scene) + 1} of {len(front)} from the cheapest"
            sentences.append(f"front of {word}: the scene stands on it, {place}")
            continue
        point = scene.error, getattr(scene, name)
        better = [
            (getattr(row, name) / getattr(scene, name), number, row.variant.words)
            for number, row in enumerate(study.rows)
            if row.error is not None and _beats((row.error, getattr(row, name)), point)
        ]
        for share, number, label in sorted(better)[:1]:
            beside = "within 2 % of it" if share * _ROUNDING > 1.0 else "not on it"
            cheaper = f"{number} ({label}) is as accurate at {share:.2g} of its {word}"
            sentences.append(f"front of {word}: the scene is {beside}; {cheaper}")
    return sentences


def fronts(rows: Sequence[Row]) -> list[tuple[str, ...]]:
    """For each row, in which of time and memory no other row beats it: a lower price at an error as small.

    Errors within `_ROUNDING` of each other count as the same, so that rounding puts nothing on the front.
    """
    unbeaten: dict[str, list[bool]] = {}
    for word, name in _PRICES.items():
        points = [(row.error, getattr(row, name)) for row in rows]
        whole = [(error, price) for error, price in points if error is not None and price is not None]
        unbeaten[word] = [point in whole and not any(_beats(rival, point) for rival in whole) for point in points]
    return [tuple(word for word in unbeaten if unbeaten[word][k]) for k in range(len(rows))]


def _beats(rival: tuple[float, float], point: tuple[Any, Any]) -> bool:
    if rival[1] == point[1]:
        return bool(rival[0] < point[0])
    return bool(rival[1] < point[1] and rival[0] <= _ROUNDING * point[0])


def _refused(prediction: Prediction, limit: float, memory: float) -> str:
    if prediction.reason:
        return prediction.reason
    if prediction.seconds is not None and prediction.seconds > limit:
        return f"predicted time {prediction.seconds:.0f} s is above --time {limit:.0f}"
    if prediction.memory is not None and prediction.memory > memory:
        return f"predicted memory {1e-9 * prediction.memory:.1f} GB is above --memory {1e-9 * memory:.1f}"
    return ""


def _row(prediction: Prediction, answer: Solved, laps: Sequence[Solved]) -> Row:
    if answer.status != "ok":
        return Row(prediction=prediction, status=answer.status, reason=answer.reason)
    nx, ny = laps[0].numbers["cells"]
    return Row(
        prediction=prediction,
        status="ok",
        seconds=median(lap.numbers["seconds"] for lap in laps),
        memory=max(lap.numbers["peak_bytes"] for lap in laps),
        cells=(nx, ny),
        bars=laps[0].numbers.get("bars", {}),
    )


def _reference(rows: Sequence[Row]) -> tuple[int, str]:
    """Number of the reference: the one planned, or else the scene as it stands, or the finest that was solved."""
    if rows[0].status == "ok":
        return 0, ""
    solved = [k for k, row in enumerate(rows) if row.status == "ok"]
    if not solved:
        raise ValueError(f"no variant could be solved (reference: {rows[0].reason}); see --plan")
    # the scene as it stands comes first where two have as many cells
    best = max(solved, key=lambda k: (_cells(rows[k]), -k))
    return best, f"the reference was not solved ({rows[0].reason}); {rows[best].variant.words!r} stands in for it"


def _cells(row: Row) -> int:
    return row.cells[0] * row.cells[1] if row.cells else 0
