"""Threshold of the range of the stress intensity factor, for short and long cracks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.units import parse_quantity
from eigencontact.errors import SceneError, nearest, require, shown

__all__ = ["Threshold"]

#: K of a short edge crack across a uniform stress, over sigma sqrt(pi a).
_EDGE = 1.1215
_CURVES = ("el-haddad", "kitagawa-takahashi")


@dataclass(frozen=True, kw_only=True)
class Threshold:
    """Range of K below which a crack does not grow, as a function of its length.

    Parameters
    ----------
    long_crack_range : float
        Threshold of long cracks [Pa sqrt(m)], at the load ratio of the cycle.
    limit_range : float
        Fatigue limit of smooth specimens as a RANGE of stress [Pa]: twice its amplitude.
    curve : {"el-haddad", "kitagawa-takahashi"}
        From one to the other smoothly, ``dK sqrt(a / (a + a0))``, or the smaller of both.

    Notes
    -----
    Both branches meet at ``a0 = (dK / (1.1215 dS))^2 / pi``, so that a short edge crack grows where the range of stress
    exceeds the limit.

    References
    ----------
    H. Kitagawa, S. Takahashi 1976, Proc. ICM 2, 627; M. H. El Haddad, K. N. Smith, T. H. Topper 1979,
    J. Eng. Mater. Technol. 101, 42, doi:10.1115/1.3443647.

    Examples
    --------
    >>> rule = Threshold(long_crack_range=5e6, limit_range=400e6)
    >>> round(rule.intrinsic_length * 1e6, 2), (rule(np.array([1.0]))[0] / 5e6).round(4).item()
    (39.54, 1.0)
    """

    long_crack_range: float
    limit_range: float
    curve: Literal["el-haddad", "kitagawa-takahashi"] = "el-haddad"

    def __post_init__(self) -> None:
        for name, unit in (("long_crack_range", "Pa m^0.5"), ("limit_range", "Pa")):
            value = getattr(self, name)
            require(0 < value < np.inf, "threshold", name.replace("_", "-"), value, f"positive and finite [{unit}]")
        if self.curve not in _CURVES:
            raise SceneError(
                f"threshold.curve must be {' or '.join(map(repr, _CURVES))} (got {shown(self.curve)})"
                + nearest(str(self.curve), _CURVES)
            )

    @classmethod
    def from_table(cls, table: Mapping[str, Any]) -> Threshold:
        """Threshold of a table with units in its values."""
        units = {"long-crack-range": ("Pa*m**0.5", "a range of K"), "limit-range": ("Pa", "a range of stress")}
        known = (*units, "curve")
        for key in table:
            if key not in known:
                raise SceneError(f"threshold.{key} must be one of {', '.join(known)}{nearest(str(key), known)}")
        for key in units:
            if key not in table:
                raise SceneError(f"threshold.{key} must be given; a threshold needs {' and '.join(units)}")
        values = {}
        for key, (unit, words) in units.items():
            try:
                values[key.replace("-", "_")] = float(parse_quantity(table[key], unit, words))
            except (TypeError, ValueError) as problem:
                raise SceneError(f"threshold.{key} must be {problem} (got {shown(table[key])})") from None
        return cls(**values, curve=table.get("curve", "el-haddad"))

    @property
    def intrinsic_length(self) -> float:
        """Length a0 at which both branches meet [m]."""
        return float((self.long_crack_range / (_EDGE * self.limit_range)) ** 2 / np.pi)

    def __call__(self, lengths: FloatArray) -> FloatArray:
        """Threshold of cracks of these lengths [m], in Pa sqrt(m)."""
        if self.curve == "el-haddad":
            return np.asarray(self.long_crack_range * np.sqrt(lengths / (lengths + self.intrinsic_length)))
        return np.asarray(np.minimum(self.long_crack_range, _EDGE * self.limit_range * np.sqrt(np.pi * lengths)))
