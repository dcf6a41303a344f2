"""The uncertainty of a finite-element result covers its error, and is not much larger; verdicts follow from it."""

import numpy as np
import pytest

from close import close
from eigencontact_verification.fem.uncertainty import estimate, verdict, verdicts

X = np.linspace(0.0, 1.0, 41)
SIZES = (0.4, 0.2, 0.1)


def smooth(rng):
    """A random sum of four cosines."""
    return sum(rng.normal() * np.cos(k * np.pi * X + rng.uniform(0.0, 2 * np.pi)) for k in range(4))


def manufactured(rng, order, noise):
    """Exact field and three meshes: leading error, next term of the series and noise relative to the error."""
    exact, first, second = smooth(rng), smooth(rng), smooth(rng) * rng.uniform(0.0, 1.5)
    near = np.exp(-3.0 * X)
    errors = [
        near * (first * h**order + second * h ** (order + 1)) * (1.0 + noise * rng.normal(size=X.size)) for h in SIZES
    ]
    return exact, [exact + error for error in errors]


# formal order, order, noise | least coverage of points, of whole profiles | largest median of u over the fine mesh's
# largest error. An order above the formal one is cut to it, hence the larger bands there.
COVERAGE = [
    (2.0, 1.0, 0.0, 0.99, 0.95, 2.0),
    (2.0, 1.0, 0.1, 0.99, 0.95, 5.0),
    (2.0, 1.0, 0.3, 0.99, 0.90, 14.0),
    (2.0, 1.5, 0.1, 0.99, 0.95, 4.0),
    (2.0, 2.0, 0.0, 0.99, 0.95, 2.5),
    (2.0, 2.0, 0.3, 0.99, 0.95, 7.0),
    (2.0, 3.0, 0.1, 0.99, 0.95, 15.0),
    (3.0, 3.0, 0.0, 0.99, 0.95, 2.5),
    (3.0, 3.0, 0.3, 0.99, 0.95, 5.0),
    (2.0, 0.7, 0.1, 0.98, 0.88, 8.0),
]


@pytest.mark.parametrize(("formal", "order", "noise", "points", "profiles", "excess"), COVERAGE)
def test_the_interval_covers_and_is_not_idle(formal, order, noise, points, profiles, excess):
    rng, inside, whole, width = np.random.default_rng(20), [], [], []
    for _ in range(200):
        exact, meshes = manufactured(rng, order, noise)
        found = estimate(*meshes, ratio=2.0, formal_order=formal)
        covered = np.abs(found.value - exact) <= found.uncertainty
        inside.append(covered.mean())
        whole.append(covered.all())
        width.append(found.uncertainty.max() / np.abs(meshes[2] - exact).max())
    assert np.mean(inside) >= points
    assert np.mean(whole) >= profiles
    assert 1.0 <= np.median(width) <= excess


@pytest.mark.parametrize("order", [1.0, 2.0, 3.0])
def test_errors_whose_sign_follows_the_mesh_are_covered_and_not_idle(order):
    """Where a point lies within its element changes from mesh to mesh: only the size of the error converges."""
    rng, whole, width = np.random.default_rng(21), [], []
    for _ in range(200):
        exact, size = smooth(rng), np.exp(-3.0 * X)
        meshes = [exact + size * h**order * rng.uniform(-1.0, 1.0, size=X.size) for h in SIZES]
        found = estimate(*meshes, ratio=2.0, formal_order=3.0)
        whole.append(np.all(np.abs(found.value - exact) <= found.uncertainty))
        width.append(found.uncertainty.max() / np.abs(meshes[2] - exact).max())
    assert np.mean(whole) >= 0.95
    assert 1.0 <= np.median(width) <= 15.0


@pytest.mark.parametrize("order", [1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("ratio", [1.5, 2.0, 3.0])
def test_pure_powers_give_order_value_and_roaches_index(order, ratio):
    exact, error = np.cos(X), 0.01 * np.exp(-X)
    meshes = [exact + error * ratio ** (order * k) for k in (2, 1, 0)]
    found = estimate(*meshes, ratio=ratio, formal_order=3.0, iteration=0.0)
    assert found.order == close(order, abs=1e-9)
    assert found.credible.all()
    np.testing.assert_allclose(found.value, exact, atol=1e-11)
    # safety factor 1.25 times the error, the largest among neighbours: the left one, as the error decays to the right
    np.testing.assert_allclose(found.uncertainty[1:], 1.25 * error[:-1], rtol=1e-6)


def test_oscillating_convergence_is_not_believed():
    exact, error = np.cos(X), 0.01 * np.exp(-X)
    found = estimate(exact + error, exact - error / 2, exact + error / 4, ratio=2.0, formal_order=2.0)
    assert not found.credible.any()
    np.testing.assert_array_equal(found.value, exact + error / 4)
    assert np.all(found.uncertainty >= 3.0 * 0.75 * error)


def test_divergence_is_not_believed_and_wide():
    error = 0.01 * np.exp(-X)
    found = estimate(error, 2 * error, 4 * error, ratio=2.0, formal_order=2.0)
    assert not found.credible.any()
    assert np.all(found.uncertainty >= 3.0 * 2.0 * error)


def test_a_difference_that_vanishes_at_one_point_keeps_its_uncertainty():
    error = 0.01 * (X - 0.5)
    meshes = [error * 4.0**k for k in (2, 1, 0)]
    meshes[1][30] = meshes[2][30]  # the medium mesh happens to be as good as the fine one
    found = estimate(*meshes, ratio=2.0, formal_order=2.0)
    assert np.all(np.abs(found.value) <= found.uncertainty)
    assert found.uncertainty[30] > 0.01 * (X[30] - 0.5)  # the fine mesh is still that far off


def test_a_small_component_is_no_surer_than_a_tenth_of_its_tensor():
    """In axes turned by a few degrees it would hold a part of the others, and of their error."""
    x = np.linspace(0.0, 1.0, 25)
    errors = [h**2 * np.stack([np.cos(x), 1e-4 * np.sin(x)], axis=1) for h in (0.4, 0.2, 0.1)]
    found = estimate(*errors, ratio=2.0, formal_order=2.0)
    large, small = found.parts["discretisation"].T
    assert small == close(0.1 * large.max() * np.ones_like(x))
    assert large.max() == close(1.25 * 0.01, rel=1e-6)


def test_a_region_of_lower_order_keeps_its_uncertainty():
    """Order 2 rules the norm near the source; far away the error is of order 1."""
    near, far = np.exp(-20.0 * X), 0.02 * (X > 0.5)
    meshes = [near * h**2 + far * h for h in SIZES]
    found = estimate(*meshes, ratio=2.0, formal_order=2.0)
    assert found.order[0] > 1.8
    assert np.all(np.abs(found.value) <= found.uncertainty)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.45])
@pytest.mark.parametrize("reach", [5.0, 10.0])
def test_a_ball_in_a_finite_ball_is_bracketed(poisson, reach):
    """Dilating ball of radius 1 in a concentric ball: u = 1/r² + b r, with b from the fixed or free outer sphere.

    Free: 2 G (1 + nu)/(1 - 2 nu) b = 4 G / reach³, that is 3 K b = 4 G / reach³; fixed: b = -1 / reach³.
    """
    r = np.linspace(1.0, 3.0, 20)
    exact = 1.0 / r**2
    fixed = exact - r / reach**3
    free = exact + 2.0 * (1.0 - 2.0 * poisson) / (1.0 + poisson) * r / reach**3
    found = estimate(fixed, fixed, fixed, ratio=2.0, formal_order=2.0, other_outer=free, iteration=0.0)
    error = np.abs(found.value - exact)
    assert np.all(error <= found.uncertainty)
    assert found.uncertainty.max() == close(np.max(free - fixed) / 2, rel=1e-12)
    assert np.max(np.abs(fixed - exact)) > error.max()  # the mean is better than either where they bracket


def test_the_bracket_of_a_coarser_mesh_leaves_its_discretisation_out():
    exact, error, truncation = np.cos(X), 0.01 * np.exp(-X), 0.002 * (1.0 + X)
    fixed = [exact - truncation + error * 4.0**k for k in (2, 1, 0)]
    free = fixed[1] + 2 * truncation
    found = estimate(*fixed, ratio=2.0, formal_order=2.0, other_outer=free, other_level=1)
    np.testing.assert_allclose(found.value, exact, atol=1e-12)
    np.testing.assert_allclose(found.parts["truncation"][:-1], truncation[1:], rtol=1e-9)
    total = sum(found.parts.values())
    np.testing.assert_allclose(found.uncertainty, total, rtol=1e-14)


def test_the_sum_covers_where_a_root_sum_square_does_not():
    """Both parts at 0.8 of their bounds with one sign: systematic errors may do that at every point."""
    exact = np.cos(X)
    d, t = np.full(41, 0.004), np.full(41, 0.002)
    fixed = [exact + 0.6 * t + d * 4.0**k for k in (2, 1, 0)]
    free = fixed[2] - 2 * t * 0.9
    found = estimate(*fixed, ratio=2.0, formal_order=2.0, other_outer=free)
    first, second = found.parts["discretisation"], found.parts["truncation"]
    worst = 0.8 * first + 0.8 * second
    assert np.all(worst <= found.uncertainty)
    assert np.all(worst > np.hypot(first, second))


# --- verdicts ---------------------------------------------------------------------------------------------------------


def known(largest_error, components=1):
    """Estimate of cos(x), and of zero for further components, whose fine mesh has the error given."""
    exact = np.zeros((41, components))
    exact[:, 0] = np.cos(X)
    meshes = [exact + largest_error * np.exp(-X)[:, None] * 4.0**k for k in (2, 1, 0)]
    return exact, estimate(*meshes, ratio=2.0, formal_order=2.0)


FAULTS = [
    ("none", 0.004, lambda v: v, "agrees"),
    ("below the uncertainty", 0.004, lambda v: v + 0.0005, "agrees"),
    ("sign", 0.004, lambda v: -v, "disagrees"),
    ("factor 2", 0.004, lambda v: 2 * v, "disagrees"),
    ("two per cent", 0.004, lambda v: 1.02 * v, "disagrees"),
    ("one point", 0.004, lambda v: v + 0.02 * (np.arange(41) == 17)[:, None], "disagrees"),
    ("shifted by one point", 0.004, lambda v: np.roll(v, 1, axis=0), "disagrees"),
    ("uncertainty too large", 0.04, lambda v: v, "inconclusive"),
    ("too large, and still outside", 0.04, lambda v: v + 0.2, "disagrees"),
    ("not a number", 0.004, lambda v: np.where(np.arange(41)[:, None] == 3, np.nan, v), "disagrees"),
]


@pytest.mark.parametrize(("error", "change", "word"), [row[1:] for row in FAULTS], ids=[row[0] for row in FAULTS])
def test_verdicts(error, change, word):
    exact, found = known(error)
    given = verdict(change(exact), found)
    assert given.word == word
    assert (given.ratio > 1.0) == (word == "disagrees")
    assert given.scale == close(1.0, abs=1e-6)


def test_a_reference_that_is_not_finite_is_inconclusive():
    mesh = np.where(X > 0.9, np.nan, np.cos(X))
    found = estimate(mesh, mesh, mesh, ratio=2.0, formal_order=2.0)
    assert verdict(np.cos(X), found).word == "inconclusive"


def test_a_component_zero_by_symmetry_is_judged_on_the_scale_of_the_field():
    exact, found = known(0.004, components=2)
    assert [one.word for one in verdicts(exact, found)] == ["agrees", "agrees"]
    wrong = exact + np.array([0.0, 0.02])
    assert [one.word for one in verdicts(wrong, found)] == ["agrees", "disagrees"]
    assert verdict(wrong, found).word == "disagrees"


def test_a_small_component_that_the_reference_cannot_resolve_is_inconclusive():
    """One per cent of the field with an uncertainty of half a per cent: a factor of 2 would pass unseen."""
    exact = np.stack([np.cos(X), 0.01 * np.sin(3 * X)], axis=-1)
    meshes = [exact + np.array([0.0, 0.004]) * 4.0**k for k in (2, 1, 0)]
    found = estimate(*meshes, ratio=2.0, formal_order=2.0)
    first, second = verdicts(exact, found)
    assert (first.word, second.word) == ("agrees", "inconclusive")
    assert "small component" in second.reason
    sharper = estimate(*[exact + 0.1 * (m - exact) for m in meshes], ratio=2.0, formal_order=2.0)
    assert [one.word for one in verdicts(exact, sharper)] == ["agrees", "agrees"]
    doubled = exact * np.array([1.0, 2.0])
    assert [one.word for one in verdicts(doubled, sharper)] == ["agrees", "disagrees"]


def test_a_small_component_of_a_whole_field_counts_as_a_part_of_the_field():
    """Three hundredths of the field, known to one: told from its double, though not to a quarter of itself."""
    exact = np.stack([np.cos(X), 0.03 * np.sin(3 * X)], axis=-1)
    found = estimate(*[exact + np.array([0.0, 0.008]) * 4.0**k for k in (2, 1, 0)], ratio=2.0, formal_order=2.0)
    alone, within = (verdicts(exact, found, small=small)[1] for small in (0.0, 0.05))
    assert (alone.word, within.word) == ("inconclusive", "agrees")
    assert within.reason.startswith("small, and")
    doubled = exact * np.array([1.0, 2.0])
    assert verdicts(doubled, found, small=0.05)[1].word == "disagrees"
    rough = estimate(*[exact + np.array([0.0, 0.012]) * 4.0**k for k in (2, 1, 0)], ratio=2.0, formal_order=2.0)
    assert rough.uncertainty[:, 1].max() > 0.25 * 0.05
    assert verdicts(exact, rough, small=0.05)[1].word == "inconclusive"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"ratio": 1.0}, "ratio must be > 1"),
        ({"formal_order": 0.1}, "formal_order must be at least"),
        ({"fine": np.zeros(3)}, "share one shape"),
        ({"other_outer": np.zeros(3)}, "other_outer must be"),
    ],
)
def test_bad_input_is_refused(changes, words):
    values = {"coarse": X, "medium": X, "fine": X, "ratio": 2.0, "formal_order": 2.0} | changes
    with pytest.raises(ValueError, match=words):
        estimate(values.pop("coarse"), values.pop("medium"), values.pop("fine"), **values)


def test_judged_values_of_another_shape_are_refused():
    _, found = known(0.004)
    with pytest.raises(ValueError, match="use the same points"):
        verdict(np.zeros(5), found)
