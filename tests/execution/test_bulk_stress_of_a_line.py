"""Bulk stress in a line contact: the stick zone moves as in closed form, and the stress yy follows from xx.

K. L. Johnson 1985, Contact Mechanics, section 7.2; D. Nowell, D. A. Hills 1987, Int. J. Mech. Sci. 29, 355: a bulk
stress that is small and acts in phase with the shear moves the stick zone by e = a sigma / (4 mu p0).
"""

import numpy as np
import pytest

import eigencontact as ec
from close import close

MODULUS, POISSON, RADIUS, LOAD, FRICTION = 119e9, 0.3, 10e-3, 400e3, 0.8
HALF_WIDTH = np.sqrt(4 * LOAD * RADIUS / (np.pi * MODULUS / (2 * (1 - POISSON**2))))
PRESSURE = 2 * LOAD / (np.pi * HALF_WIDTH)
BULK = 200e6


def stretched(cells, **last):
    """Like bodies pressed, then pushed to .6 of what friction carries."""
    steel = {"young-modulus": MODULUS, "poisson-ratio": POISSON}
    scene = {
        "title": "Line", "body1": steel, "body2": steel, "friction": {"type": "coulomb", "coefficient": FRICTION},
        "geometry": {"type": "cylinder", "radius": RADIUS}, "output": {"pictures": False},
        "grid": {"length": "infinite", "cells-per-contact-radius": cells, "margin": 1.25},
        "steps": [{"normal-load": LOAD}, {"tangential-load-x": 0.6 * FRICTION * LOAD, "increments": 4, **last}],
        "stress": [{"name": "deep", "shape": "points", "points": [[0.0, 0.0, 100 * HALF_WIDTH]]}],
    }  # fmt: skip
    return ec.run(scene).dataset.isel(step=-1)


def stick_zone(dataset):
    """Middle and half width of the cells that stick."""
    x = dataset["x"].values
    sticking = x[dataset["contact_zone"].values[0] == 2]
    return 0.5 * (sticking[0] + sticking[-1]), 0.5 * np.ptp(sticking) + 0.5 * (x[1] - x[0])


@pytest.mark.parametrize("sign", [1, -1])
def test_the_stick_zone_moves_by_the_closed_form(sign):
    cells = 64
    middle, half_width = stick_zone(stretched(cells, **{"bulk-stress-xx": sign * BULK}))
    shift = HALF_WIDTH * BULK / (4 * FRICTION * PRESSURE)
    assert shift > 4 * HALF_WIDTH / cells
    assert abs(middle) == close(shift, rel=0, abs=HALF_WIDTH / cells)
    assert half_width == close(np.sqrt(0.4) * HALF_WIDTH, rel=0, abs=HALF_WIDTH / cells)
    unmoved, _ = stick_zone(stretched(cells))
    assert unmoved == close(0.0, rel=0, abs=1e-9 * HALF_WIDTH)


def test_the_stick_zone_moves_to_the_other_side_in_the_other_body():
    first, _ = stick_zone(stretched(32, **{"bulk-stress-xx": BULK}))
    second, _ = stick_zone(stretched(32, **{"body2-bulk-stress-xx": BULK}))
    assert second == close(-first, rel=0, abs=1e-9 * HALF_WIDTH)
    both, _ = stick_zone(stretched(32, **{"bulk-stress-xx": BULK, "body2-bulk-stress-xx": BULK}))
    assert both == close(0.0, rel=0, abs=1e-9 * HALF_WIDTH)


def test_far_below_there_is_the_bulk_stress_alone_and_no_strain_along_the_line():
    dataset = stretched(16, **{"bulk-stress-xx": BULK})
    bare = stretched(16)
    stress = (dataset["deep_stress"] - bare["deep_stress"]).squeeze()
    assert float(stress.sel(component="xx")) == close(BULK, rel=2e-3)
    assert float(stress.sel(component="yy")) == close(POISSON * BULK, rel=2e-3)
    assert float(abs(stress.sel(component="zz"))) < 2e-3 * BULK


@pytest.mark.parametrize("component", ["yy", "xy"])
def test_other_components_are_refused(component):
    with pytest.raises(ec.EigencontactError, match=f"bulk-stress-{component} must be left out in a line contact"):
        stretched(8, **{f"bulk-stress-{component}": BULK})
