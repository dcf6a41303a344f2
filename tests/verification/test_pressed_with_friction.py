"""Rings on finite elements, pressed with friction: Spence's stick circle, coated contact, figure 4.16 of the thesis."""

import numpy as np
import pytest

from close import close
from eigencontact_verification.fem.pressed_with_friction import CoatedRings
from eigencontact_verification.oracles.coated_contact import coated_contact
from eigencontact_verification.oracles.spence import stick_ratio

NU = 0.3
MODULUS = 1.0 / (1.0 - NU**2)
#: Load of a contact radius of one thickness without coating; its peak pressure.
LOAD, P0 = 4 / 3 * MODULUS, 2 * MODULUS / np.pi


@pytest.mark.slow
@pytest.mark.parametrize("friction_over_beta", [0.5, 0.7])
def test_stick_circle_is_spences_where_coupling_is_weak(friction_over_beta):
    """Spence leaves the pressure as it is; at a Poisson's ratio of 0.45 shear changes it by less than 1 %."""
    nu = 0.45
    beta = (1 - 2 * nu) / (2 - 2 * nu)
    *_, last = CoatedRings(ratio=1.0, poisson_ratio=nu, largest=0.5, per_thickness=48).press(friction_over_beta * beta)
    assert (last.sticking - 0.5) / 24 == close(stick_ratio(friction_over_beta), abs=1 / 24)


@pytest.mark.slow
def test_shear_stays_within_friction_and_the_coupling_shrinks_the_stick_circle():
    """0.698 at friction 0.2 by other finite elements with friction, 80 to a radius; Spence without coupling 0.733."""
    *_, last = CoatedRings(ratio=1.0, poisson_ratio=NU, largest=0.5, per_thickness=48).press(0.2)
    assert (last.sticking - 0.5) / 24 == close(0.698, abs=0.7 / 24)
    assert np.all(np.abs(last.shear) <= 0.2 * last.pressure + 1e-9 * last.pressure.max())


@pytest.mark.parametrize("ratio", [0.5, 2.0])
def test_pressure_without_friction_is_that_of_the_integral_equation(ratio):
    rings = CoatedRings(ratio=ratio, poisson_ratio=NU, largest=1.35, per_thickness=16)
    state = rings.at_load(LOAD, 0.0)
    exact = coated_contact(LOAD, 1.0, ((1.0, ratio, NU),), (1.0, NU))
    assert state.pressure[0] == close(exact.max_pressure, rel=2e-3)
    assert not np.any(state.shear)


def largest_von_mises(rings, friction):
    """Below a tenth of the thickness, over p0; off the interface by less than an element."""
    depths = np.concatenate([np.linspace(0.1, 0.985, 60), np.linspace(1.015, 1.6, 20)])
    r, z = (axis.ravel() for axis in np.meshgrid(np.linspace(0.003, 1.4, 60), depths))
    stress = rings.stress(rings.at_load(LOAD, friction), np.stack([r, 0 * r, z], axis=1))
    shape = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    return np.sqrt(1.5 * (shape**2).sum(axis=(1, 2))).max() / P0


def test_largest_stress_without_coating_and_friction_is_hertzs():
    rings = CoatedRings(ratio=1.0, poisson_ratio=NU, largest=1.1, per_thickness=16)
    assert largest_von_mises(rings, 0.0) == close(0.6200, abs=0.001)


@pytest.mark.slow
@pytest.mark.parametrize(("ratio", "largest", "rise"), [(0.5, 1.35, 1.023), (1.0, 1.15, 1.026), (2.0, 0.95, 1.032)])
def test_friction_raises_the_stress_by_a_few_per_cent(ratio, largest, rise):
    """22, 17 and 15 % by the text; numbers of the index of the thesis."""
    rings = CoatedRings(ratio=ratio, poisson_ratio=NU, largest=largest, per_thickness=32)
    assert largest_von_mises(rings, 0.5) / largest_von_mises(rings, 0.0) == close(rise, abs=0.002)
