"""Error of a field, at each point and as one number."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["FieldError", "beside_edges", "error_name"]

#: Points where a field reaches this part of its largest value count for its one number: pictures are framed by these.
_MATTERS = 0.1
#: Part of these points whose error the number bounds.
_SHARE = 0.95
#: An error this many times larger at few points is said beside the number.
_OUTLIER_RATIO = 1.5


def error_name(name: str) -> str:
    """Name of the variable with the errors of a field or of a number of each step.

    Examples
    --------
    >>> error_name("section_von_mises")
    'section_von_mises_error'
    """
    return f"{name}_error"


@dataclass(frozen=True, kw_only=True, slots=True)
class FieldError:
    """Error of one field in one step.

    Attributes
    ----------
    largest : float
        Largest magnitude of the field, in its unit.
    error : float
        95 % of the points have a smaller error: of the points where the field reaches 10 % of its largest value, away
        from the edges of the zone in which it is not zero.
    worst : float
        Largest error at any point, such edges and singular points of a stress among them.
    source : str
        Part of the discretisation with the largest share in `error`.
    order : float, optional
        Order with which that share was observed to fall, of the field as a whole.
    parts : dict of str to float
        Share of every part of the discretisation in `error`.
    """

    largest: float
    error: float
    worst: float
    source: str = ""
    order: float | None = None
    parts: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, values: NDArray[Any], errors: NDArray[Any], edged: int, **more: Any) -> FieldError:
        """Error of a field from its values and their errors; the field has edges along its last `edged` dimensions.

        Examples
        --------
        >>> values = np.array([0.0, 0.0, 0.3, 0.9, 1.0, 0.9, 0.3, 0.0])
        >>> errors = np.array([0.0, 0.0, 0.1, 0.01, 0.01, 0.01, 0.1, 0.0])
        >>> error = FieldError.of(values, errors, 1)
        >>> error.words()
        '± 1 % of the largest value, up to ± 10 % at few points'
        """
        size = np.abs(np.nan_to_num(values))
        largest = float(size.max(initial=0.0))
        edges = beside_edges(values, edged)
        inner = errors[np.isfinite(errors) & ~edges & (size >= _MATTERS * largest)]
        return cls(
            largest=largest,
            error=float(np.quantile(inner, _SHARE)) if inner.size and largest else 0.0,
            worst=float(np.nan_to_num(errors).max(initial=0.0)),
            **more,
        )

    @property
    def relative(self) -> float | None:
        """Error relative to the largest value; None for a field of zeros."""
        return self.error / self.largest if self.largest else None

    def words(self) -> str:
        """Error relative to the largest value, as text for captions; empty for a field of zeros."""
        if not self.largest:
            return ""
        text = f"± {100 * self.error / self.largest:.2g} % of the largest value"
        worst = f"{100 * self.worst / self.largest:.2g} %"
        return f"{text}, up to ± {worst} at few points" if self.worst > _OUTLIER_RATIO * self.error else text

    def to_dict(self) -> dict[str, Any]:
        """Plain data for ``summary.json``."""
        return {**asdict(self), "relative": self.relative}

    @classmethod
    def of_dict(cls, table: Mapping[str, Any]) -> FieldError:
        """Error from the data of `to_dict`."""
        return cls(**{name: value for name, value in table.items() if name != "relative"})


def beside_edges(values: NDArray[Any], edged: int) -> NDArray[np.bool_]:
    """Points where the value or a neighbour is zero, but not both: edges of a contact or of a yielded zone.

    Examples
    --------
    >>> beside_edges(np.array([0.0, 0.0, 2.0, 3.0]), 1)
    array([False,  True,  True, False])
    """
    touched = np.nan_to_num(values) != 0.0
    edges = np.zeros(touched.shape, dtype=bool)
    for axis in range(touched.ndim - edged, touched.ndim):
        differ = np.diff(touched, axis=axis)
        for side in (slice(None, -1), slice(1, None)):
            at = tuple(side if n == axis else slice(None) for n in range(touched.ndim))
            edges[at] |= differ
    return edges
