"""Stiffness ratios from 0 to 1e6 and beyond: partners, inclusions and layers, from nothing to rigid."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from eigencontact_verification.extremes.common import MODULUS, NU, apart, ball, off, run, steel
from eigencontact_verification.extremes.feature import Corner, Feature, family
from eigencontact_verification.oracles.eshelby_sphere import isotropic_stiffness, sphere_in_body

__all__ = ["FEATURE"]


def partner(ratio: float) -> float:
    """Two elastic bodies beside one of their joint contact modulus."""
    first, second = MODULUS * (1.0 + ratio), MODULUS * (1.0 + 1.0 / ratio)
    two = run(ball(body=steel(modulus=first), body2=steel(0.2, second))).dataset["pressure"].values
    return apart(two, run(ball()).dataset["pressure"].values)


PRESTRAIN = np.diag([1e-3, 0.0, -5e-4])


def ball_in_full_space(ratio: float, resolution: str, points: list[list[float]]) -> Any:
    """Stress at points, about a ball of radius 1e-4 with a prestrain in a body without a surface."""
    material = {"young-modulus": ratio * MODULUS, "poisson-ratio": 0.25}
    region = {"type": "sphere", "center": DEEP, "radius": 1e-4, "material": material, "eigenstrain": PRESTRAIN.tolist()}
    scene = {
        "body1": {"young-modulus": MODULUS, "poisson-ratio": NU},
        "inclusions": [region],
        "grid": {"cells": 25, "size": [2.4e-4, 2.4e-4]},
        "numerics": {"half-space": "full-space", "inclusion-resolution": resolution},
        "stress": [{"name": "at", "shape": "points", "points": points}],
        "output": {"pictures": False},
    }
    return run(scene).dataset["at_stress"].values[-1]


DEEP = [0.0, 0.0, 1e-3]
OUTSIDE = [[1.6e-4, 2e-5, 1e-3], [0.0, 1e-4, 1.12e-3], [8e-5, -9e-5, 9e-4], [0.0, 0.0, 1.25e-3]]


def in_one(ratio: float) -> float:
    """Stress in a whole ball beside Eshelby."""
    expected, _ = sphere_in_body(isotropic_stiffness(ratio * MODULUS, 0.25), MODULUS, NU, np.zeros((3, 3)), PRESTRAIN)
    stress = ball_in_full_space(ratio, "whole", [DEEP, [2e-5, -3e-5, 9.6e-4]])[:3]
    return float(np.abs(stress - np.diag(expected)[:, None]).max() / np.abs(expected).max())


def in_cells(ratio: float) -> float:
    """Stress about a ball in cells beside that about a whole one."""
    field, right = (ball_in_full_space(ratio, resolution, OUTSIDE) for resolution in ("cells", "whole"))
    return apart(field, right)


def same_material(cells: int) -> float:
    """A region of the body's own constants under a contact beside none."""
    region = {"type": "sphere", "center": [0.0, 0.0, 6e-6], "radius": 4e-6, "material": steel()}
    tight: dict[str, Any] = {"numerics": {"tolerance": 1e-10}}
    pressure = run(ball(cells=cells, inclusions=[region], **tight)).dataset["pressure"].values
    return apart(pressure, run(ball(cells=cells, **tight)).dataset["pressure"].values)


def rigid_limit() -> float:
    """A ball of 1e6 times the stiffness beside one of 1e4: the difference falls with 1/ratio."""

    def pressure(ratio: float) -> Any:
        material = {"young-modulus": ratio * MODULUS * (1 - NU**2), "poisson-ratio": NU}
        region = {"type": "sphere", "center": [0.0, 0.0, 6e-6], "radius": 4e-6, "material": material}
        return run(ball(inclusions=[region])).dataset["pressure"].values

    return apart(pressure(1e6), pressure(1e4))


def balance(ratio: float) -> float:
    """Load that the pressure carries over a void or a rigid ball, beside the one prescribed."""
    material = {"young-modulus": ratio * MODULUS, "poisson-ratio": NU} if ratio else {"void": True}
    region = {"type": "sphere", "center": [0.0, 0.0, 6e-6], "radius": 4e-6, "material": material}
    result = run(ball(inclusions=[region]))
    summary = result.summary
    carried = float(result.dataset["pressure"].values[-1].sum()) * (2.6e-5 / 16) ** 2
    residuals = (float(summary[name]) for name in ("coupling_residual", "inclusion_residual"))
    return max(off(carried, ball()["steps"]["normal-load"]), *residuals)


MIRROR = "the same equation with the compliances summed in another order: round-off"
ESHELBY = "one eigenstrain is exact for a ball: the tolerance of the iteration, 1e-6"

FEATURE = Feature(
    key="stiffness",
    title="Stiffness ratios from 0 to 1e6",
    reference="the joint contact modulus, Eshelby's ball, a region of the body's own constants, equilibrium",
    corners=(
        *family("elastic partner, ratio {:g}", partner, (1e-6, 1e6, 1e12), bound=1e-9, reason=MIRROR, quick={1e6}),
        *family("ball in full space, whole, ratio {:g}", in_one, (1e-6, 1e6), bound=2e-6, reason=ESHELBY, quick={1e6}),
        *family(
            "about a ball in cells, ratio {:g}", in_cells, (1e-2, 2.0, 1e2, 1e6), bound=0.02,
            reason="ten cells a radius, those of the boundary cut: two parts in a hundred, as the README states",
        ),
        Corner(
            name="region like the body under contact", error=partial(same_material, 16), bound=1e-9,
            reason="nothing to solve for: the tolerance 1e-10 of the contact",
        ),
        *family(
            "ball below a contact, ratio {:g}", balance, (0.0, 1e-6, 1e6), bound=1e-6,
            reason="equilibrium and the certified residuals of cells and coupling: the tolerance",
        ),
        Corner(
            name="ball of ratio 1e6 beside 1e4", error=rigid_limit, bound=1e-3,
            reason="the strain of a ball falls with 1/ratio: some 1e-4 of what the ball changes, twice",
        ),
    ),
)  # fmt: skip
