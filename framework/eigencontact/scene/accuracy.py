"""Accuracy table of a scene: largest errors of its numbers, time and memory."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, model_validator

from eigencontact.core.quantities import Unit
from eigencontact.core.units import NUMBER
from eigencontact.errors import SceneError
from eigencontact.scene.checks import positive
from eigencontact.scene.table import Table

if TYPE_CHECKING:
    from eigencontact.scene.schema import Scene

__all__ = ["Accuracy", "accuracy_table", "part_of", "with_accuracy"]

_RULE = 'a relative error, as "1 %" or 0.01, or an error with a unit, as "2 nm"'


def part_of(target: float | str) -> float | None:
    """Relative error of a target; None for an error with a unit.

    Examples
    --------
    >>> part_of("0.5 %"), part_of(0.01), part_of("2 nm")
    (0.005, 0.01, None)
    """
    if not isinstance(target, str):
        return float(target)
    text = target.strip()
    return 0.01 * float(text.removesuffix("%")) if text.endswith("%") else None


def _target(value: Any) -> Any:
    """Check a target; the unit of an error is checked later with that of its number."""
    if isinstance(value, str):
        head = NUMBER.match(value.strip())
        unit = "" if head is None else value.strip()[head.end() :].strip()
        valid = bool(unit) and ("%" not in unit or unit == "%")
    else:
        valid = isinstance(value, int | float) and not isinstance(value, bool)
    fraction = part_of(value) if valid else None
    if not valid or (fraction is not None and not 0.0 < fraction < 1.0):
        raise ValueError(_RULE)
    return value


def _entry(value: Any) -> Any:
    """Check a target of a number, or a table of targets of a field by region."""
    if not isinstance(value, Mapping):
        return _target(value)
    try:
        targets = {str(region).replace("-", "_"): _target(target) for region, target in value.items()}
    except ValueError:
        targets = {}
    if not targets:
        raise ValueError(f"a table of targets by region, each {_RULE}")
    return targets


Target = Annotated[float | str, BeforeValidator(_target)]
Entry = Annotated[float | str | dict[str, float | str], BeforeValidator(_entry)]


class Accuracy(Table):
    """Largest errors of the results; the program chooses cells, increments and tolerances to reach them.

    Parameters
    ----------
    numbers : float or text, optional
        Largest error of all main results, ``"1 %"``. Any further key is the name of a number of the summary and sets
        its error: ``max-pressure = "0.5 %"``, ``approach = "2 nm"``. A field of a region has both names:
        ``stress.section = "3 %"``, relative to the largest value of the field.
    time : float, optional
        Time budget of the run, 10 minutes by default. At its end the run reports the accuracy that it reached and the
        predicted time for the targets.
    memory : float, optional
        Memory budget of the arrays, by default the memory of the machine.
    """

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Entry] = Field(init=False)

    numbers: Target | None = None
    time: Annotated[float, Unit("s", "a time"), AfterValidator(positive("s"))] | None = None
    memory: Annotated[float, Unit("B", "a size"), AfterValidator(positive("B"))] | None = None

    @model_validator(mode="after")
    def _asks(self) -> Accuracy:
        if self.numbers is None and not self.targets:
            raise ValueError('given numbers = "1 %", or the name of a number with its error')
        return self

    @property
    def targets(self) -> dict[str, float | str]:
        """Targets of single numbers by their names in the summary, and of fields, like ``"von_mises.section"``."""
        targets: dict[str, float | str] = {}
        for key, entry in (self.__pydantic_extra__ or {}).items():
            name = key.replace("-", "_")
            targets |= {f"{name}.{at}": of for at, of in entry.items()} if isinstance(entry, dict) else {name: entry}
        return targets


def accuracy_table(targets: Any) -> dict[str, Any]:
    """Table of an accuracy argument: one target for all main results, or targets by name.

    Examples
    --------
    >>> accuracy_table("1 %"), accuracy_table({"max_pressure": 0.01})
    ({'numbers': '1 %'}, {'max-pressure': 0.01})
    """
    if isinstance(targets, str | int | float) and not isinstance(targets, bool):
        return {"numbers": targets}
    if not isinstance(targets, dict):
        raise SceneError(f"accuracy must be {_RULE}, or a table of such targets by name (got {targets!r})")
    return {str(name).replace("_", "-"): target for name, target in targets.items()}


def with_accuracy(scene: Scene, accuracy: str | float | Mapping[str, Any]) -> Scene:
    """Scene with an accuracy; its own targets remain unless the call replaces them."""
    from eigencontact.scene.schema import Scene

    tables = scene.resolved()
    table = {**tables.get("accuracy", {}), **accuracy_table(accuracy)}
    return Scene(**{**tables, "accuracy": table}).within(scene.folder)
