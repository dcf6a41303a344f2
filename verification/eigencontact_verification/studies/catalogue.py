"""All studies, by name; a module is imported when one of its studies is asked for."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from eigencontact.errors import SceneError, nearest

if TYPE_CHECKING:
    from eigencontact_verification.studies.study import Study

__all__ = ["find", "names", "studies"]

_MODULES = (
    "rolling",
    "clusters",
    "single_sphere",
    "two_spheres",
    "coatings",
    "coating_thickness",
    "coating_sliding",
    "coating_friction",
    "plastic_friction",
    "plastic_fretting",
    "plastic_cells",
    "bone",
    "damage_mesh",
    "wear_sliding",
    "wear_fretting",
)


def studies() -> tuple[Study, ...]:
    """All of them, in the order of the catalogue."""
    return tuple(
        study for name in _MODULES for study in import_module(f"eigencontact_verification.studies.{name}").STUDIES
    )


def names() -> tuple[str, ...]:
    """Their names."""
    return tuple(study.name for study in studies())


def find(name: str) -> Study:
    """Study of a name.

    Raises
    ------
    SceneError
        With the nearest name.
    """
    for study in studies():
        if study.name == name:
            return study
    raise SceneError(f"study must be one of {', '.join(names())} (got {name!r}){nearest(name, names())}")
