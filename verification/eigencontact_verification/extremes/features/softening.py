"""Laws that lose strength: from perfectly plastic to what has no unique answer.

A cell in an elastic body gives way to its own plastic strain by 3 G (1 - β), β = 2 (4 - 5ν) / (15 (1 - ν)) that of
Eshelby's ball: -1.57 G at ν = 0.3. A law that falls faster has no unique answer in a single cell.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from eigencontact_verification.extremes.common import apart, run
from eigencontact_verification.extremes.feature import Corner, Feature, family, refusal

__all__ = ["FEATURE"]

YOUNG, NU, SIDE = 18.6e9, 0.3, 0.54e-6
SHEAR = YOUNG / (2 * (1 + NU))
YIELD = 1e8


def bone(hardening: dict[str, Any], *, cells: int = 8, damage: dict[str, Any] | None = None, **more: Any) -> Any:
    """A ball of 2 um on bone under 10 uN."""
    law = {
        "type": "j2",
        "hardening": hardening,
        **({} if damage is None else {"damage": damage, "yield-on": "effective"}),
    }
    return run(
        {
            "body1": {"young-modulus": YOUNG, "poisson-ratio": NU, "law": law},
            "geometry": {"type": "sphere", "radius": 2e-6},
            "grid": {"cells": cells, "size": [SIDE, SIDE]},
            "steps": {"normal-load": 1e-5},
            "numerics": {"inclusion-pitch": SIDE / cells, "allow-coarse": True, "tolerance": 1e-5},
            "output": {"pictures": False},
            **more,
        }
    )


def softer(fraction: float) -> dict[str, Any]:
    """Linear softening of this part of the shear modulus, down to half of the strength."""
    return {"type": "linear", "yield-stress": YIELD, "modulus": -fraction * SHEAR, "least-stress": 0.5 * YIELD}


PERFECT = {"type": "perfect", "yield-stress": YIELD}


def certified(hardening: dict[str, Any], damage: dict[str, Any] | None = None) -> float:
    """Largest of the residuals that a run states: of contact, cells, coupling, and of the law itself."""
    result = bone(hardening, damage=damage)
    names = ("gap_residual", "coupling_residual", "inclusion_residual", "law_residual")
    flow = result.dataset["plastic_strain_1"].values[-1]
    volume = float(np.abs(flow[:3].sum(axis=0)).max() / np.abs(flow).max())
    return max(volume, *(float(result.summary[name]) for name in names))


def turned(fraction: float) -> float:
    """Pressure beside its mirror images: softening must not break the symmetry of the scene."""
    pressure = bone(softer(fraction)).dataset["pressure"].values[-1]
    return max(apart(pressure[::-1], pressure), apart(pressure[:, ::-1], pressure), apart(pressure.T, pressure))


def never() -> float:
    """A yield stress out of reach beside the elastic body: the same bits."""
    out_of_reach = bone({"type": "perfect", "yield-stress": 1e4 * YIELD}).dataset["pressure"].values
    elastic = bone(PERFECT, body1={"young-modulus": YOUNG, "poisson-ratio": NU}).dataset["pressure"].values
    return apart(out_of_reach, elastic)


LIMIT = 3 * (1 - 2 * (4 - 5 * NU) / (15 * (1 - NU)))
BRITTLE = {"type": "exponential", "saturation": 0.9, "strain": 0.0035}
FADING = {"type": "exponential", "saturation": 0.6, "strain": 0.02}
CERTIFIED = "certificates within the tolerance"

FEATURE = Feature(
    key="softening",
    title="Softening laws",
    reference="certified residuals, flow without volume, symmetry, the elastic body",
    corners=(
        Corner(name="yield stress out of reach", error=never, bound=1e-300, reason="an elastic run, bit for bit"),
        *family("perfectly plastic", certified, [(PERFECT,)], bound=1e-5, reason=CERTIFIED, quick=True),
        *family(
            "softening of -{:.3g} G", certified, {ratio: softer(ratio) for ratio in (0.1, 1.0, 0.98 * LIMIT)},
            bound=1e-5, reason=CERTIFIED,
        ),
        Corner(
            name="symmetry, softening of -1 G", error=partial(turned, 1.0), bound=1e-3,
            reason="the tolerance 1e-5, a hundred times: softening amplifies a residual",
        ),
        *family(
            "damage {}", certified,
            {"of the effective stress": (PERFECT, FADING),
             "that falls like -3.6 G, with a length": (PERFECT, {**BRITTLE, "length": 9e-8})},
            bound=2e-5, reason="the tolerance 1e-5 is of a norm over all cells; the worst cell's law may miss more",
        ),
        refusal(f"softening of -{1.02 * LIMIT:.3g} G", lambda: bone(softer(1.02 * LIMIT)), "no unique answer"),
        refusal("damage that falls like -3.6 G, no length", lambda: bone(PERFECT, damage=BRITTLE), "no unique answer"),
    ),
)  # fmt: skip
