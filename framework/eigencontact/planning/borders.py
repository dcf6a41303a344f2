"""Borders of inclusions on planes and lines for pictures, computed with the shapes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import FloatArray
from eigencontact.model.model import Model
from eigencontact.model.outlines import section_outline
from eigencontact.model.regions import region_lattice
from eigencontact.model.sources import Source
from eigencontact.plugin import InclusionShape
from eigencontact.results.borders import LineBorders, Section

__all__ = ["line_borders", "sections_of"]


#: Halvings that find a border between two points of a line.
_HALVINGS = 30
#: Points closer to a border than this part of the spacing of the line are on it.
_ON_A_BORDER = 1e-6
#: Corners of cells are looked at this far inside them, in parts of their edge.
_INSET = 1e-6
#: A point this close to a face of cells, in parts of their edge, is on it.
_FACE_TOLERANCE = 1e-12


def sections_of(model: Model, sources: Sequence[Source]) -> tuple[Section, ...]:
    """Borders of inclusions on the planes that pictures cut.

    Those are, of a body with cells, the rows of cells normal to y and the planes of its regions; of a body that wears,
    the rows and columns of the window through inclusions at its surface.

    Parameters
    ----------
    sources : sequence of Source
        Regions that results describe one by one.
    """
    cells = {source.body for source in model.cells.inhomogeneities if source.lattice is not None}
    rows, columns = ("y", model.grid.y), ("x", model.grid.x)
    sections: list[Section] = []
    copies: dict[tuple[object, ...], FloatArray] = {}
    for number, source in enumerate(sources):
        if not _is_inclusion(source):
            continue
        planes = set[tuple[str, float]]()
        recedes = bool(model.scene.losses) and source.shape.bounds[0][2] <= 0.0
        for axis, places in (rows, columns) if recedes else (rows,) if source.body in cells else ():
            planes |= {(axis, float(place)) for place in places}
        if source.body in cells:
            planes |= {
                (request.normal, float(request.at))
                for request in model.cells.requests
                if request.shape == "plane" and request.body == source.body
            }
        for axis, place in sorted(planes):
            segments = _section(source, axis, place, copies)
            if len(segments):
                origin = _origin(source, axis)
                sections.append(Section(inclusion=number, normal=axis, place=place, origin=origin, segments=segments))
    return tuple(sections)


def _section(source: Source, axis: str, place: float, copies: dict[tuple[object, ...], FloatArray]) -> FloatArray:
    """Outline of an inclusion on a plane, from its origin; copies of one table in the scene share it."""
    low, high = np.array(source.shape.bounds)
    normal = "xyz".index(axis)
    if not low[normal] < place < high[normal]:
        return np.empty((0, 2, 2))
    share = (place - low[normal]) / (high[normal] - low[normal])
    key = (source.where, axis, round(float(share), 9), *np.round((high - low) / (high - low).max(), 9))
    if key not in copies:
        copies[key] = section_outline(source, axis, place) - _origin(source, axis)
    return copies[key]


def _origin(source: Source, axis: str) -> tuple[float, float]:
    """Horizontal and vertical end of the bounds of an inclusion on planes normal to an axis [m]."""
    first, second = (float(low) for low, name in zip(source.shape.bounds[0], "xyz", strict=True) if name != axis)
    return first, second


def line_borders(model: Model) -> dict[str, LineBorders]:
    """Inclusions at the points of each line region of a scene; without lines in bodies without inclusions."""
    return {
        request.label: _along(model, request.body, np.asarray(region_lattice(request, model.grid).points).T)
        for request in model.cells.requests
        if request.shape == "line"
        and any(source.body == request.body and _is_inclusion(source) for source in model.sources)
    }


def _is_inclusion(source: Source) -> bool:
    """Whether the faces of a region belong to an inclusion of the scene, not to a patch or to cells of a body."""
    return isinstance(source.shape, InclusionShape) and not source.guessed


def _along(model: Model, body: int, points: FloatArray) -> LineBorders:
    """Inclusions at points (3, n) [m] of a line."""
    edges = next(
        (source.lattice.edges for source in model.cells.inhomogeneities if source.body == body and source.lattice), None
    )
    near = list(_near(model, body, points))

    def number(at: FloatArray) -> NDArray[np.intp]:
        inside = [n * np.asarray(source.shape.contains(*at)) for n, source in near]
        return np.asarray(sum(inside, np.zeros(at.shape[1], dtype=np.intp)))

    inclusion = number(points)
    breaks = np.flatnonzero(inclusion[1:] != inclusion[:-1])
    low, high = np.zeros(breaks.size), np.ones(breaks.size)
    first, span = points[:, breaks], points[:, breaks + 1] - points[:, breaks]
    for _ in range(_HALVINGS if breaks.size else 0):
        middle = 0.5 * (low + high)
        as_inner = number(first + middle * span) == inclusion[breaks]
        low, high = np.where(as_inner, middle, low), np.where(as_inner, high, middle)
    border = np.full(points.shape[1], np.nan)
    border[breaks] = 0.5 * (low + high)
    uncut = np.ones(points.shape[1], dtype=bool)
    for _, source in near:
        uncut &= ~_on_border(source, points)
        if edges is not None:
            uncut &= _in_uncut_cells(source, points, model, edges)
    return LineBorders(inclusion=inclusion, border=border, uncut=uncut)


def _near(model: Model, body: int, points: FloatArray) -> Iterator[tuple[int, Source]]:
    """Inclusions of a body, by number from 1, whose bounds are within a cell of the box around points (3, n)."""
    room = max(*model.grid.edges, *(s.lattice.edges[0] for s in model.cells.inhomogeneities if s.lattice))
    inclusions = [source for source in model.sources if source.body == body and _is_inclusion(source)]
    for number, source in enumerate(inclusions, 1):
        low, high = np.array(source.shape.bounds)
        if (points.min(axis=1) - room <= high).all() and (points.max(axis=1) + room >= low).all():
            yield number, source


def _on_border(source: Source, points: FloatArray) -> NDArray[np.bool_]:
    """Points (3, n) of a line on the border of an inclusion."""
    if points.shape[1] < 2:
        return np.zeros(points.shape[1], dtype=bool)
    step = _ON_A_BORDER * np.gradient(points, axis=1)
    before, after = (np.asarray(source.shape.contains(*(points + side * step))) for side in (-1, 1))
    return np.asarray(before != after)


def _in_uncut_cells(
    source: Source, points: FloatArray, model: Model, lattice: tuple[float, float, float]
) -> NDArray[np.bool_]:
    """Points (3, n) in cells whose corners all lie within an inclusion or all outside."""
    dz, dy, dx = lattice
    edges = np.array([dx, dy, dz])[:, None]
    first = np.array([model.grid.x[0] - 0.5 * dx, model.grid.y[0] - 0.5 * dy, 0.0])[:, None]
    low = first + np.floor((points - first) / edges + _FACE_TOLERANCE) * edges
    inset = [_INSET, 1.0 - _INSET]  # a face of cells that lies in a border is not cut
    corners = [low + edges * np.array(share)[:, None] for share in product(inset, inset, inset)]
    inside = np.stack([np.asarray(source.shape.contains(*corner)) for corner in corners])
    return np.asarray(inside.all(axis=0) | ~inside.any(axis=0))
