"""Layers thin and thick, soft and stiff, under a ball."""

from __future__ import annotations

from functools import partial
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
    off,
    run,
    steel,
)
from eigencontact_verification.extremes.feature import Corner, Feature, family, refusal
from eigencontact_verification.oracles.coated_contact import contact_of_radius

__all__ = ["FEATURE"]

YOUNG = MODULUS * (1 - NU**2)
#: Thickness over contact radius, modulus over that of the ground.
CORNERS = (
    (0.1, 1e4), (0.1, 1e5), (0.1, 1e3), (0.1, 1e-4), (1.0, 1e5), (1.0, 1e-5), (10.0, 1e4), (10.0, 1e-4), (0.01, 10.0),
    (0.01, 0.1),
)  # fmt: skip


def scene(layers: list[dict[str, Any]], load: float) -> dict[str, Any]:
    """A rigid ball on layers."""
    return ball(cells=41, size=2.7, body=coated(*layers), steps={"normal-load": load})


def approach(thickness: float, ratio: float, nu: float = NU) -> float:
    """Approach beside that of the integral equation of the coated contact."""
    layer = (thickness * CONTACT, ratio * YOUNG, nu)
    contact = contact_of_radius(CONTACT, RADIUS, [layer], (YOUNG, NU))
    row = {"thickness": layer[0], "young-modulus": layer[1], "poisson-ratio": nu}
    summary = run(scene([row], contact.load)).summary
    return off(summary["approach"], contact.approach)


def in_parts(count: int) -> float:
    """Approach on a layer cut into so many beside the one layer."""
    whole = {"thickness": 5e-6, **steel(modulus=2 * MODULUS)}
    load = hertz_load()
    approaches = [run(scene([{**whole, "thickness": 5e-6 / n}] * n, load)).summary["approach"] for n in (count, 1)]
    return off(approaches[0], approaches[1])


def all_but_none(thickness: float) -> float:
    """Pressure on a thin layer of twice the stiffness beside that on none."""
    load = hertz_load()
    layer = {"thickness": thickness * CONTACT, **steel(modulus=2 * MODULUS)}
    bare = {**scene([layer], load), "body1": steel()}
    return apart(run(scene([layer], load)).dataset["pressure"].values, run(bare).dataset["pressure"].values)


CELLS = "second order in cells of a/15: a tenth of (1/15)², as the README measures, doubled for what a layer adds"

FEATURE = Feature(
    key="layers",
    title="Thin, thick, soft and stiff layers",
    reference="the integral equation of the coated contact; a layer cut into parts",
    corners=(
        *family(
            "thickness {:g} a, contrast {:g}", approach, CORNERS, bound=1e-3, reason=CELLS, quick={(0.1, 1e4)}
        ),
        *family(
            "incompressible, thickness {:g} a, contrast {:g}", approach, ((1.0, 1e-2, 0.5), (0.1, 1e2, 0.5)),
            bound=1e-3, reason=CELLS,
        ),
        *family(
            "thickness {:g} a beside none", all_but_none, (1e-3, 1e-5), bound=lambda thickness: 20 * thickness,
            reason="a layer moves the surface by a part h/a, some ten times that in cells",
        ),
        Corner(
            name="one layer cut into 30", error=partial(in_parts, 30), bound=2e-5,
            reason="tables of layers are computed until two resolutions agree to 1e-5, on both sides",
        ),
        refusal(
            "thickness of 1e-12 of the window", lambda: run(scene([{"thickness": 1e-17, **steel()}], 1.0)),
            "thickness", quick=True,
        ),
        refusal("no thickness", lambda: run(scene([{"thickness": 0.0, **steel()}], 1.0)), "thickness", quick=True),
    ),
)  # fmt: skip
