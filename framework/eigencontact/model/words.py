"""Bodies and components of a model in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import Field, fields, is_dataclass
from itertools import pairwise
from typing import Any, get_args, get_type_hints

from eigencontact.core.material import Material
from eigencontact.core.quantities import Unit
from eigencontact.core.units import readable
from eigencontact.model.kernels import Solid
from eigencontact.plugin import Component, ConstitutiveLaw, LayeredMedium

__all__ = [
    "body_in_words",
    "layers_as_data",
    "layers_in_words",
    "nested_parameters",
    "parameters",
    "sizes",
    "unit_of",
]

#: A field with more numbers than a vector has, such as a tabulated curve, is given by its count.
_LISTED = 6


def body_in_words(body: Solid | None, law: ConstitutiveLaw | None = None) -> str:
    """Constants or layers of a body in one line, with the key of its law."""
    if body is None:
        return "rigid"
    if isinstance(body, Material):
        return f"{'elastic' if law is None else f'of law {law.key!r}'}, {_constants(body)}"
    tops = (0.0, *body.interfaces)
    parts = [
        f"{readable(bottom - top, 'm')} of {name}{_constants(body.material_at(top))}"
        for (top, bottom), name in zip(pairwise(tops), _layer_names(body), strict=False)
    ]
    if len(parts) > 4:
        parts = [parts[0], f"{len(parts) - 2} more layers", parts[-1]]
    return f"layered (plugin {body.key!r}): {'; '.join([*parts, _constants(body.deep_material)])} below"


def layers_as_data(body: LayeredMedium) -> list[dict[str, Any]]:
    """Name, and depths of top and bottom [m], of each layer above the substrate."""
    tops = (0.0, *body.interfaces)
    return [
        {"name": name, "top": float(top), "bottom": float(bottom)}
        for name, (top, bottom) in zip(body.layer_names, pairwise(tops), strict=False)
    ]


def _layer_names(body: LayeredMedium) -> list[str]:
    """Names of layers before their constants; empty for layers with a number only."""
    return ["" if name == f"layer {number}" else f"{name!r}, " for number, name in enumerate(body.layer_names, 1)]


def layers_in_words(bodies: Sequence[Solid | None], *, periodic: bool) -> str:
    """Kernels of layered bodies in words; empty for homogeneous bodies."""
    media = {number: body for number, body in enumerate(bodies, 1) if isinstance(body, LayeredMedium)}
    if not media:
        return ""
    layered_bodies = " and ".join(f"body {number} ({medium.key!r})" for number, medium in media.items())
    method = "for each wave of the window" if periodic else "computed once as influence coefficients of cells"
    return f"layered kernels of {layered_bodies} instead of half-space kernels, {method}"


def _constants(material: Material) -> str:
    return f"E = {readable(material.young_modulus, 'Pa')}, ν = {material.poisson_ratio:g}"


def sizes(component: Any) -> str:
    """Numbers in the fields of a component, in readable units; zeros and None are left out.

    Examples
    --------
    >>> from eigencontact import make
    >>> sizes(make("sphere", kind="geometry", radius=105e-6)), sizes(make("sphere", kind="geometry", radius=105))
    ('radius 105 um', 'radius 105 m')
    """
    hints = get_type_hints(type(component), include_extras=True)
    texts = []
    for item in _fields(component):
        unit, value = unit_of(hints[item.name]), getattr(component, item.name)
        numbers = value if isinstance(value, tuple) else (value,)
        if all(isinstance(number, int | float) and not isinstance(number, bool) for number in numbers) and any(numbers):
            text = ", ".join(readable(number, unit) if unit else f"{number:.4g}" for number in numbers)
            if len(numbers) > 1:
                text = f"({text})" if len(numbers) <= _LISTED else f"({len(numbers)} values)"
            texts.append(f"{item.name.replace('_', '-')} {text}")
    return ", ".join(texts)


def _fields(component: Any) -> tuple[Field[Any], ...]:
    """Fields of a component; a plugin class without parameters need not be a dataclass."""
    return fields(component) if is_dataclass(component) else ()


def parameters(component: Component) -> str:
    """Key of a component, its numbers, and its choices: texts, and switches with the value True."""
    choices = []
    for item in _fields(component):
        value, name = getattr(component, item.name), item.name.replace("_", "-")
        if value is True or isinstance(value, str):
            choices.append(name if value is True else f"{name} {value}")
    return ", ".join(text for text in (component.key, sizes(component), *choices) if text)


def nested_parameters(component: Component) -> Iterator[str]:
    """Lines of the components in the fields of a component, each with the name of its field."""
    for item in _fields(component):
        value = getattr(component, item.name)
        for member in value if isinstance(value, tuple) else (value,):
            if isinstance(member, Component):
                yield f"{item.name.replace('_', '-')}: {parameters(member)}"
                yield from (f"  {line}" for line in nested_parameters(member))


def unit_of(hint: Any) -> str:
    """Unit in an annotation; empty without one."""
    if isinstance(hint, Unit):
        return hint.symbol
    parts = (*get_args(hint), *getattr(hint, "__metadata__", ()))
    return next((symbol for symbol in map(unit_of, parts) if symbol), "")
