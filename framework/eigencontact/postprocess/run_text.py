"""Results of a run on the terminal: numbers, warnings, files and times."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eigencontact.results.run_result import RunResult

__all__ = ["print_run"]


def print_run(name: str, result: RunResult) -> None:
    """Print results, warnings, written files and times of a stored run.

    Parameters
    ----------
    name : str
        Title of a scene that has none.
    result : RunResult
    """
    from rich.console import Console
    from rich.table import Table

    from eigencontact.core.text_table import print_table
    from eigencontact.core.units import time_in_words
    from eigencontact.results.course import course_table
    from eigencontact.results.summary import headlines

    console, summary = Console(highlight=False), result.summary
    numbers = Table.grid(padding=(0, 2))
    for words, value in headlines(summary):
        numbers.add_row(words, value)
    if summary.get("gap_residual") is not None:
        numbers.add_row("largest gap residual", f"{summary['gap_residual']:.1e} of the deflection (converged)")
    console.print(f"\n[bold]{summary.get('title') or name}[/bold]")
    print_table(numbers, console)
    if course := course_table(summary["history"], summary["units"]):
        console.print(f"\n{course}", markup=False, soft_wrap=True)
    if "accuracy" in summary:
        from eigencontact.accuracy.words import accuracy_lines

        console.print("\n".join(accuracy_lines(summary)), markup=False, soft_wrap=True)
    for source, reason in summary.get("errors_left_out", {}).items():
        console.print(f"the errors leave out {source}: {reason}", markup=False, soft_wrap=True)
    for caution in summary["warnings"]:
        console.print(f"warning ({caution['code']}): {caution['words']}", markup=False, soft_wrap=True)
    assert result.folder is not None
    console.print(f"\nin {result.folder.resolve()}:", soft_wrap=True)
    files = Table.grid(padding=(0, 2))
    for file, text in result.files.items():
        files.add_row(f"  {file}", text)
    print_table(files, console)
    solved = f"computed in {time_in_words(summary['compute_seconds'])}"
    if summary.get("iterations") is not None:
        solved = f"solved in {time_in_words(summary['solve_seconds'])} ({summary['iterations']} iterations, "
        solved += f"{summary['convolutions']} convolutions)"
    console.print(f"\n{solved}; everything, pictures included, in {time_in_words(result.seconds)}", soft_wrap=True)
    console.print(_spent(summary["seconds_by_block"]), soft_wrap=True)


def _spent(seconds: dict[str, float]) -> str:
    """Times by block; blocks below a fraction of the total time are summed at the end."""
    from eigencontact.core.units import time_in_words

    least = 0.01 * sum(seconds.values())
    shown = {name: value for name, value in seconds.items() if value >= least and name != "rest"}
    shown["rest"] = sum(seconds.values()) - sum(shown.values())
    return "  " + ", ".join(f"{name} {time_in_words(value)}" for name, value in shown.items())
