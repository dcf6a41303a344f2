"""Wear law for each material at the surface: coating and substrate, matrix and grains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from eigencontact.plugin import FloatArray, SceneError, WearLaw, WearState, by_material, hook_for

__all__ = ["ByMaterial"]


@dataclass(frozen=True, kw_only=True)
class ByMaterial(WearLaw):
    """Wear law by exposed material: each column wears by the law of its material.

    The names of materials are the ``name`` of inclusions and layers in the scene; all other material is ``substrate``.

    Parameters
    ----------
    laws : table of WearLaw
        Laws by name: ``coating = { type = "archard", coefficient = "1e-15 m^2/N" }``.
    """

    key: ClassVar[str] = "by-material"
    example: ClassVar[dict[str, Any]] = {"laws": {"substrate": {"type": "archard", "coefficient": 1e-13}}}
    references: ClassVar[tuple[str, ...]] = ("J. F. Archard, J. Appl. Phys. 24 (1953) 981, doi:10.1063/1.1721448",)

    laws: dict[str, WearLaw]

    def __post_init__(self) -> None:
        if not self.laws:
            raise SceneError(f"{self.key} must have laws by name of a material (got none)")

    @property
    def materials(self) -> tuple[str, ...]:
        """See `NamesMaterials.materials`."""
        return tuple(self.laws)

    @property
    def linear_in_pressure(self) -> bool:  # type: ignore[override]
        """See `WearLaw`."""
        return all(law.linear_in_pressure for law in self.laws.values())

    @property
    def needs_friction(self) -> bool:  # type: ignore[override]
        """See `WearLaw`."""
        return any(law.needs_friction for law in self.laws.values())

    @property
    def needs_cycles(self) -> bool:  # type: ignore[override]
        """See `WearLaw`."""
        return any(law.needs_cycles for law in self.laws.values())

    @property
    def volume_per_energy(self) -> float | None:
        """See `WearLaw.volume_per_energy`: if all laws have the same value."""
        volumes = {law.volume_per_energy for law in self.laws.values()}
        return volumes.pop() if len(volumes) == 1 else None

    def depth(self, state: WearState) -> FloatArray:
        """Worn depth [m]; see `WearLaw`."""
        depth = np.zeros_like(state.pressure)
        for name, exposed in by_material(f"wear law {self.key!r}", state, self.materials):
            depth = np.where(exposed, self.laws[name].depth(state), depth)
        return depth


eigencontact_register = hook_for(ByMaterial)
