"""Sizes that no machine can hold: refused at once, before anything of that size is made, with what would do."""

from functools import cache
from math import prod
from time import perf_counter

import pytest

import eigencontact as ec
from eigencontact.errors import EigencontactError, SceneError
from eigencontact.model.sizes import cut_down, most

FAR = "inclusions={type='cuboid', centers=[[0, 0, 2e-6], [1e3, 0, 2e-6]], edges=[1e-6, 1e-6, 1e-6], "

# what sets a size: (bundled scene, changes, words of the refusal)
SIZES = {
    "cells": ("hertz", ["grid={cells=1000000000, size=[2e-5, 2e-5]}"], "grid.cells must make at most"),
    "cells of one side": ("hertz", ["grid={cells=[3, 1000000000000], size=[2e-5, 2e-5]}"], "; 3 x "),
    "cells without a contact": ("buried-cuboid", ["grid.cells=1000000000"], "grid.cells must make at most"),
    "digits of cells": ("hertz", [f"grid={{cells=1{'0' * 400}, size=[2e-5, 2e-5]}}"], "grid must be of at most 1e+30"),
    "spacing": ("hertz", ["grid={size=[2e-5, 2e-5], spacing=[1e-15, 1e-15]}"], "grid.spacing must make at most"),
    "cells of a radius": ("hertz", ["grid.cells-per-contact-radius=1e15"], "grid.cells-per-contact-radius must make"),
    "margin": ("hertz", ["grid.margin=1e15"], "grid.margin must make at most"),
    "depth cells": ("hertz", ["stress.0.depth-cells=1000000000"], "stress region 'section': depth-cells must make"),
    "depth cells of layers": ("coated-sphere", ["stress.0.depth-cells=1000000000"], "depth-cells must make at most"),
    "depth cells of eigenstrain": ("buried-cuboid", ["stress.0.depth-cells=1000000000"], "depth-cells must make"),
    "count": ("hertz", ["stress={shape='line', start=[0, 0, 0], end=[0, 0, 1e-6], count=100000000}"], "stress.count"),
    "refinement": ("hertz", ["stress={shape='plane', normal='z', refinement=100000}"], "': refinement must make"),
    "box": ("hertz", ["stress={shape='plane', normal='z', start=[-9, -9, 0], end=[9, 9, 0]}"], "': start and end must"),
    "close-up": ("inclusion-under-contact", ["stress.2.refinement=1000000000"], "; give refinement = 73"),
    "room": ("inclusion-under-contact", ["stress.2.room=1e20"], "and room 1e+20); give less room"),
    "increments": ("hertz", ["steps.increments=1000000000"], "; the largest value is 100000"),
    "increments of a step": ("cattaneo-mindlin", ["steps.1.increments=100000"], "; the largest value is 99999"),
    "threads": ("hertz", ["numerics.threads=1000000000"], "numerics.threads must be in [1, 1024] threads"),
    "pitch": ("inclusion-under-contact", ["numerics.inclusion-pitch=1e-20"], "numerics.inclusion-pitch must make"),
    "inclusion cells": ("prestressed-bars", ["numerics.inclusion-cells=1000000000"], "numerics.inclusion-cells must"),
    "layers": ("peened-layer", ["eigenstrain.layers=1000000000"], "eigenstrain.layers must make at most"),
    "patch": ("peened-layer", ["eigenstrain.size=[3e3, 3e3]"], "eigenstrain must make at most"),
    "inclusion": ("inclusion-under-contact", ["inclusions.radius=1", "inclusions.center=[0, 0, 2]"], "inclusions must"),
    "room of a law": ("plastic-indentation", ["numerics.law-room=1e20"], "body1.law must make at most"),
    "cells of a law": ("plastic-indentation", ["grid.cells-per-contact-radius=3000"], "body1.law must make at most"),
    "pitch of a law": ("plastic-indentation", ["numerics.inclusion-pitch=1e-18"], "numerics.inclusion-pitch must make"),
    "inclusions far apart": (
        "inclusion-under-contact",
        [FAR + "material={void=true}}", "stress=[]"],
        "inclusions that share a box must make at most",
    ),
    "thin layer": (
        "coated-sphere",
        ["body1.medium.layers=[{thickness=1e-25, young-modulus=4e11, poisson-ratio=0.3}]"],
        "bonded-layers.thickness must be of layers that are thicker than",
    ),
}


@cache
def planned_once(scene):
    """What is imported, and what is timed, once is not the price of a refusal."""
    ec.plan(scene)


@pytest.mark.parametrize(("scene", "changes", "words"), SIZES.values(), ids=SIZES)
def test_a_size_beyond_all_memory_is_refused_at_once(scene, changes, words):
    planned_once(scene)
    began = perf_counter()
    with pytest.raises(SceneError) as refusal:
        ec.plan(ec.load_scene(scene, changes)).explain()
    assert perf_counter() - began < 3.0
    assert words in str(refusal.value)
    assert "(got " in str(refusal.value)


@pytest.mark.parametrize(
    ("setting", "nearest"),
    [
        ("grid.cells-per-contact-radius=1e15", "grid.cells-per-contact-radius={}"),
        ("grid.margin=1e15", "grid.margin={}"),
        ("grid={cells=1000000000, size=[2e-5, 2e-5]}", "grid={{cells=[{}], size=[2e-5, 2e-5]}}"),
    ],
)
def test_the_choice_that_a_refusal_names_is_not_refused_for_its_size(setting, nearest):
    with pytest.raises(SceneError) as refusal:
        ec.plan(ec.load_scene("hertz", ["stress=[]", setting]))
    choice = str(refusal.value).split("; ")[-1].removesuffix(" would do").replace(" x ", ", ")
    grid = ec.plan(ec.load_scene("hertz", ["stress=[]", nearest.format(choice)])).grid
    assert prod(grid.shape) > 0.4 * most()


def test_a_plan_that_is_too_large_says_by_how_much():
    with pytest.raises(EigencontactError, match=r"'stress-section'\); use about 1/\d+ of the cells or depths"):
        ec.plan(ec.load_scene("hertz", ["grid={cells=15000, size=[2e-5, 2e-5]}"]))


def test_what_is_cut_down_fits():
    for value, count, power in ((7e9, 3e20, 2), (1234.5, 1.001 * most(), 1), (8, 1e12, 3)):
        left = count * (cut_down(value, count, power) / value) ** power
        assert 0.45 * most() / 1.1**power < left <= 0.5 * most() * (1 + 1e-9)
