"""A rigid sphere pressed with friction beyond yield, by elements: judge of figures 2.33, 2.36, 2.37 and 2.39."""

from functools import cache

import numpy as np
import pytest

from close import close
from eigencontact_verification.fem.pressed_with_friction import CoatedRings
from eigencontact_verification.fem.yielding import Indentation, solve_indentation
from eigencontact_verification.fem.yielding_body import YieldingBody
from eigencontact_verification.fem.yielding_law import YieldingLaw, perfect

#: Units: Young's modulus, contact radius of the elastic body by Hertz.
NU, RADIUS = 0.3, 10.0
LOAD, P0 = 4 / (3 * (1 - NU**2) * RADIUS), 2 / ((1 - NU**2) * np.pi * RADIUS)


@cache
def pressed(friction, *, yields=True, fine=0.125, steps=16):
    """Pressed in steps in which the contact radius grows by as much; all loads are then taken away at once."""
    law = YieldingLaw(young_modulus=1.0, poisson_ratio=NU, hardening=perfect(P0 / 2)) if yields else None
    model = Indentation(
        young_modulus=1.0, poisson_ratio=NU, radius=RADIUS, fine=fine, extent=1.5, reach=20.0, law=law, growth=1.4,
        friction=friction,
    )  # fmt: skip
    loads = [LOAD * (k / steps) ** 3 for k in range(1, steps + 1)]
    return solve_indentation(model, [*loads, 0.0] if yields else loads)


def slipping(solution, friction, steps=16):
    """Whether the nodes in contact slip, by rising radius, and their radii."""
    moment = solution.moments[steps - 1]
    touching = moment.pressure > 0
    slips = np.abs(moment.shear) >= friction * moment.pressure * (1 - 1e-9)
    return slips[touching], solution.surface.r[touching]


def stick_ratio(friction, **options):
    solution = pressed(friction, **options)
    slips, r = slipping(solution, friction)
    return r[~slips].max(initial=0.0) / solution.moments[15].contact_radius


def print_and_wall(friction):
    """Depth of the print and height of the wall around it."""
    surface = pressed(friction).surface_displacement(np.linspace(0, 1.5, 76))
    return surface.max(), -surface.min()


def depth_of_yield(friction):
    """Least depth of a point that has yielded under the load."""
    solution = pressed(friction)
    strain = solution.body.of_state(solution.moments[15].states)
    return YieldingBody.points_of(solution.body.grid)[1][strain > 1e-3 * strain.max()].min()


@pytest.mark.slow
def test_shear_is_at_most_what_friction_carries_and_slips_at_the_edge():
    solution = pressed(0.2, yields=False, fine=0.25, steps=6)
    moment = solution.moments[-1]
    assert np.all(np.abs(moment.shear) <= 0.2 * moment.pressure * (1 + 1e-12))
    slips, _ = slipping(solution, 0.2, steps=6)
    assert slips[-1]
    assert not slips[0]
    assert np.all(moment.shear[moment.pressure > 0] > 0)  # pressure draws the surface inwards, friction holds it back


def test_friction_must_not_be_negative():
    with pytest.raises(ValueError, match=r"friction must not be negative \(got -0\.1\)"):
        pressed(-0.1)


@pytest.mark.slow
def test_an_elastic_body_has_the_stick_circle_of_rings():
    rings = CoatedRings(ratio=1.0, poisson_ratio=NU, largest=1.2, per_thickness=16)
    *_, last = rings.press(0.2)
    assert stick_ratio(0.2, yields=False) == close(rings.nodes[last.sticking] / last.radius, abs=0.07)


@pytest.mark.slow
def test_plastic_strain_reaches_the_surface_between_0_35_and_0_525_beta():
    """Figure 2.33; the text has it between 0.525 and 0.7 beta."""
    assert depth_of_yield(0.1) > 0.13
    assert depth_of_yield(0.15) < 0.05


@pytest.mark.slow
def test_plastic_strain_makes_the_stick_circle_smaller_for_little_friction_and_larger_for_more():
    """Figure 2.36."""
    assert stick_ratio(0.1) < 0.8 * stick_ratio(0.1, yields=False)
    assert stick_ratio(0.2) > 1.1 * stick_ratio(0.2, yields=False)


@pytest.mark.slow
def test_friction_deepens_the_print_by_two_fifths_and_more_than_doubles_its_wall():
    """Figure 2.37; the text has the depth more than doubled too."""
    depth, wall = np.divide(print_and_wall(0.5), print_and_wall(0.0))
    assert depth == close(1.43, abs=0.05)
    assert wall == close(2.23, abs=0.15)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.15, 0.2, 0.5])
def test_one_ring_of_slip_while_the_load_grows(friction):
    """Figure 2.39; the text has two from friction 0.2 on."""
    slips, _ = slipping(pressed(friction), friction)
    assert np.sum(np.diff(np.concatenate([[0], slips.astype(int)])) > 0) == 1
