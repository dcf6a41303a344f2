"""Threshold of the stress intensity range for crack growth, of long and of short cracks."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.crack_growth import el_haddad, kitagawa_takahashi, short_crack_length
from eigencontact.core.units import parse_quantity
from eigencontact.errors import SceneError, nearest, shown
from eigencontact.halfspace.edge_crack import edge_crack

__all__ = ["CrackThreshold", "Threshold", "positive_quantity", "quantity"]

_RULES = {"el-haddad": el_haddad, "kitagawa-takahashi": kitagawa_takahashi}
#: How texts end that are stresses times the square root of a length in metres.
_ROOT = re.compile(r"\s*[*·]?\s*(?:√m|sqrt\(m\)|m\^0\.5|m\*\*0\.5|m\^\(1/2\)|m\*\*\(1/2\))$")
#: Thresholds of a stranger: of lengths [m] and ratios R [-], in Pa sqrt(m).
Threshold = Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class CrackThreshold:
    """Threshold of long cracks and the rule for short cracks.

    Attributes
    ----------
    long_crack : float or callable
        Threshold of long cracks [Pa sqrt(m)], or a function of lengths [m] and ratios R [-] that returns thresholds.
    limit_amplitude : float or None
        Fatigue limit, an amplitude [Pa]; None leaves out the correction of short cracks.
    rule : {"el-haddad", "kitagawa-takahashi"}
        Correction of short cracks.
    """

    long_crack: float | Threshold
    limit_amplitude: float | None
    rule: str

    @classmethod
    def of(cls, threshold: Any, limit_amplitude: Any, rule: str) -> CrackThreshold:
        """Check the arguments of `eigencontact.crack` and convert them to SI units."""
        if rule not in _RULES:
            raise SceneError(
                f"rule must be {' or '.join(map(repr, _RULES))} (got {shown(rule)}){nearest(rule, _RULES)}"
            )
        amplitude = (
            None if limit_amplitude is None else positive_quantity(limit_amplitude, "Pa", "limit_amplitude", "a stress")
        )
        if callable(threshold):
            if amplitude is not None:
                raise SceneError("limit_amplitude must be left out with a threshold that is a function of its own")
            return cls(threshold, None, rule)
        text = _ROOT.sub("", threshold) if isinstance(threshold, str) else threshold
        if isinstance(threshold, str) and text == threshold:
            raise SceneError(
                f"threshold must be a stress times a root of metres, '5 MPa sqrt(m)' (got {shown(threshold)})"
            )
        return cls(positive_quantity(text, "Pa", "threshold", "a stress times sqrt(m)"), amplitude, rule)

    @property
    def short_length(self) -> float | None:
        """Length a_0 [m], with the factor of a crack normal to the surface."""
        if self.limit_amplitude is None or callable(self.long_crack):
            return None
        return short_crack_length(self.long_crack, self.limit_amplitude, float(edge_crack(0.0).weights[0, 0].sum()))

    def at(self, lengths: FloatArray, ratios: FloatArray) -> FloatArray:
        """Thresholds of cracks with lengths [m] and ratios R [-], in Pa sqrt(m)."""
        if callable(self.long_crack):
            values = np.asarray(self.long_crack(lengths, ratios), dtype=float)
            if values.shape != lengths.shape or not np.all(values > 0):
                got = shown(values.shape) if values.shape != lengths.shape else "values that are not positive"
                raise SceneError(f"threshold must return a positive value for each length, {lengths.shape} (got {got})")
            return values
        if self.short_length is None:
            return np.full(lengths.shape, self.long_crack)
        return _RULES[self.rule](lengths, self.long_crack, self.short_length)


def quantity(value: Any, unit: str, name: str, words: str) -> float:
    """Number in SI units of a number or of text with a unit; errors name the argument."""
    try:
        return float(parse_quantity(value, unit, words))
    except (TypeError, ValueError) as problem:
        raise SceneError(f"{name} must be {problem} (got {shown(value)})") from None


def positive_quantity(value: Any, unit: str, name: str, words: str) -> float:
    """Positive and finite number in SI units of a number or of text with a unit."""
    number = quantity(value, unit, name, words)
    if not 0 < number < np.inf:
        raise SceneError(f"{name} must be positive and finite [{unit}] (got {shown(value)})")
    return number
