"""Where regions overlap: prescribed eigenstrains add up, of materials the later one counts, what is prescribed in a
material is its prestrain."""

from ast import literal_eval
from functools import cache

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.errors import SceneError

E, NU, R, STRAIN = 200e9, 0.3, 1e-6, 1e-3
STEEL = {"young-modulus": E, "poisson-ratio": NU}
SOFT, STIFF = {"young-modulus": 0.25 * E, "poisson-ratio": 0.2}, {"young-modulus": 3 * E, "poisson-ratio": 0.25}
BALL = {"type": "sphere", "center": [0, 0, 2 * R], "radius": R}
SMALL = {**BALL, "radius": 0.5 * R}
BESIDE = {"type": "cuboid", "center": [R, 0, 2 * R], "edges": [2 * R, 2 * R, 2 * R]}
SLAB = {"type": "layer", "size": [4 * R, 4 * R], "top": R, "thickness": 2 * R}
PATCH = {
    "type": "uniform",
    "value": [STRAIN, 0, 0],
    "center": [0, 0],
    "size": [4 * R, 4 * R],
    "depth": 3 * R,
    "layers": 12,
}
POINTS = [[x * R, y * R, z * R] for x, y, z in ((0, 0, 2), (0.3, 0.1, 1.8), (1.5, 0, 2), (0, 0, 0.4), (2.6, 0.4, 3))]
AT = {"shape": "points", "points": POINTS}
RESOLUTIONS = pytest.mark.parametrize("resolution", ["cells", "whole"])


def stress(*inclusions, **more):
    """Stress ``(6, ...)`` in a body without a contact; what several tests compare with is found once."""
    return found_once(repr((inclusions, more)))


@cache
def found_once(case):
    inclusions, more = literal_eval(case)
    return run(*inclusions, **more)


def run(*inclusions, resolution="cells", half_space="exact", eigenstrain=(), where=AT):
    scene = {
        "body1": STEEL,
        "inclusions": list(inclusions),
        "eigenstrain": list(eigenstrain),
        "grid": {"cells": 16, "size": [4 * R, 4 * R]},
        "numerics": {"inclusion-resolution": resolution, "half-space": half_space, "tolerance": 1e-9},
        "stress": {"name": "at", **where},
    }
    return ec.run(scene).dataset["at_stress"][-1].values


def same(one, other, part=1e-7):
    np.testing.assert_allclose(one, other, rtol=0, atol=part * np.abs(other).max())


@pytest.mark.parametrize(
    ("half_space", "other"),
    [("exact", SMALL), ("exact", BESIDE), ("image-pressure", BESIDE), ("periodic", BESIDE), ("full-space", SMALL)],
)
def test_prescribed_eigenstrains_add_up(half_space, other):
    """By closed forms and, where space repeats, by cells."""
    level = {"shape": "plane", "normal": "z", "position": 1.8 * R} if half_space == "periodic" else AT
    one, other = {**BALL, "eigenstrain": STRAIN}, {**other, "eigenstrain": [0, 0, 2 * STRAIN]}
    apart = sum(stress(region, half_space=half_space, where=level) for region in (one, other))
    same(stress(one, other, half_space=half_space, where=level), apart)


def test_patches_and_inclusions_add_up():
    ball = {**BALL, "eigenstrain": STRAIN}
    same(stress(ball, eigenstrain=[PATCH, PATCH]), stress(ball) + 2 * stress(eigenstrain=[PATCH]))


def test_what_is_prescribed_twice_in_a_ball_is_twice_the_stress_of_eshelby():
    """In full space, dilatation: -4 G e (1 + ν)/(1 - ν) / 3 each."""
    ball = {**BALL, "eigenstrain": STRAIN}
    expected = -2 * (4 / 3) * E / (2 * (1 + NU)) * STRAIN * (1 + NU) / (1 - NU)
    found = stress(ball, ball, half_space="full-space", where={**AT, "points": POINTS[:2]})
    np.testing.assert_allclose(found[:3], expected, rtol=1e-9)


@pytest.mark.slow
@RESOLUTIONS
def test_what_is_prescribed_in_a_material_is_its_prestrain(resolution):
    """Whichever is written first. Whole balls feel the mean of it, which is exact here; cells that are cut, parts."""
    filled = stress({**BALL, "material": STIFF, "eigenstrain": STRAIN}, resolution=resolution)
    prescribed, material = {**BALL, "eigenstrain": STRAIN}, {**BALL, "material": STIFF}
    first, second = (stress(*pair, resolution=resolution) for pair in ((prescribed, material), (material, prescribed)))
    np.testing.assert_array_equal(first, second)
    same(first, filled, 1e-6 if resolution == "whole" else 0.1)


def test_prestrain_of_a_ball_has_the_closed_form():
    """Full space, dilatation e in a ball of bulk modulus K: -12 K G e / (3 K + 4 G)."""
    K, G = STIFF["young-modulus"] / (3 * (1 - 2 * STIFF["poisson-ratio"])), E / (2 * (1 + NU))
    pair = ({**BALL, "material": STIFF}, {**BALL, "eigenstrain": STRAIN})
    found = stress(*pair, resolution="whole", half_space="full-space", where={**AT, "points": POINTS[:2]})
    np.testing.assert_allclose(found[:3], -12 * K * G * STRAIN / (3 * K + 4 * G), rtol=1e-6)


@pytest.mark.slow
def test_of_two_materials_the_later_one_counts_with_its_prestrain():
    one, other = (
        {**BALL, "material": SOFT, "eigenstrain": 5 * STRAIN},
        {**BALL, "material": STIFF, "eigenstrain": STRAIN},
    )
    same(stress(one, other), stress(other))
    same(stress(other, one), stress(one))


@pytest.mark.slow
def test_a_material_written_later_takes_its_part_of_another():
    """A stiff core in a soft ball, and the ball over the core."""
    ball, core = {**BALL, "material": SOFT, "eigenstrain": STRAIN}, {**SMALL, "material": STIFF}
    same(stress(core, ball), stress(ball))
    cored, plain = stress(ball, core), stress(ball)
    assert np.abs(cored - plain)[:, 0].max() > 0.1 * np.abs(plain).max()


@pytest.mark.slow
def test_an_inclusion_in_a_coating_of_cells():
    """Written later it counts: of the body's material it has no eigenstrain. Written first it is covered."""
    slab = {**SLAB, "material": SOFT, "eigenstrain": STRAIN}
    like, stiff = ({**BALL, "radius": 0.9 * R, "material": material} for material in (STEEL, STIFF))
    found = {}
    for name, inclusions in {"later": [slab, like], "first": [like, slab], "stiff first": [stiff, slab]}.items():
        scene = {"body1": STEEL, "inclusions": inclusions, "grid": {"cells": 12, "size": [4 * R, 4 * R]}}
        found[name] = ec.run({**scene, "stress": AT}).dataset["equivalent_eigenstrain_1"][-1]
    core = {"cells_1_x": 0, "cells_1_y": 0, "cells_1_z": 2 * R}
    assert float(np.abs(found["later"].sel(core, method="nearest")).max()) < 1e-9 * STRAIN
    assert float(np.abs(found["first"].sel(core, method="nearest")).max()) > 0.5 * STRAIN
    np.testing.assert_array_equal(found["first"], found["stiff first"])


@pytest.mark.parametrize("second", [BALL, SMALL, {**BALL, "center": [1.9 * R, 0, 2 * R]}], ids=["same", "in", "part"])
def test_whole_inclusions_that_overlap_are_refused(second):
    first, second = {**BALL, "material": SOFT}, {**second, "material": STIFF}
    with pytest.raises(SceneError, match=r"'sphere 2'.*must not overlap.*'sphere 1'.*'cells'"):
        stress(first, second, resolution="whole")


@pytest.mark.parametrize("distance", [(2, 0, 0), (1.2, 1.6, 0), (1.5, 1.5, 0)])
def test_whole_inclusions_that_touch_are_not(distance):
    x, y, z = (part * R for part in distance)
    beside = {**BALL, "center": [x, y, 2 * R + z], "material": SOFT}
    assert np.isfinite(stress({**BALL, "material": STIFF}, beside, resolution="whole")).all()


def test_what_counts_is_said_where_regions_overlap():
    def explained(*inclusions):
        scene = {"body1": STEEL, "inclusions": list(inclusions), "stress": AT}
        return ec.plan(ec.Scene(**scene)).explain()

    far = {**BALL, "center": [9 * R, 0, 2 * R], "eigenstrain": STRAIN}
    assert "prescribed eigenstrains add up" in explained(
        {**BALL, "eigenstrain": STRAIN}, {**SMALL, "eigenstrain": STRAIN}
    )
    assert "of materials the later one counts" in explained({**BALL, "material": SOFT}, {**SMALL, "material": STIFF})
    assert "overlap" not in explained({**BALL, "eigenstrain": STRAIN}, far)
