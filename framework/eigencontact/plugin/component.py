"""Base of every plugin class: key, kind, references."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, ClassVar

from eigencontact.hooks.guard import guard_methods

__all__ = ["Component"]


class Component:
    """Base of every plugin class.

    Attributes
    ----------
    key : str
        Name in scene files, unique within its kind and package: no blanks, no ':'.
    kind : str
        Kind of plugin; set by the abstract class.
    references : tuple of str
        Sources to cite when a run uses this component.

    Examples
    --------
    Every kind has components of its own; their fields are their table in a scene:

    >>> from dataclasses import dataclass
    >>> import numpy as np
    >>> from eigencontact.plugin import Geometry, Length, require
    >>> @dataclass(frozen=True, kw_only=True)
    ... class Wave(Geometry):
    ...     key = "wave"
    ...     length: Length
    ...     def __post_init__(self):
    ...         require(self.length > 0, self.key, "length", self.length, "positive [m]")
    ...     def separation(self, x, y):
    ...         return self.length * (1 - np.cos(2 * np.pi * x / self.length)) + 0 * y
    >>> Wave(length=1e-6).kind
    'geometry'
    >>> Wave(length=-1.0)
    Traceback (most recent call last):
    eigencontact.errors.SceneError: wave.length must be positive [m] (got -1.0)
    """

    key: ClassVar[str]
    kind: ClassVar[str]
    references: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        guard_methods(cls)

    @property
    def parts(self) -> list[Component]:
        """Components in the fields of this component, and their components in turn."""
        values: list[object] = [getattr(self, item.name) for item in fields(self)] if is_dataclass(self) else []
        members = [member for value in values for member in _members(value)]
        return [
            component for member in members if isinstance(member, Component) for component in (member, *member.parts)
        ]


def _members(value: object) -> Iterable[object]:
    """Members of a field that is a tuple or a table by name; else the value."""
    if isinstance(value, Mapping):
        return value.values()
    return value if isinstance(value, tuple) else (value,)
