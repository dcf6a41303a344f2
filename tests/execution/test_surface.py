"""The surfaces of a step as one value: halved with an increment, and followed by the contact where bodies change."""

from dataclasses import replace

import numpy as np

import eigencontact as ec
from close import close
from eigencontact.execution.blocks.block import Run
from eigencontact.execution.blocks.surface import Slide, Surface
from eigencontact.execution.mechanics.mechanics import Mechanics
from eigencontact.execution.run.driver import drive
from eigencontact.solvers.control import Control

RADIUS, SIZE = 200e-6, 100e-6


def test_halves_share_the_slide_and_only_the_first_has_moved():
    whole = Surface(separation=np.ones((2, 3)), slide=Slide(distance=4.0, direction=(0.6, 0.8)), moved=True)
    first, second = whole.halves()
    assert first.slide == second.slide == Slide(distance=2.0, direction=(0.6, 0.8))
    assert (first.moved, second.moved) == (True, False)
    assert first.separation is second.separation is whole.separation
    assert Surface().halves()[0].slide is None


def scene(thickness, **changes):
    solid = {"young-modulus": 210e9, "poisson-ratio": 0.3}
    layer = {"thickness": thickness, "young-modulus": 420e9, "poisson-ratio": 0.3}
    medium = {"type": "bonded-layers", "layers": [layer], "substrate": solid}
    return ec.Scene(**{
        "body1": {"medium": medium}, "body2": {"rigid": True}, "geometry": {"type": "sphere", "radius": RADIUS},
        "steps": {"normal-load": 5.0}, "grid": {"cells": 16, "size": [SIZE, SIZE]}, "numerics": {"threads": 1},
        **changes,
    })  # fmt: skip


def started(plan):
    (mechanics,) = (block for block in plan.blocks if isinstance(block, Mechanics))
    return Run().started(mechanics.start)


def test_the_contact_follows_the_bodies_of_a_surface():
    """Pressure and softness of thinned layers are those of a scene with such layers; a like body changes nothing."""
    thick, thin = ec.plan(scene(10e-6)), ec.plan(scene(4e-6))
    y, x = thick.grid.axes()
    new = Surface(separation=(x**2 + y**2) / (2 * RADIUS))
    running, control = started(thick), Control(normal_load=5.0)
    pressures = [
        mechanics.pressed(surface, control, {}, None, None)
        for mechanics, surface in (
            (running, new),
            (running, replace(new, solids=thick.model.bodies.solids)),
            (running, replace(new, solids=thin.model.bodies.solids)),
            (started(thin), new),
        )
    ]
    np.testing.assert_array_equal(pressures[0], pressures[1])
    np.testing.assert_array_equal(pressures[2], pressures[3])
    assert np.abs(pressures[0] - pressures[2]).max() > 1e-3 * pressures[0].max()
    assert running.softness(thin.model.bodies.solids) == close(started(thin).softness(None))
    assert running.softness(thick.model.bodies.solids) == close(started(thick).softness(None))


def test_the_driver_asks_blocks_how_many_cycles_a_step_stands_for(monkeypatch):
    """A block that jumps over two cycles after each solved one, in a scene without wear."""
    cycle = {"cycle": [{"normal-load": 2.0}, {"normal-load": 5.0}], "repeat": 7}
    friction = {"type": "coulomb", "coefficient": 0.3}
    plan = ec.plan(scene(10e-6, friction=friction, steps=[{"normal-load": 5.0}, cycle], numerics={"coupling": "none"}))
    assert {name for block in plan.blocks for name in block.accumulated} == {
        "slip_distance", "dissipated_energy_density"
    }  # fmt: skip
    monkeypatch.setattr(Mechanics, "cycles_of", lambda *_: 3)
    assert [record.time for record in drive(plan)] == [1.0, 2.0, 3.0, 8.0, 9.0, 14.0, 15.0]
