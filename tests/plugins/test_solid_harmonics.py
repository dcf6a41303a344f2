"""Ladders of solid harmonics: derivatives by differences, with the orders beyond the degree that Chi needs."""

import numpy as np
import pytest

from eigencontact_plugins.shapes.solid_harmonics import Inner, Outer

STEP = 1e-3
POINTS = np.array([[0.4, -0.7, 1.1], [0.9, 0.3, -0.6], [0.5, 1.2, 0.2]])


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("kind", ["inner", "outer", "continued"])
def test_ladders_differentiate(kind, axis):
    degree = 5
    functions = Inner(degree) if kind == "inner" else Outer(degree, continued=kind == "continued")
    points = np.abs(POINTS) if kind == "continued" else POINTS
    rows = np.eye(len(functions.indices), dtype=complex)
    order = tuple(int(n == axis) for n in range(3))
    slope = np.zeros((2 * len(functions.half), points.shape[1]))
    for shift, weight in ((-2, 1), (-1, -8), (1, 8), (2, -1)):
        at = points + STEP * shift * np.eye(3)[axis][:, None]
        slope += weight / (12 * STEP) * functions.values(*at)
    for part in (1.0, -1j):  # real and imaginary parts
        expected = functions.real_part(part * rows) @ slope
        found = functions.real_part(functions.differentiated(part * rows, order)) @ functions.values(*points)
        for row, (power, low, m) in enumerate(functions.indices):
            # The highest degree has no step above it; degrees below 1 stand for functions that no field uses.
            if kind == "inner" or (2 * power + low < degree and low < degree and (low >= 1 or abs(m) <= low)):
                scale = np.abs(found[row]).max() + np.abs(expected[row]).max() + 1e-3
                np.testing.assert_allclose(found[row], expected[row], atol=1e-9 * scale, rtol=0)
