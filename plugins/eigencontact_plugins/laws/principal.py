r"""Isotropic damaged elasticity in principal strains.

Principal stresses s follow from principal strains e by

    e = (1 + ν)/E s / g(s) - (ν/E) c Σ s,

For damage of the whole stiffness ``g = 1 - D, c = 1 / (1 - D)``. With crack closure only positive s have ``1/g = (1/(1
- D) + ν) / (1 + ν)``, others have ``g = 1``, and ``c = 1``: the stiffness in uniaxial tension is (1 - D) E.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eigencontact.plugin import FloatArray

__all__ = ["Damaged", "principal", "tangent_of"]


_ROOT = float(np.sqrt(2.0))
#: Pairs of axes that the shears yz, xz, xy of the Mandel order relate.
_PAIRS = ((1, 2), (0, 2), (0, 1))


def principal(strain: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Principal values ``(3, n)`` of Mandel vectors, and the Mandel basis ``(6, 6, n)`` of their axes.

    Columns of the basis are the three dyads of an axis with itself, then the symmetric dyads of pairs, in Mandel order.
    """
    xx, yy, zz, yz, xz, xy = strain
    tensor = np.moveaxis(
        np.array([[xx, xy / _ROOT, xz / _ROOT], [xy / _ROOT, yy, yz / _ROOT], [xz / _ROOT, yz / _ROOT, zz]]), 2, 0
    )
    values, vectors = np.linalg.eigh(tensor)
    n = np.moveaxis(vectors, 0, 2)
    dyads = [(a, a) for a in range(3)] + list(_PAIRS)
    axes = np.empty((6, 6, strain.shape[1]))
    for column, (a, b) in enumerate(dyads):
        size = 1.0 if a == b else _ROOT
        for row, (i, j) in enumerate(dyads):
            product = 0.5 * (n[i, a] * n[j, b] + n[j, a] * n[i, b])
            axes[row, column] = product * size * (1.0 if i == j else _ROOT)
    return np.ascontiguousarray(values.T), axes


@dataclass(frozen=True, slots=True, eq=False)
class Damaged:
    """Principal stresses, and their derivatives.

    Attributes
    ----------
    stress : (3, n)
        Principal stresses [Pa].
    slopes : (3, 3, n)
        Derivatives of the stresses (rows) by the strains at constant D [Pa].
    by_damage : (3, n)
        Derivatives of the stresses by D [Pa].
    shears : (3, n)
        ``(s_a - s_b) / (e_a - e_b)`` of the pairs in Mandel order [Pa].
    """

    stress: FloatArray
    slopes: FloatArray
    by_damage: FloatArray
    shears: FloatArray

    @classmethod
    def of(cls, e: FloatArray, D: FloatArray, E: float, nu: float, *, closing: bool) -> Damaged:
        """Stresses of principal strains ``(3, n)`` at damage ``(n,)``; E [Pa], ν in [0, 0.5)."""
        ratio, double_shear = nu / (1.0 + nu), E / (1.0 + nu)
        sound = 1.0 - D
        if closing:
            c, dc = np.ones_like(D), np.zeros_like(D)
            soft, dsoft = (1.0 + nu) * sound / (1.0 + nu * sound), -(1.0 + nu) / (1.0 + nu * sound) ** 2
        else:
            c, dc = 1.0 / sound, 1.0 / sound**2
            soft, dsoft = sound, -np.ones_like(D)
        open_ = np.ones(e.shape, dtype=bool)
        if closing:
            open_ = e + ratio / (1.0 - 3.0 * ratio) * e.sum(axis=0) > 0.0
        # Σ s is the root of a convex, increasing, piecewise linear function: each pass crosses at least one kink.
        for _ in range(5 if closing else 1):
            g = np.where(open_, soft, 1.0)
            total = double_shear * np.sum(g * e, axis=0) / (1.0 - ratio * c * g.sum(axis=0))
            x = e + nu / E * c * total
            if not closing or np.array_equal(open_, x > 0.0):
                break
            open_ = x > 0.0
        s = double_shear * g * x
        dg = np.where(open_, dsoft, 0.0)
        rise = 1.0 - ratio * c * g.sum(axis=0)
        by_strain = double_shear * g / rise
        slopes = double_shear * g[:, None] * np.eye(3)[..., None] + ratio * c * g[:, None] * by_strain[None]
        dtotal = np.sum(s * dg / g + ratio * g * dc * total, axis=0) / rise
        by_damage = s * dg / g + ratio * g * (dc * total + c * dtotal)
        shears = np.empty_like(e)
        for row, (a, b) in enumerate(_PAIRS):
            # Secant of g(x) x, without differences if both values have the same sign.
            apart = np.abs(x[a]) + np.abs(x[b])
            mixed = (g[a] * np.abs(x[a]) + g[b] * np.abs(x[b])) / np.where(apart > 0.0, apart, 1.0)
            shears[row] = double_shear * np.where(open_[a] == open_[b], g[a], mixed)
        return cls(s, slopes, by_damage, shears)


def tangent_of(axes: FloatArray, slopes: FloatArray, shears: FloatArray) -> FloatArray:
    """Mandel tangent ``(6, 6, n)`` of an isotropic function from slopes of principal values and shears of pairs."""
    inner = np.zeros_like(axes)
    inner[:3, :3] = slopes
    for row in range(3):
        inner[3 + row, 3 + row] = shears[row]
    return np.asarray(np.einsum("ian,abn,jbn->ijn", axes, inner, axes, optimize=True))
