"""Energy release rate of an edge crack in a half-plane by plane-strain elements, which judges stress intensity factors.

The mesh is a grid of quadratic quads, sheared so that one of its lines is the crack, on which nodes are doubled. Its
faces bear the traction that frees them of a uniform stress. The rate is the difference of the energies of two cracks
whose tips are nodes of one grid.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from skfem import Basis, ElementQuad2, ElementVector, FacetBasis, LinearForm, MeshQuad, asm, condense, solve
from skfem.models.elasticity import lame_parameters, linear_elasticity

__all__ = ["energy_release"]

#: Distance of the fixed border, in lengths of the crack: at 80 the rate is 7e-4 smaller than at 200.
_FAR = 200.0
#: Growth of the elements from one to the next, away from the crack.
_GROWTH = 1.2
_ROUNDING = 1e-9


def energy_release(
    inclination: float, normal_stress: float, shear_stress: float, poisson_ratio: float, cells: int
) -> float:
    """Energy release rate of a crack of unit length in a uniform stress, times Young's modulus.

    Parameters
    ----------
    inclination : float
        Between the crack and the inward normal, towards +x [rad].
    normal_stress, shear_stress : float
        n.sigma.n and t.sigma.n of the stress without the crack, on its line.
    poisson_ratio : float
    cells : int
        Elements along the crack.
    """
    shorter, longer = (
        _energy(inclination, normal_stress, shear_stress, poisson_ratio, 1.0 / cells, count)
        for count in (cells - 1, cells + 1)
    )
    return 0.5 * cells * (longer - shorter)


def _energy(
    inclination: float, normal_stress: float, shear_stress: float, poisson_ratio: float, step: float, cells: int
) -> float:
    """Elastic energy of a crack of `cells` elements of the length `step`."""
    sine, cosine = np.sin(inclination), np.cos(inclination)
    traction = normal_stress * np.array([cosine, -sine]) + shear_stress * np.array([sine, cosine])
    mesh = _mesh(inclination, step, cells)
    element = ElementVector(ElementQuad2())
    basis = Basis(mesh, element, intorder=5)
    stiffness = asm(linear_elasticity(*lame_parameters(1.0, poisson_ratio)), basis)
    facets = mesh.boundary_facets()
    x, z = mesh.p[:, mesh.facets[:, facets]].mean(axis=1)
    on_crack = (np.abs(x - z * sine / cosine) < _ROUNDING) & (z < cells * step * cosine)
    border = FacetBasis(mesh, element, facets=facets[on_crack & (z > _ROUNDING)], intorder=5)

    @LinearForm  # type: ignore[untyped-decorator]
    def push(v: Any, w: Any) -> Any:
        outward = w.n[0] * cosine - w.n[1] * sine
        return -outward * (traction[0] * v[0] + traction[1] * v[1])

    load = asm(push, border)
    fixed = basis.get_dofs(facets[~on_crack & (z > _ROUNDING)])
    return 0.5 * float(load @ solve(*condense(stiffness, load, D=fixed)))


def _mesh(inclination: float, step: float, cells: int) -> MeshQuad:
    """Half-plane z > 0 with doubled nodes on the crack, except at its tip."""
    sizes = [step]
    while sum(sizes) < _FAR:
        sizes.append(_GROWTH * sizes[-1])
    outward = np.concatenate([[0.0], np.cumsum([step] * 4 + sizes)])
    along = np.concatenate([step * np.arange(round(1.0 / step)), 1.0 + outward])
    grid = MeshQuad.init_tensor(np.concatenate([-outward[:0:-1], outward]), along)
    doubled = np.flatnonzero((np.abs(grid.p[0]) < _ROUNDING) & (grid.p[1] < cells * step - _ROUNDING))
    numbers = np.arange(grid.p.shape[1])
    numbers[doubled] = numbers.size + np.arange(doubled.size)
    quads, right = grid.t.copy(), grid.p[0][grid.t].mean(axis=0) > 0
    quads[:, right] = numbers[quads[:, right]]
    column, position = np.hstack([grid.p, grid.p[:, doubled]])
    return MeshQuad(np.array([column + position * np.sin(inclination), position * np.cos(inclination)]), quads)
