"""The contact solver of one box against non-negative least squares, and what it does at its limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from close import close
from eigencontact.solvers.constrained_cg import BoxProblem, solve_box
from eigencontact.solvers.rigid import RigidModes

SHAPE = (7, 9)
Y, X = np.meshgrid(np.linspace(-1, 1, 7), np.linspace(-1, 1, 9), indexing="ij")
BOWL = X**2 + 0.7 * Y**2
FIELDS = [np.ones((1, 1)), Y[:, :1], -X[:1]]


def influence(power=1.0, diagonal=3.0):
    """Symmetric and positive definite, like that of a half-space: it falls with the distance."""
    at = np.column_stack([X.ravel(), Y.ravel()])
    distance = np.linalg.norm(at[:, None] - at, axis=2)
    return np.where(distance == 0, diagonal, 0.1 / np.where(distance == 0, 1, distance) ** power)


A = influence()
assert np.linalg.eigvalsh(A).min() > 0


def exact(separation, modes=(), forces=(), matrix=A):
    """Pressure ``(ny, nx)`` that minimises the energy: least squares, with the forces as rows of a large weight."""
    lower = np.linalg.cholesky(matrix)
    weight = 1e6 * np.sqrt(np.abs(matrix).max())
    rows = [weight * np.broadcast_to(field, SHAPE).reshape(1, -1) for field in modes]
    right = np.concatenate([-np.linalg.solve(lower, separation.ravel()), weight * np.asarray(forces, dtype=float)])
    return nnls(np.concatenate([lower.T, *rows]), right, maxiter=10_000)[0].reshape(SHAPE)


def solve(
    separation, modes=(), forces=(), *, start=None, loaded=None, matrix=A, dtype=float, precondition=None, **options
):
    heard = []
    products = options.pop("products", [])

    def apply(p):
        products.append(1)
        return (matrix @ p.ravel()).reshape(SHAPE).astype(dtype)

    problem = BoxProblem(
        apply=apply,
        energy=options.pop("energy", None),
        precondition=precondition or (lambda r: r.copy()),
        separation=separation.astype(dtype),
        modes=RigidModes(list(modes)),
        forces=np.asarray(forces, dtype=float),
        least_deflection=options.pop("least_deflection", 0.0),
    )
    start = np.full(SHAPE, 0.1) if start is None else start
    given = {"tolerance": 1e-11, "max_iterations": 500} | options
    loaded = start > 0 if loaded is None else loaded
    state = solve_box(problem, start.astype(dtype), loaded, on_iteration=heard.append, **given)
    return state, heard


def conditions(state, separation, modes=(), matrix=A):
    """Largest violation of p >= 0, g >= 0, p g = 0, relative to the deflection."""
    gap = (matrix @ state.pressure.ravel()).reshape(SHAPE) + separation
    deflection = np.abs((gap - separation)[state.pressure > 0]).max(initial=1e-300)
    for field, amount in zip(modes, state.rigid, strict=True):
        gap = gap - amount * field
    assert state.pressure.min() >= 0
    return max(-gap.min(), np.abs(gap[state.pressure > 0]).max(initial=0.0)) / deflection


@pytest.mark.parametrize("depth", [0.01, 0.3, 1.0, 5.0])
def test_a_prescribed_approach_equals_least_squares(depth):
    """From the first cell to all of them in contact."""
    state, heard = solve(BOWL - depth)
    assert state.residual <= 1e-11
    assert heard[-1] == state.residual
    assert conditions(state, BOWL - depth) < 1e-10
    assert state.pressure == close(exact(BOWL - depth), abs=1e-9 * state.pressure.max())
    assert (state.pressure > 0).all() == (depth == 5.0)


@pytest.mark.parametrize(
    ("count", "forces"),
    [(1, (0.3,)), (1, (40.0,)), (2, (2.0, 0.3)), (3, (2.0, 0.4, -0.5)), (3, (2.0, 0.0, 1.7)), (3, (0.5, 0.05, 0.3))],
)
def test_prescribed_forces_equal_least_squares(count, forces):
    """Load, and moments up to those that tilt the body on its edge."""
    modes = FIELDS[:count]
    state, _ = solve(BOWL, modes, forces)
    assert state.residual <= 1e-11
    assert [float((field * state.pressure).sum()) for field in modes] == close(forces, abs=1e-11)
    assert conditions(state, BOWL, modes) < 1e-10
    assert state.pressure == close(exact(BOWL, modes, forces), abs=1e-7 * state.pressure.max())


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10**6), depth=st.floats(0.05, 2.0), load=st.none() | st.floats(0.05, 5.0))
def test_rough_surfaces_equal_least_squares(seed, depth, load):
    rough = np.random.default_rng(seed).uniform(0, 1, SHAPE)
    modes, forces = ([], []) if load is None else (FIELDS[:1], [load])
    separation = rough - depth if load is None else rough
    state, _ = solve(separation, modes, forces, tolerance=1e-9)
    assert state.residual <= 1e-9
    assert state.pressure == close(exact(separation, modes, forces), abs=1e-6 * max(state.pressure.max(), 1e-9))


@pytest.mark.parametrize("start", ["one cell", "a wrong corner", "noise", "loaded with nothing"])
def test_the_start_does_not_matter(start):
    rng = np.random.default_rng(3)
    pressure, loaded = np.zeros(SHAPE), None
    if start == "one cell":
        pressure[3, 4] = 1.0
    elif start == "a wrong corner":
        pressure[:2, :2] = 1.0
    elif start == "noise":
        pressure = rng.uniform(0, 1, SHAPE) * (rng.uniform(size=SHAPE) > 0.5)
    else:
        loaded = BOWL < 0.5
    expected = exact(BOWL - 0.5)
    state, _ = solve(BOWL - 0.5, start=pressure, loaded=loaded)
    assert state.pressure == close(expected, abs=1e-9)
    if loaded is None:
        modes, forces = FIELDS, (2.0, 0.3, -0.4)
        state, _ = solve(BOWL, modes, forces, start=pressure)
        assert state.residual <= 1e-11
        assert state.pressure == close(exact(BOWL, modes, forces), abs=1e-7)


@pytest.mark.parametrize("factor", [1.0, 0.8, 1.3, 0.01, 100.0, -1.0])
@pytest.mark.parametrize("controlled", ["approach", "load", "moments"])
def test_energies_however_wrong_change_no_answer(factor, controlled):
    """An exact one saves products: cells that pull are released before a product, and no second one is needed."""
    rough = np.random.default_rng(5).uniform(0, 1, SHAPE)
    modes, forces = {"approach": ([], []), "load": (FIELDS[:1], [3.0]), "moments": (FIELDS, [3.0, 0.3, -0.4])}[
        controlled
    ]
    separation = BOWL + 0.3 * rough - (0.5 if controlled == "approach" else 0.0)
    plain, told = [], []
    slow, before = solve(separation, modes, forces, products=plain)
    fast, after = solve(
        separation, modes, forces, products=told, energy=lambda d: factor * float(d.ravel() @ A @ d.ravel())
    )
    assert max(slow.residual, fast.residual) <= 1e-11
    assert conditions(fast, separation, modes) < 1e-10
    assert fast.pressure == close(exact(separation, modes, forces), abs=1e-7 * fast.pressure.max())
    if factor == 1.0:
        assert len(after) == len(before)
        assert len(told) < len(plain)


def test_a_good_preconditioner_saves_iterations_and_changes_nothing():
    stiff = influence(diagonal=1.05)  # ill conditioned
    inverse = np.linalg.inv(stiff)
    plain, slow = solve(BOWL - 0.5, matrix=stiff, tolerance=1e-9)
    good, fast = solve(
        BOWL - 0.5, matrix=stiff, tolerance=1e-9, precondition=lambda r: (inverse @ r.ravel()).reshape(SHAPE)
    )
    assert good.pressure == close(plain.pressure, abs=1e-6)
    assert len(fast) <= len(slow)


def test_bodies_apart_do_not_press():
    state, _ = solve(BOWL + 0.1)
    assert not state.pressure.any()
    assert state.residual == 0.0
    assert conditions(state, BOWL + 0.1) <= 0.0


@pytest.mark.parametrize("size", [1e-12, 1e12])
def test_units_do_not_matter(size):
    expected, one = solve(BOWL - 0.5)
    scaled, other = solve(size * (BOWL - 0.5), start=size * np.full(SHAPE, 0.1))
    assert scaled.pressure == close(size * expected.pressure, rel=1e-9, abs=1e-12 * size)
    assert len(one) == len(other)


def test_single_precision_gets_as_far_as_it_can():
    state, _ = solve(BOWL, FIELDS, (2.0, 0.3, -0.4), dtype=np.float32, tolerance=2e-6)
    assert state.pressure.dtype == np.float32
    assert state.residual <= 2e-6
    assert state.pressure == close(exact(BOWL, FIELDS, (2.0, 0.3, -0.4)), abs=2e-5)


@pytest.mark.parametrize("iterations", [1, 2, 5])
def test_used_up_iterations_are_told_by_the_residual(iterations):
    state, heard = solve(BOWL, FIELDS[:1], (2.0,), max_iterations=iterations)
    assert len(heard) == iterations
    assert state.residual == heard[-1] > 1e-11
    assert state.pressure.sum() == close(2.0)


def test_moments_that_no_pressure_carries_end_unconverged_with_a_finite_state():
    """Beyond the edge of the box: load times lever is less than the moment."""
    state, _ = solve(BOWL, FIELDS, (1.0, 1.5, 0.0), max_iterations=60)
    assert np.isfinite(state.pressure).all()
    assert state.pressure.min() >= 0
    assert state.residual > 0.1


def test_a_body_that_does_not_deflect_under_its_mean_pressure():
    """Periodic: a singular operator. Where all gaps close they are measured by the least deflection."""
    mean = np.full((63, 63), 1 / 63)
    singular = (np.eye(63) - mean) @ A @ (np.eye(63) - mean)
    assert np.linalg.matrix_rank(singular) == 62
    state, _ = solve(BOWL, FIELDS[:1], (0.5,), matrix=singular)
    assert state.residual <= 1e-11
    assert conditions(state, BOWL, FIELDS[:1], matrix=singular) < 1e-10
    flat, heard = solve(np.zeros(SHAPE), FIELDS[:1], (6.3,), matrix=singular, least_deflection=1.0)
    assert flat.pressure == close(np.full(SHAPE, 0.1), abs=1e-14)
    assert len(heard) == 1


def test_an_operator_without_curvature_stops():
    """A body that gives way to nothing: no step can be taken, and none is."""
    state, heard = solve(BOWL, FIELDS[:1], (1.0,), matrix=np.zeros((63, 63)), max_iterations=50)
    assert len(heard) == 1
    assert state.residual == np.inf
    assert state.pressure.sum() == close(1.0)


def test_the_start_is_left_as_it_was():
    start = np.full(SHAPE, 0.1)
    loaded = start > 0
    solve(BOWL - 0.3, start=start, loaded=loaded)
    assert np.array_equal(start, np.full(SHAPE, 0.1))
    assert loaded.all()
