"""Symmetric tensors as Mandel 6-vectors, and their scalars.

Conventions of the whole package, said once: SI units; the surface is z = 0 and z points **into** the body;
pressure is positive in compression, stress is positive in tension. A symmetric tensor is the Mandel vector
``(xx, yy, zz, sqrt2 yz, sqrt2 xz, sqrt2 xy)``, component first: ``(6, ...)``. Its dot product is the double
contraction of the tensors.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from eigencontact.core.array_types import FloatArray

__all__ = [
    "COMPONENTS",
    "INDICES",
    "SQRT2",
    "from_mandel",
    "hydrostatic",
    "principal",
    "to_mandel",
    "to_matrix",
    "tresca",
    "von_mises",
]

#: Order of the components everywhere.
COMPONENTS = ("xx", "yy", "zz", "yz", "xz", "xy")
#: Their rows and columns in matrices.
INDICES = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
SQRT2 = float(np.sqrt(2.0))


def to_mandel(components: ArrayLike) -> FloatArray:
    """Mandel vector of plain tensor components (xx, yy, zz, yz, xz, xy), both ``(6, ...)``.

    Examples
    --------
    >>> to_mandel([1.0, 2.0, 3.0, 1.0, 1.0, 1.0]).round(3).tolist()
    [1.0, 2.0, 3.0, 1.414, 1.414, 1.414]
    """
    out = np.array(components, dtype=float)
    out[3:] *= SQRT2
    return out


def from_mandel(mandel: ArrayLike) -> FloatArray:
    """Plain tensor components (xx, yy, zz, yz, xz, xy) of a Mandel vector, both ``(6, ...)``."""
    out = np.array(mandel, dtype=float)
    out[3:] /= SQRT2
    return out


def to_matrix(mandel: ArrayLike) -> FloatArray:
    """Matrices ``(..., 3, 3)`` of Mandel vectors ``(6, ...)``."""
    xx, yy, zz, yz, xz, xy = from_mandel(mandel)
    rows = [np.stack(row, axis=-1) for row in ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))]
    return np.stack(rows, axis=-2)


def hydrostatic(stress: ArrayLike) -> FloatArray:
    """Mean normal stress [Pa] of Mandel stress ``(6, ...)``; positive in tension."""
    s = np.asarray(stress)
    return np.asarray((s[0] + s[1] + s[2]) / 3.0)


def von_mises(stress: ArrayLike) -> FloatArray:
    """Von Mises stress [Pa] of Mandel stress ``(6, ...)``.

    Differences of the normal stresses lose no digits when they are nearly equal.

    Examples
    --------
    >>> round(float(von_mises([2.0, 0, 0, 0, 0, 0])), 12)
    2.0
    """
    s = np.asarray(stress)
    normal = ((s[0] - s[1]) ** 2 + (s[1] - s[2]) ** 2 + (s[2] - s[0]) ** 2) / 3.0
    deviator = np.asarray(np.sqrt(normal + s[3] ** 2 + s[4] ** 2 + s[5] ** 2), dtype=float)
    return np.asarray(np.sqrt(1.5) * deviator)


def principal(stress: ArrayLike) -> FloatArray:
    """Principal stresses ``(3, ...)`` [Pa] of Mandel stress ``(6, ...)``, largest (most tensile) first."""
    values = np.asarray(np.linalg.eigvalsh(to_matrix(stress)), dtype=float)
    return np.moveaxis(values[..., ::-1], -1, 0)


def tresca(stress: ArrayLike) -> FloatArray:
    """Tresca equivalent stress [Pa], the largest difference of principal stresses, of ``(6, ...)``."""
    values = principal(stress)
    return np.asarray(values[0] - values[2])
