"""Load steps in which cells flow are halved until a stated accuracy, and others are not."""

from functools import cache

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL, SWIFT, perfect, pressed

LOAD, UNLOAD = {"normal_load": "0.65 N"}, {"normal_load": "0 N"}


def run(steps, error=None, law=SWIFT, cells=8):
    numerics = {"inclusion_pitch": "2 um", **({"plastic_error": error} if error else {})}
    return ec.run(ec.Scene(**pressed(law, steps, cells, numerics=numerics))).dataset


def strain(data):
    return data["plastic_strain_1"][-1].values


@pytest.fixture(scope="module")
def fine():
    return run([{**LOAD, "increments": 12}, UNLOAD])


@pytest.fixture(scope="module")
def coarse():
    """EP-1 in one step."""
    return run([LOAD, UNLOAD])


@pytest.fixture(scope="module")
def within():
    """Run in one step with cuts to an error, each once."""
    return cache(lambda error: run([LOAD, UNLOAD], error))


@pytest.mark.slow
@pytest.mark.parametrize("error", [0.03, 0.005])
def test_one_step_is_halved_until_its_error_is_small_enough(coarse, fine, within, error):
    """The error that is told is that which is left, within a factor; the print comes nearer as it falls."""
    found = within(error)
    told, cut = found["plastic_error"].values, found["substeps"].values
    assert 0.0 < told[0] <= error
    assert cut[0] == (2 if error == 0.03 else 6)  # where little flows halves suffice
    assert (told[1], cut[1]) == (0.0, 1.0)  # unloading is elastic: nothing to halve
    off = [float(abs(data["print_depth"][-1] - fine["print_depth"][-1])) for data in (found, coarse)]
    assert off[0] < (0.7 if error == 0.03 else 0.2) * off[1]
    size = np.linalg.norm(strain(fine))
    left = np.linalg.norm(strain(found) - strain(fine)) / size
    assert left < np.linalg.norm(strain(coarse) - strain(fine)) / size
    assert left < 3.0 * error


@pytest.mark.slow
def test_what_is_tried_counts_as_work(coarse, within):
    found = within(0.03)
    assert found["inclusion_iterations"][0] > 1.5 * coarse["inclusion_iterations"][0]


def test_elastic_steps_cost_nothing():
    plain, asked = (run([LOAD, UNLOAD], error, perfect("5.45 GPa")) for error in (None, 1e-3))
    for name in ("pressure", "inclusion_iterations", "substeps", "convolutions"):
        np.testing.assert_array_equal(asked[name], plain[name])


@pytest.mark.parametrize("error", [0.0, 2.0])
def test_errors_that_mean_nothing_are_refused(error):
    with pytest.raises(ec.EigencontactError, match=r"numerics\.plastic-error"):
        ec.Scene(body1=STEEL, geometry={"type": "sphere", "radius": 1}, steps=LOAD, numerics={"plastic_error": error})
