"""Directions of traction and displacement in a contact, and the kernels between them."""

from __future__ import annotations

from dataclasses import dataclass

from eigencontact.core.material import Material, dundurs_constant
from eigencontact.core.tractions import ALONG, Traction
from eigencontact.model.kernels import Solids
from eigencontact.plugin import LayeredMedium
from eigencontact.scene.schema import Scene

__all__ = ["Coupling", "coupling_of"]

Pair = tuple[str, str]

#: Dundurs constants below this are zero: constants given with round-off.
_ROUND_OFF = 1e-12


@dataclass(frozen=True, kw_only=True, slots=True)
class Coupling:
    """Directions and kernels of a contact.

    Attributes
    ----------
    level : str
        ``numerics.coupling`` of the scene; ``"none"`` without friction.
    components : str
        Directions in which there may be shear, of ``"xy"``; none without friction.
    pairs : tuple of (str, str)
        Directions of displacement and of traction that have a kernel.
    alike : bool
        Whether normal and tangential contact have nothing to do with each other, because both bodies move alike under
        either traction (Dundurs' constant β is zero).
    """

    level: str
    components: str
    pairs: tuple[Pair, ...]
    alike: bool

    @property
    def tractions(self) -> tuple[Traction, ...]:
        """Traction components, the pressure first."""
        return tuple(ALONG[c] for c in f"z{self.components}")

    @property
    def joins_normal(self) -> bool:
        """Whether pressure displaces the surfaces tangentially, or shear displaces them normally."""
        return any((i == "z") != (j == "z") for i, j in self.pairs)


def coupling_of(scene: Scene, bodies: Solids, *, dragged: bool = False) -> Coupling:
    """Coupling of a scene with a contact.

    Where eigenstrain (`dragged`) or bulk stress drags the surfaces they move along x and y, whatever is prescribed:
    neither is an elastic coupling, so that no level leaves it out.
    """
    if scene.friction is None:
        return Coupling(level="none", components="", pairs=(("z", "z"),), alike=False)
    level = scene.numerics.coupling
    alike = _alike(bodies) and not _grow_apart(scene, bodies)
    line = scene.grid.line
    stretched = bool(scene.bulk_at_rest)
    components = "xy" if dragged or ((level != "none" or stretched) and not line) else _components(scene)
    if line and stretched and "x" not in components:
        components = f"x{components}"
    pairs: list[Pair] = [("z", "z"), *((c, c) for c in components)]
    # In plane strain, what is along y has nothing to do with what is in the plane.
    joined = "x" if line else components
    if level != "none" and not line:
        pairs += [("x", "y"), ("y", "x")]
    if level in ("one-way", "full") and not alike:
        pairs += [(c, "z") for c in components if c in joined]
    if level == "full" and not alike:
        pairs += [("z", c) for c in components if c in joined]
    return Coupling(level=level, components=components, pairs=tuple(pairs), alike=alike)


def _alike(bodies: Solids) -> bool:
    """Whether the bodies are elastically similar: Dundurs' constant is 0, or layered bodies are equal."""
    first, second = bodies
    if isinstance(first, Material | None) and isinstance(second, Material | None):
        return abs(dundurs_constant(first, second)) < _ROUND_OFF
    return first == second


def _grow_apart(scene: Scene, bodies: Solids) -> bool:
    """Whether layers of two like bodies lose different depths."""
    return isinstance(bodies[0], LayeredMedium) and scene.losses.get(1) != scene.losses.get(2)


def _components(scene: Scene) -> str:
    """Tangential directions of the prescribed loads and motions; x if there are none."""
    if scene.output.tangential_displacement:
        return "xy"
    names = {"x": ("tangential_load_x", "shift_x", "travel_x"), "y": ("tangential_load_y", "shift_y", "travel_y")}
    turned = any(_prescribes(scene, name) for name in ("torsion_moment", "twist"))
    slides = {"y" if ramp.sliding_direction == "y" else "x" for ramp in scene.ramps if ramp.sliding_distance}
    directions = "".join(c for c in "xy" if turned or c in slides or any(_prescribes(scene, name) for name in names[c]))
    return directions or "x"


def _prescribes(scene: Scene, name: str) -> bool:
    return any(getattr(step, name) is not None for step in scene.ramps)
