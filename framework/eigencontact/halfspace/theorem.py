r"""Displacement, strain and stress of an eigenstrain in a half-space, as linear forms in potentials of its region.

The source is a region with uniform eigenstrain e in the isotropic half-space z >= 0 with a traction-free surface. With
s = (1, 1, -1), q_jk = s_j s_k e_jk, potentials Psi0, Phi0 of the region, and Psi, Phi, Chi of its mirror image::

    8 pi (1-nu) u_i = e_jk Psi0,ijk - 4(1-nu) e_ik Phi0,k - 2 nu e_kk Phi0,i                          full space
        + s_i S,i - 4(1-nu) s_i v_i + 2 z T,i + 4(1-2nu) z delta_i3 B - 2 z^2 B,i                     image
        - 2 nu e_kk [(3-4nu) s_i Phi,i + 2 z Phi,3i]

    A = q_jk Psi,jk    B = q_jk Phi,jk    v_i = q_ik Phi,k    C = q_ab Chi,ab - q_33 Phi   (a, b = 1, 2)
    S = (3-4nu) A + 4(1-nu)(1-2nu) C      T = A,3 - 4(1-nu) v_3

The eigenstress of the dilatation, lambda e_kk, is kept apart (the terms with nu e_kk): its factor 1-2nu cancels by
hand, so nu = 1/2 is an ordinary value. Strain is the symmetric gradient of the forms; stress uses the volume strain
divided by 1-2nu in closed form.

References
----------
R. D. Mindlin 1936, doi:10.1063/1.1745385 (Green's function); R. D. Mindlin and D. H. Cheng 1950,
J. Appl. Phys. 21, 926; J. H. Davies 2003, J. Appl. Mech. 70, 655 (dilatation); S. Liu et al. 2012,
Int. J. Plasticity 35, 135 (the same potentials for cuboids). Derived anew from Mindlin's Green's function.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.tensors import INDICES, SQRT2, to_matrix
from eigencontact.halfspace.forms import Form

__all__ = ["QUANTITIES", "response"]

#: Quantities of the theorem and the number of their components.
QUANTITIES = {"displacement": 3, "strain": 6, "stress": 6}

_MIRROR = (1.0, 1.0, -1.0)
_AXES = range(3)


@cache
def response(quantity: str, nu: float, space: str) -> tuple[tuple[Form, ...], ...]:
    """Forms ``[component][eigenstrain component]`` of one quantity.

    Parameters
    ----------
    quantity : {"displacement", "strain", "stress"}
        Displacement x, y, z in metres; Mandel strain; Mandel stress in units of the shear modulus.
    nu : float
        Poisson's ratio, -1 < nu <= 0.5.
    space : {"half", "full"}
        With or without the free surface z = 0.

    Returns
    -------
    tuple of tuple of Form
        Per unit of each Mandel component of the eigenstrain.
    """
    columns = [_unit_response(quantity, tensor, nu, half=space == "half") for tensor in to_matrix(np.eye(6))]
    return tuple(zip(*columns, strict=True))


def _unit_response(quantity: str, e: FloatArray, nu: float, *, half: bool) -> list[Form]:
    u = _displacement(e, nu, half=half)
    if quantity == "displacement":
        return [form.without_chi_zz() for form in u]
    strain = [(0.5 * (u[i].d(j) + u[j].d(i))).without_chi_zz() for i, j in INDICES]
    if quantity == "stress":
        volume, inside = _volume_strain(e, nu, half=half), Form.potential("inside")
        strain = [
            2.0 * (form - float(e[i, j]) * inside) + 2.0 * nu * float(i == j) * volume
            for form, (i, j) in zip(strain, INDICES, strict=True)
        ]
    return [(1.0 if i == j else SQRT2) * form for form, (i, j) in zip(strain, INDICES, strict=True)]


def _contract(e: FloatArray, potential: Form) -> Form:
    """``e_jk potential,jk``."""
    total = Form()
    for j in _AXES:
        for k in _AXES:
            total = total + float(e[j, k]) * potential.d(j).d(k)
    return total


def _along(row: Sequence[float], potential: Form) -> Form:
    """``row_k potential,k``."""
    total = Form()
    for k in _AXES:
        total = total + float(row[k]) * potential.d(k)
    return total


def _image(e: FloatArray) -> tuple[Form, Form, list[Form], Form, Form]:
    """A, B, v, C of the mirror image, and its Phi."""
    q = e * np.outer(_MIRROR, _MIRROR)
    psi, phi, chi = (Form.potential("image", name) for name in ("psi", "phi", "chi"))
    in_plane = q.copy()
    in_plane[2] = in_plane[:, 2] = 0.0
    c = _contract(in_plane, chi) - float(q[2, 2]) * phi
    return _contract(q, psi), _contract(q, phi), [_along(q[i].tolist(), phi) for i in _AXES], c, phi


def _displacement(e: FloatArray, nu: float, *, half: bool) -> list[Form]:
    scale, trace = 1.0 / (8.0 * np.pi * (1.0 - nu)), float(np.trace(e))
    psi, phi = Form.potential("real", "psi"), Form.potential("real", "phi")
    a = _contract(e, psi)
    u = [a.d(i) - 4.0 * (1.0 - nu) * _along(e[i].tolist(), phi) - 2.0 * nu * trace * phi.d(i) for i in _AXES]
    if half:
        a, b, v, c, phi = _image(e)
        s = (3.0 - 4.0 * nu) * a + 4.0 * (1.0 - nu) * (1.0 - 2.0 * nu) * c
        t = a.d(2) - 4.0 * (1.0 - nu) * v[2]
        for i in _AXES:
            u[i] = u[i] + _MIRROR[i] * (s.d(i) - 4.0 * (1.0 - nu) * v[i]) + 2.0 * t.d(i).times_z()
            u[i] = u[i] - 2.0 * b.d(i).times_z(2) + 4.0 * (1.0 - 2.0 * nu) * float(i == 2) * b.times_z()
            u[i] = u[i] - 2.0 * nu * trace * ((3.0 - 4.0 * nu) * _MIRROR[i] * phi.d(i) + 2.0 * phi.d(2).d(i).times_z())
    return [float(scale) * form for form in u]


def _volume_strain(e: FloatArray, nu: float, *, half: bool) -> Form:
    """Elastic volume strain (e_kk minus the eigenstrain's) divided by 1 - 2 nu."""
    scale, trace = float(1.0 / (8.0 * np.pi * (1.0 - nu))), float(np.trace(e))
    m = -2.0 * scale * _contract(e, Form.potential("real", "phi"))
    m = m - trace / (1.0 - nu) * Form.potential("inside")
    if half:
        a, b, _, c, phi = _image(e)
        image = 6.0 * b - 4.0 * a.d(2).d(2) - 8.0 * (1.0 - nu) * c.d(2).d(2) + 4.0 * b.d(2).times_z()
        m = m + scale * (image + 8.0 * nu * trace * phi.d(2).d(2))
    return m.without_chi_zz()
