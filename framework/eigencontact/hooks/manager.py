"""Guarded loading of plugins: one broken plugin never stops the program."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from importlib.metadata import Distribution, EntryPoint, entry_points
from typing import Any

import pluggy

from eigencontact.errors import PluginError
from eigencontact.hooks import hookspecs
from eigencontact.hooks.guard import plugin_code, reason_of
from eigencontact.hooks.registry import BrokenPlugin, Registry

__all__ = ["add_module", "load_plugins"]


def load_plugins(
    kinds: Mapping[str, type], *, discovered: Iterable[EntryPoint] | None = None, extra: Iterable[Any] = ()
) -> Registry:
    """Fill a registry from installed packages.

    Parameters
    ----------
    kinds : mapping of str to type
        Kinds of plugin and their abstract classes.
    discovered : iterable of EntryPoint, optional
        What to load; by default every installed entry point of the group ``eigencontact``.
    extra : iterable of modules
        Further modules with hook implementations, for tests and notebooks.

    Returns
    -------
    Registry
        With what could be loaded; ``registry.broken`` says what could not, from which package and why.
    """
    registry, manager = Registry(kinds), _manager()
    points = entry_points(group=hookspecs.NAMESPACE) if discovered is None else discovered
    name_and_version = cache(_name_and_version)  # each question to a distribution reads its metadata again
    for point in sorted(points, key=lambda point: (point.name, point.value)):
        package, version = point.value, ""
        try:
            if point.dist:
                package, version = name_and_version(point.dist)
            with plugin_code(reason_of, passing=()):
                add_module(registry, point.load(), package, version, manager)
        except PluginError as problem:
            registry.broken.append(BrokenPlugin(point.name, f"{package} {version}".strip(), str(problem)))
    for module in extra:
        add_module(registry, module, module.__name__, getattr(module, "__version__", ""), manager)
    return registry


def _manager() -> pluggy.PluginManager:
    manager = pluggy.PluginManager(hookspecs.NAMESPACE)
    manager.add_hookspecs(hookspecs)
    return manager


def add_module(
    registry: Registry, module: Any, package: str, version: str, manager: pluggy.PluginManager | None = None
) -> None:
    """Validate one module against the hook specifications, then register all its classes or none.

    Raises
    ------
    PluginError, or an exception of the hook
        Reason of the refusal.
    """
    manager = manager or _manager()
    if manager.is_registered(module):  # named by two entry points
        return
    manager.register(module)
    try:
        manager.check_pending()
        classes = _classes(manager, module)
        trial = registry.copy()
        for register_in in (trial, registry):
            for component in classes:
                register_in.add(component, package=package, version=version)
    except BaseException:
        manager.unregister(module)
        raise


def _classes(manager: pluggy.PluginManager, module: Any) -> list[type]:
    """Classes that the hook of a module returns."""
    classes = [
        component
        for implementation in getattr(manager.hook, hookspecs.HOOK).get_hookimpls()
        if implementation.plugin is module
        for component in implementation.function()
    ]
    if not classes:
        raise PluginError(f"it registers nothing: implement {hookspecs.HOOK} and return its classes")
    return classes


def _name_and_version(dist: Distribution) -> tuple[str, str]:
    """Name and version of an installed package."""
    metadata = dist.metadata
    return metadata["Name"], metadata["Version"]
