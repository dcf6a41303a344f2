"""Rigid modes of one box with prescribed forces, stored as rows and columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from eigencontact.core.array_types import Array

__all__ = ["RigidModes", "dot"]


def dot(a: Array, b: Array) -> float:
    """Sum of products of two fields.

    Without BLAS: its idle threads stay active for a while after each call, and take cores from the transforms.
    """
    return float(np.einsum("ij,ij->", a, b))


class RigidModes:
    """Rigid modes with prescribed forces among 1, y, -x, scaled to order one.

    Parameters
    ----------
    fields : sequence of arrays of shape (1, 1), (ny, 1) or (1, nx)
        One field per mode, broadcastable to the box.
    """

    def __init__(self, fields: Sequence[Array]) -> None:
        self.fields = [np.asarray(field, dtype=float) for field in fields]
        self._only_uniform = len(self.fields) == 1 and self.fields[0].size == 1

    def __len__(self) -> int:
        return len(self.fields)

    def combine(self, amounts: Array, dtype: Any) -> Array:
        """Sum of the modes times `amounts`, broadcastable to the box."""
        total: Array = sum((a * f for a, f in zip(amounts, self.fields, strict=True)), np.zeros((1, 1)))
        return total.astype(dtype)

    def project(self, field: Array) -> Array:
        """Sums of each mode times a field, (m,)."""
        if self._only_uniform:
            return np.array([float(np.sum(field, dtype=float)) * float(self.fields[0][0, 0])])
        rows, columns = _margins(field)
        return np.array([_sum(mode, rows, columns) for mode in self.fields])

    def gram(self, weight: Array) -> Array:
        """Matrix of the sums ``mode_i mode_j weight``, (m, m); all from a single pass over the weight."""
        if self._only_uniform:
            return np.array([[float(np.sum(weight, dtype=float)) * float(self.fields[0][0, 0]) ** 2]])
        rows, columns = _margins(weight)
        out = np.empty((len(self), len(self)))
        for i, first in enumerate(self.fields):
            for j, second in enumerate(self.fields[: i + 1]):
                if 1 in (first.size, second.size) or first.shape == second.shape:
                    value = _sum(first * second, rows, columns)
                else:
                    y, x = (first, second) if first.shape[1] == 1 else (second, first)
                    value = float(np.sum(y[:, 0] * np.einsum("ij,j->i", weight, x[0])))
                out[i, j] = out[j, i] = value
        return out

    def fit(self, field: Array, loaded: Array) -> Array:
        """Least-squares amounts of the modes in a field over the loaded cells (weights 0 or 1), (m,).

        The field must be zero at cells that are not loaded.
        """
        return self.amounts(self.gram(loaded), self.project(field))

    def amounts(self, gram: Array, projection: Array) -> Array:
        """Amplitudes (m,) of the modes from their `project` and `gram` over cells; None without cells."""
        if len(projection) == 1:
            return projection / gram[0, 0] if gram[0, 0] else np.zeros(1)
        return np.asarray(np.linalg.lstsq(gram, projection, rcond=1e-13)[0])

    def of_rows(self, rows: slice) -> RigidModes:
        """Modes on some rows of the box; `project` and `gram` of all rows are sums over such parts."""
        return RigidModes([field[rows] if field.shape[0] > 1 else field for field in self.fields])

    def factor(self, carried: Array, forces: Array) -> float | None:
        """Factor that scales the resultants of a pressure to the forces; None without such a factor."""
        if not self.fields:
            return 1.0
        if not self._only_uniform:
            return None
        return float(forces[0] / carried[0]) if carried[0] > 0 else 1.0

    def remove(self, field: Array, loaded: Array) -> None:
        """Subtract the rigid part from a field that is zero at unloaded cells, in place."""
        if len(self):
            field -= self.combine(self.fit(field, loaded), field.dtype)
            field *= loaded

    def level(self, residual: Array, loaded: Array, share: Array) -> None:
        """Subtract the rigid part from a gap residual, in place, by a fit weighted with the load share of each cell.

        The result does no work on a pressure ``share * mode``: the counterpart of `unload`.
        """
        if len(self):
            residual -= self.combine(self.fit(residual * share, share), residual.dtype)
            residual *= loaded

    def unload(self, pressure: Array, share: Array) -> None:
        """Subtract the forces from a pressure, in place, in proportion to the load share of each cell."""
        if len(self):
            amounts = np.linalg.lstsq(self.gram(share), self.project(pressure), rcond=1e-13)[0]
            pressure -= self.combine(amounts, pressure.dtype) * share

    def carry(self, pressure: Array, forces: Array) -> Array:
        """Scale a pressure by ``1 + c . modes`` to the forces; positive values remain positive."""
        if self._only_uniform:
            carried = float(self.project(pressure)[0])
            return pressure * pressure.dtype.type(forces[0] / carried) if carried > 0 else pressure
        for _ in range(30):
            error = forces - self.project(pressure)
            if not np.any(np.abs(error) > 1e-14 * np.abs(forces).max()):
                break
            change = np.linalg.lstsq(self.gram(pressure), error, rcond=1e-13)[0]
            pressure = pressure * np.maximum(1.0 + self.combine(change, float), 0.1).astype(pressure.dtype)
        return pressure

    def shortage(self, pressure: Array, forces: Array) -> float:
        """Largest missing part of the forces of a pressure; 0 for a normal load without moments.

        The reference is the force, or the resultant of the same pressure with all parts in one direction.
        """
        if self._only_uniform or not self.fields:
            return 0.0
        error = np.abs(self.project(pressure) - forces)
        size = np.array([float(np.sum(np.abs(mode) * pressure)) for mode in self.fields])
        return float(np.max(error / np.maximum(np.maximum(size, np.abs(forces)), np.finfo(float).tiny)))

    def carries(self, pressure: Array, forces: Array) -> bool:
        """Whether a pressure carries the forces to round-off of its precision."""
        return self.shortage(pressure, forces) <= 100.0 * float(np.finfo(pressure.dtype).eps)


def _margins(field: Array) -> tuple[Array, Array]:
    """Sums of a field over each row and over each column."""
    return np.sum(field, axis=1, dtype=float), np.sum(field, axis=0, dtype=float)


def _sum(mode: Array, rows: Array, columns: Array) -> float:
    """Sum of the product of a mode, constant or linear in one direction, with a field by its row and column sums."""
    if mode.size == 1:
        return float(rows.sum()) * float(mode[0, 0])
    return float(np.sum(rows * mode[:, 0]) if mode.shape[1] == 1 else np.sum(columns * mode[0]))
