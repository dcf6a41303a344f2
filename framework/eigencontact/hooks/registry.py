"""Registry of the installed component classes, their packages, and plugins that failed to load."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from functools import lru_cache
from typing import Any, get_type_hints

from eigencontact.errors import PluginError, nearest

__all__ = ["BUNDLED", "OF_FILE", "BrokenPlugin", "Entry", "Registry", "annotations_of"]

#: The package whose plugins keep their plain keys, whatever else is installed.
BUNDLED = "eigencontact"
#: What the version of a single file begins with: a hash of its text follows.
OF_FILE = "sha256:"


@lru_cache(maxsize=1024)
def annotations_of(component: type) -> dict[str, Any]:
    """Annotations of a class, evaluated once: registries are filled, and scenes read, again and again."""
    return get_type_hints(component, include_extras=True)


@dataclass(frozen=True, slots=True)
class Entry:
    """Registered class and its package."""

    kind: str
    key: str
    component: type
    package: str
    version: str

    @property
    def origin(self) -> str:
        """Package and version, for messages and provenance."""
        return f"{self.package} {self.version}".strip()

    @property
    def full_key(self) -> str:
        """Key with the name of the package, unique among installed packages."""
        return f"{self.package}:{self.key}"

    @property
    def bundled(self) -> bool:
        """Whether this project provides the plugin; bundled plugins keep their plain keys."""
        return _normal(self.package) == BUNDLED

    @property
    def of_file(self) -> bool:
        """Whether the plugin comes from a single file; see `eigencontact.hooks.files`."""
        return self.version.startswith(OF_FILE)


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

    A key is unique within its kind and package. Where packages share one, all of them stay installed: the plain key
    means the bundled plugin, so that no package can change or break a scene that ran without it; among other packages
    it is refused. ``package:key`` names any of them.

    Parameters
    ----------
    kinds : mapping of str to type
        Name of each kind of plugin and the abstract class its members derive from.
    """

    kinds: Mapping[str, type]
    broken: list[BrokenPlugin] = field(default_factory=list)
    _entries: dict[tuple[str, str, str], Entry] = field(default_factory=dict)

    def add(self, component: type, *, package: str, version: str) -> None:
        """Register one class, or raise `PluginError` with the reason."""
        name = getattr(component, "__qualname__", repr(component))
        kind = getattr(component, "kind", None)
        base = self.kinds.get(kind) if isinstance(kind, str) else None
        if base is None or not (inspect.isclass(component) and issubclass(component, base)):
            bases = ", ".join(sorted(cls.__name__ for cls in self.kinds.values()))
            raise PluginError(f"{name} must be a subclass of one of {bases}")
        if inspect.isabstract(component):
            missing = ", ".join(sorted(getattr(component, "__abstractmethods__", ())))
            raise PluginError(f"{name} must implement {missing}")
        if not is_dataclass(component) or not component.__dataclass_params__.frozen:  # type: ignore[attr-defined]
            raise PluginError(f"{name} must be a frozen dataclass: its fields are its scene table")
        key = getattr(component, "key", None)
        if not (isinstance(key, str) and re.fullmatch(r"[^\s:]+", key)):
            raise PluginError(f"{name}.key must be a non-empty text without blanks and ':' (got {key!r})")
        try:
            annotations_of(component)
        except Exception as problem:
            raise PluginError(
                f"annotations of {name} must be known when it runs (got {type(problem).__name__}: {problem}); "
                "import what they name outside TYPE_CHECKING"
            ) from problem
        place = str(kind), key, _normal(package)
        registered = self._entries.get(place)
        if registered is not None and registered.component is not component:
            raise PluginError(f"{kind} {key!r} is already registered by {registered.origin}; choose another key")
        self._entries[place] = Entry(str(kind), key, component, package, version)

    def copy(self) -> Registry:
        """Return a registry with the same entries, to try an addition on."""
        return Registry(self.kinds, list(self.broken), dict(self._entries))

    def take(self, registry: Registry) -> None:
        """Replace the entries by those of another registry."""
        self._entries = dict(registry._entries)

    def __iter__(self) -> Iterator[Entry]:
        return iter(sorted(self._entries.values(), key=lambda entry: (entry.kind, entry.key, entry.package)))

    def of_kind(self, kind: str) -> list[Entry]:
        """Entries of one kind, sorted by key."""
        return [entry for entry in self if entry.kind == kind]

    def get(self, kind: str, key: str, *, where: str = "") -> Entry:
        """Return the entry of `kind` that a scene names by `key`: ``"key"`` or ``"package:key"``.

        Raises
        ------
        PluginError
            Names what is installed, the nearest key, and any broken plugin that may have been meant; or the packages
            that share a key.
        """
        entries = [entry for entry in self.named(key) if entry.kind == kind]
        entries = [entry for entry in entries if entry.bundled] or entries
        prefix = f"{where}: " if where else ""
        if len(entries) > 1:
            owners = " and ".join(entry.origin for entry in entries)
            choices = " or ".join(repr(entry.full_key) for entry in entries)
            raise PluginError(f"{prefix}{kind} {key!r} must be of one package (got {owners}); say {choices}")
        if not entries:
            raise PluginError(f"{prefix}{self.unknown(key, kind)}")
        return entries[0]

    def named(self, key: str) -> list[Entry]:
        """Entries of any kind and package with this key; of one package for ``package:key``."""
        package, _, plain = key.rpartition(":")
        owner = _normal(package)
        return [entry for entry in self if entry.key == plain and (not package or _normal(entry.package) == owner)]

    def entry_of(self, component: Any) -> Entry:
        """Entry of the class of a component; by its key if an instance replaces an installed class.

        Raises
        ------
        PluginError
            Neither is installed.
        """
        entries = [entry for entry in self if entry.component is type(component)]
        return entries[0] if entries else self.get(component.kind, component.key)

    def spelling(self, entry: Entry) -> str:
        """Value of ``type`` in a scene: the plain key if it is unambiguous, else ``package:key``."""
        rivals = [candidate for candidate in self.named(entry.key) if candidate.kind == entry.kind]
        return entry.key if len(rivals) == 1 or entry.bundled else entry.full_key

    def unknown(self, key: str, kind: str | None = None) -> str:
        """Message of a refusal: installed keys, the nearest key, and broken plugins of a similar name."""
        entries = list(self) if kind is None else self.of_kind(kind)
        names = sorted({self.spelling(entry) for entry in entries})
        message = f"unknown {kind or 'plugin'} {key!r}; installed: {', '.join(map(repr, names)) or 'none'}"
        suspects = [b for b in self.broken if nearest(key, [b.name])] or self.broken
        hints = nearest(key, names) + "".join(f"; {suspect}" for suspect in suspects)
        return message + (hints or '; one of your own: name its file in the scene, plugins = ["my.py"]')

    @staticmethod
    def parameters(component: type) -> Iterable[str]:
        """Names of the fields of a component class, in order of definition."""
        return [item.name for item in fields(component)]


def _normal(package: str) -> str:
    """Normalised name of a package; case and kind of hyphen do not matter."""
    return re.sub(r"[-_.]+", "-", package).lower()
