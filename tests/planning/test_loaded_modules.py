"""A run loads the modules that its scene needs, and no others."""

import json
import os
import subprocess
import sys

import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL

BALL = {"type": "sphere", "center": [0.0, 0.0, 2e-6], "radius": 1e-6}
FREE = {"body1": STEEL, "grid": {"cells": 9, "size": [9e-6, 9e-6]}}
CONTACT = {**FREE, "geometry": {"type": "sphere", "radius": 105e-6}, "steps": {"normal-load": 0.1}}
FRICTION = {"friction": {"type": "coulomb", "coefficient": 0.3}, "steps": [{"normal-load": 0.1}, {"shift-x": 1e-9}]}
LEVEL = {"name": "cut", "shape": "plane", "normal": "z", "position": 1e-6, "fields": ["strain"]}
REGION = {"name": "cut", "shape": "plane", "depth-max": 4e-6, "depth-cells": 4}

LAYERS = ("halfspace.layered", "execution.blocks.layered")
EIGENSTRAIN = (
    "halfspace.points", "halfspace.theorem", "solvers.eigenstrain", "execution.fields.eigenstrain_field",
    "execution.routes.prescribed", "execution.interiors.prescribed", "model.outlines",
)  # fmt: skip
CELLS = ("execution.interiors.cells", "execution.interiors.material_cells", "solvers.equivalent_inclusions")
SLIP = (
    "solvers.tangential.newton", "solvers.tangential.contact", "execution.mechanics.friction_contact",
)  # fmt: skip
NORMAL = ("solvers.normal", "execution.mechanics.normal_contact", "model.contact_window", "solvers.coarse_contact")
#: Degrees of inclusions, fatigue tables and contacts that repeat along y alone, which no scene here has.
NEVER = (
    "solvers.polynomial_inclusions", "halfspace.moments", "execution.fields.fatigue", "execution.fields.stress_cycle",
    "core.path_loops", "halfspace.images",
)  # fmt: skip
VOLUME = ("solvers.subsurface", "solvers.eigenstrain", "convolution.volume", "halfspace.voxels", "halfspace.cloud")
HEAVY = ("numba", "matplotlib", "pyvista", "vtk", "meshio", "skfem")

#: Scene; beginnings of the names of modules of this package that it loads; that it does not; other packages that it
#: does not load.
SCENES = {
    "contact": (CONTACT, ["solvers.normal"], [*EIGENSTRAIN, *SLIP, *CELLS], ()),
    "contact over a section": ({**CONTACT, "stress": LEVEL}, ["solvers.subsurface"], [*LAYERS, *SLIP], ()),
    "friction": ({**CONTACT, **FRICTION}, SLIP, LAYERS, ()),
    "closed form": (
        {**FREE, "inclusions": [{**BALL, "eigenstrain": 1e-3}], "stress": REGION},
        ["halfspace.points"], [*NORMAL, *VOLUME, *CELLS], HEAVY,
    ),
    "void": ({**FREE, "inclusions": [{**BALL, "material": {"void": True}}]}, CELLS, ["solvers.normal"], ()),
}  # fmt: skip

#: Each scene in a process of its own, from one that has loaded what every scene needs to be read.
RUN = """
import json, os, sys
import eigencontact as ec
ec.load_scene("hertz")
for name, scene in json.loads(sys.argv[1]).items():
    if not (child := os.fork()):
        ec.run(scene)
        print(json.dumps([name, sorted(sys.modules)]), flush=True)
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
"""


@pytest.fixture(scope="module")
def modules():
    """Names of the modules that a run of each scene loads."""
    if not hasattr(os, "fork"):
        pytest.skip("processes begin empty on this system")
    coated = ["grid.cells-per-contact-radius=8", "output.vtk=false", "output.pictures=false"]
    scenes = {name: scene for name, (scene, *_) in SCENES.items()}
    scenes["layers"] = ec.load_scene("coated-sphere", coated).resolved() | {"stress": [LEVEL]}
    done = subprocess.run(
        [sys.executable, "-c", RUN, json.dumps(scenes)], capture_output=True, text=True, check=True, timeout=120
    )
    return dict(json.loads(line) for line in done.stdout.splitlines())


def loaded(modules, beginning):
    return [module for module in modules if module.startswith(f"eigencontact.{beginning}")]


@pytest.mark.parametrize("name", SCENES)
def test_a_run_loads_what_its_scene_needs(modules, name):
    _, needed, unneeded, packages = SCENES[name]
    assert not [module for beginning in ("accuracy", *NEVER) for module in loaded(modules[name], beginning)]
    assert [part for part in needed if not loaded(modules[name], part)] == []
    assert [module for part in unneeded for module in loaded(modules[name], part)] == []
    assert not set(packages) & set(modules[name])


def test_layers_are_loaded_with_a_layered_body(modules):
    assert all(loaded(modules["layers"], part) for part in LAYERS)
