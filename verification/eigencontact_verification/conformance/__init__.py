"""Conformance kit: what every plugin of a kind promises, as checks that an author runs on a class of their own.

Examples
--------
>>> import eigencontact
>>> from eigencontact_verification.conformance import checks_for
>>> shape = eigencontact.make("cuboid", center=(0.0, 0.0, 2.0), edges=(1.0, 2.0, 3.0))
>>> sum(1 for check in checks_for(shape) if check(shape) is None) > 20
True
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from eigencontact_verification.conformance.kit import checks_for, parametrize_with_checks
    from eigencontact_verification.conformance.report import ConformanceError

__all__ = ["ConformanceError", "checks_for", "parametrize_with_checks"]

_FROM = {"ConformanceError": "report", "checks_for": "kit", "parametrize_with_checks": "kit"}


def __getattr__(name: str) -> Any:
    """Load the kit when it is asked for: the command `check` is in this package, and help and completion load it."""
    if name not in _FROM:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_FROM[name]}"), name)
