"""The command `eigencontact verify`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

import os
import shutil
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Protocol

import typer

from eigencontact.engines.options import ClusterAddress, TaskThreads
from eigencontact_verification.commands.options import (
    AsJson,
    Output,
    Quiet,
    cluster_or_none,
    leave,
    with_clear_errors,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from eigencontact_verification.crosscheck.case import Case, Gap
    from eigencontact_verification.crosscheck.report import Report

__all__ = ["CaseList", "verify"]


class CaseList(Protocol):
    """Interface of the module with the cases."""

    def kernels(self) -> tuple[str, ...]:
        """Keys that can be verified."""

    def cases_of(self, kernel: str) -> tuple[Case, ...]:
        """Cases of one key."""

    def gaps(self) -> tuple[Gap, ...]:
        """Quantities without a case, with the reasons."""

    def why_not(self, kernel: str) -> str:
        """Why something that is installed, or should be, cannot be verified; empty if there is no such thing."""


def verify(
    kernels: Annotated[
        list[str] | None,
        typer.Argument(
            help="Kernels, or runs to audit (folders or their results.nc); by default all kernels.",
            metavar="[KERNEL|RESULTS]...",
        ),
    ] = None,
    *,
    quick: Annotated[
        bool, typer.Option("--quick", help="Only the quick cases, or lighter meshes: minutes on two cores.")
    ] = False,
    step: Annotated[
        int | None, typer.Option("--step", metavar="N", min=1, help="Step of a run, from 1; by default the last.")
    ] = None,
    contact: Annotated[
        bool, typer.Option("--contact", help="For axisymmetric runs: also solve the whole contact by finite elements.")
    ] = False,
    kernel: Annotated[
        list[str] | None, typer.Option("--kernel", metavar="KEY", help="The same as KERNEL; repeatable.")
    ] = None,
    law: Annotated[
        list[str] | None,
        typer.Option("--law", metavar="KEY", help="A constitutive law, also used in the finite elements; repeatable."),
    ] = None,
    plugin: Annotated[
        list[str] | None,
        typer.Option(
            "--plugin",
            metavar="FILE",
            help="A plugin file; without names, its plugins are verified; repeatable.",
        ),
    ] = None,
    output: Output = Path("cross-check"),
    workers: Annotated[
        int | None, typer.Option("--workers", metavar="N", min=1, help="Processes at a time; by default one a core.")
    ] = None,
    limit: Annotated[
        float, typer.Option("--limit", metavar="PART", help="Largest u_FE for agreement, relative to the field.")
    ] = 0.02,
    refine: Annotated[
        float,
        typer.Option(
            "--refine",
            metavar="FACTOR",
            min=1.0,
            help="Finer meshes and cells by this factor, where a verdict is inconclusive: laws, plasticity, layers.",
        ),
    ] = 1.0,
    memory: Annotated[
        float | None,
        typer.Option(
            "--memory",
            metavar="GB",
            min=0.1,
            help="A task that needs more is ended and reported (6); on a cluster, what a worker must have.",
        ),
    ] = None,
    cluster: ClusterAddress = None,
    threads: TaskThreads = None,
    pictures: Annotated[
        bool, typer.Option("--pictures", help="Also write mesh and field of one case per kernel (VTU, PNG).")
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
        str, typer.Option("--section", metavar="SECTION", help="Name in these markers; each part has its own.")
    ] = "coverage",
    figure: Annotated[
        list[str] | None,
        typer.Option(
            "--figure",
            metavar="CASE=FILE",
            help="Also copy the figure of a case there: `--figure sphere/depth-1-5-zz-nu-30=sphere.png`; repeatable.",
        ),
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Cross-check kernels, laws, or one stored run against finite elements with an error estimate.

    For a run, the stored tractions of a step load the elements, which have its layers, inclusions and the history
    variables of its bodies. Displacement of the surface and stored stress are compared.

    Finished solutions are kept in the folder: an interrupted cross-check continues, a repeated one only judges again.

    Exit codes: 0 nothing disagrees (read what is inconclusive), 1 something disagrees or could not be solved,
    2 wrong input, 130 interrupted.

    With --law the finite elements use the law itself in their integration points: the case judges everything around it.

    Examples: `eigencontact verify --quick --kernel cuboid`, `eigencontact verify --quick ./hertz`
    """
    from eigencontact.errors import EigencontactError
    from eigencontact_verification.reporting.table import check_section

    names, laws = [*(kernels or []), *(kernel or [])], law or []
    files_given = [*(plugin or []), *(name for name in names if name.endswith(".py"))]
    names = [name for name in names if name not in files_given]
    if not 0.0 < limit < 1.0:
        leave(f"--limit must be between 0 and 1 (got {limit}); 0.02 is two per cent of the field", 2)
    solve: Callable[[], tuple[Report, dict[str, Path]]]
    try:
        from eigencontact_verification.audit.command import audit_results, is_results
        from eigencontact_verification.audit.stored import plugin_files
        from eigencontact_verification.campaign.elements import executor_for
        from eigencontact_verification.crosscheck import cases
        from eigencontact_verification.crosscheck.whole import crosscheck

        runs = [name for name in names if is_results(name) and name not in cases.kernels()]
        own_shapes, own_laws = _of_files(files_given)
        if not (names or laws):
            names, laws = own_shapes, own_laws
        needed = [*files_given, *(file for run in runs for file in plugin_files(run))]
        engine = cluster_or_none(workers, cluster, None if cluster is None else memory, threads)
        options: dict[str, Any] = {"limit": limit, "quick": quick, "pictures": pictures, "show": not (quiet or as_json)}
        options["executor"] = executor_for(
            dict.fromkeys(needed), workers=workers or _cores(), cluster=engine,
            memory=None if memory is None else 1e9 * memory,
        )  # fmt: skip
        chosen: tuple[Case, ...] = ()
        _refuse_together(runs, names, laws, figure, step, contact=contact, refine=refine)
        if runs:
            solve = partial(audit_results, runs, output, step=step, contact=contact, **options)
        else:
            chosen = _chosen(cases, names, quick=quick) if names or not laws else ()
            chosen += _of_laws(laws, quick=quick)
            chosen = chosen if refine == 1.0 else tuple(case.refined(refine) for case in chosen)
            solve = partial(crosscheck, chosen, _gaps(cases, names, laws), output, **options)
        copies = _copies(chosen, figure or [])
        if markdown is not None:
            check_section(markdown, section, family="verify")
    except (EigencontactError, ValueError, ImportError, OSError) as problem:
        leave(str(problem), 2)
    try:
        with with_clear_errors("finished solutions are kept, run the same again to continue"):
            report, files = solve()
    except ValueError as problem:
        if not runs:
            raise
        leave(str(problem), 2)
    trouble = _written(report, files, markdown, section, copies)
    if as_json:
        typer.echo(files["json"].read_text(encoding="utf-8"), nl=False)
    elif not quiet:
        from eigencontact_verification.crosscheck.progress import print_report

        print_report(report, files)
    if trouble:
        leave(trouble, 2)
    raise typer.Exit(report.exit_code)


def _refuse_together(
    runs: Sequence[str], names: Sequence[str], laws: Sequence[str], figures: Sequence[str] | None, step: int | None, *,
    contact: bool, refine: float,
) -> None:  # fmt: skip
    """Refuse runs together with kernels and laws, and what only the one or the other has."""
    if not runs:
        if step is not None:
            raise ValueError(f"--step must be given with a run (got {step}); name its folder")
        if contact:
            raise ValueError("--contact must be given with a run (got none); name its folder")
        return
    kernels = [*(name for name in names if name not in runs), *laws]
    if kernels:
        raise ValueError(f"runs must be audited without kernels (got {runs[0]} and {kernels[0]}); use two commands")
    if refine != 1.0:
        raise ValueError(f"--refine must be for kernels or laws (got {refine:g} with a run); refine the scene itself")
    if figures:
        raise ValueError(f"--figure must be for kernels (got {figures[0]}); the report of an audit has its figures")


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
    added = [entry for entry in installed_plugins() if entry.component not in before]
    shapes = [entry.key for entry in added if entry.kind == "inclusion-shape"]
    laws = [entry.key for entry in added if entry.kind in ("constitutive-law", "hardening-law", "damage-law")]
    if not (shapes or laws):
        kinds = ", ".join(entry.kind for entry in added) or "nothing new"
        raise ValueError(
            f"--plugin must register a shape or a law (got {kinds}); `eigencontact check` checks other kinds"
        )
    return shapes, laws


def _chosen(cases: CaseList, names: Sequence[str], *, quick: bool) -> tuple[Case, ...]:
    """Cases of the keys asked for, in the order of the list, each key once."""
    from eigencontact.errors import nearest

    keys = cases.kernels()
    for name in names:
        if name not in keys:
            if reason := cases.why_not(name):
                raise ValueError(reason)
            raise ValueError(
                f"kernel must be one of {', '.join(keys)} (got {name!r}){nearest(name, keys)}; "
                "`eigencontact plugins` lists what is installed"
            )
    chosen = [case for key in keys if not names or key in names for case in cases.cases_of(key)]
    if quick and not any(case.quick for case in chosen):
        raise ValueError(
            f"--quick must be used with a kernel that has a quick case, for example a shape of revolution (got "
            f"{', '.join(names)}); without --quick: {_cost(chosen)}"
        )
    return tuple(case for case in chosen if case.quick or not quick)


def _cost(cases: Sequence[Case]) -> str:
    """Cost of cases in words; meshes without a symmetry of revolution take the most memory."""
    from eigencontact_verification.crosscheck.run import tasks_of

    solves = sum(task.level is not None for case in cases for task in tasks_of(case))
    return f"{len(cases)} cases, {solves} finite-element solves, many minutes, up to some 5 GB for each process"


def _copies(chosen: Sequence[Case], figures: Sequence[str]) -> dict[str, Path]:
    """Files of ``CASE=FILE`` by case, each of a case that will be solved."""
    from eigencontact.errors import nearest
    from eigencontact.results.ownership import refuse_foreign_file

    keys, copies = [case.key for case in chosen], {}
    for text in figures:
        case, equals, file = text.rpartition("=")
        if not (equals and case and file.endswith(".png")):
            raise ValueError(f"--figure must be CASE=FILE.png (got {text}); the report lists the cases")
        if case not in keys:
            raise ValueError(
                f"--figure must name a case of this cross-check (got {case!r}){nearest(case, keys)}; "
                f"there are {len(keys)}, such as {keys[0]}"
            )
        refuse_foreign_file(Path(file))
        copies[case] = Path(file)
    return copies


def _written(
    report: Report, files: dict[str, Path], markdown: Path | None, section: str, copies: dict[str, Path]
) -> str:
    """Write the files outside the folder of the report; return the first problem in words, or an empty text."""
    from eigencontact_verification.crosscheck.brief import brief
    from eigencontact_verification.reporting.table import replace_section

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
    from eigencontact_verification.crosscheck.laws import law_cases

    return tuple(case for key in dict.fromkeys(keys) for case in law_cases(key) if case.quick or not quick)


def _gaps(cases: CaseList, names: Sequence[str], laws: Sequence[str]) -> tuple[Gap, ...]:
    """Gaps of what was asked for, and the kernels that were not."""
    from eigencontact_verification.crosscheck.case import Gap

    chosen = bool(names or laws)
    gaps = tuple(gap for gap in cases.gaps() if not chosen or gap.subject in names)
    gaps += tuple(Gap(subject=f"law-{key}", what="the law by itself", reason="its kit judges it") for key in laws)
    remaining = [key for key in cases.kernels() if chosen and key not in names]
    return gaps + tuple(Gap(subject=key, what="everything", reason="not requested in this run") for key in remaining)
