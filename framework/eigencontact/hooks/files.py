"""Plugins in single files of a scene or command, with the same hook as packages."""

from __future__ import annotations

import hashlib
import linecache
import re
import sys
import traceback
from collections.abc import Iterable, Mapping
from functools import lru_cache, partial
from pathlib import Path
from types import ModuleType

from eigencontact.errors import PluginError, nearest
from eigencontact.hooks.guard import plugin_code
from eigencontact.hooks.manager import add_module
from eigencontact.hooks.registry import OF_FILE, Registry

__all__ = ["hold_texts", "texts_of", "with_files"]

#: Digits of the hash by which results name the text of a file.
_DIGITS = 16
#: Texts of files of another machine, by path; they stand for what lies there on this one.
_SENT: dict[str, str] = {}


def texts_of(files: Iterable[Path]) -> dict[str, str]:
    """Texts of plugin files by absolute path, each once, for a process without access to them (`hold_texts`).

    Raises
    ------
    PluginError
        A file that is missing or is no text.
    """
    return {str(path): _text(path) for path in dict.fromkeys(map(_resolved, files))}


def hold_texts(texts: Mapping[str, str]) -> None:
    """Replace plugin files by texts of `texts_of` in a worker from now on, by path."""
    _SENT.clear()
    _SENT.update(texts)


def with_files(registry: Registry, files: Iterable[Path]) -> Registry:
    """Return the registry with the plugins of files added; the original does not change.

    A file stands for a package: its name is the package's, ``sha256:`` and the beginning of the hash of its text the
    version. The same text at the same place is the same module, so that its classes stay the same; another text is
    another one.

    Parameters
    ----------
    registry : Registry
        What is installed.
    files : iterable of Path
        Python files, each with a hook implementation as the module of a package has.

    Raises
    ------
    PluginError
        A file that is missing, cannot be run, registers nothing or what is refused, or registers a bundled key, which
        would be another class in scenes without the file.
    """
    out = registry
    for path in files:
        module, version = _module(path)
        out = out.copy() if out is registry else out
        with plugin_code(partial(_broken, path), passing=()):
            add_module(out, module, path.name, version)
        for entry in out:
            if entry.component.__module__ == module.__name__:
                _refuse_bundled(out, path, entry.kind, entry.key)
    return out


def _refuse_bundled(registry: Registry, path: Path, kind: str, key: str) -> None:
    if any(entry.bundled and entry.kind == kind for entry in registry.named(key)):
        raise PluginError(f"plugin file {path.name} must register keys of its own (got {kind} {key!r}, a bundled one)")


def _module(path: Path) -> tuple[ModuleType, str]:
    """Module of a file, and the version from the hash of its text."""
    text = _text(path)
    return _run(_resolved(path), text), f"{OF_FILE}{hashlib.sha256(text.encode()).hexdigest()[:_DIGITS]}"


def _text(path: Path) -> str:
    if (sent := _SENT.get(str(_resolved(path)))) is not None:
        return sent
    if path.suffix != ".py" or not path.is_file():
        neighbours = [item.name for item in path.parent.glob("*.py")] if path.parent.is_dir() else []
        reason = "no Python file" if path.exists() else "no such file"
        raise PluginError(
            f"plugin file must be a Python file (got {str(path)!r}, {reason}){nearest(path.name, neighbours)}"
        )
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, ValueError) as problem:
        raise PluginError(f"plugin file must be readable text (got {str(path)!r}): {problem}") from None


def _resolved(path: Path) -> Path:
    try:
        return path.resolve()
    except (OSError, RuntimeError) as problem:  # RuntimeError: before Python 3.13, of a link to itself
        raise PluginError(f"plugin file must be a Python file (got {str(path)!r}, {problem})") from None


@lru_cache(maxsize=64)
def _run(path: Path, text: str) -> ModuleType:
    """Execute a text as a module, without bytecode files and without imports from its folder."""
    digest = hashlib.sha256(f"{path}\n{text}".encode()).hexdigest()[:_DIGITS]
    module = ModuleType(f"eigencontact_file_{re.sub(r'[^A-Za-z0-9_]', '_', path.stem)}_{digest}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module  # dataclasses and annotations look their module up
    linecache.checkcache(str(path))
    try:
        with plugin_code(partial(_broken, path), passing=()):
            exec(compile(text, str(path), "exec"), module.__dict__)  # noqa: S102 - this is what a plugin file is for
    except BaseException:
        del sys.modules[module.__name__]
        raise
    return module


def _broken(path: Path, problem: BaseException) -> str:
    """Fault of a file as text, with its line."""
    lines = [frame.lineno for frame in traceback.extract_tb(problem.__traceback__) if frame.filename == str(path)]
    line = problem.lineno if isinstance(problem, SyntaxError) else lines[-1] if lines else None
    message = " ".join((problem.msg if isinstance(problem, SyntaxError) else str(problem)).split())
    where = "" if line is None else f", line {line}"
    kind = "" if isinstance(problem, PluginError) else f"{type(problem).__name__}: "
    hint = ""
    if isinstance(problem, ModuleNotFoundError) and (path.parent / f"{problem.name}.py").is_file():
        hint = "; a plugin file stands alone: several files make a package, see `eigencontact new-plugin`"
    return f"plugin file {path.name}{where} is broken: {kind}{message or '(no message)'}{hint}"
