"""Keys of one table: of a scene, or of a plugin's class. Both are described alike."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import MISSING, dataclass, fields
from typing import Annotated, Any, get_type_hints

from pydantic import BaseModel
from pydantic_core import PydanticUndefined

from eigencontact.reference.docstrings import meanings
from eigencontact.reference.forms import Form, form_of, in_words, table_within, unit_within

__all__ = ["Key", "keys_of"]


@dataclass(frozen=True, slots=True)
class Key:
    """One key of a table.

    Attributes
    ----------
    name : str
        As a scene writes it.
    meaning : str
        One sentence or more, from the docstring of the table's class.
    form : dict
        What the key may hold, as JSON Schema (`eigencontact.reference.forms`).
    unit : str or None
        SI unit of plain numbers.
    required : bool
        Whether the key must be given.
    default : object
        Value where the key is not given; None where there is none.
    table : type or None
        Class of the tables that the key holds.
    """

    name: str
    meaning: str
    form: Form
    unit: str | None
    required: bool
    default: Any
    table: type | None

    @property
    def valid_values(self) -> str:
        """Valid values of the key in words."""
        return in_words(self.form)

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        choices = self.form.get("enum") or next((f["enum"] for f in self.form.get("anyOf", []) if "enum" in f), None)
        return {
            "name": self.name,
            "meaning": self.meaning,
            "takes": self.valid_values,
            "unit": self.unit,
            "choices": choices,
            "required": self.required,
            "default": self.default,
        }


def keys_of(cls: type) -> Iterator[Key]:
    """Keys of a table's class: a pydantic model, or a dataclass."""
    meaning_of = meanings(cls)
    described = _of_model(cls) if issubclass(cls, BaseModel) else _of_dataclass(cls)
    for field, hint, required, default in described:
        yield Key(
            name=field.replace("_", "-"),
            meaning=meaning_of.get(field, ""),
            form=form_of(hint),
            unit=unit_within(hint),
            required=required,
            default=_plain(default),
            table=table_within(hint),
        )


def _of_model(cls: type[BaseModel]) -> Iterator[tuple[str, Any, bool, Any]]:
    for name, field in cls.model_fields.items():
        hint = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
        default = None if field.default is PydanticUndefined else field.default
        yield name, hint, field.is_required(), default


def _of_dataclass(cls: type) -> Iterator[tuple[str, Any, bool, Any]]:
    hints = get_type_hints(cls, include_extras=True)
    for item in fields(cls):
        default = item.default_factory() if item.default_factory is not MISSING else item.default
        yield item.name, hints[item.name], default is MISSING, None if default is MISSING else default


def _plain(value: Any) -> Any:
    """Default in the form of a file; tables and components have the defaults of their keys."""
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value if isinstance(value, bool | int | float | str) else None
