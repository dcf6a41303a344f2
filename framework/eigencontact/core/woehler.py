"""Wöhler curve relative to a limit amplitude, with the scatter of both."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, log10
from statistics import NormalDist

__all__ = ["WoehlerCurve"]

#: Standard deviations between failure probabilities of 10 % and 90 %.
_TEN_TO_NINETY = 2.0 * NormalDist().inv_cdf(0.9)


@dataclass(frozen=True, kw_only=True, slots=True)
class WoehlerCurve:
    """Cycles to failure ``knee_cycles ratio^-slope`` above the limit amplitude; infinite at the limit and below.

    The limit amplitude is log-normal. `scatter` is the amplitude that 90 % of the parts do not survive over the
    amplitude that 10 % do not survive.

    Parameters
    ----------
    slope : float
        Exponent [-], positive.
    knee_cycles : float
        Cycles at which the curve meets the limit amplitude [-].
    scatter : float
        Scatter of the limit amplitude [-], at least 1; 1 is none.

    References
    ----------
    DIN 50100:2016-12 (slope, knee, scatter as a ratio of quantiles of 10 % and 90 %).

    Examples
    --------
    >>> curve = WoehlerCurve(slope=5.0, knee_cycles=1e6, scatter=1.5)
    >>> curve.cycles(2.0), curve.cycles(0.9)
    (31250.0, inf)
    >>> round(curve.failure_probability(1.5**0.5), 6)  # half of the scatter above the median
    0.9
    """

    slope: float
    knee_cycles: float
    scatter: float = 1.0

    def cycles(self, ratio: float, failure_probability: float = 0.5) -> float:
        """Cycles until a fraction of the components fails, for an amplitude relative to the median limit amplitude."""
        endured = self.limit_ratio(failure_probability)
        return float(self.knee_cycles * (ratio / endured) ** -self.slope) if ratio > endured else inf

    def limit_ratio(self, failure_probability: float) -> float:
        """Limit amplitude of a failure probability over the median one."""
        return float(self.scatter ** (NormalDist().inv_cdf(failure_probability) / _TEN_TO_NINETY))

    def failure_probability(self, ratio: float) -> float:
        """Fraction of the components that eventually fails, for an amplitude relative to the median limit amplitude."""
        if ratio <= 0.0 or self.scatter == 1.0:
            return float(ratio > 1.0)
        return NormalDist().cdf(log10(ratio) / log10(self.scatter) * _TEN_TO_NINETY)
