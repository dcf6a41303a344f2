"""Finite elements of a whole line contact, from plain numbers: gap, bodies, their regions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.contact_model import Heights
from eigencontact_verification.crosscheck.case import Outer
from eigencontact_verification.crosscheck.plasticity import point_law
from eigencontact_verification.fem.line_contact import LineBody, LineContact, PlaneRegion

__all__ = ["line_model"]

FloatArray = NDArray[np.float64]

#: Elements at the edges of contact and stick are smaller by this factor. The finest mesh of the quick audit (3136
#: elements) then has Cattaneo's shear within .29 % and slip within .07 % of the largest; 4160 elements of a/16 had
#: 6.4 % and .4 % (`test_line_elements`).
_SHARPER = 32
#: Growth from element to element of a mesh with one element to a half width.
_GROWTH = 16.0
#: Window around the places of the geometry, depth of the elements of a part of a half width, and reach of the mesh, in
#: half widths.
_WINDOW, _DEEP, _REACH = 1.25, 0.5, 60.0
#: That depth where a body yields.
_DEEP_YIELDING = 2.0
#: An ellipse that touches the surface is moved down by this part of its size, so that elements fit between.
_LEAST_ROOF = 1e-6


def line_model(parameters: Mapping[str, Any], divisions: int, outer: Outer) -> LineContact:
    """Model of the parameters of a case; ``half_width``, ``parts`` and ``edges`` in them decide the mesh."""
    heights, a = Heights(bodies=tuple(parameters["profile"])), parameters["half_width"]
    places = [0.0, *(place for *_, place in parameters["steps"])]
    per_half_width = parameters["parts"]
    bodies = []
    for table in parameters["bodies"]:
        moduli = {name: table[name] for name in ("young_modulus", "poisson_ratio")}
        regions = tuple(_region(region) for region in table["regions"])
        bodies.append(LineBody(**moduli, law=_law(table, **moduli), regions=regions))
    return LineContact(
        bodies=tuple(bodies),
        gap=lambda x: heights(np.abs(x)),
        friction=parameters["friction"],
        window=(min(places) - _WINDOW * a, max(places) + _WINDOW * a),
        fine=a / per_half_width,
        deep=(_DEEP_YIELDING if any(body.law for body in bodies) else _DEEP) * a,
        edges=tuple(parameters["edges"]),
        sharp=a / (_SHARPER * per_half_width),
        reach=_REACH * a,
        growth=_GROWTH ** (1 / per_half_width),
        divisions=divisions,
        outer=outer,
    )


def _law(table: Mapping[str, Any], young_modulus: float, poisson_ratio: float) -> Any:
    return None if table.get("law") is None else point_law(table["law"], young_modulus, poisson_ratio)


def _region(region: Mapping[str, Any]) -> PlaneRegion:
    young, nu = region.get("young_modulus"), region.get("poisson_ratio")
    common: dict[str, Any] = {"young_modulus": young, "poisson_ratio": nu}
    common |= {"law": _law(region, young or 0.0, nu or 0.0), "eigenstrain": region.get("eigenstrain", (0.0,) * 4)}
    if region["kind"] == "layer":
        return PlaneRegion(low=(-np.inf, region["top"]), high=(np.inf, region["bottom"]), **common)
    if region["kind"] == "box":
        return PlaneRegion(low=(region["left"], region["top"]), high=(region["right"], region["bottom"]), **common)
    x, width, height = region["x"], region["half_width"], region["half_height"]
    depth = max(region["depth"], height * (1 + _LEAST_ROOF))

    def inside(s: FloatArray, t: FloatArray) -> NDArray[np.bool_]:
        return np.asarray(((s - x) / width) ** 2 + ((t - depth) / height) ** 2 < 1.0)

    return PlaneRegion(low=(x - width, depth - height), high=(x + width, depth + height), contains=inside, **common)
