"""Elements of an annotation: types, units, marks and choices."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, get_args

__all__ = ["class_within", "parts_of"]


def parts_of(hint: Any) -> Iterator[Any]:
    """Yield the annotation, its marks and, from left to right, the elements of its arguments."""
    yield hint
    yield from getattr(hint, "__metadata__", ())
    for argument in get_args(hint):
        yield from parts_of(argument)


def class_within(hint: Any, fits: Callable[[type], bool]) -> Any:
    """First suitable class in an annotation such as ``list[Step] | None``; None without one."""
    return next((candidate for candidate in parts_of(hint) if isinstance(candidate, type) and fits(candidate)), None)
