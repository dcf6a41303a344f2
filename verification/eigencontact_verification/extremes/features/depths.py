"""Depths of 1e-3 to 1e3 cells: stress below loads and sources, and sources at these depths below the surface."""

from __future__ import annotations

from typing import Any

import numpy as np

from eigencontact_verification.extremes.common import NU, apart, ball, coated, hot_ball, run, steel
from eigencontact_verification.extremes.feature import Feature, family
from eigencontact_verification.oracles.boussinesq import rectangle

__all__ = ["FEATURE"]

DEPTHS = (1e-3, 1e-1, 1.0, 1e1, 1e3)


def below_a_rectangle(depth: float, load: str) -> float:
    """Displacement and stress below a loaded square of half-width 1, beside quadrature of point forces."""
    import eigencontact as ec

    traction = {"q_x": (1, 0, 0), "q_y": (0, 1, 0), "p": (0, 0, 1)}[load]
    constants: Any = {"young_modulus": 2 * (1 + NU), "poisson_ratio": NU}
    at = [(0.2, -0.3, depth), (0.4 + 0.5 * depth, 0.1, depth)]
    moved = ec.rectangle_field(traction, (1.0, 1.0), at, **constants)
    stressed = ec.rectangle_field(traction, (1.0, 1.0), at, quantity="stress", **constants)
    worst = 0.0
    for point, u, s in zip(at, moved, stressed, strict=True):
        right = rectangle(load, point, (1.0, 1.0), NU)
        stress = s[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]
        worst = max(worst, apart(u, right[:3]), apart(stress, right[3:]))
    return worst


def dilated_ball(clearance: float, quantity: str) -> float:
    """A hot ball of radius 1 whose top is so deep, in the surface, inside and 1e3 below, beside Davies."""
    depth = 1.0 + clearance
    points = [[0, 0.3, 0], [0.7, -0.2, 0.0], [0.3, 0.1, depth], [0.2, 0.0, depth + 3]]
    field, expected = hot_ball(depth, points, NU, quantity)
    return max(apart(value, right) for value, right in zip(field, expected, strict=True))


def free_surface(clearance: float) -> float:
    """Traction that a skew eigenstrain in a cuboid leaves on the free surface, by the stress in the middle of it."""
    import eigencontact as ec

    strain = np.array([[1.0, 0.3, -0.2], [0.3, -0.5, 0.1], [-0.2, 0.1, 0.8]]) * 1e-3
    shape = ec.make("cuboid", center=(0.0, 0.0, 0.5 + clearance), edges=(1.0, 1.0, 1.0))
    at = [[0.1, 0.2, 0.0], [0.9, -0.4, 0.0], [7.0, 3.0, 0.0], [0.0, 0.0, 0.5 + clearance]]
    constants: Any = {"young_modulus": 1.0, "poisson_ratio": NU, "quantity": "stress"}
    stress = ec.inclusion_field(shape, strain, at, **constants)
    return float(np.abs(stress[:3, 2]).max() / np.abs(stress[3]).max())


def like_layers(depth: float) -> float:
    """Stress below a ball on a body cut into layers of its own constants, beside the body, so many cells deep."""
    cell = 2.6e-5 / 16
    points = [[0.0, 0.0, depth * cell], [7e-6, 2e-6, depth * cell]]
    region = {"name": "at", "shape": "points", "points": points}
    layers = coated(*({"thickness": h, **steel()} for h in (5e-6, 5e-5)))
    cut, bare = (run(ball(body=body, stress=[region], numerics={"tolerance": 1e-9})).dataset for body in (layers, None))
    return apart(cut["at_stress"].values, bare["at_stress"].values)


QUADRATURE = "closed form and quadrature, each to round-off; far below a square its own quadrature keeps the digits"

SQUARES = {(load, depth): (depth, load) for depth in DEPTHS for load in ("p", "q_x", "q_y")}
CLEARANCES = (0.0, 1e-3, 1e3)
BALLS = {(quantity, top): (top, quantity) for top in CLEARANCES for quantity in ("displacement", "stress")}

FEATURE = Feature(
    key="depths",
    title="Depths from 1e-3 to 1e3 cells",
    reference="quadrature of point forces, Davies (a hot ball), a free surface, layers that are one body",
    corners=(
        *family(
            "below a square under {}, depth {:g} half-widths", below_a_rectangle, SQUARES, bound=1e-12,
            reason=QUADRATURE, quick={(1e-3, "p"), (1e3, "p")},
        ),
        *family(
            "{} of a hot ball, top {:g} radii deep", dilated_ball, BALLS, bound=1e-11, quick=True,
            reason="closed forms on both sides: round-off",
        ),
        *family(
            "free surface over a cuboid {:g} edges deep", free_surface, CLEARANCES, bound=1e-12, quick=True,
            reason="no traction on a free surface: round-off",
        ),
        *family(
            "layers of one material, {:g} cells deep", like_layers, DEPTHS, bound=1e-5,
            reason="tables of layers are computed until two resolutions agree to 1e-5",
        ),
    ),
)  # fmt: skip
