"""Normal and tangential contact together: rounds, acceleration, and what is refused."""

import numpy as np
import pytest

from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.errors import DomainTooSmall, SceneError
from eigencontact.solvers.anderson import Anderson
from eigencontact.solvers.control import Control
from eigencontact.solvers.normal import NormalOptions
from eigencontact.solvers.tangential.contact import FrictionalContact
from eigencontact.solvers.tangential.control import TangentialControl
from eigencontact.solvers.tangential.solver import TangentialOptions
from solvers.friction_scenes import kernels

#: Unit contact modulus, radius 20: a load of 1/15 presses a circle of radius 1 into contact.
LOAD = 1.0 / 15.0


def sphere(n=32, side=4.0, nu=0.3, coupling="full", friction=0.5, tolerance=1e-6):
    grid = Grid(nx=n, ny=n, dx=side / n, dy=side / n)
    y, x = grid.axes()
    contact = FrictionalContact(
        grid, kernels((Material(young_modulus=1.0 - nu**2, poisson_ratio=nu), None), coupling),
        lambda pressure, _: friction * pressure,
        NormalOptions(tolerance=tolerance, threads=1), TangentialOptions(tolerance=tolerance, threads=1),
    )  # fmt: skip
    return contact, (x**2 + y**2) / 40.0


@pytest.mark.parametrize("growth", [0.3, 1.0, 2.5])
def test_acceleration_converges_where_the_plain_iteration_turns_and_grows(growth):
    """``x = b + K x`` with K skew, as sliding turns pressure and shear into each other."""
    rng = np.random.default_rng(3)
    skew = rng.normal(size=(40, 40))
    skew = growth * (skew - skew.T) / np.linalg.norm(skew - skew.T, 2)
    right, x, mixer = rng.normal(size=40), np.zeros(40), Anderson(40)
    for _ in range(45):
        x = mixer.next(x, right + skew @ x)
    np.testing.assert_allclose(x, np.linalg.solve(np.eye(40) - skew, right), atol=1e-8)


def test_entries_that_come_later_are_those_of_longer_vectors_with_zeros():
    rng, short, whole = np.random.default_rng(4), Anderson(5), Anderson(5)
    for count in (6, 6, 9, 9, 12, 12):
        guess, image = np.zeros((2, 12))
        guess[:count], image[:count] = rng.normal(size=(2, count))
        found = whole.next(guess, image)
        np.testing.assert_allclose(short.next(guess[:count], image[:count]), found[:count], rtol=1e-9, atol=1e-12)
        assert not found[count:].any()


def test_a_restart_solves_a_linear_problem_with_another_right_side_at_once():
    rng, mixer, x = np.random.default_rng(5), Anderson(20), np.zeros(6)
    matrix = 0.4 * rng.normal(size=(6, 6))
    first, second = rng.normal(size=(2, 6))
    for _ in range(7):
        x = mixer.next(x, first + matrix @ x)
    mixer.restart()
    found = mixer.next(x, second + matrix @ x)
    np.testing.assert_allclose(found, np.linalg.solve(np.eye(6) - matrix, second), atol=1e-6)
    assert np.abs(found - Anderson(20).next(x, second + matrix @ x)).max() > 0.1


def test_differences_of_shorter_vectors_serve_longer_ones_after_a_restart():
    rng, short, whole = np.random.default_rng(6), Anderson(5), Anderson(5)
    for count in (6, 6, 9, None, 9, 12):
        if count is None:
            short.restart()
            whole.restart()
            continue
        guess, image = np.zeros((2, 12))
        guess[:count], image[:count] = rng.normal(size=(2, count))
        found = whole.next(guess, image)
        np.testing.assert_allclose(short.next(guess[:count], image[:count]), found[:count], rtol=1e-9, atol=1e-12)


def test_rounds_agree_to_the_tolerance_however_loose_they_begin():
    answers = []
    for tolerance in (1e-4, 1e-6, 1e-9):
        contact, h = sphere(tolerance=tolerance)
        pressed = contact.step(h, Control(normal_load=LOAD), TangentialControl())
        found = contact.step(h, Control(normal_load=LOAD), TangentialControl(tangential_load_x=0.5 * 0.5 * LOAD),
                             pressed.sliding)  # fmt: skip
        assert found.coupling_residual <= tolerance
        assert found.tangential.report.certificate.worst <= 0.2 * tolerance
        assert found.normal.report.certificate.worst <= 0.2 * tolerance
        answers.append(found)
    for found, tolerance in zip(answers[:2], (1e-4, 1e-6), strict=True):
        for name in ("pressure", "shear", "lift"):
            exact = getattr(answers[2].sliding, name)
            np.testing.assert_allclose(
                getattr(found.sliding, name), exact, atol=100 * tolerance * np.abs(exact).max(), err_msg=name
            )


def test_inexact_rounds_take_a_fraction_of_solving_each_to_the_end():
    contact, h = sphere(n=64)
    pressed = contact.step(h, Control(normal_load=LOAD), TangentialControl())
    slid = contact.step(h, Control(normal_load=LOAD), TangentialControl(tangential_load_x=0.25 * LOAD), pressed.sliding)
    assert slid.tangential_convolutions <= 100  # 165 where each round was solved to the end
    assert slid.rounds <= 8


@pytest.mark.parametrize("coupling", ["partial", "full"])
def test_more_than_friction_carries_is_refused_under_any_coupling(coupling):
    contact, h = sphere(coupling=coupling)
    pressed = contact.step(h, Control(normal_load=LOAD), TangentialControl())
    with pytest.raises(SceneError, match="must be below what friction carries together"):
        contact.step(h, Control(normal_load=LOAD), TangentialControl(tangential_load_x=0.51 * LOAD), pressed.sliding)


@pytest.mark.parametrize("coupling", ["partial", "full"])
def test_contact_at_the_edge_is_refused_under_any_coupling(coupling):
    contact, h = sphere(side=1.8, coupling=coupling)
    with pytest.raises(DomainTooSmall, match="it reaches its edge along x and y"):
        contact.step(h, Control(normal_load=LOAD), TangentialControl())


@pytest.mark.parametrize("path", [1e3, 1e5])
def test_partial_slip_after_a_long_way(path):
    """The slip of the step is a small difference of positions far from where the bodies met."""
    contact, h = sphere(n=32, coupling="partial", tolerance=1e-8)
    sliding, reach = contact.step(h, Control(normal_load=LOAD), TangentialControl()).sliding, 0.5 * LOAD
    for shift in (path * reach, (path - 0.3) * reach, (path - 0.3) * reach + 0.1 * reach):
        control = TangentialControl(shift_x=shift, shift_y=0.5 * shift)
        found = contact.step(h, Control(normal_load=LOAD), control, sliding)
        sliding = found.sliding
    assert 0.02 < np.mean(found.tangential.stick[found.sliding.pressure > 0]) < 0.98
