"""Errors that follow from the plan: half the distance of the points of regions, sizes of cells and parts of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from eigencontact.planning.plan import Plan

__all__ = ["cell_sizes", "half_distances", "has_points", "parts_of_cells", "places_of_edges"]

#: Error of the widths of a zone, in cells: a cell is in the zone or not.
_OF_WIDTH = 0.5
#: Error of the radius of a zone of one cell. In a row of cells the edge may lie anywhere: standard deviation
#: 1 / sqrt(12). A quarter of the edge, of which symmetry makes the others, crosses 2 R rows and columns, whose errors
#: average out: twice the standard deviation of their mean is sqrt(1 / (6 R)).
_OF_RADIUS = 6**-0.5


def has_points(plan: Plan) -> bool:
    """Whether the largest stress is searched over points of regions."""
    return any("stress" in request.fields for request in plan.model.cells.requests)


def half_distances(plan: Plan, summary: Mapping[str, Any]) -> dict[str, float]:
    """Half the distance [m] to the next depth with points, for each number that is the depth of a point.

    Of several regions with points at this depth, that with the farthest neighbours counts. A region with points at one
    depth alone was asked for this depth, and has no such error.
    """
    from eigencontact.model.regions import region_lattice

    requests = [request for request in plan.model.cells.requests if "stress" in request.fields]
    lattices = [region_lattice(request, plan.grid) for request in requests]
    depths = [np.unique(lattice.depths if lattice.points is None else lattice.points[:, 2]) for lattice in lattices]
    return {
        name: 0.5 * max((_gap(value, axis) for axis in depths), default=0.0)
        for name, value in _declared(summary, "of_points")
    }


def cell_sizes(plan: Plan, summary: Mapping[str, Any]) -> dict[str, float]:
    """Area of a cell [m2], or radius of the circle of this area [m], for each size that is counted in cells.

    In a line contact widths are counted in cells: their error is the edge of one.
    """
    area = plan.grid.mean_edge**2
    errors = {"m2": area, "m": plan.grid.dx if plan.grid.line else (area / np.pi) ** 0.5}
    units = {name: summary["numbers"][name]["unit"] for name, _ in _declared(summary, "scatters")}
    return {name: errors[unit] for name, unit in units.items() if unit in errors}


def places_of_edges(plan: Plan, summary: Mapping[str, Any]) -> dict[str, float]:
    """Least error [m or m2] of each size that is counted in cells; the widths of a line contact are located better."""
    return {} if plan.grid.line or not plan.scene.geometry else parts_of_cells(plan.grid.mean_edge, summary)


def parts_of_cells(edge: float, summary: Mapping[str, Any]) -> dict[str, float]:
    """Least error of each size that is counted in cells of this edge [m], by the place of the zone's edge in its cells.

    A length that is no width counts as the radius of a zone. Sizes below half a cell are none: these are distances that
    are zero by symmetry.
    """
    widths = {name for name, _ in _declared(summary, "of_widths")}
    errors = dict[str, float]()
    for name, value in _declared(summary, "scatters"):
        unit = summary["numbers"][name]["unit"]
        radius = (value / np.pi) ** 0.5 if unit == "m2" else value
        if unit in ("m", "m2") and radius > 0.5 * edge:
            error = edge * (_OF_WIDTH if name in widths else _OF_RADIUS * (edge / radius) ** 0.5)
            errors[name] = 2.0 * np.pi * radius * error if unit == "m2" else error
    return errors


def _declared(summary: Mapping[str, Any], flag: str) -> Iterator[tuple[str, float]]:
    """Numbers whose declaration has a flag, and their values."""
    for name, number in summary["numbers"].items():
        value = summary.get(name, summary["observed"].get(name))
        if number.get(flag) and value is not None:
            yield name, float(value)


def _gap(depth: float, depths: np.ndarray[Any, np.dtype[np.float64]]) -> float:
    """Larger distance from a depth to its neighbours; 0 for a depth that is not in the list."""
    nearest = int(np.argmin(abs(depths - depth)))
    if abs(depths[nearest] - depth) > 1e-6 * float(np.ptp(depths)):
        return 0.0
    gaps = np.diff(depths)[max(0, nearest - 1) : nearest + 1]
    return float(gaps.max(initial=0.0))
