"""Convolution of single rows of cells, as lines have them: all rows of sources or targets are transformed at once."""

from __future__ import annotations

from collections.abc import Sequence
from operator import is_
from typing import Any

import numpy as np

from eigencontact.convolution.backends import Backend, Plan
from eigencontact.convolution.layout import Layout
from eigencontact.convolution.spectrum import Spectrum
from eigencontact.core.array_types import Array

__all__ = ["Rows", "all_identical"]

# Bytes of the rows that are transformed together, small enough to stay in cache.
_TOGETHER = 524_288
# Plans kept of each direction.
_MAX_PLANS = 4


class Rows:
    """Plans and buffers of one layout of a single row.

    Parameters
    ----------
    layout : Layout
        Its transform along y has one point.
    fft : Backend
        FFT library.
    dtypes : (dtype, dtype)
        Real and complex numbers.
    """

    def __init__(self, layout: Layout, fft: Backend, dtypes: tuple[Any, Any]) -> None:
        self._x, self._fft, self._dtypes = layout.x, fft, dtypes
        self._most = max(1, _TOGETHER // (16 * layout.x.half))
        self._plans: tuple[dict[int, tuple[Array, Array, Plan]], ...] = ({}, {})
        #: Kernels of the last call, targets that they reach, and these kernels as one array.
        self._spectra_in_stack: list[Spectrum | None] = []
        self._reached, self._kernels = np.empty(0, np.intp), np.empty(0)

    @property
    def nbytes(self) -> int:
        """Memory of buffers held now."""
        plans = [plan for group in self._plans for plan in group.values()]
        return sum(a.nbytes + b.nbytes for a, b, _ in plans) + int(self._kernels.nbytes)

    def apply(self, sources: Array, kernels: list[Spectrum | None], targets: Array) -> None:
        """Convolve ``sources (n, 1, nx)`` with kernels ``[m * n]``, row by row, into ``targets (m, 1, tx)``."""
        if not all_identical(kernels, self._spectra_in_stack):
            self._stack(kernels, len(sources))
        if len(self._reached) < len(targets):
            targets[:] = 0
        if not self._reached.size:
            return
        waves, x = self._waves(sources[:, 0]), self._x
        for first in range(0, len(self._reached), self._most):
            group = self._kernels[first : first + self._most]
            sums, full, inverse = self._plan(1, len(group))
            if len(waves) == 1:
                np.multiply(group[:, 0], waves[0], out=sums)
            else:
                np.einsum("mnk,nk->mk", group, waves, out=sums)
            inverse()
            rows = full[:, x.target_start : x.target_start + x.targets]
            targets[self._reached[first : first + self._most], 0] = rows

    def energy(self, source: Array, kernel: Spectrum) -> float:
        """See `Convolver.energy`."""
        waves = self._waves(source)[0]
        products = (np.square(waves.real) + np.square(waves.imag)) * kernel.values[:, 0]
        single = products[0] + (products[-1] if self._x.length % 2 == 0 and self._x.length > 1 else 0.0)
        return float(2.0 * products.sum() - single)  # all other wavenumbers stand for -kx too

    def _waves(self, sources: Array) -> Array:
        """Transforms ``(n, kx)`` of rows ``(n, nx)``; memory that the next call may use again."""
        x, groups = self._x, []
        for first in range(0, len(sources), self._most):
            rows = sources[first : first + self._most]
            padded, waves, forward = self._plan(0, len(rows))
            padded[:, x.source_start : x.source_start + x.sources] = rows
            forward()
            groups.append(waves if len(sources) <= self._most else waves.copy())
        return groups[0] if len(groups) == 1 else np.concatenate(groups)

    def _plan(self, way: int, count: int) -> tuple[Array, Array, Plan]:
        """Buffers and plan of so many rows, forward (0) or back (1); the last few are kept."""
        plans = self._plans[way]
        if count in plans:
            return plans[count]
        if len(plans) >= _MAX_PLANS:
            plans.pop(next(iter(plans)))
        real = self._fft.empty((count, self._x.length), self._dtypes[0])
        waves = self._fft.empty((count, self._x.half), self._dtypes[1])
        real[:] = 0  # and kept so outside the source's columns: real transforms do not destroy their input
        forth = way == 0
        plan = self._fft.forward(real, waves) if forth else self._fft.inverse(waves, real)
        plans[count] = (real, waves, plan) if forth else (waves, real, plan)
        return plans[count]

    def _stack(self, kernels: list[Spectrum | None], count: int) -> None:
        """Keep kernels ``[m * n]`` as one array ``(m, n, kx)``, of those targets that some kernel reaches."""
        present = np.array([kernel is not None for kernel in kernels]).reshape(-1, max(count, 1))
        reached = np.flatnonzero(present.any(axis=1))
        turned = any(kernel is not None and (kernel.imaginary or np.iscomplexobj(kernel.values)) for kernel in kernels)
        stack = np.zeros((reached.size, count, self._x.half), self._dtypes[1 if turned else 0])
        for row, target in zip(stack, reached, strict=True):
            for place, kernel in zip(row, kernels[count * target : count * (target + 1)], strict=True):
                if kernel is not None:
                    (place.imag if kernel.imaginary else place)[:] = kernel.values[:, 0]
        self._spectra_in_stack, self._reached, self._kernels = kernels, reached, stack


def all_identical(first: Sequence[Any], second: Sequence[Any]) -> bool:
    """Whether two sequences hold the very same objects."""
    return len(first) == len(second) and all(map(is_, first, second))
