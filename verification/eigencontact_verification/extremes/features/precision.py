"""Single precision beside double."""

from __future__ import annotations

from typing import Any

from eigencontact_verification.extremes.common import (
    CONTACT,
    MODULUS,
    NU,
    RADIUS,
    apart,
    ball,
    coated,
    hertz_load,
    run,
    steel,
)
from eigencontact_verification.extremes.feature import Feature, family, refusal
from eigencontact_verification.oracles.coated_contact import contact_of_radius

__all__ = ["FEATURE"]

LOAD = hertz_load()
YOUNG = MODULUS * (1 - NU**2)
FRICTION: dict[str, Any] = {
    "friction": {"type": "coulomb", "coefficient": 0.3},
    "steps": [{"normal-load": LOAD}, {"normal-load": LOAD, "tangential-load-x": 0.15 * LOAD}],
}
GRAIN = {
    "inclusions": [{"type": "sphere", "center": [0, 0, 6e-6], "radius": 4e-6, "material": steel(modulus=2 * MODULUS)}]
}


def medium(thickness: float, ratio: float) -> dict[str, Any]:
    """A layer of so many times the stiffness."""
    return coated({"thickness": thickness, **steel(modulus=ratio * MODULUS)})


def beside_double(model: str, cells: int) -> float:
    """Largest pressure and approach of single precision beside double, both at the same tolerance."""
    tables = {"cells": cells, **MODELS[model]}
    results = [
        run(ball(**{**tables, "numerics": {"precision": name, **tables.get("numerics", {})}})).summary
        for name in ("single", "double")
    ]
    if results[0] == results[1]:
        return float("inf")
    return max(apart(results[0][key], results[1][key]) for key in ("max_pressure", "approach", "contact_radius"))


def thin_and_stiff() -> object:
    """A layer of a tenth of the contact at a contrast of 1e4: too ill-conditioned for 24 bits."""
    load = contact_of_radius(CONTACT, RADIUS, [(CONTACT / 10, 1e4 * YOUNG, NU)], (YOUNG, NU)).load
    return run(
        ball(
            cells=63,
            size=2.7,
            body=medium(CONTACT / 10, 1e4),
            steps={"normal-load": load},
            numerics={"precision": "single"},
        )
    )


def bound(cells: int) -> float:
    """A gap of the tolerance 1e-6 of the deflection, left in one cell, is 1e-6 (π/2) a/cell of its pressure, twice."""
    return 2e-6 * 1.571 * cells / 2.6


REASON = "the tolerance 1e-6 in a single cell, (π/2) a/cell of it as pressure, in both"

MODELS: dict[str, dict[str, Any]] = {
    "contact": {}, "friction": {**FRICTION, "numerics": {"coupling": "none"}}, "grain": GRAIN,
    "coating": {"body": medium(5e-6, 2.0)},
}  # fmt: skip

FEATURE = Feature(
    key="precision",
    title="Single precision",
    reference="double precision at the same tolerance",
    corners=(
        *family(
            "{}, {} x {} cells", beside_double,
            {(name, n, n): (name, n) for name, n in
             (("contact", 16), ("contact", 512), ("friction", 24), ("grain", 16), ("coating", 16))},
            bound=lambda _, cells: bound(cells), reason=REASON, quick={("contact", 16)},
        ),
        refusal(
            "tolerance 1e-9", lambda: run(ball(numerics={"precision": "single", "tolerance": 1e-9})),
            "use double precision", quick=True,
        ),
        refusal("thin layer, contrast 1e4", thin_and_stiff, "use double precision"),
        refusal(
            "friction, all coupled, tolerance 1e-6",
            lambda: run(ball(cells=24, numerics={"precision": "single"}, **FRICTION)), "use double precision",
        ),
    ),
)  # fmt: skip
