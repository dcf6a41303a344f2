"""Fatigue of a run: the number is the criterion's own, at the place it names; refusals."""

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.plugin import StressCycle, to_mandel

CRITERION = {"type": "crossland", "slope": 0.3, "limit-amplitude": "250 MPa"}


@pytest.fixture(scope="module")
def pressed():
    changes = ["grid.cells-per-contact-radius=8", "stress.0.depth-cells=10"]
    return ec.run(ec.load_scene("hertz", changes))


def test_hot_spot_is_the_largest_value_of_the_criterion(pressed):
    found = ec.fatigue(pressed, CRITERION, cycle="all", region="section")
    stress = pressed.dataset["section_stress"].values
    mandel = np.stack([to_mandel(step.reshape(6, -1)) for step in stress])
    parameters = {"slope": 0.3, "limit_amplitude": 250e6}
    expected = ec.make("crossland", **parameters).damage(StressCycle(stress=mandel)).value
    np.testing.assert_allclose(found.dataset.utilisation.values.ravel(), expected / 250e6, rtol=1e-12, atol=0)
    assert found.summary["utilisation"] == found.dataset.utilisation.values.max()


def test_refusals(pressed):
    with pytest.raises(ec.EigencontactError, match="cycle must be given"):
        ec.fatigue(pressed, CRITERION)
    with pytest.raises(ec.EigencontactError, match="region must name one with stress"):
        ec.fatigue(pressed, CRITERION, cycle="all", region="nowhere")
    with pytest.raises(ec.EigencontactError, match="distance must be positive"):
        ec.fatigue(pressed, CRITERION, cycle="all", region="section", distance=-1.0)
