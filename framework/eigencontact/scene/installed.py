"""The plugins of every installed package, loaded once."""

from __future__ import annotations

from functools import cache

from eigencontact.hooks.manager import load_plugins
from eigencontact.hooks.registry import Registry
from eigencontact.plugin import KINDS

__all__ = ["installed_plugins"]


@cache
def installed_plugins() -> Registry:
    """Return the registry of every installed plugin; what failed to load is in its ``broken``."""
    return load_plugins(KINDS)
