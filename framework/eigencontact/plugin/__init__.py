"""Interface for plugins, their only import: kinds of plugin, grids, tensors, units, `hook_for`, `require`.

A component is a frozen, keyword-only dataclass. Its fields are its table in a scene file; its class attribute ``key``
is its name there. It validates itself in ``__post_init__`` with `require`, does no I/O (a measured surface or a mesh
excepted) and never changes the arrays it is given.
"""

from __future__ import annotations

from eigencontact.core.arrays import FloatArray, real_array, real_points
from eigencontact.core.elasticity import (
    checked_stiffness,
    factors_of_compliance,
    factors_of_stiffness,
    frame_of,
    isotropic_factors,
    isotropic_stiffness,
    mandel_rotation,
    unit_vector,
)
from eigencontact.core.grid import Grid
from eigencontact.core.gridded import TEXT_FILES, FileArrays, GriddedData, read_arrays, read_columns, read_gridded
from eigencontact.core.jets import Jet, derivatives_of, implicit, variables
from eigencontact.core.material import Material
from eigencontact.core.paths import PathBounds, PlanePaths, smallest_balls, worst_planes
from eigencontact.core.quantities import (
    Angle,
    DataFile,
    Direction,
    Force,
    Length,
    Lengths,
    Moment,
    Place,
    Stress,
    Unit,
    unit_of,
)
from eigencontact.core.rotation import Rotation, Row, as_tuple, rotation_matrix, turned_derivatives
from eigencontact.core.tensors import COMPONENTS, SQRT2, to_mandel
from eigencontact.core.units import readable
from eigencontact.errors import NotConverged, NotUnique, SceneError, require
from eigencontact.halfspace.mirror import integrated_chi
from eigencontact.halfspace.point_kernels import PointKernels
from eigencontact.halfspace.potentials import (
    HasCornerPotentials,
    HasFarField,
    HasMirrorPotential,
    HasMomentIntegrals,
    HasMomentPotentials,
    HasMomentSums,
    HasPotentials,
    HasSidedPotentials,
    HasVolumeFractions,
    Order,
    PointSources,
)
from eigencontact.hooks.hookspecs import hook_for, hookimpl
from eigencontact.plugin.component import Component
from eigencontact.plugin.constitutive import (
    ConstitutiveLaw,
    HasCellAnswer,
    LawStep,
    LinearLaw,
    Response,
    Surroundings,
    Variable,
)
from eigencontact.plugin.damage import DamageLaw, PlasticDamage, StrainDamage
from eigencontact.plugin.fatigue import DamageParameter, FatigueCriterion, HasKnownValues, HasUpperBound, StressCycle
from eigencontact.plugin.friction import FrictionLaw, FrictionState
from eigencontact.plugin.geometry import Geometry, HasNativeGrid, HasReferencePressure
from eigencontact.plugin.hardening import HardeningLaw, IsotropicHardening, KinematicHardening
from eigencontact.plugin.inclusion import EigenstrainField, InclusionShape
from eigencontact.plugin.layered import HasResponseAtDepths, LayeredMedium, Thinning
from eigencontact.plugin.materials import NamesMaterials, by_material
from eigencontact.plugin.observer import Observer, RegionView, RememberedView, StepView
from eigencontact.plugin.revolution import Revolution
from eigencontact.plugin.surface import CornerInfluence, HasWavenumberResponse, SurfaceInfluence
from eigencontact.plugin.timed_field import Strain, TimedField, mandel_strain
from eigencontact.plugin.wear import WearLaw, WearState

__all__ = [
    "COMPONENTS",
    "KINDS",
    "SQRT2",
    "TEXT_FILES",
    "Angle",
    "Component",
    "ConstitutiveLaw",
    "CornerInfluence",
    "DamageLaw",
    "DamageParameter",
    "DataFile",
    "Direction",
    "EigenstrainField",
    "FatigueCriterion",
    "FileArrays",
    "FloatArray",
    "Force",
    "FrictionLaw",
    "FrictionState",
    "Geometry",
    "Grid",
    "GriddedData",
    "HardeningLaw",
    "HasCellAnswer",
    "HasCornerPotentials",
    "HasFarField",
    "HasKnownValues",
    "HasMirrorPotential",
    "HasMomentIntegrals",
    "HasMomentPotentials",
    "HasMomentSums",
    "HasNativeGrid",
    "HasPotentials",
    "HasReferencePressure",
    "HasResponseAtDepths",
    "HasSidedPotentials",
    "HasUpperBound",
    "HasVolumeFractions",
    "HasWavenumberResponse",
    "InclusionShape",
    "IsotropicHardening",
    "Jet",
    "KinematicHardening",
    "LawStep",
    "LayeredMedium",
    "Length",
    "Lengths",
    "LinearLaw",
    "Material",
    "Moment",
    "NamesMaterials",
    "NotConverged",
    "NotUnique",
    "Observer",
    "Order",
    "PathBounds",
    "Place",
    "PlanePaths",
    "PlasticDamage",
    "PointKernels",
    "PointSources",
    "RegionView",
    "RememberedView",
    "Response",
    "Revolution",
    "Rotation",
    "Row",
    "SceneError",
    "StepView",
    "Strain",
    "StrainDamage",
    "Stress",
    "StressCycle",
    "SurfaceInfluence",
    "Surroundings",
    "Thinning",
    "TimedField",
    "Unit",
    "Variable",
    "WearLaw",
    "WearState",
    "as_tuple",
    "by_material",
    "checked_stiffness",
    "derivatives_of",
    "factors_of_compliance",
    "factors_of_stiffness",
    "frame_of",
    "hook_for",
    "hookimpl",
    "implicit",
    "integrated_chi",
    "isotropic_factors",
    "isotropic_stiffness",
    "mandel_rotation",
    "mandel_strain",
    "read_arrays",
    "read_columns",
    "read_gridded",
    "readable",
    "real_array",
    "real_points",
    "require",
    "rotation_matrix",
    "smallest_balls",
    "to_mandel",
    "turned_derivatives",
    "unit_of",
    "unit_vector",
    "variables",
    "worst_planes",
]

#: Kinds of plugin and their abstract classes: those above that set ``kind``. A new kind is a class exported here.
KINDS: dict[str, type[Component]] = {
    item.kind: item
    for item in (globals().get(name) for name in __all__)
    if isinstance(item, type) and issubclass(item, Component) and "kind" in vars(item)
}
