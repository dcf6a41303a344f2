"""Contact at the edge of its window: where, in which step, and a load that does fit."""

import re

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import DomainTooSmall
from eigencontact_verification.oracles import hertz

SPHERE = {"type": "sphere", "radius": 1e-3}
BODIES = {"body1": {"young-modulus": 210e9, "poisson-ratio": 0.3}, "body2": {"rigid": True}}
MODULUS = 210e9 / (1 - 0.3**2)
WINDOW = {"cells": 48, "size": 60e-6}


def refused(**tables):
    """Message of a run, and what fits by it, in the unit that it says."""
    with pytest.raises(DomainTooSmall) as caught:
        ec.run(ec.load_scene(BODIES | tables))
    message = str(caught.value)
    assert "\n" not in message
    fits = re.search(r"\(about ([0-9.]+) (m?N|u?m|nm) fits\)", message)
    return message, fits and float(fits[1]) * {"mN": 1e-3, "N": 1.0, "um": 1e-6, "nm": 1e-9}[fits[2]]


def test_the_load_that_fits_is_that_of_hertz_in_the_window():
    """A contact of the radius of half the window, 30 um, less one cell and what is kept for safety."""
    steps = [{"normal-load": 1.0}, {"normal-load": 30.0}]
    message, fits = refused(geometry=SPHERE, grid=WINDOW, steps=steps)
    assert message.startswith(
        "contact must stay inside the window (in load step 2, at normal load 30 N, it reaches its edge along x and y;"
        " the window is 60 um x 60 um, given in the scene); lower the normal load (about "
    )
    assert message.endswith(
        " fits), enlarge grid size, set numerics.boundary = 'periodic' if the surfaces repeat, or"
        " numerics.allow-contact-at-edge = true if the bodies end there"
    )
    a, *_ = hertz.hertz_sphere(fits, 1e-3, MODULUS)
    assert 26e-6 < a < 30e-6


def test_an_approach_that_fits():
    message, fits = refused(geometry=SPHERE, grid=WINDOW, steps={"approach": 3e-6})
    assert "at approach 3 um" in message
    assert 0.7 * 30e-6**2 / 1e-3 < fits < 30e-6**2 / 1e-3  # a^2 / R


def test_the_recommended_load_fits_a_measured_ball_and_twice_as_much_does_not():
    geometry = [{"type": "topography", "file": "gallery:rough_surface.npz"}, SPHERE]
    message, fits = refused(geometry=geometry, steps={"normal-load": 40.0})
    assert "the window is 64 um x 64 um, the grid that the geometry 'topography' brings" in message
    assert "measure a larger patch or let it go on (outside = 'mirror', and a larger grid)" in message
    assert ec.run(ec.load_scene(BODIES | {"geometry": geometry, "steps": {"normal-load": fits}})).summary["converged"]
    refused(geometry=geometry, steps={"normal-load": 2 * fits})


def test_a_mirrored_map_in_a_larger_window_carries_the_load():
    rough = {"type": "topography", "file": "gallery:rough_surface.npz", "outside": "mirror"}
    tables = {"geometry": [rough, SPHERE], "grid": {"spacing": 2e-6, "cells": 80}, "steps": {"normal-load": 40.0}}
    result = ec.run(ec.load_scene(BODIES | tables))
    a, _, approach = hertz.hertz_sphere(40.0, 1e-3, MODULUS)
    assert result.summary["approach"] == close(approach, rel=0.1)  # the peaks stand 0.16 um above the mean plane
    pressure = result.dataset.pressure.values[-1]
    assert 32e-6 < a < 80e-6
    assert (pressure[:, :24] > 0).any()  # beyond the measured window


def test_surfaces_that_are_flat_on_the_whole_have_no_load_that_fits(tmp_path):
    np.savez(tmp_path / "flat.npz", heights=np.zeros((24, 24)), dx=1e-6)
    flat = {"type": "topography", "file": str(tmp_path / "flat.npz")}
    message, fits = refused(geometry=flat, steps={"normal-load": 2.0})
    assert fits is None
    assert "; no normal load from 2 mN on keeps it inside, as for surfaces flat on the whole, measure a " in message


def test_an_automatic_window_is_widened_by_its_margin():
    message, _ = refused(geometry=SPHERE, grid={"margin": 1.0}, steps={"normal-load": 1.0})
    assert ", raise grid.margin (1), " in message
