"""Pressed with friction: Spence's stick disk in the limit of many increments (SP-1), and what full coupling adds.

The stick disk of a finite increment is too small, because the ring that comes into contact meets the whole increment at
once. With steps even in the contact radius, c/a has an error of the first power of the step, the shear less.
"""

from functools import cache

import numpy as np
import pytest

from eigencontact_verification.oracles import spence
from solvers.frictional import Sphere

BETA = 2 / 7


@cache
def pressed(ratio, steps, n=32, coupling="one-way", grading="even"):
    """Sphere pressed in steps even in the contact radius, or each larger than the last by the same factor."""
    s = Sphere(n, coupling=coupling, friction=ratio * BETA, tolerance=1e-7)
    radii = np.arange(1, steps + 1) / steps if grading == "even" else 0.05 ** (1 - np.arange(1, steps + 1) / steps)
    for radius in radii:
        s.to(radius**3)
    return s


def shear_error(s, ratio):
    """Mean square error of the radial shear, relative."""
    y, x = s.grid.axes()
    shear = s.last.tangential.shear
    radial = (shear[0] * x + shear[1] * y) / np.maximum(s.radii, 1e-12)
    exact = spence.radial_shear(s.radii.ravel(), ratio).reshape(s.grid.shape) * BETA * s.pressure
    return float(np.sqrt(np.sum((radial - exact) ** 2) / np.sum(exact**2)))


@pytest.mark.parametrize("ratio", [0.4, 0.7, 1.0])
def test_catalogue_sp_1_in_the_limit_of_many_increments(ratio):
    k, cell = spence.stick_ratio(ratio), pressed(ratio, 8).grid.dx
    found = [pressed(ratio, steps).stick_ratio() for steps in (4, 8, 16)]
    assert found[0] < found[1] < found[2] < k + cell
    assert abs(found[2] - k) < cell
    assert abs(2 * found[2] - found[1] - k) < cell  # extrapolated
    assert shear_error(pressed(ratio, 16), ratio) < 0.35 * cell


def test_stick_disk_converges_with_the_first_power_of_the_step():
    k, steps = spence.stick_ratio(1.0), (4, 8, 16)
    errors = [k - pressed(1.0, count).stick_ratio() for count in steps]
    order = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert 0.8 < order < 1.4


def test_geometric_steps_converge_too_but_need_more():
    errors = [spence.stick_ratio(0.7) - pressed(0.7, count, grading="geometric").stick_ratio() for count in (8, 16)]
    assert 1.5 < errors[0] / errors[1] < 3.0
    assert errors[1] > spence.stick_ratio(0.7) - pressed(0.7, 16).stick_ratio()


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.4, 0.5, 0.6, 0.7, 0.8, 1.0, 1.5])
def test_catalogue_sp_1_fine(ratio):
    s = pressed(ratio, 48, 96)
    assert abs(s.stick_ratio() - spence.stick_ratio(ratio)) < s.grid.dx
    if ratio <= 1:  # at 1.5 the slipping ring is narrower than a cell, and the shear has its peak there
        assert shear_error(s, ratio) < 0.01


def moment_radius(s):
    """Contact radius from the second moment of the pressure: a Hertz pressure of radius a has 2/5 a² P."""
    pressure = s.last.normal.pressure
    return float(np.sqrt(2.5 * np.sum(pressure * s.radii**2) / np.sum(pressure)))


@pytest.mark.parametrize("ratio", [0.4, 0.7, 1.75])
def test_full_coupling_raises_the_pressure_and_shrinks_the_contact(ratio):
    alone, full = pressed(ratio, 4), pressed(ratio, 4, coupling="full")
    assert 1.02 < full.last.normal.pressure.max() / alone.last.normal.pressure.max() < 1.10
    assert 0.96 < moment_radius(full) / moment_radius(alone) < 0.995
    assert np.count_nonzero(full.last.normal.pressure) < np.count_nonzero(alone.last.normal.pressure)
    assert 0.97 < full.last.normal.approach / alone.last.normal.approach < 1.0
    assert full.last.coupling_residual < 1e-7
