"""Observers in runs: what they see, what they may ask for, how their numbers are stored."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import PlanError, PluginError
from eigencontact.plugin import Observer
from hz_1 import LOAD, NU, RADIUS, A, E

BALL = {"type": "sphere", "center": [0.2 * A, 0.0, 0.5 * A], "radius": 0.3 * A,
        "material": {"young-modulus": 0.3 * E, "poisson-ratio": NU}}  # fmt: skip
SCENE = {
    "body1": {"young-modulus": E, "poisson-ratio": NU},
    "geometry": {"type": "sphere", "radius": RADIUS},
    "grid": {"cells": 16, "size": [3.2 * A, 3.2 * A]},
    "steps": {"normal-load": LOAD, "increments": 2},
}
POINTS = [[0.0, 0.0, 0.5 * A], [0.5 * A, 0.0, 0.2 * A]]


class Spy(Observer):
    """Keeps what it sees."""

    key: ClassVar[str] = "probe"
    seen: ClassVar[list] = []

    def observe(self, step):
        self.seen.append(step)
        return {"number": 1.0}


def watched(monkeypatch, scene, spy):
    """Steps that an observer saw, and the result; it takes the place of the probe."""
    from eigencontact.model import observing

    spy.seen.clear()
    monkeypatch.setattr(observing, "build_components", lambda *_: [spy()])
    result = ec.run({**scene, "observers": {"type": "probe", "points": [[0, 0]]}})
    return list(spy.seen), result


@pytest.mark.parametrize("quantity", ["von_mises", pytest.param("hydrostatic", marks=pytest.mark.slow)])
def test_a_stress_probe_reads_what_a_region_stores_and_stores_no_region(quantity):
    probe = {"type": "stress-probe", "points": POINTS, "quantity": quantity}
    region = {"name": "same", "shape": "points", "points": POINTS, "quantities": [quantity]}
    scene = {**SCENE, "inclusions": [BALL]}
    found = ec.run({**scene, "observers": [probe]})
    expected = ec.run({**scene, "stress": [region]}).dataset[f"same_{quantity}"]
    assert not [name for name in found.dataset.variables if name.endswith(f"_{quantity}")]
    assert "max_von_mises" not in found.summary["history"][0]
    for number in (1, 2):
        name = f"stress_probe_{quantity}_{number}"
        np.testing.assert_array_equal(found.dataset[name], expected[:, number - 1])
        assert found.dataset[name].attrs["units"] == "Pa"
        assert found.summary["units"][name] == "Pa"
    largest = found.summary["observed"]["stress_probe_largest"]
    assert abs(largest) == float(np.abs(expected[-1]).max())


def test_a_probe_in_the_second_body_sees_that_body():
    steel = {"young-modulus": E, "poisson-ratio": NU}
    probes = [{"type": "stress-probe", "points": POINTS, "body": body} for body in (1, 2)]
    found = ec.run({**SCENE, "body2": {**steel, "poisson-ratio": 0.1}, "observers": probes}).summary["observed"]
    assert found["stress_probe_1_von_mises_1"] > 0
    assert found["stress_probe_1_von_mises_1"] != close(found["stress_probe_2_von_mises_1"], rel=1e-3)


def test_an_observer_sees_regions_of_the_scene_and_what_bodies_remember(monkeypatch):
    class Seeing(Spy):
        remembered = ("equivalent_eigenstrain_1",)

    region = {"name": "cut", "shape": "plane", "depth-max": A, "depth-cells": 4}
    seen, result = watched(monkeypatch, {**SCENE, "inclusions": [BALL], "stress": region}, Seeing)
    assert [step.index for step in seen] == [1, 2]
    last = seen[-1]
    np.testing.assert_array_equal(last.regions["cut"].fields["stress"], result.dataset["cut_stress"][-1])
    assert last.regions["cut"].dims == ("z", "x")
    known = last.history["equivalent_eigenstrain_1"]
    np.testing.assert_array_equal(known.values, result.dataset["equivalent_eigenstrain_1"][-1])
    assert (known.unit, list(known.coords)) == ("1", ["z", "y", "x"])
    for array in (last.fields["pressure"], last.regions["cut"].fields["stress"], known.values, known.coords["x"]):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0


def test_what_no_body_remembers_is_refused_by_name(monkeypatch):
    class Wanting(Spy):
        remembered = ("damage_1",)

    with pytest.raises(PlanError, match=r"'damage_1' must be provided by a block \(.*observer.*asked for it"):
        watched(monkeypatch, SCENE, Wanting)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"shape": "plane"}, "depths or depth-max"),
        ({"shape": "points", "points": POINTS, "body": 2}, "rigid body2"),
        ({"shape": "points", "pionts": POINTS}, "did you mean 'points'"),
    ],
)
def test_regions_that_the_scene_cannot_have_are_refused_with_the_observer(monkeypatch, table, message):
    class Asking(Spy):
        regions: ClassVar = {"there": table}

    with pytest.raises(PluginError, match=f"observer 'probe' must ask for regions .*{message}"):
        watched(monkeypatch, SCENE, Asking)


def test_numbers_without_a_declared_unit_say_so(monkeypatch):
    _, result = watched(monkeypatch, SCENE, Spy)
    assert result.dataset["probe_number"].attrs["units"] == "unknown"


@dataclass(frozen=True, kw_only=True)
class Nothing(Observer):
    key: ClassVar[str] = "nothing"

    def observe(self, step):  # noqa: ARG002
        return {}


def test_an_observer_asks_for_nothing_unless_it_says_so():
    assert dict(Nothing().units) == {}
    assert dict(Nothing().regions) == {}
    plan = ec.plan({**SCENE, "observers": {"type": "probe", "points": [[0, 0]]}})
    assert [block.name for block in plan.blocks if block.name.startswith("stress")] == []


def test_bundled_observers_declare_the_units_of_all_their_numbers():
    friction = {"friction": {"type": "coulomb", "coefficient": 0.3},
                "steps": [{"normal-load": LOAD}, {"tangential-load-x": 0.1 * LOAD}]}  # fmt: skip
    observers = [{"type": "dissipated-energy"}, {"type": "stick-radius"}, {"type": "fretting-loop"},
                 {"type": "fretting-loop", "motion": "twist"}, {"type": "probe", "points": [[0, 0]], "field": "gap"},
                 {"type": "stress-probe", "points": POINTS}]  # fmt: skip
    result = ec.run({**SCENE, **friction, "observers": observers})
    units = {name: result.dataset[name].attrs["units"] for name in result.summary["observed"]}
    assert len(units) > 20
    assert "unknown" not in units.values()
    assert units["probe_gap_1"] == "m"
    assert units["fretting_loop_4_moment"] == "N m"
