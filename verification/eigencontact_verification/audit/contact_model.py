"""Finite elements of a whole contact of revolution, from plain numbers: profile of the rigid body, layers, regions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.case import Outer
from eigencontact_verification.crosscheck.plasticity import point_law
from eigencontact_verification.fem.yielding import Indentation, YieldingRegion

__all__ = ["contact_model", "junctions", "pliancy"]

FloatArray = NDArray[np.float64]

#: A ball that touches the surface is moved down by this part of its size, so that elements fit between.
_LEAST_ROOF = 1e-6
#: Points over the quarter turn of Sneddon's integral.
_TURNS = 4000


@dataclass(frozen=True, kw_only=True)
class Heights:
    """Sum of the heights of rigid bodies above their lowest points."""

    bodies: tuple[Mapping[str, Any], ...]

    def __call__(self, r: FloatArray) -> FloatArray:
        """Height at radii (n,)."""
        return np.asarray(sum(_height(one, np.asarray(r, dtype=float)) for one in self.bodies))


def _height(one: Mapping[str, Any], r: FloatArray) -> FloatArray:
    R = one["radius"]
    if one["kind"] == "parabola":
        return np.asarray(r**2 / (2 * R))
    if one["kind"] == "circle":
        return np.asarray(R - np.sqrt(np.maximum(R * R - r * r, 0.0)))
    if one["kind"] == "punch":
        return np.where(r > one["flat"], (r - one["flat"]) ** 2 / (2 * R), 0.0)
    slope = 1 / np.tan(one["half_angle"])
    return np.asarray(np.where(r < R * slope, r**2 / (2 * R), slope * (r - R * slope) + 0.5 * R * slope**2))


def junctions(profile: Sequence[Mapping[str, Any]]) -> tuple[float, ...]:
    """Radii at which a profile changes its form."""
    found = []
    for one in profile:
        if one["kind"] == "punch" and one["flat"] > 0:
            found.append(float(one["flat"]))
        if one["kind"] == "cone":
            found.append(float(one["radius"] / np.tan(one["half_angle"])))
    return tuple(found)


def pliancy(profile: Sequence[Mapping[str, Any]], a: float) -> float:
    """Derivative θ'(a) of the approach by the contact radius on a half-space, θ(a) = a ∫ h'(a sin t) dt, t to π/2.

    By Sneddon's solution (Int. J. Eng. Sci. 3 (1965) 47); 2a/R of the parabola.
    """
    heights, small = Heights(bodies=tuple(profile)), 1e-4 * a
    t = (np.arange(_TURNS) + 0.5) * np.pi / 2 / _TURNS

    def approach(x: float) -> float:
        r = x * np.sin(t)
        slope = (heights(r + small) - heights(r - small)) / (2 * small)
        return float(x * slope.mean() * np.pi / 2)

    return (approach(a + small) - approach(a - small)) / (2 * small)


def contact_model(given: Mapping[str, Any], divisions: int, outer: Outer) -> Indentation:
    """Model of the parameters of a case; ``mesh`` in them has fine, extent, inner, deep, reach and growth."""
    mesh = given["mesh"]
    heights = Heights(bodies=tuple(given["profile"]))
    E, nu, law = given["young_modulus"], given["poisson_ratio"], given["law"]
    a = mesh["radius"]
    regions = []
    top = 0.0
    for layer in given["layers"]:
        bottom = top + layer["thickness"]
        regions.append(_region({"kind": "layer", "top": top, "bottom": bottom, **layer}, mesh["reach"]))
        top = bottom
    regions += [_region(one, mesh["reach"]) for one in given["regions"]]
    return Indentation(
        young_modulus=E,
        poisson_ratio=nu,
        law=None if law is None else point_law(law, E, nu),
        regions=tuple(regions),
        radius=a**2 / (2 * float(heights(np.array([a]))[0])),
        profile=heights,
        fine=mesh["fine"],
        extent=mesh["extent"],
        inner=mesh["inner"],
        deep=mesh["deep"],
        reach=mesh["reach"],
        growth=mesh["growth"],
        outer=outer,
        divisions=divisions,
        lines=tuple(r for r in junctions(given["profile"]) if r < mesh["extent"]),
    )


def _region(given: Mapping[str, Any], reach: float) -> YieldingRegion:
    young, nu, law = given.get("young_modulus"), given.get("poisson_ratio"), given.get("law")
    e_r, e_z = given.get("eigenstrain", (0.0, 0.0))
    own = None if law is None else point_law(law, young or 0.0, nu or 0.0)
    common: dict[str, Any] = {"young_modulus": young, "poisson_ratio": nu, "law": own, "eigenstrain": (e_r, e_z)}
    if given["kind"] == "ellipsoid":
        radius, height = given["radius"], given["height"]
        depth = max(given["depth"], height * (1 + _LEAST_ROOF))

        def inside(r: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
            return np.asarray((r / radius) ** 2 + ((z - depth) / height) ** 2 < 1.0)

        bounds = ((0.0, depth - height), (radius, depth + height))
        return YieldingRegion(contains=inside, bounds=bounds, fitted=True, **common)
    top, bottom, radius = given["top"], given["bottom"], given.get("radius", reach)

    def within(r: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        return np.asarray((r <= radius) & (z > top) & (z < bottom))

    return YieldingRegion(contains=within, bounds=((0.0, top), (radius, bottom)), **common)
