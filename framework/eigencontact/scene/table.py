"""Base of all tables of a scene: kebab-case names, no unknown keys, no change after validation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    ValidationInfo,
    field_validator,
    model_validator,
)

from eigencontact.core.quantities import Length
from eigencontact.scene.checks import finite, non_negative, one_or_many, only_numbers, positive

__all__ = ["Also", "ComponentTable", "Depth", "FiniteLength", "OfKind", "PositiveLength", "Table", "Tables"]

PositiveLength = Annotated[Length, AfterValidator(positive("m"))]
FiniteLength = Annotated[Length, AfterValidator(finite("m"))]
Depth = Annotated[Length, AfterValidator(non_negative("m"))]
Tables = Annotated[list[dict[str, Any]], BeforeValidator(one_or_many)]


@dataclass(frozen=True, slots=True)
class OfKind:
    """Mark of a field with the table of a plugin of a kind, or a list of such tables: ``type`` names the plugin.

    A table without ``type`` has the type `default`.
    """

    kind: str
    default: str = ""


@dataclass(frozen=True, slots=True)
class Also:
    """Mark of a field that also accepts a text in place of its table."""

    text: str


class Table(BaseModel):
    """Base of every table of a scene."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, alias_generator=lambda name: name.replace("_", "-"), populate_by_name=True
    )

    @field_validator("*", mode="before")
    @classmethod
    def _numbers(cls, value: Any, info: ValidationInfo) -> Any:
        field = cls.model_fields[str(info.field_name)]
        only_numbers(Annotated[field.annotation, None, *field.metadata], value)
        return value


class ComponentTable(Table):
    """Table with the fields of a plugin of a `kind` as further keys; ``type`` names the plugin.

    Parameters
    ----------
    type : str
        Name of the plugin; its fields are further keys.
    """

    model_config = ConfigDict(extra="allow")
    kind: ClassVar[str]

    type: str

    @model_validator(mode="before")
    @classmethod
    def _names_a_plugin(cls, data: Any) -> Any:
        if isinstance(data, dict) and "type" not in data:
            from eigencontact.scene.installed import installed_plugins

            keys = " or ".join(repr(entry.key) for entry in installed_plugins().of_kind(cls.kind))
            raise ValueError(f"given a type, {keys}")
        return data

    @property
    def component(self) -> dict[str, Any]:
        """Table of the plugin: ``type`` and its fields."""
        return {"type": self.type, **(self.model_extra or {})}

    @property
    def beside(self) -> list[str]:
        """Keys that are not fields of the plugin."""
        return [name for name in type(self).model_fields if name != "type"]

    def check_in(self, scene: Any) -> None:
        """Checks between the table and the rest of its scene; none by default.

        Raises
        ------
        ValueError
            A broken rule, as a whole sentence after ``!``.
        """
