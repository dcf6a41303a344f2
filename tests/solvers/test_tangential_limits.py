"""Where friction ends: gross slip and back, forces beyond it, no contact, hardly any friction, very much of it."""

import numpy as np
import pytest

from close import close
from eigencontact.errors import SceneError
from eigencontact_verification.oracles import cattaneo
from solvers.frictional import Sphere


def pressed(**options):
    s = Sphere(24, **options)
    s.to()
    return s, cattaneo.shift_of_sliding(s.friction, s.load, 1.0, s.compliance)


def test_gross_slip_is_reached_and_left():
    s, full = pressed(along="x")
    limit = s.friction * s.load
    loads, sticking, slips = [], [], []
    for ratio in (0.5, 1.5, 40.0, 40.0, 39.5, 38.0, 37.0, -40.0):
        s.to(shift_x=ratio * full)
        loads.append(s.forces()[0] / limit)
        sticking.append(s.stick_ratio())
        slips.append(float(np.abs(s.last.tangential.slip[0][s.last.normal.pressure > 0]).max()) / full)
    back = 1 - 2 * float(cattaneo.load_of_shift(0.25))  # half of the shift of sliding back from sliding
    np.testing.assert_allclose(loads, [0.646447, 1, 1, 1, back, -1, -1, -1], atol=3e-3)
    assert sticking[1:3] == [0, 0]
    assert slips[2] == close(38.5)
    assert slips[3] < 1e-12  # nothing moves
    assert 0.6 < sticking[4] < 1.0
    slid = float(s.sliding.slip_distance[12, 12]) / full
    assert slid == close((40 - 1) + (38 + 40), rel=1e-3)  # it slides but for 1 at first and 2 at the turn


def test_gross_slip_along_any_direction():
    s, full = pressed(coupling="partial")
    s.to(shift_x=30 * full, shift_y=40 * full)
    np.testing.assert_allclose(s.forces()[:2] / (s.friction * s.load), [0.6, 0.8], atol=0.01)


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"tangential_load_x": 1.01}, r"tangential_load_x must be below .*prescribe shift_x"),
        ({"tangential_load_x": 0.8, "tangential_load_y": 0.8}, r"must be below what friction carries together"),
        ({"torsion_moment": -0.7}, r"torsion_moment must be below .*prescribe twist"),
    ],
)
def test_forces_beyond_friction_are_refused_in_one_sentence(asked, said):
    s, _ = pressed(coupling="partial")
    with pytest.raises(SceneError, match=said) as caught:
        s.to(**{name: value * s.friction * s.load for name, value in asked.items()})
    assert "\n" not in str(caught.value)
    s.to(tangential_load_x=0.99 * s.friction * s.load)  # the same contact goes on


def test_forces_just_below_friction_are_carried():
    s, full = pressed(along="x")
    s.to(tangential_load_x=(1 - 1e-9) * s.friction * s.load)
    assert s.last.tangential.rigid[0] == close(full, rel=0.01)


@pytest.mark.parametrize("coupling", ["partial", "full"])
def test_without_contact_there_is_no_shear(coupling):
    s = Sphere(24, coupling=coupling)
    found = s.to(approach=-0.1, shift_x=0.3)
    assert not found.tangential.shear.any()
    assert not found.tangential.stick.any()
    assert found.tangential.rigid.tolist() == [0.3, 0.0, 0.0]
    with pytest.raises(SceneError, match="zero where the bodies do not touch"):
        s.to(approach=-0.1, tangential_load_x=0.01)
    # touched after the shift, it has not been sheared; parted again, nothing is left of the shear
    assert np.abs(s.to(shift_x=0.3).tangential.forces[0]) < 1e-9 * s.load
    assert s.to(shift_x=0.6).tangential.forces[0] > 0.1 * s.load
    assert not s.to(approach=-0.1, shift_x=0.6).tangential.shear.any()
    assert np.abs(s.to(shift_x=0.6).tangential.forces[0]) < 1e-9 * s.load


@pytest.mark.parametrize("coupling", ["partial", "full"])
@pytest.mark.parametrize("friction", [1e-6, 1e-3, 10.0])
def test_hardly_any_friction_and_very_much(friction, coupling):
    s = Sphere(24, friction=friction, coupling=coupling)
    s.to(0.5)
    s.to()
    sheared = s.to(shift_x=0.1)
    assert sheared.tangential.report.certificate.holds
    if friction < 1:  # slides as a whole
        assert s.stick_ratio() == 0
        assert s.forces()[0] == close(friction * s.load, rel=1e-3)
    else:  # sticks but for the rim
        assert s.stick_ratio() > 0.95
        assert s.forces()[0] == close(0.1 * cattaneo.initial_stiffness(1.0, s.compliance), rel=0.05)


def test_no_friction_at_all_is_frictionless():
    s = Sphere(24, friction=0.0, coupling="full")
    found = s.to(shift_x=0.1)
    assert not found.tangential.shear.any()
    smooth = Sphere(24, coupling="none")
    np.testing.assert_allclose(found.normal.pressure, smooth.to().normal.pressure, atol=1e-7)
