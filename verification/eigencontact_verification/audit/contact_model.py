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
        return np.asarray(sum(_height(body, np.asarray(r, dtype=float)) for body in self.bodies))


def _height(body: Mapping[str, Any], r: FloatArray) -> FloatArray:
    R = body["radius"]
    if body["kind"] == "parabola":
        return np.asarray(r**2 / (2 * R))
    if body["kind"] == "circle":
        return np.asarray(R - np.sqrt(np.maximum(R * R - r * r, 0.0)))
    if body["kind"] == "punch":
        return np.where(r > body["flat"], (r - body["flat"]) ** 2 / (2 * R), 0.0)
    slope = 1 / np.tan(body["half_angle"])
    return np.asarray(np.where(r < R * slope, r**2 / (2 * R), slope * (r - R * slope) + 0.5 * R * slope**2))


def junctions(profile: Sequence[Mapping[str, Any]]) -> tuple[float, ...]:
    """Radii at which a profile changes its form."""
    radii = []
    for body in profile:
        if body["kind"] == "punch" and body["flat"] > 0:
            radii.append(float(body["flat"]))
        if body["kind"] == "cone":
            radii.append(float(body["radius"] / np.tan(body["half_angle"])))
    return tuple(radii)


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


def contact_model(parameters: Mapping[str, Any], divisions: int, outer: Outer) -> Indentation:
    """Model of the parameters of a case; ``mesh`` in them has fine, extent, inner, deep, reach and growth."""
    mesh = parameters["mesh"]
    heights = Heights(bodies=tuple(parameters["profile"]))
    E, nu, law = parameters["young_modulus"], parameters["poisson_ratio"], parameters["law"]
    a = mesh["radius"]
    regions = []
    top = 0.0
    for layer in parameters["layers"]:
        bottom = top + layer["thickness"]
        regions.append(_region({"kind": "layer", "top": top, "bottom": bottom, **layer}, mesh["reach"]))
        top = bottom
    regions += [_region(region, mesh["reach"]) for region in parameters["regions"]]
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
        lines=tuple(r for r in junctions(parameters["profile"]) if r < mesh["extent"]),
    )


def _region(region: Mapping[str, Any], reach: float) -> YieldingRegion:
    young, nu, law = region.get("young_modulus"), region.get("poisson_ratio"), region.get("law")
    e_r, e_z = region.get("eigenstrain", (0.0, 0.0))
    point = None if law is None else point_law(law, young or 0.0, nu or 0.0)
    common: dict[str, Any] = {"young_modulus": young, "poisson_ratio": nu, "law": point, "eigenstrain": (e_r, e_z)}
    if region["kind"] == "ellipsoid":
        radius, height = region["radius"], region["height"]
        depth = max(region["depth"], height * (1 + _LEAST_ROOF))

        def inside(r: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
            return np.asarray((r / radius) ** 2 + ((z - depth) / height) ** 2 < 1.0)

        bounds = ((0.0, depth - height), (radius, depth + height))
        return YieldingRegion(contains=inside, bounds=bounds, fitted=True, **common)
    top, bottom, radius = region["top"], region["bottom"], region.get("radius", reach)

    def within(r: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        return np.asarray((r <= radius) & (z > top) & (z < bottom))

    return YieldingRegion(contains=within, bounds=((0.0, top), (radius, bottom)), **common)
