"""The field that the framework makes of a shape: no traction on the surface, stresses in equilibrium."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.library.inclusions import inclusion_field
from eigencontact_verification.conformance.orders import AXES
from eigencontact_verification.conformance.report import agree, check, ensure, place_of
from eigencontact_verification.conformance.sampling import derivative_along, evenly, region, sample

FloatArray = NDArray[np.float64]

#: All six components, no two alike.
_EIGENSTRAIN = np.array([[1.0, 0.3, -0.7], [0.3, -0.4, 0.5], [-0.7, 0.5, 0.8]])


@check
def check_surface_traction(shape: Any) -> None:
    """Tractions on z = 0 are below 1e-10 of the largest stress, for all six components of eigenstrain at once.

    A shape of ``contains`` alone is asked as 8 cells across.

    Points of the surface within a hundredth of a size of the shape's own bounds are left out: on an edge of a flush
    shape the stress is infinite.
    """
    box = region(shape)
    within, _ = sample(shape)
    over = box.center + 2 * (box.half + 0.5 * box.size) * evenly(64)
    over[:, 2] = 0.0
    near_edge = np.any(np.minimum(np.abs(over - box.low), np.abs(over - box.high))[:, :2] < 0.01 * box.size, axis=1)
    over = over[~near_edge]
    points = np.concatenate([over, np.maximum(within.places, 0.0)])
    for poisson_ratio in (0.0, 0.3, 0.5):
        stress = inclusion_field(
            shape, _EIGENSTRAIN, points, young_modulus=1.0, poisson_ratio=poisson_ratio, quantity="stress", cells=8
        )
        ensure(
            np.all(np.isfinite(stress)), "the stress at points of the surface and inside", "finite", "NaN or infinity",
            "see check_potentials_finite",
        )  # fmt: skip
        traction = np.max(np.abs(stress[: len(over), 2]), axis=1) / np.max(np.abs(stress))
        worst = int(np.argmax(traction))
        ensure(
            traction[worst] <= 1e-10,
            f"the traction at {place_of(over[worst : worst + 1])}, nu = {poisson_ratio}",
            "0 to 1e-10 of the largest stress",
            f"{traction[worst]:.1e} of it",
            "potentials at z = +0.0 and -0.0 may differ on a face in the surface alone, and there by its jump",
        )


@check
def check_equilibrium(shape: Any) -> None:
    """The divergence of the stress in the half-space is 0 inside and outside: every order that it uses fits the others.

    The image enters with the powers of z and with chi, which no check of Phi and Psi alone sees.
    """
    groups = sample(shape)
    places = np.concatenate([group.places for group in groups])
    clearance = np.concatenate([group.clearance for group in groups])
    below = places[:, 2] > 0
    places, reach = places[below], np.minimum(clearance, 2 * places[:, 2])[below] / 4

    def stress(points: FloatArray) -> FloatArray:
        values = inclusion_field(
            shape, _EIGENSTRAIN, points.reshape(-1, 3), young_modulus=1.0, poisson_ratio=0.3, quantity="stress"
        )
        return np.moveaxis(values.reshape(*points.shape[:-1], 3, 3), (-2, -1), (0, 1))

    slopes = [derivative_along(axis, places, reach, stress) for axis in AXES]
    divergence = slopes[0][0] + slopes[1][1] + slopes[2][2]
    scale = np.max(np.abs(slopes), axis=(0, 1, 2)) + 1e-6 * np.max(np.abs(stress(places[:, None]))) / reach
    agree(
        [f"the divergence of stress along {letter}" for letter in "xyz"],
        divergence,
        np.zeros_like(divergence),
        scale=scale,
        tolerance=1e-7,
        points=places,
        rule="0",
        advice="first settle the checks of phi, psi and chi; what then remains is above the surface, z < 0",
    )
