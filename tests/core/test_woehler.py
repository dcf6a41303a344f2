"""The Wöhler curve: slope, knee, scatter by quantiles; and a sample of parts that knows none of its formulas."""

import numpy as np
import pytest

from eigencontact.core.woehler import WoehlerCurve

CURVE = WoehlerCurve(slope=5.0, knee_cycles=2e6, scatter=1.6)


def test_slope_and_knee():
    low, high = CURVE.cycles(1.0 + 1e-12), CURVE.cycles(10.0)
    assert abs(low / 2e6 - 1) < 1e-9
    assert abs(np.log10(low / high) / 5.0 - 1) < 1e-9
    assert CURVE.cycles(1.0) == CURVE.cycles(0.2) == np.inf


def test_scatter_is_the_ratio_of_the_quantiles():
    assert abs(CURVE.limit_ratio(0.9) / CURVE.limit_ratio(0.1) - 1.6) < 1e-12
    assert CURVE.limit_ratio(0.5) == 1.0
    cycles = [CURVE.cycles(2.0, probability) for probability in (0.1, 0.5, 0.9)]
    assert abs(cycles[2] / cycles[0] / 1.6**5 - 1) < 1e-9  # of cycles: the power of the slope


def test_a_sample_of_parts_fails_as_it_says():
    """20 000 parts of log-normal limits, 10 % of which lie below one bound and 90 % below another."""
    deviation = np.log(1.6) / (2 * 1.2815515655446004)
    limits = np.exp(deviation * np.random.default_rng(3).normal(size=20_000))
    for ratio in (0.8, 1.0, 1.2):
        failed = np.mean(limits < ratio)
        assert abs(failed - CURVE.failure_probability(ratio)) < 4 * np.sqrt(0.25 / 20_000)
        lives = np.where(limits < ratio * 2, 2e6 * (2 * ratio / limits) ** -5.0, np.inf)
        assert abs(np.quantile(lives, 0.1) / CURVE.cycles(2 * ratio, 0.1) - 1) < 0.06


@pytest.mark.parametrize(("ratio", "fails"), [(0.0, 0.0), (-1.0, 0.0), (0.99, 0.0), (1.01, 1.0)])
def test_without_scatter(ratio, fails):
    assert WoehlerCurve(slope=5.0, knee_cycles=1e6).failure_probability(ratio) == fails
