"""Close-ups: stress regions around one inclusion, on points much finer than the cells."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor, prod

from eigencontact.core.grid import Grid
from eigencontact.errors import SceneError, nearest, shown
from eigencontact.model.sources import Inhomogeneity, Source
from eigencontact.scene.schema import StressRequest

__all__ = ["resolved"]

#: Points to an edge of a cell, where the scene does not say.
_REFINEMENT = 8
#: Points of one region.
_MOST = 4_000_000
_SNAP = 1e-6


def resolved(requests: Sequence[StressRequest], sources: Sequence[Source], grid: Grid) -> list[StressRequest]:
    """Replace close-ups and depth limits of the requests by coordinates.

    Those around an inclusion have its box; those down to a depth in a body that remembers the middles of its cells,
    where the scene does not say how many steps of depth it wants.

    Parameters
    ----------
    sources : sequence of Source
        With their cells, whose height sets the distance of the points along z.
    grid : Grid
        Window, to which the inclusion is cut first.

    Raises
    ------
    SceneError
        No inclusion of that name in the body; a plane that misses the box; too many points.
    """
    return [
        _in_cells(request, sources) if request.around is None else _around(request, sources, grid)
        for request in requests
    ]


def _in_cells(request: StressRequest, sources: Sequence[Source]) -> StressRequest:
    if request.depth_max is None or request.depth_cells is not None:
        return request
    solved = (region for region in sources if isinstance(region, Inhomogeneity) and region.body == request.body)
    height = next(
        (region.lattice.edges[0] for region in solved if region.lattice is not None and region.law.variables), None
    )
    if height is None:
        return request
    depths = [(number + 0.5) * height for number in range(max(1, floor(request.depth_max / height + _SNAP)))]
    return request.model_copy(update={"depth_max": None, "depths": depths})


def _around(request: StressRequest, sources: Sequence[Source], grid: Grid) -> StressRequest:
    source = _source_around(request, sources)
    finer = request.refinement or _REFINEMENT
    pitch = (grid.dx, grid.dy, _height(source, sources, grid))
    bounds = _in_window(source, grid)
    middle = [0.5 * (low + high) for low, high in bounds]
    box = [(low - request.room * (high - low), high + request.room * (high - low)) for low, high in bounds]
    normal = "xyz".index(request.normal) if request.shape == "plane" else None
    at = None if normal is None else _place(request, source, middle[normal], box[normal])
    # The middles of the cells' parts, as along x and y.
    low, high = (end / pitch[2] * finer - 0.5 for end in box[2])
    numbers = range(max(ceil(low - _SNAP), 0), floor(high + _SNAP) + 1)
    counts = [int((box[axis][1] - box[axis][0]) / pitch[axis] * finer) + 1 for axis in (0, 1)]
    counts = [1 if axis == normal else count for axis, count in enumerate([*counts, numbers.stop - numbers.start])]
    count = prod(counts)
    if count > _MOST:
        fitting = int(finer * (_MOST / count) ** (1.0 / sum(points > 1 for points in counts)))
        choice = f"refinement = {fitting}" if fitting else "less room"
        raise SceneError(
            f"stress region {request.label!r} must have at most {_MOST} points (got {shown(count)}, from refinement "
            f"{shown(finer)} and room {request.room:g}); give {choice}"
        )
    depths = [at] if normal == 2 and at is not None else [(number + 0.5) / finer * pitch[2] for number in numbers]
    return request.model_copy(
        update={
            "around": None,
            "refinement": finer,
            "position": at,
            "start": (box[0][0], box[1][0], 0.0),
            "end": (box[0][1], box[1][1], 0.0),
            "depths": depths,
        }
    )


def _place(request: StressRequest, source: Source, middle: float, box: tuple[float, float]) -> float:
    """Place of a plane along its normal [m]."""
    at = middle if request.position is None else request.position
    if not box[0] <= at <= box[1]:
        raise SceneError(
            f"stress region {request.label!r} must cut the box around {source.name!r}, {request.normal} from "
            f"{box[0]:g} m to {box[1]:g} m (got position {at:g} m); leave position out, or give more room"
        )
    return at


def _source_around(request: StressRequest, sources: Sequence[Source]) -> Source:
    names = [source.name for source in sources if source.body == request.body]
    for source in sources:
        if source.body == request.body and source.name == request.around:
            return source
    listed = ", ".join(repr(name) for name in names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
    raise SceneError(
        f"stress region {request.label!r} must be around an inclusion of body{request.body} (got {request.around!r}); "
        f"there are {listed or 'none'}{nearest(str(request.around), names)}"
    )


def _height(source: Source, sources: Sequence[Source], grid: Grid) -> float:
    """Height [m] of the solved cells of this body, else of the cells of the inclusion, else the finer grid pitch."""
    solved = [region for region in sources if region.body == source.body and isinstance(region, Inhomogeneity)]
    for region in (*solved, source):
        if region.lattice is not None:
            return region.lattice.edges[0]
    return min(grid.edges)


def _in_window(source: Source, grid: Grid) -> list[tuple[float, float]]:
    """Bounds of an inclusion along x, y, z; along x and y restricted to the window."""
    low, high = source.shape.bounds
    bounds = []
    for axis in range(3):
        ends = (float(low[axis]), float(high[axis]))
        if axis < 2:
            side = (grid.center[axis] - 0.5 * grid.size[axis], grid.center[axis] + 0.5 * grid.size[axis])
            cut = (max(ends[0], side[0]), min(ends[1], side[1]))
            ends = cut if cut[0] < cut[1] else ends
        bounds.append(ends)
    return bounds
