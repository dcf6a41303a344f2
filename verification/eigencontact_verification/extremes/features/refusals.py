"""Input that has no meaning: each is refused with one clear message, before anything is computed."""

from __future__ import annotations

from typing import Any

from eigencontact_verification.extremes.common import ball, run, steel
from eigencontact_verification.extremes.feature import Corner, Feature, refusal

__all__ = ["FEATURE"]


def without(words: str, **changes: Any) -> Corner:
    """Corner of the ball with these tables replaced; the name is the fault."""
    return refusal(words, lambda: run(ball(**changes)), CORNERS[words][0], quick=True)


#: Words of the message and tables by fault.
CORNERS: dict[str, tuple[str, dict[str, Any]]] = {
    "modulus NaN": ("young-modulus", {"body": {"young-modulus": float("nan"), "poisson-ratio": 0.3}}),
    "modulus infinite": ("young-modulus", {"body": {"young-modulus": float("inf"), "poisson-ratio": 0.3}}),
    "modulus negative": ("young-modulus", {"body": {"young-modulus": -1.0, "poisson-ratio": 0.3}}),
    "modulus zero": ("young-modulus", {"body": {"young-modulus": 0.0, "poisson-ratio": 0.3}}),
    "radius zero": ("radius", {"geometry": {"type": "sphere", "radius": 0.0}}),
    "radius of 1e300 m": ("radius", {"geometry": {"type": "sphere", "radius": 1e300}}),
    "window of no width": ("size", {"grid": {"cells": 8, "size": [0.0, 1e-5]}}),
    "window of 1e-200 m": ("size", {"grid": {"cells": 8, "size": [1e-200, 1e-200]}}),
    "load negative": ("normal-load", {"steps": {"normal-load": -1.0}}),
    "load NaN": ("normal-load", {"steps": {"normal-load": float("nan")}}),
    "tolerance zero": ("tolerance", {"numerics": {"tolerance": 0.0}}),
    "tolerance below round-off": ("tolerance", {"numerics": {"tolerance": 1e-20}}),
    "friction negative": ("coefficient", {"friction": {"type": "coulomb", "coefficient": -0.1}}),
    "friction infinite": ("coefficient", {"friction": {"type": "coulomb", "coefficient": float("inf")}}),
    "body without constants": ("young-modulus", {"body": {}}),
    "two rigid bodies": ("rigid", {"body": {"rigid": True}}),
    "unknown key": ("youngs-modulus", {"body": {**steel(), "youngs-modulus": 1.0}}),
    "unknown shape": ("spere", {"geometry": {"type": "spere", "radius": 1.0}}),
    "ball above the surface": (
        "surface", {"inclusions": [{"type": "sphere", "center": [0, 0, 0.0], "radius": 1e-6, "eigenstrain": 1e-3}]},
    ),
    "eigenstrain infinite": (
        "finite",
        {"inclusions": [{"type": "sphere", "center": [0, 0, 1e-5], "radius": 1e-6, "eigenstrain": float("inf")}]},
    ),
    "coarse cells": ("allow-coarse", {"cells": 3, "size": 8.0}),
}  # fmt: skip

FEATURE = Feature(
    key="refusals",
    title="Input without meaning",
    reference="one clear message that names field, rule and value",
    corners=tuple(without(words, **changes) for words, (_, changes) in CORNERS.items()),
)
