"""Small contacts against dense matrices by quadrature of Cerruti's point force, and an iteration of the tests' own.

The tractions of an increment are the minimum of a strictly convex function over a convex set: the friction conditions,
checked with an independent matrix, are not only necessary but single out the one solution.
"""

from functools import cache

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from eigencontact.core.grid import Box, Grid
from eigencontact.solvers.tangential.control import TangentialControl
from eigencontact.solvers.tangential.solver import TangentialOptions, TangentialSolver
from eigencontact_verification.oracles.boussinesq import rectangle
from solvers.frictional import coefficients, elastic

N, DX, DY, NU = 6, 0.5, 0.4, 0.3
GRID = Grid(nx=N, ny=N, dx=DX, dy=DY)
SHEAR_MODULUS = (1 - NU**2) / (2 * (1 + NU))


@cache
def matrix():
    """Displacement along (x, y) of every cell by shear along (x, y) on every cell, ``(2 n, 2 n)``."""
    out = np.empty((2, N * N, 2, N * N))
    rows, columns = np.divmod(np.arange(N * N), N)
    for j, load in enumerate(("q_x", "q_y")):
        table = {}
        for row in range(N):
            for column in range(N):
                point = (column * DX, row * DY, 0.0)
                table[row, column] = rectangle(load, point, (DX / 2, DY / 2), NU, SHEAR_MODULUS)[:2]
        for a in range(N * N):
            for b in range(N * N):
                row, column = rows[a] - rows[b], columns[a] - columns[b]
                values = table[abs(row), abs(column)].copy()
                values[1 - j] *= np.sign(row) * np.sign(column)  # the displacement across is odd in x and in y
                out[:, a, j, b] = values
    return out.reshape(2 * N * N, 2 * N * N)


@cache
def solver():
    return TangentialSolver(
        GRID, coefficients((elastic(NU), None), "partial"), "xy", TangentialOptions(tolerance=1e-9, threads=1)
    )


def rigid_fields():
    y, x = (np.broadcast_to(axis, GRID.shape).ravel() for axis in GRID.axes())
    one, zero = np.ones(N * N), np.zeros(N * N)
    return np.array([[one, zero], [zero, one], [-y, x]])


def least(bound, offset):
    """Minimum of ½ qAq + qe over the discs, by projected gradients with momentum, restarted where they overshoot."""
    A = matrix()
    step = 1 / np.linalg.eigvalsh(A)[-1]
    q = ahead = np.zeros((2, N * N))
    momentum = 1.0
    for _ in range(20_000):
        slope = (A @ ahead.ravel()).reshape(2, -1) + offset
        trial = ahead - step * slope
        new = trial * np.minimum(1.0, bound / np.maximum(np.hypot(*trial), 1e-300))
        if np.sum((ahead - new) * (new - q)) > 0:
            momentum = 1.0
        after = 0.5 * (1 + np.sqrt(1 + 4 * momentum**2))
        ahead = new + (momentum - 1) / after * (new - q)
        if np.abs(new - q).max() < 1e-15 and momentum > 2:
            break
        q, momentum = new, after
    return q


def test_influence_coefficients_are_those_of_the_quadrature():
    unit = np.zeros((2, N, N))
    unit[0, 2, 1], unit[1, 4, 4] = 1.0, -0.7
    whole = Box(0, N, 0, N)
    found = solver().operator.apply(unit, whole, whole)
    np.testing.assert_allclose(found.ravel(), matrix() @ unit.ravel(), atol=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_prescribed_displacements_against_an_iteration_of_its_own(seed):
    rng = np.random.default_rng(seed)
    bound = rng.uniform(0, 0.4, GRID.shape) * (rng.random(GRID.shape) > 0.2)
    offset = rng.normal(0, 0.1, (2, *GRID.shape))
    shift = rng.normal(0, 0.4, 3)
    control = TangentialControl(shift_x=shift[0], shift_y=shift[1], twist=shift[2])
    found = solver().solve(bound, offset, control)
    moved = offset.reshape(2, -1) - np.einsum("m,mkn->kn", shift, rigid_fields())
    np.testing.assert_allclose(found.shear.reshape(2, -1), least(bound.ravel(), moved), atol=1e-7)


@settings(max_examples=20, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 2**32 - 1),
    by_force=st.tuples(st.booleans(), st.booleans(), st.booleans()),
    size=st.sampled_from([1e-3, 0.3, 0.9, 0.999, 1.0 - 1e-9]),
    spread=st.sampled_from([0.0, 1.0, 6.0]),
)
# Bounds over fifteen decades: the energy of turning the smallest is below the round-off of the largest.
@example(seed=122, by_force=(False, False, False), size=0.3, spread=6.0)
@example(seed=5, by_force=(True, False, False), size=0.3, spread=6.0)
@example(seed=307, by_force=(True, True, True), size=1.0 - 1e-9, spread=6.0)
def test_friction_conditions_on_random_cells_under_random_controls(seed, by_force, size, spread):
    rng = np.random.default_rng(seed)
    bound = np.exp(spread * rng.normal(size=GRID.shape)) * (rng.random(GRID.shape) > 0.3)
    if not bound.any():
        return
    bound /= bound.max()
    offset = rng.normal(0, 10.0 ** rng.uniform(-3, 1), (2, *GRID.shape))
    fields = rigid_fields()
    # forces that some tractions within the bounds carry: those of a rigid slide
    slide = np.einsum("m,mkn->kn", rng.normal(size=3), fields)
    carried = size * bound.ravel() * slide / np.maximum(np.hypot(*slide), 1e-300)
    forces = np.einsum("mkn,kn->m", fields, carried) * GRID.cell_area
    names = (("shift_x", "tangential_load_x"), ("shift_y", "tangential_load_y"), ("twist", "torsion_moment"))
    given_values = {
        pair[force]: float(forces[mode] if force else rng.normal())
        for mode, (pair, force) in enumerate(zip(names, by_force, strict=True))
    }
    found = solver().solve(bound, offset, TangentialControl(**given_values))

    q, slip = found.shear.reshape(2, -1), np.empty((2, N * N))
    slip[:] = (matrix() @ q.ravel()).reshape(2, -1) + offset.reshape(2, -1)
    slip -= np.einsum("m,mkn->kn", found.rigid, fields)
    size_q, limit, unit = np.hypot(*q), bound.ravel(), max(1e-300, float(np.abs(matrix() @ q.ravel()).max()))
    assert np.all(size_q <= limit * (1 + 1e-9))
    inside = (limit > 0) & (size_q < limit * (1 - 1e-7))
    assert np.hypot(*slip)[inside].max(initial=0.0) <= 1e-7 * unit
    at = (limit > 0) & ~inside
    along, across = np.sum(slip * q, axis=0)[at] / limit[at], (slip[0] * q[1] - slip[1] * q[0])[at] / limit[at]
    assert along.max(initial=-1.0) <= 1e-7 * unit
    assert np.abs(across).max(initial=0.0) <= 1e-7 * unit
    moments = np.einsum("mkn,kn->m", fields, q) * GRID.cell_area
    for mode, force in enumerate(by_force):
        capacity = np.sum(np.hypot(*fields[mode]) * limit) * GRID.cell_area
        if force:
            assert abs(moments[mode] - forces[mode]) <= 1e-8 * capacity
        else:
            assert found.rigid[mode] == given_values[names[mode][0]]
