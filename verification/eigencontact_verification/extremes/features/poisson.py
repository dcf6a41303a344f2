"""Poisson's ratio at its ends: -1 < ν, ν = 0, and bodies that keep their volume, ν = 1/2."""

from __future__ import annotations

import numpy as np

from eigencontact_verification.extremes.common import (
    CONTACT,
    MODULUS,
    NU,
    apart,
    ball,
    hertz_load,
    hot_ball,
    run,
    steel,
)
from eigencontact_verification.extremes.feature import Feature, family, refusal
from eigencontact_verification.oracles.hertz import axis_stress

__all__ = ["FEATURE"]

DEPTHS = np.array([0.1, 0.3, 0.6, 1.0, 2.0, 5.0])


def pressure_by_modulus(nu: float) -> float:
    """Pressure beside that of another Poisson's ratio and the same E/(1-ν²)."""
    pressure, reference = (run(ball(body=steel(poisson))).dataset["pressure"].values for poisson in (nu, NU))
    return apart(pressure, reference)


def stress_below_a_ball(nu: float) -> float:
    """σ_zz and σ_rr on the axis, as parts of the peak pressure, beside Hertz."""
    points = [[0.0, 0.0, z * CONTACT] for z in DEPTHS]
    scene = ball(cells=41, body=steel(nu), stress=[{"name": "axis", "shape": "points", "points": points}])
    data = run(scene).dataset
    peak = 1.5 * hertz_load(CONTACT) / (np.pi * CONTACT**2)
    along, across = axis_stress(DEPTHS, nu)
    stress = data["axis_stress"].values[-1] / peak
    return float(np.abs(stress[:3] - np.stack([across, across, along])).max())


def shear_of_pressure(nu: float) -> float:
    """Shear under a pressed ball that sticks, as a part of the pressure: β = (1-2ν)/(2(1-ν)) drives it."""
    scene = ball(body=steel(nu), friction={"type": "coulomb", "coefficient": 10.0})
    data = run(scene).dataset
    return float(np.abs(data["shear_x"].values).max() / data["pressure"].values.max())


def dilated_ball(nu: float, quantity: str) -> float:
    """Dilatation of a ball below the surface: inside, outside and in the surface, beside Davies's closed form."""
    points: list[list[float]] = [[0, 0, 0], [0.4, 0.2, 0.9], [1.9, -0.3, 1.2], [0.1, 0.2, 4.0], [3.0, 1.0, 0.0]]
    return apart(*hot_ball(1.2, points, nu, quantity))


MODULUS_ALONE = "without friction the contact knows ν by E/(1-ν²) alone: the same equations, to round-off"
CELLS = "second order in cells of a/16: (1/16)² = 4e-3"
BETA = "β = (1-2ν)/(2(1-ν)) is 0 at ν = 1/2, so that no shear is left but round-off"

CONTACTS = {"-0.999": -0.999, "0": 0.0, "1e-12": 1e-12, "1/2 - 1e-12": 0.5 - 1e-12, "1/2": 0.5}
BALLS = {
    (quantity, name): (CONTACTS[name], quantity)
    for name in ("-0.999", "0", "1/2")
    for quantity in ("displacement", "stress")
}

FEATURE = Feature(
    key="poisson",
    title="Poisson's ratio from -1 to 1/2",
    reference="Hertz, Davies (a hot ball), and contacts of the same E/(1-ν²)",
    corners=(
        *family("contact, ν = {}", pressure_by_modulus, CONTACTS, bound=1e-9, reason=MODULUS_ALONE, quick={0.5}),
        *family(
            "stress below a ball, ν = {}", stress_below_a_ball, {"0": 0.0, "1/2": 0.5}, bound=4e-3, reason=CELLS,
            quick={0.5},
        ),
        *family(
            "shear that pressure drives, ν = {}", shear_of_pressure, {"1/2 - 1e-12": 0.5 - 1e-12, "1/2": 0.5},
            bound=1e-9, reason=BETA,
        ),
        *family(
            "{} of a hot ball, ν = {}", dilated_ball, BALLS, bound=lambda nu, _: 1e-14 / (1 + nu), quick=True,
            reason="closed forms on both sides: round-off, of 1/(1+ν) where volume is all but free",
        ),
        refusal("ν = 0.5 + 1e-12", lambda: run(ball(body=steel(0.5 + 1e-12))), "poisson-ratio", quick=True),
        refusal("ν = -1", lambda: run(ball(body={"young-modulus": MODULUS, "poisson-ratio": -1.0})), "poisson-ratio"),
    ),
)  # fmt: skip
