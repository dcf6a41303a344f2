"""The interface of two bodies: geometries, friction, and the kernels that join tractions to displacements."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.arrays import real_answer
from eigencontact.core.tractions import ALONG, Traction
from eigencontact.errors import PlanError, SceneError
from eigencontact.hooks.registry import Registry
from eigencontact.model.bodies import influence_for, kernel_key
from eigencontact.model.coupling import Coupling, coupling_of
from eigencontact.model.kernels import PairCoefficients, Solids
from eigencontact.model.window import given_grid
from eigencontact.plugin import FrictionLaw, Geometry, HasNativeGrid, SurfaceInfluence
from eigencontact.scene.components import build_component, build_components
from eigencontact.scene.schema import Scene

__all__ = ["Interface", "build_interface", "dragged_interface"]


@dataclass(frozen=True, kw_only=True)
class Interface:
    """Contact of two solids.

    Attributes
    ----------
    solids : Solids
    geometries : tuple of Geometry
        Their separations add up.
    friction : FrictionLaw or None
        Bound of the shear; None where the contact has no friction.
    coupling : Coupling
        Tractions, and the kernels that join them to displacements.
    influences : mapping of str to SurfaceInfluence
        By traction.
    line : bool
        Whether it is a line contact: the geometries count at y = 0.
    datum, period : float or None
        As of `PairCoefficients`.
    """

    solids: Solids
    geometries: tuple[Geometry, ...]
    friction: FrictionLaw | None
    coupling: Coupling
    influences: Mapping[str, SurfaceInfluence]
    line: bool = False
    datum: float | None = None
    period: float | None = None

    @property
    def tractions(self) -> tuple[Traction, ...]:
        """Tractions of the contact, the pressure first."""
        return self.coupling.tractions

    @property
    def normal(self) -> PairCoefficients:
        """Normal displacement of both solids by pressure."""
        return self.pair("z", "z")

    @property
    def endless(self) -> bool:
        """Whether loads have infinite extent along y: line contacts, and contacts periodic along y only."""
        return self.line or self.period is not None

    def against(self, depth: float) -> Interface:
        """Interface with displacements relative to points at a datum depth [m], if they grow without limit.

        So it is under loads without end along y, unless the scene names a depth.
        """
        return replace(self, datum=depth) if self.endless and self.datum is None else self

    def pair(self, displacement: str, traction: str) -> PairCoefficients:
        """Displacement of both solids along one direction by the traction along another."""
        return PairCoefficients(
            self.influences[ALONG[traction].name], self.solids, displacement, self.datum, self.period
        )

    def kernel_key(self, traction: str) -> str:
        """Names of the plugins behind the kernels of the traction along a direction."""
        return kernel_key(self.influences[ALONG[traction].name], self.solids)

    def separation(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Initial gap at points that broadcast [m]: the sum of all geometries.

        Raises
        ------
        PluginError
            Names a geometry that does not return real numbers of this shape.
        """
        shape = np.broadcast_shapes(x.shape, y.shape)
        y = np.zeros_like(y) if self.line else y
        total = np.zeros(shape)
        for geometry in self.geometries:
            total += real_answer(geometry.separation(x, y), f"separation of geometry {geometry.key!r}", shape)
        return total

    @property
    def measured(self) -> bool:
        """Whether a surface is a measured one: its contact consists of spots of all sizes, without one radius."""
        return any(isinstance(geometry, HasNativeGrid) for geometry in self.geometries)


def build_interface(scene: Scene, registry: Registry, solids: Solids) -> Interface | None:
    """Interface of a scene; None without a geometry.

    Raises
    ------
    SceneError, PluginError, PlanError
        A component that is refused, or an influence that is missing.
    """
    if not scene.geometry:
        return None
    coupling, friction = coupling_of(scene, solids), None
    geometries = build_components(registry, "geometry", scene.geometry, "geometry")
    influences = {item.name: influence_for(registry, item.name, solids) for item in coupling.tractions}
    if scene.friction is not None:
        friction = build_component(registry, "friction-law", scene.friction, "friction")
    interface = Interface(
        solids=solids, geometries=tuple(geometries), friction=friction, coupling=coupling, influences=influences,
        line=scene.grid.line, datum=scene.grid.datum_depth, period=_period(scene),
    )  # fmt: skip
    if interface.endless:
        _refuse_without_strips(influences.values())
    return interface


def _period(scene: Scene) -> float | None:
    """Period along y [m] of a scene that is periodic along y only: the extent of its window."""
    if not scene.numerics.repeats_y:
        return None
    grid = given_grid(scene.grid)
    if grid is None:
        raise SceneError(
            "grid must be given with numerics.boundary = 'periodic-y' (got automatic); its size along y is the period: "
            "give cells and size"
        )
    return grid.size[1]


def _refuse_without_strips(influences: Iterable[SurfaceInfluence]) -> None:
    """Refuse influences without strips in a line contact and in a window that is periodic along y only."""
    for influence in influences:
        if not influence.has_strips:
            raise PlanError(
                f"grid.length and numerics.boundary = 'periodic-y' must be left out with surface influence "
                f"{influence.key!r} (got one of them); it has no strips, only rectangles"
            )


def dragged_interface(interface: Interface, scene: Scene, registry: Registry) -> Interface:
    """Interface whose surfaces eigenstrain drags along x and y; the same without friction."""
    if interface.friction is None:
        return interface
    coupling = coupling_of(scene, interface.solids, dragged=True)
    influences = {item.name: influence_for(registry, item.name, interface.solids) for item in coupling.tractions}
    return replace(interface, coupling=coupling, influences=influences)
