"""Line contacts from numbers: Hertz's cylinder, shapes of arrays, and what is refused."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact_verification.oracles.line_contact import hertz_cylinder, hertz_pressure

E, NU, R, LOAD = 210e9, 0.3, 10e-3, 400e3
STEEL = ec.HalfSpace(E, NU)
A, P0 = hertz_cylinder(LOAD, R, E / (1 - NU**2))
TIGHT = {"tolerance": 1e-10}


def cells(count):
    """Cell centres over 3.1 half widths, and their pitch."""
    dx = 3.1 * A / count
    return (np.arange(count) - 0.5 * (count - 1)) * dx, dx


def solved(count, **changes):
    x, dx = cells(count)
    arguments = {"load": LOAD, "spacing": dx, "length": "infinite", "numerics": TIGHT} | changes
    return ec.solve_contact(x**2 / (2 * R), STEEL, **arguments)


def test_pressure_tends_to_that_of_hertz_as_cells_to_the_power_1_8():
    """Mean error over the load; the last cell of the contact makes single errors uneven."""
    errors = []
    for count in (32, 128, 512):
        x, dx = cells(count)
        errors.append(float(np.abs(solved(count).pressure[0] - hertz_pressure(x, A, P0)).sum() * dx / LOAD))
    order = -np.polyfit(np.log([32, 128, 512]), np.log(errors), 1)[0]
    assert abs(order - 1.8) < 0.2
    assert errors[-1] < 5e-5


def test_numbers_of_a_line_contact_are_per_length():
    line = solved(256)
    assert line.pressure.shape == line.gap.shape == (1, 256)
    assert (line.radius, line.max_pressure) == (close(A, rel=1e-3), close(P0, rel=1e-4))
    assert line.contact_area == close(2 * A, rel=1e-3)
    assert solved(256, load="400 N/mm").load == close(LOAD, rel=1e-9)
    assert line.dataset["normal_load"].attrs["units"] == "N/m"


def test_arrays_and_a_component_are_one_contact():
    x, dx = cells(64)
    row, line = x**2 / (2 * R), solved(64).pressure
    arguments = {"load": LOAD, "length": "infinite", "numerics": TIGHT}
    for gap in (row[:, None], row[None, :]):
        assert np.array_equal(ec.solve_contact(gap, STEEL, size=64 * dx, **arguments).pressure, line)
    cylinder = ec.solve_contact(ec.make("cylinder", radius=R), STEEL, cells=64, spacing=dx, **arguments)
    np.testing.assert_allclose(cylinder.pressure, line, atol=1e-9 * P0)
    assert ec.solve_contact(ec.make("cylinder", radius=R), STEEL, load=LOAD, length="infinite").radius == close(A, 5e-3)


def test_friction_approach_and_stress_of_a_line():
    line = solved(64, friction=0.3, tangential_load=0.1 * LOAD, numerics={"coupling": "none"})
    assert line.shear[0].sum() * line.dataset.attrs["cell_size"][0] == close(0.1 * LOAD, rel=1e-6)
    assert not line.shear[1].any()
    near, far = line.stress([[0.0, 0.0, 0.7 * A], [0.0, 5.0, 0.7 * A]])
    np.testing.assert_array_equal(near, far)
    pressed = solved(64, load=None, approach=1e-6, datum_depth="10 mm")
    assert pressed.approach == close(1e-6, rel=1e-9)


REFUSED = [
    ({"load": "400 N"}, "load must be a force per length [N/m]"),
    ({"spacing": (1e-5, 2e-5)}, "spacing must be one length, that along x, with length='infinite'"),
    ({"load": None, "approach": 1e-6}, "must not prescribe approach in a line contact without datum_depth"),
    ({"length": "1 m"}, "length must be 'infinite', which makes a line contact, or left out (got '1 m')"),
    ({"gap": np.zeros((4, 4))}, "an array (nx,), (1, nx) or (nx, 1) of 2 cells or more with length='infinite'"),
    ({"gap": np.zeros((1, 1))}, "(got (1, 1))"),
    ({"gap": np.array([0.0, np.nan])}, "solve_contact.gap must be finite everywhere [m]"),
    ({"length": None, "gap": np.zeros((4, 4)), "datum_depth": 1.0}, "datum_depth must be left out unless"),
]


@pytest.mark.parametrize(("changes", "words"), REFUSED)
def test_refusals_name_the_argument(changes, words):
    x, dx = cells(64)
    arguments = {"gap": x**2 / (2 * R), "bodies": STEEL, "load": LOAD, "spacing": dx, "length": "infinite"} | changes
    with pytest.raises(ec.EigencontactError) as refusal:
        ec.solve_contact(arguments.pop("gap"), arguments.pop("bodies"), **arguments)
    assert words in str(refusal.value)
