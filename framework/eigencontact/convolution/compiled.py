"""Loops of the volume sums that numba compiles; plain Python otherwise, and never called uncompiled.

On one core the contraction of stress (17 rows, 138 products for each wavenumber) takes a third of the time of numpy
calls on blocks of the same size, and compiled loops run in threads without waiting for the interpreter.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from typing import Any

from numpy.typing import NDArray

__all__ = ["available", "compiled_loops"]

Array = NDArray[Any]

# Wavenumbers kz taken at a time, so that the columns of one block stay in the first-level cache.
BLOCK = 40
# Products added at a time; rows have a multiple of this many entries.
GROUP = 3


def available() -> bool:
    """Whether numba is installed."""
    return find_spec("numba") is not None


@cache
def compiled_loops() -> tuple[Callable[..., None], Callable[..., None]]:
    """Compile `contract` and `collect`; the result is kept on disk, so that only the first run ever waits for it."""
    import numba

    decorate = numba.njit(cache=True, nogil=True, fastmath={"contract"})
    return decorate(contract), decorate(collect)


def contract(
    waves: Array, kernels: Array, piece: int, size: int, entries: Array, columns: Array, terms: Array, numbers: Array,
    coefficients: Array, sums: Array, column: Array, weight: Array, total: Array,
) -> None:  # fmt: skip
    """Sum kernels times sources for the wavenumbers of one piece.

    Parameters
    ----------
    waves : (n, signs, size, Fz + 1) complex
        Spectra of the sources, the value at kz = 0 repeated behind the last.
    kernels : (n_kernels, ky, 2, kz)
        Real and imaginary parts.
    piece, size : int
        First wavenumber ky of the piece, and their number.
    entries : (rows + 1,) int
        Entries of each row; a multiple of `GROUP`.
    columns : (n_entries,) int
        Source of each entry; from n on the source at -kz.
    terms : (n_entries + 1,) int
        Terms of each entry.
    numbers, coefficients : (n_terms,)
        Kernel and coefficient of each term.
    sums : (rows, signs, size, Fz) complex
        The answer.
    column, weight, total : work space
        ``(2 n, 2 or 4, 2, BLOCK)``, ``(GROUP, 2, BLOCK)`` and ``(2 or 4, 2, BLOCK)``.
    """
    n, signs, length = waves.shape[0], waves.shape[1], waves.shape[3] - 1
    kz, rows = kernels.shape[3], sums.shape[0]
    for b in range(size):
        for start in range(0, kz, BLOCK):
            stop = min(start + BLOCK, kz)
            m = stop - start
            for i in range(n):
                for s in range(signs):
                    wave = waves[i, s, b]
                    same, turned = column[i, 2 * s], column[n + i, 2 * s]
                    same_lower, turned_lower = column[i, 2 * s + 1], column[n + i, 2 * s + 1]
                    for k in range(m):
                        upper, lower = wave[start + k], wave[length - start - k]
                        same[0, k], same[1, k] = upper.real, upper.imag
                        turned[0, k], turned[1, k] = lower.real, lower.imag
                        same_lower[0, k], same_lower[1, k] = lower.real, -lower.imag
                        turned_lower[0, k], turned_lower[1, k] = upper.real, -upper.imag
            for r in range(rows):
                total[:] = 0.0
                for first in range(entries[r], entries[r + 1], GROUP):
                    weight[:] = 0.0
                    for g in range(GROUP):
                        real, imaginary = weight[g, 0], weight[g, 1]
                        for t in range(terms[first + g], terms[first + g + 1]):
                            c = coefficients[t]
                            kernel = kernels[numbers[t], piece + b]
                            for k in range(m):
                                real[k] += c * kernel[0, start + k]
                                imaginary[k] += c * kernel[1, start + k]
                    for q in range(0, 2 * signs, 2):
                        c0, c1, c2 = columns[first], columns[first + 1], columns[first + 2]
                        a0, a1, a2 = column[c0, q], column[c1, q], column[c2, q]
                        b0, b1, b2 = column[c0, q + 1], column[c1, q + 1], column[c2, q + 1]
                        ta, tb = total[q], total[q + 1]
                        for k in range(m):
                            x0, y0 = weight[0, 0, k], weight[0, 1, k]
                            x1, y1 = weight[1, 0, k], weight[1, 1, k]
                            x2, y2 = weight[2, 0, k], weight[2, 1, k]
                            ta[0, k] += (
                                x0 * a0[0, k]
                                - y0 * a0[1, k]
                                + x1 * a1[0, k]
                                - y1 * a1[1, k]
                                + x2 * a2[0, k]
                                - y2 * a2[1, k]
                            )
                            ta[1, k] += (
                                x0 * a0[1, k]
                                + y0 * a0[0, k]
                                + x1 * a1[1, k]
                                + y1 * a1[0, k]
                                + x2 * a2[1, k]
                                + y2 * a2[0, k]
                            )
                            tb[0, k] += (
                                x0 * b0[0, k]
                                - y0 * b0[1, k]
                                + x1 * b1[0, k]
                                - y1 * b1[1, k]
                                + x2 * b2[0, k]
                                - y2 * b2[1, k]
                            )
                            tb[1, k] += (
                                x0 * b0[1, k]
                                + y0 * b0[0, k]
                                + x1 * b1[1, k]
                                + y1 * b1[0, k]
                                + x2 * b2[1, k]
                                + y2 * b2[0, k]
                            )
                for s in range(signs):
                    out, upper_part, lower_part = sums[r, s, b], total[2 * s], total[2 * s + 1]
                    for k in range(m):
                        out[start + k] = complex(upper_part[0, k], upper_part[1, k])
                    if signs == 2:
                        for k in range(max(0, 1 - start), min(m, length - kz + 1 - start)):
                            out[length - start - k] = complex(lower_part[0, k], -lower_part[1, k])


def collect(
    back: Array, starts: Array, rows: Array, weights: Array, flips: Array, first: int, piece: int, size: int,
    depth: Array, out: Array,
) -> None:  # fmt: skip
    """Crop along z, combine the powers of the depth, and put the wavenumbers of a piece into their rows along y.

    Parameters
    ----------
    back : (rows, signs, size, Fz) complex
        Rows, transformed back along z.
    starts : (outputs + 1,) int
        Contributions of each output.
    rows : (n,) int
        Row of each contribution.
    weights : (n, tz)
        Its factor at each depth.
    flips : (outputs,)
        Factor of each output at -ky.
    first, piece, size : int
        First target along z, the piece's first wavenumber ky, and their number.
    depth : (tz,) complex
        Work space.
    out : (outputs, tz, Fy + 1) complex
        The answer; the last column may be written but means nothing.
    """
    signs, depths, last = back.shape[1], out.shape[1], out.shape[2] - 1
    for o in range(out.shape[0]):
        for b in range(size):
            for s in range(signs):
                depth[:] = 0.0
                for c in range(starts[o], starts[o + 1]):
                    values, weight = back[rows[c], s, b], weights[c]
                    for j in range(depths):
                        depth[j] += weight[j] * values[first + j]
                if s == 0:
                    for j in range(depths):
                        out[o, j, piece + b] = depth[j]
                else:
                    flip = flips[o]
                    for j in range(depths):
                        out[o, j, last - piece - b] = flip * depth[j]
