"""Smallest balls and circles around paths, one point of a body after the other: compiled.

This module imports numba; nothing imports it before such a path is asked about.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eigencontact.core.numba_cache import compiled

__all__ = ["balls", "neighbours", "normal_extremes", "shear_radii"]

_compiled: Any = compiled(nogil=True, error_model="numpy")
# Largest and smallest of many numbers, in vectors; they must be finite.
_reduced: Any = compiled(nogil=True, error_model="numpy", fastmath={"nnan", "ninf", "nsz", "reassoc"})

# A point lies outside where its squared distance passes the squared radius by this part, and by round-off of its size.
_SLACK = 1e-12
_ROUND_OFF = 1e-28
# Two edges of a triangle are parallel where the sine of their angle, squared, is below this.
_PARALLEL = 1e-20


@_reduced
def _extremes(values: Any) -> Any:
    """Largest and smallest of some numbers."""
    high, low = values[0], values[0]
    for t in range(1, values.size):
        high, low = max(high, values[t]), min(low, values[t])
    return high, low


@_compiled
def _circle_of_three(ux: float, uy: float, vx: float, vy: float) -> Any:
    """Centre and squared radius of the circle through 0, u and v; for collinear points of the longest pair."""
    cross = ux * vy - uy * vx
    uu, vv = ux * ux + uy * uy, vx * vx + vy * vy
    if cross * cross > _PARALLEL * uu * vv:
        x, y = 0.5 * (uu * vy - vv * uy) / cross, 0.5 * (vv * ux - uu * vx) / cross
        return x, y, x * x + y * y
    wx, wy = ux - vx, uy - vy
    ww = wx * wx + wy * wy
    if ww >= uu and ww >= vv:
        return 0.5 * (ux + vx), 0.5 * (uy + vy), 0.25 * ww
    if uu >= vv:
        return 0.5 * ux, 0.5 * uy, 0.25 * uu
    return 0.5 * vx, 0.5 * vy, 0.25 * vv


@_compiled
def _squared_radius(u: Any, v: Any, size: float) -> float:
    """Squared radius of the smallest circle around points of a plane: Welzl's method, without recursion."""
    slack = _ROUND_OFF * size
    x, y, square = u[0], v[0], 0.0
    for i in range(1, u.size):
        if (u[i] - x) ** 2 + (v[i] - y) ** 2 <= square * (1.0 + _SLACK) + slack:
            continue
        x, y, square = u[i], v[i], 0.0
        for j in range(i):
            if (u[j] - x) ** 2 + (v[j] - y) ** 2 <= square * (1.0 + _SLACK) + slack:
                continue
            x, y = 0.5 * (u[i] + u[j]), 0.5 * (v[i] + v[j])
            square = 0.25 * ((u[i] - u[j]) ** 2 + (v[i] - v[j]) ** 2)
            for k in range(j):
                if (u[k] - x) ** 2 + (v[k] - y) ** 2 <= square * (1.0 + _SLACK) + slack:
                    continue
                x, y, square = _circle_of_three(u[j] - u[i], v[j] - v[i], u[k] - u[i], v[k] - v[i])
                x += u[i]
                y += v[i]
    return square


@_compiled
def _distant_pair_first(u: Any, v: Any) -> None:
    """Exchange points so that the first two are distant: few other points are outside their circle."""
    for place in range(2):
        far, distance = 0, -1.0
        for i in range(place, u.size):
            squared = (u[i] - u[0]) ** 2 + (v[i] - v[0]) ** 2
            if squared > distance:
                far, distance = i, squared
        u[place], u[far] = u[far], u[place]
        v[place], v[far] = v[far], v[place]


@_compiled
def _projected(path: Any, weights: Any, out: Any) -> None:
    """One component of a tensor, ``(steps,)``, of its plain components ``(6, steps)``."""
    w0, w1, w2, w3, w4, w5 = weights
    for t in range(out.size):
        out[t] = (
            w0 * path[0, t] + w1 * path[1, t] + w2 * path[2, t] + w3 * path[3, t] + w4 * path[4, t] + w5 * path[5, t]
        )


@_compiled
def _weights(ax: float, ay: float, az: float, nx: float, ny: float, nz: float) -> Any:
    """Weights of xx, yy, zz, yz, xz, xy in the component along a on the plane n."""
    return ax * nx, ay * ny, az * nz, ay * nz + az * ny, ax * nz + az * nx, ax * ny + ay * nx


@_compiled
def shear_radii(paths: Any, normals: Any, out: Any) -> None:
    """Radius of the smallest circle around the shear of each plane.

    Parameters
    ----------
    paths : (points, 6, steps)
        Plain components xx, yy, zz, yz, xz, xy of a symmetric tensor; neighbours in time far apart are fastest.
    normals : (1 or points, planes, 3)
        Unit normals, of all points or of each; where one is NaN, the answer is NaN.
    out : (points, planes)
        Is filled.
    """
    u, v = np.empty(paths.shape[2]), np.empty(paths.shape[2])
    for p in range(paths.shape[0]):
        q = p if normals.shape[0] > 1 else 0
        if np.isnan(normals[q, 0, 0]):
            out[p].fill(np.nan)
            continue
        path, size = paths[p], 0.0
        for c in range(6):
            high, low = _extremes(path[c])
            size = max(size, high * high, low * low)
        for k in range(normals.shape[1]):
            nx, ny, nz = normals[q, k, 0], normals[q, k, 1], normals[q, k, 2]
            if abs(nz) < 0.8:
                length = np.sqrt(nx * nx + ny * ny)
                ax, ay, az = -ny / length, nx / length, 0.0
            else:
                length = np.sqrt(ny * ny + nz * nz)
                ax, ay, az = 0.0, -nz / length, ny / length
            bx, by, bz = ny * az - nz * ay, nz * ax - nx * az, nx * ay - ny * ax
            _projected(path, _weights(ax, ay, az, nx, ny, nz), u)
            _projected(path, _weights(bx, by, bz, nx, ny, nz), v)
            _distant_pair_first(u, v)
            out[p, k] = np.sqrt(_squared_radius(u, v, size))


@_compiled
def normal_extremes(paths: Any, normals: Any, largest: Any, smallest: Any) -> None:
    """Largest and smallest normal component on each plane, ``(points, planes)``; arguments as of `shear_radii`."""
    u = np.empty(paths.shape[2])
    for p in range(paths.shape[0]):
        q = p if normals.shape[0] > 1 else 0
        if np.isnan(normals[q, 0, 0]):
            largest[p].fill(np.nan)
            smallest[p].fill(np.nan)
            continue
        for k in range(normals.shape[1]):
            nx, ny, nz = normals[q, k, 0], normals[q, k, 1], normals[q, k, 2]
            w = (nx * nx, ny * ny, nz * nz, 2.0 * ny * nz, 2.0 * nx * nz, 2.0 * nx * ny)
            _projected(paths[p], w, u)
            largest[p, k], smallest[p, k] = _extremes(u)


@_compiled
def neighbours(points: Any, normals: Any, angles: Any, turns: Any, out: Any) -> None:
    """Unit normals around others: at `angles (points,)` [rad] from `normals (points, 3)`, in the directions `turns`.

    Fills ``out[p] (turns, 3)`` of the points p that are listed.
    """
    cosines, sines = np.cos(turns), np.sin(turns)
    for p in points:
        nx, ny, nz = normals[p, 0], normals[p, 1], normals[p, 2]
        ax, ay = (1.0, 0.0) if abs(nx) < 0.7 else (0.0, 1.0)
        inner = ax * nx + ay * ny
        ax, ay, az = ax - inner * nx, ay - inner * ny, -inner * nz
        length = np.sqrt(ax * ax + ay * ay + az * az)
        ax, ay, az = ax / length, ay / length, az / length
        bx, by, bz = ny * az - nz * ay, nz * ax - nx * az, nx * ay - ny * ax
        cosine, sine = np.cos(angles[p]), np.sin(angles[p])
        for k in range(turns.size):
            c, s = sine * cosines[k], sine * sines[k]
            out[p, k, 0] = cosine * nx + c * ax + s * bx
            out[p, k, 1] = cosine * ny + c * ay + s * by
            out[p, k, 2] = cosine * nz + c * az + s * bz


@_compiled
def _copy(values: Any, out: Any, count: int) -> None:
    """First values of an array; an assignment to a slice is compiled with the words of its errors, for two seconds."""
    for i in range(count):
        out[i] = values[i]


@_compiled
def _centre_through(points: Any, chosen: Any, count: int, first: int, gram: Any, offset: Any) -> float:
    """Smallest sphere through point `first` and `count` others: its centre less `first`, and its squared radius.

    Infinity where the points depend on each other. `gram` is room for the equations.
    """
    dim = points.shape[1]
    for i in range(count):
        for j in range(i + 1):
            total = 0.0
            for c in range(dim):
                total += (points[chosen[i], c] - points[first, c]) * (points[chosen[j], c] - points[first, c])
            gram[i, j] = total
        gram[i, count] = 0.5 * gram[i, i]
    for i in range(count):  # Cholesky, forwards, backwards
        whole = gram[i, i]
        for j in range(i + 1):
            total = gram[i, j]
            for k in range(j):
                total -= gram[i, k] * gram[j, k]
            if i > j:
                gram[i, j] = total / gram[j, j]
            elif total <= 1e-13 * whole:
                return np.inf
            else:
                gram[i, i] = np.sqrt(total)
        total = gram[i, count]
        for k in range(i):
            total -= gram[i, k] * gram[k, count]
        gram[i, count] = total / gram[i, i]
    for i in range(count - 1, -1, -1):
        total = gram[i, count]
        for k in range(i + 1, count):
            total -= gram[k, i] * gram[k, count]
        gram[i, count] = total / gram[i, i]
    square = 0.0
    for c in range(dim):
        total = 0.0
        for i in range(count):
            total += gram[i, count] * (points[chosen[i], c] - points[first, c])
        offset[c] = total
        square += total * total
    return square


@_compiled
def balls(paths: Any, centres: Any, radii: Any) -> None:
    """Smallest balls around paths ``(points, steps, d)``: centres ``(points, d)``, radii ``(points,)`` are filled.

    The farthest point joins those that hold the ball; of all spheres through it and some of those the smallest that
    encloses the others is the next ball. The radius grows with each, so that the last one is exact.
    """
    steps, dim = paths.shape[1], paths.shape[2]
    support, chosen, best = np.empty(dim + 2, np.int64), np.empty(dim + 2, np.int64), np.empty(dim + 2, np.int64)
    gram, offset, centre, next_centre = np.empty((dim + 2, dim + 3)), np.empty(dim), np.empty(dim), np.empty(dim)
    for p in range(paths.shape[0]):
        points = paths[p]
        size = 0.0
        for t in range(steps):
            for c in range(dim):
                size = max(size, points[t, c] ** 2)
        slack = _ROUND_OFF * size
        support[0], count_on_boundary, square = 0, 1, 0.0
        _copy(points[0], centre, dim)
        for _ in range(40 * steps):
            far, distance = 0, -1.0
            for t in range(steps):
                total = 0.0
                for c in range(dim):
                    total += (points[t, c] - centre[c]) ** 2
                if total > distance:
                    far, distance = t, total
            if distance <= square * (1.0 + _SLACK) + slack:
                break
            smallest, best_count = np.inf, 0
            for mask in range(1, 1 << count_on_boundary):
                count = 0
                for i in range(count_on_boundary):
                    if mask >> i & 1:
                        chosen[count] = support[i]
                        count += 1
                if count > dim:
                    continue
                candidate = _centre_through(points, chosen, int(count), int(far), gram, offset)
                if candidate >= smallest:
                    continue
                encloses = True
                for i in range(count_on_boundary):
                    total = 0.0
                    for c in range(dim):
                        total += (points[support[i], c] - points[far, c] - offset[c]) ** 2
                    if total > candidate * (1.0 + 1e-10) + slack:
                        encloses = False
                        break
                if encloses:
                    smallest, best_count = candidate, count
                    _copy(chosen, best, count)
                    for c in range(dim):
                        next_centre[c] = points[far, c] + offset[c]
            if smallest <= square or best_count == 0:  # round-off
                break
            square, count_on_boundary = smallest, best_count + 1
            _copy(best, support, best_count)
            support[best_count] = far
            _copy(next_centre, centre, dim)
        _copy(centre, centres[p], dim)
        radii[p] = np.sqrt(square)
