"""Closed triangulated surfaces: built from faces and checked; volume and winding number."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray, SceneError, require
from eigencontact_plugins.shapes.polyhedron_files import read_faces

__all__ = ["Surface", "read_surface"]

IntArray = NDArray[np.intp]

#: Largest distance of the corners of a face from their plane, relative to its size: rounding to five digits in a file.
FLAT = 1e-4


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles with outward normals.

    Attributes
    ----------
    vertices : (n, 3)
        Coordinates.
    triangles : (m, 3)
        Numbers of the vertices of each triangle, counter-clockwise as seen from outside.
    """

    vertices: FloatArray
    triangles: IntArray

    @property
    def volume(self) -> float:
        """Sum of the tetrahedra between the triangles and the middle of the vertices."""
        a, b, c = (self.vertices - self.vertices.mean(axis=0))[self.triangles].transpose(1, 0, 2)
        return float(np.einsum("ni,ni->", a, np.cross(b, c)) / 6.0)

    def winding_number(self, x: FloatArray, y: FloatArray, z: FloatArray, *, pairs: int) -> FloatArray:
        """Solid angle of the surface over 4π at points ``(n,)``: 1 inside, 0 outside.

        Each triangle with corners a, b, c as seen from the point adds 2 atan2(a·(b×c), |a||b||c| + (a·b)|c| + (b·c)|a|
        + (c·a)|b|) (Van Oosterom & Strackee 1983, eq. 8).
        """
        points = np.stack([x, y, z], axis=-1)
        corners = self.vertices[self.triangles]
        result = np.empty(len(points))
        step = max(1, pairs // len(corners))
        for first in range(0, len(points), step):
            a, b, c = np.moveaxis(corners[None] - points[first : first + step, None, None, :], 2, 0)
            la, lb, lc = (np.sqrt(np.einsum("pti,pti->pt", v, v)) for v in (a, b, c))
            triple = np.einsum("pti,pti->pt", a, np.cross(b, c))
            dots = [np.einsum("pti,pti->pt", *pair) * length for *pair, length in ((a, b, lc), (b, c, la), (c, a, lb))]
            angle = np.arctan2(triple, la * lb * lc + dots[0] + dots[1] + dots[2])
            result[first : first + step] = angle.sum(axis=1) / (2.0 * np.pi)
        return result


def read_surface(where: str, file: str) -> Surface:
    """Closed surface of a mesh file, with outward normals.

    Raises
    ------
    SceneError
        The file cannot be read or contains no surface, or the surface has folded faces, is open, or of mixed
        orientation.
    """
    surface = _merged(*_triangles(where, file, *read_faces(where, file)))
    _check_closed(where, file, surface)
    return surface if surface.volume > 0 else Surface(surface.vertices, surface.triangles[:, ::-1])


def _triangles(where: str, file: str, points: FloatArray, faces: Sequence[IntArray]) -> tuple[FloatArray, IntArray]:
    """Points, with some added, and triangles of faces with any number of corners.

    A flat face is divided from one of its corners. It need not be convex: triangles outside it have the opposite
    orientation and compensate the excess of the others. A nonplanar face is divided around its middle, if all triangles
    have the same orientation.
    """
    triangles = []
    for table in faces:
        flat, bent = (table, table[:0]) if table.shape[1] == 3 else _sorted(where, file, points, table)
        triangles += [flat[:, [0, k, k + 1]] for k in range(1, table.shape[1] - 1)]
        middle = len(points) + np.arange(len(bent))
        triangles += [np.column_stack([bent[:, k - 1], bent[:, k], middle]) for k in range(table.shape[1])]
        points = np.concatenate([points, points[bent].mean(axis=1)])
    return points, np.concatenate(triangles)


def _sorted(where: str, file: str, points: FloatArray, faces: IntArray) -> tuple[IntArray, IntArray]:
    """Flat and nonplanar faces; refuses folded faces."""
    offsets = points[faces] - points[faces].mean(axis=1, keepdims=True)
    areas = np.cross(offsets, np.roll(offsets, -1, axis=1))  # twice the areas of the triangles around the middle
    normal = areas.sum(axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)
    height = np.abs(np.einsum("fci,fi->fc", offsets, normal)).max(axis=1)
    bent = height > FLAT * np.linalg.norm(offsets, axis=2).max(axis=1)
    folded = np.flatnonzero(bent & (np.einsum("fci,fi->fc", areas, normal).min(axis=1) <= 0))
    if folded.size:
        place = ", ".join(f"{value:.6g}" for value in points[faces[folded[0], 0]])
        rule = f"a mesh of flat faces: {folded.size} are folded, one of them at ({place})"
        raise SceneError(f"{where}.file must be {rule} (got {file!r}); cut them into triangles in a mesh program")
    return faces[~bent], faces[bent]


def _merged(points: FloatArray, triangles: IntArray) -> Surface:
    """Merge equal vertices (STL repeats them) and remove collapsed triangles."""
    used = points[triangles.ravel()]
    extent = float(np.ptp(used, axis=0).max()) or 1.0
    _, first, place = np.unique(np.round(used / (1e-9 * extent)), axis=0, return_index=True, return_inverse=True)
    joined = place.reshape(-1, 3)
    a, b, c = joined.T
    return Surface(used[first], joined[(a != b) & (b != c) & (c != a)])


def _check_closed(where: str, file: str, surface: Surface) -> None:
    """Check that every edge occurs equally often in both directions."""
    ends = np.concatenate([surface.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    forward = np.where(ends[:, 0] < ends[:, 1], 1, -1)
    _, place = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
    passed, balance = np.bincount(place.ravel()), np.bincount(place.ravel(), weights=forward)
    odd, unbalanced = int((passed % 2).sum()), int(np.count_nonzero(balance))
    rule = f"a closed surface: {odd} of its {passed.size} edges have no second face; close its holes in a mesh program"
    require(odd == 0, where, "file", file, rule)
    rule = f"a surface of one sense: the faces at {unbalanced} of its {passed.size} edges look to opposite sides"
    require(unbalanced == 0, where, "file", file, rule)
    require(surface.volume != 0, where, "file", file, "a surface that encloses a volume")
