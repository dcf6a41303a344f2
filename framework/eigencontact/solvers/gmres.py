"""Generalised minimal residuals (GMRES), the linear solver for operators much more expensive than vectors.

Written here because the stop is absolute, the count of applications is part of the answer, and the orthogonalisation
is two products with a block of vectors in place of a loop over them.

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

# Part of the largest pivot, below which a pivot is rounding that a singular operator leaves: 3e-16 to 3e-13 were met
# with random singular matrices of 20 to 200 rows.
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
        What the operator applied to the answer should give.
    bound : float
        Absolute, in the Euclidean norm.
    max_iterations : int
        Applications of the operator in cycles; every restart costs one more, for the true residual.
    restart : int
        Vectors kept; memory is ``8 n (restart + 1)`` bytes at most.
    watch : callable, optional
        Called after each iteration with the norm of the residual.

    Returns
    -------
    (n,) array
        The best found. Whether it meets the bound is for the caller to check: rounding may have stopped it short.
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
            break  # stagnant: at the limit of rounding, or a load that no eigenstrain answers
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
    block = np.empty((size + 1, residual.size))  # rows not reached are never touched, and cost no memory
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
                break  # little was taken away: once more only where rounding may have left some of it
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
    else:  # the shortest of the answers that differ by rounding only
        weights = np.linalg.lstsq(upper[:count, :count], right[:count], rcond=_SINGULAR)[0]
    return weights @ block[:count], count
