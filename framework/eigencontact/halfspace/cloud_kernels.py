"""Fields of many point sources at many points: the theorem contracted by hand and compiled, for clouds of inclusions.

With n the offset and D_k = (1/R d/dR)^k of a radial potential f, every derivative of ``q:grad grad f`` is short::

    q:grad grad f   = t D1 + Q D2                        t = q_kk, w = q n, Q = n.w
    its gradient    = n_i (t D2 + Q D3) + 2 w_i D2
    its Hessian     = delta_ij (t D2 + Q D3) + n_i n_j (t D3 + Q D4) + 2 q_ij D2 + 2 (w_i n_j + w_j n_i) D3

and likewise for Chi in the plane. Sources are rows ``(x, y, z, scale, spread, least, e_xx, e_yy, e_zz, e_yz, e_xz,
e_xy)`` of tensor components. Squared distances below ``least`` are taken as that: sums stay finite and continuous where
they do not hold, and the caller replaces what comes out there. A region has levels of sources, rows ``(reach², first,
stop)`` from coarse to fine: a block of points takes the first whose reach ends before the block begins, or the last.

This module imports numba; nothing imports it before a cloud is computed.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np

__all__ = ["sum_displacement", "sum_stress"]

_CHUNK = 256
_compiled: Any = numba.njit(parallel=True, fastmath=True, error_model="numpy", cache=True)


@numba.njit(fastmath=True, error_model="numpy", cache=True)
def _rows_for_block(x: Any, y: Any, z: Any, centers: Any, starts: Any, levels: Any) -> Any:
    """First and last row of the sources of each region that serve a block of points."""
    out = np.empty((centers.shape[0], 2), np.int64)
    for region in range(centers.shape[0]):
        square = 0.0
        for axis, values in enumerate((x, y, z)):
            here = centers[region, axis]
            gap = max(values.min() - here, here - values.max(), 0.0)
            square += gap * gap
        level = starts[region]
        while level < starts[region + 1] - 1 and levels[level, 0] > square:
            level += 1
        out[region, 0], out[region, 1] = int(levels[level, 1]), int(levels[level, 2])
    return out


@_compiled
def sum_stress(
    x: Any, y: Any, z: Any, sources: Any, centers: Any, starts: Any, levels: Any, nu: float, half: Any, out: Any
) -> None:  # fmt: skip
    """Add stress components xx, yy, zz, yz, xz, xy (plain tensor, in units of `scale`) to `out` (6, n).

    `half` is True, or None for full space.
    """
    count, n1, n2 = x.size, 1.0 - nu, 1.0 - 2.0 * nu
    for block in numba.prange((count + _CHUNK - 1) // _CHUNK):
        first = block * _CHUNK
        total = np.zeros((6, _CHUNK))
        size = min(_CHUNK, count - first)
        last = first + size
        rows = _rows_for_block(x[first:last], y[first:last], z[first:last], centers, starts, levels)
        for region in range(rows.shape[0]):
            for s in range(rows[region, 0], rows[region, 1]):
                sx, sy, sz, scale, spread, least, exx, eyy, ezz, eyz, exz, exy = sources[s]
                t = exx + eyy + ezz
                t2 = exx + eyy
                for i in range(size):
                    X, Y, depth = x[first + i] - sx, y[first + i] - sy, z[first + i]
                    # The region itself: Psi, Phi of full space.
                    Z = depth - sz
                    r2 = max(X * X + Y * Y + Z * Z, least)
                    i2 = 1.0 / r2
                    P1 = -i2 * np.sqrt(i2)
                    P2, P3, P4 = -3.0 * i2 * P1, 15.0 * i2 * i2 * P1, -105.0 * i2 * i2 * i2 * P1
                    D2, D3, D4 = P1 + spread * P2, P2 + spread * P3, P3 + spread * P4
                    wx, wy, wz = exx * X + exy * Y + exz * Z, exy * X + eyy * Y + eyz * Z, exz * X + eyz * Y + ezz * Z
                    Q = X * wx + Y * wy + Z * wz
                    iso = t * D2 + Q * D3 - 2.0 * nu * t * P1 - 2.0 * nu * (t * P1 + Q * P2)
                    dyad = t * D3 + Q * D4 - 2.0 * nu * t * P2
                    own, mixed = 2.0 * D2 - 4.0 * n1 * P1, 2.0 * D3 - 2.0 * n1 * P2
                    total[0, i] += scale * (iso + dyad * X * X + own * exx + 2.0 * mixed * wx * X)
                    total[1, i] += scale * (iso + dyad * Y * Y + own * eyy + 2.0 * mixed * wy * Y)
                    total[2, i] += scale * (iso + dyad * Z * Z + own * ezz + 2.0 * mixed * wz * Z)
                    total[3, i] += scale * (dyad * Y * Z + own * eyz + mixed * (wy * Z + wz * Y))
                    total[4, i] += scale * (dyad * X * Z + own * exz + mixed * (wx * Z + wz * X))
                    total[5, i] += scale * (dyad * X * Y + own * exy + mixed * (wx * Y + wy * X))
                    if half is None:  # settled when it is compiled
                        continue
                    # Its mirror image; q is the mirrored eigenstrain.
                    Z = depth + sz
                    r2 = max(X * X + Y * Y + Z * Z, least)
                    i2 = 1.0 / r2
                    i1 = np.sqrt(i2)
                    P1 = -i2 * i1
                    P2, P3, P4 = -3.0 * i2 * P1, 15.0 * i2 * i2 * P1, -105.0 * i2 * i2 * i2 * P1
                    P5 = -9.0 * i2 * P4
                    D2, D3, D4, D5 = P1 + spread * P2, P2 + spread * P3, P3 + spread * P4, P4 + spread * P5
                    qyz, qxz = -eyz, -exz
                    w2x, w2y = exx * X + exy * Y, exy * X + eyy * Y
                    wx, wy, wz = w2x + qxz * Z, w2y + qyz * Z, qxz * X + qyz * Y + ezz * Z
                    Q2 = X * w2x + Y * w2y
                    Q = X * wx + Y * wy + Z * wz
                    iw = 1.0 / (r2 * i1 + Z)
                    c2 = i1 * iw * iw
                    c3 = -c2 * i1 * (i1 + 2.0 * iw)
                    c4 = c2 * i2 * (3.0 * i2 + 6.0 * i1 * iw + 6.0 * iw * iw)
                    # In-plane part of C = q_ab Chi,ab - q33 Phi, and C,33.
                    ch0, ch1 = t2 * c2 + Q2 * c3, t2 * c3 + Q2 * c4
                    C33 = t2 * P1 + Q2 * P2 - ezz * (P1 + Z * Z * P2)
                    # delta_ij and n_i n_j parts of A,ij; of B,ij; of A,ij3.
                    a0, a1 = t * D2 + Q * D3, t * D3 + Q * D4
                    b0, b1 = t * P2 + Q * P3, t * P3 + Q * P4
                    g0 = Z * a1 + 2.0 * wz * D3
                    g1 = Z * (t * D4 + Q * D5) + 2.0 * wz * D4
                    A33 = a0 + Z * Z * a1 + 2.0 * ezz * D2 + 4.0 * wz * Z * D3
                    B = t * P1 + Q * P2
                    B3 = Z * b0 + 2.0 * wz * P2
                    phi33 = P1 + Z * Z * P2
                    volume = 6.0 * B - 4.0 * A33 - 8.0 * n1 * C33 + 4.0 * depth * B3 + 8.0 * nu * t * phi33
                    k3, kc, kv, kd = 3.0 - 4.0 * nu, 4.0 * n1 * n2, 2.0 * n1, 2.0 * nu * t
                    z2, zz = 2.0 * depth, 2.0 * depth * depth
                    # e_ab = delta_ab iso + n_a n_b dyad + q_ab own + (w_a n_b + w_b n_a) mixed + terms of Chi, q_3a.
                    vT = 4.0 * n1
                    iso = k3 * a0 + kc * (ch0 - ezz * P1) + z2 * (g0 - vT * wz * P2) - zz * b0
                    iso += nu * volume - kd * (k3 * P1 + z2 * Z * P2)
                    dyad = k3 * a1 + kc * (ch1 - ezz * P2) + z2 * (g1 - vT * wz * P3) - zz * b1
                    dyad -= kd * (k3 * P2 + z2 * Z * P3)
                    own = 2.0 * k3 * D2 + 2.0 * kc * c2 - 2.0 * kv * P1 + 2.0 * z2 * Z * D3 - 2.0 * zz * P2
                    mixed = 2.0 * k3 * D3 - kv * P2 + 2.0 * z2 * Z * D4 - 2.0 * zz * P3
                    chi = 2.0 * kc * c3
                    deep = z2 * (2.0 * D3 - vT * P2)
                    total[0, i] += scale * (
                        iso + dyad * X * X + own * exx + 2.0 * X * (mixed * wx + chi * w2x + deep * qxz)
                    )
                    total[1, i] += scale * (
                        iso + dyad * Y * Y + own * eyy + 2.0 * Y * (mixed * wy + chi * w2y + deep * qyz)
                    )
                    total[5, i] += scale * (
                        dyad * X * Y
                        + own * exy
                        + mixed * (wx * Y + wy * X)
                        + chi * (w2x * Y + w2y * X)
                        + deep * (qxz * Y + qyz * X)
                    )
                    # e_a3 = A,a3 - 2(1-nu)(v_a,3 + v_3,a) + 2z T,a3 - 4nu z B,a - 2z² B,a3
                    #        - 2nu e_kk (Phi,a3 + 2z Phi,a33)
                    plane = a1 * Z + 2.0 * wz * D3 - kv * wz * P2 + z2 * (g1 * Z + a1 + 2.0 * wz * Z * D4)
                    plane += z2 * (2.0 * ezz * D3 - vT * (ezz * P2 + wz * Z * P3)) - 2.0 * nu * depth * 2.0 * b0
                    plane -= zz * (b1 * Z + 2.0 * wz * P3) + kd * (Z * P2 + z2 * (P2 + Z * Z * P3))
                    row = 2.0 * D3 * Z - kv * Z * P2 + z2 * (2.0 * Z * Z * D4 + 2.0 * D3)
                    row -= 8.0 * nu * depth * P2 + zz * 2.0 * Z * P3
                    shear = 2.0 * D2 - 2.0 * kv * P1 + z2 * (4.0 * Z * D3 - vT * Z * P2) - 2.0 * zz * P2
                    total[3, i] += scale * (plane * Y + row * wy + shear * qyz)
                    total[4, i] += scale * (plane * X + row * wx + shear * qxz)
                    # e_33
                    B33 = b0 + Z * Z * b1 + 2.0 * ezz * P2 + 4.0 * wz * Z * P3
                    A333 = g0 + Z * Z * g1 + 2.0 * Z * a1 + 2.0 * ezz * Z * D3 + 4.0 * wz * Z * Z * D4
                    A333 += 4.0 * (ezz * Z + wz) * D3
                    v33 = ezz * P1 + wz * Z * P2
                    T33 = A333 - vT * (2.0 * ezz * Z * P2 + wz * (P2 + Z * Z * P3))
                    e33 = -(1.0 - 4.0 * nu) * A33 - kc * C33 - 2.0 * kv * v33 + 4.0 * n2 * B
                    e33 += z2 * (T33 - 4.0 * nu * B3) - zz * B33
                    e33 -= kd * (-(1.0 - 4.0 * nu) * phi33 + z2 * (3.0 * Z * P2 + Z * Z * Z * P3))
                    total[2, i] += scale * (e33 + nu * volume)
        for k in range(6):
            for i in range(size):
                out[k, first + i] += total[k, i]


@_compiled
def sum_displacement(
    x: Any, y: Any, z: Any, sources: Any, centers: Any, starts: Any, levels: Any, nu: float, half: Any, out: Any
) -> None:  # fmt: skip
    """Add displacement components x, y, z (in units of `scale`) to `out` (3, n).

    `half` is True, or None for full space.
    """
    count, n1, n2 = x.size, 1.0 - nu, 1.0 - 2.0 * nu
    for block in numba.prange((count + _CHUNK - 1) // _CHUNK):
        first = block * _CHUNK
        total = np.zeros((3, _CHUNK))
        size = min(_CHUNK, count - first)
        last = first + size
        rows = _rows_for_block(x[first:last], y[first:last], z[first:last], centers, starts, levels)
        for region in range(rows.shape[0]):
            for s in range(rows[region, 0], rows[region, 1]):
                sx, sy, sz, scale, spread, least, exx, eyy, ezz, eyz, exz, exy = sources[s]
                t = exx + eyy + ezz
                t2 = exx + eyy
                for i in range(size):
                    X, Y, depth = x[first + i] - sx, y[first + i] - sy, z[first + i]
                    Z = depth - sz
                    r2 = max(X * X + Y * Y + Z * Z, least)
                    i2 = 1.0 / r2
                    P1 = -i2 * np.sqrt(i2)
                    P2, P3 = -3.0 * i2 * P1, 15.0 * i2 * i2 * P1
                    D2, D3 = P1 + spread * P2, P2 + spread * P3
                    wx, wy, wz = exx * X + exy * Y + exz * Z, exy * X + eyy * Y + eyz * Z, exz * X + eyz * Y + ezz * Z
                    Q = X * wx + Y * wy + Z * wz
                    along, row = t * D2 + Q * D3 - 2.0 * nu * t * P1, 2.0 * D2 - 4.0 * n1 * P1
                    total[0, i] += scale * (along * X + row * wx)
                    total[1, i] += scale * (along * Y + row * wy)
                    total[2, i] += scale * (along * Z + row * wz)
                    if half is None:  # settled when it is compiled
                        continue
                    Z = depth + sz
                    r2 = max(X * X + Y * Y + Z * Z, least)
                    i2 = 1.0 / r2
                    i1 = np.sqrt(i2)
                    P1 = -i2 * i1
                    P2, P3, P4 = -3.0 * i2 * P1, 15.0 * i2 * i2 * P1, -105.0 * i2 * i2 * i2 * P1
                    D2, D3, D4 = P1 + spread * P2, P2 + spread * P3, P3 + spread * P4
                    qyz, qxz = -eyz, -exz
                    w2x, w2y = exx * X + exy * Y, exy * X + eyy * Y
                    wx, wy, wz = w2x + qxz * Z, w2y + qyz * Z, qxz * X + qyz * Y + ezz * Z
                    Q2 = X * w2x + Y * w2y
                    Q = X * wx + Y * wy + Z * wz
                    iw = 1.0 / (r2 * i1 + Z)
                    c2 = i1 * iw * iw
                    c3 = -c2 * i1 * (i1 + 2.0 * iw)
                    k3, kc, vT = 3.0 - 4.0 * nu, 4.0 * n1 * n2, 4.0 * n1
                    z2, zz, kd = 2.0 * depth, 2.0 * depth * depth, 2.0 * nu * t
                    a0, a1 = t * D2 + Q * D3, t * D3 + Q * D4
                    b0 = t * P2 + Q * P3
                    B = t * P1 + Q * P2
                    # u_i along n_i, w_i, and q_i3 (from A,i3 and v_3,i); a, b = 1, 2 with sign +, 3 with -.
                    plane = k3 * a0 + kc * (t2 * c2 + Q2 * c3 - ezz * P1) - kd * (k3 * P1 + z2 * Z * P2)
                    both = z2 * (a1 * Z + 2.0 * wz * D3 - vT * wz * P2) - zz * b0
                    row = 2.0 * k3 * D2 - vT * P1
                    deep = z2 * 2.0 * Z * D3 - zz * 2.0 * P2
                    third = z2 * (2.0 * D2 - vT * P1)
                    total[0, i] += scale * ((plane + both) * X + (row + deep) * wx + 2.0 * kc * c2 * w2x + third * qxz)
                    total[1, i] += scale * ((plane + both) * Y + (row + deep) * wy + 2.0 * kc * c2 * w2y + third * qyz)
                    normal = k3 * a0 * Z + kc * (t2 * i1 * iw - Q2 * i2 * iw * (i1 + iw) - ezz * Z * P1) + row * wz
                    uz = -normal + both * Z + deep * wz + third * ezz + z2 * a0 + z2 * 2.0 * n2 * B
                    uz -= kd * (-k3 * Z * P1 + z2 * (P1 + Z * Z * P2))
                    total[2, i] += scale * uz
        for k in range(3):
            for i in range(size):
                out[k, first + i] += total[k, i]
