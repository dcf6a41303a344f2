"""Verdicts on a case of the cross-check without its store and its processes, and on a run."""

from eigencontact_verification.audit import cases_of
from eigencontact_verification.crosscheck.case import error_key
from eigencontact_verification.crosscheck.judge import judge
from eigencontact_verification.crosscheck.run import Solved, run_cases, tasks_of
from eigencontact_verification.crosscheck.store import Store
from eigencontact_verification.crosscheck.worker import Outcome, perform
from eigencontact_verification.fem.uncertainty import estimate, verdict

__all__ = ["references", "rows_of", "words", "words_of_audit"]


def rows_of(case):
    """Verdicts by profile and component, solved in this process."""
    outcomes = []
    for task in tasks_of(case):
        fields = case.judged() if task.level is None else case.reference(task.level, task.outer)
        outcomes.append((task, Outcome(status="done", fields=fields)))
    return {(row.profile, row.component): row for row in judge(Solved(case=case, outcomes=tuple(outcomes))).rows}


def references(case):
    """Estimate of every profile."""
    fixed = [case.reference(level, "fixed") for level in (0, 1, 2)]
    free = case.reference(case.bracket_level, "free")
    return {
        profile.name: estimate(
            *(fields[profile.name] for fields in fixed), ratio=case.ratio, formal_order=profile.formal_order,
            other_outer=free[profile.name], other_level=case.bracket_level,
        )
        for profile in case.profiles
    }  # fmt: skip


def words(case, found):
    """Verdict on each quantity: the worst of its profiles."""
    judged = case.judged()
    assert not any(error_key(profile.name) in judged for profile in case.profiles)
    out = {}
    for profile in case.profiles:
        word = verdict(judged[profile.name], found[profile.name]).word
        if out.get(profile.quantity) != "disagrees":
            out[profile.quantity] = word if out.get(profile.quantity) in (None, "agrees", word) else "inconclusive"
        if word == "disagrees":
            out[profile.quantity] = word
    return out


def words_of_audit(run, store):
    """Verdicts of the audit of a run, solved in this process."""
    cases, _ = cases_of(run)
    solved = run_cases(cases, Store(store), executor=lambda tasks: ((task, perform(task)) for task in tasks))
    verdicts = {row.word for case in solved for row in judge(case).rows}
    assert verdicts
    return verdicts
