"""Fields in a body under tractions that are given, not found."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.core.grid import Grid
from eigencontact.core.tensors import to_matrix
from eigencontact.core.tractions import TRACTIONS
from eigencontact.errors import SceneError, require
from eigencontact.library.arguments import lengths, plane
from eigencontact.library.components import field_points
from eigencontact.scene.installed import installed_plugins

if TYPE_CHECKING:
    from eigencontact.library.bodies import Body

__all__ = ["field_under"]

FloatArray = NDArray[np.float64]


def field_under(
    body: Body,
    quantity: str,
    points: ArrayLike,
    pressure: ArrayLike | None,
    shear: ArrayLike | None,
    spacing: float | str | Sequence[float | str],
    center: Sequence[float],
) -> FloatArray:
    """Stress ``(n, 3, 3)`` [Pa] or displacement ``(n, 3)`` [m]; see `eigencontact.library.bodies.Body`."""
    from eigencontact.model.bodies import influence_for
    from eigencontact.model.kernels import StressCoefficients
    from eigencontact.solvers.subsurface import stress_at_points
    from eigencontact.solvers.surface_means import depth_of_means, means_at_points

    where = f"{type(body).__name__}.{quantity}"
    table = body.scene_table()
    if "law" in table or body.scene_inclusions(1):
        raise SceneError(
            f"{where} must be of a body of elastic constants and layers alone (got {body!r}); regions and laws answer "
            "to a contact: solve_contact(...)"
        )
    loads = _loads(pressure, shear, where)
    shape = next(iter(loads.values())).shape
    dx, dy = lengths(spacing, 2, where, "spacing")
    middle = lengths(center, 2, where, "center", positive=False)
    grid = Grid(nx=shape[1], ny=shape[0], dx=dx, dy=dy, center=(middle[0], middle[1]))
    at = field_points(points, where, half_space=True) + 0.0  # a depth of -0.0 would be the other side of the surface
    registry, solid = installed_plugins(), body.solid
    kernels = [
        StressCoefficients(influence_for(registry, name, (solid, None)), solid, quantity)
        for name in TRACTIONS
        if name in loads
    ]
    tractions = [loads[name] for name in TRACTIONS if name in loads]
    near = at[:, 2] < depth_of_means(grid) if quantity == "stress" else np.zeros(len(at), dtype=bool)
    values = np.zeros((len(kernels[0].components), len(at)))
    evaluations: list[tuple[NDArray[np.bool_], Any]] = [(near, means_at_points), (~near, stress_at_points)]
    for some, evaluate in evaluations:
        if some.any():
            values[:, some] = evaluate(grid, kernels, tractions, at[some])
    return to_matrix(values) if quantity == "stress" else np.ascontiguousarray(values.T)


def _loads(pressure: ArrayLike | None, shear: ArrayLike | None, where: str) -> dict[str, FloatArray]:
    """Tractions by name, of one shape."""
    if pressure is None and shear is None:
        raise SceneError(f"{where} must be given a pressure (ny, nx), a shear (2, ny, nx), or both (got neither)")
    loads = {}
    if pressure is not None:
        loads["p"] = plane(pressure, where, "pressure", "Pa")
    if shear is not None:
        tractions = plane(shear, where, "shear", "Pa", leading=(2,))
        loads |= {"q_x": tractions[0], "q_y": tractions[1]}
        if "p" in loads:
            rule = f"of the shape {(2, *loads['p'].shape)} of the pressure"
            require(tractions.shape[1:] == loads["p"].shape, where, "shear", tractions.shape, rule)
    return loads
