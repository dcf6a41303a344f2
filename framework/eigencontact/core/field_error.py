"""Error of a field: how far its values may be off, at each point and in one number."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["FieldError", "beside_edges", "error_name"]

#: Points where a field reaches this part of its largest value count for its one number: pictures are framed by these.
_MATTERS = 0.1
#: Part of these points whose error the number bounds.
_SHARE = 0.95


def error_name(name: str) -> str:
    """Variable of the errors of a field or of a number of each step, beside that variable.

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
    at_edges : float
        Largest error at such an edge; 0 without one.
    source : str
        Part of the discretisation with the largest share in `error`.
    order : float, optional
        Order with which that share was observed to fall, of the field as a whole.
    """

    largest: float
    error: float
    at_edges: float = 0.0
    source: str = ""
    order: float | None = None

    @classmethod
    def of(cls, values: NDArray[Any], errors: NDArray[Any], edged: int, **more: Any) -> FieldError:
        """Error of a field from its values and the errors of these; it has edges along its last `edged` dimensions.

        Examples
        --------
        >>> values = np.array([0.0, 0.0, 0.3, 0.9, 1.0, 0.9, 0.3, 0.0])
        >>> errors = np.array([0.0, 0.0, 0.1, 0.01, 0.01, 0.01, 0.1, 0.0])
        >>> error = FieldError.of(values, errors, 1)
        >>> f"{error.error:.2f}, at edges {error.at_edges:.2f}", error.words()
        ('0.01, at edges 0.10', '± 1 %, ± 10 % at edges')
        """
        size = np.abs(np.nan_to_num(values))
        largest = float(size.max(initial=0.0))
        edges = beside_edges(values, edged)
        valid = np.isfinite(errors)
        inner = errors[valid & ~edges & (size >= _MATTERS * largest)]
        return cls(
            largest=largest,
            error=float(np.quantile(inner, _SHARE)) if inner.size and largest else 0.0,
            at_edges=float(errors[valid & edges].max(initial=0.0)),
            **more,
        )

    @property
    def relative(self) -> float | None:
        """Error in parts of the largest value; None for a field of zeros."""
        return self.error / self.largest if self.largest else None

    def words(self) -> str:
        """Error in parts of the largest value, for captions; empty for a field of zeros."""
        if not self.largest:
            return ""
        text = f"± {100 * self.error / self.largest:.2g} %"
        edges = 100 * self.at_edges / self.largest
        return f"{text}, ± {edges:.2g} % at edges" if self.at_edges > self.error else text

    def to_dict(self) -> dict[str, Any]:
        """Plain data for ``summary.json``."""
        return {**asdict(self), "relative": self.relative}


def beside_edges(values: NDArray[Any], edged: int) -> NDArray[np.bool_]:
    """Points with a neighbour of which one is zero and the other is not: edges of a contact, or of what has yielded.

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
