"""What tests of shapes in closed form share: derivatives of their potentials, and rules that these obey."""

import numpy as np

from point_potentials import orders

#: Potentials and orders of their derivatives that fields need.
DERIVATIVES = [("phi", n) for n in (1, 2, 3, 4)] + [("psi", n) for n in (3, 4, 5)] + [("chi", n) for n in (3, 4)]
#: Those whose derivatives of the order below are at hand too.
RAISED = [("phi", 2), ("phi", 3), ("phi", 4), ("psi", 4), ("psi", 5)]
#: Central differences of eighth order, by distance in steps.
_STENCIL = {1: 4 / 5, 2: -1 / 5, 3: 4 / 105, 4: -1 / 280}


def columns(points):
    return tuple(np.array(points, dtype=float).T)


def evaluate(shape, potential, order, points):
    return getattr(shape, potential)(orders(order), *points)


def check_gradient(shape, potential, order, points, *, step, tolerance, floor=0.0):
    """Each order is the gradient of the one below, by differences; their error is that of rounding, 1e-16 / step."""
    values = evaluate(shape, potential, order, points)
    atol = tolerance * max(floor, np.abs(values).max())
    for axis in range(3):
        gradient = 0.0
        for distance, weight in _STENCIL.items():
            for sign in (1, -1):
                moved = [t + sign * distance * step * (i == axis) for i, t in enumerate(points)]
                gradient = gradient + sign * weight / step * evaluate(shape, potential, order - 1, moved)
        for lower, expected in zip(orders(order - 1), gradient, strict=True):
            row = orders(order).index(tuple(n + (i == axis) for i, n in enumerate(lower)))
            np.testing.assert_allclose(values[row], expected, rtol=0, atol=atol)


def check_scaling(shape, scaled, factor, potential, order, points):
    """A shape whose lengths are all scaled has derivatives scaled by a power of the factor."""
    values = evaluate(scaled, potential, order, tuple(factor * t for t in points))
    expected = evaluate(shape, potential, order, points) * factor ** ((2 if potential == "phi" else 4) - order)
    np.testing.assert_allclose(values, expected, rtol=0, atol=1e-13 * np.abs(expected).max())


def check_forms(shape):
    """Points come in any form, none among them, and stay as they are; there may be no derivative."""
    x, y, z = (np.linspace(0, 1, 6).reshape(2, 3) for _ in range(3))
    for t in (x, y, z):
        t.flags.writeable = False
    assert shape.psi([(4, 0, 0), (3, 1, 0)], x, y, z).shape == (2, 2, 3)
    assert shape.phi([], x, y, z).shape == (0, 2, 3)
    assert shape.chi([(4, 0, 0)], x[:0], y[:0], z[:0]).shape == (1, 0, 3)
