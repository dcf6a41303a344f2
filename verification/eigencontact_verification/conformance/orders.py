"""Orders of differentiation, their names, and derivatives of the powers of the distance, written for the kit alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["AXES", "Order", "add", "name", "of_total", "point_derivatives"]

FloatArray = NDArray[np.float64]
Order = tuple[int, int, int]

#: Unit orders along x, y, z.
AXES: tuple[Order, Order, Order] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def add(first: Order, second: Order, times: int = 1) -> Order:
    """``first + times * second``."""
    return (first[0] + times * second[0], first[1] + times * second[1], first[2] + times * second[2])


def of_total(total: int) -> list[Order]:
    """All orders with this many derivatives: 3, 6, 10, 15, 21 for 1 to 5."""
    return [(i, j, total - i - j) for i in range(total, -1, -1) for j in range(total - i, -1, -1)]


def name(potential: str, order: Order) -> str:
    """``"Psi,xxz"`` for ``("psi", (2, 0, 1))``."""
    return f"{potential.capitalize()},{'x' * order[0]}{'y' * order[1]}{'z' * order[2]}"


def point_derivatives(power: int, orders: Sequence[Order], offset: FloatArray) -> FloatArray:
    """Derivatives of ``R**power`` at `offset` ``(3, ...)`` from the point, ``(len(orders), ...)``.

    From R² f,i = p x_i f, true of every power, differentiated by the product rule: each order follows from lower ones.
    """
    squared = np.sum(offset**2, axis=0)
    derivatives: dict[Order, FloatArray] = {(0, 0, 0): squared ** (power / 2)}

    def value(order: Order) -> FloatArray:
        if order in derivatives:
            return derivatives[order]
        axis = next(i for i in range(3) if order[i])
        base = add(order, AXES[axis], -1)
        total = power * offset[axis] * value(base)
        if base[axis]:
            total = total + power * base[axis] * value(add(base, AXES[axis], -1))
        for i in range(3):
            if base[i]:
                total = total - 2 * base[i] * offset[i] * value(add(order, AXES[i], -1))
            if base[i] > 1:
                total = total - base[i] * (base[i] - 1) * value(add(order, AXES[i], -2))
        derivatives[order] = total / squared
        return derivatives[order]

    return np.array([value(order) for order in orders])
