"""Wear from next to nothing to through a coating, and to what no surface can bear."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from eigencontact_verification.extremes.common import (
    CONTACT,
    MODULUS,
    RADIUS,
    ball,
    coated,
    hertz_load,
    off,
    run,
    steel,
)
from eigencontact_verification.extremes.feature import Corner, Feature, family, refusal
from eigencontact_verification.oracles.wear_springs import sliding_limit

__all__ = ["FEATURE"]

LOAD = hertz_load()
#: Volume of the cap that the ball presses in [m³].
CAP = np.pi * CONTACT**4 / (4 * RADIUS)
FRICTION = 0.25
#: So little that the way is long: elastic shear that is let go adds a slip of its own, a part in 1e9 of the way here.
COEFFICIENT = 1e-15


def slid(volumes: float, *, increments: int = 8, size: float = 2.6, cells: int = 16, **more: Any) -> Any:
    """A ball that slides until it has worn so many volumes of the cap, on a window of `size` contact radii."""
    steps = [
        {"normal-load": LOAD},
        {
            "normal-load": LOAD,
            "sliding-distance": volumes * CAP / (FRICTION * LOAD * COEFFICIENT),
            "increments": increments,
        },
    ]
    tables: dict[str, Any] = {
        "friction": {"type": "coulomb", "coefficient": FRICTION},
        "wear": {"type": "dissipated-energy", "coefficient": COEFFICIENT},
        "numerics": {"coupling": "none"},
    }
    return run(ball(cells=cells, size=size, steps=steps) | tables | more)


def conserved(volumes: float, size: float, cells: int) -> float:
    """Worn volume beside coefficient times friction, load and way; the load beside the pressure's sum."""
    result = slid(volumes, size=size, cells=cells)
    cell = (size * CONTACT / cells) ** 2
    worn = float(result.dataset["worn_depth"].values[-1].sum()) * cell
    load = float(result.dataset["pressure"].values[-1].sum()) * cell
    return max(off(worn, (volumes * CAP)), off(load, LOAD))


def worn_flat() -> float:
    """Largest pressure after 1000 volumes beside load over area of the worn cap."""
    volumes = 1000.0
    size = 2.6 * float(sliding_limit(volumes * CAP, LOAD, RADIUS)[0]) / CONTACT
    peak = slid(volumes, size=size, increments=24, cells=96).summary["max_pressure"]
    return off(peak, float(sliding_limit(volumes * CAP, LOAD, RADIUS)[1]))


def in_one_step(volumes: float) -> float:
    """Worn volume of one increment beside that of 32: energy counts, not increments."""
    single, divided = (slid(volumes, increments=n, size=5.0).summary["worn_volume"] for n in (1, 32))
    return off(single, divided)


def next_to_nothing() -> float:
    """Volumes of 1e-20 and 1e-24 of the cap are in proportion."""
    little, less = (slid(v, increments=1).summary["worn_volume"] for v in (1e-20, 1e-24))
    return off(1e4 * less, little)


def through_cells() -> float:
    """A coating in cells, worn through where it was pressed most: the volume is that of the energy."""
    region = {
        "name": "coating", "type": "cuboid", "center": [0, 0, 2.5e-8], "edges": [6e-5, 6e-5, 5e-8],
        "material": steel(modulus=2 * MODULUS),
    }  # fmt: skip
    laws = {name: {"type": "dissipated-energy", "coefficient": COEFFICIENT} for name in ("coating", "substrate")}
    more: dict[str, Any] = {
        "inclusions": [region], "wear": {"type": "by-material", "body": 1, "laws": laws},
        "numerics": {"coupling": "none", "inclusion-pitch": 2.5e-8, "allow-coarse": True},
    }  # fmt: skip
    result = slid(3.0, size=5.0, cells=24, **more)
    exposed = result.dataset["exposed_material"].values[-1]
    if not (exposed.min() == 0 and exposed.max() == 1):
        return float("inf")
    worn = float(result.dataset["worn_depth"].values[-1].sum()) * (5.0 * CONTACT / 24) ** 2
    return off(worn, (3.0 * CAP))


def through_layers() -> object:
    """Layers are uniform in the kernels: a run ends before they differ too much."""
    return slid(2.0, size=4.0, body1=coated({"thickness": 1e-7, **steel(modulus=2 * MODULUS)}))


ENERGY = (
    "volume is coefficient times energy; extrapolation that is bounded cell by cell leaves a part of the error that "
    "a run states, of which the default allows 1e-2: a tenth of that"
)

SIZES = {volumes: (volumes, size, cells) for volumes, size, cells in ((1e-3, 2.6, 16), (1.0, 4.0, 16), (1e3, 16.0, 96))}

FEATURE = Feature(
    key="wear",
    title="Wear, through a coating and to absurd depths",
    reference="conservation, proportion, the flat that a worn ball ends in",
    corners=(
        Corner(
            name="1e-20 of the cap", error=next_to_nothing, bound=1e-6, quick=True,
            reason="proportional: the tolerance of the contact",
        ),
        *family("{:g} times the cap", conserved, SIZES, bound=1e-3, reason=ENERGY, quick={SIZES[1e-3]}),
        Corner(
            name="1000 times the cap, flat", error=worn_flat, bound=5e-3,
            reason="rings of uniform pressure come within half a percent of it at 100 volumes (case WR-9), and go on",
        ),
        Corner(name="the cap in one increment", error=partial(in_one_step, 1.0), bound=1e-3, reason=ENERGY),
        Corner(name="through a coating in cells", error=through_cells, bound=1e-3, reason=ENERGY),
        refusal("through exact layers", through_layers, "layer"),
        refusal("1e12 times the cap", lambda: slid(1e12, increments=1), "must", quick=True),
    ),
)  # fmt: skip
