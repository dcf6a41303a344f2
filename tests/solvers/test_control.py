"""What is prescribed and what comes out: load, approach, moments, tilts; signs; a dense reference; symmetries."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from close import close
from eigencontact.core.grid import Grid
from eigencontact_verification.oracles import dense, punch
from solvers.contacts import halfspace, paraboloid, rounded_punch, solve, square_grid

EDGE = {"allow_contact_at_edge": True}
compliance = cache(dense.compliance_matrix)


def modes_of(grid):
    """Fields of approach, tilt_x, tilt_y on the flattened grid."""
    y, x = grid.axes()
    return np.array([np.broadcast_to(field, grid.shape).ravel() for field in (np.ones((1, 1)), y, -x)])


def rough(grid, seed, amplitude, curvature):
    y, x = grid.axes()
    return amplitude * np.random.default_rng(seed).standard_normal(grid.shape) + curvature * (x**2 + y**2)


# --- pairs of controls -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(40, 40), (37, 53), (64, 31)], ids=str)
@pytest.mark.parametrize("load", [1e-3, 0.4, 1.3])
def test_load_and_approach_control_meet(shape, load):
    grid = Grid(ny=shape[0], nx=shape[1], dy=2.7 / shape[0], dx=2.7 / shape[1])
    h = paraboloid(grid) + 0.005 * np.cos(9 * grid.x[None]) * np.sin(8 * grid.y[:, None])
    by_load = solve(grid, h, normal_load=load, tolerance=1e-11)
    by_approach = solve(grid, h, approach=by_load.approach, tolerance=1e-11)
    assert by_load.normal_load == close(load, rel=1e-12)
    assert by_approach.approach == by_load.approach
    assert by_approach.normal_load == close(load, rel=1e-8)
    assert np.abs(by_approach.pressure - by_load.pressure).max() < 1e-7 * by_load.pressure.max()


@pytest.mark.parametrize("start", ["approach", "load"])
@pytest.mark.parametrize("cells", [12, 17, 29])
def test_tilt_and_moment_control_meet(cells, start):
    """Tilt a rounded punch, prescribe the moments that result, and find the tilts again."""
    grid = square_grid(cells, half_width=1.9, offset=(0.2, -0.4))
    h = rounded_punch(grid)
    first = {"approach": 0.35} if start == "approach" else {"normal_load": 0.5}
    tilted = solve(grid, h, **first, tilt_x=0.06, tilt_y=-0.03, tolerance=1e-11)
    second = {"approach": tilted.approach} if start == "approach" else {"normal_load": tilted.normal_load}
    back = solve(grid, h, **second, moment_x=tilted.moment_x, moment_y=tilted.moment_y, tolerance=1e-11)
    assert (tilted.tilt_x, tilted.tilt_y) == (0.06, -0.03)
    assert (back.tilt_x, back.tilt_y) == close((0.06, -0.03), rel=1e-8)
    assert back.approach == close(tilted.approach, rel=1e-8)
    assert back.normal_load == close(tilted.normal_load, rel=1e-8)
    assert np.abs(back.pressure - tilted.pressure).max() < 1e-7 * tilted.pressure.max()


def test_signs_and_equilibrium_of_moments():
    """g = h + u - δ - φx y + φy x; φx > 0 presses at y > 0, Mx = Σ p y dA; φy > 0 presses at x < 0, My = -Σ p x dA."""
    grid = square_grid(16, half_width=1.9)
    y, x = grid.axes()
    h = rounded_punch(grid)
    s = solve(grid, h, normal_load=0.5, tilt_x=0.05, tilt_y=0.02, tolerance=1e-11)
    assert np.abs(s.gap - (h + s.displacement - s.approach - s.tilt_x * y + s.tilt_y * x)).max() < 1e-15
    assert s.normal_load == close(s.pressure.sum() * grid.cell_area, rel=1e-13)
    assert s.moment_x == close((s.pressure * y).sum() * grid.cell_area, rel=1e-12)
    assert s.moment_y == close(-(s.pressure * x).sum() * grid.cell_area, rel=1e-12)
    assert s.moment_x > 0
    assert s.moment_y > 0
    assert s.pressure[y[:, 0] > 0].sum() > 1.2 * s.pressure[y[:, 0] < 0].sum()
    assert s.pressure[:, x[0] < 0].sum() > 1.05 * s.pressure[:, x[0] > 0].sum()


def test_moments_refer_to_the_origin_of_coordinates():
    """A window and a ball away from the origin: the same contact, moments P y and -P x."""
    here = Grid(nx=40, ny=38, dx=0.1, dy=0.1)
    there = Grid(nx=40, ny=38, dx=0.1, dy=0.1, center=(10.0, -7.0))
    h = paraboloid(here)
    expected = solve(here, h, normal_load=0.8)
    moved = solve(there, h, normal_load=0.8)
    assert np.abs(moved.pressure - expected.pressure).max() < 1e-9 * expected.pressure.max()
    assert (moved.moment_x, moved.moment_y) == close((-5.6, -8.0), rel=1e-9)
    back = solve(there, h, normal_load=0.8, moment_x=-5.6, moment_y=-8.0, tolerance=1e-8)
    assert (back.tilt_x, back.tilt_y) == close((0.0, 0.0), abs=1e-8)


@pytest.mark.parametrize("tilt", [(0.0, 0.0), (0.003, -0.002)], ids=str)
def test_flat_punch_approaches_its_closed_form(tilt):
    """First order at best (a staircase rim under an infinite pressure): P, Mx, My to 0.3 % at 64 cells per radius."""
    grid = square_grid(64, half_width=1.1)
    y, x = grid.axes()
    h = np.where(x**2 + y**2 < 1, 0.0, 10.0)
    s = solve(grid, h, approach=0.01, tilt_x=tilt[0], tilt_y=tilt[1], options=EDGE)
    load, moment_x, moment_y = punch.flat_punch_forces(0.01, *tilt, 1.0, 1.0)
    assert s.normal_load == close(load, rel=3e-3)
    assert (s.moment_x, s.moment_y) == close((moment_x, moment_y), rel=3e-3, abs=1e-12)
    exact = punch.flat_punch_pressure(x, y, 0.01, *tilt, 1.0, 1.0)
    inside = x**2 + y**2 < 0.6**2
    assert np.abs(s.pressure - exact)[inside].max() < 2e-3 * exact[inside].max()


def test_closed_form_of_the_punch_is_in_equilibrium_by_quadrature():
    """Polar quadrature with r = a sin t, which takes the rim's singularity away."""
    t, w = np.polynomial.legendre.leggauss(40)
    t, w = 0.25 * np.pi * (t + 1), 0.25 * np.pi * w
    phi = 2 * np.pi * np.arange(16)[:, None] / 16
    r = 0.7 * np.sin(t)
    y, x = r * np.sin(phi), r * np.cos(phi)
    p = punch.flat_punch_pressure(x, y, 0.01, 0.003, -0.002, 0.7, 2.5)
    area = r * 0.7 * np.cos(t) * w * 2 * np.pi / 16
    found = (np.sum(p * area), np.sum(p * y * area), -np.sum(p * x * area))
    assert found == close(punch.flat_punch_forces(0.01, 0.003, -0.002, 0.7, 2.5), rel=1e-12)


# --- the dense reference -----------------------------------------------------------------------------------------

RANDOM = settings(deadline=None, derandomize=True, max_examples=15, phases=[Phase.generate])  # shrinking takes minutes
ROUGHNESS = st.sampled_from([(0.0, 0.05), (0.0, 0.3), (0.1, 0.05), (1.0, 0.0), (1.0, 0.3)])
LOADS = st.floats(-3, 2).map(lambda exponent: 10.0**exponent)
SHAPES = st.tuples(st.sampled_from([1, 2, 7, 11, 12]), st.sampled_from([1, 3, 9, 10]))


def agrees(solution, pressure, gap, tolerance):
    """Pressure and gap within 100 tolerances of the largest pressure and deflection."""
    deflection = solution.displacement[solution.pressure > 0].max()
    assert np.abs(solution.pressure.ravel() - pressure).max() < 100 * tolerance * pressure.max()
    assert gap is None or np.abs(solution.gap.ravel() - gap).max() < 100 * tolerance * deflection


@RANDOM
@given(SHAPES, ROUGHNESS, LOADS, st.integers(0, 10**6))
def test_any_surface_under_load_equals_the_dense_solution(shape, roughness, load, seed):
    """From one touching cell to nearly all of them."""
    grid = Grid(ny=shape[0], nx=shape[1], dx=1.3, dy=0.8)
    h = rough(grid, seed, *roughness)
    K = compliance(shape, (0.8, 1.3), 1.0)
    pressure, gap, rigid = dense.solve_contact(K, h.ravel(), modes_of(grid)[:1], np.array([load / grid.cell_area]))
    s = solve(grid, h, normal_load=load, tolerance=1e-11, options=EDGE)
    agrees(s, pressure, gap, 1e-11)
    assert s.approach == close(rigid[0], rel=1e-10, abs=1e-12)


@RANDOM
@given(SHAPES, ROUGHNESS, st.floats(0.01, 20), st.integers(0, 10**6))
def test_any_surface_at_any_approach_equals_the_dense_solution(shape, roughness, approach, seed):
    grid = Grid(ny=shape[0], nx=shape[1], dx=1.3, dy=0.8)
    h = rough(grid, seed, *roughness)
    K = compliance(shape, (0.8, 1.3), 1.0)
    approach += h.min()
    pressure, gap, _ = dense.solve_contact(K, h.ravel() - approach)
    s = solve(grid, h, approach=approach, tolerance=1e-11, options=EDGE)
    agrees(s, pressure, gap, 1e-11)


@RANDOM
@given(
    ROUGHNESS,
    st.floats(-1, 2).map(lambda exponent: 10.0**exponent),
    st.floats(-0.6, 0.6),
    st.floats(-0.6, 0.6),
    st.integers(0, 10**6),
)
def test_any_surface_under_load_and_moments_equals_the_dense_solution(roughness, load, share_x, share_y, seed):
    """Centres of pressure up to 0.6 of the way to the edge of the window; contacts of three cells among them."""
    grid = Grid(ny=11, nx=9, dx=1.3, dy=0.8)
    h = rough(grid, seed, *roughness)
    K = compliance((11, 9), (0.8, 1.3), 1.0)
    forces = load * np.array([1.0, share_x * 4.0, share_y * 5.2])
    pressure, gap, rigid = dense.solve_contact(K, h.ravel(), modes_of(grid), forces / grid.cell_area)
    s = solve(grid, h, normal_load=load, moment_x=forces[1], moment_y=forces[2], tolerance=1e-9, options=EDGE)
    # Contact along one line leaves the tilt about it free within a range: only the pressure is unique then.
    on_a_line = np.linalg.matrix_rank(modes_of(grid)[:, pressure > 1e-9 * pressure.max()]) < 3
    agrees(s, pressure, None if on_a_line else gap, 1e-9)
    assert on_a_line or (s.approach, s.tilt_x, s.tilt_y) == close(tuple(rigid), rel=1e-7, abs=1e-7 * load)


@pytest.mark.parametrize(("load", "cells"), [(1e-9, 1), (1e4, 108), (200.0, range(60, 108))], ids=str)
def test_from_one_cell_to_all(load, cells):
    """The table above does reach its ends."""
    grid = Grid(ny=12, nx=9, dx=1.3, dy=0.8)
    h = rough(grid, 3, 1.0, 0.05)
    s = solve(grid, h, normal_load=load, tolerance=1e-11, options=EDGE)
    count = np.count_nonzero(s.pressure)
    assert count in (cells if isinstance(cells, range) else [cells])
    K = compliance((12, 9), (0.8, 1.3), 1.0)
    pressure, gap, _ = dense.solve_contact(K, h.ravel(), modes_of(grid)[:1], np.array([load / grid.cell_area]))
    agrees(s, pressure, gap, 1e-11)


def test_dense_solution_satisfies_the_conditions_of_contact():
    """The judge itself: complementarity to round-off, forces carried, and the energy is least among perturbations."""
    grid = Grid(ny=12, nx=9, dx=1.3, dy=0.8)
    h = rough(grid, 5, 0.3, 0.05).ravel()
    K, modes = compliance((12, 9), (0.8, 1.3), 1.0), modes_of(grid)
    forces = np.array([3.0, 2.0, -1.5])
    p, g, rigid = dense.solve_contact(K, h, modes, forces)
    assert p.min() >= 0
    assert g.min() >= 0
    assert np.all(p * g == 0)
    assert np.abs(h + K @ p - rigid @ modes - g).max() < 1e-13 * np.abs(K @ p).max()
    assert modes @ p == close(forces, rel=1e-12)
    rng = np.random.default_rng(6)
    energy = 0.5 * p @ K @ p + h @ p
    for _ in range(20):
        q = np.maximum(0.0, p + 0.05 * p.max() * rng.standard_normal(p.size) * (p > 0))
        q *= forces[0] / q.sum()
        extra = rigid[1:] @ (modes[1:] @ q - forces[1:])  # work of the moments that q does not carry
        assert 0.5 * q @ K @ q + h @ q - extra > energy


# --- the certificate, recomputed ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "control",
    [{"normal_load": 0.6}, {"approach": 0.5}, {"normal_load": 0.6, "moment_x": 0.05, "moment_y": -0.02}],
    ids=str,
)
@pytest.mark.parametrize("tolerance", [1e-4, 1e-8])
def test_certificate_recomputed_by_a_dense_sum(control, tolerance):
    grid = Grid(ny=35, nx=33, dx=0.08, dy=0.08)
    h = paraboloid(grid) + 0.01 * np.random.default_rng(8).standard_normal(grid.shape)
    K = compliance((35, 33), (0.08, 0.08), 1.0)
    s = solve(grid, h, tolerance=tolerance, **control)
    u = (K @ s.pressure.ravel()).reshape(grid.shape)
    y, x = grid.axes()
    g = h + u - s.approach - s.tilt_x * y + s.tilt_y * x
    loaded = s.pressure > 0
    deflection = u[loaded].max()
    certificate = s.report.certificate
    assert np.abs(s.displacement - u).max() < 1e-12 * deflection
    assert s.pressure.min() >= 0
    assert np.abs(g[loaded]).max() / deflection == close(certificate.gap, rel=1e-3, abs=1e-12)
    assert max(0.0, -g[~loaded].min()) / deflection == close(certificate.penetration, rel=1e-3, abs=1e-12)
    assert certificate.worst <= tolerance
    assert certificate.holds
    assert certificate.tolerance == tolerance
    assert s.report.iterations > 0
    assert s.report.convolutions > 0
    assert s.report.seconds > 0


# --- exact symmetries --------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def lopsided():
    grid = Grid(nx=31, ny=24, dx=0.1, dy=0.12)
    h = paraboloid(grid, 1.0, 0.8) + 0.02 * np.random.default_rng(1).standard_normal(grid.shape)
    return grid, h, solve(grid, h, normal_load=0.9, moment_x=0.05, moment_y=-0.08, tolerance=1e-11)


@pytest.mark.parametrize(
    ("turn", "moments", "tilts"),
    [
        # array operation, (Mx, My) and (φx, φy) of the turned problem from those of the first
        (lambda f: f[:, ::-1], lambda m: (m[0], -m[1]), lambda t: (t[0], -t[1])),
        (lambda f: f[::-1], lambda m: (-m[0], m[1]), lambda t: (-t[0], t[1])),
        (lambda f: f[::-1, ::-1], lambda m: (-m[0], -m[1]), lambda t: (-t[0], -t[1])),
        (lambda f: f.T, lambda m: (-m[1], -m[0]), lambda t: (-t[1], -t[0])),
        (np.rot90, lambda m: (m[1], -m[0]), lambda t: (t[1], -t[0])),
        (lambda f: np.rot90(f, -1), lambda m: (-m[1], m[0]), lambda t: (-t[1], t[0])),
    ],
    ids=["mirror x", "mirror y", "half turn", "transpose", "quarter turn", "quarter turn back"],
)
def test_mirrors_and_quarter_turns(lopsided, turn, moments, tilts):
    grid, h, first = lopsided
    turned = np.ascontiguousarray(turn(h))
    swapped = turned.shape != h.shape
    other = Grid(nx=24, ny=31, dx=0.12, dy=0.1) if swapped else grid
    moment_x, moment_y = moments((0.05, -0.08))
    s = solve(other, turned, normal_load=0.9, moment_x=moment_x, moment_y=moment_y, tolerance=1e-11)
    assert np.abs(s.pressure - turn(first.pressure)).max() < 1e-10 * first.pressure.max()
    assert (s.tilt_x, s.tilt_y) == close(tilts((first.tilt_x, first.tilt_y)), rel=1e-10)
    assert s.approach == close(first.approach, rel=1e-11)


def test_more_load_more_contact():
    """Pressure at every cell grows with the load (Hertz-like contacts never unload a cell)."""
    grid = square_grid(12)
    h = paraboloid(grid) + 0.004 * np.cos(11 * grid.x[None] + 5 * grid.y[:, None])
    steps = [solve(grid, h, normal_load=load, tolerance=1e-10).pressure for load in (0.1, 0.3, 0.7, 1.2)]
    assert all(np.all(after >= before - 1e-8) for before, after in pairwise(steps))


def test_coefficients_of_one_table_serve_any_grid():
    """The solver asks for nothing but a table: offsets from 0, one quadrant."""
    seen = []

    class Recorder:
        def table(self, x, y, half_widths):
            seen.append((x[0], y[0], np.ptp(x), half_widths))
            return halfspace().table(x, y, half_widths)

        response = None  # needed by periodic contact only

    grid = square_grid(16)
    solve(grid, paraboloid(grid), Recorder(), normal_load=1.0)
    assert all(first_x == 0 and first_y == 0 for first_x, first_y, _, _ in seen)
