"""Declarations of the scalars of a run, in the file of the block, law or observer that computes them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from math import fsum
from typing import Any, Literal

from eigencontact.core.units import per_length, readable

__all__ = ["ROUND_OFF", "ErrorBar", "Number", "accumulate", "by_name", "headline_numbers"]

#: Errors below this part of a number are round-off.
ROUND_OFF = 1e-9


@dataclass(frozen=True, kw_only=True, slots=True)
class Number:
    """One scalar of a step and of a run.

    Results files, the summary, the console, reports, sweeps and the reference page read this declaration; none of them
    lists names.

    Attributes
    ----------
    name : str
        In results and ``summary.json``.
    unit : str
        SI; ``"1"`` for a ratio or a count.
    meaning : str
        In words.
    role : {"result", "certificate", "error", "effort"}
        A certificate measures how well the equations of a step are met, an error estimates what a result may be off by,
        an effort counts work.
    over : {"last", "sum", "max"}
        What the summary of a run gives: the value of the last step, the sum over the steps, or the largest.
    headline : bool
        Whether the console, notebooks and the figures of a sweep show it without being asked.
    label : str
        Words before the value there; by default its name.
    replaces : str
        Name of a number that is not shown where this one is not zero.
    estimates : str
        Of an error: name of the number that it belongs to.
    scatters : bool
        Whether it jumps as cells move, like an area of cells: its error is then not extrapolated.
    of_widths : bool
        Whether it is a length between the outermost cells of a zone: it is known to half a cell.
    summed : bool
        Whether it is a sum over the load steps that were solved, without skipped ones.
    of_points : bool
        Whether it is the depth of one of the points of a region: it is known to half their distance.
    in_line : str
        Its meaning and its label in a line contact, where these differ.

    Examples
    --------
    >>> Number(name="max_pressure", unit="Pa", meaning="largest contact pressure", headline=True).of_run([1.0, 3.0])
    3.0
    >>> Number(name="iterations", unit="1", meaning="iterations", role="effort", over="sum").of_run([4.0, None, 6.0])
    10.0
    """

    name: str
    unit: str
    meaning: str
    role: Literal["result", "certificate", "error", "effort"] = "result"
    over: Literal["last", "sum", "max"] = "last"
    headline: bool = False
    label: str = ""
    replaces: str = ""
    estimates: str = ""
    scatters: bool = False
    of_widths: bool = False
    summed: bool = False
    of_points: bool = False
    in_line: str = ""

    def per_length(self) -> Number:
        """Return the declaration in a line contact, where forces, work and areas are per length."""
        meaning, label = self.in_line or self.meaning, self.in_line or self.label
        return replace(self, unit=per_length(self.unit), meaning=meaning, label=label)

    @property
    def words(self) -> str:
        """Words before the value."""
        return self.label or self.name.replace("_", " ")

    def text(self, value: float) -> str:
        """Value with its unit, for people."""
        if self.unit in ("1", "unknown"):
            return f"{value:.4g}"
        return readable(value, self.unit.replace("m2", "m^2").replace("m3", "m^3"))

    def own_error(self, name: str) -> Number:
        """Declaration of the estimated error of this number."""
        meaning = f"error of the {self.meaning}"
        return Number(name=name, unit=self.unit, meaning=meaning, role="error", estimates=self.name)

    def of_run(self, values: Iterable[float | None]) -> float | None:
        """Value of a run from the values of its steps; None without any value."""
        listed = list(values)
        if self.over == "last":
            return listed[-1] if listed else None
        step_values = [value for value in listed if value is not None]
        if not step_values:
            return None
        return fsum(step_values) if self.over == "sum" else max(step_values)

    def attributes(self) -> dict[str, str | int]:
        """Attributes of its variable in a results file."""
        return {
            "units": self.unit, "long_name": self.meaning, "purpose": self.role, "over": self.over,
            "headline": int(self.headline), "label": self.words, "replaces": self.replaces, "estimates": self.estimates,
        }  # fmt: skip

    @classmethod
    def of_attributes(cls, name: str, attributes: Mapping[str, Any]) -> Number:
        """Declaration that a variable of a results file carries."""
        return cls(
            name=name, unit=str(attributes["units"]), meaning=str(attributes["long_name"]),
            role=attributes.get("purpose", "result"), over=attributes.get("over", "last"),
            headline=bool(attributes.get("headline", 0)),
            label=str(attributes.get("label", "")), replaces=str(attributes.get("replaces", "")),
            estimates=str(attributes.get("estimates", "")),
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True, slots=True)
class ErrorBar:
    """Error of one number of a run.

    Attributes
    ----------
    value, error : float
        The number and its estimated error, in the unit of the number.
    source : str
        Part of the discretisation with the largest share.
    order : float, optional
        Order with which that share was observed to fall.
    parts : dict of str to float
        Share of every part, by name.
    """

    value: float
    error: float
    source: str
    order: float | None = None
    parts: Mapping[str, float] = field(default_factory=dict)

    @property
    def counts(self) -> bool:
        """Whether the error is more than round-off: that of a load that the scene prescribes is not."""
        return self.error > ROUND_OFF * abs(self.value)

    @property
    def relative(self) -> float | None:
        """Error relative to the value; None for a value of zero."""
        return self.error / abs(self.value) if self.value else None

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {**asdict(self), "relative": self.relative, "parts": dict(self.parts)}

    @classmethod
    def of_dict(cls, table: Mapping[str, Any]) -> ErrorBar:
        """Error bar from the data of `to_dict`."""
        return cls(**{name: value for name, value in table.items() if name != "relative"})

    def words(self, number: Number) -> str:
        """Error in the unit of the value, with its main source.

        Examples
        --------
        >>> radius = Number(name="contact_radius", unit="m", meaning="radius of the contact")
        >>> ErrorBar(value=6e-6, error=3e-8, source="cells", order=1.94).words(radius)
        '± 0.03 um (0.5 %, cells)'
        """
        if not self.value:
            return f"± {number.text(float(f'{self.error:.2g}'))} ({self.source})"
        digits, _, unit = number.text(self.value).partition(" ")
        error = f"{self.error * float(digits) / self.value:.2g} {unit}".strip()
        return f"± {error} ({100 * self.error / abs(self.value):.2g} %, {self.source})"


def by_name(numbers: Iterable[Number]) -> dict[str, Number]:
    """Numbers by name, in order; of equal names the first counts."""
    listed: dict[str, Number] = {}
    for number in numbers:
        listed.setdefault(number.name, number)
    return listed


def headline_numbers(numbers: Iterable[Number], values: Mapping[str, float | None]) -> list[Number]:
    """Main results of a run, without results that another nonzero number replaces.

    Examples
    --------
    >>> solved = Number(name="solved", unit="J", meaning="work", headline=True)
    >>> whole = Number(name="whole", unit="J", meaning="work of all cycles", headline=True, replaces="solved")
    >>> [number.name for number in headline_numbers([solved, whole], {"solved": 1.0, "whole": 9.0})]
    ['whole']
    """
    listed = list(numbers)
    replaced = {number.replaces for number in listed if values.get(number.name)}
    return [
        number
        for number in listed
        if number.headline and number.name not in replaced and values.get(number.name) is not None
    ]


def accumulate(numbers: Mapping[str, Number], total: dict[str, float], values: Mapping[str, float]) -> None:
    """Combine the values of several solutions of a step: iterations are summed, other numbers have their maximum."""
    for name, value in values.items():
        if name not in total:
            total[name] = value
        elif name in numbers and numbers[name].role != "effort":
            total[name] = max(total[name], value)
        else:
            total[name] += value
