"""Reference cases of normal elastic contact, run as scenes, against the oracle and its printed numbers."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact_verification.oracles import hertz

CASES = {
    # case: radius [m], load [N], Young's modulus [Pa]; radius of contact [m], peak pressure [Pa], approach [m]
    "HZ-1": (105e-6, 0.65, 210e9, 6.0533e-6, 8469.6e6, 348.98e-9),
    "HZ-2": (200e-6, 12.307, 210e9, 20.000e-6, 14.691e9, 2.000e-6),
    "HZ-5": (105e-6, 0.65, 0.8 * 210e9, 1.0772 * 6.0533e-6, 0.8618 * 8469.6e6, 1.1604 * 348.98e-9),
}


@pytest.mark.parametrize("cells", [21, 24, 29, 37])
@pytest.mark.parametrize("case", CASES)
def test_hertz_to_half_a_per_cent_from_twenty_cells_on(case, cells):
    radius, load, modulus, a, p0, approach = CASES[case]
    result = ec.run(
        {
            "body1": {**STEEL, "young-modulus": modulus},
            "geometry": {"type": "sphere", "radius": radius},
            "grid": {"cells-per-contact-radius": cells},
            "steps": {"normal-load": load},
        }
    )
    pitch = float(result.dataset.x[1] - result.dataset.x[0])
    assert a / pitch >= 20
    summary = result.summary
    assert summary["contact_radius"] == close(a, rel=5e-3)
    assert summary["max_pressure"] == close(p0, rel=1e-3)
    assert summary["approach"] == close(approach, rel=5e-4)
    exact = hertz.hertz_sphere(load, radius, modulus / (1 - 0.3**2))
    assert (a, p0, approach) == close(exact, rel=1e-4)


def test_dissimilar_bodies_press_like_one_of_their_contact_modulus():
    """Steel on glass: the closed form knows the bodies by E* alone."""
    bodies = [{**STEEL}, {"young-modulus": "70 GPa", "poisson-ratio": 0.22}]
    modulus = 1 / ((1 - 0.3**2) / 210e9 + (1 - 0.22**2) / 70e9)
    grid = {"cells": [96, 96], "size": [3e-5, 3e-5]}
    scene = {"geometry": {"type": "sphere", "radius": 1e-4}, "grid": grid, "steps": {"normal-load": 0.5}}
    both = ec.run({"body1": bodies[0], "body2": bodies[1], **scene}).dataset
    single = {"young-modulus": modulus * (1 - 0.25**2), "poisson-ratio": 0.25}
    one = ec.run({"body1": single, **scene}).dataset
    np.testing.assert_allclose(both.pressure, one.pressure, rtol=0, atol=1e-9 * float(one.pressure.max()))
