"""Loads from nothing over the first touch of one cell to a window that is full of contact."""

from __future__ import annotations

from functools import partial

import numpy as np

from eigencontact_verification.extremes.common import MODULUS, RADIUS, apart, ball, dense_error, hertz_load, off, run
from eigencontact_verification.extremes.feature import Corner, Feature, family, refusal
from eigencontact_verification.oracles.hertz import hertz_sphere

__all__ = ["FEATURE"]

COARSE = {"allow-coarse": True}


def nothing() -> float:
    """No load: no pressure, no approach."""
    result = run(ball(cells=17, steps={"normal-load": 0.0}))
    return float(np.abs(result.dataset["pressure"].values).max() + abs(result.summary["approach"]))


def one_cell(share: float) -> float:
    """A load that one cell in the middle bears alone: load / cell, and the approach by quadrature."""
    from eigencontact_verification.oracles.boussinesq import rectangle

    edge = 2e-6
    neighbour = edge**2 / (2 * RADIUS)
    compliance = rectangle("p", (0.0, 0.0, 0.0), (edge / 2, edge / 2), 0.0, MODULUS / 2)[2]
    load = share * neighbour / compliance * edge**2
    scene = ball(steps={"normal-load": load}, grid={"cells": 9, "size": [9 * edge, 9 * edge]}, numerics=COARSE)
    result = run(scene)
    expected = np.zeros((9, 9))
    expected[4, 4] = load / edge**2
    pressure = result.dataset["pressure"].values[-1]
    return max(apart(pressure, expected), off(result.summary["approach"], (load / edge**2 * compliance)))


def hertz(contact: float, size: float, cells: int) -> float:
    """Approach beside Hertz for contacts from a few cells to nearly all of the window."""
    summary = run(ball(contact, cells=cells, size=size)).summary
    _, _, approach = hertz_sphere(ball(contact)["steps"]["normal-load"], RADIUS, MODULUS)
    return off(summary["approach"], approach)


def balance(load: float) -> float:
    """Sum of the pressure beside a load so large that the window is full; bodies end at its edge."""
    scene = ball(
        steps={"normal-load": load}, grid={"cells": 16, "size": [2.6e-5, 2.6e-5]},
        numerics={"allow-contact-at-edge": True, "allow-coarse": True},
    )  # fmt: skip
    pressure = run(scene).dataset["pressure"].values[-1]
    if pressure.min() <= 0:
        return float("inf")
    turned = max(apart(pressure[::-1], pressure), apart(pressure.T, pressure))
    return max(off(float(pressure.sum()) * (2.6e-5 / 16) ** 2, load), turned)


def tilted(share: float) -> float:
    """Load and moment of the pressure beside those prescribed; the outermost column of cells bears a share of 1."""
    load, side, cells = hertz_load(1e-5), 2.6e-5, 16
    moment = share * load * 0.5 * side * (1.0 - 1.0 / cells)
    scene = ball(
        steps={"normal-load": load, "moment-y": moment}, numerics={"allow-contact-at-edge": True, "allow-coarse": True}
    )
    columns = run(scene).dataset["pressure"].values[-1].sum(axis=0) * (side / cells) ** 2
    x = (np.arange(cells) - 0.5 * (cells - 1)) * side / cells
    return max(off(columns.sum(), load), off(abs(float(columns @ x)), moment))


FULL = ball(steps={"normal-load": 1e3})

CONTACTS = {size: (1e-5, 2 / size, cells) for size, cells in ((0.1, 60), (0.5, 32), (0.96, 64))}

FEATURE = Feature(
    key="loads",
    title="Loads from first touch to a full window",
    reference="no load, one cell by itself, Hertz, equilibrium and symmetry, dense linear algebra",
    corners=(
        Corner(name="no load", error=nothing, bound=1e-300, reason="nothing touches: zero", quick=True),
        *family(
            "one cell, {:g} of what the next would bear", one_cell, (1e-9, 1e-3, 0.5), bound=1e-10, quick={1e-9},
            reason="one cell is one equation: round-off",
        ),
        *family(
            "contact of {:g} of the window", hertz, CONTACTS,
            bound=lambda _, size, cells: 0.1 * (size / cells) ** 2 + 1e-6,
            reason="second order in cells: a tenth of (cell/a)², as the README measures",
        ),
        *family(
            "full window, {:g} N", balance, (1e1, 1e3, 1e6), bound=1e-9, quick={1e3},
            reason="equilibrium is kept to round-off; symmetry is that of the equations",
        ),
        Corner(
            name="full window by an approach", error=partial(dense_error, (9, 8), (1e-6, 1e-6), 1e-6), bound=1e-7,
            reason="the same cells by dense linear algebra: the tolerance 1e-9, times their condition", quick=True,
        ),
        *family(
            "moment, {:.9g} of what the cells bear", tilted, (1e-9, 0.5, 1 - 1e-9), bound=1e-6, quick={1 - 1e-9},
            reason="certified to the tolerance",
        ),
        refusal("moment of what the cells bear", partial(tilted, 1.0), "must be smaller than", quick=True),
        refusal(
            "full window, bodies go on", lambda: run({**FULL, "numerics": COARSE}), "must stay inside the window",
            quick=True,
        ),
    ),
)  # fmt: skip
