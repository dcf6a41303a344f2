"""Scales from nanometres to kilometres and moduli from jelly to beyond diamond: powers of two change no digit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from eigencontact_verification.extremes.common import (
    CONTACT,
    MODULUS,
    NU,
    RADIUS,
    apart,
    coated,
    hertz_load,
    run,
    steel,
)
from eigencontact_verification.extremes.feature import Feature, family

__all__ = ["FEATURE"]


def scene(length: float, stiffness: float, extra: Callable[[float, float], dict[str, Any]]) -> dict[str, Any]:
    """The ball with lengths and moduli times these factors."""
    load = hertz_load() * length**2 * stiffness
    return {
        "body1": steel(modulus=MODULUS * stiffness),
        "geometry": {"type": "sphere", "radius": RADIUS * length},
        "grid": {"cells": 16, "size": [2.6 * CONTACT * length] * 2},
        "steps": {"normal-load": load},
        "output": {"pictures": False},
        **extra(length, stiffness),
    }


def plain(_length: float, _stiffness: float) -> dict[str, Any]:
    """Nothing more."""
    return {}


def friction(length: float, stiffness: float) -> dict[str, Any]:
    """Pulled to half of what friction carries."""
    load = hertz_load() * length**2 * stiffness
    steps = [{"normal-load": load}, {"normal-load": load, "tangential-load-x": 0.1 * load}]
    return {"friction": {"type": "coulomb", "coefficient": 0.2}, "steps": steps}


def coating(length: float, stiffness: float) -> dict[str, Any]:
    """A coating of twice the stiffness."""
    layer = {"thickness": 5e-6 * length, **steel(modulus=2 * MODULUS * stiffness)}
    return {"body1": coated(layer, substrate=steel(modulus=MODULUS * stiffness))}


def grain(length: float, stiffness: float) -> dict[str, Any]:
    """A ball of half the stiffness below the contact."""
    region = {
        "type": "sphere", "center": [0.0, 0.0, 6e-6 * length], "radius": 4e-6 * length,
        "material": steel(modulus=0.5 * MODULUS * stiffness),
    }  # fmt: skip
    return {"inclusions": [region]}


def yielding(_length: float, stiffness: float) -> dict[str, Any]:
    """A body that yields."""
    law = {"type": "j2", "hardening": {"type": "perfect", "yield-stress": 1.5e-3 * MODULUS * stiffness}}
    return {"body1": {**steel(NU, MODULUS * stiffness), "law": law}}


def wearing(length: float, stiffness: float) -> dict[str, Any]:
    """A body that slides and wears by a tenth of a deflection."""
    load = hertz_load() * length**2 * stiffness
    return {
        "friction": {"type": "coulomb", "coefficient": 0.25},
        "wear": {"type": "dissipated-energy", "coefficient": 1e-12 / stiffness},
        "steps": [{"normal-load": load}, {"normal-load": load, "sliding-distance": 1e-4 * length}],
        "numerics": {"coupling": "none"},
    }


MODELS = {
    "contact": plain, "friction": friction, "coating": coating, "grain": grain, "yield": yielding, "wear": wearing,
}  # fmt: skip


def scaled(model: str, lengths: int, moduli: int) -> float:
    """Pressure beside that of the scene in micrometres, both divided by their moduli."""
    length, stiffness = 2.0**lengths, 2.0**moduli
    pressure = run(scene(length, stiffness, MODELS[model])).dataset["pressure"].values / stiffness
    return apart(pressure, run(scene(1.0, 1.0, MODELS[model])).dataset["pressure"].values)


POWERS_OF_TWO = "powers of two change no digit but in logarithms and transforms, which round anew: 1e-10"
SIZES = ((-14, "ball of 60 nm, contact of 0.6 nm"), (27, "ball of 134 km, contact of 1.3 km"))

FEATURE = Feature(
    key="scales",
    title="Lengths from nanometres to kilometres, moduli from 1 kPa to 1e20 Pa",
    reference="the same scene in micrometres and gigapascals",
    corners=(
        *family(
            "{}, {}", scaled, {(model, words): (model, power, 0) for model in MODELS for power, words in SIZES},
            bound=1e-10, reason=POWERS_OF_TWO, quick={("contact", power, 0) for power, _ in SIZES},
        ),
        *family(
            "{}, moduli times 2^{}", scaled,
            {(model, power): (model, 0, power) for model in MODELS for power in (-27, 30)}, bound=1e-10,
            reason=POWERS_OF_TWO,
        ),
    ),
)  # fmt: skip
