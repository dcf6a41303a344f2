"""Sums of kernels and tractions of several load steps over wavenumbers: compiled.

This module imports numba; nothing imports it before the stress of several steps is computed at once.
"""

from __future__ import annotations

from typing import Any

from eigencontact.core.numba_cache import compiled

__all__ = ["sums"]

_compiled: Any = compiled(nogil=True, error_model="numpy")


@_compiled
def sums(kernels: Any, waves: Any, out: Any) -> None:
    """Fill sums ``(steps, depths, wavenumbers)`` over tractions and rows.

    `kernels` are ``(depths, tractions, rows, wavenumbers)``, `waves` ``(tractions, steps, rows, wavenumbers)``.
    """
    depths, tractions, rows, numbers = kernels.shape
    for s in range(waves.shape[1]):
        for z in range(depths):
            for k in range(numbers):
                out[s, z, k] = 0.0
            for t in range(tractions):
                for r in range(rows):
                    for k in range(numbers):
                        out[s, z, k] += kernels[z, t, r, k] * waves[t, s, r, k]
