"""Polyhedron with a surface from a mesh file."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import (
    DataFile,
    FloatArray,
    InclusionShape,
    Length,
    Place,
    Rotation,
    as_tuple,
    hook_for,
    real_points,
    require,
    rotation_matrix,
)
from eigencontact_plugins.shapes.polyhedron_mesh import Surface, read_surface
from eigencontact_plugins.shapes.polyhedron_rays import Bins, sorted_into_bins
from eigencontact_plugins.shapes.polyhedron_volumes import volumes_in_cells

__all__ = ["Polyhedron"]

Point = tuple[float, float, float]

#: Pairs of points and triangles per block.
PAIRS = 1 << 17
#: Round-off of the volume in a cell, below which a cell is empty or full.
ROUNDING = 1e-12


@dataclass(frozen=True, kw_only=True)
class Polyhedron(InclusionShape):
    """Region inside a closed surface of flat faces, with any number of corners.

    Parameters
    ----------
    file : str
        Surface mesh: STL, PLY, OBJ, OFF, VTK (unstructured grid) or VTU. Every edge must belong to two faces of
        opposite orientation. If all faces point inwards, the program reverses them. Several closed parts, and cavities,
        are allowed. Nonplanar faces are divided into triangles around their middle; folded ones are refused.
    scale : float
        Metres per unit of the coordinates in the file.
    rotation : (3, 3) or (3,), optional
        Matrix whose columns are the directions of the mesh's axes in the scene, or three angles [rad] yaw, pitch, roll:
        ``Rz(yaw) Ry(pitch) Rx(roll)``.
    offset : (float, float, float)
        Position of the origin of the mesh (x, y, z) [m], after scaling and rotation.

    Notes
    -----
    The shape has no potentials: the framework divides it into cuboids with volume fractions, which are exact unless
    parts of the body overlap. A point is inside if the winding number of the surface around it, counted along a ray, is
    not zero. For the few points with a ray through an edge or a corner, the solid angle of the whole surface decides.
    """

    key: ClassVar[str] = "polyhedron"
    references: ClassVar[tuple[str, ...]] = (
        "A. Van Oosterom & J. Strackee 1983, doi:10.1109/TBME.1983.325207 (solid angle of a triangle)",
        "S. Liu & Q. Wang 2005, J. Appl. Mech. 72, 871 (sum over cuboids)",
    )

    file: DataFile
    scale: Length = 1.0
    rotation: Rotation | None = None
    offset: Place = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name in ("rotation", "offset"):
            object.__setattr__(self, name, as_tuple(getattr(self, name)))
        require(0 < self.scale < np.inf, self.key, "scale", self.scale, "positive and finite [m]")
        good = np.shape(self.offset) == (3,) and bool(np.isfinite(self.offset).all())
        require(good, self.key, "offset", self.offset, "three finite lengths (x, y, z) [m]")
        _ = self.surface  # read and check the file before the run

    @cached_property
    def surface(self) -> Surface:
        """Vertices in scene coordinates [m] and triangles with outward normals."""
        mesh = read_surface(self.key, self.file)
        turn = rotation_matrix(self.key, self.rotation)
        return Surface(mesh.vertices * self.scale @ turn.T + np.array(self.offset), mesh.triangles)

    @property
    def volume(self) -> float:
        """Volume [m³], by the divergence theorem."""
        return self.surface.volume

    @property
    def bounds(self) -> tuple[Point, Point]:
        """Corners of lowest and of highest coordinates [m]."""
        vertices = self.surface.vertices[np.unique(self.surface.triangles)]
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        return (float(low[0]), float(low[1]), float(low[2])), (float(high[0]), float(high[1]), float(high[2]))

    def contains(self, x: FloatArray, y: FloatArray, z: FloatArray) -> NDArray[np.bool_]:
        """Whether points lie inside; undefined on the surface."""
        x, y, z = real_points(self.key, x, y, z)
        points = np.broadcast_arrays(*(np.asarray(t, dtype=float) for t in (x, y, z)))
        low, high = self.bounds
        near = np.ones(points[0].shape, dtype=bool)
        for t, a, b in zip(points, low, high, strict=True):
            near &= (t >= a) & (t <= b)
        inside = np.zeros_like(near)
        candidates = np.stack([t[near] for t in points], axis=-1)
        winding, doubt = self._bins.winding(candidates)
        within = winding > 0
        within[doubt] = self.surface.winding_number(*candidates[doubt].T, pairs=PAIRS) > 0.5
        inside[near] = within
        return inside

    def volume_fractions(self, low: Point, edges: Point, shape: tuple[int, int, int]) -> FloatArray | None:
        """Fraction of each cell inside, ``(nz, ny, nx)``, to round-off; None if parts of the body overlap."""
        corners = (self.surface.vertices[self.surface.triangles] - np.array(low)) / np.array(edges)
        volumes = volumes_in_cells(corners, shape)
        volumes[np.abs(volumes) < ROUNDING] = 0.0
        volumes[np.abs(volumes - 1.0) < ROUNDING] = 1.0
        return volumes if volumes.min() >= 0 and volumes.max() <= 1 else None

    @cached_property
    def _bins(self) -> Bins:
        return sorted_into_bins(self.surface.vertices[self.surface.triangles])


eigencontact_register = hook_for(Polyhedron)
