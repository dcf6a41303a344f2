"""What the scene of a run says of jumps: on which side the points of a line lie, borders on planes of no region."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.errors import EigencontactError
from eigencontact.model.outlines import section_outline
from eigencontact.viz.sides import SAME, interface_depths
from eigencontact.viz.worn import scene_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from eigencontact.model.sources import Source
    from eigencontact.results.stored import Results

    FloatArray = NDArray[np.float64]

__all__ = ["LineSides", "inclusion_segments", "inclusions_of", "line_sides"]

#: Halvings that find a border between two points.
HALVINGS = 30
#: Points closer to a border than this part of the spacing of the line are on it.
ON_A_BORDER = 1e-6
#: Corners of cells are looked at this far inside them, in parts of their edge.
INSET = 1e-6


@dataclass(frozen=True)
class LineSides:
    """Sides of the points of a line.

    Attributes
    ----------
    number : (n,) int
        Side of each point; neighbours of different numbers have a jump between them.
    shares : (m,)
        Where each jump lies, as a part of the way from one point to the next.
    whole : (n,) bool
        Points that lie on no border, and in no cell which a border cuts; stress in those is that of neither side.
    """

    number: NDArray[np.intp]
    shares: FloatArray
    whole: NDArray[np.bool_]


def line_sides(dataset: Results, body: int, points: FloatArray, step: int) -> LineSides:
    """Sides of points (3, n) [m] along a line in a body."""
    depths = np.array(interface_depths(dataset, body, step))
    inclusions = inclusions_of(dataset, body)

    def number(at: FloatArray) -> NDArray[np.intp]:
        found = np.searchsorted(depths * (1.0 - SAME), at[2], side="right")
        for n, one in enumerate(inclusions, 1):
            inside = np.asarray(one.shape.contains(*at))
            found = np.where(inside, found + n * (depths.size + 1), found)
        return np.asarray(found, dtype=np.intp)

    own = number(points)
    breaks = np.flatnonzero(own[1:] != own[:-1])
    low, high = np.zeros(breaks.size), np.ones(breaks.size)
    first, way = points[:, breaks], points[:, breaks + 1] - points[:, breaks]
    for _ in range(HALVINGS if breaks.size else 0):
        middle = 0.5 * (low + high)
        same = number(first + middle * way) == own[breaks]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    whole = _whole(dataset, body, points, inclusions) & ~_on_border(points, inclusions)
    return LineSides(own, 0.5 * (low + high), whole)


def _on_border(points: FloatArray, inclusions: tuple[Source, ...]) -> NDArray[np.bool_]:
    """Points (3, n) of a line at which an inclusion begins or ends."""
    on = np.zeros(points.shape[1], dtype=bool)
    if points.shape[1] < 2:
        return on
    step = ON_A_BORDER * np.gradient(points, axis=1)
    for inclusion in inclusions:
        before, after = (np.asarray(inclusion.shape.contains(*(points + side * step))) for side in (-1, 1))
        on |= before != after
    return on


def _whole(dataset: Results, body: int, points: FloatArray, inclusions: tuple[Source, ...]) -> NDArray[np.bool_]:
    """Points of cells whose corners lie all within an inclusion or all outside; all where none are stored."""
    names = [f"cells_{body}_{axis}" for axis in "xyz"]
    whole = np.ones(points.shape[1], dtype=bool)
    if not inclusions or any(name not in dataset.variables or dataset.sizes[name] < 2 for name in names):
        return whole
    middles = [np.asarray(dataset[name].values, dtype=float) for name in names]
    edges = np.array([places[1] - places[0] for places in middles])[:, None]
    first = np.array([places[0] for places in middles])[:, None] - 0.5 * edges
    low = first + np.floor((points - first) / edges + SAME) * edges
    inset = [INSET, 1.0 - INSET]  # a face of cells that lies in a border is not cut
    corners = [low + edges * np.array(share)[:, None] for share in product(inset, inset, inset)]
    for one in inclusions:
        inside = np.stack([np.asarray(one.shape.contains(*corner)) for corner in corners])
        whole &= inside.all(axis=0) | ~inside.any(axis=0)
    return whole


def inclusions_of(dataset: Results, body: int) -> tuple[Source, ...]:
    """Inclusions of a body without their cells; none where the scene cannot be built again."""
    if not scene_of(dataset).get("inclusions"):
        return ()
    return tuple(one for one in _inclusions(dataset.attrs["scene"]) if one.body == body)


def inclusion_segments(dataset: Results, body: int, normal: str, at: float) -> FloatArray:
    """Borders (n, 2, 2) [m] of the inclusions of a body on a plane, for which results need not store them."""
    found = [section_outline(one, normal, at) for one in inclusions_of(dataset, body)]
    return np.concatenate([np.empty((0, 2, 2)), *found])


@lru_cache(maxsize=1)
def _inclusions(text: str) -> tuple[Source, ...]:
    import tomllib

    from eigencontact.model.bodies import bodies_of
    from eigencontact.model.sources import build_sources
    from eigencontact.scene.schema import Scene

    try:
        scene = Scene(**{**tomllib.loads(text), "eigenstrain": []})
        registry: Any = scene.known_plugins()
        prescribed, inhomogeneities = build_sources(scene, registry, None, bodies_of(scene, registry))
    except EigencontactError:
        return ()
    return (*prescribed, *inhomogeneities)
