"""What every plugin class has: a key, a kind, references."""

from __future__ import annotations

from typing import ClassVar

__all__ = ["Component"]


class Component:
    """Base of every plugin class.

    Attributes
    ----------
    key : str
        Name in scene files, unique within its kind and package: no blanks, no ':'.
    kind : str
        Kind of plugin; set by the abstract class.
    references : tuple of str
        Sources to cite when a run uses this component.
    """

    key: ClassVar[str]
    kind: ClassVar[str]
    references: ClassVar[tuple[str, ...]] = ()
