"""Averaging points of a region, from its point sources."""

from __future__ import annotations

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.halfspace.potentials import HasFarField, PointSources

__all__ = ["averaging_points", "is_ball"]

Rule = tuple[FloatArray, FloatArray]


def averaging_points(shape: HasFarField) -> Rule:
    """Points ``(m, 3)`` [m] and weights ``(m,)`` of the mean over a region.

    Ellipsoids, known by their volume and second moments, take 13 points and polynomials of degree 5 exactly; other
    shapes 8 points and degree 3 (if they are symmetric about their centroid's axes).
    """
    far = shape.far_field()
    volume = float(far.volumes.sum())
    center = far.volumes @ far.positions / volume
    offsets = far.positions - center
    moments = (far.volumes[:, None] * offsets).T @ offsets + float(far.volumes @ far.spreads) * np.eye(3)
    squares, axes = (np.full(3, far.spreads[0]), np.eye(3)) if _is_one_ball(far) else np.linalg.eigh(moments / volume)
    deviations = np.sqrt(squares)
    ellipsoid = 4.0 / 3.0 * np.pi * float(np.prod(np.sqrt(5.0) * deviations))
    if abs(ellipsoid - volume) < 1e-6 * volume:
        points, weights = _ball()
        points = np.sqrt(5.0) * points
    else:
        points = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
        weights = np.full(8, 0.125)
    return center + (points * deviations) @ axes.T, weights


def _ball() -> Rule:
    """Centre and twelve corners of an icosahedron: degree 5 in the unit ball."""
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    signs = [(first, second) for first in (-1, 1) for second in (-1, 1)]
    corners = [np.roll((0.0, first, second * golden), turn) for turn in range(3) for first, second in signs]
    directions = np.array(corners) / np.hypot(1.0, golden)
    # <r²> = 3/5 and <r⁴> = 3/7 of a ball.
    return np.vstack([np.zeros(3), np.sqrt(5.0 / 7.0) * directions]), np.array([4.0 / 25.0] + [7.0 / 100.0] * 12)


def is_ball(shape: object) -> bool:
    """Whether a shape is a ball, by its far field."""
    return isinstance(shape, HasFarField) and _is_one_ball(shape.far_field())


def _is_one_ball(far: PointSources) -> bool:
    """One point source, of the spread that belongs to its volume."""
    radius = float(np.sqrt(5.0 * far.spreads[0]))
    return far.spreads.size == 1 and abs(far.volumes[0] - 4.0 / 3.0 * np.pi * radius**3) < 1e-9 * far.volumes[0]
