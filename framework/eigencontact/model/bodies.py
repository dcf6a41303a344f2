"""The two bodies of a scene: rigid, a homogeneous half-space, or a medium whose constants change with depth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from eigencontact.core.material import Material
from eigencontact.errors import PluginError, SceneError, require
from eigencontact.hooks.registry import Registry
from eigencontact.model.installed import installed_influence
from eigencontact.model.kernels import Solid, Solids
from eigencontact.model.sources import Inhomogeneity, Source, build_inclusions, build_law
from eigencontact.plugin import ConstitutiveLaw, LayeredMedium, SurfaceInfluence
from eigencontact.scene.components import build_component

if TYPE_CHECKING:
    from eigencontact.scene.schema import Body, Scene

__all__ = ["Bodies", "bodies_of", "build_bodies", "influence_for", "kernel_key", "layered_bodies", "without_layers"]


@dataclass(frozen=True, kw_only=True)
class Bodies:
    """Two bodies with their elastic constants and laws.

    Attributes
    ----------
    solids : Solids
        Elastic constants, uniform or layered; None is rigid.
    laws : mapping of int to ConstitutiveLaw
        Law of each body that has one, also where the body stays elastic.
    prescribed, inhomogeneities : tuple of Source
        Inclusions with eigenstrain alone, and inclusions of another material, before they are cut into cells.
    """

    solids: Solids
    laws: Mapping[int, ConstitutiveLaw]
    prescribed: tuple[Source, ...]
    inhomogeneities: tuple[Inhomogeneity, ...]

    def half_space(self, body: int) -> Material:
        """Constants of a homogeneous body (1 or 2): the only kind that may contain eigenstrain."""
        material = self.solids[body - 1]
        assert isinstance(material, Material)
        return material


def build_bodies(scene: Scene, registry: Registry) -> Bodies:
    """Bodies of a scene.

    Raises
    ------
    SceneError, PluginError
        A component that is refused, or that is not installed.
    """
    solids = bodies_of(scene, registry)
    prescribed, inhomogeneities = build_inclusions(scene, registry, solids)
    laws: dict[int, ConstitutiveLaw] = {}
    for body, table in ((1, scene.body1.law), (2, scene.body2.law)):
        if table is not None:
            laws[body] = build_law(registry, table, f"body{body}.law", solids[body - 1])
            _refuse_law(laws[body], scene, f"body{body}.law")
    return Bodies(solids=solids, laws=laws, prescribed=prescribed, inhomogeneities=inhomogeneities)


def _refuse_law(law: ConstitutiveLaw, scene: Scene, where: str) -> None:
    """Refuse laws and scenes that a body cannot have."""
    rule = "of a material that yields or degrades: one that is elastic has young-modulus and poisson-ratio"
    require(not law.linear, where, "type", law.key, rule)
    if not scene.geometry:
        raise SceneError(
            f"{where} must be left out without a contact (got {law.key!r}); give an inclusion with this material"
        )


def bodies_of(scene: Scene, registry: Registry) -> Solids:
    """Solids of a scene, by body; None is rigid.

    Raises
    ------
    SceneError, PluginError
        A medium that is refused, or that is not installed.
    """
    return _body(scene.body1, registry, "body1"), _body(scene.body2, registry, "body2")


def _body(body: Body, registry: Registry, name: str) -> Solid | None:
    if body.rigid:
        return None
    if body.medium is not None:
        return _medium(body.medium, registry, f"{name}.medium")
    assert body.young_modulus is not None
    assert body.poisson_ratio is not None
    return Material(young_modulus=body.young_modulus, poisson_ratio=body.poisson_ratio)


def _medium(table: dict[str, Any], registry: Registry, where: str) -> LayeredMedium:
    """Layered medium of a table; error messages begin with the body."""
    try:
        medium: LayeredMedium = build_component(registry, "layered-medium", table, where)
    except SceneError as problem:
        text = str(problem)
        raise SceneError(text if where in text else f"{where}: {text}") from None
    entry = registry.entry_of(medium)
    try:
        ends, depths = (medium.surface_material, medium.deep_material), tuple(medium.interfaces)
        inside = [medium.material_at(depth) for depth in (0.0, *depths)]
        k = np.array([[0.0, 1.0, 2.0]]) / (depths[0] if depths else 1.0)
        answer = np.asarray(medium.response("displacement", ["z"], "p", k, k.T, 0.0))
    except PluginError as problem:
        raise PluginError(f"{where}: {problem}") from None
    except (ArithmeticError, TypeError, ValueError) as problem:
        raise PluginError(
            f"{where}: {entry.kind} {entry.key!r} of {entry.origin} must tell its materials, interfaces and "
            f"response (got {type(problem).__name__}: {problem})"
        ) from problem
    for item in (*ends, *inside):
        if not isinstance(item, Material):
            raise PluginError(
                f"{where}: {entry.kind} {entry.key!r} of {entry.origin} must be made of Materials (got {item!r})"
            )
    if any(not low < high for low, high in pairwise((0.0, *depths))):
        raise PluginError(
            f"{where}: interfaces of {entry.kind} {entry.key!r} of {entry.origin} must be positive and ascend "
            f"(got {depths})"
        )
    if answer.shape != (1, 3, 3) or not np.isfinite(answer).all():
        raise PluginError(
            f"{where}: response of {entry.kind} {entry.key!r} of {entry.origin} must be finite, of shape (1, 3, 3) for "
            f"one component at 3 x 3 waves (got shape {answer.shape})"
        )
    return medium


def layered_bodies(bodies: Sequence[Solid | None]) -> list[LayeredMedium]:
    """Layered bodies among solids, each once."""
    return list(dict.fromkeys(body for body in bodies if isinstance(body, LayeredMedium)))


def without_layers(bodies: Solids) -> tuple[Material | None, Material | None]:
    """Solids with the substrate, down to the surface, in place of each layered medium."""
    first, second = (body.deep_material if isinstance(body, LayeredMedium) else body for body in bodies)
    return first, second


def influence_for(registry: Registry, traction: str, bodies: Solids) -> SurfaceInfluence:
    """Influence of one traction component: the installed one, extended to layered bodies where a solid is one.

    Raises
    ------
    PlanError
        None is installed, or more than one.
    """
    installed = installed_influence(registry, traction)
    if not layered_bodies(bodies):
        return installed
    from eigencontact.halfspace.layered_influence import LayeredInfluence

    # It has the methods of a surface influence; `halfspace` imports no plugins, so that it is no subclass.
    return cast("SurfaceInfluence", LayeredInfluence(installed))


def kernel_key(influence: SurfaceInfluence, bodies: Sequence[Solid | None]) -> str:
    """Name of the plugins behind a kernel of these bodies."""
    media = sorted({medium.key for medium in layered_bodies(bodies)})
    homogeneous = any(isinstance(body, Material) for body in bodies)
    return " + ".join([influence.key, *media]) if homogeneous or not media else " + ".join(media)
