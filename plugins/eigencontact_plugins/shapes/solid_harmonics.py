r"""Solid harmonics, their products with powers of r, and their derivatives as matrices (ladders).

Regular and irregular solid harmonics of degree l and order m, x_± = x ± iy, P without the factor (-1)^m::

    R_l^m = r^l P_l^m(cos) e^(im phi) / (l+m)!        I_l^m = (l-m)! P_l^m(cos) e^(im phi) / r^(l+1)
    X_l^(-m) = (-1)^m conj(X_l^m)

Derivatives are single harmonics of neighbouring degree and order, so that {r^(2j) R_l^m} and {I_l^m, r² I_l^m} are
closed under differentiation: any derivative of a function of such a set is a row of coefficients. I_l^m with l = m - 1
and m - 2 continue the ladder downwards along z; they are regular except on the negative z axis.

References
----------
E. W. Hobson 1931, The Theory of Spherical and Ellipsoidal Harmonics, ch. III and IV; L. Greengard and V. Rokhlin 1997,
Acta Numerica 6, 229 (irregular harmonics and their derivatives). The continued ladder was derived for this project.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cache
from math import comb, prod

import numpy as np
from numpy.typing import NDArray

from eigencontact.plugin import FloatArray

__all__ = ["Inner", "Outer", "ladder"]

ComplexArray = NDArray[np.complex128]
#: Power j of r² that multiplies a harmonic, its degree l and its order m.
Index = tuple[int, int, int]
Terms = dict[Index, float]


class _Functions(ABC):
    """Set of functions that is closed under differentiation.

    Attributes
    ----------
    indices : list of Index
        All functions, negative orders included.
    row : dict
        Position of each in `indices`.
    """

    def __init__(self, indices: list[Index]) -> None:
        self.indices = indices
        self.row = {index: row for row, index in enumerate(indices)}
        self.half = [index for index in indices if index[2] >= 0]
        ladders = {step: self._matrix(step) for step in ("+", "-", "z")}
        plus, minus = ladders["+"], ladders["-"]
        from scipy.sparse import csr_array  # late: most runs need no moments

        # Each row of the transpose has at most two entries.
        self._along = tuple(csr_array(step.T) for step in (0.5 * (plus + minus), -0.5j * (plus - minus), ladders["z"]))
        self._place = np.array([self.half.index((j, low, abs(m))) for j, low, m in indices])
        self._mirrored = np.array([m < 0 for _, _, m in indices])
        self._sign = np.array([(-1.0) ** m if m < 0 else 1.0 for _, _, m in indices])

    @abstractmethod
    def _step(self, step: str, index: Index) -> Terms:
        """Coefficients of the derivative of a function along ``"+"``, ``"-"`` or ``"z"``."""

    def _matrix(self, step: str) -> ComplexArray:
        out = np.zeros((len(self.indices), len(self.indices)), dtype=complex)
        for row, index in enumerate(self.indices):
            for target, value in self._step(step, index).items():
                if value and target in self.row:
                    out[row, self.row[target]] = value
        return out

    def differentiated(self, rows: ComplexArray, order: tuple[int, int, int]) -> ComplexArray:
        """Derivative of functions from their rows of coefficients, ``(n, len(indices))``."""
        columns = rows.T
        for times, matrix in zip(order, self._along, strict=True):
            for _ in range(times):
                columns = matrix @ columns
        return np.asarray(columns.T)

    def real_part(self, rows: ComplexArray) -> FloatArray:
        """Coefficients ``(..., 2 len(half))`` of the real part in the real and imaginary parts of orders m >= 0."""
        folded = np.where(self._mirrored, np.conj(rows), rows) * self._sign
        half = np.zeros((*rows.shape[:-1], len(self.half)), dtype=complex)
        for column, place in enumerate(self._place):  # at most two functions share a position
            half[..., place] += folded[..., column]
        return np.concatenate((half.real, -half.imag), axis=-1)


class Inner(_Functions):
    """r^(2j) R_l^m with 2j + l up to a degree: all polynomials of that degree."""

    def __init__(self, degree: int) -> None:
        super().__init__(
            [
                (j, low, m)
                for total in range(degree + 1)
                for j in range(total // 2 + 1)
                for low in (total - 2 * j,)
                for m in range(-low, low + 1)
            ]
        )
        self.degree = degree

    def _step(self, step: str, index: Index) -> Terms:
        j, low, m = index
        shift = {"z": 0, "+": 1, "-": -1}[step]
        raised = {"z": (low + m + 1) * (low - m + 1), "+": (low + m + 1) * (low + m + 2)}.get(
            step, -(low - m + 1) * (low - m + 2)
        )
        lowered = {"z": 1, "+": -1, "-": 1}[step]
        size = 2 * low + 1
        return {
            (j - 1, low + 1, m + shift): 2 * j * raised / size,
            (j, low - 1, m + shift): lowered * (2 * j + size) / size,
        }

    def values(self, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Real and imaginary parts of the functions with m >= 0, ``(2 len(half), n)``."""
        plus, square = x + 1j * y, x * x + y * y + z * z
        harmonics: dict[tuple[int, int], ComplexArray] = {(0, 0): np.ones(x.shape, dtype=complex)}
        for m in range(self.degree + 1):
            if m:
                harmonics[m, m] = plus * harmonics[m - 1, m - 1] / (2 * m)
            for low in range(m, self.degree):
                below = square * harmonics[low - 1, m] if low > m else 0.0
                harmonics[low + 1, m] = ((2 * low + 1) * z * harmonics[low, m] - below) / (
                    (low + m + 1) * (low - m + 1)
                )
        out = np.empty((2 * len(self.half), *x.shape))
        for row, (j, low, m) in enumerate(self.half):
            values = harmonics[low, m] * square**j if j else harmonics[low, m]
            out[row], out[row + len(self.half)] = values.real, values.imag
        return out


class Outer(_Functions):
    """I_l^m with l up to a degree, |m| <= l + 2 where the ladder is continued, and r² I_l^m (j = 1) with |m| <= l."""

    def __init__(self, degree: int, *, continued: bool) -> None:
        more = 2 if continued else 0
        lowest = -more
        plain = [(0, low, m) for low in range(lowest, degree + 1) for m in range(-(low + more), low + more + 1)]
        super().__init__(plain + [(1, low, m) for low in range(degree + 1) for m in range(-low, low + 1)])
        self.degree, self._more = degree, more

    def _step(self, step: str, index: Index) -> Terms:
        j, low, m = index
        target = m + {"z": 0, "+": 1, "-": -1}[step]
        plain = {"z": -1.0, "+": -1.0, "-": 1.0}[step]
        if j == 0:
            return {(0, low + 1, target): plain}
        size = 2 * low + 1
        raised = {"z": 1.0, "+": 1.0, "-": -1.0}[step]
        lowered = {"z": (low - m) * (low + m), "+": -(low - m) * (low - m - 1)}.get(step, (low + m) * (low + m - 1))
        return {(1, low + 1, target): plain + 2 * raised / size, (0, low - 1, target): 2 * lowered / size}

    def values(self, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
        """Real and imaginary parts of the functions with m >= 0, ``(2 len(half), n)``; r > 0, and z >= 0 if continued.

        Functions of degree below 1 and order above it are 0: no third derivative requires them.
        """
        plus, square = x + 1j * y, x * x + y * y + z * z
        over, distance = 1.0 / square, np.sqrt(square)
        harmonics: dict[tuple[int, int], ComplexArray] = {(0, 0): (1.0 / distance).astype(complex)}
        highest = self.degree + self._more
        for m in range(highest + 1):
            if m:
                harmonics[m, m] = (2 * m - 1) * plus * over * harmonics[m - 1, m - 1]
            for low in range(m, self.degree):
                below = (low - m) * (low + m) * harmonics[low - 1, m] if low > m else 0.0
                harmonics[low + 1, m] = ((2 * low + 1) * z * harmonics[low, m] - below) * over
        if self._more:
            self._continue(harmonics, plus, square, distance, z)
        out = np.zeros((2 * len(self.half), *x.shape))
        for row, (j, low, m) in enumerate(self.half):
            if (low, m) in harmonics:
                values = harmonics[low, m] * square if j else harmonics[low, m]
                out[row], out[row + len(self.half)] = values.real, values.imag
        return out

    def _continue(
        self,
        harmonics: dict[tuple[int, int], ComplexArray],
        plus: ComplexArray,
        square: FloatArray,
        distance: FloatArray,
        z: FloatArray,
    ) -> None:
        """Add I_(m-1)^m and I_(m-2)^m: finite for z >= 0; the first has no difference of nearly equal numbers."""
        cosine, base = z / distance, plus / (distance * (distance + z))
        power = np.ones_like(plus)
        for m in range(1, self.degree + 3):
            power = power * base
            first = power * np.polynomial.polynomial.polyval(cosine, _continued(m))
            if m - 1 <= self.degree:
                harmonics[m - 1, m] = first
            if m >= 2:
                harmonics[m - 2, m] = square * harmonics[m, m] / (2 * m - 1) - z * first


@cache
def _continued(m: int) -> tuple[float, ...]:
    """Coefficients of Q_m, by powers of z/r: I_(m-1)^m = [x_+/(r (r + z))]^m Q_m(z/r)."""
    if m == 1:
        return (1.0,)
    below, odd = (*_continued(m - 1), 0.0), float(prod(range(1, 2 * (m - 1), 2)))
    last = m - 1
    out = [2.0 * last * below[0]]
    for power in range(1, m):
        out.append(out[-1] + 2.0 * last * below[power] - odd * comb(last, power - 1))
    return tuple(out)


@cache
def ladder(kind: str, degree: int) -> Inner | Outer:
    """Functions up to a degree: ``"inner"``, ``"outer"``, or ``"image"`` with the continued ladder."""
    return Inner(degree) if kind == "inner" else Outer(degree, continued=kind == "image")
