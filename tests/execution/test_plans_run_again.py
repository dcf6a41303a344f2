"""A plan can be run any number of times, and the memory of a run ends with the run."""

import gc
from collections import Counter

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from eigencontact.viz import figures

SECTION = [{"name": "section", "shape": "plane", "normal": "y", "depths": ["1 um", "3 um"]}]
BALL = {
    "geometry": {"type": "sphere", "radius": "105 um"}, "grid": {"cells": [10, 10], "size": ["22 um", "22 um"]},
    "stress": SECTION, "output": {"vtk": False},
}  # fmt: skip
YIELDING = {"type": "j2", "hardening": {"type": "perfect", "yield-stress": "1.5 GPa"}}
COATING = {"type": "cuboid", "center": [0, 0, "2 um"], "edges": ["9 um", "9 um", "4 um"]}
HARD = {"young-modulus": "420 GPa", "poisson-ratio": 0.25}
SCENES = {
    "coating in cells": {
        "body1": STEEL, "inclusions": [{**COATING, "material": HARD}], "steps": [{"normal-load": "0.3 N"}],
        "numerics": {"inclusion-pitch": "2 um"}, **BALL,
    },
    "box that grows": {
        "body1": STEEL | {"law": YIELDING}, "numerics": {"inclusion-pitch": "2 um", "law-room": 0.0},
        "steps": [{"normal-load": "0.3 N"}, {"normal-load": "0.65 N"}], **BALL,
    },
    "exact layers with friction": {
        "body1": {"medium": {"type": "bonded-layers", "layers": [{"thickness": "2 um", **HARD}], "substrate": STEEL}},
        "friction": {"type": "coulomb", "coefficient": 0.3},
        "steps": [{"normal-load": "0.3 N"}, {"tangential-load-x": "0.05 N"}], **BALL,
    },
}  # fmt: skip
#: Classes that hold tables, spectra or systems of equations.
OPERATORS = (
    "Convolver", "FrictionalContact", "InhomogeneousCells", "MeanVolumeField", "MeansOnLattice", "NormalSolver",
    "PlaneFields", "SectionStress", "SubsurfaceStress", "SurfaceAndCells", "VolumeField", "WithinCells",
)  # fmt: skip


def count_operators():
    """Number of operators in memory, by class."""
    gc.collect()
    return Counter(name for name in (type(thing).__name__ for thing in gc.get_objects()) if name in OPERATORS)


class Counting:
    """Watcher that counts the operators after each step."""

    def __init__(self):
        self.counts = []

    def step_started(self, *_):
        pass

    def iterated(self, *_):
        pass

    def step_finished(self, *_):
        self.counts.append(count_operators().total())


#: The box that grows takes as long as the others together.
SLOW = {"box that grows", "exact layers with friction"}


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in SCENES])
def test_a_plan_runs_twice_with_equal_results_and_leaves_no_operator(name, tmp_path, monkeypatch):
    """In memory and in a folder; operators are alive while steps are solved, and not while pictures are drawn."""
    counts, watcher = [], Counting()
    monkeypatch.setattr(figures, "draw_all", lambda *_, **__: counts.append(count_operators()) or {})
    plan = ec.plan(SCENES[name])
    before = count_operators()
    in_memory = ec.run(plan, watcher=watcher)
    assert min(watcher.counts) >= before.total() + 2
    stored = ec.run(plan, tmp_path)
    assert stored.summary["converged"]
    assert counts == [before]
    assert count_operators() == before
    first, second = in_memory.dataset, stored.dataset
    for field in first.data_vars:
        if np.issubdtype(first[field].dtype, np.number) and "seconds" not in field:
            np.testing.assert_array_equal(first[field], second[field], err_msg=field)
    if name == "box that grows":  # else the plan would have been as it was in any case
        (region,) = plan.model.cells.inhomogeneities
        assert first.equivalent_plastic_strain_1.shape[1:] > region.lattice.shape
