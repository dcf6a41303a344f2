"""Damage by a mean over a neighbourhood: with the contact in one solve, whatever the box; what a length that is no
length does, and a stranger's law."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import NotUnique
from eigencontact.execution.interiors.averages import Averages
from eigencontact.plugin import LawStep

SIDE, CELLS = 0.36e-6, 8
LOAD, UNLOAD = {"normal_load": "10 uN", "increments": 1}, {"normal_load": "0 N"}
PERFECT = {"type": "perfect", "yield-stress": "100 MPa"}
FADING = {"type": "exponential", "saturation": 0.6, "strain": 0.02}


def bone(length=None, steps=(LOAD,), hardening=PERFECT, fading=FADING, **numerics):
    damage = fading if length is None else fading | {"length": length}
    return ec.Scene(
        body1={
            "young_modulus": "18.6 GPa",
            "poisson_ratio": 0.3,
            "law": {"type": "j2", "hardening": hardening, "damage": damage, "yield-on": "effective"},
        },
        geometry={"type": "sphere", "radius": "2 um"},
        grid={"cells": [CELLS, CELLS], "size": [SIDE, SIDE]},
        steps=list(steps),
        numerics={"inclusion_pitch": SIDE / CELLS, "allow_coarse": True, "tolerance": 1e-5, **numerics},
        output={"pictures": False},
    )


@pytest.fixture(scope="module")
def local():
    return ec.run(bone()).dataset


@pytest.fixture(scope="module")
def averaged():
    return ec.run(bone("90 nm", [LOAD, UNLOAD])).dataset


def test_a_length_within_a_cell_is_none(local):
    """The same result by another iteration, in which the damage is an unknown of its own."""
    found = ec.run(bone("20 nm")).dataset
    np.testing.assert_allclose(found["approach"], local["approach"], rtol=1e-4)
    assert float(local["damage_1"].max()) > 0.3
    for statistic in ("max", "sum"):
        one, other = (float(getattr(data["damage_1"], statistic)()) for data in (found, local))
        assert one == close(other, rel=1e-3)


@pytest.mark.slow
def test_damage_is_that_of_the_mean_strain(averaged, local):
    """What is stored obeys the definition: D of the weighted mean of p; the peak is lower than without."""
    p, damage = (averaged[f"{name}_1"].values[0] for name in ("equivalent_plastic_strain", "damage"))
    places = np.stack(np.meshgrid(*(averaged[f"cells_1_{axis}"] for axis in "zyx"), indexing="ij"), axis=-1)
    k, j, i = np.unravel_index(damage.argmax(), damage.shape)
    squared = np.sum((places - places[k, j, i]) ** 2, axis=-1)
    weight = np.maximum(1 - squared / 90e-9**2, 0) ** 2
    mean = np.sum(weight * p) / weight.sum()
    np.testing.assert_allclose(damage[k, j, i], 0.6 * (1 - np.exp(-mean / 0.02)), rtol=1e-4)
    assert damage.max() < 0.97 * local["damage_1"].values.max()
    rims = [damage[-1], damage[:, [0, -1]], damage[:, :, [0, -1]]]
    assert max(float(np.abs(rim).max()) for rim in rims) == 0.0


@pytest.mark.slow
def test_the_result_does_not_depend_on_the_first_box(averaged):
    found = ec.run(bone("90 nm", [LOAD, UNLOAD], law_room=0.6)).dataset
    np.testing.assert_allclose(found["approach"], averaged["approach"], rtol=1e-4)
    assert found["damage_1"].size > averaged["damage_1"].size
    np.testing.assert_allclose(found["damage_1"].max(), averaged["damage_1"].max(), rtol=1e-3)


def test_two_laws_side_by_side_average_each_its_own_cells():
    """A constant stays a constant up to the interface, and a law without a length is told no mean."""

    class Soft:
        def __init__(self, averaged):
            self.averaged = averaged
            self.variables = {"strain": type("V", (), {"components": 1}), "other": type("V", (), {"components": 2})}

    halves = np.arange(24).reshape(2, 3, 4) % 4 < 2
    cells = [np.flatnonzero(part) for part in (halves, ~halves)]
    laws = [(Soft({"other": 2.0}), cells[0]), (Soft({}), cells[1])]
    found = Averages(laws, halves.shape, (1.0, 1.0, 1.0))
    known = {"strain": np.zeros((1, 12)), "other": np.array([[1.0], [3.0]]) * np.ones((2, 12))}
    fields = found.of([known, known])
    assert fields.shape == (2, 2, 3, 4)
    np.testing.assert_allclose(fields[:, halves], known["other"], rtol=1e-13)
    assert not fields[:, ~halves].any()
    point = LawStep(x=np.zeros(12), y=np.zeros(12), z=np.zeros(12), time=1.0, duration=1.0)
    first, second = found.with_means([point, point], fields)
    np.testing.assert_allclose(first.means["other"], known["other"], rtol=1e-13)
    assert second.means == {}
    assert found.width == (2, 2, 2)


STEEP = {"type": "linear", "yield-stress": "100 MPa", "modulus": "-30 GPa"}  # 3 G is 21.5 GPa
BRITTLE = {"type": "exponential", "saturation": 0.9, "strain": 0.0035}


@pytest.mark.parametrize(
    ("changes", "advice"),
    [({"hardening": STEEP}, "give it hardening that falls less steeply"), ({"fading": BRITTLE}, "a length in damage")],
)
def test_what_has_no_unique_answer_is_refused_by_cell_law_and_remedy(changes, advice):
    place = r"first cell \(\d+, \d+, \d+\) \(layer, row, column\) at x = \S+ m, y = \S+ m, z = \S+ m"
    with pytest.raises(NotUnique, match=rf"'j2' softens so fast .* no unique answer, {place}; .*{advice}"):
        ec.run(bone(**changes))


@pytest.mark.slow
def test_a_length_gives_one_answer_where_there_was_none():
    """The strength falls at the rate of -3.6 G at first."""
    found = ec.run(bone("120 nm", fading=BRITTLE, steps=[LOAD | {"normal_load": "3 uN"}])).dataset
    assert 0.1 < float(found["damage_1"].max()) < 0.95
    assert float(found["coupling_residual"].max()) <= 1e-5
