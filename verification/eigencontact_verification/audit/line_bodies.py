"""Bodies of a line contact in plain numbers: moduli, laws, layers, cross-sections of inclusions, eigenstrain."""

from __future__ import annotations

import tomllib
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.bodies import NotJudged, moduli_of
from eigencontact_verification.audit.contact_scene import (
    INCOMPRESSIBLE,
    body_law,
    law_numbers,
    layers_of,
    profile_of,
    refuse,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["line_scene"]

FloatArray = NDArray[np.float64]


def line_scene(text: str, edges: FloatArray, times: Sequence[float]) -> dict[str, Any]:
    """Scene of a run, as JSON allows.

    Parameters
    ----------
    text : str
        TOML.
    edges : (strips + 1,) float64
        Edges of the strips of the run [m]; patches of eigenstrain end there.
    times : sequence of float
        Of its steps.

    Returns
    -------
    dict
        ``profile`` (see `ContactScene`), ``friction``, the coefficient, and ``bodies`` that deform: number,
        young_modulus, poisson_ratio, law, ``cut`` (whether cells cut regions of other constants), ``regions``. These
        have a ``kind``: ``"layer"`` (top, bottom), ``"ellipse"`` (x, depth, half_width, half_height) or ``"box"``
        (left, right, top, bottom), and young_modulus, poisson_ratio, law and eigenstrain (xx, yy, zz, xz) of their own.

    Raises
    ------
    NotJudged
        It has what the elements have not.
    """
    from eigencontact.model.bodies import bodies_of
    from eigencontact.model.sources import build_sources
    from eigencontact.scene.components import build_component
    from eigencontact.scene.schema import Scene

    scene = Scene(**{**tomllib.loads(text), "stress": [], "observers": [], "fatigue": []})
    refuse(scene, line=True)
    registry = scene.known_plugins()
    solids = bodies_of(scene, registry)
    deep: list[Any] = [getattr(solid, "deep_material", solid) for solid in solids]
    if any(patch.size is None for patch in scene.eigenstrain):
        raise NotJudged("a patch of eigenstrain without a size fills the window, and the elements need a size")
    prescribed, different = build_sources(scene, registry, None, deep)
    bodies = []
    for number, (solid, material) in enumerate(zip(solids, deep, strict=True), 1):
        table: Any = (scene.body1, scene.body2)[number - 1]
        if solid is None:
            continue
        if material.poisson_ratio > INCOMPRESSIBLE:
            raise NotJudged(
                f"Poisson's ratio is {material.poisson_ratio:g}, and the elements lock above {INCOMPRESSIBLE:g}"
            )
        if table.initial is not None:
            raise NotJudged(f"body {number} starts from the state of another run")
        layers = _layers(solid)
        sources = [source for source in (*prescribed, *different) if source.body == number]
        if layers and sources:
            raise NotJudged(
                f"body {number} has layers and inclusions or eigenstrain, and the elements take one of them"
            )
        regions = [_region(source, material, edges, times) for source in sources]
        _refuse_overlap([region for region in regions if "young_modulus" in region])
        bodies.append(
            {
                "number": number,
                "law": body_law(registry, table.law, number, material),
                "young_modulus": material.young_modulus,
                "poisson_ratio": material.poisson_ratio,
                "cut": any(source.body == number for source in different),
                "regions": layers + regions,
            }
        )
    coefficient = 0.0
    if scene.friction is not None:
        friction: Any = build_component(registry, "friction-law", scene.friction, "friction")
        if friction.key != "coulomb":
            raise NotJudged(f"the elements have no friction law {friction.key!r}")
        if bodies[0]["number"] != 1:
            raise NotJudged("body 1 is rigid, and the elements need an elastic body 1 under friction")
        coefficient = float(friction.coefficient)
    profile = [profile_of(registry, table, 0.0) for table in scene.geometry]
    return {"bodies": bodies, "profile": profile, "friction": coefficient}


def _layers(solid: Any) -> list[dict[str, Any]]:
    """Layers with the depths of their sides."""
    layers, top = [], 0.0
    for layer in layers_of(solid):
        bottom = top + layer.pop("thickness")
        layers.append({"kind": "layer", "top": top, "bottom": bottom, **layer})
        top = bottom
    return layers


def _region(source: Any, material: Any, edges: FloatArray, times: Sequence[float]) -> dict[str, Any]:
    """Place, constants and eigenstrain of a source."""
    if not source.field.uniform:
        raise NotJudged(f"the eigenstrain of '{source.name}' varies in space, and the elements need uniform ones")
    strains = np.array([source.uniform_eigenstrain(time) for time in times])
    xx, yy, zz, yz, xz, xy = strains[0]
    if np.any(strains != strains[0]):
        raise NotJudged(f"the eigenstrain of '{source.name}' changes with time")
    if yz or xy:
        raise NotJudged(
            f"the eigenstrain of '{source.name}' has shear along the line, and the elements are in plane strain"
        )
    region = _place(source, edges)
    region["eigenstrain"] = [float(v) for v in (xx, yy, zz, xz / np.sqrt(2.0))]
    if hasattr(source, "law"):
        young, nu = moduli_of(source.law, material)
        region |= {"young_modulus": young, "poisson_ratio": nu, "law": law_numbers(source.law, young)}
    return region


def _place(source: Any, edges: FloatArray) -> dict[str, Any]:
    """Kind and size of the cross-section of a source; a patch ends at edges of strips, as in the run."""
    (left, _, top), (right, _, bottom) = source.shape.bounds
    if source.layers is not None or not hasattr(source.shape, "solid"):
        ends = [float(edges[np.abs(edges - place).argmin()]) for place in (left, right)]
        if not ends[0] < ends[1]:
            raise NotJudged(f"the patch '{source.name}' is narrower than a strip")
        return {"kind": "box", "left": ends[0], "right": ends[1], "top": 0.0, "bottom": float(bottom)}
    solid = source.shape.solid
    (_, front, _), (_, back, _) = solid.bounds
    tall = abs(front + back) < 1e-9 * (back - front)  # y = 0 cuts its middle
    axis = getattr(solid, "axis", None)
    straight = getattr(solid, "rotation", None) is None
    if (solid.key == "cylinder" and axis in ("y", (0.0, 1.0, 0.0))) or (
        solid.key in ("sphere", "ellipsoid") and tall and straight
    ):
        place = {"x": (left + right) / 2, "depth": (top + bottom) / 2}
        half = {"half_width": (right - left) / 2, "half_height": (bottom - top) / 2}
        return {"kind": "ellipse", **{name: float(value) for name, value in (place | half).items()}}
    if solid.key == "cuboid" and straight:
        return {"kind": "box", "left": float(left), "right": float(right), "top": float(top), "bottom": float(bottom)}
    raise NotJudged(f"the elements have no cross-section of inclusion '{source.name}' ({solid.key})")


def _refuse_overlap(regions: list[dict[str, Any]]) -> None:
    """Raise NotJudged where boxes around regions of other constants meet."""
    boxes = []
    for region in regions:
        if region["kind"] == "ellipse":
            half = np.array([region["half_width"], region["half_height"]])
            middle = np.array([region["x"], region["depth"]])
            boxes.append((middle - half, middle + half))
        else:
            boxes.append((np.array([region["left"], region["top"]]), np.array([region["right"], region["bottom"]])))
    for k, (low, high) in enumerate(boxes):
        if any(np.all((low < up) & (high > down)) for down, up in boxes[:k]):
            raise NotJudged("the boxes around two inclusions overlap, and the meshes need room between them")
