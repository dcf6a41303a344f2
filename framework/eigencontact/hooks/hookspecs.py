"""Hook of a plugin package, called once per process when the registry is filled.

Order never matters: the registry sorts by key. The hook returns classes, not instances.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import pluggy

if TYPE_CHECKING:
    from eigencontact.plugin import Component

__all__ = ["HOOK", "NAMESPACE", "eigencontact_register", "hook_for", "hookimpl"]

#: Name of the pluggy project and of the entry-point group.
NAMESPACE = "eigencontact"
#: The one hook.
HOOK = "eigencontact_register"

hookspec = pluggy.HookspecMarker(NAMESPACE)
hookimpl = pluggy.HookimplMarker(NAMESPACE)


def hook_for(*components: type[Component]) -> Callable[[], list[type[Component]]]:
    """Hook of a module that registers these classes.

    Examples
    --------
    >>> from eigencontact.plugin import Geometry
    >>> eigencontact_register = hook_for(Geometry)
    >>> eigencontact_register()[0].kind
    'geometry'
    """
    return hookimpl(lambda: list(components))


@hookspec
def eigencontact_register() -> Iterable[type[Component]]:  # type: ignore[empty-body]
    """Return the plugin classes of this module, of any kinds; the abstract class of each defines its ``kind``."""
