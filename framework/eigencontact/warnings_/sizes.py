"""The sizes that a plan understood, in units in which a slip of units is seen."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import Field, fields, is_dataclass
from typing import Any, get_args, get_type_hints

from eigencontact.core.grid import Grid
from eigencontact.core.quantities import Unit
from eigencontact.core.units import readable
from eigencontact.model.contact_estimate import ContactEstimate
from eigencontact.model.model import Model
from eigencontact.model.resolution import cells_per_radius, percent
from eigencontact.plugin import Component, ConstitutiveLaw
from eigencontact.scene.schema import Scene, Step
from eigencontact.scene.steps import solved_cycles
from eigencontact.scene.wear import Wear

__all__ = [
    "body_laws",
    "contact_as_data",
    "expected_lines",
    "geometry_lines",
    "largest_loads",
    "law_lines",
    "sizes",
    "wear_lines",
]

#: Sides of a contact that differ by less are those of a circle.
_ROUND = 0.1
#: A field with more numbers than a vector has, such as a tabulated curve, is given by its count.
_LISTED = 6


def geometry_lines(model: Model) -> list[str]:
    """Every geometry with its sizes."""
    words = [f"{geometry.key}, {sizes(geometry)}" for geometry in model.geometries]
    return [f"{'' if number else 'geometry':<12}{text}".rstrip(", ") for number, text in enumerate(words)]


def sizes(component: Any) -> str:
    """Numbers among the fields of a component, in readable units; what is left out or zero is not said.

    Examples
    --------
    >>> from eigencontact import make
    >>> sizes(make("sphere", kind="geometry", radius=105e-6)), sizes(make("sphere", kind="geometry", radius=105))
    ('radius 105 um', 'radius 105 m')
    """
    hints = get_type_hints(type(component), include_extras=True)
    said = []
    for item in _fields(component):
        unit, value = _unit(hints[item.name]), getattr(component, item.name)
        numbers = value if isinstance(value, tuple) else (value,)
        if all(isinstance(number, int | float) and not isinstance(number, bool) for number in numbers) and any(numbers):
            text = ", ".join(readable(number, unit) if unit else f"{number:.4g}" for number in numbers)
            if len(numbers) > 1:
                text = f"({text})" if len(numbers) <= _LISTED else f"({len(numbers)} values)"
            said.append(f"{item.name.replace('_', '-')} {text}")
    return ", ".join(said)


def _fields(component: Any) -> tuple[Field[Any], ...]:
    """Fields of a component; a plugin class without parameters need not be a dataclass."""
    return fields(component) if is_dataclass(component) else ()


def body_laws(model: Model) -> dict[int, ConstitutiveLaw]:
    """Law of each body that has one, also where the body stays elastic."""
    numbers = [number for number, body in enumerate((model.scene.body1, model.scene.body2), 1) if body.law is not None]
    return dict(zip(numbers, model.laws, strict=False))


def law_lines(model: Model) -> list[str]:
    """Constitutive laws with memory, of bodies and of regions, with hardening, damage and all parameters."""
    owners: dict[int, tuple[ConstitutiveLaw, list[str]]] = {
        id(law): (law, [f"body {number}"]) for number, law in body_laws(model).items()
    }
    for region in model.inhomogeneities:
        if region.law.variables and not region.guessed:
            owners.setdefault(id(region.law), (region.law, []))[1].append(region.name)
    lines = []
    for law, names in owners.values():
        owner = names[0] if len(names) == 1 else f"{names[0]} ... {names[-1]}, {len(names)} regions"
        lines += [f"{owner}: {_parameters(law)}", *(f"  {line}" for line in _nested(law))]
    return [f"{'' if number else 'law':<12}{text}" for number, text in enumerate(lines)]


def _parameters(component: Component) -> str:
    """Key of a component, its numbers, and its choices: text and switches that are on."""
    choices = []
    for item in _fields(component):
        value, name = getattr(component, item.name), item.name.replace("_", "-")
        if value is True or isinstance(value, str):
            choices.append(name if value is True else f"{name} {value}")
    return ", ".join(text for text in (component.key, sizes(component), *choices) if text)


def _nested(component: Component) -> Iterator[str]:
    """Lines of the components that the fields of a component hold, each by the name of its field."""
    for item in _fields(component):
        value = getattr(component, item.name)
        for member in value if isinstance(value, tuple) else (value,):
            if isinstance(member, Component):
                yield f"{item.name.replace('_', '-')}: {_parameters(member)}"
                yield from (f"  {line}" for line in _nested(member))


def wear_lines(model: Model) -> list[str]:
    """Which law wears which body, when the surfaces move, and how many cycles of each kind will be solved."""
    table = model.scene.wear
    if model.wear is None or table is None:
        return []
    who = " and ".join(f"body {body}" for body in table.parts)
    if len(table.parts) > 1:
        who = " and ".join(f"body {body} by {part:.3g} of the depth" for body, part in table.parts.items())
    law = ", ".join(text for text in (model.wear.key, sizes(model.wear)) if text)
    how = "implicit in the pressure" + ("" if model.wear.linear_in_pressure else ", by a small change of it")
    cycles = any(step.cycle is not None for step in model.scene.steps)
    when = "at the end of each cycle" if cycles and table.update == "cycle" else "by each increment"
    lines = [f"wear        {who}: {law}", f"            the surface moves {when}, {how}"]
    repeats = [step.repeat for step in model.scene.steps if step.repeat > 1]
    return [*lines, *(f"            {repeat} cycles, {_solved(repeat, table)}" for repeat in repeats)]


def _solved(repeat: int, table: Wear) -> str:
    solved = solved_cycles(repeat, table)
    if solved == repeat:
        return "all of them solved"
    if table.error is None:
        return f"{solved} of them solved: each stands for {table.cycles_per_update}"
    return f"about {solved} of them solved: as many as keep the error of the worn volume to {percent(table.error)}"


def largest_loads(scene: Scene) -> str:
    """Largest of each load or motion of the history; nothing where there is none."""
    said = []
    for name, field in Step.model_fields.items():
        unit = _unit(field.annotation)
        values = [abs(value) for step in scene.ramps if unit and (value := getattr(step, name)) is not None]
        if any(values):
            said.append(f"{name.replace('_', '-')} {readable(max(values), unit)}")
    return f", at most {', '.join(said)}" if said else ""


def expected_lines(model: Model) -> list[str]:
    """What the contact will be, by estimate."""
    contact = model.expected
    if contact is None:
        return []
    wide, high = contact.extent
    is_round = abs(wide - high) < _ROUND * max(wide, high)
    size = f"radius {readable(0.25 * (wide + high), 'm')}" if is_round else f"sides {_sides(contact)}"
    cells = cells_per_radius(contact, model.grid)
    alone = ", without what lies in the bodies" if model.sources else ""
    words = f"contact of {size}, pressure up to {readable(contact.peak, 'Pa')}, {cells:.3g} cells to a radius"
    return [f"expected    {words} (an estimate{alone})"]


def _sides(contact: ContactEstimate) -> str:
    return " x ".join(readable(side, "m") for side in contact.extent)


def contact_as_data(contact: ContactEstimate, grid: Grid) -> dict[str, object]:
    """Expected contact as plain data [m, Pa]."""
    return {
        "extent": list(contact.extent),
        "max_pressure": contact.peak,
        "cells_per_radius": cells_per_radius(contact, grid),
    }


def _unit(hint: Any) -> str:
    """Unit in an annotation; empty where there is none."""
    if isinstance(hint, Unit):
        return hint.symbol
    parts = (*get_args(hint), *getattr(hint, "__metadata__", ()))
    return next((symbol for symbol in map(_unit, parts) if symbol), "")
