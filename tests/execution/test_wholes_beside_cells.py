"""Whole inclusions beside cells of the same body: in a body that yields, and beside shapes that stay in cells."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.errors import SceneError
from hz_1 import LOAD, NU, P0, RADIUS, A, E

POINTS = {"shape": "points", "points": [[0, 0, 0.5 * A], [0.1 * A, 0, 0.2 * A], [0.5 * A, 0.3 * A, 0.6 * A]]}


def stiff(ratio):
    return {"young-modulus": ratio * E, "poisson-ratio": NU}


def ball(ratio=2.0, x=0.0, **more):
    return {
        "type": "sphere", "center": [x * A, 0.0, 0.6 * A], "radius": 0.3 * A, "material": stiff(ratio), **more,
    }  # fmt: skip


def yields(stress):
    return {
        **STEEL,
        "law": {"type": "j2", "hardening": {"type": "linear", "yield-stress": stress, "modulus": 0.05 * E}},
    }


def scene(*inclusions, body=STEEL, resolution=None, cells=27, steps=None):
    return {
        "body1": body,
        "geometry": {"type": "sphere", "radius": RADIUS},
        "grid": {"cells": cells, "size": [2.6 * A, 2.6 * A]},
        "steps": steps or {"normal-load": LOAD},
        "inclusions": list(inclusions),
        "numerics": {"tolerance": 1e-6, "inclusion-resolution": resolution or {"whole": 3}},
        "stress": POINTS,
    }


@pytest.mark.slow
def test_a_law_that_never_yields_changes_nothing():
    """Its cells carry no eigenstrain, not even those that the ball cuts."""
    patch = {"type": "cuboid", "center": [0.0, 0.0, 0.6 * A], "edges": [1.2 * A, 1.2 * A, 1.0 * A]}
    law = {"type": "j2", **stiff(1.0), "hardening": {"type": "perfect", "yield-stress": 1e3 * P0}}
    alone = ec.run(scene(ball(), cells=17))
    around = ec.run(scene({**patch, "material": law}, ball(), cells=17))
    assert "equivalent_eigenstrain_1" in around.dataset
    assert "whole_eigenstrain_1" in around.dataset
    np.testing.assert_allclose(around.dataset["pressure"], alone.dataset["pressure"], rtol=0, atol=1e-5 * P0)
    name = "points_body1_von_mises"
    np.testing.assert_allclose(around.dataset[name], alone.dataset[name], rtol=1e-4)


@pytest.mark.slow
def test_a_ball_in_a_body_that_yields_agrees_with_cells():
    """With the eigenstrain of its own cells the print is smaller, as it is on coarse cells without the ball."""
    steps = [{"normal-load": LOAD, "increments": 3}, {"normal-load": 0.0}]
    body = yields(0.45 * P0)
    options = {"body": body, "steps": steps, "cells": 23}
    whole, cells = (ec.run(scene(ball(), resolution=how, **options)) for how in ({"whole": 3}, "cells"))
    for name, bound in (("print_depth", 0.06), ("plastic_volume", 0.05)):
        assert whole.summary[name] == close(cells.summary[name], rel=bound)
    assert whole.summary["print_depth"] > cells.summary["print_depth"]
    assert whole.summary["coupling_residual"] < 1e-6


@pytest.mark.slow
def test_the_print_over_a_stiff_ball():
    """Case EP-12 (finite elements: 109.4 nm): cells alone 96 and 100 nm on 8 and 12 cells a radius, 99 and 102 here."""
    changes = ["numerics.inclusion-resolution={whole=4}", "grid.cells-per-contact-radius=8"]
    from eigencontact.app import load_scene

    found = ec.run(load_scene("hard-inclusion-in-plastic-matrix", changes)).summary["print_depth"]
    assert 98e-9 < found < 105e-9


@pytest.mark.slow
def test_shapes_without_moments_stay_in_cells():
    """A stiff block beside a stiff ball: the ball as a whole, the block in cells, against both in cells."""
    block = {"type": "cuboid", "center": [0.5 * A, 0.0, 0.6 * A], "edges": [0.3 * A] * 3, "material": stiff(3)}
    mixed, cells = (ec.run(scene(ball(x=-0.3), block, resolution=how)) for how in ({"whole": 3}, "cells"))
    assert "{ whole" not in ec.explain(scene(ball(x=-0.3), block))
    difference = np.abs(mixed.dataset["pressure"] - cells.dataset["pressure"])[-1].values
    assert difference[9:18, 9:18].max() < 0.01 * P0
    name = "points_body1_von_mises"
    np.testing.assert_allclose(mixed.dataset[name][-1, 2], cells.dataset[name][-1, 2], rtol=0.02)


@pytest.mark.slow
def test_a_run_continues_from_what_is_stored(tmp_path):
    """Both eigenstrains are stored; a region afterwards sees them as the run did."""
    steps = [{"normal-load": 0.8 * LOAD}]
    written = scene(ball(), body=yields(0.45 * P0), steps=steps, cells=13)
    stored = ec.run({**written, "output": {"pictures": False}}, tmp_path).dataset
    found = ec.region(tmp_path, {**POINTS, "name": "later"})
    name = "von_mises"
    np.testing.assert_array_equal(found[f"later_{name}"][-1], stored[f"points_body1_{name}"][-1])


def test_without_a_contact_all_or_none_are_wholes():
    block = {"type": "cuboid", "center": [0.5 * A, 0.0, 0.6 * A], "edges": [0.3 * A] * 3, "material": stiff(3)}
    free = scene(ball(eigenstrain=1e-3), block)
    del free["geometry"], free["steps"]
    with pytest.raises(SceneError, match='must be "cells" without a contact'):
        ec.plan(free)
