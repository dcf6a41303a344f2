"""Fatigue criteria of a scene: components, and the regions with the evaluated points."""

from __future__ import annotations

from dataclasses import dataclass

from eigencontact.hooks.registry import Registry
from eigencontact.plugin import FatigueCriterion
from eigencontact.scene.components import build_component
from eigencontact.scene.fatigue import FatigueRequest, elastic_constants
from eigencontact.scene.schema import Scene, StressRequest

__all__ = ["FatigueModel", "fatigue_of"]


@dataclass(frozen=True, kw_only=True)
class FatigueModel:
    """A fatigue criterion in a region.

    Attributes
    ----------
    criterion : FatigueCriterion
    request : FatigueRequest
        Cycle, critical distance, life.
    region : StressRequest
        Points at which it is evaluated.
    """

    criterion: FatigueCriterion
    request: FatigueRequest
    region: StressRequest


def fatigue_of(scene: Scene, registry: Registry) -> tuple[FatigueModel, ...]:
    """Fatigue criteria of a scene, in its order.

    Raises
    ------
    SceneError, PluginError
        A criterion that is refused, or that needs a strain that the region does not store.
    """
    models = []
    for number, request in enumerate(scene.fatigue):
        where = "fatigue" if len(scene.fatigue) == 1 else f"fatigue.{number}"
        criterion: FatigueCriterion = build_component(
            registry, FatigueCriterion.kind, request.component, where, request.beside
        )
        region = request.region_in(scene)
        if criterion.needs_strain and "strain" not in region.fields:
            body = scene.resolved()[f"body{region.body}"]
            elastic_constants(body, ["inclusions"] if scene.inclusions or scene.eigenstrain else (), region.label)
        models.append(FatigueModel(criterion=criterion, request=request, region=region))
    return tuple(models)
