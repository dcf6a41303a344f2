"""Aspects of 1e-3 to 1e3: loaded rectangles, cuboids with eigenstrain, cells, radii of curvature."""

from __future__ import annotations

from typing import Any

import numpy as np

from eigencontact_verification.extremes.common import RADIUS, apart, dense_error
from eigencontact_verification.extremes.feature import Feature, family

__all__ = ["FEATURE"]


def rectangle_in_parts(aspect: float, quantity: str) -> float:
    """Field of a rectangle beside the sum of those of 16 parts of it, cut along its long side."""
    import eigencontact as ec

    a, b, count = (aspect, 1.0, 16) if aspect > 1 else (1.0, 1.0 / aspect, 16)
    points = np.array([[0.1 * a, 0.3 * b, 0.2], [1.7 * a, 0.2 * b, 0.0], [0.5 * a, -1.2 * b, 3.0], [0.0, 0.0, 1.0]])
    along, half = (0, a / count) if a > b else (1, b / count)
    widths = (half, b) if along == 0 else (a, half)
    constants: Any = {"young_modulus": 1.0, "poisson_ratio": 0.3, "quantity": quantity}
    load = (0.3, -0.2, 1.0)
    total = np.zeros_like(ec.rectangle_field(load, (a, b), points, **constants))
    for k in range(count):
        shifted = points.copy()
        shifted[:, along] -= (2 * k + 1 - count) * half
        total += ec.rectangle_field(load, widths, shifted, **constants)
    return apart(ec.rectangle_field(load, (a, b), points, **constants), total)


def cuboid_in_parts(*edges: float) -> float:
    """Stress of a cuboid beside the sum of those of 32 parts of it."""
    import eigencontact as ec

    size = np.array(edges)
    long, count = int(size.argmax()), 32
    middle = np.array([0.0, 0.0, 0.5 * size[2] + 0.1])
    points = np.array([[0.0, 0.0, 0.0], [0.7, 0.4, 0.0], [0.6 * size[0], 0.1, 0.3], [0.2, 0.3, size[2] + 0.5]])
    strain = np.array([[1.0, 0.3, -0.2], [0.3, -0.5, 0.1], [-0.2, 0.1, 0.8]]) * 1e-3
    constants: Any = {"young_modulus": 1.0, "poisson_ratio": 0.3, "quantity": "stress"}
    piece = size.copy()
    piece[long] /= count
    shapes = []
    for k in range(count):
        place = middle.copy()
        place[long] += (k - 0.5 * (count - 1)) * piece[long]
        shapes.append(ec.make("cuboid", center=tuple(place), edges=tuple(piece)))
    whole = ec.make("cuboid", center=tuple(middle), edges=tuple(size))
    field = ec.inclusion_field(whole, strain, points, **constants)
    return apart(field, ec.inclusion_field(shapes, strain, points, **constants))


PARTS = "fields add up, exactly: round-off of the corner sums, 1e-16 times (size/edge)² = 1e6 at the most"
DENSE = "the same cells by dense linear algebra: the tolerance 1e-9, times the condition of some 100 cells"

RECTANGLES = {
    (quantity, aspect): (aspect, quantity) for aspect in (1e3, 1e-3) for quantity in ("displacement", "stress")
}
CUBOIDS = ((1e3, 1.0, 1.0), (1.0, 1e3, 1.0), (1.0, 1.0, 1e3), (1e3, 1e3, 1.0))
#: Edges of the cells, and radii of curvature.
CELLS = {
    1e3: ((9, 8), (1e-3, 1e-6), 2e-8, (1e6 * RADIUS, RADIUS)),
    1e-3: ((9, 8), (1e-6, 1e-3), 2e-8, (RADIUS, 1e6 * RADIUS)),
}
ELLIPSOIDS = {ratio: ((15, 8), (2e-6, 1e-6), 1e-8, (RADIUS * ratio, RADIUS)) for ratio in (1e3, 1e-3)}

FEATURE = Feature(
    key="aspects",
    title="Aspects from 1e-3 to 1e3",
    reference="sums of parts; dense linear algebra on the same cells",
    corners=(
        *family("{} of a rectangle of {:g} : 1", rectangle_in_parts, RECTANGLES, bound=1e-10, reason=PARTS, quick=True),
        *family("cuboid of {:g} : {:g} : {:g}", cuboid_in_parts, CUBOIDS, bound=1e-10, reason=PARTS, quick=True),
        *family("cells of {:g} : 1", dense_error, CELLS, bound=1e-7, reason=DENSE),
        *family("ellipsoid of radii {:g} : 1", dense_error, ELLIPSOIDS, bound=1e-7, reason=DENSE),
    ),
)
