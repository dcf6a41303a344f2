"""Checks of every component: a registered key, sources, frozen fields that are its table, refusals by name."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from dataclasses import FrozenInstanceError, fields, is_dataclass, replace
from pathlib import Path
from typing import Any, get_args, get_type_hints

import numpy as np

from eigencontact.errors import SceneError
from eigencontact.hooks.registry import Entry
from eigencontact.plugin import Component
from eigencontact.scene.components import instantiate
from eigencontact.scene.installed import installed_plugins
from eigencontact_verification.conformance.report import check, ensure, fail

#: Parts of names of fields that hold lengths; those must be positive.
_LENGTHS = ("radius", "radii", "length", "edges", "semi_axes", "height", "width", "thickness")


@check
def check_registered(component: Any) -> None:
    """The class is installed under its key, so that scenes can name it."""
    registry = installed_plugins()
    components = [entry.component for entry in registry.named(component.key) if entry.kind == component.kind]
    broken = "".join(f"; {item}" for item in registry.broken)
    ensure(
        components == [type(component)],
        f"the installed {component.kind} {component.key!r}",
        f"{type(component).__module__}.{type(component).__qualname__}",
        ", ".join(f"{cls.__module__}.{cls.__qualname__}" for cls in components) or "nothing",
        "install its package (pip install -e .), with an entry point in the group 'eigencontact' and a hookimpl "
        f"that returns the class{broken}",
    )


@check
def check_references(component: Any) -> None:
    """Sources are given: results cite them."""
    sources = component.references
    good = isinstance(sources, tuple) and sources and all(isinstance(text, str) and text.strip() for text in sources)
    ensure(
        good,
        "references",
        "a tuple of texts, at least one",
        repr(sources),
        "name the paper and the equation, or say that the formula is elementary",
    )


@check
def check_frozen(component: Any) -> None:
    """Fields cannot be assigned: a component may be shared and cached."""
    ensure(is_dataclass(component), "the class", "a dataclass", type(component).__name__, "decorate it")
    for item in fields(component):
        before = getattr(component, item.name)
        try:
            setattr(component, item.name, before)
        except FrozenInstanceError:
            continue
        fail(item.name, "frozen", "assigned without an error", "use @dataclass(frozen=True, kw_only=True)")


@check
def check_fields_are_the_table(component: Any) -> None:
    """The component comes back from its fields written as a TOML table with kebab-case keys, as a scene gives them."""
    import tomli_w

    table = {
        item.name.replace("_", "-"): _plain(getattr(component, item.name))
        for item in fields(component)
        if getattr(component, item.name) is not None
    }
    read = tomllib.loads(tomli_w.dumps(table))
    entry = Entry(component.kind, component.key, type(component), "this package", "")
    again = instantiate(installed_plugins(), entry, read, component.key)
    for item in fields(component):
        before, after = getattr(component, item.name), getattr(again, item.name)
        ensure(
            _equal(before, after),
            item.name,
            f"{before!r} again when read from a scene table",
            repr(after),
            "annotate the field with what a table can hold (Length, float, tuple of those, str, bool)",
        )


@check
def check_files_are_marked(component: Any) -> None:
    """A text that is the path of a file stands in a field annotated `DataFile`: it is found and hashed by that."""
    from eigencontact.core.quantities import FileMark

    hints = get_type_hints(type(component), include_extras=True)
    for item in fields(component):
        value = getattr(component, item.name)
        if isinstance(value, str | Path) and value and Path(value).is_file():
            ensure(
                FileMark() in annotations_of(hints[item.name]),
                item.name,
                "annotated as a file",
                repr(hints[item.name]),
                f"write {item.name}: DataFile, from eigencontact.plugin",
            )


def annotations_of(hint: Any) -> list[Any]:
    """Everything that annotates a type or a part of it."""
    return [
        *getattr(hint, "__metadata__", ()),
        *(mark for argument in get_args(hint) for mark in annotations_of(argument)),
    ]


@check
def check_bad_numbers_refused(component: Any) -> None:
    """NaN and infinity in any number are refused by name (infinity may be a default, and is then allowed)."""
    for item in fields(component):
        for bad in (math.nan, math.inf):
            if item.default == bad:
                continue
            for spoilt in _spoilt(getattr(component, item.name), bad):
                _refused(component, item.name, spoilt, "finite")


@check
def check_bad_lengths_refused(component: Any) -> None:
    """Negative lengths (fields called radius, edges, semi_axes, height and the like) are refused by name.

    So is zero, unless it is the default or one of many in a map.
    """
    for item in fields(component):
        if any(word in item.name for word in _LENGTHS):
            value = getattr(component, item.name)
            size = float(np.max(np.abs(value))) or 1.0 if _is_numeric(value) else 1.0
            allowed = np.ndim(value) > 1 or item.default == 0.0
            for bad in (-size,) if allowed else (0.0, -size):
                for spoilt in _spoilt(value, bad):
                    _refused(component, item.name, spoilt, "positive")


def _refused(component: Any, field: str, value: Any, rule: str) -> None:
    advice = f"in __post_init__: require(<condition>, self.key, {field!r}, self.{field}, '{rule} [m]')"
    try:
        replace(component, **{field: value})
    except SceneError as problem:
        named = field in str(problem).replace("-", "_")
        ensure(named, f"the refusal of {field} = {value!r}", f"worded with the name {field}", str(problem), advice)
    else:
        fail(f"{field} = {value!r}", "refused with SceneError", "a component", advice)


def _is_numeric(value: Any) -> bool:
    try:
        return bool(np.asarray(value).dtype.kind == "f")
    except ValueError:
        return False


def _spoilt(value: Any, bad: float) -> Iterator[Any]:
    """Copies of a value with one number replaced: each in turn, of large arrays the first."""
    if isinstance(value, float):
        yield bad
    elif isinstance(value, np.ndarray) and value.dtype.kind == "f" and value.size:
        copy = value.copy()
        copy.flat[0] = bad
        yield copy
    elif isinstance(value, (tuple, list)):
        for index, item in enumerate(value[:4]):
            for spoilt in _spoilt(item, bad):
                yield type(value)([*value[:index], spoilt, *value[index + 1 :]])


def _plain(value: Any) -> Any:
    """Value in the types of TOML."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, (tuple, list)):
        return [_plain(value_of_list) for value_of_list in value]
    if isinstance(value, dict):
        return {key: _plain(value_of_list) for key, value_of_list in value.items()}
    if is_dataclass(value):
        columns = {item.name.replace("_", "-"): getattr(value, item.name) for item in fields(value)}
        table = {key: _plain(value_of_list) for key, value_of_list in columns.items() if value_of_list is not None}
        return {"type": value.key, **table} if isinstance(value, Component) else table
    return str(value) if isinstance(value, Path) else value


def _equal(before: Any, after: Any) -> bool:
    if isinstance(before, np.ndarray) or isinstance(after, np.ndarray):
        return np.array_equal(before, after)
    return bool(before == after)
