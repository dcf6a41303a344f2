"""The command `eigencontact verify`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

import json
import os
import shutil
import sys
import time
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn, Protocol, Self

import typer

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from eigencontact_verification.campaign.case import Case, Gap
    from eigencontact_verification.campaign.judge import JudgedCase
    from eigencontact_verification.campaign.report import Report
    from eigencontact_verification.campaign.run import Executor
    from eigencontact_verification.campaign.worker import Outcome, Task

__all__ = ["CaseList", "campaign", "verify"]

#: Least time between two lines on solutions [s].
_LINES = 10.0


class CaseList(Protocol):
    """What the module with the cases offers."""

    def kernels(self) -> tuple[str, ...]:
        """Keys that can be verified."""

    def cases_of(self, kernel: str) -> tuple[Case, ...]:
        """Cases of one key."""

    def gaps(self) -> tuple[Gap, ...]:
        """What no case covers."""

    def why_not(self, kernel: str) -> str:
        """Why something that is installed, or should be, cannot be verified; empty if there is no such thing."""


def verify(
    kernels: Annotated[
        list[str] | None, typer.Argument(help="What to verify; by default everything installed.", metavar="[KERNEL]...")
    ] = None,
    *,
    quick: Annotated[bool, typer.Option("--quick", help="Only the quick cases: minutes on two cores.")] = False,
    kernel: Annotated[
        list[str] | None, typer.Option("--kernel", metavar="KEY", help="The same as KERNEL; repeatable.")
    ] = None,
    law: Annotated[
        list[str] | None,
        typer.Option("--law", metavar="KEY", help="A law of a material, which the elements ask as well; repeatable."),
    ] = None,
    plugin: Annotated[
        list[str] | None,
        typer.Option(
            "--plugin",
            metavar="FILE",
            help="A plugin file; without names, what it registers is verified; repeatable.",
        ),
    ] = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Folder of report and finished solutions.")
    ] = Path("cross-check"),
    workers: Annotated[
        int | None, typer.Option("--workers", metavar="N", min=1, help="Processes at a time; by default one a core.")
    ] = None,
    limit: Annotated[
        float, typer.Option("--limit", metavar="PART", help="Largest u_FE for agreement, as a part of the field.")
    ] = 0.02,
    memory: Annotated[
        float, typer.Option("--memory", metavar="GB", min=0.1, help="A task that needs more is ended and reported.")
    ] = 6.0,
    cluster: Annotated[
        str | None,
        typer.Option("--cluster", metavar="ADDRESS", help="Scheduler of dask.distributed, its file, or `local:N`."),
    ] = None,
    pictures: Annotated[
        bool, typer.Option("--pictures", help="Also write mesh and field of one case a kernel (VTU, PNG).")
    ] = False,
    markdown: Annotated[
        Path | None,
        typer.Option(
            "--markdown",
            metavar="FILE",
            help="Also write the coverage between `<!-- verify:SECTION -->` and `<!-- /verify:SECTION -->` of FILE.",
        ),
    ] = None,
    section: Annotated[
        str, typer.Option("--section", metavar="SECTION", help="Name in these markers; a part has one of its own.")
    ] = "coverage",
    figure: Annotated[
        list[str] | None,
        typer.Option(
            "--figure",
            metavar="CASE=FILE",
            help="Also copy the figure of a case there: `--figure sphere/depth-1-5-zz-nu-30=sphere.png`; repeatable.",
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")] = False,
) -> None:
    """Compare every kernel with finite elements whose own error is known; write a report.

    Finished solutions are kept in the folder: an interrupted campaign continues, a repeated one only judges again.

    Exit codes: 0 nothing disagrees (read what is inconclusive), 1 something disagrees or could not be solved,
    2 wrong input, 130 interrupted.

    With --law the finite elements ask the law itself in their integration points: what is judged is all around it.

    Example: `eigencontact verify --quick --kernel cuboid`
    """
    from eigencontact.errors import EigencontactError
    from eigencontact_verification.benchmarks.table import check_section

    names, laws = [*(kernels or []), *(kernel or [])], law or []
    files_given = [*(plugin or []), *(name for name in names if name.endswith(".py"))]
    names = [name for name in names if name not in files_given]
    if not 0.0 < limit < 1.0:
        _refuse(f"--limit must be between 0 and 1 (got {limit}); 0.02 is two per cent of the field")
    try:
        from eigencontact_verification.campaign import cases

        own_shapes, own_laws = _of_files(files_given)
        if not (names or laws):
            names, laws = own_shapes, own_laws
        chosen = _chosen(cases, names, quick=quick) if names or not laws else ()
        chosen += _of_laws(laws, quick=quick)
        copies = _copies(chosen, figure or [])
        if markdown is not None:
            check_section(markdown, section, family="verify")
        executor = _executor(workers or _cores(), memory * 1e9, cluster, files_given)
    except (EigencontactError, ValueError, ImportError, OSError) as problem:
        _refuse(str(problem))
    gaps = _gaps(cases, names, laws)
    try:
        report, files = campaign(
            chosen, gaps, output, executor=executor, limit=limit, quick=quick, pictures=pictures,
            show=not (quiet or as_json),
        )  # fmt: skip
    except EigencontactError as problem:
        typer.echo(f"eigencontact: {' '.join(str(problem).split())}", err=True)
        raise typer.Exit(problem.exit_code) from None
    except KeyboardInterrupt:
        typer.echo("eigencontact: interrupted; finished solutions are kept, run the same again to continue", err=True)
        raise typer.Exit(130) from None
    trouble = _written(report, files, markdown, section, copies)
    if as_json:
        typer.echo(json.dumps(report.to_dict(), indent=2))
    elif not quiet:
        _print(report, files)
    if trouble:
        _refuse(trouble)
    raise typer.Exit(report.exit_code)


def _refuse(problem: str) -> NoReturn:
    typer.echo(f"eigencontact: {' '.join(problem.split())}", err=True)
    raise typer.Exit(2) from None


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _of_files(files: Sequence[str]) -> tuple[list[str], list[str]]:
    """Keys of the shapes and of the laws that files register; this process knows them from now on."""
    if not files:
        return [], []
    from eigencontact.scene.installed import add_plugin_files, installed_plugins

    before = {entry.component for entry in installed_plugins()}
    add_plugin_files(files)
    own = [entry for entry in installed_plugins() if entry.component not in before]
    shapes = [entry.key for entry in own if entry.kind == "inclusion-shape"]
    laws = [entry.key for entry in own if entry.kind in ("constitutive-law", "hardening-law", "damage-law")]
    if not (shapes or laws):
        raise ValueError(
            f"--plugin must register a shape or a law (got {', '.join(entry.kind for entry in own) or 'nothing new'}); "
            "`eigencontact check` asks the conformance kit about other kinds"
        )
    return shapes, laws


def _executor(workers: int, memory: float, cluster: str | None, plugins: Sequence[str]) -> Executor:
    from eigencontact_verification.campaign.run import Limits, in_processes

    if cluster is None:
        return partial(in_processes, workers=workers, limits=Limits(memory=memory), plugins=plugins)
    if plugins:
        raise ValueError("--plugin must be without --cluster, whose workers have no such file; install it there")
    from eigencontact.engines.cluster import Cluster
    from eigencontact_verification.campaign.cluster import on_cluster

    return partial(on_cluster, engine=Cluster(cluster, say=lambda words: typer.echo(words, err=True)))


def _chosen(cases: CaseList, names: Sequence[str], *, quick: bool) -> tuple[Case, ...]:
    """Cases of the keys asked for, in the order of the list, each key once."""
    from eigencontact.errors import nearest

    known = cases.kernels()
    for name in names:
        if name not in known:
            if reason := cases.why_not(name):
                raise ValueError(reason)
            raise ValueError(
                f"kernel must be one of {', '.join(known)} (got {name!r}){nearest(name, known)}; "
                "`eigencontact plugins` lists what is installed"
            )
    found = [case for key in known if not names or key in names for case in cases.cases_of(key)]
    if quick and not any(case.quick for case in found):
        raise ValueError(
            f"--quick must be given a kernel with a quick case, as a shape of revolution about z has (got "
            f"{', '.join(names)}); without --quick: {_cost(found)}"
        )
    return tuple(case for case in found if case.quick or not quick)


def _cost(cases: Sequence[Case]) -> str:
    """What cases cost, in words; meshes without a symmetry of revolution are what takes memory."""
    from eigencontact_verification.campaign.run import tasks_of

    solves = sum(task.level is not None for case in cases for task in tasks_of(case))
    return f"{len(cases)} cases, {solves} finite-element solves, many minutes, up to some 5 GB for each process"


def _copies(chosen: Sequence[Case], figures: Sequence[str]) -> dict[str, Path]:
    """Files of ``CASE=FILE`` by case, each of a case that will be solved."""
    from eigencontact.errors import nearest

    known, copies = [case.key for case in chosen], {}
    for text in figures:
        case, equals, file = text.rpartition("=")
        if not (equals and case and file.endswith(".png")):
            raise ValueError(f"--figure must be CASE=FILE.png (got {text}); the report lists the cases")
        if case not in known:
            raise ValueError(
                f"--figure must name a case of this campaign (got {case!r}){nearest(case, known)}; "
                f"there are {len(known)}, such as {known[0]}"
            )
        copies[case] = Path(file)
    return copies


def _written(
    report: Report, files: dict[str, Path], markdown: Path | None, section: str, copies: dict[str, Path]
) -> str:
    """Write what is wanted outside the folder of the report; the first problem in words, or nothing."""
    from eigencontact_verification.benchmarks.table import replace_section
    from eigencontact_verification.campaign.brief import brief

    try:
        if markdown is not None:
            replace_section(markdown, section, brief(report), family="verify")
        for case, file in copies.items():
            drawn = files["figures"] / f"{case.replace('/', '-')}.png"
            if not drawn.is_file():
                return f"--figure must name a case that was solved (got {case}); see why not in {files['markdown']}"
            file.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(drawn, file)
    except (ValueError, OSError) as problem:
        return str(problem)
    return ""


def _of_laws(keys: Sequence[str], *, quick: bool) -> tuple[Case, ...]:
    """Cases of laws, each once."""
    if not keys:
        return ()
    from eigencontact_verification.campaign.laws import law_cases

    return tuple(case for key in dict.fromkeys(keys) for case in law_cases(key) if case.quick or not quick)


def _gaps(cases: CaseList, names: Sequence[str], laws: Sequence[str]) -> tuple[Gap, ...]:
    """Gaps of what was asked for, and the kernels that were not."""
    from eigencontact_verification.campaign.case import Gap

    some = bool(names or laws)
    told = tuple(gap for gap in cases.gaps() if not some or gap.kernel in names)
    told += tuple(Gap(kernel=f"law-{key}", what="the law by itself", reason="its kit judges it") for key in laws)
    left = [key for key in cases.kernels() if some and key not in names]
    return told + tuple(Gap(kernel=key, what="everything", reason="not asked for in this run") for key in left)


def campaign(
    cases: Sequence[Case],
    gaps: Sequence[Gap],
    folder: Path,
    *,
    executor: Executor,
    limit: float = 0.02,
    quick: bool = False,
    pictures: bool = False,
    show: bool = False,
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

    Returns
    -------
    Report, dict of str to Path
        What was found, and the files.
    """
    from eigencontact_verification.campaign.judge import judge
    from eigencontact_verification.campaign.report import Report, write_report
    from eigencontact_verification.campaign.run import run_campaign
    from eigencontact_verification.campaign.store import Store

    start = time.perf_counter()
    with _Bar(show=show) as bar:
        solved = run_campaign(cases, Store(folder / "solutions"), executor=executor, progress=bar)
    judged = tuple(judge(one, limit=limit) for one in solved)
    notes = tuple(_pictures(judged, folder / "fields")) if pictures else ()
    report = Report(
        cases=judged,
        gaps=tuple(gaps),
        limit=limit,
        quick=quick,
        seconds=time.perf_counter() - start,
        notes=notes,
        pictures=_drawn(judged, folder / "fields") if pictures else {},
    )
    return report, write_report(report, folder)


def _pictures(judged: Sequence[JudgedCase], folder: Path) -> Iterator[str]:
    """Write mesh and field of the first case of each kernel; say what was written, or why it was not."""
    seen = set()
    for case in (found.case for found in judged):
        if case.kernel in seen:
            continue
        seen.add(case.kernel)
        try:
            files = case.pictures(_folder(case, folder))
        except Exception as problem:  # noqa: BLE001 - a picture that fails must not cost the report
            yield f"{case.key}: no pictures, {type(problem).__name__}: {' '.join(str(problem).split())}"
            continue
        if files:
            names = ", ".join(file.name for file in files)
            yield f"{case.key}: mesh and field in {folder.name}/{_folder(case, folder).name}: {names}"


def _folder(case: Case, folder: Path) -> Path:
    return folder / case.key.replace("/", "-")


def _drawn(judged: Sequence[JudgedCase], folder: Path) -> dict[str, tuple[Path, ...]]:
    """Pictures that are there, by key of the case; one that failed has not taken the others with it."""
    files = {one.case.key: tuple(sorted(_folder(one.case, folder).glob("*.png"))) for one in judged}
    return {key: found for key, found in files.items() if found}


class _Bar:
    """Progress with the remaining time: the bar counts work, the words count solutions; lines without a terminal."""

    def __init__(self, *, show: bool) -> None:
        self._bar: Any = None
        self._task: Any = None
        self._left = self._total = 0
        self._lines = False
        self._began = self._said = time.monotonic()
        if show:
            from rich.console import Console
            from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

            from eigencontact.progress import draws_in_place

            console = Console(stderr=True)
            if draws_in_place(sys.stderr):
                words = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn(), TextColumn("left"))
                self._bar = Progress(*words, TimeRemainingColumn(), console=console, transient=True)
            else:
                self._lines = True

    def __enter__(self) -> Self:
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def started(self, tasks: Sequence[Task]) -> None:
        """Show the work that is due."""
        self._left = self._total = len(tasks)
        self._began = self._said = time.monotonic()
        if self._lines and tasks:
            typer.echo(f"{self._total} solutions to compute", err=True)
        if self._bar is not None:
            self._task = self._bar.add_task(f"{self._left} solutions", total=sum(task.weight for task in tasks))

    def finished(self, task: Task, outcome: Outcome) -> None:
        """Count a solution; say what failed."""
        self._left -= 1
        if self._bar is not None:
            if outcome.status != "done":
                self._bar.console.print(f"{task.case.key}, {task.label}: {outcome.reason}", markup=False)
            self._bar.update(self._task, advance=task.weight, description=f"{self._left} solutions to go")
        elif self._lines:
            self._say(task, outcome)

    def _say(self, task: Task, outcome: Outcome) -> None:
        """A line for what failed, and for how far it is where the last one is some time ago."""
        from eigencontact.progress import time_in_words

        now = time.monotonic()
        if outcome.status != "done":
            typer.echo(f"{task.case.key}, {task.label}: {outcome.reason}", err=True)
        if now - self._said >= _LINES:
            self._said, done = now, self._total - self._left
            typer.echo(f"solution {done} of {self._total} done after {time_in_words(now - self._began)}", err=True)


def _print(report: Report, files: dict[str, Path]) -> None:
    """The coverage table, what is not agreement, and where the report is."""
    from rich.console import Console
    from rich.table import Table

    from eigencontact_verification.campaign.brief import totals
    from eigencontact_verification.campaign.judge import coverage

    console = Console(highlight=False)
    table = Table("kernel", "quantity", "component", "verdict", "profiles", "u_FE", "|SA−FE|", box=None, pad_edge=False)
    for one in coverage(report.rows):
        numbers = ("–" if value is None else f"{100 * value:.2g} %" for value in (one.uncertainty, one.difference))
        agreed = f"{one.counts['agrees']}/{sum(one.counts.values())}"
        table.add_row(one.kernel, one.quantity, one.component, one.word, agreed, *numbers)
    console.print(table)
    for row in report.rows:
        if row.word != "agrees":
            words = f"{row.word}: {row.kernel}/{row.case}, {row.profile}, {row.component}: {row.reason}"
            console.print(words, markup=False, soft_wrap=True)
    console.print(f"\n{totals(report)} {len(report.gaps)} known gaps.", markup=False, soft_wrap=True)
    console.print(f"report: {files['html'].resolve()}", markup=False, soft_wrap=True)
