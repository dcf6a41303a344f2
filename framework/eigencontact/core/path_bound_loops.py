"""Upper bounds of amplitudes and normal components over all planes, one point of a body after the other: compiled.

This module imports numba; nothing imports it before such a bound is asked about.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eigencontact.core.numba_cache import compiled

__all__ = ["NORMAL", "RADIUS", "SHEAR", "SIZE", "WIDTHS", "bounds"]

#: What `bounds` computes: see `eigencontact.core.paths.PathBounds`.
SHEAR, NORMAL, SIZE, RADIUS, WIDTHS = range(5)
#: The closed form of eigenvalues errs by a part of 1e-8 of the deviator.
_SLACK = 1e-7
#: Of more points the bounds are those by J2, without eigenvalues.
_MAX_EXACT_POINTS = 1024
#: Neighbouring points whose bounds by J2 are computed together; their numbers fit the first-level cache.
_BLOCK = 64
#: A path without a part of its size in further directions has no width there.
_FLAT = 1e-24

_compiled: Any = compiled(nogil=True, error_model="numpy")


@_compiled
def _principal(xx: float, yy: float, zz: float, yz: float, xz: float, xy: float, kind: int) -> Any:
    """Largest shear, largest or largest absolute eigenvalue of a tensor of plain components."""
    mean = (xx + yy + zz) / 3.0
    xx, yy, zz = xx - mean, yy - mean, zz - mean
    second = 0.5 * (xx * xx + yy * yy + zz * zz) + yz * yz + xz * xz + xy * xy
    size = np.sqrt(second / 3.0)
    determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    cosine = determinant / (2.0 * size**3) if size > 0.0 else 0.0
    angle = np.arccos(min(max(cosine, -1.0), 1.0)) / 3.0
    if kind == SHEAR:
        return np.sqrt(3.0) * size * (np.sin(angle + np.pi / 3.0) + _SLACK)
    largest = mean + 2.0 * size * (np.cos(angle) + _SLACK)
    if kind == NORMAL:
        return largest
    return max(largest, -mean - 2.0 * size * (np.cos(angle + 2.0 * np.pi / 3.0) - _SLACK))


@_compiled
def _widths(path: Any, steps: int) -> Any:
    """Sum of half widths of a path ``(steps, 6)`` along orthonormal directions; the path is projected out of itself."""
    total, size = 0.0, 0.0
    for number in range(6):
        first, far, distance = 0, 0, 0.0
        for _ in range(2):  # a long chord: the farthest point of the farthest point
            first, distance = far, 0.0
            for t in range(steps):
                square = 0.0
                for c in range(6):
                    square += (path[t, c] - path[first, c]) ** 2
                if square > distance:
                    far, distance = t, square
        size = distance if number == 0 else size
        if distance <= _FLAT * size:
            break
        length = np.sqrt(distance)
        direction = (path[far] - path[first]) / length
        low = high = 0.0
        origin = path[first].copy()
        for t in range(steps):
            along = 0.0
            for c in range(6):
                along += (path[t, c] - origin[c]) * direction[c]
            low, high = min(low, along), max(high, along)
            for c in range(6):
                path[t, c] -= along * direction[c]
        total += 0.5 * (high - low)
    return total


@_compiled
def _copied(tensors: Any, p: int, kind: int, path: Any, squares: Any, means: Any) -> int:
    """Copy the path of a point, less the centre of the box around it, with squared deviators and means of its tensors.

    Returns the step of the largest deviator.
    """
    steps = tensors.shape[0]
    for t in range(steps):
        mean = (tensors[t, 0, p] + tensors[t, 1, p] + tensors[t, 2, p]) / 3.0
        for c in range(6):
            path[t, c] = tensors[t, c, p] - mean * (c < 3 and kind >= RADIUS)
    for c in range(6):
        low = high = path[0, c]
        for t in range(1, steps):
            low, high = min(low, path[t, c]), max(high, path[t, c])
        for t in range(steps):
            path[t, c] -= 0.5 * (low + high) * (kind != NORMAL)
    largest = 0
    for t in range(steps):
        mean, square = (path[t, 0] + path[t, 1] + path[t, 2]) / 3.0, 0.0
        for c in range(6):
            square += (path[t, c] - mean * (c < 3)) ** 2
        squares[t], means[t] = square, abs(mean) if kind == SIZE else mean * (kind == NORMAL)
        if square > squares[largest]:
            largest = t
    return largest


@_compiled
def _of_block(tensors: Any, kind: int, begin: int, work: Any, out: Any) -> None:
    """Fill the bounds by J2 of points from `begin` on; `work` ``(8, n)`` is overwritten.

    The innermost loops run over neighbouring points, for which processors have instructions.
    """
    steps, count = tensors.shape[0], min(out.size - begin, work.shape[1])
    centre, means, best = work[:6], work[6], work[7]
    means[:], best[:] = 0.0, -np.inf
    for c in range(6):
        centre[c] = 0.0
        if kind == NORMAL:
            continue
        for p in range(count):
            low = high = tensors[0, c, begin + p]
            if kind == RADIUS and c < 3:
                low = high = (
                    low - (tensors[0, 0, begin + p] + tensors[0, 1, begin + p] + tensors[0, 2, begin + p]) / 3.0
                )
            means[p], centre[c, p] = low, high
        for t in range(1, steps):
            for p in range(count):
                value = tensors[t, c, begin + p]
                if kind == RADIUS and c < 3:
                    value -= (tensors[t, 0, begin + p] + tensors[t, 1, begin + p] + tensors[t, 2, begin + p]) / 3.0
                means[p], centre[c, p] = min(means[p], value), max(centre[c, p], value)
        for p in range(count):
            centre[c, p] = 0.5 * (means[p] + centre[c, p])
    factor = 1.0 if kind == RADIUS else (0.5 if kind == SHEAR else 2.0 / 3.0) * (1.0 + 1e-12)
    for t in range(steps):
        for p in range(count):
            xx, yy = tensors[t, 0, begin + p] - centre[0, p], tensors[t, 1, begin + p] - centre[1, p]
            zz, yz = tensors[t, 2, begin + p] - centre[2, p], tensors[t, 3, begin + p] - centre[3, p]
            xz, xy = tensors[t, 4, begin + p] - centre[4, p], tensors[t, 5, begin + p] - centre[5, p]
            mean = (xx + yy + zz) / 3.0
            xx, yy, zz = xx - mean, yy - mean, zz - mean
            value = factor * (xx * xx + yy * yy + zz * zz + yz * yz + xz * xz + xy * xy)
            if kind == NORMAL:
                value = mean + np.sqrt(value)
            elif kind == SIZE:
                value = abs(mean) + np.sqrt(value)
            best[p] = max(best[p], value)
    for p in range(count):
        out[begin + p] = best[p] if kind in (NORMAL, SIZE) else np.sqrt(best[p])


@_compiled
def bounds(tensors: Any, kind: int, out: Any) -> None:
    """Fill the bounds ``(points,)`` of one kind for paths of Mandel vectors ``(steps, 6, points)``.

    A tensor of an amplitude is that less the centre of the box around the path. The largest shear is at most the root
    of J2, the largest eigenvalue at most the mean and 2 / sqrt 3 of that root. Eigenvalues are found of few points, and
    there at steps whose bound by J2 passes the largest eigenvalue so far.
    """
    if out.size > _MAX_EXACT_POINTS and kind != WIDTHS:
        work = np.empty((8, _BLOCK))
        for begin in range(0, out.size, _BLOCK):
            _of_block(tensors, kind, begin, work, out)
        return
    steps = tensors.shape[0]
    path, root = np.empty((steps, 6)), np.sqrt(2.0)
    squares, means = np.empty(steps), np.empty(steps)
    factor = (0.5 if kind == SHEAR else 2.0 / 3.0) * (1.0 + 1e-12)
    for p in range(out.size):
        largest = _copied(tensors, p, kind, path, squares, means)
        if kind == WIDTHS:
            out[p] = _widths(path, steps)
        elif kind == RADIUS:
            out[p] = np.sqrt(squares[largest])
        else:
            best = -np.inf
            for number in range(-1, steps):
                t = number if number >= 0 else largest
                value = means[t] + np.sqrt(factor * squares[t])
                if value > best:
                    row = path[t]
                    value = _principal(row[0], row[1], row[2], row[3] / root, row[4] / root, row[5] / root, kind)
                best = max(best, value)
            out[p] = best
