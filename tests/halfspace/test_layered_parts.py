"""Transforms, nodes and weights behind the coefficients of layers, each against closed forms."""

import numpy as np
import pytest

from eigencontact.halfspace.layered_cells import StretchedNodes
from eigencontact.halfspace.layered_hankel import LogGrid

# --- Hankel transform ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e4])
@pytest.mark.parametrize("reach", [1e-3, 0.4, 30.0])  # the integral itself is summed close to the axis
def test_hankel_transforms_of_an_exponential(scale, reach):
    """The transform of exp(-ks): ((d - s)/r)^n (1 + n d/s) s / d³ / 2π with d² = r² + s²."""
    grid = LogGrid(scale, 1.5 * reach * scale, 0.1, 1e-14, 60.0)
    r = np.geomspace(1e-3, 1.0, 40) * reach
    d = np.sqrt(1 + r * r)
    response = np.exp(-grid.wavenumbers * scale)
    found = grid.fields([np.array([response, 2 * response])] * 4, range(4), r * scale)
    for order, values in enumerate(found):
        expected = (r / (d + 1)) ** order * (1 + order * d) / d**3 / (2 * np.pi)
        assert values.shape == (2, 40)
        error = np.abs(values[0] * scale**2 - expected).max()
        assert error < (1e-14 if reach < 0.5 else 1e-12) * np.abs(expected).max()
        np.testing.assert_allclose(values[1], 2 * values[0], rtol=1e-12, atol=1e-14 * np.abs(values).max())


def test_what_vanishes_on_the_axis_keeps_its_digits():
    """Order 0 of (1 - kz/2) exp(-kz) is 3 r² / 4π z⁴ there: a window of 1/1000 of the depth sees a millionth."""
    grid = LogGrid(1.0, 1.0, 0.1, 1e-14, 60.0)
    k, r = grid.wavenumbers, np.array([1e-3])
    (values,) = grid.fields([((1 - 0.5 * k) * np.exp(-k))[None]], [0], r)
    np.testing.assert_allclose(values[0], 3 * r**2 / (4 * np.pi), rtol=1e-5)


# --- nodes --------------------------------------------------------------------------------------------------------


def nodes(scale, reach, digits=45.0):
    return StretchedNodes.enough(scale, float(np.arcsinh(reach / scale)), digits)


@pytest.mark.parametrize("cell", [1e-6, 1e-2, 1.0, 50.0, 1e4])
def test_integrals_over_cells_of_any_size(cell):
    """Of s / (s² + x²)^(3/2) and x / (s² + x²)^2 for s = 1, relative to what a cell may hold of them."""
    x = np.arange(20) * cell
    low, high = x - 0.5 * cell, x + 0.5 * cell
    found = nodes(1.0, high[-1])
    weights = found.integrals(x, 0.5 * cell)
    even, odd = (1 + found.x**2) ** -1.5, found.x / (1 + found.x**2) ** 2
    # Differences of the primitives sin(arctan x) and -1/2(1 + x²), written so that narrow cells keep their digits.
    middle = 0.5 * (np.arctan(low) + np.arctan(high))
    expected = 2 * np.cos(middle) * np.sin(0.5 * np.arctan2(cell, 1 + low * high))
    np.testing.assert_allclose(weights[1] @ even, expected, rtol=0, atol=1e-12 * expected.max())
    expected = 0.5 * cell * (low + high) / ((1 + low**2) * (1 + high**2))
    np.testing.assert_allclose(weights[-1] @ odd, expected, rtol=0, atol=2e-12 * min(cell, 1.0))
    np.testing.assert_allclose(weights[1].sum(axis=1), cell, rtol=1e-11)


def test_values_of_even_and_odd_functions_on_both_sides():
    found, x = nodes(1.0, 40.0), np.array([-40.0, -3.0, -1e-8, 0.0, 1e-8, 0.7, 40.0])
    weights = found.values(x)
    np.testing.assert_allclose(weights[1] @ (1 + found.x**2) ** -0.5, (1 + x**2) ** -0.5, rtol=1e-12)
    np.testing.assert_allclose(weights[-1] @ (found.x / (1 + found.x**2)), x / (1 + x**2), rtol=1e-12)


def test_nodes_converge_as_they_say():
    """A pole at x = ± i s: the error falls like exp(-digits), up to a factor for the order of the pole."""
    x = np.linspace(0.0, 30.0, 301)
    errors = []
    for digits in (10.0, 20.0, 30.0):
        found = nodes(1.0, 30.0, digits)
        errors.append(np.abs(found.values(x)[1] @ (1 / (1 + found.x**2)) - 1 / (1 + x**2)).max())
    slope = np.polyfit((10.0, 20.0, 30.0), np.log(errors), 1)[0]
    assert -1.3 < slope < -0.8
    assert errors[-1] < 1e-10
