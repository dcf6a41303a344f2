"""Anderson acceleration of a fixed point ``x = G(x)``."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from eigencontact.core.array_types import FloatArray

__all__ = ["Anderson"]

#: Singular values below this fraction of the largest (of differences scaled to one) are left out of the combination.
_DEPENDENT = 1e-6


class Anderson:
    """Next iterate of a fixed-point iteration, from the last iterates and their images.

    With all iterates stored, the method follows GMRES for a linear problem: it converges where the plain iteration
    diverges.

    Parameters
    ----------
    depth : int
        Number of stored differences.

    Notes
    -----
    Vectors may become longer from call to call. New entries were zero before; the stored vectors are not extended.

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

    def __init__(self, depth: int = 20) -> None:
        self._depth = depth
        self._images: list[FloatArray] = []
        self._residuals: list[FloatArray] = []
        self._gram = np.zeros((0, 0))
        #: Differences of images and of residuals from an earlier solution, and the products of the latter.
        self._earlier: list[tuple[FloatArray, FloatArray]] = []
        self._gram_earlier = np.zeros((0, 0))

    def restart(self) -> None:
        """Begin another solution of nearly the same problem with the stored differences, but without the guesses.

        The differences describe how the residual depends on the unknowns, so that the first combination already removes
        most of the residual.
        """
        steps = [
            (_difference(images[1], images[0]), _difference(residuals[1], residuals[0]))
            for images, residuals in zip(pairwise(self._images), pairwise(self._residuals), strict=True)
        ]
        self._earlier = [*steps[::-1], *self._earlier][: self._depth]
        self._gram_earlier = np.array([[_dot(a, b) for _, b in self._earlier] for _, a in self._earlier])
        self._images, self._residuals, self._gram = [], [], np.zeros((0, 0))

    @property
    def nbytes(self) -> int:
        """Memory of the stored vectors."""
        pairs = sum(image.nbytes + residual.nbytes for image, residual in self._earlier)
        return pairs + sum(vector.nbytes for vector in (*self._images, *self._residuals))

    def next(self, guess: FloatArray, image: FloatArray) -> FloatArray:
        """Combine the images so that their residuals cancel best."""
        residual = image - guess
        self._images = [*self._images[-self._depth :], image]
        self._residuals = [*self._residuals[-self._depth :], residual]
        products = np.array([_dot(earlier, residual) for earlier in self._residuals])
        gram, known_products = np.empty((products.size, products.size)), products.size - 1
        gram[:known_products, :known_products] = self._gram[
            len(self._gram) - known_products :, len(self._gram) - known_products :
        ]
        gram[-1], gram[:, -1] = products, products
        self._gram = gram
        if known_products == 0 and not self._earlier:
            return image
        last = products[:-1]
        changes = gram[:-1, :-1] - last[:, None] - last[None, :] + products[-1]  # of the residuals, to the last one
        right = products[-1] - last
        if self._earlier:
            across = np.array([[_dot(earlier, vector) for vector in self._residuals] for _, earlier in self._earlier])
            mixed_products = across[:, :-1] - across[:, -1:]
            changes = np.block([[changes, mixed_products.T], [mixed_products, self._gram_earlier]])
            right = np.concatenate([right, -across[:, -1]])
        size = np.sqrt(np.maximum(np.diag(changes), np.finfo(float).tiny))
        weights = np.linalg.lstsq(changes / np.outer(size, size), right / size, rcond=_DEPENDENT**2)[0] / size
        mixed = (1.0 - weights[:known_products].sum()) * image
        for weight, old in zip(weights[:known_products], self._images[:-1], strict=True):
            mixed[: old.size] += weight * old
        for weight, (step, _) in zip(weights[known_products:], self._earlier, strict=True):
            mixed[: step.size] += weight * step
        return np.asarray(mixed)


def _difference(later: FloatArray, earlier: FloatArray) -> FloatArray:
    """Difference of two vectors, of which the later one may be longer."""
    out = later.copy()
    out[: earlier.size] -= earlier
    return out


def _dot(a: FloatArray, b: FloatArray) -> float:
    """Product of two vectors; the shorter one is extended by zeros."""
    count = min(a.size, b.size)
    return float(np.einsum("i,i->", a.ravel()[:count], b.ravel()[:count]))
