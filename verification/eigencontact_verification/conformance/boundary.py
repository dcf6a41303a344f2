"""Checks on the boundary of a region: displacements are continuous, a face takes the mean, a flush face one side."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.conformance.orders import name, of_total
from eigencontact_verification.conformance.report import agree, check
from eigencontact_verification.conformance.sampling import (
    evenly,
    inside,
    natural_scale,
    on_boundary,
    potential,
    region,
)

FloatArray = NDArray[np.float64]

#: Derivatives that the boundary leaves continuous, and the first that jump there.
_CONTINUOUS = (("phi", 1), ("psi", 3))
_JUMPING = (("phi", 2), ("psi", 4))


@check
def check_continuity(shape: Any) -> None:
    """Phi of order 1 and Psi of order 3 are continuous across the boundary that contains draws."""
    crossing, outward = on_boundary(shape)
    step = region(shape).step * outward
    for which, total in _CONTINUOUS:
        orders = of_total(total)
        agree(
            [name(which, order) for order in orders],
            potential(shape, which, orders, crossing - step),
            potential(shape, which, orders, crossing + step),
            scale=np.max(natural_scale(shape, which, total, crossing + step)),
            tolerance=1e-5,
            points=crossing,
            rule="the same just inside and just outside",
            advice="the formulas inside and outside differ on the boundary: compare their constants, and the boundary "
            "with that of contains",
        )


def _faces(shape: Any) -> tuple[FloatArray, FloatArray]:
    """Points of flat faces that lie in the planes of bounds, and their outward normals.

    Faces whose coordinate is much larger than the shape are left out: a rounded point does not lie on them.
    """
    box = region(shape)
    points, normals = [], []
    spread = evenly(7)
    for axis in range(3):
        for side in (-1.0, 1.0):
            normal = np.where(np.arange(3) == axis, side, 0.0)
            flat = np.where(np.arange(3) == axis, 0.0, 0.9 * spread)
            places = box.center + box.half * (flat + normal)
            places[:, axis] = box.high[axis] if side > 0 else box.low[axis]
            places = places[np.abs(places[:, axis]) < 100 * box.half[axis]]
            # flat: what lies 1e-6 under the plane is inside, above it is outside, here and a tenth of the way around
            ring = places[:, None, :] + 0.05 * box.half * np.where(np.arange(3) == axis, 0.0, evenly(24))
            step = 1e-6 * 2 * box.half[axis] * normal
            even = np.all(inside(shape, ring - step) & ~inside(shape, ring + step), axis=1)
            points.append(places[even])
            normals.append(np.tile(normal, (int(np.sum(even)), 1)))
    return np.concatenate(points), np.concatenate(normals)


def smooth_points(shape: Any) -> tuple[FloatArray, FloatArray]:
    """Points of the boundary off z = 0 and their outward normals: of `_faces`, and where axes leave at `bounds`."""
    box = region(shape)
    places, normals = _faces(shape)
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    tips = np.where(axes > 0, box.high, np.where(axes < 0, box.low, box.center))
    met = inside(shape, tips - box.step * axes) & ~inside(shape, tips + box.step * axes)
    places, normals = np.concatenate([places, tips[met]]), np.concatenate([normals, axes[met]])
    below = places[:, 2] != 0
    return places[below], normals[below]


@check
def check_face_means(shape: Any) -> None:
    """On a flat face, second derivatives of Phi and fourth of Psi are the mean of both sides (not in z = 0)."""
    places, normals = _faces(shape)
    away = places[:, 2] != 0
    places, normals = places[away], normals[away]
    if not len(places):
        return
    step = region(shape).step * normals
    for which, total in _JUMPING:
        orders = of_total(total)
        inner, outer = (potential(shape, which, orders, places + side * step) for side in (-1, 1))
        agree(
            [f"{name(which, order)} on a face" for order in orders],
            potential(shape, which, orders, places),
            (inner + outer) / 2,
            scale=natural_scale(shape, which, total, places - step),
            tolerance=1e-5,
            points=places,
            rule="the mean of its values just inside and just outside",
            advice="where the offset from the face is exactly 0 let atan(.../0) be 0, or average both formulas",
        )


@check
def check_flush_face(shape: Any) -> None:
    """A face in the surface takes the value inside the body or the one above it, as it is told (or z = +0.0, -0.0)."""
    places, _ = _faces(shape)
    places = places[places[:, 2] == 0]
    if not len(places):
        return
    step = region(shape).step
    for which, total in _JUMPING:
        orders = of_total(total)
        for zero, side, words in ((0.0, step, "just below the surface"), (-0.0, -step, "just above the surface")):
            exact, beside = places.copy(), places.copy()
            exact[:, 2], beside[:, 2] = zero, side
            agree(
                [f"{name(which, order)} at z = {zero}, seen from {words.split()[1]}" for order in orders],
                potential(shape, which, orders, exact),
                potential(shape, which, orders, beside),
                scale=natural_scale(shape, which, total, beside),
                tolerance=1e-5,
                points=exact,
                rule=f"its limit {words}",
                advice="set takes_side = True and choose by the argument side where the face lies in z = 0",
            )
