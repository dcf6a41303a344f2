"""Errors of a run that the comparison of whole contacts allows: edge of the contact, count of cells, two grids."""

import numpy as np
import pytest

from close import close
from eigencontact_verification.audit.bodies import NotJudged
from eigencontact_verification.audit.contact_edge import counting_error, edge_radius
from eigencontact_verification.audit.contact_lines import StoredContact
from eigencontact_verification.audit.stored_profile import StoredProfile
from eigencontact_verification.audit.two_grids import with_two_grids
from eigencontact_verification.crosscheck.case import Profile


def lattice(cell, half, shift=0.0):
    """Distances of the middles of square cells from the axis."""
    x = cell * (np.arange(-half, half + 1) + shift)
    return np.hypot(*np.meshgrid(x, x)).ravel()


def hertz_gap(r, a):
    """Gap beside Hertz's contact below a sphere of radius 1."""
    s = np.minimum(a / np.maximum(r, a), 1.0)
    sunk = ((2 * a * a - r * r) * np.arcsin(s) + a * np.sqrt(np.maximum(r * r - a * a, 0.0))) / np.pi
    return np.where(r > a, r * r / 2 - a * a + sunk, 0.0)


@pytest.mark.parametrize("a", [6.13, 7.9, 12.4, 16.01, 24.3])
@pytest.mark.parametrize("shift", [0.0, 0.5])
def test_the_gap_tells_the_edge_of_hertz_s_contact_between_the_cells(a, shift):
    r = lattice(1.0, 32, shift)
    start = np.sqrt(np.count_nonzero(r < a) / np.pi)
    radius, error = edge_radius(r, hertz_gap(r, a), np.sqrt(np.maximum(a * a - r * r, 0.0)), 1.0, start)
    assert radius == close(a, rel=5e-3)
    assert abs(radius - a) < error < 0.1


def test_a_pressure_that_does_not_fall_to_the_edge_makes_the_reading_uncertain():
    r = lattice(1.0, 32)
    radius, error = edge_radius(r, hertz_gap(r, 12.4), np.where(r < 12.4, 1.0, 0.0), 1.0, 12.4)
    assert radius == close(12.4, rel=5e-3)
    assert error == close(1.55, rel=1e-6)  # a cell and a half, and what a Hertz contact has


def test_no_edge_is_read_in_a_few_cells_or_a_window_that_is_too_small():
    r = lattice(1.0, 8)
    assert np.isnan(edge_radius(r, hertz_gap(r, 3.0), 0 * r, 1.0, 3.0)).all()
    assert np.isnan(edge_radius(r, hertz_gap(r, 12.0), 0 * r, 1.0, 12.0)).all()


@pytest.mark.parametrize("shift", [0.0, 0.5])
def test_a_count_of_cells_is_within_what_it_can_miss(shift):
    r = lattice(0.5, 40, shift)
    for a in np.linspace(3.0, 12.0, 60):
        missed = abs(np.sqrt(0.25 * np.count_nonzero(r < a) / np.pi) - a)
        allowed = counting_error(r, 0.25, a)
        assert missed <= 1.02 * allowed  # circles are tried at 200 radii
        assert allowed < 0.3 * 0.5  # of a cell


def run(cell, loads=(1.0, 0.0)):
    """A run that is nothing but its cells and loads."""
    field, steps = np.zeros((2, 1, 1)), np.ones(2)
    return StoredContact(
        name="run", text="", load=np.array(loads), approach=steps, radius=steps, correction=steps, straight=2,
        x=np.zeros(1), y=np.zeros(1), pressure=field, gap=field, residual=None, homogeneous=None, cell=cell, pitch=cell,
        middles=np.zeros(0),
    )  # fmt: skip


def line(kind, cell, wrong):
    """Values with an error that is `wrong` over a length of 1, in proportion to the cells."""
    along = cell * np.arange(1, int(6 / cell))
    values = np.exp(-0.1 * along**2)[:, None] * (1 + wrong * cell)
    profile = Profile(
        name=kind, quantity="displacement", points=np.zeros((along.size, 3)), along=along, label="x [m]",
        components=("u_z",), unit="m",
    )  # fmt: skip
    return StoredProfile(profile=profile, kind=kind, moments=(1,), values=values, error=0 * values)


@pytest.mark.parametrize("kind", ["print", "stress"])
def test_two_grids_tell_an_error_of_first_order(kind):
    fine, coarse = line(kind, 0.2, 0.3), line(kind, 0.3, 0.3)
    (found,) = with_two_grids([fine], run(0.2), [coarse], run(0.3))
    error = 0.06 * np.exp(-0.1 * fine.profile.along**2)[:, None]
    assert found.error.max() == close(1.25 * error.max(), rel=0.02)
    assert np.all(found.error > error)


def test_stress_beside_regions_and_lines_that_the_second_run_lacks_keep_their_error():
    lines = [line("stress", 0.2, 0.3), line("print", 0.2, 0.3)]
    found = with_two_grids(lines, run(0.2), [line("stress", 0.3, 0.3)], run(0.3), regions=True)
    assert [a is b for a, b in zip(found, lines, strict=True)] == [True, True]


def test_another_load_or_equal_cells_are_refused():
    with pytest.raises(NotJudged, match="same loads"):
        with_two_grids([], run(0.2), [], run(0.3, (2.0, 0.0)))
    with pytest.raises(NotJudged, match=r"factor of 1\.2"):
        with_two_grids([], run(0.2), [], run(0.2))
