"""What a plan says of a scene that wears before it runs, and what a run says of its own worth afterwards."""

import re

import pytest

import eigencontact as ec
from bodies import rubbed
from close import close
from eigencontact.core.units import readable
from eigencontact.model.resolution import percent

PRESSED = {"normal-load": "0.65 N"}
CYCLE = [{"shift-x": "60 nm"}, {"shift-x": "-60 nm", "increments": 2}, {"shift-x": 0.0}]
ENERGY = {"type": "dissipated-energy", "coefficient": "5 mm^3/J"}


def scene(wear, steps, **changes):
    grid = {"cells": 12, "size": ["15 um", "15 um"]}
    return ec.load_scene(rubbed(**{"wear": wear, "grid": grid, "steps": steps, **changes}))


def cycles(repeat):
    return [PRESSED, {"cycle": CYCLE, "repeat": repeat}]


# table of wear beside its law, repeats, lines that explain them
LINES = [
    ({}, 5000, ["wear        body 1: dissipated-energy, coefficient 5 mm^3/J",
                "            the surface moves at the end of each cycle, implicit in the pressure",
                "      5000 cycles, about 29 of them solved, for an error of the worn volume of at most 1 %"]),
    ({"jump-error": 0.1}, 5000, ["about 16 of them solved, for an error of the worn volume of at most 10 %"]),
    ({"cycles-per-update": 100}, 5000, ["            5000 cycles, 53 of them solved: one for 100 cycles"]),
    ({"shares": {"body1": 0.7, "body2": 0.3}}, 2,
     ["wear        body 1 by 0.7 of the depth and body 2 by 0.3 of the depth: dissipated-energy, ",
      "            2 cycles, all of them solved"]),
    ({"body": 2, "update": "increment"}, 2, ["wear        body 2: ", "the surface moves by each increment, impli"]),
    ({"type": "threshold-energy", "threshold": "2 kJ/m^2"}, 2,
     ["threshold-energy, coefficient 5 mm^3/J, threshold 2 kJ/m^2", "in the pressure, linearised"]),
]  # fmt: skip


@pytest.mark.parametrize(("table", "repeat", "lines"), LINES)
def test_explain_says_what_wears_and_how(table, repeat, lines):
    text = ec.plan(scene(ENERGY | table, cycles(repeat))).explain()
    for line in lines:
        assert line in text
    assert ("load        about" in text) == ("about" in "".join(lines))
    assert "  wear: body" in text
    assert "and what has worn" in text


def test_explain_without_wear_says_nothing_of_it():
    text = ec.plan(scene(None, cycles(3))).explain()
    assert "wear" not in text
    assert "worn" not in text
    assert "load        13 steps" in text


def test_what_wear_leaves_out():
    left = {item.effect: item.reason for item in ec.plan(scene(ENERGY, cycles(5000))).left_out}
    assert "debris, a third body and transfer" in left
    assert "slopes of the worn surfaces" in left
    assert "about 4971 of 5000 cycles" in left
    fewer = ec.plan(scene(ENERGY | {"cycles-per-update": 100}, cycles(5000)))
    assert "4947 of 5000 cycles" in {item.effect for item in fewer.left_out}
    assert not [item for item in ec.plan(scene(ENERGY, cycles(2))).left_out if "cycles" in item.effect]


def test_predicted_time_follows_the_cycles_that_are_solved():
    few, many = (ec.plan(scene(ENERGY, cycles(repeat))) for repeat in (10, 10**6))
    assert many.steps == 1 + 4 * 43
    assert many.seconds / few.seconds == close(many.steps / few.steps, rel=0.5)
    assert set(few.to_dict()["scene"]["wear"]) >= {"type", "coefficient", "update"}


def test_units_of_laws_are_readable():
    assert readable(2e6, "J/m^2") == "2 MJ/m^2"
    assert readable(1e-18, "m^3/J") == "1 um^3/J"
    assert readable(1e-13, "1/Pa") == "1e-13 1/Pa"


def warnings(wear, steps, **changes):
    return {one["code"]: one["words"] for one in ec.run(scene(wear, steps, **changes)).summary["warnings"]}


BLUNT = {"geometry": {"type": "sphere", "radius": "20 um"}, "friction": None}
SLIDE = PRESSED | {"sliding-distance": "1 mm", "increments": 10}


def test_depths_beyond_small_slopes_are_said_with_where_they_begin():
    """A ball of 20 um wears by a tenth of the contact's radius a where a^2 / 2 R is a / 10, at 400 nm.

    The contact is flattened before it wears: it is somewhat larger.
    """
    wide = BLUNT | {"grid": {"cells": 16, "size": ["16 um", "16 um"]}}
    deep = warnings({"type": "archard", "coefficient": 6e-14}, [PRESSED, SLIDE], **wide)
    (depth,) = re.findall(r"on it exceeds ([\d.]+) nm, ", deep["worn-slopes"])
    assert 400 < float(depth) < 600
    assert "10 % of the contact radius" in deep["worn-slopes"]
    assert "worn-slopes" not in warnings({"type": "archard", "coefficient": 6e-16}, [PRESSED, SLIDE], **wide)


def test_a_contact_that_wears_towards_the_edge_of_the_window_is_said():
    tight = BLUNT | {"grid": {"cells": 16, "size": ["12 um", "12 um"]}}
    told = warnings({"type": "archard", "coefficient": 3.5e-14}, [PRESSED, SLIDE], **tight)["worn-window"]
    assert "the worn contact ends 1 cell before the edge of the window" in told
    assert "worn-window" not in warnings({"type": "archard", "coefficient": 1e-16}, [PRESSED, SLIDE], **tight)


@pytest.mark.slow
def test_jumps_of_a_given_size_that_are_too_large_are_said():
    wear = {"type": "dissipated-energy", "coefficient": "1e-2 mm^3/J"}
    told = warnings(wear | {"cycles-per-update": 30}, cycles(70))
    assert "the estimated error of the worn volume is " in told["wear-jumps"]
    assert "; set a smaller wear.cycles-per-update, or wear.jump-error" in told["wear-jumps"]
    assert "wear-jumps" not in warnings(wear | {"jump-error": 0.1}, cycles(70))


def test_explain_of_a_step_that_slides_along_a_direction():
    made = scene({"type": "archard", "coefficient": 1e-16}, [PRESSED, SLIDE | {"sliding-direction": "y"}], **BLUNT)
    assert "sliding-distance 1 mm" in ec.plan(made).explain()


SHIFTED = {
    "body1": {"young-modulus": 210e9, "poisson-ratio": 0.3}, "geometry": {"type": "sphere", "radius": 200e-6},
    "friction": {"type": "coulomb", "coefficient": 0.5}, "wear": {"type": "dissipated-energy", "coefficient": 2e-12},
    "grid": {"cells-per-contact-radius": 10}, "numerics": {"coupling": "none"},
}  # fmt: skip


def shifted(**last):
    return ec.plan({**SHIFTED, "steps": [{"normal-load": 12.307}, last]})


@pytest.mark.parametrize(("along", "shift", "told"), [("x", 3e-6, True), ("y", -3e-6, True), ("x", 1.8e-6, False)])
def test_a_shift_that_is_not_small_beside_the_contact_is_told_by_number(along, shift, told):
    planned = shifted(**{f"shift-{along}": shift, "increments": 4})
    found = [caution for caution in planned.cautions if caution.code == "shift"]
    assert len(found) == told
    ratio = abs(shift) / (0.5 * planned.model.window.expected.extent[0])
    if told:
        assert found[0].error == close(ratio / (1 + ratio), rel=1e-12)
        assert "the scar is 13 % shorter along the shift than that of a moving contact" in found[0].words
    (left,) = [item.effect for item in planned.left_out if "motion of the contact" in item.effect]
    assert left.endswith(f"shift-x and shift-y, up to {percent(ratio)} of its radius")


def test_without_wear_or_shift_the_contact_does_not_move_over_the_body():
    for planned in (shifted(**{"tangential-load-x": 1.0}), ec.plan("gross-slip")):
        assert not [item for item in planned.left_out if "motion of the contact" in item.effect]
        assert "shift" not in [caution.code for caution in planned.cautions]


@pytest.mark.parametrize(("scene", "motion"), [("pin-on-disc", "slides"), ("repeated-rolling", "rolls")])
def test_a_geometry_slides_where_surfaces_rub(scene, motion):
    (block,) = [block for block in ec.plan(scene).blocks if block.name == "separation"]
    assert f", which {motion} along the surface" in block.reason
