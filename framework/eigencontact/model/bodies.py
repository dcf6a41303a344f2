"""The two bodies of a scene: rigid, a homogeneous half-space, or a medium whose constants change with depth."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from eigencontact.core.material import Material
from eigencontact.core.units import readable
from eigencontact.errors import PluginError, SceneError
from eigencontact.hooks.registry import Registry
from eigencontact.model.installed import installed_influence
from eigencontact.model.kernels import Bodies, Solid
from eigencontact.plugin import ConstitutiveLaw, LayeredMedium, SurfaceInfluence
from eigencontact.scene.components import build_component

if TYPE_CHECKING:
    from eigencontact.scene.schema import Body, Scene

__all__ = [
    "bodies_of",
    "body_in_words",
    "influence_for",
    "kernel_key",
    "layered_bodies",
    "layers_as_data",
    "layers_in_words",
    "without_layers",
]


def bodies_of(scene: Scene, registry: Registry) -> Bodies:
    """Bodies of a scene; None is rigid.

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
    """Layered medium of a table; a component names itself in its errors, the body is put before it."""
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
    """Those of the bodies that are layered, each once."""
    return list(dict.fromkeys(body for body in bodies if isinstance(body, LayeredMedium)))


def without_layers(bodies: Bodies) -> tuple[Material | None, Material | None]:
    """Bodies with the substrate, down to the surface, in place of each layered medium."""
    first, second = (body.deep_material if isinstance(body, LayeredMedium) else body for body in bodies)
    return first, second


def influence_for(registry: Registry, traction: str, bodies: Bodies) -> SurfaceInfluence:
    """Influence of one traction component on these bodies: the installed one, for layered bodies too if there are any.

    Raises
    ------
    PlanError
        None is installed, or more than one.
    """
    installed = installed_influence(registry, traction)
    if not layered_bodies(bodies):
        return installed
    from eigencontact.halfspace.layered_influence import LayeredInfluence

    # It has the methods of a surface influence; `halfspace` knows no plugins, so it is none by name.
    return cast("SurfaceInfluence", LayeredInfluence(installed))


def kernel_key(influence: SurfaceInfluence, bodies: Sequence[Solid | None]) -> str:
    """Name of the plugins behind a kernel of these bodies."""
    media = sorted({medium.key for medium in layered_bodies(bodies)})
    homogeneous = any(isinstance(body, Material) for body in bodies)
    return " + ".join([influence.key, *media]) if homogeneous or not media else " + ".join(media)


def body_in_words(body: Solid | None, law: ConstitutiveLaw | None = None) -> str:
    """What a body is made of, in one line; of its law, if it has one, the key."""
    if body is None:
        return "rigid"
    if isinstance(body, Material):
        return f"{'elastic' if law is None else f'of law {law.key!r}'}, {_constants(body)}"
    tops = (0.0, *body.interfaces)
    parts = [
        f"{readable(bottom - top, 'm')} of {called}{_constants(body.material_at(top))}"
        for (top, bottom), called in zip(pairwise(tops), _called(body), strict=False)
    ]
    if len(parts) > 4:
        parts = [parts[0], f"{len(parts) - 2} more layers", parts[-1]]
    return f"layered (plugin {body.key!r}): {'; '.join([*parts, _constants(body.deep_material)])} below"


def layers_as_data(body: LayeredMedium) -> list[dict[str, Any]]:
    """Name, and depths of top and bottom [m], of each layer above the substrate."""
    tops = (0.0, *body.interfaces)
    return [
        {"name": name, "top": float(top), "bottom": float(bottom)}
        for name, (top, bottom) in zip(body.layer_names, pairwise(tops), strict=False)
    ]


def _called(body: LayeredMedium) -> list[str]:
    """Names of layers before their constants; nothing for those that have their number alone."""
    return ["" if name == f"layer {number}" else f"{name!r}, " for number, name in enumerate(body.layer_names, 1)]


def layers_in_words(bodies: Sequence[Solid | None], *, periodic: bool) -> str:
    """Which kernels a layered body replaces, and by what; empty for homogeneous bodies."""
    media = {number: body for number, body in enumerate(bodies, 1) if isinstance(body, LayeredMedium)}
    if not media:
        return ""
    who = " and ".join(f"body {number} ({medium.key!r})" for number, medium in media.items())
    how = "for each wave of the window" if periodic else "computed once as influence coefficients of cells"
    return f"layered kernels of {who} instead of half-space kernels, {how}"


def _constants(material: Material) -> str:
    return f"E = {readable(material.young_modulus, 'Pa')}, ν = {material.poisson_ratio:g}"
