"""Stress of the steps of a cycle after the run: that of a run which stores it in all steps, for observers too."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.app import plan
from eigencontact.execution.fields.regions import Region
from eigencontact.execution.fields.stress_of_steps import StressOfSteps
from eigencontact.plugin import Observer
from eigencontact.sweeps.fretting_map import _Numbers

CRITERION = {"type": "findley", "slope": 0.3, "limit-amplitude": "1 GPa"}
SECTION = 'name="section", shape="plane", normal="y", depth-max="20 um", depth-cells=8'
FEW = [f"steps.{k}.increments={n}" for k, n in ((1, 2), (2, 3), (3, 3))]


@dataclass(frozen=True, kw_only=True)
class LargestTension(Observer):
    """Reads the region of the scene."""

    key: ClassVar[str] = "probe"
    units: ClassVar[dict[str, str]] = {"tension": "Pa"}

    def observe(self, step):
        return {"tension": step.regions["section"].fields["stress"][0].max()}


@pytest.fixture(scope="module", params=["line", "sphere"])
def scene(request):
    name, changes = {
        "line": ("cylinder-fretting", ["body1.bulk-stress.xx='100 MPa'", "stress.0.depth-cells=20"]),
        "sphere": ("fretting-mode-1", [f"stress=[{{{SECTION}}}]"]),
    }[request.param]  # fmt: skip
    return ec.load_scene(name, [*FEW, "grid.cells-per-contact-radius=8", "observers=[]", *changes])


def test_stress_of_a_cycle_is_that_of_stored_steps(scene):
    whole = plan(scene)
    late = _Numbers(CRITERION, None, "section", 1).planned(whole)
    (block,) = (block for block in late.blocks if isinstance(block, Region))
    assert block.only_step == whole.steps
    stored, last = ec.run(whole), ec.run(late)
    assert last.summary["max_von_mises"] == stored.summary["max_von_mises"]
    assert last.summary["warnings"] == stored.summary["warnings"]
    with last.stored() as results:
        stress = StressOfSteps(block, results, range(3, whole.steps))
    expected = np.asarray(stored.dataset["section_stress"].values)[3:]
    expected = expected.reshape(*expected.shape[:2], -1)
    expected[:, 3:] *= np.sqrt(2.0)
    some = np.random.default_rng(1).permutation(expected.shape[2])[:50]
    for points in (slice(None), slice(7, 30), some, np.isin(np.arange(expected.shape[2]), some)):
        np.testing.assert_allclose(stress(points), expected[..., points], atol=1e-12 * np.abs(expected).max(), rtol=0)


def test_an_observer_reads_a_region_that_is_stored_once(scene, monkeypatch):
    from eigencontact.model import observing

    monkeypatch.setattr(observing, "build_components", lambda *_: [LargestTension()])
    probe = {"type": "stress-probe", "points": [[0.0, 0.0, 1e-6]]}
    whole = plan(ec.Scene(**{**scene.resolved(), "observers": [probe]}))
    late = _Numbers(CRITERION, None, "section", 1).planned(whole)
    found, expected = (
        [row["probe_tension"] for row in ec.run(planned).summary["history"]] for planned in (late, whole)
    )
    assert found == expected
