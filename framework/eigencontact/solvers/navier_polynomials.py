"""Polynomial strains of an elastic inclusion, from displacements in equilibrium.

In a homogeneous inclusion without body forces the displacement u satisfies div C' grad u = 0. Up to strain degree 0 ...
6 there are 6, 21, 42, 69, 102, 141, 186 polynomials of this kind, and 6, 24, 60, ... polynomials in total. Each degree
therefore gives the same solution with fewer unknowns, and without the null space that general polynomials have in a
void or a rigid inclusion. With the bounded factors of a stiffness (`eigencontact.core.elasticity`), a field g
represents both strain ``e = 2G soft g`` and stress ``τ = 2G stiff g``. Both are finite for a void (τ = 0), for a rigid
inclusion (e = 0), and for an incompressible inclusion.

References
----------
T. Mura 1987, Micromechanics of Defects in Solids, section 13 (polynomial eigenstrain in an inclusion). The dimensions
of the null spaces of the equilibrium equations by degree were computed for this project.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from eigencontact.core.array_types import FloatArray
from eigencontact.core.tensors import INDICES, SQRT2

__all__ = ["all_polynomials", "equilibrated_polynomials"]

_ROUNDING = 1e-9

Monomial = tuple[int, int, int]


def equilibrated_polynomials(
    soft: FloatArray, stiff: FloatArray, around: tuple[FloatArray, FloatArray], degree: int, points: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Values of g at points, ``(n, 6, m)``, lower degrees first, and the degree of each.

    Parameters
    ----------
    soft, stiff : (6, 6)
        Factors of the inclusion's stiffness.
    around : two of (6, 6)
        Factors of the surrounding material: they select among the fields of a void or a rigid inclusion.
    degree : int
        Degree of the strain.
    points : (m, 3)
        Relative to the centre, in units of the inclusion's size.

    Returns
    -------
    (n, 6, m), (n,) or None
        None if a degree has more than 6 degree + 9 fields (6 for degree 0), for a stiffness of lower rank.
    """
    empty, rigid = not stiff.any(), not soft.any()
    first, second = around if empty or rigid else (soft, stiff)
    values, degrees = [], []
    for total in range(degree + 1):
        fields = _fields(first, second, total)
        if fields is None:
            return None
        monomials = np.array([_power(points, exponents) for exponents in _monomials(total)])
        g = np.einsum("nip,pm->nim", fields, monomials)
        if empty:
            g = np.einsum("ij,njm->nim", first, g)
        elif rigid:
            g = np.einsum("ij,njm->nim", second, g)
        values.append(g / np.sqrt((g**2).mean(axis=(1, 2), keepdims=True)))
        degrees += [total] * len(g)
    return np.concatenate(values), np.array(degrees)


def all_polynomials(densities: FloatArray, degree: int) -> tuple[FloatArray, FloatArray]:
    """Values ``(n, 6, m)`` of every component of every density, lower degrees first, and their degrees."""
    values = np.einsum("ij,nm->nijm", np.eye(6), densities).reshape(-1, 6, densities.shape[1])
    counts = [(total + 1) * (total + 2) // 2 * 6 for total in range(degree + 1)]
    return values, np.repeat(np.arange(degree + 1), counts)


def _fields(soft: FloatArray, stiff: FloatArray, degree: int) -> FloatArray | None:
    """Homogeneous g of a degree, ``(n, 6, monomials)``, with sym grad u = soft g and div (stiff g) = 0."""
    soft, stiff = soft / np.abs(soft).max(), stiff / np.abs(stiff).max()
    of_u, of_g, of_force = (_monomials(degree + step) for step in (1, 0, -1))
    columns = {(0, i, p): n for n, (i, p) in enumerate((i, p) for i in range(3) for p in of_u)}
    columns |= {(1, i, p): len(columns) + n for n, (i, p) in enumerate((i, p) for i in range(6) for p in of_g)}
    rows: list[FloatArray] = []
    for row, (i, j) in enumerate(INDICES):
        weight = 0.5 if row < 3 else 0.5 * SQRT2
        for target in of_g:
            line = np.zeros(len(columns))
            for component, axis in ((i, j), (j, i)):
                raised = _shifted(target, axis, 1)
                line[columns[0, component, raised]] += weight * raised[axis]
            for column in range(6):
                line[columns[1, column, target]] -= soft[row, column]
            rows.append(line)
    for i in range(3):
        for target in of_force:
            line = np.zeros(len(columns))
            for row, pair in enumerate(INDICES):
                for axis in {pair[1] if pair[0] == i else pair[0]} if i in pair else ():
                    raised = _shifted(target, axis, 1)
                    scale = raised[axis] / (1.0 if row < 3 else SQRT2)
                    for column in range(6):
                        line[columns[1, column, raised]] += scale * stiff[row, column]
            rows.append(line)
    _, sizes, basis = np.linalg.svd(np.array(rows))
    rank = int((sizes > _ROUNDING * sizes[0]).sum())
    g = basis[rank:, 3 * len(of_u) :]
    # Rigid rotations have g = 0, and mix with the rest of the null space.
    _, sizes, turned = np.linalg.svd(g, full_matrices=False)
    independent = turned[sizes > _ROUNDING]
    expected = 6 if degree == 0 else 6 * (degree + 1) + 3
    return independent.reshape(-1, 6, len(of_g)) if len(independent) == expected else None


@cache
def _monomials(degree: int) -> tuple[Monomial, ...]:
    return tuple((i, j, degree - i - j) for i in range(degree + 1) for j in range(degree + 1 - i))


def _shifted(monomial: Monomial, axis: int, step: int) -> Monomial:
    i, j, k = (power + (step if axis == n else 0) for n, power in enumerate(monomial))
    return i, j, k


def _power(points: FloatArray, exponents: Monomial) -> FloatArray:
    return np.asarray(np.prod(points ** np.array(exponents), axis=1))
