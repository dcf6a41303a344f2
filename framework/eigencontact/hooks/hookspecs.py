"""What a plugin package implements: one hook, called once per process, when the registry is filled.

Order never matters: the registry sorts by key. The hook returns classes, not instances.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from types import ModuleType
from typing import TYPE_CHECKING

import pluggy

if TYPE_CHECKING:
    from eigencontact.plugin import Component

__all__ = ["HOOK", "NAMESPACE", "OLD_HOOKS", "hookimpl", "specifications"]

#: Name of the pluggy project and of the entry-point group.
NAMESPACE = "eigencontact"
#: The one hook.
HOOK = "eigencontact_register"
#: Names of hooks up to version 0.1, one for each kind. They do what `HOOK` does, and go with version 0.3.
OLD_HOOKS = tuple(
    f"{HOOK}_{kinds}"
    for kinds in (
        "eigenstrain_fields",
        "friction_laws",
        "geometries",
        "inclusion_shapes",
        "layered_media",
        "observers",
        "surface_influences",
    )
)

hookspec = pluggy.HookspecMarker(NAMESPACE)
hookimpl = pluggy.HookimplMarker(NAMESPACE)


def eigencontact_register() -> Iterable[type[Component]]:  # type: ignore[empty-body]
    """Return the plugin classes of this module, of any kind: each class knows its ``kind`` from its abstract class."""


def specifications() -> ModuleType:
    """Specifications for pluggy: the hook, and its old names, which are one and the same."""
    module = ModuleType(__name__)
    vars(module).update({name: hookspec(_renamed(name)) for name in (HOOK, *OLD_HOOKS)})
    return module


def _renamed(name: str) -> Callable[[], Iterable[type[Component]]]:
    def register() -> Iterable[type[Component]]:
        return eigencontact_register()

    register.__name__ = name
    return register
