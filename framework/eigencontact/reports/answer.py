"""The result of a run in a few sentences, for the top of its report."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from eigencontact.reports.columns import Column

__all__ = ["answer", "cards"]

#: Sentence for a number after the last step, in the order of a report.
_SENTENCES = {
    "normal_load": "The normal load is {}.",
    "tangential_load": "The tangential load is {}.",
    "contact_radius": "The contact area is that of a circle with a radius of {}.",
    "max_pressure": "The largest contact pressure is {}.",
    "max_von_mises": "The largest von Mises stress at the requested points is {}.",
    "print_depth": "The residual imprint is {} deep.",
    "cycles": "The run covers {} cycles.",
    "worn_volume": "The bodies have lost a volume of {}.",
    "max_worn_depth": "The largest worn depth is {}.",
    "wear_energy": "The work of friction is {}, with the skipped cycles.",
    "dissipated_energy": "The work of friction is {}.",
}
#: Numbers that a report shows in large letters.
_CARDS = (
    *("normal_load", "tangential_load", "approach", "contact_radius", "max_pressure", "max_von_mises", "max_uplift"),
    *("max_plastic_strain", "dissipated_energy", "wear_energy", "worn_volume", "max_worn_depth"),
)
#: Estimated relative errors, by the number that they belong to.
_ERRORS = {"worn_volume": "wear_error"}


def answer(columns: Iterable[Column], steps: Sequence[int]) -> list[str]:
    """Sentences on the numbers after the last step.

    Parameters
    ----------
    columns : iterable of Column
        All numbers of the run.
    steps : sequence of int
        Numbers of the stored steps.

    Returns
    -------
    list of str
        A number that ends below its largest magnitude names that magnitude and its step as well. The work of friction
        is that of all cycles where the run skips some.
    """
    by_name = {column.name: column for column in _of_all_cycles(columns)}
    sentences = [
        _sentence(words, by_name[name], by_name.get(_ERRORS.get(name, "")), steps)
        for name, words in _SENTENCES.items()
        if name in by_name and by_name[name].last is not None and by_name[name].largest
    ]
    moved = (axis for axis in "xy" if f"shift_{axis}" in by_name and by_name[f"shift_{axis}"].varies)
    return [*sentences, *(_stroke(by_name[f"shift_{axis}"], axis) for axis in moved)]


def cards(columns: Iterable[Column]) -> list[Column]:
    """Numbers that a report shows in large letters, in the order of the columns."""
    return [column for column in _of_all_cycles(columns) if column.name in _CARDS]


def _of_all_cycles(columns: Iterable[Column]) -> list[Column]:
    """All columns but the work of friction in solved increments, where the run also has that of all cycles."""
    listed = list(columns)
    whole = any(column.name == "wear_energy" and column.largest for column in listed)
    return [column for column in listed if not (whole and column.name == "dissipated_energy")]


def _sentence(words: str, column: Column, error: Column | None, steps: Sequence[int]) -> str:
    text = words.format(_value(column, column.last))
    if column.varies and _value(column, column.last) != _value(column, column.largest):
        largest = _value(column, column.largest)
        text = f"{text[:-1]}; the largest value is {largest}, at step {steps[column.at_largest]}."
    if error is not None and error.last:
        text = f"{text[:-1]} (estimated error {100 * error.last:.2g} %)."
    return text


def _value(column: Column, value: float | None) -> str:
    return f"{column.text(value)} {column.scale.unit}".strip()


def _stroke(column: Column, axis: str) -> str:
    held = [value for value in column.values if value is not None]
    return f"The shift along {axis} spans {_value(column, max(held) - min(held))} over all steps, peak to peak."
