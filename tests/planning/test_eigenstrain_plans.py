"""Plans of scenes with eigenstrain: work follows the scene, and `explain` says how every field is found."""

import json

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.core.borders import border
from eigencontact.model.boxes import boxes_of
from eigencontact.model.sources import Lattice

BALL = {"type": "sphere", "center": [0.0, 0.0, "2 um"], "radius": "1 um", "eigenstrain": 1e-3}
SCENE = {"body1": STEEL, "inclusions": [BALL], "grid": {"cells": 9, "size": [9e-6, 9e-6]}}
REGION = {"name": "cut", "shape": "plane", "depth-max": "4 um", "depth-cells": 4}
CONTACT = {"geometry": {"type": "sphere", "radius": "105 um"}, "steps": {"normal-load": "0.1 N"}}
GRADED = {"type": "depth-profile", "depths": [0.0, "4 um"], "values": [1e-3, 0.0]}


def names(planned):
    return [part.name for part in planned.parts]


# scene tables beside SCENE; names of the blocks in order
BLOCKS = {
    "a ball alone": ({}, ["residual-displacement"]),
    "with a region": ({"stress": REGION}, ["residual-displacement", "stress-cut"]),
    "under a contact": (CONTACT, ["separation", "normal-contact", "residual-displacement", "homogeneous-pressure"]),
    "under a contact, with a region": (
        {**CONTACT, "stress": REGION},
        ["separation", "normal-contact", "residual-displacement", "homogeneous-pressure", "stress-cut"],
    ),
    "a region of the other body": (
        {**CONTACT, "body2": STEEL, "stress": {**REGION, "body": 2}},
        ["separation", "normal-contact", "residual-displacement", "homogeneous-pressure", "stress-cut"],
    ),
    "no eigenstrain": ({**CONTACT, "inclusions": []}, ["separation", "normal-contact", "reference-pressure"]),
}


@pytest.mark.parametrize("case", BLOCKS)
def test_blocks(case):
    changes, expected = BLOCKS[case]
    assert names(ec.plan(SCENE | changes)) == expected


def test_the_displacement_along_the_surface_is_computed_where_somebody_sees_it():
    def provided(changes):
        return {name for block in ec.plan(SCENE | changes).blocks for name in block.provides if "residual" in name}

    everything = {f"residual_displacement_{axis}" for axis in "xyz"}
    assert provided({}) == everything
    assert provided(CONTACT) == {"residual_displacement_z"}
    assert provided({**CONTACT, "output": {"tangential-displacement": True}}) == everything


def test_explain_says_how_each_field_is_found():
    text = ec.plan(SCENE | {"stress": REGION}).explain()
    for words in (
        "eigenstrain, 1 region",
        "sphere 1 (plugin 'sphere', body 1): closed form",
        "exact half-space, double precision",
        "displacement x, y, z <- eigenstrain of 'sphere 1' (plugin 'sphere'), 9 x 9 points of the surface, closed form",
        "contact: the scene has no [geometry]",
        "cells inside the bodies: every inclusion has a closed form",
    ):
        assert words in text
    full = ec.plan(SCENE | {"numerics": {"half-space": "full-space"}}).explain()
    assert "full space (the free surface is left out)" in full
    both = ec.plan(SCENE | CONTACT).explain()
    assert "eigenstrain that follows from the contact: the eigenstrain is prescribed" in both


def test_many_inclusions_take_one_line():
    shape = {name: value for name, value in BALL.items() if name != "center"}
    centers = [[4e-6 * n, 0.0, 2e-6] for n in range(30)]
    planned = ec.plan(SCENE | {"inclusions": {**shape, "centers": centers}})
    assert "sphere 1, 1 ... sphere 1, 30, 30 of them (plugin 'sphere', body 1): closed form" in planned.explain()
    (kernel,) = planned.kernels
    assert kernel.count == 30


def test_a_plan_of_eigenstrain_is_plain_data():
    data = json.loads(json.dumps(ec.plan(SCENE).to_dict()))
    (ball,) = data["inclusions"]
    assert (ball["plugin"], ball["exact"], ball["how"], ball["cells"]) == ("sphere", True, "closed form", 0)
    assert data["predicted_seconds"] > 0
    assert any("Mindlin" in text for text in data["references"])
    assert not any("Polonsky" in text for text in data["references"])


# ---------------------------------------------------------------- cells


def test_cells_follow_the_grid_and_the_faces_of_the_region():
    cuboid = {"type": "cuboid", "center": [0.5e-6, 0.0, "3 um"], "edges": ["4 um", "3 um", "2 um"]}
    graded = {**cuboid, "eigenstrain": GRADED}
    (source,) = ec.plan(SCENE | {"inclusions": graded, "numerics": {"inclusion-cells": 4}}).model.sources
    assert not source.exact
    # columns of 1 um from -4.5 um; layers of 0.5 um: x from -1.5 to 2.5, y from -1.5 to 1.5, z from 2 to 4
    assert source.lattice == Lattice((4, 3, 3), (4, 3, 4), (close(0.5e-6), close(1e-6), close(1e-6)))
    assert "cut into 48 cells, 4 x 3 x 4 (the eigenstrain is not uniform)" in source.how


def test_a_patch_is_whole_cells_of_the_window():
    patch = {"type": "depth-profile", "depths": [0.0], "values": [1e-3], "depth": "1 um", "layers": 5}
    planned = ec.plan(SCENE | {"inclusions": [], "eigenstrain": [patch, {**patch, "size": [2.2e-6, 0.1e-6]}]})
    whole, part = planned.model.sources
    assert whole.lattice.shape == (5, 9, 9)
    assert part.lattice.shape == (5, 1, 3)
    assert part.lattice.first[0] == 0
    np.testing.assert_allclose(part.shape.bounds[1][2], 1e-6)


def test_near_regions_share_a_box_and_far_ones_do_not():
    def groups(*centers, **changes):
        cube = {"type": "cuboid", "edges": ["2 um", "2 um", "2 um"], "eigenstrain": GRADED | changes}
        tables = [{**cube, "center": center} for center in centers]
        return boxes_of(ec.plan(SCENE | {"inclusions": tables}).model.sources)

    (one,) = groups([-1.5e-6, 0.5e-6, 1e-6], [1.5e-6, 0.5e-6, 1e-6])
    assert [source.name for source in one.sources] == ["cuboid 1", "cuboid 2"]
    assert len(groups([-1.5e-6, 0.5e-6, 1e-6], [51.5e-6, 0.5e-6, 1e-6])) == 2
    assert [group.varies for group in groups([0, 0, 1e-6], times=[0.0, 1.0], factors=[0.0, 1.0])] == [True]


def test_kernels_that_serve_once_do_not_add_up_and_those_of_changing_fields_do():
    cube = {"type": "cuboid", "center": [0.0, 0.0, 1e-6], "edges": [3e-6, 3e-6, 2e-6], "eigenstrain": GRADED}
    regions = [{**REGION, "name": "one"}, {**REGION, "name": "two"}]
    still = ec.plan(SCENE | {"inclusions": cube, "stress": regions})
    assert still.cost.transient == max(block.cost.transient for block in still.blocks) > 0
    assert still.cost.memory == 0
    assert still.cost.seconds_per_step == 0
    changing = {**cube, "eigenstrain": {**GRADED, "times": [0.0, 1.0], "factors": [0.0, 1.0]}}
    kept = ec.plan(SCENE | {"inclusions": changing, "stress": regions})
    assert kept.cost.memory > 1.5 * still.cost.transient
    assert kept.cost.seconds_per_step > 0


# ---------------------------------------------------------------- outlines


@pytest.mark.parametrize(
    ("inside", "area"),
    [
        (lambda x, y: (x / 3) ** 2 + (y / 2) ** 2 <= 1, np.pi * 6),
        (lambda x, y: (np.abs(x) <= 3) & (np.abs(y) <= 2), 24.0),
        (lambda x, y: (x**2 + y**2 <= 4) & (x**2 + y**2 >= 1), 3 * np.pi),
        (lambda x, y: np.abs(x) / 3 + np.abs(y) / 2 <= 1, 12.0),
    ],
)
def test_borders_enclose_the_area(inside, area):
    """Sum over segments of the triangle with the origin, signed by which side is inside."""
    segments = border(inside, (-3.0, -2.0), (3.0, 2.0))
    a, b = segments[:, 0], segments[:, 1]
    middle, along = 0.5 * (a + b), b - a
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1)
    step = 2e-2 * normal / np.linalg.norm(normal, axis=1, keepdims=True)
    outward = np.where(inside(*(middle - step).T), 1.0, -1.0)
    found = 0.5 * np.sum(outward * np.sum(middle * normal, axis=1))
    assert found == close(area, rel=5e-3)
    assert all(inside(*(0.999 * end).T).mean() > 0.3 for end in (a, b))
