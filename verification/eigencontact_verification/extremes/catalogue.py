"""Features in the order of the report: one for each module of `features`."""

from __future__ import annotations

from importlib import import_module

from eigencontact.errors import SceneError, nearest
from eigencontact_verification.extremes.feature import Feature

__all__ = ["KEYS", "chosen"]

#: Names of the modules in `features`, each with a `FEATURE`.
KEYS = (
    "poisson", "stiffness", "aspects", "depths", "loads", "friction", "scales", "grids", "precision", "layers",
    "softening", "wear", "refusals",
)  # fmt: skip


def chosen(keys: tuple[str, ...] = KEYS) -> tuple[Feature, ...]:
    """Features by their keys.

    Raises
    ------
    SceneError
        An unknown key.
    """
    for key in keys:
        if key not in KEYS:
            raise SceneError(f"--feature must be one of {', '.join(KEYS)} (got {key!r}){nearest(key, KEYS)}")
    modules = (import_module(f"eigencontact_verification.extremes.features.{key}") for key in KEYS if key in keys)
    return tuple(module.FEATURE for module in modules)
