"""Stress intensity factors of edge cracks: closed forms, published factors, symmetries, order of the error."""

import numpy as np
import pytest

from close import close
from eigencontact.core.crack_growth import arrest_length, el_haddad, factor_ranges, kitagawa_takahashi
from eigencontact.errors import SceneError
from eigencontact.halfspace.edge_crack import edge_crack

#: Factor of a normal edge crack under tension, Koiter 1965.
KOITER = 1.1215222551925


def factors(angle, normal, shear, nodes=80):
    """Factors over sqrt(pi a) of stresses given as functions of the distance from the mouth in crack lengths."""
    crack = edge_crack(angle, nodes)
    y = crack.places
    return crack.factors(1 / np.pi, normal(y), shear(y))


def tension(angle, nodes=80):
    """Factors of a crack in a half-plane stretched along its surface."""
    c, s = np.cos(angle), np.sin(angle)
    return factors(angle, lambda y: c * c * y**0, lambda y: -s * c * y**0, nodes)


@pytest.mark.parametrize(("power", "value"), [(0, 1.1215), (1, 0.68286), (2, 0.52549)])
def test_normal_crack_under_powers_of_the_depth(power, value):
    opening, sliding = factors(0.0, lambda y: y**power, lambda y: 0 * y)
    assert opening == close(value, rel=2e-5)
    assert abs(sliding) < 1e-12
    shear = factors(0.0, lambda y: 0 * y, lambda y: y**power)
    np.testing.assert_allclose(shear, [0.0, opening], rtol=0, atol=1e-12)  # both modes are alike below a free surface


def test_error_falls_with_the_fourth_power_of_the_nodes():
    nodes = np.array([20, 40, 80, 160])
    errors = [abs(tension(0.0, n)[0] - KOITER) for n in nodes]
    slope = -np.polyfit(np.log(nodes), np.log(errors), 1)[0]
    assert slope == close(4.0, abs=0.15)
    assert errors[2] < 5e-8


def test_crack_at_45_degrees_agrees_with_the_published_factors():
    """Hasebe and Inohara 1980, as handbooks print it: 0.705 and 0.364. Other angles: tests/verification."""
    np.testing.assert_allclose(np.abs(tension(np.pi / 4)), [0.705, 0.364], rtol=0, atol=6e-4)


def test_mirrored_crack_opens_alike_and_slides_the_other_way():
    np.testing.assert_allclose(tension(-0.7), tension(0.7) * [1, -1], rtol=1e-11, atol=0)


def test_thin_wedges_are_refused():
    with pytest.raises(SceneError, match=r"crack.angle must be within 1\.309"):
        edge_crack(np.radians(80.0))


def test_closed_tip_counts_as_zero_and_ratio_does_not():
    steps = np.array([[[4.0], [-12.0]], [[0.0], [3.0]]])
    mode_1, mode_2, effective, ratio = (float(item[0]) for item in factor_ranges(steps))
    assert (mode_1, mode_2, effective, ratio) == (4.0, 3.0, 5.0, -3.0)
    assert np.isnan(factor_ranges(-np.abs(steps)).ratio[0])


def test_thresholds_meet_far_from_the_short_crack_length():
    lengths = np.array([1e-9, 1.0])
    smooth, kinked = (rule(lengths, 5e6, 1e-4) for rule in (el_haddad, kitagawa_takahashi))
    np.testing.assert_allclose(smooth, kinked, rtol=1e-4)
    assert el_haddad(np.array([1e-4]), 5e6, 1e-4)[0] == close(5e6 / np.sqrt(2))


def test_arrest_where_the_range_falls_below_the_threshold():
    lengths = np.geomspace(1e-6, 1e-3, 31)
    assert arrest_length(lengths, lengths**-0.5, np.full(31, 1e-4**-0.5)) == close(1e-4, rel=1e-12)
    assert arrest_length(lengths, lengths**0.5, 2 * lengths**0.5) == 0.0
    assert arrest_length(lengths, lengths**0.5, 0.5 * lengths**0.5) == np.inf
