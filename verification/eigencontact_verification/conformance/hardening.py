"""Checks of hardening and damage laws: a curve over strain with its slope, in range, the same each time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import DamageLaw, IsotropicHardening, KinematicHardening
from eigencontact_verification.conformance.report import check, ensure, fail

FloatArray = NDArray[np.float64]
Curve = Callable[[FloatArray], tuple[FloatArray, FloatArray]]

#: Strains: zero, and nine decades up to 3.
_STRAINS = np.concatenate([[0.0], np.geomspace(1e-8, 3.0, 60)])
#: Step of differences as a part of the strain, and what they may differ by, in parts of the steepest chord so far.
_STEP, _ALLOWED = 1e-4, 1e-3


def _curve(law: Any) -> tuple[str, Curve]:
    """Name and method of the curve of a law."""
    for kind, name in ((IsotropicHardening, "flow_stress"), (KinematicHardening, "recall"), (DamageLaw, "damage")):
        if isinstance(law, kind):
            return name, getattr(law, name)
    expected = "IsotropicHardening, KinematicHardening, PlasticDamage or StrainDamage"
    return fail("the class", f"a {expected}", type(law).__name__, "derive from one")


@check
def check_curve_arrays(law: Any) -> None:
    """Value and slope of every strain: float64 of the shape of the strains, finite, also of none."""
    name, curve = _curve(law)
    for count in (0, 1, len(_STRAINS)):
        answers = curve(_STRAINS[:count])
        ensure(
            isinstance(answers, tuple) and len(answers) == 2, name, "a pair: value, slope", type(answers).__name__, ""
        )
        for quantity, values in zip(("value", "slope"), answers, strict=True):
            good = isinstance(values, np.ndarray) and values.shape == (count,) and values.dtype == np.float64
            got = f"{getattr(values, 'dtype', type(values))} of shape {np.shape(values)}"
            advice = "np.full_like(p, ...) makes a constant"
            ensure(good, f"{quantity} of {name}", f"float64 of shape ({count},)", got, advice)
            ensure(np.all(np.isfinite(values)), f"{quantity} of {name}", "finite", "not", "look at p = 0: give a limit")


@check
def check_curve_range(law: Any) -> None:
    """Flow stress positive; recall 1 at zero, then in (0, 1]; damage 0 at zero, never falling, below 1."""
    name, curve = _curve(law)
    values = curve(_STRAINS)[0]
    if name == "flow_stress":
        ensure(np.all(values > 0), name, "positive", values.min(), "let softening end at a small stress")
        return
    first = 1.0 if name == "recall" else 0.0
    ensure(values[0] == first, f"{name} at zero", f"{first:g}", values[0], "nothing has happened yet")
    if name == "recall":
        ensure(np.all((values > 0) & (values <= 1)), name, "in (0, 1]", (values.min(), values.max()), "")
        ensure(law.modulus >= 0, "modulus", "zero or positive [Pa]", law.modulus, "")
    else:
        ensure(np.all((values >= 0) & (values < 1)), name, "in [0, 1)", (values.min(), values.max()), "")
        ensure(np.all(np.diff(values) >= 0), name, "never falling", np.diff(values).min(), "damage does not heal")


@check
def check_curve_slope(law: Any) -> None:
    """The slope is the derivative; at a kink that of one side."""
    name, curve = _curve(law)
    at = _STRAINS[1:]
    value, slope = curve(at)
    sides = [(curve(at * (1 + sign * _STEP))[0] - value) / (sign * _STEP * at) for sign in (1, -1)]
    chord = np.abs(value - curve(np.zeros(1))[0]) / at
    size = np.abs(slope) + np.max(np.abs(sides), axis=0) + chord + np.abs(value) * 1e-9 / (_STEP * at)
    error = np.min([np.abs(slope - side) for side in sides], axis=0) / np.where(size > 0, size, 1.0)
    worst = int(np.argmax(error))
    ensure(
        error[worst] <= _ALLOWED, f"slope of {name} at {at[worst]:.2g}", f"the derivative, {sides[0][worst]:.6g}",
        f"{slope[worst]:.6g}", "differentiate by strain, not microstrain; next to 0 np.expm1 and np.log1p keep digits",
    )  # fmt: skip


@check
def check_curve_pure(law: Any) -> None:
    """Same answer twice and point by point; strains untouched, and read-only."""
    name, curve = _curve(law)
    strains = _STRAINS.copy()
    strains.flags.writeable = False
    first = [np.array(array) for array in curve(strains)]
    curve(2.0 * strains)
    for quantity, once, again in zip(("value", "slope"), first, curve(strains), strict=True):
        ensure(
            np.array_equal(once, again), f"{quantity} of {name} asked twice", "the same", "different", "keep no memory"
        )
    for point in range(0, len(strains), 7):
        single = curve(strains[point : point + 1])
        for quantity, array, value in zip(("value", "slope"), first, single, strict=True):
            equal = np.allclose(array[point], value[0], rtol=1e-12, atol=0.0)
            advice = "no `if` on arrays, no maximum over all"
            ensure(equal, f"{quantity} of {name} of one strain", "that among many", value[0], advice)
