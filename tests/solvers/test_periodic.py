"""Periodic contact against Westergaard's line waves, crossed waves in full contact, and its own limits."""

import numpy as np
import pytest
from scipy.integrate import quad

from close import close
from eigencontact.core.grid import Grid
from eigencontact.errors import NotConverged
from eigencontact_verification.oracles import westergaard
from solvers.contacts import paraboloid, solve, square_grid

PERIODIC = {"periodic": True}
AMPLITUDE = 0.01
FULL = westergaard.line_pressure_to_flatten(AMPLITUDE, 1.0, 1.0)


def line_wave(cells, offset=0.31):
    grid = Grid(nx=cells, ny=3, dx=1.0 / cells, dy=0.5, center=(offset / cells, 0.0))
    return grid, AMPLITUDE * (1 - np.cos(2 * np.pi * grid.x[None])) + np.zeros((3, 1))


def wave_errors(cells, share, offset):
    grid, h = line_wave(cells, offset)
    mean = share * FULL
    s = solve(grid, h, normal_load=mean * 1.5, options=PERIODIC)
    exact = westergaard.line_pressure(grid.x, mean, AMPLITUDE, 1.0, 1.0)
    half = westergaard.line_half_width(mean, AMPLITUDE, 1.0, 1.0)
    error = np.abs(s.pressure - exact)
    approach = westergaard.line_approach(mean, AMPLITUDE, 1.0, 1.0)
    return error[:, np.abs(grid.x) < 0.8 * half].max() / exact.max(), abs(s.approach / approach - 1)


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_partial_contact_of_a_wave_converges_to_westergaard(share):
    """Pressure away from the edges and approach: second order (measured 1.78 to 2.27), 47 to 409 cells a wave.

    Both edges fall between cell centres, and by how much makes the error jump from one grid to the next: hence many
    sizes without a common factor, and the mean square of four positions of the wave on the grid.
    """
    cells = np.array([47, 59, 67, 83, 97, 109, 127, 149, 163, 191, 211, 241, 277, 317, 359, 409])
    positions = (0.125, 0.375, 0.625, 0.875)
    errors = [[wave_errors(n, share, position) for position in positions] for n in cells]
    errors = np.sqrt(np.mean(np.square(errors), axis=1))
    slopes = -np.polyfit(np.log(cells), np.log(errors), 1)[0]
    assert np.all(np.abs(slopes - 2) < 0.35), slopes
    assert np.all(errors[-1] < [1e-4, 2e-5])


@pytest.mark.parametrize("share", [1.0, 1.5])
@pytest.mark.parametrize("cells", [5, 16, 31, 64])
def test_full_contact_of_a_wave_is_exact(cells, share):
    grid, h = line_wave(cells)
    s = solve(grid, h, normal_load=share * FULL * 1.5, tolerance=1e-12, options=PERIODIC)
    exact = westergaard.line_pressure(grid.x, share * FULL, AMPLITUDE, 1.0, 1.0)
    assert np.abs(s.pressure - exact).max() < 1e-10 * exact.max()
    assert s.approach == close(AMPLITUDE, rel=1e-12)


@pytest.mark.parametrize("shape", [(22, 30), (21, 29), (13, 64)], ids=str)
def test_full_contact_of_crossed_waves_is_exact(shape):
    grid = Grid(ny=shape[0], nx=shape[1], dx=1.0 / shape[1], dy=0.7 / shape[0], center=(0.003, 0.01))
    k = (2 * np.pi, 2 * np.pi / 0.7 * 2)
    y, x = grid.axes()
    h = AMPLITUDE * (1 - np.cos(k[0] * x) * np.cos(k[1] * y))
    mean = 0.6 * np.hypot(*k) * AMPLITUDE
    s = solve(grid, h, normal_load=mean * 0.7, tolerance=1e-12, options=PERIODIC)
    exact = westergaard.crossed_full_pressure(x, y, mean, AMPLITUDE, k, 1.0)
    assert np.abs(s.pressure - exact).max() < 1e-10 * exact.max()


@pytest.mark.parametrize("share", [0.1, 0.6])
def test_load_and_approach_control_meet(share):
    grid, h = line_wave(64)
    first = solve(grid, h, normal_load=share * FULL * 1.5, tolerance=1e-11, options=PERIODIC)
    again = solve(grid, h, approach=first.approach, tolerance=1e-11, options=PERIODIC)
    assert np.abs(again.pressure - first.pressure).max() < 1e-8 * first.pressure.max()
    assert again.report.iterations < 100


def test_shifting_the_window_shifts_the_answer():
    rng = np.random.default_rng(2)
    grid = Grid(nx=37, ny=26, dx=0.1, dy=0.13)
    h = 0.02 * rng.standard_normal(grid.shape)
    first = solve(grid, h, normal_load=0.5, tolerance=1e-11, options=PERIODIC)
    moved = solve(grid, np.roll(h, (7, -11), (0, 1)), normal_load=0.5, tolerance=1e-11, options=PERIODIC)
    assert np.abs(moved.pressure - np.roll(first.pressure, (7, -11), (0, 1))).max() < 1e-9 * first.pressure.max()
    assert moved.approach == close(first.approach, rel=1e-10)


def test_a_small_contact_in_a_large_period_is_a_single_one():
    """Neighbours at 16 radii only shift the datum: by P/(π E* L) times the lattice constant of 1/r, -3.90026.

    The lattice sum of 1/r over a square lattice with a neutralising background is twice that of the Coulomb energy of a
    two-dimensional Wigner crystal (L. Bonsall, A. A. Maradudin 1977, doi:10.1103/PhysRevB.15.1959). Measured: -3.885.
    """
    grid = square_grid(16, half_width=8)
    h = paraboloid(grid)
    alone = solve(grid, h, normal_load=1.0)
    many = solve(grid, h, normal_load=1.0, options=PERIODIC)
    shift = (many.approach - alone.approach) * np.pi * 16.0
    assert shift == close(-3.90026, rel=6e-3)
    assert many.pressure.max() == close(alone.pressure.max(), rel=2e-3)


def test_an_approach_beyond_the_mean_plane_has_no_solution_and_is_refused():
    """A periodic displacement has zero mean: full contact fixes the approach, the pressure may be anything."""
    grid, h = line_wave(32)
    with pytest.raises(NotConverged):
        solve(grid, h, approach=5 * AMPLITUDE, options={**PERIODIC, "max_iterations": 60})


@pytest.mark.parametrize("share", [0.05, 0.5, 0.95])
def test_oracle_by_quadrature(share):
    """Load by integrating the pressure; flatness by ∫ -(2/π) ln|2 sin(π(x-t))| p(t) dt with t = a sin(s)."""
    mean = share * FULL
    a = westergaard.line_half_width(mean, AMPLITUDE, 1.0, 1.0)

    def pressure(t):
        return float(westergaard.line_pressure(t, mean, AMPLITUDE, 1.0, 1.0))

    load = quad(lambda s: pressure(a * np.sin(s)) * a * np.cos(s), -np.pi / 2, np.pi / 2)[0]
    assert load == close(mean, rel=1e-9)
    approach = westergaard.line_approach(mean, AMPLITUDE, 1.0, 1.0)
    for x in (0.0, 0.37 * a, 0.9 * a):
        u = sum(
            quad(
                lambda t, x=x: -2 / np.pi * np.log(abs(2 * np.sin(np.pi * (x - t)))) * pressure(t), low, high, limit=400
            )[0]
            for low, high in ((-a, x), (x, a))
        )
        assert AMPLITUDE * (1 - np.cos(2 * np.pi * x)) + u == close(approach, rel=1e-6)


def test_a_flat_surface_carries_its_load_uniformly():
    """Full contact without any deflection: the mean of a periodic displacement is zero by definition."""
    grid = Grid(nx=16, ny=12, dx=1e-6, dy=1e-6)
    load = 1e-3
    solution = solve(grid, np.zeros(grid.shape), normal_load=load, options=PERIODIC)
    uniform = load / (grid.cell_area * grid.nx * grid.ny)
    np.testing.assert_allclose(solution.pressure, uniform, rtol=1e-12)
