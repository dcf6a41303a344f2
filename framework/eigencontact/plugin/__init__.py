"""The one package that plugins import: kinds of plugin, grids, tensors, units, `hookimpl`, `require`.

A component is a frozen, keyword-only dataclass. Its fields are its table in a scene file; its class attribute ``key``
is its name there. It validates itself in ``__post_init__`` with `require`, does no I/O (a measured surface or a mesh
excepted) and never changes the arrays it is given.
"""

from __future__ import annotations

from eigencontact.core.arrays import real_array, real_points
from eigencontact.core.grid import Grid
from eigencontact.core.jets import Jet, derivatives_of, implicit, variables
from eigencontact.core.material import Material
from eigencontact.core.quantities import Angle, DataFile, Force, Length, Moment, Stress, Unit
from eigencontact.core.tensors import COMPONENTS, SQRT2, to_mandel
from eigencontact.errors import SceneError, require
from eigencontact.halfspace.mirror import integrated_chi
from eigencontact.halfspace.potentials import (
    HasCornerPotentials,
    HasFarField,
    HasMirrorPotential,
    HasPotentials,
    Order,
    PointSources,
)
from eigencontact.hooks.hookspecs import hookimpl
from eigencontact.plugin.component import Component
from eigencontact.plugin.friction import FrictionLaw, FrictionState
from eigencontact.plugin.geometry import Geometry, HasNativeGrid, HasReferencePressure
from eigencontact.plugin.inclusion import EigenstrainField, InclusionShape
from eigencontact.plugin.layered import LayeredMedium
from eigencontact.plugin.observer import Observer, StepView
from eigencontact.plugin.surface import CornerInfluence, HasWavenumberResponse, SurfaceInfluence

__all__ = [
    "COMPONENTS",
    "KINDS",
    "SQRT2",
    "Angle",
    "Component",
    "CornerInfluence",
    "DataFile",
    "EigenstrainField",
    "Force",
    "FrictionLaw",
    "FrictionState",
    "Geometry",
    "Grid",
    "HasCornerPotentials",
    "HasFarField",
    "HasMirrorPotential",
    "HasNativeGrid",
    "HasPotentials",
    "HasReferencePressure",
    "HasWavenumberResponse",
    "InclusionShape",
    "Jet",
    "LayeredMedium",
    "Length",
    "Material",
    "Moment",
    "Observer",
    "Order",
    "PointSources",
    "SceneError",
    "StepView",
    "Stress",
    "SurfaceInfluence",
    "Unit",
    "derivatives_of",
    "hookimpl",
    "implicit",
    "integrated_chi",
    "real_array",
    "real_points",
    "require",
    "to_mandel",
    "variables",
]

#: Kinds of plugin and their abstract classes: those above that set ``kind``. A new kind is a class exported here.
KINDS: dict[str, type[Component]] = {
    item.kind: item
    for item in (globals().get(name) for name in __all__)
    if isinstance(item, type) and issubclass(item, Component) and "kind" in vars(item)
}
