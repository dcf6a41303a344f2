"""Finished finite-element solutions in a folder, found again by a hash of all that decides them."""

from __future__ import annotations

import contextlib
import hashlib
import inspect
import json
import os
from functools import lru_cache
from importlib import import_module
from importlib.metadata import PackageNotFoundError, distributions, version
from pathlib import Path
from typing import Any

import numpy as np

from eigencontact_verification import fem
from eigencontact_verification.crosscheck.case import Case, Fields, Level, Outer

__all__ = ["Store", "content_hash", "fem_digest"]

_LIBRARIES = ("numpy", "scipy", "scikit-fem", "pyamg")
#: Files of ``fem`` that only read finished solutions.
_READERS = ("uncertainty.py",)


@lru_cache(maxsize=1)
def fem_digest() -> str:
    """Digest of the text of the finite-element code and of the versions of what it stands on."""
    digest = hashlib.sha256()
    for folder in fem.__path__:
        for file in sorted(Path(folder).rglob("*.py")):
            if file.name not in _READERS:
                digest.update(file.name.encode() + b"\0" + file.read_bytes())
    for name in _LIBRARIES:
        try:
            digest.update(f"{name} {version(name)}\n".encode())
        except PackageNotFoundError:
            digest.update(f"{name} absent\n".encode())
    return digest.hexdigest()


@lru_cache(maxsize=1)
def _plugin_versions() -> list[str]:
    """Packages that register plugins: a shape's own `contains` decides the mesh."""
    return sorted(
        {
            f"{package.name} {package.version}"
            for package in distributions()
            if any(point.group == "eigencontact" for point in package.entry_points)
        }
    )


@lru_cache(maxsize=64)
def _class_digest(kind: type[Case]) -> str:
    """Digest of the text of the code that a class names, or of itself and its bases."""
    digest = hashlib.sha256()
    for base in () if kind.code else kind.__mro__:
        if issubclass(base, Case) and base is not Case:
            with contextlib.suppress(OSError, TypeError):  # a class made at a prompt has no file
                digest.update(inspect.getsource(base).encode())
    for name in kind.code:
        module, _, path = name.partition(":")
        component: Any = import_module(module)
        for attribute in path.split(".") if path else ():
            component = inspect.getattr_static(component, attribute)
        component = component.fget if isinstance(component, property) else component
        digest.update(inspect.getsource(component).encode())
    return digest.hexdigest()


def content_hash(case: Case, level: Level, outer: Outer) -> str:
    """Hash of everything that decides ``case.reference(level, outer)``; its name is no part of that.

    Raises
    ------
    ValueError
        The parameters cannot be written as JSON.
    """
    try:
        parameters = json.dumps(case.parameters, sort_keys=True, allow_nan=True)
    except TypeError as problem:
        raise ValueError(f"case '{case.key}' parameters must be JSON ({problem}); use numbers, text, lists") from None
    digest = hashlib.sha256(parameters.encode())
    kind = type(case)
    for text in (kind.__module__, kind.__qualname__, _class_digest(kind), fem_digest(), *_plugin_versions()):
        digest.update(text.encode() + b"\0")
    digest.update(f"{case.subject} {case.ratio!r} {level} {outer}".encode())
    for profile in case.profiles:
        digest.update(f"{profile.name}\0{profile.quantity}\0{profile.components}".encode())
        digest.update(np.ascontiguousarray(profile.points).tobytes())
    return digest.hexdigest()


class Store:
    """Folder of finished solutions, one JSON file each; files that cannot be read count as absent.

    Parameters
    ----------
    folder : Path
        Made when the first solution is written.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def _file(self, key: str) -> Path:
        return self.folder / key[:2] / f"{key}.json"

    def read(self, key: str) -> tuple[Fields, dict[str, Any]] | None:
        """Fields and facts (seconds, memory) of a solution, or None."""
        try:
            data = json.loads(self._file(key).read_text(encoding="utf-8"))
            fields = {name: np.asarray(values, dtype=float) for name, values in data["fields"].items()}
            return fields, dict(data["facts"])
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return None

    def write(self, key: str, fields: Fields, facts: dict[str, Any]) -> None:
        """Keep a solution; an interruption leaves either the whole file or none."""
        file = self._file(key)
        file.parent.mkdir(parents=True, exist_ok=True)
        data = {"facts": facts, "fields": {name: values.tolist() for name, values in fields.items()}}
        partial = file.with_suffix(f".{os.getpid()}.partial")
        partial.write_text(json.dumps(data), encoding="utf-8")
        partial.replace(file)
