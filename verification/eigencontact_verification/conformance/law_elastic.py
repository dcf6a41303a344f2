"""Checks of linear laws: a stiffness that stores energy, or where it is infinite, bounded factors."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import LinearLaw
from eigencontact_verification.conformance.law_questions import finite, history, law_check, law_of_points, step_at
from eigencontact_verification.conformance.report import ensure

FloatArray = NDArray[np.float64]

_ROUNDING = 1e-9
#: Shear moduli of the material around [Pa].
_AROUND = (1e6, 8e10, 1e13)


@law_check
def check_stiffness(law: Any) -> None:
    """A symmetric stiffness without negative eigenvalues gives the stress; an infinite one is refused."""
    linear = law_of_points(law, step_at())
    if not isinstance(linear, LinearLaw):
        return
    ensure(not law.variables, "variables of a linear law", "none", set(law.variables), "derive from ConstitutiveLaw")
    if not finite(law):
        _, stiff = linear.factors(_AROUND[-1])
        ensure(
            np.linalg.eigvalsh(stiff).max() >= 1.0 - _ROUNDING, "a stiffness that is refused",
            "infinite in some strain", "a finite one", "return the matrix (6, 6) or, of n points, (n, 6, 6)",
        )  # fmt: skip
        return
    stiffness = np.asarray(linear.stiffness_matrix())
    _symmetric("stiffness_matrix", stiffness, np.abs(stiffness).max(axis=(-2, -1)))
    for question, answer in history(law):
        expected = np.einsum("...ij,j...->i...", np.broadcast_to(stiffness, (question.count, 6, 6)), question.strain)
        error = np.abs(answer.stress - expected).max()
        ensure(
            error <= _ROUNDING * np.abs(expected).max(), "stress", "stiffness times strain", f"off by {error:.3g} Pa",
            "leave update to LinearLaw",
        )  # fmt: skip


@law_check
def check_factors(law: Any) -> None:
    """Factors soft = (C + 2G)^-1 and stiff = C soft are bounded and symmetric; stiff + 2 G soft is the unit matrix."""
    linear = law_of_points(law, step_at())
    if not isinstance(linear, LinearLaw):
        return
    for around in _AROUND:
        soft, stiff = (np.asarray(factor, dtype=float) for factor in linear.factors(around))
        case = f"factors({around:.0e})"
        ensure(
            soft.shape in ((6, 6), (step_at().x.size, 6, 6)) and soft.shape == stiff.shape, f"shapes of {case}",
            "(6, 6), or (n, 6, 6) of n points", f"{soft.shape} and {stiff.shape}", "return soft, stiff",
        )  # fmt: skip
        _symmetric(f"2 G soft of {case}", 2.0 * around * soft, 1.0)
        _symmetric(f"stiff of {case}", stiff, 1.0)
        error = np.abs(stiff + 2.0 * around * soft - np.eye(6)).max()
        ensure(error <= _ROUNDING, f"stiff + 2 G soft of {case}", "the unit matrix", f"off by {error:.3g}", "")
        if finite(law):
            error = np.abs(linear.stiffness_matrix() @ soft - stiff).max()
            ensure(error <= 1e-7, f"stiff of {case}", "C soft", f"off by {error:.3g}", "both are of one stiffness")


def _symmetric(subject: str, matrix: FloatArray, size: Any) -> None:
    """Refuse matrices that are not finite and symmetric, or have negative eigenvalues."""
    ensure(np.all(np.isfinite(matrix)), subject, "finite", "not", "see eigencontact.plugin.factors_of_compliance")
    skew = np.abs(matrix - matrix.swapaxes(-1, -2)).max(axis=(-2, -1))
    ensure(np.all(skew <= _ROUNDING * size), subject, "symmetric", f"off by {np.max(skew):.3g}", "energy has no curl")
    least = np.linalg.eigvalsh(0.5 * (matrix + matrix.swapaxes(-1, -2)))[..., 0]
    ensure(np.all(least >= -_ROUNDING * size), subject, "without negative eigenvalues", f"{np.min(least):.3g}", "")
