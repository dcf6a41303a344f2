"""Loops of the volume sums, compiled by numba.

On one core the contraction of stress (17 rows, 138 products at each wavenumber) takes half the time of numpy calls on
blocks of the same size, and compiled loops run in threads without waiting for the interpreter.

This module imports numba; nothing imports it before a large volume is summed. The compiled code is kept on disk.
"""

from __future__ import annotations

from typing import Any

from eigencontact.core.numba_cache import compiled

__all__ = ["GROUP", "add_packed", "collect", "contract"]

# Products added at a time; rows have a multiple of this many entries, of neighbouring columns.
GROUP = 3

_compiled: Any = compiled(nogil=True, fastmath={"contract"})


@_compiled
def _scaled(out: Any, values: Any, factor: float, m: int) -> None:
    """Write ``factor * values``."""
    for k in range(m):
        out[k] = factor * values[k]


@_compiled
def _add_scaled(out: Any, values: Any, factor: float, m: int) -> None:
    """Add ``factor * values``."""
    for k in range(m):
        out[k] += factor * values[k]


@_compiled
def _add_products(total: Any, w: Any, c: Any, m: int) -> None:
    """Add `GROUP` complex products, real and imaginary parts apart."""
    for k in range(m):
        x0, y0, x1, y1, x2, y2 = w[0, 0, k], w[0, 1, k], w[1, 0, k], w[1, 1, k], w[2, 0, k], w[2, 1, k]
        a0, b0, a1, b1, a2, b2 = c[0, 0, k], c[0, 1, k], c[1, 0, k], c[1, 1, k], c[2, 0, k], c[2, 1, k]
        total[0, k] += x0 * a0 - y0 * b0 + x1 * a1 - y1 * b1 + x2 * a2 - y2 * b2
        total[1, k] += x0 * b0 + y0 * a0 + x1 * b1 + y1 * a1 + x2 * b2 + y2 * a2


@_compiled
def contract(
    waves: Any, kernels: Any, start: int, entries: Any, columns: Any, terms: Any, numbers: Any,
    coefficients: Any, sums: Any, column: Any, weight: Any, total: Any, size: int,
) -> None:  # fmt: skip
    """Sum kernels times sources for the wavenumbers of one piece.

    Parameters
    ----------
    waves : (n, signs, size, Fz + 1) complex
        Spectra of the sources, the value at kz = 0 repeated behind the last.
    kernels : (n_kernels, 2, ky * kz)
        Real and imaginary parts.
    start : int
        Where the piece begins in the last axis of `kernels`.
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
        ``(2 or 4, 2 n, 2, size * kz)``, ``(GROUP, 2, size * kz)``, ``(2 or 4, 2, size * kz)``.
    size : int
        Wavenumbers ky of the piece.
    """
    n, signs, length = waves.shape[0], waves.shape[1], waves.shape[3] - 1
    kz = column.shape[3] // waves.shape[2]
    m = size * kz
    for i in range(n):
        for s in range(signs):
            for b in range(size):
                for k in range(kz):
                    j = b * kz + k
                    upper, lower = waves[i, s, b, k], waves[i, s, b, length - k]
                    column[2 * s, i, 0, j], column[2 * s, i, 1, j] = upper.real, upper.imag
                    column[2 * s, n + i, 0, j], column[2 * s, n + i, 1, j] = lower.real, lower.imag
                    column[2 * s + 1, i, 0, j], column[2 * s + 1, i, 1, j] = lower.real, -lower.imag
                    column[2 * s + 1, n + i, 0, j], column[2 * s + 1, n + i, 1, j] = upper.real, -upper.imag
    for r in range(sums.shape[0]):
        total[:] = 0.0
        for first in range(entries[r], entries[r + 1], GROUP):
            for g in range(GROUP):
                begin, end = terms[first + g], terms[first + g + 1]
                if begin == end:
                    weight[g] = 0.0
                for t in range(begin, end):
                    for component in range(2):
                        kernel = kernels[numbers[t], component, start : start + m]
                        if t == begin:
                            _scaled(weight[g, component], kernel, coefficients[t], m)
                        else:
                            _add_scaled(weight[g, component], kernel, coefficients[t], m)
            at = columns[first]
            for q in range(2 * signs):
                _add_products(total[q], weight, column[q, at : at + GROUP], m)
        for s in range(signs):
            for b in range(size):
                for k in range(kz):
                    j = b * kz + k
                    sums[r, s, b, k] = complex(total[2 * s, 0, j], total[2 * s, 1, j])
                for k in range(1, length - kz + 1):
                    j = b * kz + k
                    sums[r, s, b, length - k] = complex(total[2 * s + 1, 0, j], -total[2 * s + 1, 1, j])


@_compiled
def collect(
    back: Any, starts: Any, rows: Any, weights: Any, flips: Any, first: int, piece: int, size: int,
    depth: Any, out: Any,
) -> None:  # fmt: skip
    """Crop along z, combine the powers of the depth, and write the wavenumbers of a piece to their rows along y.

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


@_compiled
def add_packed(total: Any, field: Any, values: Any, first: int, sign: float, turned: bool) -> None:  # noqa: FBT001
    """Add a packed spectrum times a field.

    Parameters
    ----------
    total, field : (n, F) complex
        Sum and field at some wavenumbers kx and all ky.
    values : (kx, F//2 + 1) real
        Spectrum at ky >= 0.
    first : int
        Its row for the first row of `field`.
    sign : float
        Parity along y.
    turned : bool
        The spectrum is 1j times the values.
    """
    length, half = field.shape[1], values.shape[1]
    for i in range(field.shape[0]):
        if turned:
            for k in range(half):
                v = values[first + i, k]
                total[i, k] += complex(-v * field[i, k].imag, v * field[i, k].real)
            for k in range(half, length):
                v = sign * values[first + i, length - k]
                total[i, k] += complex(-v * field[i, k].imag, v * field[i, k].real)
        else:
            for k in range(half):
                v = values[first + i, k]
                total[i, k] += complex(v * field[i, k].real, v * field[i, k].imag)
            for k in range(half, length):
                v = sign * values[first + i, length - k]
                total[i, k] += complex(v * field[i, k].real, v * field[i, k].imag)
