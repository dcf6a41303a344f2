"""Numbers of all steps, grouped into results, certificates and effort; and the result in a few sentences."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from eigencontact.core.field_error import error_name
from eigencontact.core.numbers import Number, headline_numbers
from eigencontact.viz.style import Scale, scale_for

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from eigencontact.results.stored import Results


__all__ = ["Column", "answer", "cards", "columns", "telling"]

#: Below these parts of the largest load, of that times the contact radius, and of that radius, forces, moments and
#: lengths are round-off. Solvers balance moments to their tolerance only; friction and wear may be very small.
_ROUND_OFF, _MOMENT, _LENGTH = 1e-9, 1e-6, 1e-12


@dataclass(frozen=True)
class Column:
    """Number of every step: its declaration, its values by step, None where a step has none, and their errors.

    The errors are empty where they were not estimated.
    """

    number: Number
    values: list[float | None]
    errors: tuple[float, ...] = ()

    @property
    def name(self) -> str:
        """As in ``summary.json`` and ``results.nc``."""
        return self.number.name

    @property
    def meaning(self) -> str:
        """In words."""
        return self.number.meaning

    @property
    def unit(self) -> str:
        """SI unit."""
        return self.number.unit

    @cached_property
    def scale(self) -> Scale:
        """Engineering unit for all values."""
        # Observers spell powers with a circumflex; a prefix belongs to what is raised.
        scale = scale_for([value for value in self.values if value is not None], self.unit.replace("^", ""))
        return Scale(scale.factor, scale.unit.replace("m2", "m²").replace("m3", "m³"))

    @property
    def label(self) -> str:
        """Name in words, with the unit that the texts are in."""
        return self.scale.label(self.name.replace("_", " "))

    def text(self, value: float | None) -> str:
        """Value in the unit of the scale, without the unit."""
        return "" if value is None else f"{value * self.scale.factor:.5g}"

    def with_unit(self, value: float | None) -> str:
        """Value in the unit of the scale, with the unit."""
        return f"{self.text(value)} {self.scale.unit}".strip()

    @property
    def last(self) -> float | None:
        """The value of the last step."""
        return self.values[-1]

    @property
    def at_largest(self) -> int:
        """Position where the largest magnitude is first reached, but for round-off."""
        reached = (1 - _ROUND_OFF) * abs(self.largest or 0.0)
        return next(at for at, value in enumerate(self.values) if abs(value or 0.0) >= reached)

    @property
    def largest(self) -> float | None:
        """The value of the largest magnitude."""
        return max((value for value in self.values if value is not None), key=abs, default=None)

    @property
    def varies(self) -> bool:
        """Whether the values differ between steps."""
        values = [value for value in self.values if value is not None]
        return len(values) > 1 and max(values) - min(values) > _ROUND_OFF * max(map(abs, values))


def columns(dataset: Results) -> list[Column]:
    """All numbers of the steps, in the order of the blocks that compute them, those of observers last."""
    listed = []
    for name, variable in dataset.data_vars.items():
        attrs = variable.attrs
        if attrs.get("role") in ("scalar", "observed"):
            values = [float(value) if math.isfinite(value) else None for value in variable.values]
            if any(value is not None for value in values):
                place = (attrs["role"] == "observed", int(attrs.get("rank", 0)), str(name))
                errors = tuple(dataset[error_name(name)].values) if error_name(name) in dataset else ()
                listed.append((place, Column(Number.of_attributes(str(name), attrs), values, errors)))
    return [column for _, column in sorted(listed, key=lambda item: item[0])]


def telling(columns_of_run: list[Column]) -> list[Column]:
    """Results among the numbers, without certificates, iterations, zeros and round-off."""
    largest = {column.name: abs(column.largest or 0.0) for column in columns_of_run}
    load, radius = largest.get("normal_load", 0.0), largest.get("contact_radius", 0.0)
    least = {"N": _ROUND_OFF * load, "N m": _MOMENT * load * radius, "m": _LENGTH * radius}
    return [
        column
        for column in columns_of_run
        if column.number.role == "result" and largest[column.name] > least.get(column.unit, 0.0)
    ]


def answer(columns: Iterable[Column], steps: Sequence[int]) -> list[str]:
    """Sentences about the numbers of a run (all columns, with the numbers of its stored steps) after the last step.

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
    """Main results, in the order of the columns, without those that another number replaces."""
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
