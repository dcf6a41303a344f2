"""The list of bodies that yield: every law of hardening, damage, layers, balls, prior stress, cycles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.crosscheck.case import Profile
from eigencontact_verification.crosscheck.plasticity import KEY, PlasticCase

__all__ = ["plastic_case", "plastic_cases"]

FloatArray = NDArray[np.float64]

#: Elements to a contact radius are `_FINE` times these parts; growth of the undivided mesh; its size.
_FINE, _DIVISIONS, _GROWTH, _EXTENT, _REACH = 1.2, (3, 6, 12), 2.5, 1.6, 40.0
#: Steel under the load of case HZ-1: p0 = 8470 MPa.
_BODY = {"young_modulus": 210e9, "poisson_ratio": 0.3, "radius": 105e-6, "load": 0.65}
_PATH = (0.4, 0.7, 1.0, 0.0)
_CYCLED = (0.5, 1.0, 0.0, 0.5, 1.0, 0.0)
#: Distance from a boundary, in contact radii, where the steps of the coarsest cells are not felt.
_MARGIN = 0.25


def plastic_case(
    name: str,
    words: str,
    *hardening: Mapping[str, Any],
    law: Mapping[str, Any] | None = None,
    regions: Sequence[Mapping[str, Any]] = (),
    path: Sequence[float] = _PATH,
    body: Mapping[str, float] = _BODY,
    stop: int = 0,
    quick: bool = False,
) -> PlasticCase:
    """Case of one body.

    Parameters
    ----------
    name, words : str
        Of the case; what yields, for the figures.
    hardening : mappings
        Tables of the hardening of the body, as in a scene; none: the body is elastic.
    law : mapping, optional
        Further fields of its law.
    regions : sequence of mappings
        See `Problem`.
    path : sequence of float
        See `Problem`.
    body : mapping
        Elastic constants, radius of the sphere and load.
    stop, quick : int, bool
        See `PlasticCase`, and `Case`.
    """
    edges = [edge for region in regions for edge in _edges(region)]
    parameters: dict[str, Any] = {
        **body,
        "path": list(path),
        "law": {**({"hardening": [dict(one) for one in hardening]} if hardening else {}), **(law or {})} or None,
        "regions": [dict(region) for region in regions],
        "fine": _FINE,
        "extent": _EXTENT,
        "reach": _REACH,
        "growth": _GROWTH,
        "divisions": list(_DIVISIONS),
    }
    return PlasticCase(
        subject=KEY,
        name=name,
        title=words,
        parameters=parameters,
        quick=quick,
        profiles=_profiles(path, edges),
        ratio=2.0,
        stop=stop,
    )


def _edges(region: Mapping[str, Any]) -> tuple[float, float]:
    """Depths at which the axis enters and leaves a region."""
    if region["kind"] == "ball":
        return region["depth"] - region["radius"], region["depth"] + region["radius"]
    return region["top"], region["bottom"]


def _profiles(path: Sequence[float], edges: Sequence[float]) -> tuple[Profile, ...]:
    """Depth of every increment, pressure at the largest load, and what stays: surface, strain and stress below it.

    Points on the axis are middles of the finest cells.
    """
    r, z = np.linspace(0.0, 1.4, 15), (np.arange(4, 30) + 0.5) / 12
    z = z[np.all(np.abs(z[:, None] - np.asarray([-1.0, *edges])) > _MARGIN, axis=1)]
    inner, number = np.linspace(0.0, 0.45, 10), np.arange(1.0, len(path) + 1.0)

    def line(name: str, quantity: Any, x: FloatArray, depth: FloatArray, along: FloatArray, **rest: Any) -> Profile:
        points = np.stack([x, 0 * x, depth], axis=1)
        return Profile(name=name, quantity=quantity, points=points, along=along, formal_order=2.0, **rest)

    shift, stress, below = "a²/R", "p0", "depth [a]"
    away = "distance from the axis [a]"
    return (
        line(
            "depth", "displacement", 0 * number, 0 * number, number, label="step [1]", components=("u_z",), unit=shift
        ),
        line("pressure", "stress", inner, 0 * inner, inner, label=away, components=("s_zz",), unit=stress),
        line("print", "displacement", r, 0 * r, r, label=away, components=("u_z",), unit=shift),
        line("axis-strain", "strain", 0 * z, z, z, label=below, components=("e_p",), unit="1"),
        line("axis-stress", "stress", 0 * z, z, z, label=below, components=("s_xx", "s_zz"), unit=stress),
    )


def _perfect(stress: float) -> dict[str, Any]:
    return {"type": "perfect", "yield_stress": stress}


def plastic_cases() -> tuple[PlasticCase, ...]:
    """All cases: every hardening law, damage, layers, inclusions, prior stress, cycles."""
    swift = {"type": "swift", "B": 1240e6, "C": 30.0, "n": 0.085}
    linear = {"type": "linear", "yield_stress": 2.5e9, "modulus": 30e9}
    softer = {"young_modulus": 0.8}
    stiff = {"kind": "ball", "depth": 1.3, "radius": 0.4, "young_modulus": 2.0}
    fading = {"type": "exponential", "saturation": 0.4, "strain": 0.02}

    def back(modulus: float, recovery: float) -> dict[str, Any]:
        return {"type": "armstrong-frederick", "modulus": modulus, "recovery": recovery}

    chaboche = (_perfect(1.5e9), back(200e9, 100.0), back(40e9, 20.0))
    return (
        plastic_case("perfect", "perfectly plastic", _perfect(3e9), quick=True),
        plastic_case("linear", "linear hardening", linear),
        plastic_case("swift", "Swift's hardening", swift),
        plastic_case(
            "ludwik", "Ludwik's hardening", {"type": "ludwik", "yield_stress": 2.5e9, "strength": 6e9, "n": 0.4}
        ),
        plastic_case(
            "voce", "Voce's hardening", {"type": "voce", "yield_stress": 2.5e9, "saturation": 1e9, "rate": 80.0}
        ),
        plastic_case(
            "tabulated",
            "hardening by a table",
            {"type": "tabulated", "strain": [0.0, 0.005, 0.02], "stress": [2.5e9, 2.9e9, 3.2e9]},
        ),
        plastic_case(
            "prager",
            "Prager's hardening, loaded twice",
            _perfect(1.8e9),
            {"type": "prager", "modulus": 40e9},
            path=_CYCLED,
            quick=True,
        ),
        plastic_case(
            "chaboche", "two back-stresses that fade, loaded twice by two runs", *chaboche, path=_CYCLED, stop=3
        ),
        plastic_case("damage", "perfectly plastic, with damage", _perfect(3e9), law={"damage": fading}),
        plastic_case(
            "damage-effective",
            "damage, yield on the effective stress",
            linear,
            law={"damage": fading, "yield_on": "effective"},
        ),
        plastic_case(
            "layer-yields",
            "a layer of one radius yields",
            regions=[{"kind": "layer", "top": 0.0, "bottom": 1.0, "law": {"hardening": [_perfect(3e9)]}}],
        ),
        plastic_case(
            "substrate-yields",
            "all below one radius yields",
            regions=[{"kind": "layer", "top": 1.0, "bottom": 3.0, "law": {"hardening": [_perfect(2.9e9)]}}],
        ),
        plastic_case(
            "ball-yields",
            "a ball of 0.8 E yields in an elastic body",
            regions=[{"kind": "ball", "depth": 0.7, "radius": 0.5, "law": {"hardening": [_perfect(2.5e9)]}, **softer}],
        ),
        plastic_case("stiff-ball", "an elastic ball of 2 E in a body that yields", _perfect(3e9), regions=[stiff]),
        plastic_case(
            "prior-stress",
            "a disc that expands along the surface",
            _perfect(3.5e9),
            regions=[{"kind": "disc", "top": 0.0, "bottom": 1.0, "radius": 2.0, "eigenstrain": 2e-3}],
            path=(0.0, *_PATH),
        ),
    )
