"""Scenes that the features share: a ball on a body, in units that make numbers of order one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact_verification.oracles.dense import compliance_matrix, solve_contact
from eigencontact_verification.oracles.eshelby import dilatational_ball_displacement, dilatational_ball_stress

__all__ = [
    "CONTACT", "MODULUS", "NU", "RADIUS", "apart", "ball", "coated", "dense_error", "hertz_load", "hot_ball", "off",
    "run", "steel",
]  # fmt: skip

FloatArray = NDArray[np.float64]

#: Contact modulus E* [Pa], Poisson's ratio and radius of the ball [m] where a corner does not change them.
MODULUS, NU, RADIUS = 1e11, 0.3, 1e-3
#: Contact radius [m] of the ball likewise.
CONTACT = 1e-5


def steel(nu: float = NU, modulus: float = MODULUS) -> dict[str, Any]:
    """Body of this contact modulus E/(1-ν²) [Pa]."""
    return {"young-modulus": modulus * (1.0 - nu * nu), "poisson-ratio": nu}


def coated(*layers: dict[str, Any], substrate: dict[str, Any] | None = None) -> dict[str, Any]:
    """Body of bonded layers on steel, or on another substrate."""
    return {"medium": {"type": "bonded-layers", "layers": list(layers), "substrate": substrate or steel()}}


def hertz_load(contact: float = CONTACT, radius: float = RADIUS, modulus: float = MODULUS) -> float:
    """Load [N] under which a rigid ball has this contact radius [m]."""
    return 4.0 * modulus * contact**3 / (3.0 * radius)


def ball(
    contact: float = CONTACT, *, cells: int = 16, size: float = 2.6, body: Any = None, **more: Any
) -> dict[str, Any]:
    """A rigid ball with this contact radius [m] on a window of `size` contact radii."""
    return {
        "body1": steel() if body is None else body,
        "geometry": {"type": "sphere", "radius": RADIUS},
        "grid": {"cells": cells, "size": [size * contact] * 2},
        "steps": {"normal-load": hertz_load(contact)},
        "output": {"pictures": False},
        **more,
    }


def run(scene: Mapping[str, Any]) -> Any:
    """Result in memory of a scene; a run that does not end well raises."""
    import eigencontact as ec

    return ec.run(dict(scene))


def apart(values: ArrayLike, expected: ArrayLike) -> float:
    """Largest difference as a part of the largest expected value."""
    right = np.asarray(expected, dtype=float)
    return float(np.abs(np.asarray(values, dtype=float) - right).max() / np.abs(right).max())


def off(value: Any, expected: Any) -> float:
    """Difference of two numbers as a part of the second."""
    return abs(float(value) / float(expected) - 1.0)


def hot_ball(depth: float, points: ArrayLike, nu: float, quantity: str) -> tuple[FloatArray, FloatArray]:
    """Field of a dilated ball of radius 1 and depth of its centre, at points (n, 3), and Davies's closed form.

    Parameters
    ----------
    quantity : str
        ``"displacement"`` or ``"stress"``; shear modulus 1, eigenstrain 1e-3.
    """
    import eigencontact as ec

    points = np.asarray(points, dtype=float)
    shape = ec.make("sphere", center=(0.0, 0.0, depth), radius=1.0)
    constants: Any = {"young_modulus": 2.0 * (1.0 + nu), "poisson_ratio": nu, "quantity": quantity}
    field = ec.inclusion_field(shape, 1e-3 * np.eye(3), points, **constants)
    closed = dilatational_ball_displacement if quantity == "displacement" else dilatational_ball_stress
    return np.asarray(field), np.asarray(closed(points, (0.0, 0.0, depth), 1.0, 1e-3, nu))


def dense_error(
    cells: tuple[int, int],
    edges: tuple[float, float],
    approach: float,
    radii: tuple[float, float] = (RADIUS, RADIUS),
) -> float:
    """Error of the pressure of a paraboloid that is pressed by an approach, against dense linear algebra.

    Parameters
    ----------
    cells, edges, radii : pairs along (x, y)
        Number of cells, their edges [m], radii of curvature [m].
    approach : float
        [m]
    """
    (nx, ny), (dx, dy), (rx, ry) = cells, edges, radii
    scene = {
        "body1": steel(),
        "geometry": {"type": "ellipsoid", "radius-x": rx, "radius-y": ry},
        "grid": {"cells": [nx, ny], "size": [nx * dx, ny * dy]},
        "steps": {"approach": approach},
        "numerics": {"tolerance": 1e-9, "allow-contact-at-edge": True, "allow-coarse": True},
        "output": {"pictures": False},
    }
    pressure = run(scene).dataset["pressure"].values[-1]
    x, y = ((np.arange(n) - 0.5 * (n - 1)) * d for n, d in ((nx, dx), (ny, dy)))
    separation = (x**2 / (2 * rx) + (y**2 / (2 * ry))[:, None]).ravel() - approach
    matrix = compliance_matrix((ny, nx), (dy, dx), MODULUS)
    return apart(pressure.ravel(), solve_contact(matrix, separation)[0])
