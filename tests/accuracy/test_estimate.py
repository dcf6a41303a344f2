"""Errors from two coarser discretisations: exact power laws, scatter, planted faults."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from close import close
from eigencontact.accuracy.estimate import estimate

ORDERS = st.floats(1.0, 2.0)
SIZES = st.sampled_from([(1.5, 2.0), (2.0, 3.0)])


@given(ORDERS, SIZES, st.sampled_from([-3e9, 1.0, 2e-9]), st.floats(1e-6, 0.3))
def test_the_error_of_a_power_law_is_within_the_bar_and_at_least_four_fifths_of_it(order, sizes, limit, part):
    value = limit * (1 + part)
    found = estimate(value, [(size, limit * (1 + part * size**order)) for size in sizes], 1.0, 2.0)
    assert found.order == close(order, 1e-3)
    true = abs(limit * part)
    assert true <= found.error <= 1.26 * true


@given(st.floats(2.1, 2.4), SIZES)
def test_an_order_above_the_known_one_is_not_trusted_to_make_the_bar_smaller(order, sizes):
    error = estimate(1.1, [(size, 1 + 0.1 * size**order) for size in sizes], 1.0, 2.0).error
    assert error >= 0.1


@pytest.mark.parametrize("others", [[(1.5, 1.1), (2.0, 0.9)], [(1.5, 1.1), (2.0, 1.1)], [(1.5, 1.0), (2.0, 1.1)]])
def test_a_number_that_scatters_has_no_order_and_twice_its_largest_difference(others):
    found = estimate(1.0, others, 1.0, 2.0)
    assert found.order is None
    assert found.error == close(2 * max(abs(value - 1.0) / (size - 1.0) for size, value in others))


def test_an_area_of_cells_is_not_extrapolated():
    others = [(size, 1 + 0.1 * size**2) for size in (2.0, 3.0)]
    assert estimate(1.1, others, 1.0, 2.0, scatters=True) == (close(2 * 0.4), None)


def test_a_number_that_converges_with_the_square_root_of_the_cells_has_its_own_band():
    others = [(size, 1 + 0.1 * size**0.5) for size in (2.0, 3.0)]
    assert 0.1 <= estimate(1.1, others, 0.5, 0.5).error <= 0.126
    assert estimate(1.1, others[:1], 0.5, 0.5).error == close(0.1)


def test_one_coarser_value_counts_with_the_lowest_order():
    assert estimate(1.0, [(2.0, 1.1)], 1.0, 2.0).error == close(0.1)
    assert estimate(1.0, [(0.5, 0.95)], 1.0, 1.0).error == close(0.1)  # a finer one


def test_no_difference_is_no_error():
    assert estimate(3.0, [(1.5, 3.0), (2.0, 3.0)], 1.0, 2.0).error == 0.0
