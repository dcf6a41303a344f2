"""Line contacts of scenes, in plane strain: closed forms, units per length, refusals.

Lengths in the half width of a Hertz contact with R = E* = 1, P = π/4 and p0 = 1/2 (per unit length).
"""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.errors import DomainTooSmall, PlanError, SceneError
from eigencontact.model.interface import _refuse_without_strips
from eigencontact.model.kernels import PairCoefficients
from eigencontact.plugin import SurfaceInfluence
from eigencontact.solvers.control import Control
from eigencontact.solvers.normal import NormalOptions, NormalSolver
from eigencontact_plugins.surface_loads import PressureLoad
from eigencontact_verification.oracles.line_contact import (
    cattaneo_shear,
    cattaneo_stick,
    hertz_cylinder,
    hertz_pressure,
    hertz_stress,
    rounded_punch_load,
    rounded_punch_pressure,
    stress_under,
    trailing_edge_tension,
)

NU = 0.3
P, P0 = np.pi / 4, 0.5
#: Bodies with E* = 1: one on a rigid one, and two alike.
ONE = {"body1": {"young-modulus": 1 - NU**2, "poisson-ratio": NU}}
PAIR = {f"body{number}": {"young-modulus": 2 * (1 - NU**2), "poisson-ratio": NU} for number in (1, 2)}
CYLINDER = {"type": "cylinder", "radius": 1.0, "length": "infinite"}
FRICTION = {"type": "coulomb", "coefficient": 0.3}
SHARE = 0.6
C = cattaneo_stick(P, SHARE * 0.3 * P, 0.3)


def scene(cells=256, size=3.0, *, grid=None, **tables):
    """Tables of a line contact, by default of a cylinder on one body."""
    given = ONE | {"geometry": CYLINDER, "steps": [{"normal-load": P}]} | tables
    given["grid"] = {"length": "infinite", "cells": cells, "size": size} | (grid or {})
    return given | {"numerics": {"tolerance": 1e-8, **tables.get("numerics", {})}, "output": {"pictures": False}}


def solved(*cells, **tables):
    result = ec.run(scene(*cells, **tables))
    return result.summary, result.dataset


def root_mean_square(values):
    return float(np.sqrt(np.mean(np.square(values))))


def test_hertz_converges_with_the_edge_of_the_pressure():
    """The root of the pressure at its ends bounds the order of the mean error by 1; the maximum is much better."""
    cells, errors = np.array([64, 256, 1024]), []
    for n in cells:
        summary, data = solved(int(n))
        errors.append(root_mean_square(data.pressure.values[-1, 0] - hertz_pressure(data.x.values, 1.0, P0)) / P0)
        assert summary["max_pressure"] == close(P0, rel=0.3 / (n / 3) ** 2)
        assert summary["contact_radius"] == close(1.0, abs=0.01 * 3.0 / n)
    order = -np.polyfit(np.log(cells), np.log(errors), 1)[0]
    assert 0.85 < order < 1.15
    assert errors[1] < 1e-3 > errors[2] * 5


@pytest.mark.parametrize("ratio", [0.1, 0.5, 0.7])
def test_punch_with_rounded_edges(ratio):
    """Published pressure of a flat with parabolic edges: half width a = b / ratio, finite everywhere."""
    angle, half = np.arcsin(ratio), 1.0 / ratio
    load = rounded_punch_load(angle)
    punch = {"type": "rounded-punch", "flat-radius": 1.0, "edge-radius": 1.0}
    summary, data = solved(256, 2.7 * half, geometry=punch, steps=[{"normal-load": load}])
    x = data.x.values
    inside = np.abs(x) < half
    expected = np.where(inside, load * rounded_punch_pressure(np.clip(x, -half, half), angle), 0.0)
    pressure = data.pressure.values[-1, 0]
    assert root_mean_square(pressure - expected) < 0.3 / (256 / 2.7) * expected.max()  # first order, as by Hertz
    assert pressure.max() == close(expected.max(), rel=3e-4)
    assert summary["contact_radius"] == close(half, rel=1e-3)


def test_the_numbers_of_the_punch():
    """The closed form itself, against its published numbers at b/a = 0.5, and its load."""
    angles = np.arcsin([0.1, 0.5, 0.7])
    assert [rounded_punch_load(angle) for angle in angles] == close([68.557, 1.2284, 0.30153], rel=5e-5)
    x = np.linspace(0.0, 2.0, 4001)[:-1]
    p = rounded_punch_pressure(x, angles[1])
    assert [p[0], p.max(), 0.5 * x[p.argmax()]] == close([0.201, 0.335, 0.634], rel=6e-3)
    assert 2.0 * np.trapezoid(p, x) == close(1.0, abs=1e-3)


@pytest.fixture(scope="module")
def fretted():
    """Cylinder in partial slip, Q = 0.6 μP, with stress on a section and along the surface."""
    stress = [
        {"shape": "plane", "name": "section", "normal": "y", "depth-max": 1.5, "depth-cells": 60},
        {"shape": "points", "name": "edge", "points": [[-1.0, 0.0, 0.003], [-1.0, 7.0, 0.003], [-1.0, 0.0, 0.012]]},
    ]
    steps = [{"normal-load": P}, {"tangential-load-x": SHARE * 0.3 * P}]
    return ec.run(scene(512, **PAIR, friction=FRICTION, steps=steps, stress=stress))


def test_partial_slip_of_a_cylinder(fretted):
    summary, data = fretted.summary, fretted.dataset
    shear = data.shear_x.values[-1, 0]
    expected = cattaneo_shear(data.x.values, 1.0, P0, 0.3, C)
    assert root_mean_square(shear - expected) < 1e-3 * 0.3 * P0
    assert summary["stick_radius"] == close(C, abs=0.5 * 3.0 / 512)
    assert summary["slip_fraction"] == close(1.0 - C, abs=3.0 / 512)
    assert "shear_y" not in data  # what is along y has nothing to do with it
    assert summary["units"]["tangential_load"] == "N/m"
    assert summary["units"]["dissipated_energy"] == "J/m"


def test_stress_below_a_cylinder_in_partial_slip(fretted):
    data = fretted.dataset
    x, z, stress = data.section_x.values, data.section_z.values, data.section_stress.values[-1]
    for row, column in ((4, 130), (20, 256), (40, 400)):
        shear = lambda s: cattaneo_shear(s, 1.0, P0, 0.3, C)  # noqa: E731
        ends = (-1.0, -C, C, 1.0)
        expected = stress_under(lambda s: hertz_pressure(s, 1.0, P0), shear, x[column], z[row], ends)
        np.testing.assert_allclose(stress[[0, 2, 4], row, column], expected, rtol=0, atol=1e-4 * P0)
        assert stress[1, row, column] == close(NU * (stress[0, row, column] + stress[2, row, column]), rel=1e-9)


def test_tension_at_the_trailing_edge(fretted):
    """It falls with the root of the depth, which two depths extrapolate to the surface; the place along y is free."""
    xx = fretted.dataset.edge_stress.values[-1, 0]
    assert xx[0] == xx[1]
    assert 2.0 * xx[0] - xx[2] == close(trailing_edge_tension(P0, 0.3, SHARE), rel=0.04)


def test_largest_stress_below_a_cylinder():
    """Largest shear 0.300 p0 at 0.786 a and von Mises stress 0.558 p0 at 0.704 a, on the axis."""
    axis = {"shape": "line", "name": "axis", "start": [0, 0, 0.3], "end": [0, 0, 1.3], "count": 401}
    _, data = solved(255, stress=[axis])
    xx, _, zz = data.axis_stress.values[-1, :3]
    z = data.axis_z.values
    np.testing.assert_allclose([xx, zz], P0 * hertz_stress(0.0, z)[:2], rtol=0, atol=2e-4 * P0)
    shear, mises = 0.5 * np.abs(xx - zz) / P0, data.axis_von_mises.values[-1] / P0
    assert [shear.max(), z[shear.argmax()]] == close([0.30028, 0.786], rel=2e-3)
    assert [mises.max(), z[mises.argmax()]] == close([0.55752, 0.704], rel=4e-3)


def test_gross_slip_is_refused_with_its_unit():
    steps = [{"normal-load": P}, {"tangential-load-x": 1.01 * 0.3 * P}]
    with pytest.raises(SceneError, match=r"steps\.1\.tangential-load-x.* of at most 0\.235619 N/m"):
        ec.run(scene(64, **PAIR, friction=FRICTION, steps=steps))
    sliding = [{"normal-load": P}, {"sliding-distance": 0.1}]
    _, data = solved(64, **PAIR, friction=FRICTION, steps=sliding)
    np.testing.assert_allclose(data.shear_x.values[-1], 0.3 * data.pressure.values[-1], rtol=1e-12)


@pytest.mark.parametrize(("coupling", "moves"), [("none", False), ("one-way", True), ("full", True)])
def test_coupling_levels(coupling, moves):
    """Pressure drags the surface of a body on a rigid one inwards: the shear is odd, and zero without coupling."""
    numerics = {"coupling": coupling}
    _, data = solved(128, friction=FRICTION, steps=[{"normal-load": P, "increments": 4}], numerics=numerics)
    shear = data.shear_x.values[-1, 0]
    assert np.any(shear) == moves
    np.testing.assert_allclose(shear, -shear[::-1], rtol=0, atol=1e-6 * P0)


def test_a_shear_out_of_the_plane():
    """Antiplane partial slip has the zones of Cattaneo's problem: its kernel is a multiple of that along x."""
    steps = [{"normal-load": P}, {"tangential-load-y": SHARE * 0.3 * P}]
    summary, data = solved(256, **PAIR, friction=FRICTION, steps=steps)
    expected = cattaneo_shear(data.x.values, 1.0, P0, 0.3, C)
    assert root_mean_square(data.shear_y.values[-1, 0] - expected) < 2e-3 * 0.3 * P0
    assert summary["stick_radius"] == close(C, abs=3.0 / 256)


@pytest.mark.parametrize(("share", "mean"), [(0.2, 0.09549), (0.5, 0.5), (0.8, 0.90451)])
def test_a_wavy_surface_in_periodic_contact(share, mean):
    """Westergaard: mean pressure sin²(π a/λ) of that which flattens the wave."""
    n = 320
    grid = Grid(nx=n, ny=1, dx=1.0 / n, dy=1.0, line=True)
    coefficients = PairCoefficients(PressureLoad(), (Material(young_modulus=1 - NU**2, poisson_ratio=NU), None), "z")
    solver = NormalSolver(grid, coefficients, NormalOptions(tolerance=1e-8, periodic=True))
    height = 1e-3
    gap = height * (1.0 - np.cos(2 * np.pi * grid.x[None]))
    pressure = solver.solve(gap, Control(normal_load=mean * np.pi * height)).pressure
    assert np.mean(pressure > 0) == close(share, abs=1.01 / n)


def test_a_periodic_scene_is_a_line_contact_too():
    numerics = {"boundary": "periodic"}
    summary, _ = solved(256, 12.0, numerics=numerics)
    assert summary["max_pressure"] == close(P0, rel=0.02)


def test_approach_against_a_named_depth():
    """J. 5.56: a point at the depth d >> a, on the axis; and the load of that approach."""
    depth = 50.0
    summary, _ = solved(grid={"datum-depth": depth})
    expected = P / np.pi * (2.0 * np.log(2.0 * depth) - NU / (1.0 - NU))
    assert summary["approach"] == close(expected, rel=1e-3)
    back, _ = solved(grid={"datum-depth": depth}, steps=[{"approach": summary["approach"]}])
    assert back["normal_load"] == close(P, rel=1e-6)


def test_automatic_grids_and_units_of_a_scene():
    tables = ONE | {"geometry": CYLINDER, "steps": [{"normal-load": "1 N/mm"}], "grid": {"length": "infinite"}}
    tables["body1"] = {"young-modulus": "210 GPa", "poisson-ratio": NU}
    tables["geometry"] = {"type": "cylinder", "radius": "10 mm"}
    plan = ec.plan(ec.load_scene(tables))
    half = np.sqrt(4 * 1e3 * 0.01 / (np.pi * 210e9 / (1 - NU**2)))
    assert plan.grid.ny == 1
    assert plan.grid.line
    assert plan.grid.dx == close(half / 32, rel=0.05)
    text = ec.explain(ec.load_scene(tables))
    for words in ("line contact in plane strain", "normal-load 1 kN/m", "contact of half width", "strips of"):
        assert words in text
    summary = ec.run(ec.load_scene(tables, ["output.pictures=false"])).summary
    units = {"normal_load": "N/m", "contact_area": "m", "contact_radius": "m", "max_pressure": "Pa"}
    assert {name: summary["units"][name] for name in units} == units
    assert summary["contact_radius"] == close(half, rel=2e-3)
    assert summary["numbers"]["contact_radius"]["meaning"] == "half width of the contact"


REFUSALS = {
    "force": ({"steps": [{"normal-load": "400 N"}]}, r"normal-load must be a force per length \[N/m\]; a line contact"),
    "approach": ({"steps": [{"approach": 0.1}]}, "without grid.datum-depth .* set the depth"),
    "shift": ({"steps": [{"normal-load": P}, {"shift-x": 0.1}], "friction": FRICTION}, "without grid.datum-depth"),
    "tilt": ({"steps": [{"normal-load": P, "tilt-x": 0.1}]}, "must not prescribe tilt-x in a line contact"),
    "travel": ({"steps": [{"normal-load": P, "travel-y": 0.1}]}, "must not prescribe travel-y in a line contact"),
    "two sides": ({"grid": {"cells": [64, 2]}}, "one value of cells, that along x"),
    "centre": ({"grid": {"center": [0.0, 1.0]}}, "centred at y = 0"),
    "edge": ({"grid": {"size": 1.5}}, "its edge along x; the window is 1.5 m"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_refusals(name):
    tables, words = REFUSALS[name]
    with pytest.raises((SceneError, DomainTooSmall), match=words):
        ec.run(scene(64, **tables))


def test_forces_per_length_belong_to_line_contacts():
    tables = scene(64)
    tables["grid"] = {"cells": 64, "size": 3.0}
    tables["steps"] = [{"normal-load": "400 N/mm"}]
    with pytest.raises(SceneError, match=r"a force \[N\]; only a line contact is loaded per length: set grid.length"):
        ec.load_scene(tables)
    tables["grid"]["datum-depth"] = 1.0
    with pytest.raises(SceneError, match="datum-depth must be left out unless length = 'infinite'"):
        ec.load_scene(tables | {"steps": [{"normal-load": 1.0}]})


def test_an_influence_without_strips_is_refused_by_name():
    class Rectangles(SurfaceInfluence):
        key, traction = "rectangles-only", "p"

        def displacement(self, *_):
            raise NotImplementedError

        stress = displacement

    with pytest.raises(PlanError, match=r"influence 'rectangles-only' .* it has no strips"):
        _refuse_without_strips([Rectangles()])


def test_wear_is_a_worn_area():
    """Gross slip by a distance: the worn area is the wear coefficient times load and path."""
    wear = {"type": "archard", "coefficient": 1e-4, "hardness": 1.0}
    steps = [{"normal-load": P}, {"sliding-distance": 10.0, "increments": 2}]
    summary, _ = solved(128, steps=steps, friction=FRICTION, **PAIR, wear=wear)
    assert summary["units"]["worn_volume"] == "m2"
    assert summary["worn_volume"] == close(1e-4 * P * 10.0, rel=1e-6)


def test_the_middle_of_a_long_cylinder_is_a_line_contact():
    """Its sharp ends take more than their part; the middle has the line contact of the load that it bears itself."""
    length, cells = 16.0, (48, 36)
    tables = scene(steps=[{"normal-load": P * length}], geometry=CYLINDER | {"length": length})
    tables["grid"] = {"cells": cells, "size": [3.0, length + 2.0]}
    tables["numerics"] = {"tolerance": 1e-6, "allow-coarse": True}
    row = ec.run(tables).dataset.pressure.values[-1, cells[1] // 2]
    _, data = solved(cells[0], steps=[{"normal-load": float(row.sum()) * 3.0 / cells[0]}])
    np.testing.assert_allclose(row, data.pressure.values[-1, 0], rtol=0, atol=5e-3 * row.max())


@pytest.mark.slow
def test_the_middle_of_a_long_cylinder_is_a_line_contact_of_its_load_there():
    """The profile across tends to that of plane strain as (a / length)^2; the load in the middle only as 1 / ln."""
    steel, load, radius, nx = ec.HalfSpace(210e9, 0.3), 400e3, 10e-3, 32
    a, p0 = hertz_cylinder(load, radius, 210e9 / 0.91)
    dx, ratios, errors, shares = 3.1 * a / nx, (8, 16, 32, 64), [], []
    for ratio in ratios:
        length, rows = ratio * a, 8 * ratio + 1  # of the straight part; eight rows beyond it stay free
        long = ec.solve_contact(
            ec.make("cylinder", radius=radius, length=length), steel, load=load * length, cells=(nx, rows + 8),
            spacing=(dx, length / rows), numerics={"tolerance": 1e-9},
        )  # fmt: skip
        middle = long.pressure[(rows + 8) // 2]
        share = float(middle.sum()) * dx / load
        plane = ec.solve_contact(
            ec.make("cylinder", radius=radius), steel, load=share * load, cells=nx, spacing=dx, length="infinite",
            numerics={"tolerance": 1e-11},
        )  # fmt: skip
        errors.append(float(np.abs(middle - plane.pressure[0]).max()) / p0)
        shares.append(share)
    order = -np.polyfit(np.log(ratios), np.log(errors), 1)[0]
    assert abs(order - 2.05) < 0.15
    assert errors[-1] < 1e-4
    assert shares == sorted(shares)
    assert 0.85 < shares[-1] < 0.95
