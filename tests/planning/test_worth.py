"""What a plan says of its own worth: cells that show no contact are refused, few cells and slips of units told."""

from importlib.resources import files

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.errors import SceneError
from eigencontact.model.resolution import pressure_error
from eigencontact_verification.oracles.hertz import hertz_sphere

BALL = {"type": "sphere", "radius": 105e-6}
A, P0, _ = hertz_sphere(0.65, 105e-6, 210e9 / (1 - 0.3**2))
COARSE = "numerics.allow-coarse=true"


def hertz(cells, size, *changes):
    return ec.load_scene("hertz", ["stress=[]", f"grid={{cells={cells}, size=[{size!r}, {size!r}]}}", *changes])


def codes(cautions):
    return [caution.code for caution in cautions]


def test_a_contact_that_cells_cannot_show_is_refused_with_its_error():
    with pytest.raises(SceneError) as refusal:
        ec.plan(hertz(12, 1e-3))
    words = str(refusal.value)
    assert "grid must have at least 2 cells to a radius of the contact (got 0.073: cells of 83.333 um for an" in words
    assert "the largest pressure may be wrong by 100 %" in words
    assert 'grid = "auto", or numerics.allow-coarse = true' in words


def test_it_is_solved_where_the_scene_allows_it_and_says_so():
    planned = ec.plan(hertz(12, 1e-3, COARSE))
    assert codes(planned.cautions) == ["contact-cells"]
    summary = ec.run(planned).summary
    assert summary["max_pressure"] < 0.05 * P0
    (warning,) = summary["warnings"]
    assert warning["code"] == "contact-cells"
    assert warning["error"] == close(1.0, rel=1e-12)
    assert "0.073 cells per radius" in warning["words"]


def test_an_automatic_grid_is_never_that_coarse():
    with pytest.raises(SceneError, match=r"at least 2 cells to a radius of the contact \(got 1: "):
        ec.plan(ec.load_scene("hertz", ["grid.cells-per-contact-radius=1"]))


def test_a_contact_far_from_the_middle_of_a_wide_window_is_seen_as_small():
    """The coarse look over the window sees one of 48 cells; a close look tells the radius."""
    away = "geometry.center=[3e-4, -1e-4]"
    expected = ec.plan(hertz(400, 1e-3, away, COARSE)).model.window.expected
    assert 0.5 * expected.extent[0] == close(A, rel=0.02)
    assert expected.peak == close(P0, rel=0.02)
    with pytest.raises(SceneError, match="at least 2 cells"):
        ec.plan(hertz(200, 1e-3, away))
    assert codes(ec.plan(hertz(400, 1e-3, away)).cautions) == ["contact-cells"]
    assert codes(ec.plan(hertz(1400, 1e-3, away)).cautions) == []


@pytest.mark.parametrize(
    "radius", [3, pytest.param(5, marks=pytest.mark.slow), pytest.param(12, marks=pytest.mark.slow)]
)
def test_the_estimated_error_bounds_that_of_hertz(radius):
    """At places all over a cell; the bound is within a factor of two of the worst."""
    h, worst = A / radius, 0.0
    cells = 2 * int(1.5 * radius) + 6
    for x, y in ((0.0, 0.0), (0.5, 0.5), (0.5, 0.0), (0.2, -0.3), (0.1, 0.4), (0.3, 0.35)):
        scene = hertz(cells, cells * h, f"geometry.center=[{x * h!r}, {y * h!r}]", "output.pictures=false")
        worst = max(worst, abs(ec.run(scene).summary["max_pressure"] / P0 - 1.0))
    assert worst < pressure_error(radius) < 2.0 * worst


@pytest.mark.parametrize(
    "more", [{"eigenstrain": 1e-3, "type": "cylinder", "length": 8e-6, "axis": "x"}, {"material": {"void": True}}]
)
def test_a_region_narrower_than_a_cell_is_refused(more):
    """Between the centres of cells it would fill none."""
    region = {"type": "sphere", "center": [0, 0, 3e-6], "radius": 0.4e-6, **more}
    scene = {"body1": STEEL, "inclusions": [region], "grid": {"cells": 16, "size": [16e-6, 16e-6]}}
    with pytest.raises(SceneError, match=r"must have at least 1 cell across its narrowest extent \(got 0.8 of 1 um"):
        ec.plan(scene)
    ec.plan({**scene, "numerics": {"allow-coarse": True}})


def test_the_sizes_understood_are_said_in_units_that_show_a_slip():
    words = ec.plan("hertz").explain()
    assert "geometry    sphere, radius 105 um\n" in words
    assert "load        1 step, at most normal-load 650 mN\n" in words
    assert "expected    contact of radius 6." in words
    assert "pressure up to 8." in words
    assert "GPa, 65.3 cells to a radius" in words
    assert "window      21.596 um x" in words
    assert "warnings" not in words
    slipped = ec.plan(ec.load_scene("hertz", ["geometry.radius=105"])).explain()
    assert "sphere, radius 105 m\n" in slipped
    assert "kPa" in slipped.split("expected")[1]
    data = ec.plan("hertz").to_dict()
    assert data["warnings"] == []
    assert data["expected"]["max_pressure"] == close(P0, rel=0.02)


def test_a_contact_of_two_sides_says_both():
    assert "expected    contact of sides 45." in ec.plan("hertz-ellipse").explain()


def test_strains_that_are_not_small_are_told():
    planned = ec.plan(ec.load_scene("hertz", ["stress=[]", "steps.normal-load=650", "grid.cells-per-contact-radius=8"]))
    assert codes(planned.cautions) == ["small-strain"]
    assert "check the units of load" in planned.explain().split("warnings")[1]
    assert planned.to_dict()["warnings"][0]["code"] == "small-strain"


@pytest.mark.parametrize(("cells", "told"), [(256, False), (250, True)])
def test_cells_wider_than_the_points_of_a_surface_are_told(cells, told):
    planned = ec.plan(ec.load_scene("random-rough", [f"grid={{cells={cells}, size='64 um'}}"]))
    assert codes(planned.cautions) == ["surface-cells"] * told
    words = "cells of 256 nm are wider than the spacing 250 nm of the geometry 'random-rough'"
    assert (words in "".join(caution.words for caution in planned.cautions)) == told


@pytest.mark.parametrize(
    ("outside", "cells", "told"), [("far", 128, True), ("mirror", 128, True), ("mirror", 256, False)]
)
def test_a_measured_surface_that_does_not_fit_to_its_repetition_is_told(outside, cells, told):
    """A mirrored one has twice the window for its period."""
    table = f"{{type='topography', file='gallery:rough_surface.npz', outside='{outside}'}}"
    changes = [f"geometry=[{table}]", "numerics.boundary=periodic", f"grid={{cells={cells}, spacing='0.5 um'}}"]
    planned = ec.plan(ec.load_scene("rough-surface", changes))
    assert codes(planned.cautions) == ["periodic-seam"] * told
    with np.load(files("eigencontact") / "gallery" / "rough_surface.npz") as bundled:
        heights = bundled["heights"]
    step = 1e9 * np.sqrt(np.mean((heights[0] - heights[-1]) ** 2))
    along = 1e9 * max(np.sqrt(np.mean((heights[n] - heights[n - 1]) ** 2)) for n in (1, -1))
    assert all(f"a step of {step:.5g} nm" in caution.words for caution in planned.cautions)
    assert all(f"along y, but only {along:.5g} nm between" in caution.words for caution in planned.cautions)


@pytest.mark.parametrize(("cells", "told"), [(1.9, True), (2.0, False)])
def test_a_length_of_few_cells_is_told(cells, told):
    cell = 1.5e-3
    scene = ec.load_scene("concrete-bars-damage", [f"body1.law.damage.length={cells * cell!r}"])
    found = [caution for caution in ec.plan(scene).cautions if caution.code == "law-length"]
    assert len(found) == told
    assert not told or "is 1.9 cells, fewer than 2" in found[0].words


@pytest.mark.parametrize(("material", "told"), [("j2", True), ("isotropic", False)])
def test_a_ball_that_yields_by_its_own_law_in_a_body_that_yields_is_told_by_number(material, told):
    steel = "young-modulus='210 GPa', poisson-ratio=0.3"
    law = f"type='j2', {steel}, hardening={{type='perfect', yield-stress='3.7 GPa'}}" if material == "j2" else steel
    changes = ["grid.cells-per-contact-radius=5", "numerics.inclusion-pitch='3 um'", "stress=[]"]
    planned = ec.plan(ec.load_scene("hard-inclusion-in-plastic-matrix", [*changes, f"inclusions.0.material={{{law}}}"]))
    found = [caution for caution in planned.cautions if caution.code == "law-regions"]
    assert len(found) == told
    if told:
        assert "'ball' has its own yield law in a body that yields" in found[0].words
        radius, edge = (
            0.25 * sum(planned.model.window.expected.extent),
            max(planned.model.cells.inhomogeneities[0].lattice.edges),
        )
        assert 4.5 < radius / edge < 6.0
        assert found[0].error == close(1.8 * edge / radius, rel=1e-12)


def test_few_increments_are_told_where_shear_follows_from_pressure():
    for spacing, error in (("even", 0.09), ("radius", 0.265)):
        few = ec.plan(ec.load_scene("fretting-mode-2", ["steps.increments=2", f"steps.spacing={spacing}"]))
        (caution,) = few.cautions
        assert caution.code == "load-steps"
        assert caution.error == close(error, rel=1e-12)
    assert ec.plan("fretting-mode-2").cautions == ()


def test_few_increments_of_a_later_loading_from_nothing_are_told_too():
    steps = "[{normal-load=1, increments=8}, {cycle=[{normal-load=0}, {normal-load=1, increments=2}], repeat=2}]"
    (caution,) = ec.plan(ec.load_scene("fretting-mode-2", [f"steps={steps}"])).cautions
    assert "the contact grows in 2 increments in steps.1.cycle.1, " in caution.words


def test_a_load_that_turns_within_one_increment_is_told():
    few = ec.plan(ec.load_scene("fretting-mode-1", [f"steps.{n}.increments=1" for n in (1, 2)]))
    assert [c.words[:37] for c in few.cautions if "reverses" in c.words] == ["steps.2 reverses the tangential motio"]


@pytest.mark.parametrize(
    "name", ["hertz", "hertz-ellipse", "gross-slip", "two-inclusions", "inclusion-cluster", "rough-surface"]
)
def test_bundled_scenes_are_free_of_warnings(name):
    assert ec.plan(name).cautions == ()
    assert np.isfinite(ec.plan(name).model.window.expected.peak)


def test_a_void_in_cells_with_two_cells_above_it_says_so():
    (caution,) = ec.plan(ec.load_scene("void-near-surface", ["numerics.inclusion-resolution=cells"])).cautions
    assert caution.words.startswith("'void' has 2 cells between its top and the surface")
