"""The tangential solver against Cattaneo and Mindlin (CM-1 to CM-4) and Lubkin (TO-1, TO-2).

The shear has an edge of infinite slope where stick ends and where contact ends, and both edges fall between cell
centres: its error in the mean square falls with the first power of the cell size (measured 0.9 to 1.2), as that of a
Hertz pressure does.
"""

import numpy as np
import pytest

from close import close
from eigencontact_verification.oracles import cattaneo, torsion
from solvers.frictional import Sphere

#: Neither on a cell centre nor on a cell edge: no symmetry flatters the error.
OFFSET = (0.31, 0.11)


def sphere(n, size=2.6, **options):
    return Sphere(n, size=size, centre=(OFFSET[0] * size / n, OFFSET[1] * size / n), **options)


def sliding_shift(s):
    return cattaneo.shift_of_sliding(s.friction, s.load, 1.0, s.compliance)


def dissipated(s):
    return float(s.sliding.dissipated.sum() * s.grid.cell_area)


@pytest.mark.parametrize("ratio", [0.2, 0.5, 0.9])
@pytest.mark.parametrize(("coupling", "along", "extra"), [("none", "x", 0.0), ("partial", "xy", 2e-3)])
def test_shear_stick_radius_and_shift_of_first_loading(ratio, coupling, along, extra):
    """CM-1. What Cattaneo and Mindlin neglect, slip across the load, changes the shear by a few parts in a thousand."""
    s = sphere(48, coupling=coupling, along=along)
    s.to()
    found = s.to(tangential_load_x=ratio * s.friction * s.load)
    c, traction = float(cattaneo.stick_ratio(ratio)), s.friction * s.pressure
    edges = np.minimum(np.abs(s.radii - c), np.abs(s.radii - 1.0)) < 2 * s.grid.dx
    error = np.abs(found.tangential.shear[0] - cattaneo.shear(s.radii, ratio, 1.0, traction))[~edges]
    assert abs(s.stick_ratio() - c) < s.grid.dx
    assert error.max() < (0.01 + extra) * traction
    assert found.tangential.rigid[0] == close(sliding_shift(s) * float(cattaneo.shift_of_load(ratio)), rel=5e-4 + extra)
    assert s.forces()[0] == close(ratio * s.friction * s.load, rel=1e-7)


def test_shear_converges_with_the_first_power_of_the_cell():
    cells, errors = (20, 40, 80), []
    for n in cells:
        s = sphere(n, along="x")
        s.to()
        shear = s.to(tangential_load_x=0.5 * s.friction * s.load).tangential.shear[0]
        exact = cattaneo.shear(s.radii, 0.5, 1.0, s.friction * s.pressure)
        errors.append(np.sqrt(np.sum((shear - exact) ** 2) / np.sum(exact**2)))
    order = -np.polyfit(np.log(cells), np.log(errors), 1)[0]
    assert 0.8 < order < 1.3
    assert errors[-1] < 0.02


@pytest.mark.parametrize("amplitude", [0.025, 0.125])
def test_loop_under_a_prescribed_shift(amplitude):
    """CM-2 (partial slip) and CM-3 (sliding): δ/a over that of sliding for the sphere of the catalogue."""
    s = sphere(32, along="x")
    full, peak = sliding_shift(s), amplitude / 0.06071
    s.to()
    loads, shifts, taken = [], [], []
    turns = peak * np.cos(np.linspace(0, 2 * np.pi, 41))
    for ratio in [*(peak * np.arange(1, 9) / 8), *turns[1:]]:
        s.to(shift_x=ratio * full)
        loads.append(s.forces()[0] / (s.friction * s.load))
        shifts.append(ratio)
        taken.append(dissipated(s))
    expected = [*cattaneo.load_of_shift(shifts[:8]), *cattaneo.load_on_loop(shifts[8:28], peak)]
    np.testing.assert_allclose(loads[:28], expected, atol=2e-3)
    np.testing.assert_allclose(loads[28:48], -np.array(loads[8:28]), atol=1e-6)  # a loop is its own image
    if peak < 1:
        exact = cattaneo.cycle_energy(float(cattaneo.load_of_shift(peak)), s.friction, s.load, 1.0, s.compliance)
    else:
        exact = cattaneo.cycle_energy_sliding(peak * full, s.friction, s.load, 1.0, s.compliance)
    assert taken[-1] - taken[7] == close(exact, rel=0.02 if peak < 1 else 0.01)


@pytest.mark.parametrize("ratio", [pytest.param(0.5, marks=pytest.mark.slow), 0.8, 1.0 - 1e-9])
def test_energy_of_a_loop_under_a_prescribed_load(ratio):
    """CM-4: 40 steps a cycle."""
    s = sphere(32, along="x")
    s.to()
    force = ratio * s.friction * s.load
    for share in np.linspace(0, 1, 11)[1:]:
        s.to(tangential_load_x=share * force)
    before = dissipated(s)
    for share in np.cos(np.linspace(0, 2 * np.pi, 41))[1:]:
        s.to(tangential_load_x=share * force)
    exact = cattaneo.cycle_energy(ratio, s.friction, s.load, 1.0, s.compliance)
    assert dissipated(s) - before == close(exact, rel=0.01)


@pytest.mark.parametrize("stick", [0.9, 0.7, 0.5, 0.3])
def test_torsion(stick):
    """TO-1, by the angle and by the moment; shear along the circles alone, whatever Poisson's ratio."""
    s = sphere(48, coupling="partial")
    s.to()
    modulus = s.bodies[0].young_modulus / 2.6
    angle = float(torsion.twist(stick)) * s.friction * s.load / modulus
    moment = torsion.moment(stick) * s.friction * s.load
    found = s.to(twist=angle)
    assert s.forces()[2] == close(moment, rel=2e-3)
    assert abs(s.stick_ratio() - stick) < s.grid.dx
    y, x = s.grid.axes()
    r = np.maximum(s.radii, 1e-12)
    around = (found.tangential.shear[1] * x - found.tangential.shear[0] * y) / r
    edges = np.minimum(np.abs(s.radii - stick), np.abs(s.radii - 1.0)) < 2 * s.grid.dx
    exact = torsion.shear(np.minimum(s.radii, 1.0).ravel(), stick).reshape(s.grid.shape) * s.friction * s.pressure
    assert np.abs(around - exact)[~edges].max() < 0.015 * s.friction * s.pressure

    again = sphere(48, coupling="partial")
    again.to()
    assert again.to(torsion_moment=s.forces()[2]).tangential.rigid[2] == close(angle, rel=1e-5)


def test_limits_of_torsion():
    """TO-2: the first stiffness, and an angle that grows like the logarithm of the stick radius."""
    s = sphere(48, coupling="partial")
    s.to()
    modulus = s.bodies[0].young_modulus / 2.6
    tiny = 1e-6 * s.friction * s.load / modulus
    s.to(twist=tiny)
    assert s.forces()[2] / tiny == close(torsion.initial_stiffness(modulus, 1.0), rel=0.01)
    s.to(twist=1e6 * tiny)
    slid = torsion.sliding_moment(s.friction, s.load, 1.0)
    assert slid == close(s.forces()[2], rel=2e-3)
