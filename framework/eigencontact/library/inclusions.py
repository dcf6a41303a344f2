"""Field of an inclusion at points: the half-space theorem as one call."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.core.arrays import is_whole, real_array
from eigencontact.core.material import Material
from eigencontact.core.tensors import to_mandel, to_matrix
from eigencontact.core.units import LARGEST
from eigencontact.errors import SceneError, require
from eigencontact.halfspace.cloud import field_of_cloud
from eigencontact.halfspace.potentials import HasPotentials
from eigencontact.halfspace.theorem import QUANTITIES
from eigencontact.halfspace.voxelised import VoxelisedShape
from eigencontact.library.components import field_points
from eigencontact.model.installed import installed_cell
from eigencontact.plugin import InclusionShape
from eigencontact.scene.installed import installed_plugins

__all__ = ["inclusion_field"]

FloatArray = NDArray[np.float64]
_SUBJECT = "inclusion_field"


def inclusion_field(
    shape: InclusionShape | list[InclusionShape] | tuple[InclusionShape, ...],
    eigenstrain: ArrayLike,
    points: ArrayLike,
    *,
    young_modulus: float,
    poisson_ratio: float,
    quantity: Literal["displacement", "strain", "stress"] = "displacement",
    space: Literal["half", "full"] = "half",
    cells: int = 16,
    tolerance: float = 1e-6,
) -> FloatArray:
    """Field of a region with uniform eigenstrain in an elastic half-space z >= 0 with a free surface, or in full space.

    Parameters
    ----------
    shape : InclusionShape or list of them
        The region, of `eigencontact.make` or your own; of several regions the fields add up (hundreds of them are
        summed in one compiled loop). In a half-space they must lie in z >= 0; they may touch the surface.
    eigenstrain : float, (3, 3) or (number of shapes, 3, 3) [-]
        Symmetric stress-free strain, of all shapes or of each; one number is the same along all axes. Expansion is
        positive, any trace.
    points : (n, 3) [m]
        Field points, z >= 0 in a half-space.
    young_modulus, poisson_ratio : float
        E [Pa] and ν in (-1, 0.5], the end included.
    quantity : {"displacement", "strain", "stress"}
        What to return; strain is the total strain, stress is positive in tension.
    space : {"half", "full"}
        With or without the free surface z = 0.
    cells : int
        Cells across the longest extent of a shape that has only ``contains``; other shapes do not use it.
    tolerance : float
        Error allowed for many shapes and points, relative to the largest value of their field; 0 sums all shapes
        one by one to round-off.

    Returns
    -------
    (n, 3) [m] or (n, 3, 3) [-] or [Pa]
        Displacement, or symmetric tensors. Components that jump across a face of the region take the mean of both
        sides on it; in the surface, the limit from inside (where a round shape touches it, that along the surface). On
        edges strain and stress are infinite (a logarithm); they come out large and finite.

    Raises
    ------
    SceneError
        A wrong shape of array, values that are not finite, points or region above the surface.

    References
    ----------
    Mindlin & Cheng 1950, J. Appl. Phys. 21, 926; Chiu 1978, J. Appl. Mech. 45, 302; Davies 2003, J. Appl. Mech. 70,
    655; Liu et al. 2012, Int. J. Plasticity 35, 135.

    Examples
    --------
    A heated sphere below the surface lifts it, by (4/3)(1+ν) ε a³/c² above its centre:

    >>> import numpy as np, eigencontact as ec
    >>> ball = ec.make("sphere", center=(0, 0, 2.0), radius=1.0)
    >>> u = inclusion_field(ball, 1e-3 * np.eye(3), [[0, 0, 0]], young_modulus=210e9, poisson_ratio=0.3)
    >>> f"{u[0, 2]:.6e}"
    '-4.333333e-04'
    """
    shapes = list(shape) if isinstance(shape, list | tuple) else [shape]
    for item in shapes:
        require(isinstance(item, InclusionShape), _SUBJECT, "shape", item, "an inclusion shape, as make() returns")
    rule = f"one number, or of shape (3, 3) or ({len(shapes)}, 3, 3) [-]"
    strain = real_array(eigenstrain, _SUBJECT, "eigenstrain", rule, "1")
    strain = strain * np.eye(3) if strain.ndim == 0 else strain
    allowed = strain.shape in ((3, 3), (len(shapes), 3, 3))
    require(allowed, _SUBJECT, "eigenstrain", strain.shape, rule)
    require(np.all(np.abs(strain) <= LARGEST), _SUBJECT, "eigenstrain", strain.tolist(), "finite [-]")
    require(np.array_equal(strain, strain.swapaxes(-1, -2)), _SUBJECT, "eigenstrain", strain.tolist(), "symmetric")
    supported = isinstance(quantity, str) and quantity in QUANTITIES
    require(supported, _SUBJECT, "quantity", quantity, f"one of {', '.join(map(repr, QUANTITIES))}")
    require(isinstance(space, str) and space in ("half", "full"), _SUBJECT, "space", space, "'half' or 'full'")
    require(is_whole(cells) and cells >= 1, _SUBJECT, "cells", cells, "a whole number, 1 or more")
    allowed = isinstance(tolerance, int | float) and 0.0 <= tolerance <= 0.01
    require(allowed, _SUBJECT, "tolerance", tolerance, "0 to 0.01 [-]")
    at = field_points(points, _SUBJECT, half_space=space == "half")
    material = Material(young_modulus=young_modulus, poisson_ratio=poisson_ratio)
    if space == "half":
        for item in shapes:
            check_below_surface(item, _SUBJECT)
    tensors = np.broadcast_to(strain, (len(shapes), 3, 3))
    field = field_of_cloud(
        [with_potentials(item, cells) for item in shapes],
        to_mandel([tensors[:, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]).T,
        (at[:, 0], at[:, 1], at[:, 2]),
        poisson_ratio=material.poisson_ratio,
        quantity=quantity,
        space=space,
        tolerance=float(tolerance),
    )
    if quantity == "displacement":
        return np.ascontiguousarray(field.T)
    return to_matrix(field * material.shear_modulus if quantity == "stress" else field)


def with_potentials(shape: InclusionShape, cells: int) -> Any:
    """Return the shape if it has potentials, else the shape divided into cells."""
    if isinstance(shape, HasPotentials):
        return shape
    return VoxelisedShape(shape, installed_cell(installed_plugins()), cells)


def check_below_surface(shape: InclusionShape, where: str) -> None:
    """Refuse a region that reaches above the surface by more than round-off."""
    low, high = shape.bounds
    size = max(b - a for a, b in zip(low, high, strict=True))
    if not low[2] >= -1e-12 * size:
        raise SceneError(
            f"{where}: {shape.key} must lie below the surface, z of 0 or more [m] (its top is at z = {low[2]:g} m); "
            "move it down, or use the full space"
        )
