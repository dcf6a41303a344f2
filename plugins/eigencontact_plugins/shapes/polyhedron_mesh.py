"""Closed surfaces of triangles: reading, checking, volume and winding number."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import SceneError, require

__all__ = ["Surface", "read_surface"]

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.intp]
FORMATS = {".stl": "stl", ".ply": "ply", ".obj": "obj", ".off": "off", ".vtk": "vtk", ".vtu": "vtu"}


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles that look outwards.

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
    """Closed surface of a mesh file, its triangles turned outwards.

    Raises
    ------
    SceneError
        For a file that cannot be read, holds no surface, or one that is open or of mixed sense.
    """
    path = Path(file)
    suffix = path.suffix.lower()
    require(path.is_file(), where, "file", file, "an existing file; a relative path counts from the scene's folder")
    require(suffix in FORMATS, where, "file", file, f"a surface mesh of one of the types {', '.join(FORMATS)}")
    import meshio  # type: ignore[import-untyped,unused-ignore]

    try:
        with np.errstate(over="ignore"):  # it takes the start of a text STL for a number of triangles first
            mesh: Any = getattr(meshio, FORMATS[suffix]).read(str(path))
    except (Exception, SystemExit) as problem:  # its readers raise errors of many kinds
        reason = (str(problem).strip().splitlines() or [type(problem).__name__])[0]
        raise SceneError(f"{where}.file must be a readable mesh (got {file!r}); {reason}") from problem
    triangles = _triangles(mesh.cells)
    volumes = sorted({block.type for block in mesh.cells if block.dim == 3})
    require(not volumes, where, "file", file, f"a surface mesh without {', '.join(volumes)} cells; extract its surface")
    require(len(triangles) > 0, where, "file", file, "a mesh with triangles; it holds none")
    surface = _merged(np.asarray(mesh.points, dtype=float), triangles)
    _check_closed(where, file, surface)
    return surface if surface.volume > 0 else Surface(surface.vertices, surface.triangles[:, ::-1])


def _triangles(blocks: Any) -> IntArray:
    """Triangles of all faces; polygons as fans."""
    parts = [np.empty((0, 3), dtype=np.intp)]
    for block in blocks:
        if block.type in ("triangle", "quad", "polygon") or block.type.startswith("polygon"):
            faces = np.atleast_2d(np.asarray(block.data, dtype=np.intp))
            parts += [faces[:, [0, k, k + 1]] for k in range(1, faces.shape[1] - 1)]
    return np.concatenate(parts)


def _merged(points: FloatArray, triangles: IntArray) -> Surface:
    """Equal vertices become one (STL repeats them), collapsed triangles vanish."""
    used = points[triangles.ravel()]
    extent = float(np.ptp(used, axis=0).max()) or 1.0
    _, first, place = np.unique(np.round(used / (1e-9 * extent)), axis=0, return_index=True, return_inverse=True)
    joined = place.reshape(-1, 3)
    a, b, c = joined.T
    return Surface(used[first], joined[(a != b) & (b != c) & (c != a)])


def _check_closed(where: str, file: str, surface: Surface) -> None:
    """Every edge is passed as often one way as the other."""
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
