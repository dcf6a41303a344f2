"""Precision chosen by the plan: where the tolerance allows single, what it costs in accuracy, and where it is told."""

import json

import numpy as np
import pytest

from eigencontact import app
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.precision import plane_round_off, settled, volume_round_off
from eigencontact.execution.routes.subsurface import Subsurface
from eigencontact.model.sources import Lattice
from eigencontact.scene.schema import Numerics
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.eigenstrain import VolumeField

SECTION = ["observers=[]", "output.pictures=false", "output.vtk=false"]
HERTZ = ["grid.cells-per-contact-radius=16", *SECTION]
VOID = [
    "grid.cells-per-contact-radius=10",
    "stress.depth-cells=6",
    "numerics.allow-coarse=true",
    "numerics.inclusion-resolution=cells",
    *SECTION,
]
PLASTIC = ["grid.cells-per-contact-radius=6", *SECTION]
FRICTION = ["grid.cells-per-contact-radius=12", "stress=[]", *SECTION]

CONTACT, STRESS, MEANS = "contact", "stress by tractions", "mean stress in cells of body 1"


def planned(scene, changes, precision, tolerance):
    numerics = [f"numerics.precision={precision}", f"numerics.tolerance={tolerance}"]
    return app.plan(app.load_scene(scene, [*changes, *numerics]))


@pytest.mark.parametrize(
    ("scene", "changes", "tolerance", "single", "double"),
    [
        ("hertz", HERTZ, 1e-4, {CONTACT, STRESS}, set()),
        ("hertz", HERTZ, 1e-6, {STRESS}, {CONTACT}),
        ("hertz", HERTZ, 1e-8, set(), {CONTACT, STRESS}),
        ("void-near-surface", VOID, 1e-4, {CONTACT, MEANS, STRESS, "stress by cells"}, set()),
        ("void-near-surface", VOID, 1e-5, {STRESS, "stress by cells"}, {CONTACT, MEANS}),
        # plasticity begins at the surface: powers of the depth lose digits in the sum over the volume
        ("plastic-hertz", PLASTIC, 1e-5, {STRESS, "stress by cells"}, {CONTACT, MEANS, "stress by cells, in space"}),
    ],
)
def test_single_is_taken_where_the_tolerance_allows_it(scene, changes, tolerance, single, double):
    found = planned(scene, changes, "auto", tolerance).precisions
    assert {one.operator for one in found if one.chosen == "single"} == single
    assert {one.operator for one in found if one.chosen == "double"} == double
    assert all((one.round_off <= one.bound) == (one.chosen == "single") for one in found)


@pytest.mark.parametrize(
    ("scene", "changes", "tolerance", "names"),
    [
        ("hertz", HERTZ, 1e-4, ("pressure", "section_stress")),
        ("hertz", HERTZ, 1e-6, ("section_stress",)),
        ("cattaneo-mindlin", FRICTION, 1e-4, ("pressure", "shear_x")),
        pytest.param(
            "void-near-surface", VOID, 1e-4, ("pressure", "section_stress", "equivalent_eigenstrain_1"),
            marks=pytest.mark.slow,
        ),
    ],
)  # fmt: skip
def test_the_error_against_double_is_below_the_tolerance(scene, changes, tolerance, names):
    double, auto = (app.run(planned(scene, changes, word, tolerance)).dataset for word in ("double", "auto"))
    for name in names:
        error = float(np.abs(auto[name] - double[name]).max() / np.abs(double[name]).max())
        assert 1e-9 < error < tolerance, name


@pytest.mark.parametrize("scene", ["wear-gross-sliding", "coating-worn-through", "coated-fretting", "prestressed-bars"])
def test_every_part_of_a_plan_knows_what_it_computes_in(scene):
    assert planned(scene, [], "auto", 1e-5).precisions


def test_what_the_scene_says_is_not_chosen():
    for word in ("double", "single"):
        plan = planned("hertz", HERTZ, word, 1e-4)
        assert plan.precisions == []
        assert f"{word} precision" in plan.explain()


def test_plan_and_results_say_what_is_used(tmp_path):
    plan = planned("hertz", HERTZ, "auto", 1e-6)
    words = plan.explain()
    assert "precision by operator" in words
    assert "contact double (round-off of single, " in words
    assert "stress by tractions single (round-off of single, " in words
    chosen = {one["operator"]: one["chosen"] for one in plan.to_dict()["precisions"]}
    result = app.run(plan, tmp_path / "run")
    assert chosen == result.summary["precisions"] == {CONTACT: "double", STRESS: "single"}
    assert json.loads((tmp_path / "run" / "summary.json").read_text())["precisions"] == chosen
    assert json.loads(result.dataset.attrs["precisions"]) == chosen


def test_a_scene_without_an_operator_to_choose_for_is_in_double():
    plan = app.plan(app.load_scene("buried-cuboid", ["numerics.precision=auto"]))
    assert plan.precisions == []
    assert "double precision" in plan.explain()


def test_other_words_are_refused_with_the_choices():
    with pytest.raises(SceneError, match=r"numerics\.precision must be .*'double', 'single' or 'auto'.*got 'half'"):
        app.load_scene("hertz", ["numerics.precision=half"])


@pytest.mark.parametrize(("first", "layers"), [(0, 6), (0, 16), (12, 8)])
def test_round_off_that_is_measured_is_that_of_the_operator(first, layers):
    """On a stand-in of few columns, against boxes of more of them and another eigenstrain."""
    half_space = Subsurface.of(planned("void-near-surface", VOID, "double", 1e-6).model, 1).half_space
    options, grid = half_space.options("stress"), half_space.grid
    lattice = Lattice(first=(first, 3, 4), shape=(layers, 20, 24), edges=(grid.dx, grid.dy, grid.dx))
    measured = volume_round_off(half_space, "stress", (grid.dx, grid.dy), lattice)
    cells = Cells(first=(0.0, 0.0, (first + 0.5) * grid.dx), pitch=(grid.dx, grid.dy, grid.dx), shape=(layers, 20, 24))
    strain = np.random.default_rng(7).standard_normal((6, *cells.shape))
    double, single = (
        VolumeField(half_space.cell, cells, cells, precision=word, **options).apply(strain)
        for word in ("double", "single")
    )
    error = float(np.abs(single - double).max() / np.abs(double).max())
    assert 0.25 < error / measured < 4.0


def test_round_off_of_single_precision():
    assert 3e-8 < plane_round_off() < 1e-6
    numerics = Numerics(precision="auto", tolerance=1e-3)
    for share, chosen in ((1.0, "single"), (0.1, "double")):
        found, (why,) = settled(numerics, "it", lambda: 1e-4, share=share)
        assert found.precision == why.chosen == chosen
    assert settled(numerics, "it", lambda: None) == (Numerics(precision="double", tolerance=1e-3), ())
