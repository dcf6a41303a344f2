"""Generalised minimal residuals (GMRES), for operators much more expensive than operations on vectors.

This implementation differs from library versions in three points: the stopping criterion is absolute, it returns the
number of applications, and the orthogonalisation is two products with a block of vectors instead of a loop.

References
----------
Y. Saad and M. H. Schultz 1986, SIAM J. Sci. Stat. Comput. 7, 856.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.products import norm_of

__all__ = ["gmres"]

# Ratio to the largest pivot below which a pivot is round-off of a singular operator: random singular matrices of 20 to
# 200 rows had 3e-16 to 3e-13.
_SINGULAR = 1e-12


def gmres(
    operator: Callable[[FloatArray], FloatArray],
    residual: FloatArray,
    *,
    bound: float,
    max_iterations: int,
    restart: int = 50,
    watch: Callable[[float], None] | None = None,
) -> FloatArray:
    """Correction that brings the norm of the residual below a bound, from a start of zero.

    Parameters
    ----------
    operator : callable
        ``(n,)`` to ``(n,)``, linear.
    residual : (n,)
        Residual of the start; the operator applied to the correction should equal it.
    bound : float
        Bound of the Euclidean norm of the residual, absolute.
    max_iterations : int
        Largest number of applications within cycles; every restart needs one more for the true residual.
    restart : int
        Number of stored vectors; memory is at most ``8 n (restart + 1)`` bytes.
    watch : callable, optional
        Called after each iteration with the norm of the residual.

    Returns
    -------
    (n,) array
        Best correction found. The caller must check the bound, because round-off may have stopped the iteration early.
    """
    total = np.zeros_like(residual)
    left, remainder = max_iterations, residual
    while left > 0 and norm_of(remainder) > bound:
        size = min(restart, left)
        step, used = _cycle(operator, remainder, bound, size, watch)
        left -= used
        if left <= 0:
            return total + step
        before, remainder = norm_of(remainder), residual - operator(total + step)
        after = norm_of(remainder)
        if after < before:
            total += step
        if not after < 0.999 * before:
            break  # stagnation: round-off, or a load without a solution
    return total


def _cycle(
    operator: Callable[[FloatArray], FloatArray],
    residual: FloatArray,
    bound: float,
    size: int,
    watch: Callable[[float], None] | None,
) -> tuple[FloatArray, int]:
    """One cycle without restart: correction and iterations."""
    norm = norm_of(residual)
    block = np.empty((size + 1, residual.size))  # rows that are not used are not touched, and take no memory
    block[0] = residual / norm
    upper, turns, right = np.zeros((size, size)), np.zeros((size, 2)), np.zeros(size + 1)
    right[0] = norm
    count = 0
    while count < size:
        vector = operator(block[count])
        first = norm_of(vector)
        basis = block[: count + 1]
        column = np.zeros(count + 2)
        height = first
        for _ in range(2):
            before, projection = height, np.einsum("ij,j->i", basis, vector)
            vector = vector - np.einsum("i,ij->j", projection, basis)
            column[:-1] += projection
            height = norm_of(vector)
            if height > 0.5 * before:
                break  # small reduction: a second pass is only necessary after cancellation
        column[-1] = height
        for k, (cosine, sine) in enumerate(turns[:count]):
            column[k], column[k + 1] = (
                cosine * column[k] + sine * column[k + 1],
                cosine * column[k + 1] - sine * column[k],
            )
        length = float(np.hypot(column[-2], column[-1]))
        if length == 0.0:
            break
        cosine, sine = column[-2] / length, column[-1] / length
        turns[count] = cosine, sine
        upper[:count, count], upper[count, count] = column[:count], length
        right[count], right[count + 1] = cosine * right[count], -sine * right[count]
        count += 1
        if watch is not None:
            watch(abs(float(right[count])))
        if abs(right[count]) <= bound or height <= 1e-14 * first or count == size:
            break
        np.divide(vector, height, out=block[count])
    if count == 0:
        return np.zeros_like(residual), 1
    pivots = np.abs(np.diag(upper)[:count])
    if pivots.min() > _SINGULAR * pivots.max():
        weights = np.linalg.solve(upper[:count, :count], right[:count])
    else:  # shortest of the solutions that differ by round-off
        weights = np.linalg.lstsq(upper[:count, :count], right[:count], rcond=_SINGULAR)[0]
    return weights @ block[:count], count
