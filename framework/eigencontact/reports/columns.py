"""The numbers of all steps, by what they are for: results, certificates, effort."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from eigencontact.results.layout import SCALARS
from eigencontact.viz.style import Scale, scale_for

if TYPE_CHECKING:
    from eigencontact.results.stored import Results

__all__ = ["EFFORT", "Column", "columns", "is_certificate", "telling"]

#: Numbers that say what the steps took.
EFFORT = (
    *("iterations", "convolutions", "tangential_convolutions", "coupling_rounds", "coupling_iterations"),
    *("inclusion_iterations", "substeps", "solve_seconds"),
)
#: Numbers that say how good the others are, beside the residuals.
_ERRORS = ("wear_error", "update_error", "wear_lag", "layer_error", "plastic_error")
#: Below these parts of the largest load, of that times the contact radius, and of that radius, forces, moments and
#: lengths are round-off. Solvers balance moments to their tolerance only; friction and wear may be very small.
_ROUND_OFF, _MOMENT, _LENGTH = 1e-9, 1e-6, 1e-12


@dataclass(frozen=True)
class Column:
    """One number of every step.

    Attributes
    ----------
    name : str
        As in ``summary.json`` and ``results.nc``.
    meaning, unit : str
        In words; SI.
    values : list of float or None
        By step; None where a step has none.
    """

    name: str
    meaning: str
    unit: str
    values: list[float | None]

    @cached_property
    def scale(self) -> Scale:
        """Engineering unit for all of them."""
        # Observers spell powers with a circumflex; a prefix belongs to what is raised.
        found = scale_for([value for value in self.values if value is not None], self.unit.replace("^", ""))
        return Scale(found.factor, found.unit.replace("m2", "m²").replace("m3", "m³"))

    @property
    def label(self) -> str:
        """Name in words, with the unit that the texts are in."""
        words = self.name.replace("_", " ")
        return f"{words} [{self.scale.unit}]" if self.scale.unit else words

    def text(self, value: float | None) -> str:
        """A value in the unit of the scale, without it."""
        return "" if value is None else f"{value * self.scale.factor:.5g}"

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
        """Whether it changes from step to step."""
        held = [value for value in self.values if value is not None]
        return len(held) > 1 and max(held) - min(held) > _ROUND_OFF * max(map(abs, held))


def columns(dataset: Results) -> list[Column]:
    """Every number that some step has, in the order of the vocabulary, those of laws and observers after them."""
    found = []
    for name, variable in dataset.data_vars.items():
        role = variable.attrs.get("role")
        if role not in ("scalar", "observed"):
            continue
        values = [float(value) if math.isfinite(value) else None for value in variable.values]
        if all(value is None for value in values):
            continue
        meaning = str(variable.attrs["long_name"])
        if role == "observed":
            meaning = "by an observer of the scene"
        found.append(Column(str(name), meaning, str(variable.attrs["units"]), values))
    order = list(SCALARS)
    found.sort(key=lambda column: order.index(column.name) if column.name in order else len(order))
    return found


def is_certificate(name: str) -> bool:
    """Whether a number says how good others are."""
    return name.endswith("_residual") or name in _ERRORS


def telling(found: list[Column]) -> list[Column]:
    """Results among the numbers: neither certificates nor effort, nor what is zero, or round-off, in all steps."""
    largest = {column.name: abs(column.largest or 0.0) for column in found}
    load, radius = largest.get("normal_load", 0.0), largest.get("contact_radius", 0.0)
    least = {"N": _ROUND_OFF * load, "N m": _MOMENT * load * radius, "m": _LENGTH * radius}
    return [
        column
        for column in found
        if not is_certificate(column.name)
        and column.name not in EFFORT
        and largest[column.name] > least.get(column.unit, 0.0)
    ]
