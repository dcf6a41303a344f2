"""Centre of a body and its rotation about z, shared by the geometries."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from eigencontact.plugin import FloatArray, real_points, require

__all__ = ["body_axes", "check_angle", "check_center", "check_length"]


def body_axes(
    x: ArrayLike, y: ArrayLike, center: tuple[float, float], angle: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """Coordinates of points along the axes of a body, relative to its centre, rotated by `angle` [rad] from x to y.

    Examples
    --------
    >>> along, across = body_axes(1.0, 3.0, (1.0, 1.0), np.pi / 2)
    >>> round(float(along), 12), round(abs(float(across)), 12)
    (2.0, 0.0)
    """
    x, y = real_points("separation", x, y)
    dx, dy = x - center[0], y - center[1]
    if angle == 0.0:
        return dx, dy
    cos, sin = np.cos(angle), np.sin(angle)
    return cos * dx + sin * dy, cos * dy - sin * dx


def check_length(where: str, field: str, value: float) -> None:
    """Refuse a length that is not positive and finite [m]."""
    require(0 < value < np.inf, where, field, value, "positive and finite [m]")


def check_center(where: str, center: tuple[float, float]) -> None:
    """Refuse a centre without two finite coordinates [m]."""
    require(len(center) == 2 and bool(np.isfinite(center).all()), where, "center", center, "two finite lengths (x, y)")


def check_angle(where: str, angle: float) -> None:
    """Refuse an angle that is not finite [rad]."""
    require(np.isfinite(angle), where, "angle", angle, "finite [rad]")
