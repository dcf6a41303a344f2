"""Guard of plugin code: every exception becomes one error that names the plugin.

It stands where plugin code is entered: round each import, each call of a hook, and each public method of a plugin class
(`guard_methods`, which the base class of all plugins calls).
"""

from __future__ import annotations

import inspect
import os
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cached_property, wraps
from pathlib import Path
from types import FunctionType
from typing import Any

from eigencontact.errors import EigencontactError, PluginError

__all__ = ["guard_methods", "plugin_code", "reason_of"]

#: Packages whose classes are bases of plugins and no plugins.
_BASES = ("eigencontact", "builtins", "abc", "typing")
_MARK = "_eigencontact_guarded"
#: Whether the thread is inside the code of a plugin: a plugin that calls another is one place to come back to.
_NESTED = threading.local()


@contextmanager
def plugin_code(
    message: Callable[[BaseException], str], *, passing: tuple[type[EigencontactError], ...] = (EigencontactError,)
) -> Iterator[None]:
    """Run code of a plugin: its exceptions become `PluginError`, and the working directory does not change.

    KeyboardInterrupt passes, because it comes from the user. SystemExit does not: a plugin must not end a run with exit
    code 0 and no results.

    Parameters
    ----------
    message : callable
        Text of the error, given the exception.
    passing : tuple of types
        Errors that pass as they are.

    Examples
    --------
    >>> with plugin_code(lambda problem: f"plugin 'torus' failed with {reason_of(problem)}"):
    ...     raise SystemExit(0)
    Traceback (most recent call last):
    eigencontact.errors.PluginError: plugin 'torus' failed with SystemExit: 0
    """
    outermost, _NESTED.inside = not getattr(_NESTED, "inside", False), True
    folder = _working_directory() if outermost else None  # asking takes longer than a small call
    try:
        yield
    except BaseException as problem:
        if isinstance(problem, (*passing, KeyboardInterrupt)):
            raise
        raise PluginError(message(problem)) from problem
    finally:
        _NESTED.inside = not outermost
        if folder is not None and _working_directory() != folder:
            with suppress(OSError):
                os.chdir(folder)


def reason_of(problem: BaseException) -> str:
    """Type and message of an exception in one line."""
    text = "; ".join(line.strip() for line in str(problem).splitlines() if line.strip())
    return f"{type(problem).__name__}: {text or '(no message)'}"


def guard_methods(cls: type) -> None:
    """Let the public methods and properties of a plugin class run as `plugin_code`.

    Methods of a base class that is no plugin, a mixin of the author, count too.
    """
    bases = [base for base in cls.__mro__ if base.__module__.partition(".")[0] not in _BASES]
    for name in dict.fromkeys(name for base in bases for name in vars(base) if not name.startswith("_")):
        value = inspect.getattr_static(cls, name)
        if isinstance(value, FunctionType):
            setattr(cls, name, _guarded(cls, value))
        elif isinstance(value, classmethod | staticmethod):
            setattr(cls, name, type(value)(_guarded(cls, value.__func__)))
        elif isinstance(value, property) and value.fget is not None:
            setattr(cls, name, value.getter(_guarded(cls, value.fget)))
        elif isinstance(value, cached_property):
            value.func = _guarded(cls, value.func)


def _guarded(cls: Any, function: Any) -> Any:
    """Return a function of a class with the guard, once."""
    if hasattr(function, _MARK):
        return function
    import numpy as np  # the command line imports this module for its help

    @wraps(function)
    def call(*arguments: Any, **keywords: Any) -> Any:
        owner = next(item for item in (*arguments[:1], cls) if hasattr(item, "kind"))
        with plugin_code(lambda problem: _failure(owner, function, problem)):
            result = function(*arguments, **keywords)
        if np.ma.is_masked(result):  # NumPy would use the values under the mask
            raise PluginError(f"{_name_of(owner, function)} must return no masked values (got {result.mask.sum()})")
        return result

    setattr(call, _MARK, True)
    return call


def _failure(owner: Any, function: Any, problem: BaseException) -> str:
    """Words for an exception in a method, with the line of the file of the method."""
    file = getattr(getattr(function, "__code__", None), "co_filename", "")
    lines = [frame.lineno for frame in traceback.extract_tb(problem.__traceback__) if frame.filename == file]
    place = f", line {lines[-1]} of {Path(file).name}" if lines else ""
    return f"{_name_of(owner, function)} must return without an exception (got {reason_of(problem)}{place})"


def _name_of(owner: Any, function: Any) -> str:
    name = getattr(function, "__name__", "a method")
    return f"{name} of {owner.kind.replace('-', ' ')} {getattr(owner, 'key', '')!r}"


def _working_directory() -> str | None:
    try:
        return os.getcwd()  # noqa: PTH109 - asked at each call, and a Path costs ten times as much
    except OSError:  # it was removed
        return None
