"""Fields of a contact as a dataset, and along a row of cells."""

import numpy as np
import pytest

import eigencontact as ec


@pytest.fixture(scope="module")
def contact():
    ball, steel = ec.make("sphere", radius="105 um"), ec.HalfSpace("210 GPa", 0.3)
    return ec.solve_contact(ball, steel, load=[0.2, 0.4], cells=(17, 15), size=("17 um", "15 um"))


def test_the_fields_are_those_of_the_step(contact):
    for step in (1, 2):
        fields = contact.at(step).to_xarray()
        assert set(fields) == {"displacement_z", "gap", "pressure", "reference_pressure"}
        assert all(field.dims == ("y", "x") for field in fields.values())
        assert np.array_equal(fields.pressure, contact.at(step).pressure)
        assert fields.pressure.attrs["units"] == "Pa"


def test_a_profile_is_a_row_of_cells(contact):
    along_x, along_y = contact.profile(), contact.profile("y", at="2.4 um")
    assert np.array_equal(along_x.pressure, contact.pressure[7])
    assert np.array_equal(along_x.x, contact.x)
    assert np.array_equal(along_y.gap, contact.gap[:, 10])
    assert float(along_y.x) == contact.x[10]
    assert np.array_equal(contact.at(1).profile("x", at=-7.4e-6).pressure, contact.at(1).pressure[0])


@pytest.mark.parametrize(
    ("axis", "at", "words"),
    [
        ("z", 0.0, r"profile.axis must be 'x' or 'y' \(got 'z'\)"),
        (3, 0.0, r"profile.axis must be 'x' or 'y'"),
        ("x", 7.6e-6, r"profile.at must be within the window, -7.5e-06 to 7.5e-06 \[m\]"),
        ("x", "1 N", r"profile.at must be a length"),
        ("y", [1e-6], r"profile.at must be a length"),
    ],
)
def test_lines_that_are_none_are_refused(axis, at, words, contact):
    with pytest.raises(ec.EigencontactError, match=rf"^ContactResult\.{words}"):
        contact.profile(axis, at)


def test_a_notebook_names_the_fields(contact):
    assert "displacement_z, gap, pressure, reference_pressure" in contact._repr_html_()
