"""The result of a run in a few sentences, for the top of its report."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eigencontact.core.numbers import headline_numbers

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from eigencontact.reports.columns import Column

__all__ = ["answer", "cards"]


def answer(columns: Iterable[Column], steps: Sequence[int]) -> list[str]:
    """Sentences on the numbers of a run (all of them, with the numbers of its stored steps) after the last step.

    A number that ends below its largest magnitude names that magnitude and its step as well. The work of friction is
    that of all cycles where the run skips some.
    """
    listed = list(columns)
    by_name = {column.name: column for column in listed}
    errors = {column.number.estimates: column for column in listed if column.number.estimates}
    sentences = [_sentence(column, errors.get(column.name), steps) for column in cards(listed) if column.largest]
    moved = (axis for axis in "xy" if f"shift_{axis}" in by_name and by_name[f"shift_{axis}"].varies)
    return [*sentences, *(_stroke(by_name[f"shift_{axis}"], axis) for axis in moved)]


def cards(columns: Iterable[Column]) -> list[Column]:
    """Headline numbers, in the order of the columns, without those that another number replaces."""
    by_name = {column.name: column for column in columns}
    largest = {name: column.largest for name, column in by_name.items()}
    return [by_name[number.name] for number in headline_numbers((c.number for c in by_name.values()), largest)]


def _sentence(column: Column, error: Column | None, steps: Sequence[int]) -> str:
    last, largest = column.with_unit(column.last), column.with_unit(column.largest)
    text = f"{column.meaning[:1].upper()}{column.meaning[1:]}: {last}."
    if column.varies and last != largest:
        text = f"{text[:-1]}; the largest value is {largest}, at step {steps[column.at_largest]}."
    if error is not None and error.last:
        text = f"{text[:-1]} (estimated error {100 * error.last:.2g} %)."
    return text


def _stroke(column: Column, axis: str) -> str:
    values = [value for value in column.values if value is not None]
    return f"The shift along {axis} spans {column.with_unit(max(values) - min(values))} over all steps, peak to peak."
