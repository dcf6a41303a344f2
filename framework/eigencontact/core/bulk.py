"""Bulk stress of a body: uniform stress in the plane of the surface, caused by a distant load.

The surface z = 0 is free, so that zz, xz and yz are zero everywhere. Layers that are bonded to a substrate share its
strain in the plane, and each is in plane stress. Axes are those of the window for both bodies.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.core.tensors import SQRT2
from eigencontact.core.tractions import side

__all__ = [
    "BULK_NAMES",
    "IN_PLANE",
    "NO_BULK",
    "bulk_name",
    "bulk_of",
    "dragged",
    "in_plane_strain",
    "plane_stress",
    "recorded_bulk",
    "relative_strain",
    "strain_across",
]

#: Components in the plane, in the order of all arrays ``(3,)`` here.
IN_PLANE = ("xx", "yy", "xy")
#: No bulk stress in either body.
NO_BULK: Mapping[str, float] = MappingProxyType({})


def bulk_name(body: int, component: str) -> str:
    """Name of a component, in steps of scenes and in scalars of results.

    Examples
    --------
    >>> bulk_name(1, "xx"), bulk_name(2, "xy")
    ('bulk_stress_xx', 'body2_bulk_stress_xy')
    """
    return f"{'' if body == 1 else f'body{body}_'}bulk_stress_{component}"


#: Names of all components, by body.
BULK_NAMES = {body: tuple(bulk_name(body, component) for component in IN_PLANE) for body in (1, 2)}


def recorded_bulk(scalars: Mapping[str, float]) -> dict[str, float]:
    """Bulk stress [Pa] among the scalars of a step, by name."""
    return {name: scalars[name] for names in BULK_NAMES.values() for name in names if name in scalars}


def bulk_of(values: Mapping[str, float], body: int) -> FloatArray:
    """Bulk stress (xx, yy, xy) [Pa] of a body; missing values are zero."""
    return np.array([values.get(name, 0.0) for name in BULK_NAMES[body]])


def in_plane_strain(stress: FloatArray, material: Material, grid: Grid | None = None) -> FloatArray:
    """Strain (xx, yy, xy) of a uniform stress (xx, yy, xy) [Pa] under a free surface.

    In plane strain, below strips of a grid without end along y, the strain yy is zero, and the stress yy follows: ν
    times the stress xx.

    Examples
    --------
    >>> steel = Material(young_modulus=200e9, poisson_ratio=0.25)
    >>> in_plane_strain(np.array([200e6, 0.0, 0.0]), steel).tolist()
    [0.001, -0.00025, 0.0]
    >>> in_plane_strain(np.array([200e6, 0.0, 0.0]), steel, Grid.of(8, 1, 1.0, 1.0, line=True)).tolist()
    [0.0009375, 0.0, 0.0]
    """
    E, nu = material.young_modulus, material.poisson_ratio
    xx, yy, xy = stress
    shear = xy / (2.0 * material.shear_modulus)
    if grid is not None and 1 not in grid.bounded_axes:
        return np.array([(1.0 - nu * nu) * xx / E, 0.0, shear])
    return np.array([(xx - nu * yy) / E, (yy - nu * xx) / E, shear])


def plane_stress(strain: FloatArray, material: Material) -> FloatArray:
    """Mandel stress ``(6,)`` [Pa] of a strain (xx, yy, xy) under a free surface.

    Examples
    --------
    >>> steel = Material(young_modulus=200e9, poisson_ratio=0.25)
    >>> plane_stress(in_plane_strain(np.array([200e6, 0.0, 50e6]), steel), steel).round().tolist()
    [200000000.0, 0.0, 0.0, 0.0, 0.0, 70710678.0]
    """
    xx, yy, xy = strain
    nu, stiffness = material.poisson_ratio, material.plane_strain_modulus
    shear = 2.0 * material.shear_modulus * xy
    return np.array([stiffness * (xx + nu * yy), stiffness * (yy + nu * xx), 0.0, 0.0, 0.0, SQRT2 * shear])


def strain_across(strain: FloatArray, material: Material) -> float:
    """Strain zz under a free surface for a strain (xx, yy, xy)."""
    nu = material.poisson_ratio
    return float(-nu / (1.0 - nu) * (strain[0] + strain[1]))


def dragged(strain: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
    """Displacement along x and y ``(2, ...)`` of a strain (xx, yy, xy) at offsets x, y from its middle.

    Without rotation: the middle stays where it is, and so do its axes.
    """
    xx, yy, xy = strain
    shape = np.broadcast_shapes(np.shape(x), np.shape(y))
    return np.stack([np.broadcast_to(xx * x + xy * y, shape), np.broadcast_to(xy * x + yy * y, shape)])


def relative_strain(
    values: Mapping[str, float], substrates: Iterable[Material | None], grid: Grid | None = None
) -> FloatArray:
    """Strain (xx, yy, xy) of the surface of body 1 minus that of body 2; None is rigid, with zero strain."""
    total = np.zeros(3)
    for body, material in enumerate(substrates, start=1):
        if material is not None:
            total += side(body, "x") * in_plane_strain(bulk_of(values, body), material, grid)
    return total
