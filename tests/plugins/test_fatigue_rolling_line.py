"""Fatigue criteria below a rolling line contact, and under bending with torsion out of phase; one planted fault."""

import numpy as np
import pytest
from scipy.optimize import minimize

import eigencontact as ec
from eigencontact.plugin import DamageParameter, StressCycle, to_mandel
from eigencontact_plugins.fatigue.crossland import Crossland
from eigencontact_verification.conformance import checks_for
from eigencontact_verification.conformance.report import ConformanceError

POISSON = 0.3


def line_stress(x, z):
    """Stress below a Hertz line contact in units of its largest pressure, lengths in units of its half width.

    K. L. Johnson 1985, Contact Mechanics, equations (4.49), plane strain; ``(steps, 6)``: xx, yy, zz, yz, xz, xy.
    """
    root = np.sqrt((1 - x**2 + z**2) ** 2 + 4 * x**2 * z**2)
    m, n = np.sqrt(0.5 * (root + 1 - x**2 + z**2)), np.sign(x) * np.sqrt(0.5 * (root - 1 + x**2 - z**2))
    part = (z**2 + n**2) / (m**2 + n**2)
    xx, zz = -(m * (1 + part) - 2 * z), -m * (1 - part)
    xz = n * (m**2 - z**2) / (m**2 + n**2)
    return np.stack([xx, POISSON * (xx + zz), zz, 0 * x, xz, 0 * x], axis=-1)


def passage(z, steps=801, shift=0):
    """Cycle of a whole passage at a depth; xz may be shifted by steps, the planted fault."""
    stress = line_stress(np.sinh(np.linspace(-4.0, 4.0, steps)), z)
    stress[:, 4] = np.roll(stress[:, 4], shift)
    return StressCycle(stress=to_mandel(stress.T).T[:, :, None])


def value(cycle, key, **parameters):
    criterion = ec.make(key, kind="fatigue-criterion", limit_amplitude=1.0, **parameters)
    return float(criterion.damage(cycle).value[0])


def amplitude_and_dang_van(z, steps, slope):
    """Both values by a quadratic programme for the smallest ball, matrices and plain components throughout."""
    stress = line_stress(np.sinh(np.linspace(-4.0, 4.0, steps)), z)
    mean = stress[:, :3].sum(axis=1) / 3
    rows = np.column_stack([stress[:, :3] - mean[:, None], np.sqrt(2) * stress[:, 4]])
    middle = rows.mean(axis=0)
    away = rows - middle
    squares = np.sum(away**2, axis=1)
    slopes = np.column_stack([2 * away, np.ones(steps)])
    solved = minimize(
        lambda v: v[-1] + v[:-1] @ v[:-1], np.append(np.zeros(4), squares.max()), method="SLSQP",
        jac=lambda v: np.append(2 * v[:-1], 1.0), options={"ftol": 1e-15, "maxiter": 200},
        constraints={
            # |away - c|^2 <= t + c c, linear in c and t
            "type": "ineq", "fun": lambda v: slopes @ v - squares, "jac": lambda _: slopes,
        },
    )  # fmt: skip
    shifted = rows - middle - solved.x[:-1]
    matrices = np.zeros((steps, 3, 3))
    matrices[:, [0, 1, 2], [0, 1, 2]] = shifted[:, :3]
    matrices[:, 0, 2] = matrices[:, 2, 0] = shifted[:, 3] / np.sqrt(2)
    values = np.linalg.eigvalsh(matrices)
    return np.sqrt(solved.fun / 2), np.max(0.5 * (values[:, 2] - values[:, 0]) + slope * mean)


#: Depth in half widths, sqrt(J2) amplitude, Dang Van of slope 0.3, in units of the largest pressure, of 3201 steps by
#: the quadratic programme. Few steps change Dang Van by up to 1 %, through the centre of the ball.
TABLE = [(0.3, 0.23619, 0.15232), (0.5, 0.25000, 0.16917), (0.9, 0.22682, 0.16172)]


@pytest.mark.parametrize("z", [row[0] for row in TABLE])
def test_rolling_line_by_a_quadratic_programme(z):
    amplitude, dang_van = amplitude_and_dang_van(z, 401, 0.3)
    cycle = passage(z, 401)
    assert abs(value(cycle, "crossland", slope=0.0) / amplitude - 1) < 1e-8
    assert abs(value(cycle, "dang-van", slope=0.3) / dang_van - 1) < 1e-7


@pytest.mark.parametrize(("z", "amplitude", "dang_van"), TABLE)
def test_rolling_line(z, amplitude, dang_van):
    """Five digits, and 1e-4 of the value."""
    cycle = passage(z, 3201)
    assert abs(value(cycle, "crossland", slope=0.0) - amplitude) < 0.5e-5 + 1e-4 * amplitude
    assert abs(value(cycle, "dang-van", slope=0.3) - dang_van) < 0.5e-5 + 1e-4 * dang_van


def test_shear_of_a_rolling_line_is_a_quarter_of_the_pressure():
    """Johnson: orthogonal shear amplitude 0.25 p0 at a depth of half of the half width."""
    amplitudes = [np.ptp(passage(z).stress[:, 4, 0]) / 2**1.5 for z in (0.49, 0.5, 0.51)]
    assert abs(amplitudes[1] - 0.25) < 1e-4
    assert amplitudes[1] > max(amplitudes[0], amplitudes[2])


@pytest.mark.parametrize(("z", "amplitude", "dang_van"), TABLE)
def test_a_component_shifted_by_a_step_is_caught(z, amplitude, dang_van):
    """Of 81 steps; the right cycle meets the table within what so few steps allow, the wrong one does not."""
    right, fault = passage(z, 81), passage(z, 81, shift=1)
    assert abs(value(right, "crossland", slope=0.0) / amplitude - 1) < 0.005
    assert abs(value(fault, "crossland", slope=0.0) / amplitude - 1) > 0.01
    assert abs(value(right, "dang-van", slope=0.3) / dang_van - 1) < 0.02
    assert abs(value(fault, "dang-van", slope=0.3) / dang_van - 1) > 0.02


class Shifted(Crossland):
    """The planted fault inside a criterion: xy comes one step late."""

    def damage(self, cycle):
        stress = np.array(cycle.stress)
        stress[:, 5] = np.roll(stress[:, 5], 1, axis=0)
        return DamageParameter(super().damage(StressCycle(stress=stress)).value)


def test_a_component_shifted_by_a_step_is_caught_by_the_checks():
    failed = set()
    for check in checks_for(Shifted(slope=0.3, limit_amplitude=250e6)):
        try:
            check(Shifted(slope=0.3, limit_amplitude=250e6))
        except ConformanceError:
            failed.add(check.__name__)
    assert {"check_start_of_cycle", "check_turned_axes"} <= failed


@pytest.mark.parametrize("phase", [0.0, 30.0, 60.0, 90.0])
def test_papadopoulos_does_not_depend_on_the_phase_of_bending_and_torsion(phase):
    """Closed form of the paper: sqrt(bending^2 / 3 + torsion^2) + slope bending / 3, in and out of phase."""
    bending, torsion, slope, time = 138.0, 167.0, 0.3, 2 * np.pi * np.arange(360) / 360
    plain = np.zeros((360, 6))
    plain[:, 0], plain[:, 5] = bending * np.cos(time), torsion * np.cos(time - np.radians(phase))
    cycle = StressCycle(stress=to_mandel(plain.T).T[:, :, None])
    expected = np.sqrt(bending**2 / 3 + torsion**2) + slope * bending / 3
    assert abs(value(cycle, "papadopoulos", slope=slope) / expected - 1) < 1e-3
