"""Fields of many point sources at many points: the theorem contracted by hand and compiled, for clouds of inclusions.

With n the offset and D_k = (1/R d/dR)^k of a radial potential f, every derivative of ``q:grad grad f`` is short::

    q:grad grad f   = t D1 + Q D2                        t = q_kk, w = q n, Q = n.w
    its gradient    = n_i (t D2 + Q D3) + 2 w_i D2
    its Hessian     = delta_ij (t D2 + Q D3) + n_i n_j (t D3 + Q D4) + 2 q_ij D2 + 2 (w_i n_j + w_j n_i) D3

and likewise for Chi in the plane. Sources are rows ``(x, y, z, scale, spread, e_xx, e_yy, e_zz, e_yz, e_xz, e_xy)`` of
tensor components. A point closer to a region than its least distance gets nothing of it, and one closer to its mirror
image nothing of that: the caller adds what belongs there.

A region has levels of sources, rows ``(reach², first, stop)`` from coarse to fine: a block of points takes the first
whose reach ends before the block begins, or the last; its mirror image, further away, often a coarser one.

Blocks of points are rows ``(first, stop, node, role)``. The node is that of a tree (`expansions`) to which the points
belong. Role 1: they carry the node's expansion, and take the regions that are far from the node but not from the nodes
above it. Role 0: they are the points of a leaf, and take all regions that are far from no node above. Without a tree
the node is -1, and a block takes every region.

This module imports numba; nothing imports it before a cloud is computed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eigencontact.core.numba_cache import compiled

__all__ = ["sum_sources"]

_inner: Any = compiled(fastmath=True, error_model="numpy")
_compiled: Any = compiled(nogil=True, fastmath=True, error_model="numpy")


@_inner
def _is_far(node: int, region: int, nodes: Any, regions: Any, apart: float) -> Any:
    """Whether a node may use the expansion of a region."""
    if nodes[node, 4] == 0.0:
        return False
    square = 0.0
    for axis in range(3):
        square += (nodes[node, axis] - regions[region, axis]) ** 2
    distance, radius = np.sqrt(square), nodes[node, 3]
    return radius <= apart * (distance - regions[region, 3]) and distance - radius >= regions[region, 4]


@_inner
def _is_taken(block: Any, region: int, nodes: Any, parents: Any, regions: Any, apart: float) -> Any:
    """Whether a block uses a region."""
    node = block[2]
    if node < 0:
        return True
    if _is_far(node, region, nodes, regions, apart) != (block[3] == 1):
        return False
    node = parents[node]
    while node >= 0:
        if _is_far(node, region, nodes, regions, apart):
            return False
        node = parents[node]
    return True


@_inner
def _gap(box: Any, center: Any, side: float) -> Any:
    """Square of the gap between a box and the center of a region (side 1) or of its image (-1)."""
    square = 0.0
    for axis in range(3):
        place = center[axis] * (side if axis == 2 else 1.0)
        gap = max(box[0, axis] - place, place - box[1, axis], 0.0)
        square += gap * gap
    return square


@_inner
def _all_near(box: Any, center: Any, side: float) -> Any:
    """Whether all points of a box are closer to a region than its least distance."""
    square = 0.0
    for axis in range(3):
        place = center[axis] * (side if axis == 2 else 1.0)
        square += max(abs(place - box[0, axis]), abs(place - box[1, axis])) ** 2
    return square < 0.999 * center[4] ** 2


@compiled()
def _clear(x: Any, y: Any, z: Any, center: Any, side: float, near_sum: Any) -> None:
    """Subtract from points the regions that are too close; rounded like numpy, for equal decisions of the caller."""
    least = center[4] * center[4]
    for i in range(x.size):
        dx, dy, dz = x[i] - center[0], y[i] - center[1], z[i] - side * center[2]
        if dx * dx + dy * dy + dz * dz < least:
            for c in range(len(near_sum)):
                near_sum[c, i] = 0.0


@_inner
def _stress_by_itself(x: Any, y: Any, z: Any, source: Any, nu: float, total: Any) -> None:
    """Add the stress of a source in full space at some points: Psi, Phi of the region itself."""
    sx, sy, sz, scale, spread, exx, eyy, ezz, eyz, exz, exy = source
    t = exx + eyy + ezz
    n1 = 1.0 - nu
    for i in range(x.size):
        X, Y = x[i] - sx, y[i] - sy
        Z = z[i] - sz
        r2 = X * X + Y * Y + Z * Z
        i2 = 1.0 / r2
        P1 = -i2 * np.sqrt(i2)
        P2, P3, P4 = -3.0 * i2 * P1, 15.0 * i2 * i2 * P1, -105.0 * i2 * i2 * i2 * P1
        D2, D3, D4 = P1 + spread * P2, P2 + spread * P3, P3 + spread * P4
        wx, wy, wz = exx * X + exy * Y + exz * Z, exy * X + eyy * Y + eyz * Z, exz * X + eyz * Y + ezz * Z
        Q = X * wx + Y * wy + Z * wz
        iso = t * D2 + Q * D3 - 2.0 * nu * t * P1 - 2.0 * nu * (t * P1 + Q * P2)
        dyad = t * D3 + Q * D4 - 2.0 * nu * t * P2
        straight, mixed = 2.0 * D2 - 4.0 * n1 * P1, 2.0 * D3 - 2.0 * n1 * P2
        total[0, i] += scale * (iso + dyad * X * X + straight * exx + 2.0 * mixed * wx * X)
        total[1, i] += scale * (iso + dyad * Y * Y + straight * eyy + 2.0 * mixed * wy * Y)
        total[2, i] += scale * (iso + dyad * Z * Z + straight * ezz + 2.0 * mixed * wz * Z)
        total[3, i] += scale * (dyad * Y * Z + straight * eyz + mixed * (wy * Z + wz * Y))
        total[4, i] += scale * (dyad * X * Z + straight * exz + mixed * (wx * Z + wz * X))
        total[5, i] += scale * (dyad * X * Y + straight * exy + mixed * (wx * Y + wy * X))


@_inner
def _stress_by_image(x: Any, y: Any, z: Any, source: Any, nu: float, total: Any) -> None:
    """Add the stress of the mirror image of a source; q is the mirrored eigenstrain."""
    sx, sy, sz, scale, spread, exx, eyy, ezz, eyz, exz, exy = source
    t = exx + eyy + ezz
    t2 = exx + eyy
    n1, n2 = 1.0 - nu, 1.0 - 2.0 * nu
    for i in range(x.size):
        X, Y, depth = x[i] - sx, y[i] - sy, z[i]
        Z = depth + sz
        r2 = X * X + Y * Y + Z * Z
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
        # e_ab = delta_ab iso + n_a n_b dyad + q_ab straight + (w_a n_b + w_b n_a) mixed + terms of Chi, q_3a.
        vT = 4.0 * n1
        iso = k3 * a0 + kc * (ch0 - ezz * P1) + z2 * (g0 - vT * wz * P2) - zz * b0
        iso += nu * volume - kd * (k3 * P1 + z2 * Z * P2)
        dyad = k3 * a1 + kc * (ch1 - ezz * P2) + z2 * (g1 - vT * wz * P3) - zz * b1
        dyad -= kd * (k3 * P2 + z2 * Z * P3)
        straight = 2.0 * k3 * D2 + 2.0 * kc * c2 - 2.0 * kv * P1 + 2.0 * z2 * Z * D3 - 2.0 * zz * P2
        mixed = 2.0 * k3 * D3 - kv * P2 + 2.0 * z2 * Z * D4 - 2.0 * zz * P3
        chi = 2.0 * kc * c3
        deep = z2 * (2.0 * D3 - vT * P2)
        total[0, i] += scale * (iso + dyad * X * X + straight * exx + 2.0 * X * (mixed * wx + chi * w2x + deep * qxz))
        total[1, i] += scale * (iso + dyad * Y * Y + straight * eyy + 2.0 * Y * (mixed * wy + chi * w2y + deep * qyz))
        total[5, i] += scale * (
            dyad * X * Y
            + straight * exy
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


@_inner
def _displacement_by_itself(x: Any, y: Any, z: Any, source: Any, nu: float, total: Any) -> None:
    """Add the displacement of a source in full space at some points: Psi, Phi of the region itself."""
    sx, sy, sz, scale, spread, exx, eyy, ezz, eyz, exz, exy = source
    t = exx + eyy + ezz
    n1 = 1.0 - nu
    for i in range(x.size):
        X, Y = x[i] - sx, y[i] - sy
        Z = z[i] - sz
        r2 = X * X + Y * Y + Z * Z
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


@_inner
def _displacement_by_image(x: Any, y: Any, z: Any, source: Any, nu: float, total: Any) -> None:
    """Add the displacement of the mirror image of a source; q is the mirrored eigenstrain."""
    sx, sy, sz, scale, spread, exx, eyy, ezz, eyz, exz, exy = source
    t = exx + eyy + ezz
    t2 = exx + eyy
    n1, n2 = 1.0 - nu, 1.0 - 2.0 * nu
    for i in range(x.size):
        X, Y, depth = x[i] - sx, y[i] - sy, z[i]
        Z = depth + sz
        r2 = X * X + Y * Y + Z * Z
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
        along = z2 * (a1 * Z + 2.0 * wz * D3 - vT * wz * P2) - zz * b0
        row = 2.0 * k3 * D2 - vT * P1
        deep = z2 * 2.0 * Z * D3 - zz * 2.0 * P2
        third = z2 * (2.0 * D2 - vT * P1)
        total[0, i] += scale * ((plane + along) * X + (row + deep) * wx + 2.0 * kc * c2 * w2x + third * qxz)
        total[1, i] += scale * ((plane + along) * Y + (row + deep) * wy + 2.0 * kc * c2 * w2y + third * qyz)
        normal = k3 * a0 * Z + kc * (t2 * i1 * iw - Q2 * i2 * iw * (i1 + iw) - ezz * Z * P1) + row * wz
        uz = -normal + along * Z + deep * wz + third * ezz + z2 * a0 + z2 * 2.0 * n2 * B
        uz -= kd * (-k3 * Z * P1 + z2 * (P1 + Z * Z * P2))
        total[2, i] += scale * uz


@_inner
def _add(side: int, x: Any, y: Any, z: Any, source: Any, nu: float, total: Any) -> None:
    """Add a source (side 0) or its mirror image (1): stress to six components, displacement to three."""
    if len(total) == 6:
        if side == 0:
            _stress_by_itself(x, y, z, source, nu, total)
        else:
            _stress_by_image(x, y, z, source, nu, total)
    elif side == 0:
        _displacement_by_itself(x, y, z, source, nu, total)
    else:
        _displacement_by_image(x, y, z, source, nu, total)


@_compiled
def sum_sources(x: Any, y: Any, z: Any, blocks: Any, tree: Any, sources: Any, nu: float, half: Any, out: Any) -> None:
    """Sum the fields of all sources at the points of some blocks into `out`, in units of `scale`.

    Threads may do so at once for different blocks.

    Parameters
    ----------
    x, y, z : (n,)
        Points.
    blocks : (b, 4) of int
        See above.
    tree : (nodes (k, 5), parents (k,), apart)
        Center, radius and whether there is an expansion; a region is far if the radius is below `apart` times its gap.
    sources : (rows (m, 11), regions (r, 5), starts (r + 1,), levels (l, 3))
        Regions are rows of center, reach of the sources, least distance.
    nu : float
        Poisson's ratio.
    half : bool
        Half-space; full space otherwise.
    out : (6, n) or (3, n)
        Stress components xx, yy, zz, yz, xz, xy (plain tensor), or displacement components x, y, z.
    """
    rows, regions, starts, levels = sources
    nodes, parents, apart = tree
    components = len(out)
    box = np.empty((2, 3))
    for block in blocks:
        first, stop = block[0], block[1]
        px, py, pz = x[first:stop], y[first:stop], z[first:stop]
        for axis, points in enumerate((px, py, pz)):
            box[0, axis], box[1, axis] = points.min(), points.max()
        total, near_sum = np.zeros((components, stop - first)), np.zeros((components, stop - first))
        for region in range(regions.shape[0]):
            if not _is_taken(block, region, nodes, parents, regions, apart):
                continue
            for side in range(2 if half else 1):
                sign = 1.0 - 2.0 * side
                square = _gap(box, regions[region], sign)
                level = starts[region]
                while level < starts[region + 1] - 1 and levels[level, 0] > square:
                    level += 1
                near = square < regions[region, 4] ** 2
                if near:
                    if _all_near(box, regions[region], sign):
                        continue
                    near_sum.fill(0.0)
                for s in range(int(levels[level, 1]), int(levels[level, 2])):
                    _add(side, px, py, pz, rows[s], nu, near_sum if near else total)
                if near:
                    _clear(px, py, pz, regions[region], sign, near_sum)
                    for c in range(components):
                        for i in range(stop - first):
                            total[c, i] += near_sum[c, i]
        for c in range(components):
            for i in range(stop - first):
                out[c, first + i] = total[c, i]
