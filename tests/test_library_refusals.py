"""Calls from Python with values that make no sense: field, rule and value in our words, never NumPy's."""

from fractions import Fraction

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL
from eigencontact.plugin import Grid, Material, real_array

BALL = ec.make("sphere", center=(0.0, 0.0, 2.0), radius=1.0)
SWELLING = 1e-3 * np.eye(3)
POINT = [[0.0, 0.0, 1.0]]

#: Arrays that are none of real numbers, and a word of the refusal.
NO_ARRAYS = {
    "text": ("x", "text"),
    "texts": ([["0", "0", "1"]], "text"),
    "bytes": (b"abc", "bytes"),
    "nothing": (None, "objects"),
    "table": ({"x": 1}, "objects"),
    "complex": ([[0, 0, 1 + 0j]], "complex numbers"),
    "complex array": (np.zeros((1, 3), dtype=complex), "complex numbers"),
    "booleans": ([[True, False, True]], "booleans"),
    "masked": (np.ma.array(POINT, mask=[[True, False, False]]), "1 masked"),
    "ragged": ([[0, 0, 1], [0, 0]], "no one shape"),
    "objects": ([[0, 0, object()]], "objects"),
    "times": (np.zeros((1, 3), dtype="M8[s]"), "datetime64"),
    "too large": ([[10**400, 0, 1]], "objects"),
    "a function": (lambda: 0, "objects"),
}
CALLS = {
    "inclusion_field.points": lambda value: ec.inclusion_field(BALL, SWELLING, value, **STEEL),
    "inclusion_field.eigenstrain": lambda value: ec.inclusion_field(BALL, value, POINT, **STEEL),
    "rectangle_field.traction": lambda value: ec.rectangle_field(value, (1.0, 1.0), POINT, **STEEL),
    "rectangle_field.half_widths": lambda value: ec.rectangle_field((0, 0, 1.0), value, POINT, **STEEL),
    "rectangle_field.points": lambda value: ec.rectangle_field((0, 0, 1.0), (1.0, 1.0), value, **STEEL),
}


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("case", NO_ARRAYS)
def test_arrays_of_anything_but_real_numbers_are_refused(case, call):
    value, word = NO_ARRAYS[case]
    with pytest.raises(ec.EigencontactError) as caught:
        CALLS[call](value)
    assert str(caught.value).startswith(f"{call} must be ")
    assert word in str(caught.value)


WRONG_SHAPES = [3.0, [], [[]], [1.0, 2.0, 3.0, 4.0], [[1.0, 2.0]], np.zeros((2, 2, 3)), np.zeros((0, 4))]


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("value", WRONG_SHAPES, ids=[str(np.shape(value)) for value in WRONG_SHAPES])
def test_wrong_shapes_are_refused(value, call):
    if np.ndim(value) == 0 and call == "inclusion_field.eigenstrain":
        same = 3.0 * np.eye(3)
        assert np.array_equal(CALLS[call](value), CALLS[call](same))  # one number is the same along all axes
        return
    with pytest.raises(ec.EigencontactError, match=rf"^{call} must be "):
        CALLS[call](value)


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e308])
def test_values_that_cannot_be_reckoned_with_are_refused(bad, call):
    shapes = {"points": (1, 3), "eigenstrain": (3, 3), "traction": (3,), "half_widths": (2,)}
    with pytest.raises(ec.EigencontactError, match=rf"^{call} must be "):
        CALLS[call](np.full(shapes[call.split(".")[1]], bad))


def test_numbers_of_any_real_kind_are_taken():
    for value in (
        [[0, 0, 1]],
        np.array(POINT, dtype=np.float16),
        [[Fraction(0), 0, np.float32(1)]],
        np.ma.array(POINT),
    ):
        assert real_array(value, "here", "points", "numbers").dtype == np.float64
        np.testing.assert_array_equal(real_array(value, "here", "points", "numbers"), POINT)


@pytest.mark.parametrize("bad", [None, "210 GPa", True, [1.0, 2.0], np.ones(2), 1j, np.nan, 0.0, -1.0, 1e308, 10**400])
@pytest.mark.parametrize("name", ["young_modulus", "poisson_ratio"])
def test_constants_that_are_no_numbers_are_refused(name, bad):
    if name == "poisson_ratio" and isinstance(bad, float) and bad == 0.0:
        bad = -np.inf
    for call in (
        lambda constants: Material(**constants),
        lambda constants: ec.rectangle_field((0, 0, 1.0), (1.0, 1.0), POINT, **constants),
        lambda constants: ec.inclusion_field(BALL, SWELLING, POINT, **constants),
    ):
        with pytest.raises(ec.EigencontactError, match=rf"^material\.{name} must be "):
            call(STEEL | {name: bad})


@pytest.mark.parametrize("bad", [None, 3, ["stress"], np.ones(3), {}, "strane"])
def test_choices_that_are_none_are_refused(bad):
    for name in ("quantity", "space"):
        with pytest.raises(ec.EigencontactError, match=rf"^inclusion_field\.{name} must be "):
            ec.inclusion_field(BALL, SWELLING, POINT, **STEEL, **{name: bad})
    with pytest.raises(ec.EigencontactError, match=r"^rectangle_field\.quantity must be "):
        ec.rectangle_field((0, 0, 1.0), (1.0, 1.0), POINT, quantity=bad, **STEEL)
    if bad is not None:
        with pytest.raises(ec.EigencontactError, match=r"^make\.kind must be "):
            ec.make("sphere", kind=bad, radius=1.0)


@pytest.mark.parametrize("bad", [0, -1, 2.5, "16", True, None, [16]])
def test_counts_that_are_none_are_refused(bad):
    with pytest.raises(ec.EigencontactError, match=r"^inclusion_field\.cells must be a whole number, 1 or more"):
        ec.inclusion_field(BALL, SWELLING, POINT, cells=bad, **STEEL)
    with pytest.raises(ec.EigencontactError, match=r"^grid\.nx must be a whole number"):
        Grid(nx=bad, ny=1, dx=1.0, dy=1.0)


@pytest.mark.parametrize("bad", [None, 3, [1, 2], {}, object(), b"hertz"])
def test_sources_and_folders_that_are_none_are_refused(bad):
    if not isinstance(bad, dict):
        for call in (ec.load_scene, ec.plan, ec.explain, ec.run):
            with pytest.raises(ec.EigencontactError, match=r"^scene must be a TOML file, the name of a bundled scene"):
                call(bad)
    with pytest.raises(ec.EigencontactError, match=r"^results must be a file or folder \(got "):
        ec.open_results(bad)
    with pytest.raises(ec.EigencontactError, match=r"^make\.key must be the name of a plugin \(got "):
        ec.make(bad)
    if bad is not None:
        with pytest.raises(ec.EigencontactError, match=r"^folder must be a path, or None"):
            ec.run("hertz", bad)


@pytest.mark.parametrize("bad", ["steps.normal-load=1", 3, [3], [None]])
def test_changes_that_are_none_are_refused(bad):
    with pytest.raises(ec.EigencontactError, match=r"key=value"):
        ec.load_scene("hertz", bad)


def test_a_zero_in_a_path_is_refused():
    for call in (ec.load_scene, ec.open_results):
        with pytest.raises(ec.EigencontactError):
            call("a\0b.toml")
    quick = ["stress=[]", "grid.cells-per-contact-radius=4", "output.pictures=false", "output.vtk=false"]
    with pytest.raises(ec.EigencontactError, match=r"must be a folder that can be written"):
        ec.run(ec.load_scene("hertz", quick), "a\0b")


SHAPES = {
    "sphere": BALL,
    "cuboid": ec.make("cuboid", center=(0, 0, 2), edges=(1, 1, 1)),
    "ellipsoid": ec.make("ellipsoid", kind="inclusion-shape", center=(0, 0, 2), semi_axes=(1, 1, 0.5)),
    "cylinder": ec.make("cylinder", kind="inclusion-shape", center=(0, 0, 2), radius=1, length=1),
    "layer": ec.make("layer", size=(1, 1), thickness=1),
}


@pytest.mark.parametrize("key", SHAPES)
@pytest.mark.parametrize("case", NO_ARRAYS)
def test_shapes_hold_real_points_only(case, key):
    value, word = NO_ARRAYS[case]
    with pytest.raises(ec.EigencontactError, match=rf"^{key}\.y must be coordinates \[m\]") as caught:
        SHAPES[key].contains(0.0, value, 1.0)
    assert word in str(caught.value)


def test_other_functions_of_place_take_real_points_only():
    for values in (np.zeros(2, dtype=complex), np.ma.array([0.0, 1.0], mask=[0, 1])):
        with pytest.raises(ec.EigencontactError, match=r"^separation\.x must be coordinates"):
            ec.make("sphere", radius=1.0).separation(values, 0.0)
        with pytest.raises(ec.EigencontactError, match=r"^uniform\.z must be coordinates"):
            ec.make("uniform", value=1.0).eigenstrain(0.0, 0.0, values, 1.0)
    with pytest.raises(
        ec.EigencontactError, match=r"^cuboid: coordinates must be of shapes that broadcast .*\(2,\), \(3,\)"
    ):
        SHAPES["cuboid"].contains(np.zeros(2), np.zeros(3), 0.0)


@pytest.mark.parametrize("key", SHAPES)
def test_points_at_infinity_lie_outside_and_missing_ones_nowhere(key):
    assert not SHAPES[key].contains(np.array([np.nan, 0.0]), np.array([0.0, np.nan]), np.array([1.0, 1.0])).any()
