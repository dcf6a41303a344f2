"""A cross-check from its cases to the report: solve, judge, draw, write."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from eigencontact_verification.crosscheck.case import Case, Gap
    from eigencontact_verification.crosscheck.judge import JudgedCase
    from eigencontact_verification.crosscheck.report import Report
    from eigencontact_verification.crosscheck.run import Executor

__all__ = ["crosscheck"]


def crosscheck(
    cases: Sequence[Case],
    gaps: Sequence[Gap],
    folder: Path,
    *,
    executor: Executor,
    limit: float = 0.02,
    quick: bool = False,
    pictures: bool = False,
    show: bool = False,
    beside: Callable[[Sequence[JudgedCase]], tuple[Sequence[JudgedCase], Sequence[Gap]]] | None = None,
    method: str = "",
    remarks: Callable[[Sequence[JudgedCase]], Sequence[str]] | None = None,
) -> tuple[Report, dict[str, Path]]:
    """Solve, judge and report.

    Parameters
    ----------
    cases : sequence of Case
        What to verify.
    gaps : sequence of Gap
        What the report lists as not covered.
    folder : Path
        Gets the report, and the finished solutions below ``solutions``.
    executor : callable
        Performs the tasks.
    limit : float
        Largest u_FE for agreement.
    quick : bool
        Said in the report. The quick cases of a kernel may leave components out; those are then not in its table.
    pictures : bool
        Also write mesh and field of the first case of each kernel.
    show : bool
        Draw a bar with the remaining time, where there is a terminal; else write a line now and then.
    beside : callable, optional
        Gives more cases for the report, and gaps, from what was judged.
    method : str
        What the report says of the method, in place of the words for kernels.
    remarks : callable, optional
        Gives more notes for the report from what was judged.

    Raises
    ------
    ResultsError
        A file of another origin in the folder that the report would replace; nothing is solved then.

    Returns
    -------
    Report, dict of str to Path
        What was found, and the files.
    """
    from eigencontact_verification.crosscheck.judge import judge
    from eigencontact_verification.crosscheck.progress import Bar
    from eigencontact_verification.crosscheck.report import Report, names_of, write_report
    from eigencontact_verification.crosscheck.run import run_cases
    from eigencontact_verification.crosscheck.store import Store
    from eigencontact_verification.reporting.files import open_folder

    open_folder(folder, names_of([case.key for case in cases]))
    start = time.perf_counter()
    with Bar(show=show) as bar:
        solved = run_cases(cases, Store(folder / "solutions"), executor=executor, progress=bar)
    judged = tuple(judge(solution, limit=limit) for solution in solved)
    more, new_gaps = beside(judged) if beside is not None else ((), ())
    notes = tuple(remarks(judged)) if remarks is not None else ()
    notes += tuple(_pictures(judged, folder / "fields")) if pictures else ()
    report = Report(
        cases=(*judged, *more),
        gaps=(*gaps, *new_gaps),
        limit=limit,
        quick=quick,
        seconds=time.perf_counter() - start,
        notes=notes,
        pictures=_drawn(judged, folder / "fields") if pictures else {},
        **({"method": method} if method else {}),
    )
    return report, write_report(report, folder)


def _pictures(judged: Sequence[JudgedCase], folder: Path) -> Iterator[str]:
    """Write mesh and field of the first case of each kernel that draws some; say what was written, or why not."""
    drawn = set()
    for case in (judged_case.case for judged_case in judged):
        if case.subject in drawn:
            continue
        try:
            files = case.pictures(_folder(case, folder))
        except Exception as problem:  # noqa: BLE001 - a picture that fails must not cost the report
            yield f"{case.key}: no pictures, {type(problem).__name__}: {' '.join(str(problem).split())}"
            continue
        if files:
            drawn.add(case.subject)
            names = ", ".join(file.name for file in files)
            yield f"{case.key}: mesh and field in {folder.name}/{_folder(case, folder).name}: {names}"


def _folder(case: Case, folder: Path) -> Path:
    return folder / case.key.replace("/", "-")


def _drawn(judged: Sequence[JudgedCase], folder: Path) -> dict[str, tuple[Path, ...]]:
    """Pictures that are there, by key of the case; one that failed has not taken the others with it."""
    files = {
        judged_case.case.key: tuple(sorted(_folder(judged_case.case, folder).glob("*.png"))) for judged_case in judged
    }
    return {key: pictures for key, pictures in files.items() if pictures}
