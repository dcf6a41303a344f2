"""Shear tractions allowed by friction: a disc in each cell, with prescribed resultant forces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eigencontact.core.array_types import BoolArray, FloatArray
from eigencontact.errors import EigencontactError

__all__ = ["FittedModes", "Infeasible", "RigidPlane", "inner", "length_of"]

_TINY = np.finfo(float).tiny
#: Error of the forces, relative to the sum of all bounds, at which the projection stops.
_EXACT = 1e-14
#: Largest accepted error of the forces, relative to the same sum.
_ENOUGH = 1e-9
#: Size of the multipliers of forces, in units of the tractions, that shows that the forces exceed the limit.
_FAR = 1e12
#: Smallest allowed ratio of the eigenvalues of normal equations.
_FLAT = 1e-6
#: Singular values below this fraction of the largest count as zero.
_NOTHING = 1e-10
#: Smaller singular values are zero in any units: their inverse overflows.
_ZERO = 1e-300


class Infeasible(EigencontactError):
    """No tractions within their bounds carry the prescribed forces."""


def inner(a: FloatArray, b: FloatArray) -> float:
    """Sum of products of two vector fields; without BLAS, see `eigencontact.solvers.rigid.dot`."""
    return float(np.einsum("kij,kij->", a, b))


def length_of(vectors: FloatArray) -> FloatArray:
    """Euclidean length of each vector of a field ``(k, ny, nx)``."""
    if len(vectors) == 1:
        return np.asarray(np.abs(vectors[0]))
    return np.asarray(np.sqrt(np.einsum("kij,kij->ij", vectors, vectors)))


def _solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solution of equations of a few modes; the call of LAPACK takes longer than the division of a single mode."""
    return right / matrix[0] if len(right) == 1 else np.asarray(np.linalg.solve(matrix, right))


class RigidPlane:
    """Rigid modes of the surface plane with prescribed forces.

    Parameters
    ----------
    fields : (m, k, ny, nx) float64
        Displacement of each unit mode, scaled to order one.
    forces : (m,) float64
        Forces of these modes: ``sum(mode * traction)``.
    """

    def __init__(self, fields: FloatArray, forces: FloatArray) -> None:
        self.fields, self.forces = fields, forces

    def __len__(self) -> int:
        return len(self.fields)

    def combine(self, amounts: FloatArray) -> FloatArray:
        """Sum of the modes times `amounts`, ``(k, ny, nx)``."""
        return np.asarray(np.einsum("m,mkij->kij", amounts, self.fields))

    def work(self, vectors: FloatArray) -> FloatArray:
        """Sums of each mode times a field, ``(m,)``."""
        return np.asarray(np.einsum("mkij,kij->m", self.fields, vectors))

    def closest(self, vectors: FloatArray, bound: FloatArray, on_rim: BoolArray | None = None) -> FloatArray:
        """Tractions within the discs, with the prescribed forces, that are closest to given tractions.

        The multipliers of the forces maximise a concave dual function with one variable per mode, by Newton's method.
        Cells `on_rim` keep their traction on the rim of their discs, if the other cells can balance the forces. The
        closest point of the whole disc would move slipping cells off their bound by a small amount, of the size of the
        former error of the forces.

        Raises
        ------
        Infeasible
            No such tractions exist.
        """
        no_rim = np.zeros(bound.shape, dtype=bool)
        if not len(self):
            size, on_rim = length_of(vectors), no_rim if on_rim is None else on_rim
            return np.asarray(vectors * np.where((size > bound) | on_rim, bound / np.maximum(size, _TINY), 1.0))
        if on_rim is not None and np.any(on_rim):
            try:
                return self._climb(vectors, bound, on_rim, 20)
            except Infeasible:  # rims are not a convex set
                pass
        return self._climb(vectors, bound, no_rim, 80)

    def _climb(self, vectors: FloatArray, bound: FloatArray, on_rim: BoolArray, iterations: int) -> FloatArray:
        """Newton's method on the dual function."""
        capacity = np.einsum("mij,ij->m", np.sqrt(np.einsum("mkij,mkij->mij", self.fields, self.fields)), bound) + _TINY
        amounts, value = np.zeros(len(self)), np.inf
        error = self.forces
        limit = _FAR * (1.0 + float(length_of(vectors).max(initial=0.0)))
        for _ in range(iterations):
            moved = vectors + self.combine(amounts)
            size = length_of(moved)
            outside = (size > bound) | on_rim
            factor = np.where(outside, bound / np.maximum(size, _TINY), 1.0)
            closest = moved * factor
            error = self.work(closest) - self.forces
            if np.all(np.abs(error) <= _EXACT * capacity):
                return closest
            value = self._dual(size, outside, bound, amounts)
            direction = np.where(outside, moved / np.maximum(size, _TINY), 0.0) * np.sqrt(factor)
            along = np.einsum("mkij,kij->mij", self.fields, direction)
            slope = np.einsum("mkij,ij,lkij->ml", self.fields, factor, self.fields)
            slope -= np.einsum("mij,lij->ml", along, along)
            reach = 2.0 * float(size.max(initial=0.0) + bound.max(initial=0.0)) + _TINY
            flat = float(np.abs(error).max()) / reach + _TINY  # limits the change to that value if all cells slip
            slope += (1e-13 * np.trace(slope) + flat) * np.eye(len(self))
            change = -_solved(slope, error)
            share, expected = 1.0, float(error @ change)
            for _ in range(40):
                trial = amounts + share * change
                size = length_of(vectors + self.combine(trial))
                trial_value = self._dual(size, (size > bound) | on_rim, bound, trial)
                if trial_value <= value + 1e-4 * share * expected or abs(trial_value - value) <= 1e-13 * abs(value):
                    break
                share *= 0.5
            amounts = trial
            if np.abs(amounts).max() >= limit:
                break
        if np.all(np.abs(error) <= _ENOUGH * capacity):
            return closest
        raise Infeasible(f"friction must carry the prescribed forces (got {error / capacity} of its capacity missing)")

    def _dual(self, size: FloatArray, outside: NDArray[np.bool_], bound: FloatArray, amounts: FloatArray) -> float:
        """Negative of the dual function, to be minimised."""
        inside = 0.5 * size**2
        return float(np.sum(np.where(outside, bound * size - 0.5 * bound**2, inside))) - float(self.forces @ amounts)

    def fitted(self, unit: FloatArray, loaded: BoolArray) -> FittedModes:
        """Modes on the free directions of tractions: in loaded cells, across the unit vectors."""
        return FittedModes(self, unit, loaded)


class FittedModes:
    """Least-squares fit of a field by rigid modes, in the directions across the unit vectors of slipping cells.

    The fit uses the normal equations if they are well conditioned. If nearly all cells slip in the direction of one
    rigid motion, this motion has almost no component across. The fit then uses an orthogonal basis of the modes, which
    costs more and loses half as many digits.
    """

    def __init__(self, modes: RigidPlane, unit: FloatArray, loaded: BoolArray) -> None:
        self._modes = modes
        fields = modes.fields * loaded
        along = np.einsum("mkij,kij->mij", fields, unit)
        gram = np.einsum("mkij,lkij->ml", fields, fields) - np.einsum("mij,lij->ml", along, along)
        size = gram[0] if len(modes) == 1 else np.linalg.eigvalsh(gram)
        self._gram: FloatArray | None = gram
        if size[0] <= _FLAT * size[-1]:
            self._gram = None
            across = fields - along[:, None] * unit
            self._basis = np.linalg.svd(across.reshape(len(modes), -1).T, full_matrices=False)

    def amounts(self, field: FloatArray) -> FloatArray:
        """Amounts ``(m,)`` of the modes with the best fit of a field without components along the unit vectors."""
        if self._gram is not None:
            return _solved(self._gram, self._modes.work(field))
        left, size, right = self._basis
        significant = size > max(_NOTHING * size[0], _ZERO)
        return np.asarray(right[significant].T @ ((left.T @ field.ravel())[significant] / size[significant]))
