"""The registry: which component classes are installed, from which package, and what failed to load."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass

from eigencontact.errors import PluginError, nearest

__all__ = ["BrokenPlugin", "Entry", "Registry"]


@dataclass(frozen=True, slots=True)
class Entry:
    """One registered class and the package it came from."""

    kind: str
    key: str
    component: type
    package: str
    version: str

    @property
    def origin(self) -> str:
        """Package and version, for messages and provenance."""
        return f"{self.package} {self.version}".strip()


@dataclass(frozen=True, slots=True)
class BrokenPlugin:
    """A plugin that could not be loaded or registered, and why."""

    name: str
    package: str
    reason: str

    def __str__(self) -> str:
        return f"plugin {self.name!r} of {self.package} is broken: {self.reason}"


@dataclass(slots=True)
class Registry:
    """Component classes by kind and key.

    Parameters
    ----------
    kinds : mapping of str to type
        Name of each kind of plugin and the abstract class its members derive from.
    """

    kinds: Mapping[str, type]
    broken: list[BrokenPlugin] = field(default_factory=list)
    _entries: dict[tuple[str, str], Entry] = field(default_factory=dict)

    def add(self, kind: str, component: type, *, package: str, version: str) -> None:
        """Register one class, or raise `PluginError` saying what is wrong with it."""
        base = self.kinds[kind]
        name = getattr(component, "__qualname__", repr(component))
        if not (inspect.isclass(component) and issubclass(component, base)):
            raise PluginError(f"{name} must be a subclass of {base.__name__} to be a {kind}")
        if inspect.isabstract(component):
            missing = ", ".join(sorted(getattr(component, "__abstractmethods__", ())))
            raise PluginError(f"{name} must implement {missing}")
        if not is_dataclass(component) or not component.__dataclass_params__.frozen:  # type: ignore[attr-defined]
            raise PluginError(f"{name} must be a frozen dataclass: its fields are its scene table")
        key = getattr(component, "key", None)
        if not (isinstance(key, str) and key):
            raise PluginError(f"{name}.key must be a non-empty text (got {key!r})")
        known = self._entries.get((kind, key))
        if known is not None and known.component is not component:
            raise PluginError(f"{kind} {key!r} is already registered by {known.origin}; choose another key")
        self._entries[kind, key] = Entry(kind, key, component, package, version)

    def copy(self) -> Registry:
        """Return a registry with the same entries, to try an addition on."""
        return Registry(self.kinds, list(self.broken), dict(self._entries))

    def __iter__(self) -> Iterator[Entry]:
        return iter(sorted(self._entries.values(), key=lambda entry: (entry.kind, entry.key)))

    def of_kind(self, kind: str) -> list[Entry]:
        """Entries of one kind, sorted by key."""
        return [entry for entry in self if entry.kind == kind]

    def get(self, kind: str, key: str, *, where: str = "") -> Entry:
        """Return the entry of `kind` with `key`.

        Raises
        ------
        PluginError
            Names what is installed, the nearest key, and any broken plugin that may have been meant.
        """
        try:
            return self._entries[kind, key]
        except KeyError:
            raise PluginError(self._unknown(kind, key, where)) from None

    def named(self, key: str) -> list[Entry]:
        """Entries of any kind with this key."""
        return [entry for entry in self if entry.key == key]

    def _unknown(self, kind: str, key: str, where: str) -> str:
        entries = self.of_kind(kind)
        prefix = f"{where}: " if where else ""
        installed = ", ".join(repr(entry.key) for entry in entries) or "none"
        message = (
            f"{prefix}unknown {kind} {key!r}; installed: {installed}{nearest(key, (entry.key for entry in entries))}"
        )
        suspects = [b for b in self.broken if nearest(key, [b.name])] or self.broken
        return message + "".join(f"; {suspect}" for suspect in suspects)

    @staticmethod
    def parameters(component: type) -> Iterable[str]:
        """Names of the fields of a component class, in order of definition."""
        return [item.name for item in fields(component)]
