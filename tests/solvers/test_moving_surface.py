"""Surfaces worn by their own pressure: a bed of springs in closed form, the flat punch, the sphere of WR-9."""

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from close import close
from eigencontact.errors import NotConverged, SceneError
from eigencontact.solvers.control import Control
from eigencontact.solvers.moving_surface import moved
from eigencontact.solvers.normal import NormalOptions, NormalSolver
from solvers.contacts import halfspace, paraboloid, square_grid
from worn_ball import SLIDING

RANDOM = settings(deadline=None, derandomize=True, max_examples=30, phases=[Phase.generate])


class Bed:
    """Independent springs of 1 m/Pa, pressed by 1 m at a surface h: depth tends to (1 - h) (1 - exp(-rate n))."""

    def __init__(self, h):
        self.h, self.solves = np.asarray(h, dtype=float), 0

    def pressed(self, depth, springs, _start):
        self.solves += 1
        return np.maximum(0.0, 1.0 - self.h - depth) / (1.0 + springs)

    def moved(self, rate, cycles, tolerance, depth=0.0, steady=None):
        depth = np.zeros(self.h.shape) + depth
        pressure = self.pressed(depth, 0.0, None)
        return moved(self.pressed, depth, pressure, rate, cycles, steady=steady, tolerance=tolerance)


@RANDOM
@given(st.integers(0, 10**6), st.floats(-3, 2), st.sampled_from([1e-1, 1e-2, 1e-3]))
def test_a_bed_of_springs_by_its_exponential(seed, exponent, tolerance):
    """The tolerance bounds the true error, five of it that of the pressure; some cells have no rate or no contact."""
    rng = np.random.default_rng(seed)
    h, rate = rng.uniform(-0.5, 1.5, (5, 6)), 10.0**exponent * rng.uniform(-0.5, 1, (5, 6)).clip(0)
    bed = Bed(h)
    done = bed.moved(rate, 2.0, tolerance)
    reach = np.maximum(0.0, 1.0 - h)
    depth, pressure = reach * -np.expm1(-2.0 * rate), reach * np.exp(-2.0 * rate)
    assert done.solves == bed.solves - 1
    assert max(done.error, done.pressure_error / 5) <= tolerance
    assert np.abs(done.depth - depth).sum() <= tolerance * depth.sum()
    assert np.abs(done.pressure - pressure).sum() <= 5 * tolerance * pressure.sum()


def test_extrapolation_is_of_second_order():
    """Error of three solves over jumps of decreasing size; two-sided, and small at the end.

    Relative to the depth of a jump it is of second order, relative to the pressure that is left of third.
    """
    sizes = np.array([0.005, 0.01, 0.02, 0.04])
    found = [Bed([[0.0]]).moved(np.ones((1, 1)), size, 0.35 * size) for size in sizes]
    assert [done.solves for done in found] == [3] * 4
    exact = -np.expm1(-sizes)
    errors = np.abs(np.array([done.depth[0, 0] for done in found]) / exact - 1)
    pressures = np.abs(np.array([done.pressure[0, 0] for done in found]) / np.exp(-sizes) - 1)
    assert np.polyfit(np.log(sizes), np.log(errors), 1)[0] == close(2, abs=0.1)
    assert np.polyfit(np.log(sizes), np.log(pressures), 1)[0] == close(3, abs=0.1)
    assert errors[0] < 1e-5


def test_one_solve_is_of_first_order_and_knows_its_error():
    sizes = np.array([0.005, 0.01, 0.02, 0.04])
    found = [Bed([[0.0]]).moved(np.ones((1, 1)), size, 10.0) for size in sizes]
    assert [done.solves for done in found] == [1] * 4
    errors = 1 - np.array([done.depth[0, 0] for done in found]) / -np.expm1(-sizes)
    assert [done.error for done in found] == close(errors, rel=0.05)
    assert np.polyfit(np.log(sizes), np.log(errors), 1)[0] == close(1, abs=0.1)


def test_depth_that_does_not_ask_for_pressure():
    """d depth = rate (1 - h - depth) + steady: an exponential towards another limit, or a straight line."""
    h, rate, steady = (
        np.array([[0.0, 0.3, 0.5, 2.0]]),
        np.array([[1.0, 0.4, 0.0, 1.0]]),
        np.array([[0.1, 0.0, 0.2, 0.3]]),
    )
    done = Bed(h).moved(rate, 1.5, 1e-4, steady=steady)
    expected = [1.1 * -np.expm1(-1.5), 0.7 * -np.expm1(-0.6), 0.3, 0.45]
    assert done.depth == close(np.array([expected]), abs=2e-4)
    assert Bed(h).moved(0 * rate, 1.5, 1e-4, steady=steady).depth == close(1.5 * steady)


@RANDOM
@given(st.floats(-6, 15), st.sampled_from([10.0, 0.1]))
def test_stiff_cells_stay_in_contact_and_above_their_limit(exponent, tolerance):
    """However many cycles at once: pressure zero or positive, depth below what closes the gap."""
    rate = np.array([[1e-3, 0.1, 1.0, 10.0, 1e4]])
    done = Bed(np.zeros((1, 5))).moved(rate, 10.0**exponent, tolerance)
    assert done.pressure.min() >= 0
    assert done.depth.min() >= 0
    assert done.depth.max() <= 1 + 1e-12


def test_the_error_falls_like_the_square_of_the_solves():
    """Tolerances 1e-3 to 1e-5: 63 to 1023 solves, slope two-sided; the estimate is one to four times the error."""
    bed = Bed(np.linspace(0, 1.2, 20)[None])
    depth = np.maximum(0.0, 1.0 - bed.h) * -np.expm1(-1.0)
    found = [bed.moved(np.ones((1, 20)), 1.0, tolerance) for tolerance in np.logspace(-3, -5, 5)]
    errors = np.array([np.abs(done.depth - depth).sum() / depth.sum() for done in found])
    ratio = np.array([done.error for done in found]) / errors
    assert np.polyfit(np.log([done.solves for done in found]), np.log(errors), 1)[0] == close(-2, abs=0.1)
    assert np.all((ratio > 1) & (ratio < 4))


def test_in_two_parts_as_at_once():
    h, rate = np.linspace(0, 1.2, 20)[None], np.linspace(0, 2, 20)[None]
    first = Bed(h).moved(rate, 0.7, 1e-4)
    second = Bed(h).moved(rate, 0.5, 1e-4, depth=first.depth)
    assert first.depth + second.depth == close(Bed(h).moved(rate, 1.2, 1e-4).depth, abs=1e-4)


@pytest.mark.parametrize(("rate", "cycles"), [(0.0, 5.0), (1.0, 0.0)])
def test_nothing_moves_without_a_rate_or_cycles(rate, cycles):
    bed = Bed(np.zeros((2, 3)))
    done = bed.moved(np.full((2, 3), rate), cycles, 1e-3)
    assert (done.solves, done.error) == (0, 0.0)
    assert not done.depth.any()
    assert np.array_equal(done.pressure, np.ones((2, 3)))


def test_a_negative_rate_and_no_tolerance_are_refused():
    with pytest.raises(SceneError, match=r"moved.rate must be zero or positive .* \(got -1.0\)"):
        Bed([[0.0]]).moved(np.array([[-1.0]]), 1.0, 1e-3)
    with pytest.raises(SceneError, match=r"moved.tolerance must be positive \(got 0.0\)"):
        Bed([[0.0]]).moved(np.array([[1.0]]), 1.0, 0.0)


def test_noise_above_the_tolerance_is_told():
    rng = np.random.default_rng(0)

    def noisy(depth, springs, start):
        return (1 - depth) / (1 + springs) * rng.uniform(0.99, 1.01, depth.shape)

    with pytest.raises(NotConverged, match=r"worn depth over 2 cycles must come within the tolerance 1\.0e-05"):
        moved(noisy, np.zeros((3, 3)), np.ones((3, 3)), np.ones((3, 3)), 2.0, tolerance=1e-5)


# --- half-space --------------------------------------------------------------------------------------------------


def worn(grid, h, rate, load, stages, tolerance, **options):
    """Depth, contact pressure on it and solves after each stage (cycles in all)."""
    solver = NormalSolver(grid, halfspace(), NormalOptions(tolerance=1e-7, **options))

    def pressed(depth, springs, start):
        return solver.solve(h + depth, Control(normal_load=load), springs=springs, start=start).pressure

    depth, solves, done = np.zeros(grid.shape), 0, 0.0
    pressure = pressed(depth, np.zeros(grid.shape), None)
    for cycles in stages:
        step = moved(pressed, depth, pressure, rate, cycles - done, tolerance=tolerance)
        depth, pressure, solves, done = depth + step.depth, step.pressure, solves + step.solves, cycles
        yield depth, pressed(depth, np.zeros(grid.shape), pressure), solves


def test_a_sliding_flat_punch_tends_to_uniform_pressure():
    """WR-14: u[p] + rate ∫p = const, p(0) over the mean at E* rate N/a. The rim is a staircase."""
    grid = square_grid(20, half_width=1.1)
    y, x = grid.axes()
    inside = x**2 + y**2 < 1
    radius = np.sqrt(inside.sum() * grid.cell_area / np.pi)
    times = {0.05: 0.5441, 0.1: 0.5782, 0.2: 0.6367, 0.5: 0.7701, 1.0: 0.9013, 2.0: 0.9854}
    h, rate = np.where(inside, 0.0, 10.0), np.full(grid.shape, radius)
    states = worn(grid, h, rate, np.pi * radius**2, times, 5e-3, allow_contact_at_edge=True)
    centre = x**2 + y**2 < 0.01
    found = [float(pressure[centre].mean()) for _, pressure, _ in states]
    assert found == close(list(times.values()), rel=0.01)


def sphere(cells, half_width, volumes, tolerance):
    """WR-9 with a = R = E* = 1: relative errors of pressure and depth, error of the radius in cells, solves."""
    grid = square_grid(cells, half_width)
    stages = [volume * np.pi / 4 for volume in volumes]
    rate = np.full(grid.shape, 0.75)  # load 4/3: one cycle wears a volume of 1
    for volume, (depth, pressure, solves) in zip(
        volumes, worn(grid, paraboloid(grid), rate, 4 / 3, stages, tolerance), strict=True
    ):
        peak, deepest, reach = SLIDING[volume]
        found = np.sqrt(np.count_nonzero(pressure) * grid.cell_area / np.pi)
        yield pressure.max() * np.pi / 2 / peak - 1, depth.max() / deepest - 1, (found - reach) * cells, solves


def test_a_worn_sphere_on_a_coarse_grid():
    """WR-9: ten cells a radius, three decades of volume: within 1 %."""
    states = list(sphere(10, 2.2, [0.1, 1.0, 10.0], 2e-3))
    for peak, depth, cells, _ in states:
        assert (peak, depth) == close((0.0, 0.0), abs=1e-2)
        assert abs(cells) < 1
    assert states[-1][-1] <= 69


def test_a_worn_sphere_at_once():
    """WR-9: from the elastic contact to 100 reference volumes in 15 solves, depth to 1 %, pressure to 2 %."""
    ((peak, depth, cells, solves),) = sphere(8, 3.5, [100.0], 1e-2)
    assert peak == close(0.0, abs=2e-2)
    assert depth == close(0.0, abs=1e-2)
    assert abs(cells) < 1
    assert solves <= 15


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cells", "half_width", "volumes"), [(48, 1.2, [0.01, 0.1]), (32, 2.0, [1.0, 10.0]), (20, 3.5, [100.0])]
)
def test_a_worn_sphere(cells, half_width, volumes):
    """WR-9: pressure and depth to .5 %, the radius to one cell."""
    for peak, depth, off, _ in sphere(cells, half_width, volumes, 1e-3):
        assert (peak, depth) == close((0.0, 0.0), abs=5e-3)
        assert abs(off) < 1
