"""Versions of installed packages that must be equal on every worker: this package and packages of plugins."""

from __future__ import annotations

from importlib.metadata import entry_points

from eigencontact import __version__

__all__ = ["OURS", "unlike", "versions"]

#: Name of this package, and of the entry points by which others offer plugins.
OURS = "eigencontact"


def versions() -> dict[str, str]:
    """Versions by name of package: this one, and all that offer plugins."""
    offered = {point.dist.name: point.dist.version for point in entry_points(group=OURS) if point.dist is not None}
    return {**dict(sorted(offered.items())), OURS: __version__}


def unlike(reference: dict[str, str], packages: dict[str, str]) -> str:
    """Description of the packages of a worker that differ from the `reference`; empty without a difference.

    Examples
    --------
    >>> unlike({"eigencontact": "0.1.0", "bowls": "2.0"}, {"eigencontact": "0.1.0"})
    'must have bowls 2.0 (got none); install it'
    """
    differing = [name for name in (OURS, *reference) if reference[name] != packages.get(name)]
    if not differing:
        return ""
    names = list(dict.fromkeys(differing))
    versions_found = ", ".join(packages.get(name) or "none" for name in names)
    return f"must have {', '.join(f'{name} {reference[name]}' for name in names)} (got {versions_found}); install it"
