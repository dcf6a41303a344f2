"""Friction from 1e-6 to 10, from the first slip to gross sliding."""

from __future__ import annotations

from functools import cache
from itertools import product
from typing import Any

import numpy as np

from eigencontact_verification.extremes.common import (
    CONTACT,
    NU,
    RADIUS,
    apart,
    ball,
    coated,
    hertz_load,
    off,
    run,
    steel,
)
from eigencontact_verification.extremes.feature import Feature, family, refusal
from eigencontact_verification.oracles import cattaneo
from eigencontact_verification.oracles.coated_contact import contact_of_radius

__all__ = ["FEATURE"]


@cache
def sheared(friction: float, ratio: float, coupling: str = "none", cells: int = 24) -> Any:
    """Pressed, then pulled to this part of what friction carries."""
    load = hertz_load()
    steps = [{"normal-load": load}, {"normal-load": load, "tangential-load-x": ratio * friction * load}]
    return run(
        ball(
            cells=cells, friction={"type": "coulomb", "coefficient": friction}, steps=steps,
            numerics={"coupling": coupling, "tolerance": 1e-8},
        )
    ).dataset  # fmt: skip


def in_proportion(friction: float, ratio: float) -> float:
    """Shear over μ beside that of μ = 1/2: with displacements apart the equations are the same."""
    shear, reference = (sheared(mu, ratio)["shear_x"].values[-1] / mu for mu in (friction, 0.5))
    return apart(shear, reference)


def shift(friction: float, ratio: float, cells: int = 24) -> float:
    """Shift beside Cattaneo and Mindlin."""
    body = steel()
    compliance = (2.0 - NU) / (body["young-modulus"] / (2 * (1 + NU)))
    full = cattaneo.shift_of_sliding(friction, hertz_load(), CONTACT, compliance)
    computed = float(sheared(friction, ratio, cells=cells)["shift_x"][-1])
    return abs(computed / (full * float(cattaneo.shift_of_load(ratio))) - 1.0)


def limits(friction: float, ratio: float) -> float:
    """Shear beyond what friction carries, or a force missed, with all displacements coupled."""
    data = sheared(friction, ratio, "full")
    shear = np.hypot(data["shear_x"].values[-1], data["shear_y"].values[-1])
    pressure = data["pressure"].values[-1]
    force = float(data["shear_x"].values[-1].sum()) * (2.6 * CONTACT / 24) ** 2
    pull = ratio * friction * hertz_load()
    return max(float((shear - friction * pressure).max() / (friction * pressure.max())), off(force, pull))


def plate(contrast: float, coupling: str) -> float:
    """Coulomb's bound and the force on a layer of a tenth of the contact radius, so many times as stiff."""
    young = steel()["young-modulus"]
    load = contact_of_radius(CONTACT, RADIUS, [(CONTACT / 10, contrast * young, NU)], (young, NU)).load
    body = coated({"thickness": CONTACT / 10, "young-modulus": contrast * young, "poisson-ratio": NU})
    steps = [{"normal-load": load}, {"normal-load": load, "tangential-load-x": 0.1 * load}]
    friction = {"type": "coulomb", "coefficient": 0.2}
    scene = ball(cells=31, size=2.7, body=body, friction=friction, steps=steps, numerics={"coupling": coupling})
    data = run(scene).dataset
    shear, pressure = data["shear_x"].values[-1], data["pressure"].values[-1]
    excess = float((np.hypot(shear, data["shear_y"].values[-1]) - 0.2 * pressure).max() / pressure.max())
    return max(excess, off(float(shear.sum()) * (2.7 * CONTACT / 31) ** 2, 0.1 * load))


CELLS = "second order in cells of a/9, and the edge of stick within a cell: (1/9)²/2"

FEATURE = Feature(
    key="friction",
    title="Friction coefficients from 1e-6 to 10",
    reference="Cattaneo and Mindlin, proportion to μ, Coulomb's bound and the prescribed force",
    corners=(
        *family(
            "shear over μ, μ = {:g}, {:g} of sliding", in_proportion, product((1e-6, 10.0), (1e-3, 0.5, 0.999)),
            bound=1e-6, quick={(1e-6, 0.5)},
            reason="scaled equations: a hundred times the tolerance of 1e-8, as edge cells change sides",
        ),
        *family(
            "shift, μ = {:g}, {:g} of sliding", shift, product((1e-6, 10.0), (0.5, 0.999)), bound=6e-3, reason=CELLS
        ),
        *family(
            "Coulomb's bound and force, full coupling, μ = {:g}, {:g} of sliding", limits,
            ((1e-6, 0.5), (1e-6, 0.999), (1e-2, 0.999), (10.0, 0.02)), bound=1e-7,
            reason="certified to the tolerance of 1e-8, tenfold",
        ),
        *family(
            "thin layer, contrast {:g}, coupling {}", plate, product((1e3, 1e5), ("partial", "full")), bound=1e-6,
            reason="certified to the tolerance",
        ),
        refusal("force beyond friction", lambda: sheared(0.5, 1.001), "friction", quick=True),
    ),
)  # fmt: skip
