"""Geometries of line contacts: the wedge against its closed form, profiles from files, cuts of rough surfaces."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.core.held_arrays import hold
from eigencontact_verification.oracles.line_contact import (
    hertz_cylinder,
    hertz_pressure,
    wedge_half_width,
    wedge_pressure,
)  # fmt: skip

E, NU, LOAD = 210e9, 0.3, 400e3
E_STAR = E / (1 - NU**2)
STEEL = ec.HalfSpace(E, NU)
LINE = {"load": LOAD, "length": "infinite", "numerics": {"tolerance": 1e-10}}


def test_the_wedge_tends_to_its_closed_form_as_cells():
    """Order 1 of the whole, by the cell at the edge; order 2 away from the edge and from the ends of the contact."""
    half_angle, counts = 1.4, (32, 128, 512)
    slope = 1 / np.tan(half_angle)
    a, whole, smooth = wedge_half_width(LOAD, slope, E_STAR), [], []
    for count in counts:
        dx = 2.6 * a / count
        wedge = ec.make("wedge", half_angle=half_angle)
        run = ec.solve_contact(wedge, STEEL, cells=count, spacing=dx, **LINE)
        error = run.pressure[0] - wedge_pressure(run.x - 0.5 * dx, run.x + 0.5 * dx, a, slope, E_STAR)
        inner = (np.abs(run.x) > 0.1 * a) & (np.abs(run.x) < 0.9 * a)
        whole.append(float(np.abs(error).sum()) * dx / LOAD)
        smooth.append(float(np.abs(error[inner]).max()) / (E_STAR * slope))
    order, inner_order = (-np.polyfit(np.log(counts), np.log(errors), 1)[0] for errors in (whole, smooth))
    assert abs(order - 1.1) < 0.2
    assert abs(inner_order - 2.1) < 0.3
    assert whole[-1] < 6e-4
    assert smooth[-1] < 4e-5


def test_the_closed_form_of_the_wedge_carries_its_load():
    edges = np.linspace(-1.2, 1.2, 24)
    mean = wedge_pressure(edges[:-1], edges[1:], 1.0, 0.1, 1.0)
    assert float(mean @ np.diff(edges)) == close(wedge_half_width(0.1, 0.1, 1.0) * 0.1, rel=1e-12)
    middle = wedge_pressure(0.5 - 1e-6, 0.5 + 1e-6, 1.0, 0.1, 1.0)
    assert middle == close(0.1 / np.pi * np.arccosh(2.0), rel=1e-9)


def test_an_automatic_window_holds_a_wedge():
    run = ec.solve_contact(ec.make("wedge", half_angle=1.4, center=(1e-3, 0.0)), STEEL, **LINE)
    assert run.radius == close(wedge_half_width(LOAD, 1 / np.tan(1.4), E_STAR), rel=0.02)


def parabola(tmp_path, radius=10e-3, count=81, reach=0.3e-3):
    """Profile of a cylinder in a text file, in mm and um."""
    x = np.linspace(-reach, reach, count)
    file = tmp_path / "profile.txt"
    np.savetxt(file, np.column_stack([x * 1e3, 7.0 - x**2 / (2 * radius) * 1e6]), header="x [mm] height [um]")
    return ec.make("profile", file=str(file), unit="1 mm", height_unit="1 um")


def test_a_profile_of_a_cylinder_is_in_contact_as_hertz_says(tmp_path):
    profile = parabola(tmp_path)
    run = ec.solve_contact(profile, STEEL, **LINE)  # the cells of the profile
    a, p0 = hertz_cylinder(LOAD, 10e-3, E_STAR)
    assert run.pressure.shape == (1, 81)
    assert np.abs(run.pressure[0] - hertz_pressure(run.x, a, p0))[np.abs(run.x) < 0.9 * a].max() < 2e-3 * p0


def test_a_profile_is_linear_between_its_points_and_flat_beyond():
    profile = ec.make("profile", file=(held := hold(x=[0.0, 1.0, 3.0], height=[0.0, 2.0, 1.0])).name, center=1.0)
    x = np.array([-5.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0])
    assert profile.separation(x, np.zeros(7)).tolist() == [2.0, 2.0, 1.0, 0.0, 0.5, 1.0, 1.0]
    with pytest.raises(ec.EigencontactError, match=r"profile\.file must have even steps .* give grid\.cells"):
        profile.native_grid()
    assert held is not None


REFUSED = [
    ({"x": [0.0, 2.0, 1.0], "height": [0.0, 1.0, 2.0]}, "finite and ascending [m]"),
    ({"x": [0.0, 1.0, 2.0], "height": [0.0, np.nan, 2.0]}, "a file with finite height [m]"),
    ({"x": [0.0, 1.0, 2.0], "height": [0.0, 1.0]}, "height has the shape (2,)"),
    ({"x": [0.0, 1.0], "height": [0.0, 1.0]}, "a profile of 3 points or more"),
    ({"x": [0.0, 1.0, 2.0]}, "a file with height"),
]


@pytest.mark.parametrize(("arrays", "words"), REFUSED)
def test_a_profile_that_is_none_is_refused(arrays, words):
    held = hold(**arrays)
    with pytest.raises(ec.EigencontactError) as refusal:
        ec.make("profile", file=held.name)
    assert words in str(refusal.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0 1\n1 2\n1 3\n", "one row for every combination of its x"),
        ("0 1\n1\n2 3\n", "rows x height"),
        ("", "it holds no row"),
    ],
)
def test_a_text_that_is_no_profile_is_refused(tmp_path, text, words):
    file = tmp_path / "profile.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ec.EigencontactError) as refusal:
        ec.make("profile", file=str(file))
    assert words in str(refusal.value)


def test_units_of_a_profile_are_checked(tmp_path):
    with pytest.raises(ec.EigencontactError, match=r"profile\.unit must be positive and finite \[m\]"):
        ec.make("profile", file=hold(x=[0.0, 1.0, 2.0], height=[0.0, 1.0, 2.0]).name, unit=0.0)
    with pytest.raises(ec.EigencontactError, match=r"profile\.height_unit must be left out for a file of NetCDF"):
        ec.make("profile", file=str(tmp_path / "profile.nc"), height_unit="1 um")


def test_a_rough_surface_is_cut_at_y_0_and_a_smooth_one_lies_under_it():
    """The cells of the window of a rough line contact are strips, whatever grid the surface brings."""
    rough = ec.make("random-rough", size=(1e-4, 1e-4), short_cutoff=2e-5, rms_height=1e-8)
    run = ec.solve_contact(
        rough, STEEL, load=1e4, length="infinite", numerics={"boundary": "periodic", "tolerance": 1e-9}
    )
    assert run.pressure.shape[0] == 1
    assert run.load == close(1e4, rel=1e-8)
    gap = run.gap[0][run.pressure[0] > 0]
    assert np.abs(gap).max() < 1e-12
    assert (run.gap >= -1e-13).all()
