"""Layers that wear: as thick in the kernels as their mean in contact; the error of that, and what is refused."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import SceneError
from eigencontact.execution.blocks.block import Run
from eigencontact.execution.blocks.step import Step
from eigencontact.execution.run.driver import drive
from eigencontact.plugin import LayeredMedium
from execution.worn_layer import ARCHARD, LOAD, NU, PEAK, RADIUS, SOLID, E, H, gross_sliding, records


def coated(ratio=2.0, **layer):
    layers = [{"thickness": H, **SOLID, "young-modulus": ratio * E, **layer}]
    return {"medium": {"type": "bonded-layers", "layers": layers, "substrate": SOLID}}


def scene(body1, worn=(0.1, 10), increments=(2, 4), wear=None, **changes):
    usual = {"body1": body1, "grid": {"cells": 40, "size": [5 * H, 5 * H]}, "wear": ARCHARD | (wear or {})}
    return gross_sliding(worn, increments, **usual | changes)


@pytest.mark.slow
@pytest.mark.parametrize("body", [1, 2])
def test_a_coated_body_in_gross_sliding(body):
    """Case WR-17, from rings on a layered half-space: whichever body wears, to 1 %, radii to a cell of a0 / 8."""
    found = records(scene(coated(), wear={"body": body}))
    for record, peak, depth, radius in ((found[2], 1.3663, 0.05325, 0.880), (found[-1], 0.2139, 1.51853, 1.820)):
        scalars = record.scalars
        assert scalars["max_pressure"] / PEAK == close(peak, rel=0.01)
        assert scalars["max_worn_depth"] / (H**2 / RADIUS) == close(depth, rel=0.01)
        assert abs(scalars["contact_radius"] / H - radius) < 0.125
    assert ("layer_error" in scalars) == (body == 1)
    if body == 1:
        assert 0.007 < scalars["layer_error"] < 0.05
        assert 0.0 < scalars["layer_lost_1"] < scalars["max_worn_depth"]


@pytest.mark.slow
def test_a_coating_of_the_substrate_is_none_worn_through_or_not():
    """The layer is worn through here: nothing is refused, as nothing differs."""
    bare = {"young-modulus": E, "poisson-ratio": NU}
    one, other = (records(scene(body, (1, 10), (1, 3)))[-1] for body in (coated(1.0, thickness=0.1 * H), bare))
    assert one.scalars["max_worn_depth"] > 0.1 * H
    assert one.scalars["layer_error"] < 1e-12
    for name in ("pressure", "worn_depth"):
        largest = np.abs(other.fields[name]).max()
        assert np.abs(one.fields[name] - other.fields[name]).max() < 1e-5 * largest


def test_without_wear_layers_stay():
    """A coefficient of zero leaves every bit of the contact; the kernels are never made anew."""
    worn = records(scene(coated(), wear={"coefficient": 0.0}))
    still = records(scene(coated(), wear={"body": 2, "coefficient": 0.0}))
    np.testing.assert_array_equal(worn[-1].fields["pressure"], still[-1].fields["pressure"])
    assert worn[-1].scalars["layer_lost_1"] == worn[-1].scalars["layer_error"] == 0.0


@pytest.mark.slow
def test_a_run_goes_on_from_its_records_to_the_bit():
    made = scene(coated(), (3,), (5,), grid={"cells": 20, "size": [5 * H, 5 * H]})
    whole = records(made)
    again = list(drive(ec.plan(made), stored_steps={one.index: lambda one=one: one for one in whole[:4]}))
    assert whole[3].scalars["layer_lost_1"] > 0
    for record, known in zip(again, whole[4:], strict=True):
        assert record.scalars["layer_lost_1"] == known.scalars["layer_lost_1"]
        for name in ("pressure", "worn_depth"):
            np.testing.assert_array_equal(record.fields[name], known.fields[name])


def test_plans_say_how_layers_wear():
    assert "layers of body 1 have their mean thickness in contact, error at most 0.05" in ec.explain(scene(coated()))


SECTION = {"name": "section", "shape": "plane", "normal": "y", "depths": [0.5 * H, 1.5 * H]}


def test_worn_through_is_refused_while_the_steps_before_are_kept():
    course, found = (
        drive(ec.plan(scene(coated(thickness=0.1 * H), (3,), (15,), grid={"cells": 20, "size": [5 * H, 5 * H]}))),
        [],
    )
    with pytest.raises(SceneError, match=r"wear.layer-error = 0.05 must be at least .*got .*by cells.*smaller incr"):
        found.extend(iter(lambda: next(course), None))
    assert len(found) >= 2


def test_stress_is_that_below_the_worn_surface_of_thinner_layers():
    """The stress of the last step, against a fresh contact of the same pressure on layers of that thickness."""
    small = {"cells": 16, "size": [5 * H, 5 * H]}
    worn = records(scene(coated(), (4,), (4,), stress=SECTION, grid=small))[-1]
    left = H - worn.scalars["layer_lost_1"]
    fresh = ec.Scene(
        body1=coated(thickness=left), geometry={"type": "sphere", "radius": RADIUS}, steps={"normal-load": LOAD},
        grid=small, stress=SECTION, numerics={"threads": 1},
    )  # fmt: skip
    made = ec.plan(fresh)
    region = next(block for block in made.blocks if block.name == "stress-section")
    step = Step(index=1, time=1.0, fields={"pressure": worn.fields["pressure"]})
    Run().started(region.start).advance(step)
    one, other = (part.regions["section"].fields["stress"] for part in (worn, step))
    assert left < 0.99 * H
    assert np.abs(one - other).max() < 1e-9 * np.abs(other).max()


def test_thinned_layers_are_thinner_layers():
    """Response of two layers that have lost a depth, against the layers that remain, given as such."""

    def medium(*thickness):
        layers = [{"thickness": h, "young-modulus": (9 - n) * E, "poisson-ratio": NU} for n, h in thickness]
        solid = {"young-modulus": E, "poisson-ratio": NU}
        made: LayeredMedium = ec.make("bonded-layers", kind="layered-medium", layers=layers, substrate=solid)
        return made

    worn, k = medium((0, 1e-6), (1, 3e-6)), np.geomspace(1e3, 1e8, 30)
    for lost, left in ((0.25e-6, ((0, 0.75e-6), (1, 3e-6))), (2e-6, ((1, 2e-6),))):
        answers = [
            one.response("displacement", ["z"], "p", k, 0 * k, 0.0) for one in (worn.thinned(lost), medium(*left))
        ]
        np.testing.assert_allclose(answers[0], answers[1], rtol=1e-12)
    assert worn.thinned(4e-6) == worn.deep_material


@pytest.mark.parametrize(("who", "alike"), [({"body": 1}, False), ({"shares": {"body1": 0.5, "body2": 0.5}}, True)])
def test_like_layers_stay_alike_where_both_wear_alike(who, alike):
    """Where one of two like bodies gets thinner, pressure moves the surfaces along themselves."""
    made = ec.plan(scene(coated(), body2=coated(), friction={"type": "coulomb", "coefficient": 0.3}, wear=who))
    assert made.model.interface.coupling.alike == alike
    assert (("x", "z") in made.model.interface.coupling.pairs) != alike
