"""The second course of normal contact, where cells only change sides: a plate on a soft ground, to its conditions."""

import numpy as np
import pytest

from close import close
from eigencontact.solvers.constrained_cg import BoxProblem, solve_box
from eigencontact.solvers.rigid import RigidModes
from eigencontact.solvers.settled_sets import solve_settled

N = 25
LINE = np.linspace(-1, 1, N)
Y, X = np.meshgrid(LINE, LINE, indexing="ij")
BOWL = X**2 + Y**2
ONE = [np.ones((1, 1))]
MOMENTS = [np.ones((1, 1)), Y[:, :1], -X[:1]]


def plate(contrast=1e6):
    """Compliance of a plate that bends on a soft ground, periodic far away: 1/(k + k³ contrast) and its own springs."""
    size = 4 * N
    k = np.fft.fftfreq(size) * size
    k = np.hypot(k[:, None], k[None])
    k[0, 0] = 1.0
    kernel = np.fft.ifft2(contrast / (k + k**3) + 1.0).real
    offset = np.arange(N)[:, None] - np.arange(N)
    return kernel[offset[:, None, :, None], offset[None, :, None, :]].reshape(N * N, N * N)


PLATE = plate()


def problem(modes, forces, *, separation=BOWL, dtype=float, share=None):
    return BoxProblem(
        apply=lambda p: (PLATE @ p.ravel()).reshape(N, N).astype(dtype),
        precondition=lambda r: r.copy(),
        separation=separation.astype(dtype),
        modes=RigidModes(modes),
        forces=np.asarray(forces, dtype=float),
        share=share,
    )


def solve(one, solver=solve_settled, *, tolerance=1e-8, iterations=5000, dtype=float):
    start = np.full((N, N), one.forces[0] / N**2 if len(one.forces) else 0.1, dtype=dtype)
    heard = []
    found = solver(
        one, start, start > 0, tolerance=tolerance, max_iterations=iterations, on_iteration=heard.append
    )  # fmt: skip
    assert len(heard) <= iterations
    return found, len(heard)


def violation(state, one):
    """Of p >= 0, g >= 0, p g = 0, by a product of its own, relative to the deflection."""
    deflection = (PLATE @ state.pressure.ravel()).reshape(N, N)
    gap = deflection + one.separation
    for field, amount in zip(one.modes.fields, state.rigid, strict=True):
        gap = gap - amount * field
    assert state.pressure.min() >= 0
    return max(-gap.min(), np.abs(gap[state.pressure > 0]).max()) / deflection[state.pressure > 0].max()


def test_the_plate_is_one():
    """Positive definite, and nearly all of its compliance is bending: what makes cells change sides."""
    values = np.linalg.eigvalsh(PLATE)
    assert values[0] > 0
    assert values[-1] > 1e4 * values[0]


@pytest.mark.parametrize(
    ("modes", "forces"), [(ONE, [1e-4]), (ONE, [4e-3]), (ONE, [2e-2]), (MOMENTS, [4e-3, 4e-4, 0.0])]
)
def test_the_conditions_hold_and_both_courses_agree(modes, forces):
    """From one cell to most of them; the first course gets there too on this plate, in more or fewer iterations."""
    one = problem(modes, forces)
    found, used = solve(one)
    assert used < 700
    assert found.residual <= 1e-8
    assert violation(found, one) <= 2e-8
    assert one.modes.project(found.pressure) == close(np.asarray(forces), abs=1e-12 * forces[0])
    other, _ = solve(one, solve_box)
    assert other.residual <= 1e-8
    assert found.pressure == close(other.pressure, abs=1e-3 * other.pressure.max())
    assert found.rigid[0] == close(other.rigid[0], rel=1e-6)


def test_a_prescribed_approach_and_shares_of_springs():
    one = problem([], [], separation=BOWL - 0.3)
    assert violation(solve(one)[0], one) <= 2e-8
    shared = problem(ONE, [4e-3], share=np.where(X > 0, 0.5, 1.0))
    assert violation(solve(shared)[0], shared) <= 2e-8


def test_iterations_that_are_used_up_are_told():
    found, used = solve(problem(ONE, [4e-3]), iterations=7)
    assert used == 7
    assert found.residual > 1e-8
