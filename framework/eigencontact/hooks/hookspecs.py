"""What a plugin package may implement. Each hook is called once per process, when the registry is filled.

Order never matters: the registry sorts by key. A hook returns classes, not instances.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import pluggy

if TYPE_CHECKING:
    from eigencontact.plugin import (
        ConstitutiveLaw,
        EigenstrainField,
        FrictionLaw,
        Geometry,
        InclusionShape,
        LayeredMedium,
        Observer,
        SurfaceInfluence,
    )

__all__ = ["NAMESPACE", "REGISTER_HOOKS", "hookimpl"]

#: Name of the pluggy project and of the entry-point group.
NAMESPACE = "eigencontact"

hookspec = pluggy.HookspecMarker(NAMESPACE)
hookimpl = pluggy.HookimplMarker(NAMESPACE)

#: kind of plugin -> name of the hook that registers it
REGISTER_HOOKS = {
    "surface-influence": "eigencontact_register_surface_influences",
    "geometry": "eigencontact_register_geometries",
    "observer": "eigencontact_register_observers",
    "inclusion-shape": "eigencontact_register_inclusion_shapes",
    "eigenstrain-field": "eigencontact_register_eigenstrain_fields",
    "friction-law": "eigencontact_register_friction_laws",
    "layered-medium": "eigencontact_register_layered_media",
    "constitutive-law": "eigencontact_register_constitutive_laws",
}


@hookspec
def eigencontact_register_surface_influences() -> Iterable[type[SurfaceInfluence]]:  # type: ignore[empty-body]
    """Return the classes of surface influence (field of a uniformly loaded rectangle) of this package."""


@hookspec
def eigencontact_register_geometries() -> Iterable[type[Geometry]]:  # type: ignore[empty-body]
    """Return the classes of geometry (initial separation) of this package."""


@hookspec
def eigencontact_register_observers() -> Iterable[type[Observer]]:  # type: ignore[empty-body]
    """Return the classes of observer (sees every accepted step) of this package."""


@hookspec
def eigencontact_register_inclusion_shapes() -> Iterable[type[InclusionShape]]:  # type: ignore[empty-body]
    """Return the classes of inclusion shape (a region that may carry an eigenstrain) of this package."""


@hookspec
def eigencontact_register_eigenstrain_fields() -> Iterable[type[EigenstrainField]]:  # type: ignore[empty-body]
    """Return the classes of eigenstrain field (stress-free strain as a function of place and time) of this package."""


@hookspec
def eigencontact_register_friction_laws() -> Iterable[type[FrictionLaw]]:  # type: ignore[empty-body]
    """Return the classes of friction law (largest shear traction of each point in contact) of this package."""


@hookspec
def eigencontact_register_layered_media() -> Iterable[type[LayeredMedium]]:  # type: ignore[empty-body]
    """Return the classes of layered medium (constants depend on depth; response to tractions) of this package."""


@hookspec
def eigencontact_register_constitutive_laws() -> Iterable[type[ConstitutiveLaw]]:  # type: ignore[empty-body]
    """Return the classes of constitutive law (stress of a strain, and what a point remembers) of this package."""
