"""A run of revolution in plain numbers: what is pressed, by what, along which loads; and what is not of revolution.

A square box that is wider than the contact by a quarter is taken as a disc of its area.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.bodies import NotJudged, moduli_of

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = [
    "INCOMPRESSIBLE",
    "ContactScene",
    "body_law",
    "contact_scene",
    "law_numbers",
    "layers_of",
    "profile_of",
    "refuse",
]

FloatArray = NDArray[np.float64]

#: Half width of a box, in contact radii, from which it counts as a disc of its area, and as a layer without end.
_WIDE, _ENDLESS = 1.25, 10.0
#: Part of the contact radius by which a place may be off the axis.
_CENTRED = 1e-6
#: Poisson's ratio from which the far field is not what the elements hold.
INCOMPRESSIBLE = 0.4999


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactScene:
    """A deformable body of revolution and what is pressed into it; all in SI units.

    Attributes
    ----------
    number : int
        Of the body: 1 or 2.
    young_modulus, poisson_ratio : float
        Of the substrate.
    law : dict or None
        Fields of its law, as a scene writes them.
    layers : list of dict
        thickness, young_modulus, poisson_ratio; from the surface downwards.
    regions : list of dict
        By ``kind``: ``"ellipsoid"`` (depth, radius, height: semi-axes), ``"disc"`` (top, bottom, radius), ``"layer"``
        (top, bottom); with young_modulus, poisson_ratio, law, eigenstrain (e_rr, e_zz).
    profile : list of dict
        Bodies whose heights add up, by ``kind``: ``"parabola"``, ``"circle"``, ``"punch"``, ``"cone"``.
    cells, cut : bool
        Whether the run has cells in the body; whether they cut the boundary of something.
    notes : list of str
        What the elements take otherwise than the scene.
    """

    number: int
    young_modulus: float
    poisson_ratio: float
    law: dict[str, Any] | None
    layers: list[dict[str, float]]
    regions: list[dict[str, Any]]
    profile: list[dict[str, Any]]
    cells: bool
    cut: bool
    notes: list[str]

    def numbers(self) -> dict[str, Any]:
        """All that decides the finite elements, as JSON allows."""
        names = ("young_modulus", "poisson_ratio", "law", "layers", "regions", "profile")
        return {name: getattr(self, name) for name in names}


def contact_scene(text: str, contact_radius: float) -> ContactScene:
    """Scene of a run, from its text in the results.

    Parameters
    ----------
    text : str
        TOML.
    contact_radius : float
        Largest of the run [m].

    Raises
    ------
    NotJudged
        It is not of revolution, or has what the elements have not.
    """
    from eigencontact.model.bodies import bodies_of
    from eigencontact.model.sources import build_sources
    from eigencontact.scene.schema import Scene

    scene = Scene(**{**tomllib.loads(text), "stress": [], "observers": [], "fatigue": []})
    refuse(scene)
    registry = scene.known_plugins()
    solids = bodies_of(scene, registry)
    (number, solid), *second = [(k, elastic) for k, elastic in enumerate(solids, 1) if elastic is not None]
    if second:
        raise NotJudged("both bodies are elastic, and the axisymmetric elements need a rigid one")
    material: Any = getattr(solid, "deep_material", solid)
    if material.poisson_ratio > INCOMPRESSIBLE:
        raise NotJudged(
            f"Poisson's ratio is {material.poisson_ratio:g}, and the elements lock above {INCOMPRESSIBLE:g}"
        )
    deep: list[Any] = [getattr(elastic, "deep_material", elastic) for elastic in solids]
    if scene.eigenstrain:
        raise NotJudged("a patch of eigenstrain is rectangular, and the elements are axisymmetric")
    prescribed, different = build_sources(scene, registry, None, deep)
    notes: list[str] = []
    body = scene.body1 if number == 1 else scene.body2
    if body.initial is not None:
        raise NotJudged("the body starts from the state of another run")
    regions = []
    for source in (*prescribed, *different):
        place = _place(source.shape, source.name, contact_radius, notes)
        if not source.field.uniform:
            raise NotJudged(f"the eigenstrain of '{source.name}' varies in space, and the elements need uniform ones")
        place["eigenstrain"] = _of_revolution(source.name, np.asarray(source.uniform_eigenstrain(1.0)))
        if hasattr(source, "law"):
            young, nu = moduli_of(source.law, material)
            place |= {"young_modulus": young, "poisson_ratio": nu, "law": law_numbers(source.law, young)}
        regions.append(place)
    return ContactScene(
        number=number,
        young_modulus=material.young_modulus,
        poisson_ratio=material.poisson_ratio,
        law=body_law(registry, body.law, number, material),
        layers=layers_of(solid),
        regions=regions,
        profile=[profile_of(registry, table, contact_radius) for table in scene.geometry],
        cells=bool(different) or body.law is not None,
        cut=any(place["kind"] != "layer" and "young_modulus" in place for place in regions),
        notes=notes,
    )


def refuse(scene: Any, *, line: bool = False) -> None:
    """Raise NotJudged where a scene is not covered at all; elements of a line contact have friction and bulk stress."""
    half_space, boundary = scene.numerics.half_space, scene.numerics.boundary
    reasons = {
        "the run has no contact": not scene.geometry,
        "the contact has friction, and the axisymmetric elements have none": scene.friction is not None and not line,
        "a surface wears, and the elements keep their surfaces": scene.wear is not None,
        "the bodies have a bulk stress, and the axisymmetric elements have none": bool(scene.bulk_at_rest) and not line,
        f'numerics.half-space is "{half_space}", and the elements need "exact"': half_space != "exact",
        f'numerics.boundary is "{boundary}", and the elements need "non-periodic"': boundary != "non-periodic",
    }
    for reason, holds in reasons.items():
        if holds:
            raise NotJudged(reason)


def _plain(component: Any) -> dict[str, Any]:
    """Fields of a component with its key as ``type``."""
    table = {field.name: getattr(component, field.name) for field in fields(component)}
    table = {name: list(value) if isinstance(value, tuple) else value for name, value in table.items()}
    return {"type": component.key, **{name: value for name, value in table.items() if value is not None}}


def law_numbers(law: Any, young_modulus: float) -> dict[str, Any] | None:
    """Fields of a law that yields; None where it is elastic."""
    if not law.variables:
        return None
    if law.key != "j2":
        raise NotJudged(f"the elements have no law {law.key!r}")
    table: dict[str, Any] = {"hardening": [_plain(hardening) for hardening in law.hardening], "yield_on": law.yield_on}
    for hardening in table["hardening"]:
        if "tangent_modulus" in hardening:
            slope = hardening.pop("tangent_modulus")
            hardening["modulus"] = young_modulus * slope / (young_modulus - slope)
    if law.damage is not None:
        damage = _plain(law.damage)
        if damage["type"] != "exponential":
            raise NotJudged(f"the elements have no damage law {damage['type']!r}")
        if damage.get("length"):
            raise NotJudged("the damage is averaged over a length, and the elements have local damage")
        table["damage"] = damage
    return table


def body_law(registry: Any, table: Mapping[str, Any] | None, number: int, material: Any) -> dict[str, Any] | None:
    """Fields of the law of a body; None where it is elastic. Raises NotJudged for a law that the elements have not."""
    from eigencontact.model.sources import build_law

    return (
        None
        if table is None
        else law_numbers(build_law(registry, table, f"body{number}.law", material), material.young_modulus)
    )


def layers_of(solid: Any) -> list[dict[str, float]]:
    """Layers of a body from the surface down; raises NotJudged where their constants change with depth."""
    if not hasattr(solid, "interfaces"):
        return []
    depths = [0.0, *solid.interfaces]
    layers = []
    for top, bottom in pairwise(depths):
        material = solid.material_at(top)
        layers.append(
            {
                "thickness": bottom - top,
                "young_modulus": material.young_modulus,
                "poisson_ratio": material.poisson_ratio,
            }
        )
        if solid.material_at(0.5 * (top + bottom)) != material:
            raise NotJudged("the constants of a layer change with depth, and the elements need uniform layers")
    return layers


def _place(shape: Any, name: str, contact_radius: float, notes: list[str]) -> dict[str, Any]:
    """Kind and size of an inclusion on the axis."""
    (x0, y0, top), (x1, y1, bottom) = ((float(v) for v in corner) for corner in shape.bounds)
    if max(abs(x0 + x1), abs(y0 + y1)) > 2 * _CENTRED * contact_radius:
        raise NotJudged(f"inclusion '{name}' lies off the axis")
    key, half = shape.key, 0.5 * min(x1 - x0, y1 - y0)
    tall = getattr(shape, "axis", "z") in ("z", (0.0, 0.0, 1.0))
    if key in ("sphere", "ellipsoid") and np.isclose(x1 - x0, y1 - y0, rtol=1e-9, atol=0):
        return {"kind": "ellipsoid", "depth": 0.5 * (top + bottom), "radius": half, "height": 0.5 * (bottom - top)}
    if key == "cylinder" and tall and np.isclose(x1 - x0, y1 - y0, rtol=1e-9, atol=0):
        return {"kind": "disc", "top": top, "bottom": bottom, "radius": half}
    if key in ("cuboid", "layer") and half >= _ENDLESS * contact_radius:
        return {"kind": "layer", "top": top, "bottom": bottom}
    if key == "cuboid" and half >= _WIDE * contact_radius and np.isclose(x1 - x0, y1 - y0, rtol=1e-9, atol=0):
        notes.append(
            f"the box '{name}' of half width {half / contact_radius:.3g} contact radii is represented by a disc of "
            "equal area"
        )
        return {"kind": "disc", "top": top, "bottom": bottom, "radius": 2 * half / np.sqrt(np.pi)}
    raise NotJudged(f"inclusion '{name}' ({key}) is not axisymmetric")


def _of_revolution(name: str, mandel: FloatArray) -> list[float]:
    size = float(np.abs(mandel).max())
    if size and max(abs(mandel[0] - mandel[1]), *np.abs(mandel[3:])) > 1e-9 * size:
        raise NotJudged(f"inclusion '{name}' has an eigenstrain that is not axisymmetric")
    return [float(mandel[0]), float(mandel[2])]


def profile_of(registry: Any, table: Mapping[str, Any], contact_radius: float) -> dict[str, Any]:
    """Kind and size of a geometry; raises NotJudged for one off the axis, or one that the elements have not."""
    from eigencontact.scene.components import build_component

    geometry = build_component(registry, "geometry", table, "geometry")
    if max(abs(v) for v in getattr(geometry, "center", (0.0, 0.0))) > _CENTRED * contact_radius:
        raise NotJudged(f"the geometry {geometry.key!r} lies off the axis")
    if geometry.key == "sphere":
        return {"kind": geometry.profile, "radius": geometry.radius}
    if geometry.key == "cylinder" and geometry.length == np.inf and geometry.angle == 0.0:
        return {"kind": "parabola", "radius": geometry.radius}
    if geometry.key == "rounded-punch":
        return {"kind": "punch", "flat": geometry.flat_radius, "radius": geometry.edge_radius}
    if geometry.key == "rounded-cone":
        return {"kind": "cone", "half_angle": geometry.half_angle, "radius": geometry.tip_radius}
    raise NotJudged(f"the geometry {geometry.key!r} has no equivalent in the finite-element models")
