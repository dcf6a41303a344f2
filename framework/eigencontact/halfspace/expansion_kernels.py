"""Compiled sums of biharmonic polynomials, and of fields that expansions pass down a tree of points.

The polynomials are the real solid harmonics ``r^k Y_kn`` up to a degree p, scaled to Racah's norm (the sum of the
squares of one degree is ``r^2k``), and ``r²`` times those up to degree p - 2: (p+1)² + (p-1)² of them, all that a field
without body forces has up to that degree.

This module imports numba; nothing imports it before a large cloud is computed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from eigencontact.core.numba_cache import compiled

__all__ = ["grow", "moments", "pass_down", "polynomials"]

# Points at which polynomials are evaluated together.
_CHUNK = 64

_inner: Any = compiled(fastmath=True, error_model="numpy")
_compiled: Any = compiled(nogil=True, fastmath=True, error_model="numpy")


@_inner
def _fill(x: Any, y: Any, z: Any, degree: int, out: Any) -> None:
    """All polynomials ``(count, n)`` at n points: of order n and degree k in row ``k² + k ± n``, cosines above."""
    size = x.size
    cosine, sine, square = np.ones(size), np.zeros(size), np.empty(size)
    for i in range(size):
        square[i] = x[i] * x[i] + y[i] * y[i] + z[i] * z[i]
    top = 1.0  # of n times the azimuth, times the distance from the axis to the power of n
    for n in range(degree + 1):
        if n:
            top *= np.sqrt((2.0 * n - 1.0) / (2.0 * n)) if n > 1 else 1.0
            for i in range(size):
                cosine[i], sine[i] = cosine[i] * x[i] - sine[i] * y[i], cosine[i] * y[i] + sine[i] * x[i]
        # (k² - n²)^½ P_k = (2k - 1) z P_k-1 - ((k-1)² - n²)^½ r² P_k-2, first without the azimuth
        for k in range(n, degree + 1):
            row = k * (k + 1) + n
            if k == n:
                for i in range(size):
                    out[row, i] = top
            else:
                scale = 1.0 / np.sqrt(1.0 * (k * k - n * n))
                first, second = (2.0 * k - 1.0) * scale, np.sqrt((k - 1.0) ** 2 - n * n) * scale
                first_row, second_row = (k - 1) * k + n, (k - 2) * (k - 1) + n if k > n + 1 else (k - 1) * k + n
                for i in range(size):
                    out[row, i] = first * z[i] * out[first_row, i] - second * square[i] * out[second_row, i]
        for k in range(n, degree + 1):
            row = k * (k + 1)
            for i in range(size):
                if n:
                    out[row - n, i] = out[row + n, i] * sine[i]
                out[row + n, i] *= cosine[i]
    count = (degree + 1) ** 2
    for row in range((degree - 1) ** 2 if degree > 1 else 0):
        for i in range(size):
            out[count + row, i] = square[i] * out[row, i]


@_inner
def _size(degree: int) -> Any:
    return (degree + 1) ** 2 + ((degree - 1) ** 2 if degree > 1 else 0)


@_inner
def polynomials(x: Any, y: Any, z: Any, degree: int) -> Any:
    """Polynomials ``(count, n)`` at points."""
    out = np.empty((_size(degree), x.size))
    _fill(x, y, z, degree, out)
    return out


@_inner
def moments(x: Any, y: Any, z: Any, weights: Any, spreads: Any, degree: int) -> Any:
    """Moments ``(2, (degree + 1)²)`` of sources: of the harmonics, and of ``r²/(2k + 3) + spread`` times them."""
    values = polynomials(x, y, z, degree)
    out = np.zeros((2, (degree + 1) ** 2))
    for k in range(degree + 1):
        for row in range(k * k, (k + 1) * (k + 1)):
            for i in range(x.size):
                share = weights[i] * values[row, i]
                square = x[i] * x[i] + y[i] * y[i] + z[i] * z[i]
                out[0, row] += share
                out[1, row] += share * (square / (2.0 * k + 3.0) + spreads[i])
    return out


@_inner
def _add(x: Any, y: Any, z: Any, center: Any, coefficients: Any, degree: int, out: Any) -> None:
    """Add an expansion at some points to ``out (c, n)``."""
    radius = center[3]
    values = polynomials((x - center[0]) / radius, (y - center[1]) / radius, (z - center[2]) / radius, degree)
    for row in range(values.shape[0]):
        for c in range(out.shape[0]):
            factor = coefficients[c, row]
            for i in range(x.size):
                out[c, i] += factor * values[row, i]


@_compiled
def pass_down(
    x: Any, y: Any, z: Any, ranges: Any, children: Any, numbers: Any, place: Any, nodes: Any, unit: Any, degree: int,
    coefficients: Any, values: Any, out: Any,
) -> None:  # fmt: skip
    """Pass expansions of one depth of a tree to the nodes below, and to points without a closer expansion.

    Threads may do so at once for different expansions.

    Parameters
    ----------
    x, y, z : (n,)
        Points, those of a leaf next to each other.
    ranges : (k, 2) of int
        First point of every node and the end of them.
    children : (k, 2) of int
        Nodes below a node; -1 for none.
    numbers : (h,) of int
        Nodes of the depth, those whose expansions are given.
    place : (k,) of int
        Number of each node among those that have one.
    nodes : (k, 5)
        Center, radius and whether there is an expansion.
    unit : (3, m)
        Points of an expansion in units of the radius.
    degree : int
        Of the polynomials.
    coefficients : (h, c, count)
        Expansions.
    values : (expansions, c, m)
        Values at the points of all expansions; those of nodes below are added to.
    out : (c, n)
        Values at the points, added to.
    """
    for number in range(coefficients.shape[0]):
        node = numbers[number]
        center, expansion = nodes[node], coefficients[number]
        for side in range(2):
            child = children[node, side]
            if child >= 0 and nodes[child, 4] == 1.0:
                px = nodes[child, 0] + nodes[child, 3] * unit[0]
                py = nodes[child, 1] + nodes[child, 3] * unit[1]
                pz = nodes[child, 2] + nodes[child, 3] * unit[2]
                _add(px, py, pz, center, expansion, degree, values[place[child]])
            elif child >= 0 or side == 0:
                a, b = ranges[child if child >= 0 else node]
                for start in range(a, b, _CHUNK):
                    stop = min(start + _CHUNK, b)
                    _add(x[start:stop], y[start:stop], z[start:stop], center, expansion, degree, out[:, start:stop])


@compiled()
def grow(points: Any, least: int, block: int) -> Any:
    """Binary tree over points ``(3, n)``, halved along their longest extent until a leaf has at most `block` points.

    Returns
    -------
    order, nodes, ranges, parents, children, depths
        As in `eigencontact.halfspace.expansions.Tree`; nodes of fewer than `least` points have no expansion.
    """
    count = points.shape[1]
    order, upper = np.arange(count), np.empty(count, np.int64)
    ranges, nodes = [(0, count)], [(0.0, 0.0, 0.0, 0.0, 0.0)]
    parents, children, depths = [-1], [(-1, -1)], [0]
    low, high, center = np.empty(3), np.empty(3), np.empty(3)
    grown = 0
    while grown < len(ranges):
        stop = len(ranges)
        for node in range(grown, stop):
            a, b = ranges[node]
            longest = 0
            for axis in range(3):
                low[axis] = high[axis] = points[axis, order[a]]
                for i in range(a, b):
                    value = points[axis, order[i]]
                    low[axis], high[axis] = min(low[axis], value), max(high[axis], value)
                center[axis] = 0.5 * (low[axis] + high[axis])
                if high[axis] - low[axis] > high[longest] - low[longest]:
                    longest = axis
            square = 0.0
            for i in range(a, b):
                square_distance = 0.0
                for axis in range(3):
                    square_distance += (points[axis, order[i]] - center[axis]) ** 2
                square = max(square, square_distance)
            apart = 1.0 if b - a >= least and square > 0.0 else 0.0
            nodes[node] = (center[0], center[1], center[2], np.sqrt(square), apart)
            if b - a <= block or square == 0.0:
                continue
            middle, above = a, 0
            for i in range(a, b):
                if points[longest, order[i]] <= center[longest]:
                    order[middle] = order[i]
                    middle += 1
                else:
                    upper[above] = order[i]
                    above += 1
            for i in range(above):
                order[middle + i] = upper[i]
            children[node] = (len(ranges), len(ranges) + 1)
            for first, last in ((a, middle), (middle, b)):
                ranges.append((first, last))
                nodes.append((0.0, 0.0, 0.0, 0.0, 0.0))
                parents.append(node)
                children.append((-1, -1))
        depths.append(stop)
        grown = stop
    return order, np.array(nodes), np.array(ranges), np.array(parents), np.array(children), np.array(depths)
