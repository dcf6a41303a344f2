"""Wear laws: closed forms at cells and in runs, units, increments do not count, refusals of a stranger's."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest

from close import close
from eigencontact import load_scene, make, run
from eigencontact.errors import PluginError
from eigencontact.plugin import WearLaw, WearState
from eigencontact.plugin.wear import checked_depth
from plugins.wrong_answers import wrong_answers

UM = 1e-6
X, Y = UM * np.arange(-2.0, 3.0)[None, :], UM * np.arange(-1.0, 2.0)[:, None]
SHAPE = (3, 5)
RAMP = np.arange(15.0).reshape(SHAPE)


def state(**arrays):
    zero = np.zeros(SHAPE)
    names = ("pressure", "shear", "slip", "slip_amplitude", "energy", "worn_depth", "total_energy")
    fields = {name: np.broadcast_to(arrays.get(name, zero), SHAPE).astype(float) for name in names}
    return WearState(**fields, material=np.zeros(SHAPE, dtype=np.intp), x=X, y=Y, time=1.0)


def law(key, **fields):
    return make(key, kind="wear-law", **fields)


# law, state, expected depth [m]
DEPTHS = {
    "archard": (law("archard", coefficient=2e-13), {"pressure": 1e9 * RAMP, "slip": 3e-6}, 6e-10 * RAMP),
    "archard with a hardness": (
        law("archard", coefficient=1e-4, hardness="2 GPa"),
        {"pressure": 1e9 * RAMP, "slip": 4e-6},
        2e-10 * RAMP,
    ),
    "archard without friction": (
        law("archard", coefficient=2e-13),
        {"pressure": 1e9, "slip": 3e-6 * RAMP, "energy": 0.0},
        6e-10 * RAMP,
    ),
    "energy": (law("dissipated-energy", coefficient=2e-12), {"energy": 50.0 * RAMP, "pressure": 1.0}, 1e-10 * RAMP),
    "energy of what has opened": (law("dissipated-energy", coefficient=2e-12), {"energy": 50.0 * RAMP}, 1e-10 * RAMP),
    "amplitude": (
        law("amplitude-scaled", coefficient=1e-2),
        {"energy": 50.0, "slip_amplitude": 1e-9 * RAMP, "slip": 4e-9 * RAMP},
        5e-10 * RAMP,
    ),
    "threshold": (
        law("threshold-energy", coefficient=1e-12, threshold=100.0),
        {"energy": 30.0, "total_energy": 10.0 * RAMP},
        1e-12 * np.clip(10.0 * RAMP - 70.0, 0.0, 30.0),
    ),
    "no threshold": (law("threshold-energy", coefficient=1e-12, threshold=0.0), {"energy": RAMP}, 1e-12 * RAMP),
}


@pytest.mark.parametrize("case", DEPTHS)
def test_depths(case):
    found, arrays, expected = DEPTHS[case]
    np.testing.assert_allclose(checked_depth(found, state(**arrays)), expected, rtol=1e-14, atol=0)


# law, its field, what a scene writes, SI value
UNITS = [
    ("archard", "coefficient", "1e-13 m^3/(N m)", 1e-13),
    ("archard", "coefficient", "1e-4 mm^3/(N m)", 1e-13),
    ("archard", "coefficient", "2 /TPa", 2e-12),
    ("archard", "hardness", "2 GPa", 2e9),
    ("dissipated-energy", "coefficient", "1e-3 mm^3/J", 1e-12),
    ("dissipated-energy", "coefficient", "1 um^3/J", 1e-18),
    ("dissipated-energy", "coefficient", 1e-12, 1e-12),
    ("amplitude-scaled", "coefficient", "1e4 mm^3/(J mm)", 1e-2),
    ("amplitude-scaled", "coefficient", "3 mm^2/J", 3e-6),
    ("threshold-energy", "coefficient", "1e-3 mm^3/J", 1e-12),
    ("threshold-energy", "threshold", "2 kJ/m^2", 2e3),
    ("threshold-energy", "threshold", "2 mJ/mm^2", 2e3),
]


@pytest.mark.parametrize(("key", "name", "text", "value"), UNITS)
def test_units(key, name, text, value):
    others = {"threshold-energy": {"coefficient": 1.0, "threshold": 1.0}}.get(key, {"coefficient": 1.0})
    assert getattr(law(key, **others | {name: text}), name) == close(value, rel=1e-14, abs=0)


def test_a_law_of_amplitude_is_that_of_energy_at_its_reference():
    """WR-7: alpha' = alpha_ref / delta_ref, and V = alpha_ref E where the amplitude is delta_ref."""
    reference = 25e-6
    scaled, plain = law("amplitude-scaled", coefficient=1e-12 / reference), law("dissipated-energy", coefficient=1e-12)
    at = state(energy=50.0 * RAMP, slip_amplitude=reference)
    np.testing.assert_allclose(scaled.depth(at), plain.depth(at), rtol=1e-14)
    twice = replace(at, slip_amplitude=2.0 * at.slip_amplitude)
    np.testing.assert_allclose(scaled.depth(twice), 2.0 * plain.depth(twice), rtol=1e-14)


def test_only_the_law_of_energy_knows_its_volume():
    assert law("dissipated-energy", coefficient=3e-12).volume_per_energy == 3e-12
    assert law("archard", coefficient=1e-13).volume_per_energy is None
    assert law("threshold-energy", coefficient=1e-12, threshold=1.0).volume_per_energy is None


def scene(wear, *, steps=(), increments=2, repeat=1, shift="100 nm"):
    """A ball of 6 um contact radius on 12 x 12 cells, rubbed to and fro in partial slip."""
    cycle = [
        {"shift-x": shift, "increments": increments},
        {"shift-x": f"-{shift}", "increments": 2 * increments},
        {"shift-x": 0.0, "increments": increments},
    ]
    return load_scene(
        {
            "body1": {"young-modulus": "210 GPa", "poisson-ratio": 0.3},
            "geometry": {"type": "sphere", "radius": "105 um"},
            "friction": {"type": "coulomb", "coefficient": 0.5},
            "wear": wear,
            "grid": {"cells": 12, "size": ["15 um", "15 um"]},
            "steps": [{"normal-load": "0.65 N"}, *(steps or [{"cycle": cycle, "repeat": repeat}])],
            "numerics": {"threads": 1, "coupling": "none", "tolerance": 1e-9},
            "output": {"pictures": False, "vtk": False},
        }
    )


#: So little wear that the pressure does not change: what a law says is what a run must give.
LITTLE = 1e-9


def test_a_law_of_amplitude_does_not_count_increments():
    """5, 10 and 20 increments a quarter of a cycle, from stick to gross slip and back."""
    wear = {"type": "amplitude-scaled", "coefficient": "1 mm^3/(J mm)"}
    runs = [run(scene(wear, increments=count, shift="400 nm")).dataset.isel(step=-1) for count in (5, 10, 20)]
    depth = [one["worn_depth"].values for one in runs]
    assert depth[0].max() > 1e-11
    for other in depth[1:]:
        np.testing.assert_allclose(other, depth[0], rtol=0, atol=1e-6 * depth[0].max())


def test_the_amplitude_of_a_cycle_is_a_quarter_of_its_path():
    last = run(scene({"type": "amplitude-scaled", "coefficient": LITTLE * 1e-2})).dataset.isel(step=-1)
    slipped, energy = last["slip_distance"].values, last["dissipated_energy_density"].values
    expected = LITTLE * 1e-2 * 0.25 * slipped * energy
    np.testing.assert_allclose(last["worn_depth"], expected, rtol=0, atol=1e-6 * expected.max())
    # There and back by 2 A each, less what is lost to elasticity: A is below the 100 nm of the bodies.
    assert 10e-9 < 0.25 * slipped.max() < 100e-9


def test_energy_and_volume():
    """WR-7: V = alpha E, by the work of friction that the contact counts."""
    last = run(scene({"type": "dissipated-energy", "coefficient": LITTLE * 1e-12}, repeat=3)).dataset.isel(step=-1)
    assert float(last["worn_volume"]) == close(LITTLE * 1e-12 * float(last["dissipated_energy"]), rel=1e-6)
    assert float(last["energy_volume_residual"]) < 1e-10


def test_a_threshold_is_crossed_within_a_cycle():
    """Where the work of friction passes it in the second of three cycles, what is beyond it wears, no more."""
    plain = run(scene({"type": "dissipated-energy", "coefficient": 0.0}, repeat=3)).dataset
    work = plain["dissipated_energy_density"].isel(step=-1).values
    threshold = 0.4 * float(work.max())  # 1.2 cycles of the cell that has most
    wear = {"type": "threshold-energy", "coefficient": LITTLE * 1e-12, "threshold": threshold}
    last = run(scene(wear, repeat=3)).dataset.isel(step=-1)
    expected = LITTLE * 1e-12 * np.maximum(work - threshold, 0.0)
    assert 0 < np.count_nonzero(expected) < np.count_nonzero(work)
    np.testing.assert_allclose(last["worn_depth"], expected, rtol=0, atol=1e-5 * expected.max())


# law, worn volume [m^3] by load 0.65 N over 1 m at friction 0.5
SLIDING = [
    ({"type": "archard", "coefficient": "1e-18 m^3/(N m)"}, 6.5e-19),
    ({"type": "archard", "coefficient": 1e-8, "hardness": "10 GPa"}, 6.5e-19),
    ({"type": "dissipated-energy", "coefficient": "1 um^3/J"}, 3.25e-19),
]


@pytest.mark.parametrize(("wear", "volume"), SLIDING)
def test_gross_sliding_wears_by_load_and_path(wear, volume):
    slide = {"normal-load": "0.65 N", "sliding-distance": "1 m", "increments": 2}
    last = run(scene(wear, steps=[slide])).dataset.isel(step=-1)
    assert float(last["worn_volume"]) == close(volume, rel=1e-6)


@dataclass(frozen=True, kw_only=True)
class Stranger(WearLaw):
    """Answers with what it is told to."""

    key: ClassVar[str] = "stranger"

    answer: object

    def depth(self, state):
        return self.answer(state) if callable(self.answer) else self.answer


WRONG = wrong_answers(SHAPE, "m", "cells", "slip")


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_answer_names_the_law(case):
    answer, words = WRONG[case]
    with pytest.raises(PluginError, match=rf"^depth of wear law 'stranger' {words}"):
        checked_depth(Stranger(answer=answer), state())
