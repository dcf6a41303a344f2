"""`eigencontact verify RESULTS`: cases of stored runs through the machinery of the cross-check of kernels."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eigencontact_verification.crosscheck.case import Case, Gap
    from eigencontact_verification.crosscheck.judge import JudgedCase
    from eigencontact_verification.crosscheck.report import Report
    from eigencontact_verification.crosscheck.run import Executor

__all__ = ["audit_results", "is_results"]

_METHOD = (
    "Each stored step is compared with finite elements that carry its tractions and have its layers, its inclusions, "
    "and what its bodies remember as their own. They share no code with what is judged. What a homogeneous half-space "
    "does under tractions is taken from point forces (Boussinesq, Cerruti): the elements are asked for what layers, "
    "inclusions and damage change of it, and in a homogeneous body for the field of the tractions as smooth as a mesh "
    "can carry them. The elements' own uncertainty, "
    "u_FE, is the sum of a grid convergence index (three meshes), half the distance of fixed and free outer faces, "
    "and, where the run cuts inclusions into cells, the change of their field over half a cell. "
    "A component agrees if |SA − FE| ≤ u_FE at every point of a profile and u_FE is at most {limit} of the field's "
    "largest value there; it disagrees if the difference exceeds u_FE anywhere; otherwise it is inconclusive, which is "
    "no agreement. Checks need no elements: their difference is what was found, their u_FE what is allowed, both "
    "relative. Differences and uncertainties below are parts of the field's largest value. "
    "Numbers with error bars are compared after ASME V&V 20-2009: E = S − D, u_val² = u_SA² + u_FE², where u_SA is the "
    "error bar of the run. Where |E| ≤ u_val the number agrees within u_val; else E ± u_val is the error of model or "
    "implementation; with u_val above 5 % of the number, agreement is inconclusive."
)
#: Note on a run without error bars.
_WITHOUT = (
    "{name} has no error bars: its own error is estimated by rules on its cells, and its numbers have no comparison "
    "error; `eigencontact run SCENE --errors` gives them."
)


def is_results(name: str) -> bool:
    """Whether a name on the command line is a run: a results file, or a folder that has one or the steps of one."""
    path = Path(name)
    return path.suffix == ".nc" or (path.is_dir() and any((path / entry).exists() for entry in ("results.nc", "steps")))


def audit_results(
    paths: Sequence[str], output: Path, *, executor: Executor, step: int | None = None, limit: float = 0.02,
    quick: bool = False, pictures: bool = False, show: bool = False, contact: bool = False,
) -> tuple[Report, dict[str, Path]]:  # fmt: skip
    """Audit runs and write the report.

    Parameters
    ----------
    paths : sequence of str
        Folders of runs, or their ``results.nc``.
    output : Path
        Folder of the report and of finished solutions.
    executor : callable
        Performs the solutions.
    step : int, optional
        From 1; by default the last one stored.
    limit : float
        Largest u_FE for agreement, as a part of the field.
    quick : bool
        Lighter meshes.
    pictures, show : bool
        As for `crosscheck`.
    contact : bool
        Beside that, solve each run whose contact is of revolution wholly by finite elements.
    """
    from eigencontact_verification.audit.cases import cases_of_step
    from eigencontact_verification.audit.checks import checked, gap_in_words
    from eigencontact_verification.audit.contact_cases import contact_cases_of
    from eigencontact_verification.audit.numbers import compared_numbers
    from eigencontact_verification.audit.stored import bars_of, read_step
    from eigencontact_verification.audit.table import halved_in_words
    from eigencontact_verification.crosscheck.whole import crosscheck
    from eigencontact_verification.reporting.files import open_folder

    runs = [read_step(path, step) for path in paths]
    names = [run.name for run in runs]
    if len(set(names)) != len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"RESULTS must have different scene names (got {twice!r} twice); audit one at a time")
    open_folder(output, ())  # references take seconds: a folder that cannot be written is refused before
    answers: list[tuple[Sequence[Case], Sequence[Gap]]] = [cases_of_step(run, quick=quick) for run in runs]
    answers += [contact_cases_of(path, quick=quick) for path in paths] if contact else []
    bars = {run.name: bars_of(path) for run, path in zip(runs, paths, strict=True)}
    without = {name: () if own_bars else (_WITHOUT.format(name=name),) for name, own_bars in bars.items()}

    def beside(judged: Sequence[JudgedCase]) -> tuple[list[JudgedCase], list[Gap]]:
        """Checks of all runs, and numbers of those with error bars."""
        more = [checks for checks in map(checked, runs) if checks.rows]
        new_gaps: list[Gap] = []
        for run in runs:
            cases, gaps = compared_numbers(run, bars[run.name], judged)
            more += cases
            new_gaps += gaps
        return more, new_gaps

    return crosscheck(
        [case for cases, _ in answers for case in cases], [gap for _, gaps in answers for gap in gaps], output,
        executor=executor, limit=limit, quick=quick, pictures=pictures, show=show,
        beside=beside, method=_METHOD,
        remarks=lambda judged: [
            *(words for run in runs for words in (*gap_in_words(run, judged), *without[run.name])),
            *halved_in_words(judged),
        ],
    )  # fmt: skip
