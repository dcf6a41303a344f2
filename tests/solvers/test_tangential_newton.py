"""Newton iteration for tractions within discs: closed form of uncoupled cells, projected gradients of coupled ones."""

import numpy as np
import pytest

from close import close
from eigencontact.solvers.tangential.discs import Infeasible, RigidPlane, length_of
from eigencontact.solvers.tangential.newton import DiscProblem, solve_discs

SHAPE = (2, 5, 6)
MODES = np.array([[np.ones(SHAPE[1:]), np.zeros(SHAPE[1:])], [np.zeros(SHAPE[1:]), np.ones(SHAPE[1:])]])


def problem(matrix, offset, bound, forces=None):
    """Cells coupled by a matrix; prescribed forces along x and y, or none."""
    modes = RigidPlane(MODES if forces is not None else np.zeros((0, *SHAPE)), np.array(forces or ()))
    size = np.trace(matrix) / len(matrix)
    return DiscProblem(
        lambda q: (matrix @ q.ravel()).reshape(SHAPE), lambda slip: slip / size, offset, np.asarray(bound), modes
    )


def solve(discs, tolerance=1e-10):
    residuals = []
    state = solve_discs(discs, np.zeros(SHAPE), tolerance=tolerance, max_iterations=60, on_iteration=residuals.append)
    assert residuals[-1] == state.residual <= tolerance
    return state


def random(seed):
    """Coupled cells, some of which carry nothing."""
    rng = np.random.default_rng(seed)
    size = int(np.prod(SHAPE))
    root = rng.normal(size=(size, size)) / np.sqrt(size)
    bound = rng.uniform(0.1, 1.0, SHAPE[1:]) * (rng.uniform(size=SHAPE[1:]) > 0.2)
    return root @ root.T + 0.3 * np.eye(size), rng.normal(size=SHAPE), bound


def projected_gradients(matrix, offset, bound, modes, steps=4000):
    """Minimum of the energy by accelerated projected gradients, which know neither stick nor slip."""
    plane = modes
    largest = np.linalg.eigvalsh(matrix)[-1]
    q = before = plane.closest(np.zeros(SHAPE), bound)
    for number in range(steps):
        ahead = q + number / (number + 3) * (q - before)
        slip = (matrix @ ahead.ravel()).reshape(SHAPE) + offset
        before, q = q, plane.closest(ahead - slip / largest, bound)
        if np.abs(q - before).max() < 1e-13:
            break
    return q


def test_uncoupled_cells_slip_where_they_would_exceed_their_bound():
    """The traction is the nearest point of the disc to the one that would hold the cell."""
    _, offset, bound = random(1)
    state = solve(problem(2.0 * np.eye(offset.size), offset, bound))
    held = -offset / 2.0
    expected = held * np.minimum(1.0, bound / length_of(held))
    np.testing.assert_allclose(state.tractions, expected, rtol=0, atol=1e-10)
    np.testing.assert_array_equal(state.slipping, (length_of(held) > bound) & (bound > 0))


@pytest.mark.parametrize("seed", [2, 3])
@pytest.mark.parametrize("forces", [None, (1.5, -0.5)])
def test_coupled_cells_reach_the_least_energy(forces, seed):
    matrix, offset, bound = random(seed)
    discs = problem(matrix, offset, bound, forces)
    state = solve(discs)
    expected = projected_gradients(matrix, offset, bound, discs.modes, steps=1500)
    np.testing.assert_allclose(state.tractions, expected, rtol=0, atol=1e-7)
    assert 0 < state.slipping.sum() < np.count_nonzero(bound)
    if forces is not None:
        np.testing.assert_allclose(state.tractions.sum((1, 2)), forces, rtol=1e-9)


def test_a_force_without_slip_moves_all_cells_as_one():
    """Equal uncoupled cells share a force that none of them need slip for; the rigid motion is what it does to each."""
    count = SHAPE[1] * SHAPE[2]
    state = solve(problem(2.0 * np.eye(2 * count), np.zeros(SHAPE), np.full(SHAPE[1:], 1.0), (0.6 * count, 0.0)))
    np.testing.assert_allclose(state.tractions[0], 0.6, rtol=1e-12)
    assert state.rigid == close(np.array([1.2, 0.0]), rel=1e-12, abs=1e-12)
    assert not state.slipping.any()


def test_a_force_beyond_friction_is_refused():
    matrix, offset, bound = random(4)
    with pytest.raises(Infeasible, match="friction must carry the prescribed forces"):
        solve(problem(matrix, offset, bound, (1.01 * bound.sum(), 0.0)))
