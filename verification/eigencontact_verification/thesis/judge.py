"""Verdicts on the claims of the thesis: the studies behind them are run, and the rules read their rows."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eigencontact.engines.cluster import Cluster
from eigencontact.errors import EigencontactError
from eigencontact_verification.studies.catalogue import STUDIES
from eigencontact_verification.studies.errors import with_errors
from eigencontact_verification.studies.formula import Context, evaluate
from eigencontact_verification.studies.run import Failed, run_study
from eigencontact_verification.studies.study import Study
from eigencontact_verification.thesis.entries import Claim, Entry, Rule
from eigencontact_verification.thesis.rules import Row, error_of, number_of, selected

__all__ = ["VERDICTS", "JudgedClaim", "judged_claims", "verdict_of", "wanted_rows"]

#: Verdicts on a claim; the last but one: the program ought to agree and does not.
VERDICTS = ("agrees", "erratum", "differs", "not comparable", "disagrees", "open")


@dataclass(frozen=True)
class JudgedClaim:
    """A claim of a figure and its verdict."""

    name: str  #: of the figure or table
    says: str
    verdict: str  #: one of `VERDICTS`
    number: str  #: of this program, in words
    text: str  #: number of the text, in words
    why: str  #: reason of the verdict
    source: str  #: study, scene or formula behind it
    error: float | None = None  #: of the number of this program, where its run tells it
    size: str = ""  #: "full" where a quick form would not do

    def to_dict(self) -> dict[str, Any]:
        """Table for JSON; the number of this program is stored as ``found``."""
        return {{"number": "found"}.get(name, name): value for name, value in vars(self).items()}


def judged_claims(
    entries: Sequence[Entry],
    folder: Path,
    *,
    coarse: bool,
    errors: bool = False,
    workers: int = 1,
    cluster: Cluster | None = None,
    tell: Callable[[str], None],
) -> Iterator[JudgedClaim]:
    """Verdicts on the claims of some figures; each study runs once, with the variants that the claims need.

    Parameters
    ----------
    folder : Path
        Results of the variants in ``quick`` and ``full``; finished ones are read again.
    coarse : bool
        Cells, steps and layers of a first look, but for rules that need full size.
    errors : bool
        Runs estimate the errors of their numbers, but for those of full size in a quick form: they take long enough.
    workers, cluster : int, Cluster
        Processes at a time, or the cluster that runs the variants instead.
    tell : callable
        Told of each study before it runs.
    """
    rules: dict[tuple[str, bool], list[Rule]] = {}
    for rule in (claim.rule for entry in entries for claim in entry.claim if claim.rule is not None):
        if rule.study:
            rules.setdefault((rule.study, coarse and not rule.full), []).append(rule)
    rows: dict[tuple[str, bool], list[Row]] = {}
    failures: dict[str, str] = {}
    for (name, quick), needed_rules in rules.items():
        tell(name if quick or not coarse else f"{name}, full size")
        rows[name, quick] = []
        bars = errors and quick == coarse
        study = with_errors(STUDIES.find(name)) if bars else STUDIES.find(name)
        chosen = wanted_rows(study, needed_rules, coarse=quick)
        reduced_study = replace(study, coarse_rows=chosen) if quick else replace(study, rows=chosen)
        place = folder / f"{'quick' if quick else 'full'}{'-errors' if bars else ''}"
        for item in run_study(reduced_study, place, coarse=quick, workers=workers, cluster=cluster):
            if isinstance(item, Failed):
                failures[name] = f"{item.label}: {item.reason}"
                continue
            item.dataset.close()
            rows[name, quick].append(Row(chosen[item.place], item.row, study.row_errors(item)))
    for entry in entries:
        for claim in entry.claim:
            key = ("", coarse) if claim.rule is None else (claim.rule.study, coarse and not claim.rule.full)
            yield _judged(entry.name, claim, rows.get(key, []), failures)


def wanted_rows(study: Study, rules: Sequence[Rule], *, coarse: bool) -> list[Mapping[str, Any]]:
    """Variants of a study that some rules need, each once, in the order of the study."""
    candidates = [*study.rows, *(row for row in study.coarse_rows if coarse)]
    selections = [
        selected(candidates, parameters)
        for rule in rules
        for parameters in (rule.at, rule.over)
        if parameters or parameters is rule.at
    ]
    needed_rows = [row for row in candidates if any(row in rows for rows in selections)]
    return [row for n, row in enumerate(needed_rows) if not any(_equal(row, earlier) for earlier in needed_rows[:n])]


def _equal(row: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    return set(row) == set(other) and bool(selected([row], other))


def verdict_of(claim: Claim, number: float) -> tuple[str, str]:
    """Verdict on a claim whose rule has given a number or a yes or no, and its reason."""
    if isinstance(number, bool):
        agrees, right = number, True
    else:
        low, high = claim.bounds
        strict = claim.side != "about"  # above 1 means more than 1
        agrees = low < number < high if strict else low <= number <= high
        right = not claim.right or claim.right[0] <= number <= claim.right[1]
    if agrees:
        return "agrees", ""
    if claim.erratum and right:
        return "erratum", claim.erratum
    if claim.differs:
        return "differs", claim.differs
    if claim.erratum:
        return "disagrees", f"neither the text's number nor the right one: {claim.erratum}"
    return "disagrees", claim.lacks and f"to tell who is right it lacks: {claim.lacks}"


def _judged(name: str, claim: Claim, rows: Sequence[Row], failures: Mapping[str, str]) -> JudgedClaim:
    text, source = _text(claim), ""
    if claim.rule is None:
        why = claim.incomparable or claim.lacks
        return JudgedClaim(name, claim.says, "not comparable" if claim.incomparable else "open", "", text, why, "")
    rule = claim.rule
    source = rule.study or rule.scene or rule.formula
    try:
        number, behind = number_of(rule, rows) if rule.study else (_computed(rule), "")
    except EigencontactError as problem:
        why = failures.get(rule.study, str(problem))
        return JudgedClaim(name, claim.says, "open", "", text, f"not computed: {why}", source)
    verdict, why = verdict_of(claim, number)
    error = error_of(rule, rows) if rule.study else None
    if verdict == "disagrees" and error and any(verdict_of(claim, number + way * error)[1] == "" for way in (-1, 1)):
        why = "; ".join(filter(None, ("its error bar reaches the text's bounds", why)))
    reason = behind
    if not isinstance(number, bool):
        bar = f" ± {error:.2g}" if error else ""
        reason = f"{number:.4g}{bar}" + (f" ({behind})" if behind else "")
    size = "full" if rule.full else ""
    return JudgedClaim(name, claim.says, verdict, reason, text, why, source, error, size)


def _computed(rule: Rule) -> float:
    if not rule.scene:
        return float(evaluate(rule.formula, Context(rule.constants), "rule.formula"))
    from eigencontact.app import load_scene, run

    scene = load_scene(rule.scene)
    return float(evaluate(rule.formula, Context(rule.constants, run(scene).dataset), "rule.formula"))


def _text(claim: Claim) -> str:
    if claim.value is None:
        return claim.rule.take if claim.rule is not None else ""
    unit = "" if claim.unit == "1" else f" {claim.unit}"
    within = f" within {100 * claim.tolerance:g} %" if claim.tolerance else ""
    return f"{'' if claim.side == 'about' else claim.side + ' '}{claim.value:g}{unit}{within}"
