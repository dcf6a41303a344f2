"""All numbers of a step for the reference page, from the declarations of blocks and observers."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from typing import TYPE_CHECKING

from eigencontact.core.numbers import Number, by_name
from eigencontact.errors import EigencontactError
from eigencontact.hooks.registry import Registry

if TYPE_CHECKING:
    from eigencontact.execution.blocks.block import PlanItem

__all__ = ["known_numbers", "numbers_as_markdown", "observed_numbers"]

_RULES = {"last": "value of the last step", "sum": "sum over the steps", "max": "largest of the steps"}


def known_numbers() -> dict[str, Number]:
    """Numbers of blocks, by name; those of laws and observers depend on the scene.

    Examples
    --------
    >>> known_numbers()["max_pressure"].unit
    'Pa'
    """
    from eigencontact import execution
    from eigencontact.execution.blocks.block import PlanItem

    for module in pkgutil.walk_packages(execution.__path__, f"{execution.__name__}."):
        importlib.import_module(module.name)
    return by_name(number for item in _below(PlanItem) for number in item.numbers)


def _below(kind: type[PlanItem]) -> Iterator[type[PlanItem]]:
    for child in kind.__subclasses__():
        yield child
        yield from _below(child)


def observed_numbers(registry: Registry) -> dict[str, dict[str, str]]:
    """Units of the numbers of each installed observer that needs no parameters, by its key."""
    listed = {}
    for entry in registry.of_kind("observer"):
        try:
            listed[registry.spelling(entry)] = dict(entry.component().units)
        except (TypeError, EigencontactError):  # it needs parameters: its own page says which
            continue
    return listed


def numbers_as_markdown(registry: Registry) -> str:
    """Tables of the numbers of blocks and of observers."""
    lines = ["| number | unit | meaning | kind | summary of a run |", "|---|---|---|---|---|"]
    lines += [
        f"| `{number.name}` | {number.unit} | {number.meaning} | {number.role} | {_RULES[number.over]} |"
        for number in known_numbers().values()
    ]
    lines += ["", "## Observers", "", "| number | unit |", "|---|---|"]
    lines += [
        f"| `{key.replace('-', '_')}_{name}` | {unit} |"
        for key, units in observed_numbers(registry).items()
        for name, unit in units.items()
    ]
    return "\n".join(lines)
