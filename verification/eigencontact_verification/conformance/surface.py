"""The field that the framework makes of a shape: its surface carries no traction, it is symmetric and finite."""

from __future__ import annotations

from typing import Any

import numpy as np

from eigencontact.inclusions import inclusion_field
from eigencontact_verification.conformance.report import check, ensure, place_of
from eigencontact_verification.conformance.sampling import evenly, region, sample

__all__ = ["check_surface_traction"]

#: All six components, no two alike.
_EIGENSTRAIN = np.array([[1.0, 0.3, -0.7], [0.3, -0.4, 0.5], [-0.7, 0.5, 0.8]])


@check
def check_surface_traction(shape: Any) -> None:
    """Tractions on z = 0 are below 1e-10 of the largest stress, for all six components of eigenstrain at once.

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
            shape, _EIGENSTRAIN, points, young_modulus=1.0, poisson_ratio=poisson_ratio, quantity="stress"
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
            "the image is made of the same potentials at z < 0 and of chi: both must be right there",
        )
