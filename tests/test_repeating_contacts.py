"""Contacts that repeat along y alone: cylinders, rows of balls, friction, stress, and what is refused."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact_plugins.surface_loads import PressureLoad
from eigencontact_verification.oracles import hertz
from eigencontact_verification.oracles.line_contact import hertz_cylinder

E, NU = 210e9, 0.3
STEEL, E_STAR = ec.HalfSpace(E, NU), E / (1 - NU**2)
REPEATING = {"boundary": "periodic-y", "tolerance": 1e-11}
R, LOAD = 10e-3, 400e3
A, P0 = hertz_cylinder(LOAD, R, E_STAR)
PERIOD, NX = 1.3 * A, 48
CYLINDER = ec.make("cylinder", radius=R)


def line(**changes):
    arguments = {"load": LOAD, "cells": NX, "size": 3.1 * A, "length": "infinite", "numerics": {"tolerance": 1e-11}}
    return ec.solve_contact(CYLINDER, STEEL, **(arguments | changes))


def cylinder(rows, **changes):
    arguments = {"load": LOAD * PERIOD, "cells": (NX, rows), "size": (3.1 * A, PERIOD), "numerics": REPEATING}
    return ec.solve_contact(CYLINDER, STEEL, **(arguments | changes))


@pytest.mark.parametrize("rows", [1, 2, 8])
def test_a_cylinder_is_the_line_contact(rows):
    repeating, strips = cylinder(rows), line()
    assert np.abs(repeating.pressure - strips.pressure).max() < 1e-11 * P0
    assert repeating.approach == close(strips.approach, rel=1e-11)
    assert repeating.load == close(LOAD * PERIOD, rel=1e-9)


def test_slip_of_a_cylinder_is_that_of_the_line_contact():
    sheared = {"friction": 0.4, "tangential_load": 0.2 * LOAD}
    strips = line(**sheared, numerics={"coupling": "full", "tolerance": 1e-9})
    sheared = {"friction": 0.4, "tangential_load": 0.2 * LOAD * PERIOD}
    repeating = cylinder(3, **sheared, numerics=REPEATING | {"coupling": "full", "tolerance": 1e-9})
    assert np.abs(repeating.shear[0] - strips.shear[0]).max() < 1e-6 * P0
    assert np.abs(repeating.shear[1]).max() < 1e-6 * P0
    assert 0.1 < float(repeating.dataset["slip_fraction"][-1]) < 0.9


def test_stress_inside_is_that_of_the_line_contact():
    points = [[0.0, 0.0, 0.7 * A], [0.4 * A, 0.2 * PERIOD, 0.3 * A], [0.3 * A, 0.1 * PERIOD, 0.01 * A]]
    stress, expected = (run.stress(points) for run in (cylinder(4), line()))
    assert np.abs(stress - expected).max() < 1e-9 * P0
    table = {"name": "section", "shape": "plane", "normal": "y", "depth_max": 2 * A, "depth_cells": 4}
    section, expected = (run.region(**table)["section_von_mises"] for run in (cylinder(4), line()))
    assert np.abs(section.values - expected.values).max() < 1e-9 * P0


RADIUS, FORCE = 105e-6, 0.65
BALL_A, BALL_P0, _ = hertz.hertz_sphere(FORCE, RADIUS, E_STAR)
VOID = {"type": "void"}
BALL = ec.make("sphere", radius=RADIUS)
PITCH, ACROSS = 2.6 * BALL_A / 24, 24


def row_of_balls(periods, **changes):
    cells = (ACROSS, ACROSS * periods)
    arguments = {"load": FORCE, "cells": cells, "spacing": PITCH, "numerics": REPEATING | {"tolerance": 1e-9}}
    return ec.solve_contact(BALL, STEEL, **(arguments | changes))


def test_a_row_of_balls_tends_to_one_ball_as_the_period_to_the_third():
    """Neighbours at a distance L bend the surface by 1 / L^3 of their load."""
    alone = row_of_balls(1, numerics={"tolerance": 1e-9}).max_pressure
    errors = [row_of_balls(n).max_pressure / alone - 1 for n in (2, 4, 8)]
    order = -np.polyfit(np.log([2, 4, 8]), np.log(errors), 1)[0]
    assert abs(order - 3.0) < 0.1
    assert 0 < errors[-1] < 5e-5


def test_a_row_of_balls_is_in_equilibrium_with_its_neighbours_one_by_one():
    """The gap is closed under the sum of the pressures of 401 periods, up to a constant and the sum of the others."""
    run = row_of_balls(1)
    material = Material(young_modulus=E, poisson_ratio=NU)
    half, shifts = 0.5 * PITCH, np.arange(-200, 201) * PITCH * ACROSS
    along_x, along_y = np.arange(ACROSS) * PITCH, np.arange(1 - ACROSS, ACROSS) * PITCH
    places = (along_y[:, None] + shifts)[:, :, None]
    field = PressureLoad().displacement(["z"], along_x, places, 0.0, (half, half), material)[0].sum(axis=1)
    rows, columns = np.nonzero(run.pressure)
    offsets = rows[:, None] - rows + ACROSS - 1, np.abs(columns[:, None] - columns)
    lift = field[offsets] @ run.pressure[rows, columns]
    gap = (run.x[columns] ** 2 + run.y[rows] ** 2) / (2 * RADIUS) + lift
    assert np.ptp(gap) < 2e-5 * np.mean(lift)


def test_a_step_at_the_seam_along_y_is_told_and_one_along_x_is_not():
    rows, columns = np.mgrid[0:8, 0:8] * 1e-9
    for gap, told in ((rows, True), (columns, False)):
        run = ec.solve_contact(gap, STEEL, load=0.1, spacing=1e-6, numerics=REPEATING | {"allow-contact-at-edge": True})
        assert ("periodic-seam" in {caution["code"] for caution in run.summary["warnings"]}) == told


REFUSED = [
    ({"approach": 1e-7, "load": None}, "must not prescribe approach in a contact that repeats along y without"),
    ({"steps": [{"normal-load": 1.0, "tilt-x": 1e-3}], "load": None}, "must not prescribe tilt-x in a contact that"),
    ({"length": "infinite", "cells": 24, "spacing": PITCH}, "length must be left out with numerics.boundary"),
    ({"cells": None, "spacing": None}, "grid must be given with numerics.boundary = 'periodic-y'"),
    ({"numerics": {"boundary": ["periodic", "non-periodic"]}}, "turn the scene by 90 degrees"),
    ({"numerics": {}, "datum_depth": 1e-3}, "datum_depth must be left out unless length = 'infinite'"),
]


@pytest.mark.parametrize(("changes", "words"), REFUSED)
def test_refusals_name_the_argument(changes, words):
    with pytest.raises(ec.EigencontactError) as refusal:
        row_of_balls(1, **changes)
    assert words in str(refusal.value)


@pytest.mark.parametrize(
    "body",
    [
        ec.HalfSpace(E, NU, bulk_stress={"xx": 1e6}),
        ec.HalfSpace(
            E, NU, inclusions={"type": "sphere", "center": [0, 0, 1e-5], "radius": 2e-6, "material": {"type": "void"}}
        ),
        ec.Layered([("2 um", "420 GPa", 0.25)], substrate=STEEL),
    ],
)
def test_bodies_that_are_not_plain_are_refused(body):
    with pytest.raises(ec.EigencontactError, match=r"must be left out with numerics\.boundary = 'periodic-y'"):
        ec.solve_contact(BALL, body, load=FORCE, cells=24, spacing=PITCH, numerics=REPEATING)


def test_a_pair_names_the_axes_and_explain_says_what_a_period_means():
    scene = {
        "body1": {"young-modulus": E, "poisson-ratio": NU},
        "geometry": {"type": "sphere", "radius": RADIUS},
        "grid": {"cells": 24, "spacing": PITCH, "datum-depth": "1 mm"},
        "numerics": {"boundary": ["non-periodic", "periodic"]},
        "steps": [{"approach": "100 nm"}],
    }
    assert ec.load_scene(scene).numerics.boundary == "periodic-y"
    text = ec.explain(scene)
    assert "the window repeats along y: loads, work and areas are those of one period" in text
    assert "displacements against the depth of 1 mm (grid.datum-depth)" in text


def test_other_cells_of_a_repeating_window_repeat():
    grid = Grid(nx=8, ny=8, dx=1.0, dy=1.0, repeats_y=True)
    assert grid.with_cells(4, 4, 2.0, 2.0, (0.0, 0.0)).ended_axes == (0,)
