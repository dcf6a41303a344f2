"""Comparison of numbers after ASME V&V 20: error E = S - D, uncertainties of both sides, verdict."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eigencontact.core.units import readable
from eigencontact_verification.crosscheck.judge import Row
from eigencontact_verification.reporting.verdict import MARKS, validated

__all__ = ["HEAD", "Comparison", "cells", "compared", "line"]


@dataclass(frozen=True, kw_only=True)
class Comparison(Row):
    """Number S of a run beside the number D of finite elements.

    Attributes
    ----------
    simulation, reference, error : float
        S, D, and the comparison error E = S - D.
    u_sa, u_fe, u_val : float
        Numerical uncertainty of S, which is its error bar, of D, and of E. That of the input is zero: both sides take
        the same.
    unit : str
        Unit of all these.
    """

    simulation: float
    reference: float
    error: float
    u_sa: float
    u_fe: float
    u_val: float
    unit: str


def compared(
    subject: str, case: str, name: str, words: str, *, simulation: float, reference: float, u_sa: float, u_fe: float,
    unit: str, source: str, remedy: str,
) -> Comparison:  # fmt: skip
    """Comparison of a number with its verdict.

    Parameters
    ----------
    subject, case, name, words : str
        Scene, case, number and its words.
    source : str
        Main source of `u_sa`.
    remedy : str
        Makes `u_fe` smaller.

    Examples
    --------
    >>> both = {"unit": "m", "source": "cells", "remedy": "finer meshes"}
    >>> sides = {"simulation": 1.0, "reference": 1.01, "u_sa": 0.003, "u_fe": 0.004}
    >>> number = compared("hertz", "step-1", "approach", "approach", **sides, **both)
    >>> number.word, number.reason
    ('disagrees', 'model or implementation error E ± u_val = -1 % ± 0.5 %')
    """
    scale, error, u_val = abs(simulation), simulation - reference, float(np.hypot(u_sa, u_fe))
    word, reason = validated(error / scale, u_val / scale)
    if word == "inconclusive":
        run = f"u_SA of the run (source: {source}); run the scene with finer settings"
        reason += f"; its larger part is {run if u_sa > u_fe else f'u_FE of the elements; {remedy}'}"
    return Comparison(
        subject=subject, case=case, profile=words, quantity="number", component=name, word=word,
        reason=reason, difference=abs(error) / scale, uncertainty=u_val / scale, scale=scale,
        ratio=abs(error) / u_val if u_val > 0.0 else None, simulation=simulation, reference=reference, error=error,
        u_sa=u_sa, u_fe=u_fe, u_val=u_val, unit=unit,
    )  # fmt: skip


HEAD = ("number", "run S", "elements D", "E = S − D", "u_SA", "u_FE", "u_val", "verdict", "in words")


def cells(row: Comparison) -> tuple[str, ...]:
    """Cells of the table under `HEAD`; errors and uncertainties are parts of S."""
    unit = row.unit.replace("m2", "m^2").replace("m3", "m^3")
    values = (readable(value, unit) for value in (row.simulation, row.reference))
    numbers = (row.error, row.u_sa, row.u_fe, row.u_val)
    shares = (f"{100 * value / abs(row.simulation):.2g} %" for value in numbers)
    return (row.profile, *values, *shares, f"{MARKS[row.word]} {row.word}", row.reason)


def line(row: Comparison) -> str:
    """One line for a terminal."""
    name, simulation, reference, error, u_sa, u_fe, *_ = cells(row)
    return f"{name}: S = {simulation}, D = {reference}, E = {error}, u_SA {u_sa}, u_FE {u_fe}: {row.reason}"
