"""Field of a component with its position."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from functools import cache
from typing import Annotated, get_args, get_origin, get_type_hints

from eigencontact.core.quantities import PlaceMark

__all__ = ["place_field"]


def place_field(cls: type) -> str | None:
    """Name of the dataclass field with the annotation `Place`; None without one."""
    return _marked_field(cls)


@cache
def _marked_field(cls: type) -> str | None:
    if not is_dataclass(cls):
        return None
    hints = get_type_hints(cls, include_extras=True)
    return next((item.name for item in fields(cls) if _is_marked(hints[item.name])), None)


def _is_marked(hint: object) -> bool:
    return get_origin(hint) is Annotated and any(isinstance(annotation, PlaceMark) for annotation in get_args(hint)[1:])
