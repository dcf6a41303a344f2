"""Anderson acceleration of a fixed point ``x = G(x)``."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["Anderson"]

FloatArray = NDArray[np.float64]


class Anderson:
    """Next guess from the last ones and their images.

    Parameters
    ----------
    depth : int
        Differences kept.

    References
    ----------
    D. G. Anderson, J. ACM 12 (1965) 547; H. F. Walker, P. Ni, SIAM J. Numer. Anal. 49 (2011) 1715.

    Examples
    --------
    >>> mixer, x = Anderson(2), np.array([1.0, 1.0])
    >>> for _ in range(4):
    ...     x = mixer.next(x, np.array([0.5 * x[1] + 1.0, -0.9 * x[0]]))
    >>> (x * 1.45).round(9).tolist()
    [1.0, -0.9]
    """

    def __init__(self, depth: int = 8) -> None:
        self._depth = depth
        self._guesses: list[FloatArray] = []
        self._images: list[FloatArray] = []

    def next(self, guess: FloatArray, image: FloatArray) -> FloatArray:
        """Combine the images so that their residuals cancel best."""
        self._guesses = [*self._guesses[-self._depth :], guess]
        self._images = [*self._images[-self._depth :], image]
        residuals = [b - a for a, b in zip(self._guesses, self._images, strict=True)]
        if len(residuals) == 1:
            return image
        changes = [residuals[-1] - old for old in residuals[:-1]]
        gram = np.array([[_dot(one, other) for other in changes] for one in changes])
        right = np.array([_dot(one, residuals[-1]) for one in changes])
        weights = np.linalg.lstsq(gram, right, rcond=1e-13)[0]
        mixed = image.copy()
        for weight, old in zip(weights, self._images[:-1], strict=True):
            mixed -= weight * (image - old)
        return mixed


def _dot(a: FloatArray, b: FloatArray) -> float:
    return float(np.einsum("i,i->", a.ravel(), b.ravel()))
