"""Plans with inhomogeneities: one box of cells for each body, solved with the contact; nothing where there are none."""

import tracemalloc

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.model.boxes import box_of_inhomogeneities

HARD = {"young-modulus": "420 GPa", "poisson-ratio": 0.3}
BALL = {"type": "sphere", "center": [0.0, 0.0, "2 um"], "radius": "1 um", "material": HARD}
GRID = {"cells": 16, "size": [8e-6, 8e-6]}
SCENE = {"body1": STEEL, "inclusions": [BALL], "grid": GRID}
CONTACT = {"geometry": {"type": "sphere", "radius": "105 um"}, "steps": {"normal-load": "0.1 N"}}
FRICTION = {"friction": {"type": "coulomb", "coefficient": 0.3}}
REGION = {"name": "cut", "shape": "plane", "depth-max": "4 um", "depth-cells": 8}
LAYER = {"type": "cuboid", "center": [0.0, 0.0, 0.5e-6], "edges": [8e-6, 8e-6, 1e-6], "material": HARD}

TOGETHER = ("normal-contact", "inhomogeneities")
# scene tables beside SCENE; blocks in order, and what each solves together
GROUPS = {
    "alone": ({}, [("inhomogeneities",)]),
    "alone, with a region": ({"stress": REGION}, [("inhomogeneities",), ("stress-cut",)]),
    "under a contact": (CONTACT, [("separation",), TOGETHER, ("homogeneous-pressure",)]),
    "under a contact, with a region": (
        {**CONTACT, "stress": REGION},
        [("separation",), TOGETHER, ("homogeneous-pressure",), ("stress-cut",)],
    ),
    "with friction": (
        {**CONTACT, **FRICTION},
        [("separation",), ("frictional-contact", "inhomogeneities"), ("homogeneous-pressure",), ("shear-bound",)],
    ),
}


@pytest.mark.parametrize("case", GROUPS)
def test_blocks(case):
    changes, expected = GROUPS[case]
    assert [tuple(part.name for part in block.parts) for block in ec.plan(SCENE | changes).blocks] == expected


def boxes(*inclusions, grid=GRID, **numerics):
    planned = ec.plan({"body1": STEEL, "body2": STEEL, "inclusions": inclusions, "grid": grid, "numerics": numerics})
    found = {}
    for body in (1, 2):
        sources = [source for source in planned.model.cells.inhomogeneities if source.body == body]
        if sources:
            lattice = box_of_inhomogeneities(sources).lattice
            found[body] = (lattice.first, lattice.shape, lattice.edges)
    return found


def test_all_of_one_body_share_a_box():
    below = {**BALL, "center": [1e-6, 0.0, 4e-6]}
    other = {**BALL, "body": 2}
    found = boxes(BALL, below, other)
    assert found[1] == ((2, 6, 6), (8, 4, 6), close((0.5e-6, 0.5e-6, 0.5e-6)))
    assert found[2] == ((2, 6, 6), (4, 4, 4), close((0.5e-6, 0.5e-6, 0.5e-6)))


# inclusions, numerics -> layers of the box, height of the cells
HEIGHTS = {
    "flat ones have four layers": ([LAYER], {}, 4, 0.25e-6),
    "the thinnest decides": ([LAYER, {**LAYER, "center": [0, 0, 1.2e-6], "edges": [8e-6, 8e-6, 4e-7]}], {}, 14, 1e-7),
    "thick ones follow the grid": ([{**LAYER, "center": [0, 0, 2e-6], "edges": [4e-6, 4e-6, 4e-6]}], {}, 8, 0.5e-6),
    "faces fall on faces": ([{**LAYER, "center": [0, 0, 1.4e-6], "edges": [4e-6, 4e-6, 2e-6]}], {}, 5, 0.4e-6),
    "as the scene says": ([LAYER], {"inclusion-pitch": 0.5e-6}, 2, 0.5e-6),
}  # fmt: skip


@pytest.mark.parametrize("case", HEIGHTS)
def test_height_of_the_cells(case):
    inclusions, numerics, layers, height = HEIGHTS[case]
    _, shape, edges = boxes(*inclusions, **numerics)[1]
    assert shape[0] == layers
    assert edges[0] == close(height, rel=1e-9)


def test_explain_names_what_is_solved_with_what():
    planned = ec.plan({**SCENE, **CONTACT})
    text = planned.explain()
    assert "inhomogeneities of body 1, 1 region in 4 x 4 x 4 cells of 500 nm x 500 nm x 500 nm" in text
    assert "E = 420 GPa, ν = 0.3" in text
    assert text.count("(solved together)") == 2
    assert "layered" not in text
    assert "it is prescribed" not in text
    assert any("Eshelby" in reference for reference in planned.to_dict()["references"])
    assert planned.cost.peak > 58 * 8 * 5**3


def test_a_uniform_layer_is_recommended_to_the_layered_medium():
    def text(**changes):
        return ec.plan({**SCENE, **CONTACT, "inclusions": [{**LAYER, **changes}]}).explain()

    assert 'body1.medium = { type = "bonded-layers", ... }' in text()
    assert "bonded-layers" not in text(edges=[7e-6, 8e-6, 1e-6])
    assert "bonded-layers" not in text(center=[0.0, 0.0, 0.7e-6])
    assert "bonded-layers" not in text(material={"void": True}, center=[0.0, 0.0, 1.5e-6])


def test_the_prediction_covers_what_is_held():
    """Memory within a factor of two of its peak while the kernels are sampled; compiled loops are loaded before."""
    from eigencontact.convolution import compiled  # noqa: F401

    planned = ec.plan({**SCENE, **CONTACT, "inclusions": [LAYER], "grid": {"cells": 32, "size": [8e-6, 8e-6]}})
    (cells,) = [part for part in planned.parts if part.name == "inhomogeneities"]
    tracemalloc.start()
    cells.start()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert 0.5 < cells.cost.peak / peak < 2.0


def test_outlines_are_drawn():
    from eigencontact.model.outlines import outlines

    found = outlines(ec.plan({**SCENE, **CONTACT, "stress": REGION}).model)
    assert set(found) == {"", "cut"}
    np.testing.assert_allclose(np.hypot(*found[""][:, 0].T), 1e-6, rtol=0.02)
