"""Errors from two coarser discretisations: exact power laws, scatter, planted faults."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy import mean, median
from numpy.random import default_rng

from close import close
from eigencontact.accuracy import estimate as module
from eigencontact.accuracy.estimate import estimate

ORDERS = st.floats(1.0, 2.0)
SIZES = st.sampled_from([(2.0, 2.5), (1.5, 2.0), (2.0, 3.0)])


@given(ORDERS, SIZES, st.sampled_from([-3e9, 1.0, 2e-9]), st.floats(1e-6, 0.3))
def test_the_error_of_a_power_law_is_within_the_bar_and_at_least_four_fifths_of_it(order, sizes, limit, part):
    value = limit * (1 + part)
    found = estimate(value, [(size, limit * (1 + part * size**order)) for size in sizes], 1.0, 2.0)
    assert found.order == close(order, 1e-3)
    true = abs(limit * part)
    assert true <= found.error <= 1.26 * true


@given(st.floats(0.55, 1.0), st.sampled_from([(2.0, 4.0), (0.5, 2.0), (0.55, 1.9)]), st.sampled_from([-3e9, 1.0]))
def test_a_finer_value_tells_the_same_order_as_two_coarser_ones(order, sizes, limit):
    found = estimate(1.1 * limit, [(size, limit * (1 + 0.1 * size**order)) for size in sizes], 1.0, 1.0)
    assert found.order == close(order, 1e-3)
    assert found.error == close(1.25 * 0.1 * abs(limit), 1e-3)


@pytest.mark.parametrize("finer", [1.1, 0.9])
def test_a_finer_value_without_an_order_counts_with_the_lowest(finer):
    """The coarser value lies on the other side, or shows no change at all."""
    for coarser in (finer, 1.0):
        found = estimate(1.0, [(0.5, finer), (2.0, coarser)], 1.0, 1.0)
        assert found == (close(0.2), None)


@given(st.floats(2.1, 2.4), SIZES)
def test_an_order_above_the_known_one_is_not_trusted_to_make_the_bar_smaller(order, sizes):
    error = estimate(1.1, [(size, 1 + 0.1 * size**order) for size in sizes], 1.0, 2.0).error
    assert error >= 0.1


@pytest.mark.parametrize("order", [2.6, 4.0])
def test_an_order_far_above_the_known_one_is_assumed_and_has_a_larger_factor(order):
    found = estimate(1.1, [(size, 1 + 0.1 * size**order) for size in (2.0, 2.5)], 1.0, 2.0)
    assert found == (close(3 * 0.1 * (2.5**order - 1) / (2.5**2 - 1)), None)
    mean = estimate(1.1, [(size, 1 + 0.1 * size**order) for size in (2.0, 2.5)], 1.0, 2.0, mean=True)
    assert mean == (close(1.25 / 3 * found.error), None)


def test_the_smaller_factor_is_seen(monkeypatch):
    monkeypatch.setattr(module, "_ASSUMED", module._SAFETY)
    with pytest.raises(AssertionError):
        test_an_order_far_above_the_known_one_is_assumed_and_has_a_larger_factor(2.6)


@pytest.mark.parametrize("others", [[(2.0, 1.1), (2.5, 0.9)], [(2.0, 1.1), (2.5, 1.1)], [(2.0, 1.0), (2.5, 1.1)]])
def test_a_number_that_scatters_has_no_order_and_three_times_its_scatter(others):
    found = estimate(1.0, others, 1.0, 2.0)
    assert found.order is None
    assert found.error == close(3 * max(abs(value - 1.0) / (size + 1.0) for size, value in others))


def test_bars_of_scatter_hold_in_nine_of_ten_and_are_less_than_five_errors_wide():
    """Errors drawn anew on every grid, as large as its cells: the factor is neither too small nor far too large."""
    random = default_rng(29)
    errors = random.normal(size=(2000, 3)) * (1.0, 2.0, 2.5)
    bars = [estimate(one, [(2.0, two), (2.5, three)], 1.0, 2.0, scatters=True).error for one, two, three in errors]
    true = abs(errors[:, 0])
    assert 0.9 < mean(bars >= true) < 0.99
    assert median(bars / true) < 5.0


def test_an_area_of_cells_is_not_extrapolated():
    others = [(size, 1 + 0.1 * size**2) for size in (2.0, 2.5)]
    assert estimate(1.1, others, 1.0, 2.0, scatters=True) == (close(3 * 0.1 * 5.25 / 3.5), None)


@pytest.mark.parametrize("scatters", [True, False])
@given(order=st.floats(0.5, 0.9), size=SIZES)
def test_no_estimate_without_an_order_is_less_than_the_lowest_order_makes_of_it(scatters, order, size):
    others = [(step, 1 + 0.1 * step**order) for step in size]
    assert estimate(1.1, others, order, order, scatters=scatters).error >= 0.1 * (1 - 1e-9)


def test_a_number_that_converges_with_the_square_root_of_the_cells_has_its_own_band():
    others = [(size, 1 + 0.1 * size**0.5) for size in (2.0, 3.0)]
    assert 0.1 <= estimate(1.1, others, 0.5, 0.5).error <= 0.126
    assert estimate(1.1, others[:1], 0.5, 0.5).error == close(0.1)


def test_one_coarser_value_counts_with_the_lowest_order():
    assert estimate(1.0, [(2.0, 1.1)], 1.0, 2.0).error == close(0.1)
    assert estimate(1.0, [(0.5, 0.95)], 1.0, 1.0).error == close(0.1)  # a finer one


def test_no_difference_is_no_error():
    assert estimate(3.0, [(1.5, 3.0), (2.0, 3.0)], 1.0, 2.0).error == 0.0


@pytest.mark.parametrize("fault", [1.0, -1.0])
def test_a_wrong_order_is_seen(monkeypatch, fault):
    observed = module._observed_order
    monkeypatch.setattr(module, "_observed_order", lambda *pairs: observed(*pairs) + fault)
    others = [(size, 1 + 0.1 * size**1.5) for size in (2.0, 2.5)]
    found = estimate(1.1, others, 1.0, 2.0)
    assert found.order != close(1.5)
    assert not 0.1 <= found.error <= 0.126
