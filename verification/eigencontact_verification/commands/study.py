"""The command `eigencontact study`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eigencontact.engines.options import ClusterAddress, TaskMemory, TaskThreads
from eigencontact_verification.commands.options import (
    AsJson,
    Errors,
    Form,
    Name,
    Output,
    Show,
    Workers,
    chosen_file,
    cluster_or_none,
    print_keys,
    with_clear_errors,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eigencontact.engines.cluster import Cluster
    from eigencontact_verification.studies.run import Failed
    from eigencontact_verification.studies.study import Finished, Study

__all__ = ["study"]

Quick = Annotated[bool, typer.Option("--coarse", "--quick", help="Fewer variants and cells, for a first look.")]
Chapter = Annotated[int | None, typer.Option("--chapter", metavar="N", help="With `thesis`: this chapter alone.")]
Figure = Annotated[
    str | None, typer.Option("--figure", metavar="N.M", help="With `thesis`: this figure alone, or `table N.M`.")
]
Pictures = Annotated[
    Path | None,
    typer.Option(
        "--pictures", metavar="FOLDER", help="With `thesis`: a small picture of each figure, of all variants."
    ),
]


#: Name in place of a study.
THESIS = "thesis"


def study(
    name: Name = None,
    *,
    output: Output = Path("studies"),
    coarse: Quick = False,
    errors: Errors = False,
    chapter: Chapter = None,
    figure: Figure = None,
    pictures: Pictures = None,
    workers: Workers = 1,
    cluster: ClusterAddress = None,
    memory: TaskMemory = None,
    threads: TaskThreads = None,
    as_json: AsJson = False,
    form: Form = False,
    show: Show = False,
) -> None:
    """Reproduce a trend of the literature: a parameter sweep from one file, its numbers, and a figure with its source.

    Re-running resumes; finished variants are reused.

    A study is a TOML file: a scene, varying parameters, numbers and panels, and the publication of the trend. `--form`
    lists its keys. Example: `eigencontact study spence-radius --show > my.toml`, then `eigencontact study my.toml`.

    `eigencontact study thesis --quick` judges every claim of the thesis on its figures that a study can judge.
    """
    with with_clear_errors():
        from eigencontact.errors import SceneError
        from eigencontact_verification.commands.thesis import report_thesis
        from eigencontact_verification.studies.catalogue import STUDIES
        from eigencontact_verification.thesis.reading import thesis_index

        if form:
            _print_form()
            return
        if name == THESIS:
            engine = cluster_or_none(workers, cluster, memory, threads)
            report_thesis(
                output,
                entries=thesis_index().entries(chapter, figure),
                coarse=coarse,
                errors=errors,
                workers=workers or 1,
                cluster=engine,
                pictures=pictures,
                as_json=as_json,
            )
            return
        if chapter is not None or figure is not None or pictures is not None:
            raise SceneError(f"--chapter, --figure and --pictures must be used with the study {THESIS} (got {name!r})")
        columns = {"study": lambda item: item.name, "what": lambda item: item.title, "after": _sources}
        item = chosen_file(STUDIES, name, show=show, columns=columns)
        if item is not None:
            from eigencontact_verification.studies.errors import with_errors

            item = with_errors(item) if errors else item
            engine = cluster_or_none(workers, cluster, memory, threads)
            _run(item, output, coarse=coarse, workers=workers or 1, cluster=engine, as_json=as_json)


def _sources(item: Study) -> str:
    """Authors, years and figures of a study."""
    return "; ".join(
        f"{source.get('authors', '')} {source.get('year', '')}, {source.get('figure', source.get('form', ''))}"
        for source in item.sources
    )


def _print_form() -> None:
    from eigencontact_verification.studies.form import FORM
    from eigencontact_verification.studies.formula import FUNCTIONS
    from eigencontact_verification.studies.moments import MOMENTS

    print_keys(FORM, "study")
    functions = {name: meaning for name, (_, meaning) in FUNCTIONS.items()}
    functions |= {"given": "whether a variant has a parameter", "has": "whether results have a name"}
    moments = {name: meaning for name, (_, meaning) in MOMENTS.items()}
    title = "moments of a load history, whose last argument is read then; a bare name is read at the end"
    print_keys({"functions of formulas": functions, title: moments}, width=16)


def _run(item: Study, output: Path, *, coarse: bool, workers: int, cluster: Cluster | None, as_json: bool) -> None:
    from eigencontact_verification.reporting.files import open_folder
    from eigencontact_verification.reporting.progress import counted
    from eigencontact_verification.studies.run import Failed, run_study, write_study

    open_folder(output, (f"{item.name}.json", f"{item.name}.png"))
    total = len(item.coarse_rows if coarse else item.rows)
    outcomes: list[Finished | Failed] = []
    with counted(item.name, "variant ") as tell:
        for outcome in run_study(item, output, coarse=coarse, workers=workers, cluster=cluster):
            outcomes.append(outcome)
            tell(outcome.label, len(outcomes), total)
    outcomes.sort(key=lambda outcome: outcome.place)  # several processes finish in any order
    files = write_study(item, outcomes, output)
    if as_json:
        typer.echo(files[-1].read_text(encoding="utf-8"))
    else:
        _report(item, outcomes)
        typer.echo(f"written: {', '.join(str(path) for path in files)}")
    failed = [outcome for outcome in outcomes if isinstance(outcome, Failed)]
    for outcome in outcomes:
        if not isinstance(outcome, Failed):
            outcome.dataset.close()
    for variant in failed:
        typer.echo(f"eigencontact: variant {variant.label} failed: {variant.reason}", err=True)
    if failed:
        raise typer.Exit(1)


def _report(item: Study, outcomes: Sequence[Finished | Failed]) -> None:
    from rich.table import Table

    from eigencontact.core.text_table import print_table
    from eigencontact.sweeps.gather import warnings_in_words
    from eigencontact_verification.studies.checks import verdicts
    from eigencontact_verification.studies.run import source_in_words
    from eigencontact_verification.studies.study import Finished

    finished = [outcome for outcome in outcomes if isinstance(outcome, Finished)]
    columns = dict.fromkeys(name for outcome in finished for name in outcome.row)
    typer.echo(item.title)
    table = Table("variant", *columns, box=None, pad_edge=False)
    for outcome in finished:
        cells = {name: f"{value:.4g}" for name, value in outcome.row.items()}
        cells |= {name: f"{cells[name]} ± {error:.2g}" for name, error in item.row_errors(outcome).items()}
        table.add_row(outcome.label, *(cells.get(name, "") for name in columns))
    print_table(table)
    for line in warnings_in_words({outcome.label: outcome.warnings for outcome in finished}, len(outcomes)):
        typer.echo(line)
    for verdict in verdicts(item, finished):
        typer.echo(f"{'holds' if verdict.holds else 'does not hold'}: {verdict.check} ({verdict.numbers})")
    if item.trend:
        typer.echo(item.trend)
    for source in item.sources:
        typer.echo(f"after: {source_in_words(source)}")
