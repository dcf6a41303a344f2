"""Corner functions of a cuboid: derivatives of its potentials as sums over eight corners, finite everywhere.

Let (x, y, z) be the offset of the field point from a corner, R its length and i, j, k any permutation of the axes::

    L_i = ln(R + x_i)      A_i = arctan(x_j x_k / (x_i R))      g_i = 1 / (R (R + x_i))
    k_i = (2R + x_i) / (R³ (R + x_i)²) = -dg_i/dx_j / x_j       w = R + z      M = ln(w) + z/w
    E_x = arctan(y/x) - arctan(y z / (x R)), written without the branch jump at x = 0; E_y with x and y exchanged

Each table maps how often the potential is differentiated along i, j, k (in falling order; Chi: along x, y, z) to a
function whose mixed derivative d³/dx dy dz is that derivative of 1/R, R or z ln(R + z) - R. Terms that depend on only
two coordinates are omitted, because the sum over the corners removes them; it also removes a change of the unit of
length.

Expressions 0/0 and infinite values have a limit or a bound: R + x_i of negative x_i is (x_j² + x_k²)/(R - x_i); A_i at
x_i = 0 is the mean of both sides, 0, or the limit from a given side; quotients are floored at `FLOOR`, so that the
singularities of edges and corners are large, finite and of correct sign.

References: Chiu 1978, J. Appl. Mech. 45, 302-306 (cuboid in a half-space); Liu & Wang 2005, J. Appl. Mech. 72, 871-878
(corner sums of Psi and Phi); MacMillan 1930, The theory of the potential (potential of the cuboid).
"""

# ruff: noqa: N802 - symbols of the table above

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from eigencontact.plugin import FloatArray, Order

__all__ = ["Corner", "LineCorner", "corner_derivative"]


#: Smallest R and R + x_i in a logarithm or a quotient, in the unit of length of the coordinates.
FLOOR = 1e-30


class Corner:
    """Shared sub-expressions at offsets (x, y, z) from a corner, each computed at first use.

    `side` is the sign (-1, 0, 1; broadcast) that z = 0 counts as in A_z: 0 means the mean of both sides.
    """

    def __init__(self, x: FloatArray, y: FloatArray, z: FloatArray, side: FloatArray | float = 0.0) -> None:
        self.x = (x, y, z)
        self.squares = tuple(t * t for t in self.x)
        self.R: FloatArray = np.sqrt(self.squares[0] + self.squares[1] + self.squares[2])
        self.side = side
        self._computed: dict[tuple[str, int], FloatArray] = {}

    def _once(self, name: str, i: int, compute: Callable[[int], FloatArray]) -> FloatArray:
        value = self._computed.get((name, i))
        if value is None:
            value = self._computed[name, i] = compute(i)
        return value

    def u(self) -> FloatArray:
        """Quotient 1 / R."""
        return self._once("u", 0, lambda _: np.asarray(1.0 / np.maximum(self.R, FLOOR)))

    def u3(self) -> FloatArray:
        """Quotient 1 / R³."""
        return self._once("u3", 0, lambda _: np.asarray(self.u() ** 2 * self.u()))

    def plus(self, i: int) -> FloatArray:
        """R + x_i without cancellation, at least `FLOOR`."""
        return self._once("plus", i, self._plus)

    def _plus(self, i: int) -> FloatArray:
        total: FloatArray = self.R + np.abs(self.x[i])
        if np.any(self.x[i] < 0):
            squares = self.squares[i - 1] + self.squares[i - 2]
            total = np.where(self.x[i] < 0, squares / np.maximum(total, FLOOR), total)
        return np.maximum(total, FLOOR, out=total)

    def L(self, i: int) -> FloatArray:
        """Logarithm of R + x_i."""
        return self._once("L", i, lambda i: np.asarray(np.log(self.plus(i))))

    def A(self, i: int) -> FloatArray:
        """Angle arctan(x_j x_k / (x_i R)), sign-folded."""
        return self._once("A", i, self._A)

    def _A(self, i: int) -> FloatArray:
        sign = np.sign(self.x[i])
        if i == 2:
            sign = np.where(sign == 0, self.side, sign)
        angle: FloatArray = np.arctan2(self.x[i - 2] * sign * self.x[i - 1], np.abs(self.x[i]) * self.R)
        return angle

    def g(self, i: int) -> FloatArray:
        """Quotient 1 / (R (R + x_i))."""
        return self._once("g", i, lambda i: np.asarray(self.u() / self.plus(i)))

    def k(self, i: int) -> FloatArray:
        """Quotient (2R + x_i) / (R³ (R + x_i)²)."""
        return self._once("k", i, lambda i: np.asarray(self.g(i) * self.u() * (self.u() + 1.0 / self.plus(i))))

    def M(self) -> FloatArray:
        """Sum ln(R + z) + z / (R + z)."""
        return self._once("M", 2, lambda _: np.asarray(self.L(2) + self.x[2] / self.plus(2)))

    def E(self, i: int) -> FloatArray:
        """Angle E_x (i = 0) or E_y (i = 1), for z >= 0."""
        return self._once("E", i, self._E)

    def _E(self, i: int) -> FloatArray:
        (x, y, z), (x2, y2, _) = self.x, self.squares
        first, second = (x2, y2) if i == 0 else (y2, x2)
        return np.asarray(np.arctan2(x * y * (x2 + y2), self.plus(2) * (first * self.R + second * z)))


class LineCorner(Corner):
    """Corner at y = ∞: the odd part along y of each expression, without terms in y alone or in x or z alone.

    The sum over the corners at ±∞ removes the other terms. Factors of y in formulas have no such part: y counts as 0.
    """

    def __init__(self, x: FloatArray, z: FloatArray) -> None:
        super().__init__(x, np.zeros((), np.result_type(x, z)), z)
        self.rho2: FloatArray = np.maximum(self.squares[0] + self.squares[2], FLOOR**2)
        self.zeros: FloatArray = np.zeros(self.R.shape, self.R.dtype)
        self.R = self.zeros

    def u(self) -> FloatArray:
        """See `Corner.u`."""
        return self.zeros

    def plus(self, i: int) -> FloatArray:  # noqa: ARG002
        """See `Corner.plus`."""
        return np.full_like(self.zeros, np.inf)

    def L(self, i: int) -> FloatArray:
        """See `Corner.L`."""
        return np.asarray(-0.5 * np.log(self.rho2)) if i == 1 else self.zeros

    def A(self, i: int) -> FloatArray:
        """See `Corner.A`."""
        if i == 1:
            return self.zeros
        sign, transverse = np.sign(self.x[i]), self.x[2 - i]
        return np.asarray(np.arctan2(transverse * sign + self.zeros, np.abs(self.x[i])))

    def g(self, i: int) -> FloatArray:
        """See `Corner.g`."""
        return np.asarray(-1.0 / self.rho2) if i == 1 else self.zeros

    def k(self, i: int) -> FloatArray:
        """See `Corner.k`."""
        return np.asarray(-2.0 / self.rho2**2) if i == 1 else self.zeros

    def M(self) -> FloatArray:
        """See `Corner.M`."""
        return self.zeros

    def E(self, i: int) -> FloatArray:
        """See `Corner.E`."""
        return self.A(2) if i == 0 else self.zeros


Formula = Callable[[Corner, int, int, int], FloatArray]

PHI: dict[Order, Formula] = {
    (1, 0, 0): lambda c, i, j, k: c.x[j] * c.L(k) + c.x[k] * c.L(j) - c.x[i] * c.A(i),
    (1, 1, 0): lambda c, _i, _j, k: c.L(k),
    (2, 0, 0): lambda c, i, _j, _k: -c.A(i),
    (1, 1, 1): lambda c, _i, _j, _k: c.u(),
    (2, 1, 0): lambda c, i, _j, k: c.x[i] * c.g(k),
    (3, 0, 0): lambda c, _i, j, k: -(c.x[j] * c.g(k) + c.x[k] * c.g(j)),
    (2, 1, 1): lambda c, i, _j, _k: -c.x[i] * c.u3(),
    (2, 2, 0): lambda c, i, j, k: -c.x[i] * c.x[j] * c.k(k),
    (3, 1, 0): lambda c, i, _j, k: c.g(k) - c.squares[i] * c.k(k),
    (4, 0, 0): lambda c, i, j, k: c.x[i] * (c.x[j] * c.k(k) + c.x[k] * c.k(j)),
}
PSI: dict[Order, Formula] = {
    (1, 1, 1): lambda c, _i, _j, _k: c.R,
    (2, 1, 0): lambda c, i, _j, k: c.x[i] * c.L(k),
    (3, 0, 0): lambda c, i, j, k: c.x[j] * c.L(k) + c.x[k] * c.L(j) - 2 * c.x[i] * c.A(i),
    (2, 1, 1): lambda c, i, _j, _k: c.x[i] * c.u(),
    (2, 2, 0): lambda c, i, j, k: c.x[i] * c.x[j] * c.g(k),
    (3, 1, 0): lambda c, i, _j, k: c.L(k) + c.squares[i] * c.g(k),
    (4, 0, 0): lambda c, i, j, k: -2 * c.A(i) - c.x[i] * (c.x[j] * c.g(k) + c.x[k] * c.g(j)),
    (2, 2, 1): lambda c, i, j, _k: -c.x[i] * c.x[j] * c.u3(),
    (3, 1, 1): lambda c, i, _j, _k: c.u() - c.squares[i] * c.u3(),
    (3, 2, 0): lambda c, i, j, k: c.x[j] * (c.g(k) - c.squares[i] * c.k(k)),
    (4, 1, 0): lambda c, i, _j, k: c.x[i] * (3 * c.g(k) - c.squares[i] * c.k(k)),
    (5, 0, 0): lambda c, i, j, k: (
        c.squares[i] * (c.x[j] * c.k(k) + c.x[k] * c.k(j)) - 3 * (c.x[j] * c.g(k) + c.x[k] * c.g(j))
    ),
}
#: At most one derivative along z, which is axis k; i and j are x and y with n_i >= n_j.
CHI: dict[Order, Formula] = {
    (2, 1, 0): lambda c, i, _j, _k: -0.5 * c.x[i] * c.M(),
    (3, 0, 0): lambda c, i, j, k: 0.5 * c.x[j] * c.M() - PHI[1, 0, 0](c, i, j, k),
    (1, 1, 1): lambda c, _i, _j, k: c.x[k] * c.L(k) - c.R,
    (2, 0, 1): lambda c, i, j, k: c.x[k] * c.E(i) - c.x[i] * c.L(j),
    (2, 2, 0): lambda c, i, j, k: -0.5 * (c.x[i] / c.plus(k)) * (c.x[j] / c.plus(k)),
    (3, 1, 0): lambda c, i, _j, k: -0.5 * (c.M() + (c.x[i] / c.plus(k)) ** 2),
    (4, 0, 0): lambda c, i, j, k: 0.5 * (c.x[i] / c.plus(k)) * (c.x[j] / c.plus(k)) + c.A(i),
    (2, 1, 1): lambda c, i, _j, k: -c.x[i] / c.plus(k),
    (3, 0, 1): lambda c, _i, j, k: c.x[j] / c.plus(k) - c.L(j),
}


def _formula(potential: str, order: Order) -> tuple[Formula, tuple[int, int, int]]:
    """Entry of the tables for an order, and the axes (i, j, k) to read it with."""
    if potential == "chi":
        if order[2] >= 2:  # Chi,zz is Phi
            return _formula("phi", (order[0], order[1], order[2] - 2))
        i, j = (0, 1) if order[0] >= order[1] else (1, 0)
        return CHI[order[i], order[j], order[2]], (i, j, 2)
    i, j, k = sorted(range(3), key=lambda axis: -order[axis])
    return {"phi": PHI, "psi": PSI}[potential][order[i], order[j], order[k]], (i, j, k)


def corner_derivative(potential: str, order: Order, corner: Corner) -> FloatArray:
    """Corner function of one derivative of ``"phi"``, ``"psi"`` or ``"chi"``."""
    formula, axes = _formula(potential, order)
    return formula(corner, *axes)
