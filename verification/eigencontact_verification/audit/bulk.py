"""Bulk stress of a stored step: in closed form in the body, and as an eigenstrain of regions with other constants.

Let S be the bulk stress of the body around and e its strain, S + s the stress and e + e' the strain everywhere. In a
region of stiffness C the law ``S + s = C (e + e')`` is that of an eigenstrain, ``s = C (e' - E)`` with
``E = C^-1 S - e``: elements compute s.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from eigencontact_verification.audit.stored import StoredStep
    from eigencontact_verification.fem.loaded_body import LoadedBody

__all__ = ["bulk_stress_at", "bulk_stress_of", "eigenstrain_by_bulk", "strain_of"]

FloatArray = NDArray[np.float64]


def bulk_stress_of(stored: StoredStep, number: int) -> FloatArray:
    """Tensor (3, 3) [Pa] that the step prescribes of a body, of the substrate under layers."""
    first = "" if number == 1 else f"body{number}_"
    xx, yy, xy = (stored.scalars.get(f"{first}bulk_stress_{component}", 0.0) for component in ("xx", "yy", "xy"))
    return np.array([[xx, xy, 0.0], [xy, yy, 0.0], [0.0, 0.0, 0.0]])


def strain_of(stress: FloatArray, young_modulus: float, poisson_ratio: float) -> FloatArray:
    """Strain (3, 3) of a stress [Pa] by Hooke's law."""
    lateral = poisson_ratio * np.trace(stress) * np.eye(3)
    return np.asarray(((1.0 + poisson_ratio) * stress - lateral) / young_modulus)


def eigenstrain_by_bulk(stress: FloatArray, inside: tuple[float, float], around: tuple[float, float]) -> FloatArray:
    """Eigenstrain E (3, 3) by which a region of other constants answers; constants are (E [Pa], ν)."""
    return strain_of(stress, *inside) - strain_of(stress, *around)


def bulk_stress_at(stress: FloatArray, body: LoadedBody, points: FloatArray) -> FloatArray:
    """Stress ``(n, 6)`` (xx, yy, zz, yz, xz, xy) [Pa] at points ``(n, 3)``; layers share the strain of the substrate.

    At the depth of an interface that of the deeper layer.
    """
    strain = strain_of(stress, body.young_modulus, body.poisson_ratio)
    bottoms = np.cumsum([layer.thickness for layer in body.layers])
    place = np.searchsorted(bottoms * (1.0 - 1e-9), points[:, 2], side="right")
    out = np.zeros((len(points), 6))
    constants = [(layer.young_modulus, layer.poisson_ratio) for layer in body.layers]
    for number, (E, nu) in enumerate([*constants, (body.young_modulus, body.poisson_ratio)]):
        in_plane = E / (1.0 + nu) * (strain[:2, :2] + nu / (1.0 - nu) * np.trace(strain[:2, :2]) * np.eye(2))
        out[place == number] = [in_plane[0, 0], in_plane[1, 1], 0.0, 0.0, 0.0, in_plane[0, 1]]
    return out
