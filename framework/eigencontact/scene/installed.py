"""Registry of the plugins of all installed packages, loaded once, and of single files."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from pathlib import Path

from eigencontact.hooks.files import with_files
from eigencontact.hooks.manager import load_plugins
from eigencontact.hooks.registry import Registry
from eigencontact.plugin import KINDS

__all__ = ["add_plugin_files", "installed_plugins"]


@cache
def installed_plugins() -> Registry:
    """Return the registry of all installed plugins; plugins that failed to load are in its ``broken``."""
    return load_plugins(KINDS)


def add_plugin_files(files: Iterable[str | Path]) -> None:
    """Register the plugins of files in this process as installed, for commands without a scene.

    Raises
    ------
    PluginError
        See `eigencontact.hooks.files.with_files`; then none is added.
    """
    registry = installed_plugins()
    registry.take(with_files(registry, map(Path, files)))
