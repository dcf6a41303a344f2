"""A rigid body of revolution on the surface: it presses where the surface would be inside it, and friction holds it.

The pressure at a node of the surface is a stiff spring on the overlap, ``p = k max(0, overlap)``, and its force that of
Simpson's rule on the edges. (Two Gauss points an edge leave a pressure that alternates and does no work.) With
k = 1e4 E over the size of the elements the overlap that is left is a few millionths of the depth.

Friction is a spring of a hundredth of that stiffness from the place where a node was at the end of the last increment,
whose force is at most the friction coefficient times the pressure (backward Euler). A node that comes into contact
sticks where it was at the end of the last increment.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skfem import CellBasis

__all__ = ["Surface", "surface_of"]

FloatArray = NDArray[np.float64]

#: Nodes on either side of an edge of contact that tell where it is.
_NODES = 4
#: Stiffness that holds a node over that which presses it: a stiffer one makes sticking nodes change to and fro.
_HOLD = 1e-2


@dataclass(frozen=True, kw_only=True, eq=False)
class Surface:
    """Nodes of the surface where contact is looked for, by rising r; not the one on the axis, which has no weight.

    Attributes
    ----------
    r, weight : (n,) float64
        Place, and r dr.
    unknowns, radial : (n,) int64
        Number of u_z and of u_r of each node.
    axis : int
        Number of u_z of the node on the axis.
    height : (n,) float64
        Of the rigid body above its lowest point, which is on the axis.
    stiffness : float
        k, stress over length.
    friction : float
        Friction coefficient.
    """

    r: FloatArray
    weight: FloatArray
    unknowns: NDArray[np.int64]
    radial: NDArray[np.int64]
    axis: int
    height: FloatArray
    stiffness: float
    friction: float = 0.0

    @property
    def hold(self) -> float:
        """Stiffness of the spring that holds a node where it sticks, stress over length."""
        return _HOLD * self.stiffness

    def pressure(self, u: FloatArray, depth: float) -> FloatArray:
        """Pressure (n,) at a displacement of the body and a depth of the rigid body."""
        return np.maximum(0.0, self.stiffness * (depth - self.height - u[self.unknowns]))

    def shear(
        self, u: FloatArray, before: FloatArray, last: FloatArray, p: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Shear (n,) on the body, positive outwards, and its sense where it slips: 1, -1, or 0 where it sticks.

        Parameters
        ----------
        u, before : (unknowns,) float64
            Displacement now, and at the end of the last increment.
        last, p : (n,) float64
            Shear at the end of the last increment; pressure now.
        """
        trial, most = last - self.hold * (u - before)[self.radial], self.friction * p
        return np.clip(trial, -most, most), np.where((np.abs(trial) > most) & (p > 0), np.sign(trial), 0.0)

    def touching(self, u: FloatArray) -> float:
        """Depth at which the rigid body just touches."""
        return float(min(u[self.axis], np.min(u[self.unknowns] + self.height)))

    def contact_radius(self, u: FloatArray, depth: float) -> float:
        """Radius where contact ends, between nodes; 0 without contact.

        Towards an edge the pressure falls as a root of the distance and the gap rises with its power 3/2, whatever the
        profile: the mean of where p² against r² and gap^(2/3) against r come to zero, on lines through four nodes each.
        """
        overlap = depth - self.height - u[self.unknowns]
        inside = np.flatnonzero(overlap > 0)
        if inside.size < _NODES or inside[-1] + _NODES >= len(self.r):
            return float(self.r[inside].max(initial=0.0))
        last = int(inside[-1])
        within, beyond = np.s_[last + 1 - _NODES : last + 1], np.s_[last + 1 : last + 1 + _NODES]
        first = np.sqrt(max(_zero(self.r[within] ** 2, overlap[within] ** 2), 0.0))
        second = _zero(self.r[beyond], np.maximum(-overlap[beyond], 0.0) ** (2 / 3))
        low, high = self.r[last - 1], self.r[last + 2]
        return float(np.mean(np.clip((first, second), low, high)))


def _zero(x: FloatArray, y: FloatArray) -> float:
    """Where the line of least squares through points (n,) comes to zero."""
    slope, start = np.polyfit(x - x[0], y, 1)
    return float(x[0] - start / slope)


def surface_of(
    basis: CellBasis,
    *,
    reach: float,
    height: Callable[[FloatArray], FloatArray],
    stiffness: float,
    friction: float = 0.0,
) -> Surface:
    """Nodes of the surface z = 0 within r <= reach, below a body of the profile ``height(r)``."""
    corners, middles = basis.nodal_dofs[1], basis.facet_dofs[1]
    mesh = basis.mesh
    facets = mesh.boundary_facets()
    facets = facets[np.all(mesh.p[1, mesh.facets[:, facets]] == 0, axis=0)]
    facets = facets[mesh.p[0, mesh.facets[:, facets]].max(axis=0) <= reach * (1 + 1e-12)]
    ends = mesh.facets[:, facets]
    length = np.abs(np.diff(mesh.p[0, ends], axis=0))[0]
    weight = np.zeros(basis.N)
    for unknowns, share in ((corners[ends[0]], 1 / 6), (corners[ends[1]], 1 / 6), (middles[facets], 4 / 6)):
        np.add.at(weight, unknowns, share * length * basis.doflocs[0, unknowns])
    loaded = np.flatnonzero(weight)
    loaded = loaded[np.argsort(basis.doflocs[0, loaded])]
    r = np.asarray(basis.doflocs[0, loaded])
    partner = np.zeros(basis.N, dtype=np.int64)  # u_r of the node of each u_z
    partner[corners], partner[middles] = basis.nodal_dofs[0], basis.facet_dofs[0]
    axis = int(corners[ends[mesh.p[0, ends] == 0][0]])
    return Surface(
        r=r, weight=weight[loaded], unknowns=loaded, radial=partner[loaded], axis=axis, height=np.asarray(height(r)),
        stiffness=stiffness, friction=friction,
    )  # fmt: skip
