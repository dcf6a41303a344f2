"""Truncated Taylor series in x, y and z ("jets"): write a potential as a formula, get its exact derivatives.

A jet holds, for many points at once, the Taylor coefficients of one function up to an order. Sums, products, quotients,
powers and the elementary functions below act on the coefficients, so a formula written for numbers, evaluated on the
jets of the coordinates, yields every partial derivative at round-off: no difference quotients, no symbolic algebra.

A product costs ``binomial(order + 6, 6)`` multiplications a point: 28 for order 2, 210 for order 4, 462 for order 5.

References
----------
A. Griewank & A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, chapter 13 (Taylor arithmetic).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from math import factorial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eigencontact.core.array_types import FloatArray

__all__ = ["Jet", "derivatives_of", "implicit", "monomials", "variables"]

Order = tuple[int, int, int]
CHUNK = 4096  # points worked on together by `derivatives_of`: the coefficients of a few jets fit into the cache


@cache
def monomials(order: int) -> tuple[Order, ...]:
    """Exponents of x, y, z up to a total degree, by rising degree.

    Examples
    --------
    >>> monomials(1)
    ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
    """
    return tuple(
        (i, j, degree - i - j) for degree in range(order + 1) for i in range(degree, -1, -1)
        for j in range(degree - i, -1, -1)
    )  # fmt: skip


@cache
def _places(order: int) -> dict[Order, int]:
    return {exponents: place for place, exponents in enumerate(monomials(order))}


@cache
def _product_table(order: int) -> tuple[NDArray[np.intp], ...]:
    """Positions of the products of each monomial with all monomials up to the order."""
    exponents, places = monomials(order), _places(order)
    return tuple(
        np.array([places[i + l, j + m, k + n] for l, m, n in exponents if i + j + k + l + m + n <= order])
        for i, j, k in exponents
    )


@cache
def _degree(size: int) -> int:
    """Total degree of a polynomial of so many coefficients."""
    return next(degree for degree in range(size) if len(monomials(degree)) >= size) if size > 1 else 0


def _multiply(a: FloatArray, b: FloatArray, order: int) -> FloatArray:
    """Product up to `order`; its length, like that of the factors, determines its degree."""
    if len(a) > len(b):
        a, b = b, a
    table = _product_table(order)
    size = len(monomials(min(order, _degree(len(a)) + _degree(len(b)))))
    product = np.zeros((size, *np.broadcast_shapes(a.shape[1:], b.shape[1:])))
    product[: len(b)] = a[0] * b[: len(table)]
    for place in range(1, min(len(a), len(table))):
        target = table[place][: len(b)]
        product[target] += a[place] * b[: len(target)]
    return product


def _sum(a: FloatArray, b: FloatArray) -> FloatArray:
    if len(a) < len(b):
        a, b = b, a
    total = a.copy()
    total[: len(b)] += b
    return total


class Jet:
    """Taylor coefficients of one function at many points.

    Parameters
    ----------
    coefficients : (m, ...)
        Derivative ``(i, j, k)`` divided by ``i! j! k!`` for each of `monomials`, then the axes of the points. A
        polynomial of low degree has fewer rows than the order; the rest are zero.
    order : int
        Total degree after which the series is cut; operations cut to the lower order of two jets.

    Notes
    -----
    Understands ``+ - * / **`` with jets, numbers and arrays of the points' shape, and the numpy functions ``sqrt, exp,
    log, arctan, arcsinh, arctan2, square, reciprocal``. At points where the function is singular the result is what
    numpy gives for its value (infinite or NaN, with a warning).

    Examples
    --------
    Second derivatives of 1/R at (0, 0, 2): 2/R³ along z, -1/R³ across.

    >>> x, y, z = variables(0.0, 0.0, 2.0, order=2)
    >>> inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
    >>> float(inverse.derivative((0, 0, 2))), float(inverse.derivative((2, 0, 0)))
    (0.25, -0.125)
    """

    __slots__ = ("coefficients", "order")

    def __init__(self, coefficients: FloatArray, order: int) -> None:
        self.coefficients = coefficients
        self.order = order

    @property
    def value(self) -> FloatArray:
        """The function itself."""
        return np.asarray(self.coefficients[0])

    def derivative(self, orders: Order) -> FloatArray:
        """Partial derivative, `orders` times along x, y and z."""
        i, j, k = orders
        place = _places(self.order).get((i, j, k))
        if place is None:
            raise ValueError(
                f"derivative must be of total order 0 to {self.order} (got {orders}); ask `variables` for more"
            )
        if place >= len(self.coefficients):
            return np.zeros_like(self.value)
        return np.asarray(self.coefficients[place] * float(factorial(i) * factorial(j) * factorial(k)))

    def truncated(self, order: int) -> Jet:
        """The same series, cut after a lower order."""
        return Jet(self.coefficients[: len(monomials(order))], min(order, self.order))

    def compose(self, series: Sequence[ArrayLike]) -> Jet:
        """Function of this jet from the Taylor coefficients ``f, f', f''/2!, ...`` at `value`, order + 1 terms."""
        terms = [np.asarray(term, dtype=float) for term in series]
        step = self.coefficients.copy()
        step[0] = 0.0
        result = np.zeros((1, *self.value.shape)) + terms[self.order]
        for degree in range(1, self.order + 1):  # Horner; what is multiplied later needs fewer orders now
            result = _multiply(step, result, degree)
            result[0] += terms[self.order - degree]
        return Jet(result, self.order)

    @classmethod
    def from_gradient(cls, value: ArrayLike, gradient: tuple[Jet, Jet, Jet]) -> Jet:
        """Jet, one order higher, with this gradient: for integrals with elementary derivatives."""
        order = min(derivative.order for derivative in gradient) + 1
        exponents = monomials(order)
        coefficients = np.zeros((len(exponents), *gradient[0].value.shape))
        coefficients[0] = value
        for place in range(1, len(exponents)):
            axis = next(a for a in range(3) if exponents[place][a])
            i, j, k = (count - (axis == a) for a, count in enumerate(exponents[place]))
            lower = _places(order)[i, j, k]
            if lower < len(gradient[axis].coefficients):
                coefficients[place] = gradient[axis].coefficients[lower] / exponents[place][axis]
        return cls(coefficients, order)

    def __add__(self, other: Any) -> Jet:
        if isinstance(other, Jet):
            order = min(self.order, other.order)
            size = len(monomials(order))
            return Jet(_sum(self.coefficients[:size], other.coefficients[:size]), order)
        shifted = self.coefficients.copy()
        shifted[0] += other
        return Jet(shifted, self.order)

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(-self.coefficients, self.order)

    def __sub__(self, other: Any) -> Jet:
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> Jet:
        return (-self).__add__(other)

    def __mul__(self, other: Any) -> Jet:
        if isinstance(other, Jet):
            order = min(self.order, other.order)
            return Jet(_multiply(self.coefficients, other.coefficients, order), order)
        return Jet(self.coefficients * other, self.order)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Jet:
        return self * _power(other, -1.0) if isinstance(other, Jet) else Jet(self.coefficients / other, self.order)

    def __rtruediv__(self, other: Any) -> Jet:
        return _power(self, -1.0).__mul__(other)

    def __pow__(self, exponent: float) -> Jet:
        """Real power; whole powers from 1 on are products, which also hold at a value of zero."""
        if not (float(exponent).is_integer() and exponent >= 1):
            return _power(self, float(exponent))
        if exponent == 1:
            return self
        half: Jet = self ** (exponent // 2)
        return half * half * self if exponent % 2 else half * half

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        function = _FUNCTIONS.get(ufunc)
        if function is None or method != "__call__" or options:
            return NotImplemented
        return function(*inputs)


def _power(jet: Jet, exponent: float) -> Jet:
    inverse = 1.0 / jet.value
    terms = [inverse if exponent == -1.0 else jet.value**exponent]
    for degree in range(1, jet.order + 1):
        terms.append(terms[-1] * (inverse * ((exponent - degree + 1) / degree)))
    return jet.compose(terms)


def _exp(jet: Jet) -> Jet:
    value = np.exp(jet.value)
    return jet.compose([value / factorial(degree) for degree in range(jet.order + 1)])


def _log(jet: Jet) -> Jet:
    powers = [(-1.0 / jet.value) ** degree / -degree for degree in range(1, jet.order + 1)]
    return jet.compose([np.log(jet.value), *powers])


def _arctan(jet: Jet) -> Jet:
    angle, inverse = np.arctan2(1.0, jet.value), 1.0 / np.hypot(1.0, jet.value)
    terms = [-np.sin(k * angle) * (-inverse) ** k / k for k in range(1, jet.order + 1)]
    return jet.compose([np.arctan(jet.value), *terms])


def _arcsinh(jet: Jet) -> Jet:
    """Coefficients p of the derivative (1 + v²)^(-1/2): (k + 1)(1 + v²) p_(k+1) = -(2k + 1) v p_k - k p_(k-1)."""
    v, square = jet.value, 1.0 + jet.value**2
    terms, p, before = [np.arcsinh(v)], 1.0 / np.sqrt(square), np.zeros_like(v)
    for k in range(jet.order):
        terms.append(p / (k + 1))
        p, before = -((2 * k + 1) * v * p + k * before) / ((k + 1) * square), p
    return jet.compose(terms)


def _arctan2(y: Any, x: Any) -> Jet:
    """Angle of (x, y), by a rotation to the direction of the value, where the arctangent is regular."""
    a, b = (
        coordinate.value if isinstance(coordinate, Jet) else np.asarray(coordinate, dtype=float)
        for coordinate in (x, y)
    )
    return _arctan((y * a - x * b) / (x * a + y * b)) + np.arctan2(b, a)


_FUNCTIONS: dict[np.ufunc, Callable[..., Jet]] = {
    np.add: lambda a, b: a + b if isinstance(a, Jet) else b.__radd__(a),
    np.subtract: lambda a, b: a - b if isinstance(a, Jet) else b.__rsub__(a),
    np.multiply: lambda a, b: a * b if isinstance(a, Jet) else b.__rmul__(a),
    np.true_divide: lambda a, b: a / b if isinstance(a, Jet) else b.__rtruediv__(a),
    np.power: lambda a, b: a**b,
    np.negative: lambda a: -a,
    np.square: lambda a: a * a,
    np.reciprocal: lambda a: a**-1,
    np.sqrt: lambda a: a**0.5,
    np.exp: _exp,
    np.log: _log,
    np.arctan: _arctan,
    np.arcsinh: _arcsinh,
    np.arctan2: _arctan2,
}


def variables(x: ArrayLike, y: ArrayLike, z: ArrayLike, order: int) -> tuple[Jet, Jet, Jet]:
    """Jets of the coordinates; x, y, z broadcast.

    Examples
    --------
    >>> x, y, z = variables(2.0, 3.0, 5.0, 1)
    >>> (x * y).derivative((1, 0, 0)).tolist()
    3.0
    """
    values = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in (x, y, z)))
    jets = []
    for axis, value in enumerate(values):
        coefficients = np.zeros((4 if order > 0 else 1, *value.shape))
        coefficients[0] = value
        if order > 0:
            coefficients[1 + axis] = 1.0
        jets.append(Jet(coefficients, order))
    return jets[0], jets[1], jets[2]


def implicit(equation: Callable[[Jet], Jet], root: FloatArray, slope: FloatArray, order: int) -> Jet:
    """Jet of the function w(x, y, z) that solves ``equation(w) = 0``.

    Parameters
    ----------
    equation : callable
        Residual as a jet, given the jet of w; written with the jets of the coordinates.
    root, slope : (...)
        Solution at the points, to round-off, and the derivative of the residual by w there, not zero.
    order : int
        Order wanted; each step of Newton's method with that slope settles one more.

    Examples
    --------
    The cube root of x + y at 8: derivatives 1/12 and -1/144.

    >>> x, y, z = variables(5.0, 3.0, 0.0, order=2)
    >>> w = implicit(lambda w: w**3 - x - y, np.array(2.0), np.array(12.0), 2)
    >>> float(w.derivative((0, 1, 0)) * 12), round(float(w.derivative((1, 1, 0)) * 144), 12)
    (1.0, -1.0)
    """
    solution = Jet(np.asarray(root, dtype=float)[None], 0)
    for degree in range(1, order + 1):
        residual = equation(Jet(solution.coefficients, degree)).coefficients / -slope
        residual[: len(monomials(degree - 1))] = 0.0  # settled already; what is left of them is rounding
        solution = Jet(_sum(solution.coefficients, residual[: len(monomials(degree))]), degree)
    return solution


def derivatives_of(
    function: Callable[[Jet, Jet, Jet], Jet], orders: Sequence[Order], x: ArrayLike, y: ArrayLike, z: ArrayLike
) -> FloatArray:
    """Derivatives of a formula, ``(len(orders), ...)``; x, y, z broadcast. All that ``phi`` of a shape has to call.

    Examples
    --------
    Gradient of R at (3, 0, 4):

    >>> derivatives_of(lambda x, y, z: np.sqrt(x * x + y * y + z * z), [(1, 0, 0), (0, 0, 1)], 3.0, 0.0, 4.0)
    array([0.6, 0.8])
    """
    points = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in (x, y, z)))
    flat = [value.reshape(-1) for value in points]
    result = np.empty((len(orders), flat[0].size))
    highest = max((sum(order) for order in orders), default=0)
    for start in range(0, flat[0].size, CHUNK):
        chunk = slice(start, start + CHUNK)
        jet = function(*variables(flat[0][chunk], flat[1][chunk], flat[2][chunk], highest))
        for row, order in enumerate(orders):
            result[row, chunk] = jet.derivative(order)
    return result.reshape(len(orders), *points[0].shape)
