"""Wear of a contact: the law, its table in the scene, and the motion that wears."""

from __future__ import annotations

from dataclasses import dataclass

from eigencontact.errors import SceneError
from eigencontact.hooks.registry import Registry
from eigencontact.plugin import WearLaw
from eigencontact.scene.components import build_component
from eigencontact.scene.schema import Scene
from eigencontact.scene.wear import Wear

__all__ = ["WearModel", "wear_model"]


@dataclass(frozen=True, kw_only=True)
class WearModel:
    """Wear of the two surfaces.

    Attributes
    ----------
    law : WearLaw
        Depth that sliding takes off.
    table : Wear
        Bodies that wear, size of jumps over cycles, errors allowed.
    slides, travels, repeats : bool
        Whether a ramp slides all over the contact, moves the geometry, or belongs to a cycle that is repeated.
    """

    law: WearLaw
    table: Wear
    slides: bool
    travels: bool
    repeats: bool

    @property
    def parts(self) -> dict[int, float]:
        """Share of each body in the worn depth."""
        return self.table.parts

    @property
    def by_increment(self) -> bool:
        """Whether each increment of a cycle moves the surfaces."""
        return self.table.update == "increment"


def wear_model(scene: Scene, registry: Registry) -> WearModel | None:
    """Wear of a scene; None without wear.

    Raises
    ------
    SceneError, PluginError
        A law that is refused, or that needs friction or cycles where the scene has none.
    """
    if scene.wear is None:
        return None
    table, ramps = scene.wear, scene.ramps
    law: WearLaw = build_component(registry, WearLaw.kind, table.component, "wear", table.beside)
    if law.needs_friction and scene.friction is None:
        candidates = [
            repr(entry.key)
            for entry in registry.of_kind(law.kind)
            if not getattr(entry.component, "needs_friction", True)
        ]
        raise SceneError(
            f"wear.type must name a law of pressure and path in a contact without friction, {' or '.join(candidates)} "
            f"(got {law.key!r}, which uses the work of friction); change it, or add [friction]"
        )
    if law.needs_cycles and table.update == "increment":
        raise SceneError(
            f"wear.update must be 'cycle' with {law.key!r}, which uses the slip amplitude of a cycle (got "
            "'increment'); remove wear.update"
        )
    if law.needs_cycles and all(step.cycle is None for step in scene.steps):
        raise SceneError(
            f"steps must have a cycle with wear.type = {law.key!r}, which uses the slip amplitude of a cycle (got "
            "none); write them as cycle = [{ ... }]"
        )
    return WearModel(
        law=law,
        table=table,
        slides=any(ramp.slides for ramp in ramps),
        travels=any(ramp.travels for ramp in ramps),
        repeats=any(step.repeat > 1 for step in scene.steps),
    )
