"""Tables of inhomogeneities: what is understood, and one clear message for everything that is not."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from eigencontact.errors import EigencontactError
from eigencontact.scene.schema import Scene
from one_line import one_line_error

BALL = {"type": "sphere", "center": [0.0, 0.0, "2 um"], "radius": "1 um"}
GRID = {"cells": 8, "size": [4e-6, 4e-6]}
HARD = {"young-modulus": "420 GPa", "poisson-ratio": 0.25}
FIBRE = {
    "type": "transversely-isotropic",
    "axial-modulus": "200 GPa",
    "transverse-modulus": "20 GPa",
    "axial-poisson-ratio": 0.2,
    "transverse-poisson-ratio": 0.3,
    "axial-shear-modulus": "15 GPa",
}
UNIT = np.eye(6).tolist()


def scene(material, **tables):
    ball = {**BALL, "material": material} if material is not None else BALL
    return Scene(**{"body1": STEEL, "inclusions": ball, "grid": GRID} | tables)


# table -> table as it is kept, words of `explain`
GOOD = {
    "isotropic": (HARD, {"type": "isotropic", **HARD}, "cells of E = 420 GPa, ν = 0.25"),
    "void": ({"void": True}, {"type": "void"}, "cells of nothing (a void)"),
    "void by type": ({"type": "void"}, {"type": "void"}, "cells of nothing (a void)"),
    "rigid": ({"type": "rigid"}, {"type": "rigid"}, "cells of a rigid material"),
    "cubic": ({"type": "cubic", "c11": 3e11, "c12": 1e11, "c44": 1e11}, None, "cells of cubic material"),
    "fibre": ({**FIBRE, "axis": [1, 0, 0]}, None, "cells of transversely-isotropic material"),
    "stiffness": ({"type": "stiffness", "stiffness": UNIT}, None, "cells of stiffness material"),
}


@pytest.mark.parametrize("case", GOOD)
def test_materials(case):
    table, kept, words = GOOD[case]
    found = scene(table)
    assert found.inclusions[0].material == (kept or table)
    assert found.inclusions[0].eigenstrain is None
    assert Scene(**found.resolved()) == found
    assert words in ec.plan(found).explain()


def test_a_law_may_be_given_as_a_component():
    law = ec.make("cubic", c11="300 GPa", c12="100 GPa", c44="100 GPa")
    planned = ec.plan(scene(law))
    assert planned.model.cells.inhomogeneities[0].law == law
    assert ec.plan(planned.scene.resolved()).model.cells.inhomogeneities[0].law == law
    assert law in planned.model.components


LOPSIDED = (np.eye(6) + np.eye(6, k=1)).tolist()
# material, tables of the scene -> words of the message
REFUSED = {
    "neither": (None, {}, "inclusions must be given an eigenstrain, a material, or both"),
    "void and type": ({"void": True, "type": "cubic"}, {}, "void = true, or of another type"),
    "half-space": (HARD, {"numerics": {"half-space": "image-pressure"}}, "half-space must be 'exact' or 'full-space'"),
    "periodic": (HARD, {"numerics": {"boundary": "periodic"}}, "boundary must be 'non-periodic'"),
    "rigid body": ({**HARD}, {"body1": {"rigid": True}, "body2": STEEL}, "must lie in an elastic body"),
    "pitch": (HARD, {"numerics": {"inclusion-pitch": 0.0}}, "inclusion-pitch must be positive"),
    "text": ("steel", {}, "material"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_refusals(case):
    material, tables, words = REFUSED[case]
    with one_line_error(words):
        scene(material, **tables)


CUBIC = {"type": "cubic", "c11": 3e9, "c12": 1e9, "c44": 1e9}
# material -> words of the message of the plan
OF_NO_MATERIAL = {
    "where": ({**HARD, "young-modulus": "-1 GPa"}, "inclusions.material.young-modulus must be"),
    "negative modulus": ({**HARD, "young-modulus": "-1 GPa"}, "young-modulus must be zero (a void) or positive"),
    "infinite modulus": ({**HARD, "young-modulus": float("inf")}, "positive, and finite [Pa] (got inf)"),
    "ratio": ({**HARD, "poisson-ratio": 0.6}, "poisson-ratio must be in (-1, 0.5] [-] (got 0.6)"),
    "half": ({"young-modulus": 1e9}, "inclusions.material.poisson-ratio must be given (isotropic needs it)"),
    "unknown key": ({**HARD, "poison-ratio": 0.3}, "did you mean 'poisson-ratio'?"),
    "unknown type": ({"type": "cubik"}, "inclusions.material: unknown constitutive-law 'cubik'"),
    "nearest type": ({"type": "cubik"}, "did you mean 'cubic'?"),
    "void and more": ({"void": True, **HARD}, "unknown key 'young-modulus' in inclusions.material (void)"),
    "key of another": ({**HARD, "c11": 1e9}, "unknown key 'c11' in inclusions.material (isotropic)"),
    "missing": ({"type": "cubic", "c11": 1.0}, "c12 must be given"),
    "text": ({**HARD, "young-modulus": "much"}, "inclusions.material.young-modulus must be a stress [Pa]"),
    "size": ({"type": "stiffness", "stiffness": [[1.0]]}, "6 x 6 Mandel components"),
    "ragged": ({"type": "stiffness", "stiffness": [[1.0], [1.0, 2.0]]}, "6 x 6 Mandel components"),
    "lopsided": ({"type": "stiffness", "stiffness": LOPSIDED}, "stiffness must be symmetric"),
    "unstable": ({"type": "stiffness", "stiffness": (-np.eye(6)).tolist()}, "without negative eigenvalues"),
    "axis": ({**FIBRE, "axis": [1.0, 0.0]}, "inclusions.material.axis"),
    "cubic": ({**CUBIC, "c12": 4e9}, "inclusions.material.c12 must be between"),
    "skew axes": (
        {**CUBIC, "x-axis": [1, 0, 0], "y-axis": [1, 1, 0]},
        "inclusions.material.y-axis must be at right angles",
    ),
    "fibre": ({**FIBRE, "axial-poisson-ratio": 3.0}, "axial-poisson-ratio must be in"),
    "no file": ({"type": "map", "file": "nowhere.npz"}, "inclusions.material.file must be an existing file"),
}


@pytest.mark.parametrize("case", OF_NO_MATERIAL)
def test_constants_of_no_material_are_refused_before_the_run(case):
    material, words = OF_NO_MATERIAL[case]
    with one_line_error(words):
        ec.plan({"body1": STEEL, "inclusions": {**BALL, "material": material}, "grid": GRID})


# changes of a good map -> words of the message
MAPS = {
    "no modulus": ({"young_modulus": None}, "a file with young_modulus"),
    "axes": ({"x": np.array([1.0, 0.0])}, "finite and ascending [m]"),
    "shape": ({"young_modulus": np.ones((2, 2))}, "of shape (z, y, x) = (2, 2, 2)"),
    "negative": ({"young_modulus": -np.ones((2, 2, 2))}, "young_modulus must be zero"),
}


@pytest.mark.parametrize("case", MAPS)
def test_maps_that_are_refused(case, tmp_path):
    changes, words = MAPS[case]
    axis = np.array([0.0, 1e-6])
    good = {"x": axis, "y": axis, "z": axis, "young_modulus": np.full((2, 2, 2), 1e9), "poisson_ratio": np.array(0.3)}
    arrays = {name: values for name, values in (good | changes).items() if values is not None}
    np.savez(tmp_path / "map.npz", **arrays)
    material = {"type": "map", "file": str(tmp_path / "map.npz")}
    with pytest.raises(EigencontactError) as caught:
        ec.plan({"body1": STEEL, "inclusions": {**BALL, "material": material}, "grid": GRID})
    assert words in str(caught.value)


def test_a_map_beside_the_scene_is_found(tmp_path):
    axis = np.array([0.0, 1e-6])
    constants = {"young_modulus": np.full((2, 2, 2), 1e9), "poisson_ratio": np.full((2, 2, 2), 0.3)}
    np.savez(tmp_path / "map.npz", x=axis, y=axis, z=axis, **constants)
    path = tmp_path / "scene.toml"
    path.write_text(
        '[body1]\nyoung-modulus = "210 GPa"\npoisson-ratio = 0.3\n[[inclusions]]\ntype = "sphere"\n'
        'center = [0, 0, "2 um"]\nradius = "1 um"\nmaterial = { type = "map", file = "map.npz" }\n',
        encoding="utf-8",
    )
    assert "the map" in ec.plan(ec.load_scene(path)).explain()
