"""What yields beside what does not: layers, hard and soft inclusions, coatings, both bodies, prior strain."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL, perfect
from close import close

ELASTIC = {"type": "elastic"}
#: Hertz, HZ-2 of the case catalogue: load [N], contact radius [m], peak pressure [Pa].
LOAD, A, P0 = 12.307, 20e-6, 14.691e9
PRESS, FREE = {"normal_load": LOAD}, {"normal_load": 0.0}
SPHERE = {"type": "sphere", "radius": "200 um"}
BALL = {"type": "sphere", "radius": "8 um", "center": [0, 0, "16 um"]}
HARD = {"young-modulus": "420 GPa", "poisson-ratio": 0.3}


#: Middles of cells beside the axis: laws hold for means over cells, which differ the more at corners.
CENTRES = {"name": "cut", "shape": "points", "points": [[2.5e-6, 2.5e-6, z * 1e-6] for z in range(2, 42, 4)]}


def by_depth(*laws, interfaces=("20 um",)):
    return {"type": "by-depth", "interfaces": list(interfaces), "laws": list(laws)}


def layer(material, thickness="20 um"):
    """Layer as wide as what yields below the contact, and more."""
    return {"type": "layer", "size": ["60 um", "60 um"], "thickness": thickness, "material": material}


def scene(law=None, steps=(PRESS,), cells=12, law2=None, **more):
    """Few cells: what is compared has the same ones."""
    return ec.Scene(
        **{
            "body1": {**STEEL, **({"law": law} if law else {})},
            "body2": {**STEEL, "law": law2} if law2 else {"rigid": True},
            "geometry": SPHERE,
            "grid": {"cells": [cells, cells], "size": ["60 um", "60 um"]},
            "steps": list(steps),
            "numerics": {"inclusion_pitch": "4 um"},
            "output": {"pictures": False},
            **more,
        }
    )


def run(*args, **more):
    return ec.run(scene(*args, **more)).dataset


def assert_alike(found, expected, step=-1):
    """To some tolerances of the iteration: in the pressure, the approach and what stays."""
    np.testing.assert_allclose(found["pressure"][step], expected["pressure"][step], rtol=0, atol=2e-5 * P0)
    left = float(abs(expected["residual_displacement_z"][step]).max())
    np.testing.assert_allclose(
        found["residual_displacement_z"][step], expected["residual_displacement_z"][step], rtol=0, atol=1e-3 * left
    )
    assert float(found["approach"][step]) == close(float(expected["approach"][step]), rel=1e-5)


@pytest.fixture(scope="module")
def plain():
    """EP-2 in one step."""
    found = run(perfect())
    assert float(found["equivalent_plastic_strain_1"].max()) > 0.01
    return found


def test_a_layer_that_holds_all_of_the_plastic_zone_is_the_whole_body(plain):
    """EP-8: 20 um of the same constants yield, the ground below does not."""
    layered = run(by_depth(perfect(), ELASTIC))
    for name in ("pressure", "residual_displacement_z", "equivalent_plastic_strain_1"):
        np.testing.assert_array_equal(layered[name], plain[name])


@pytest.mark.parametrize(
    ("law", "inclusions"),
    [
        (None, [layer(perfect(), "24 um")]),
        (perfect(), [layer(perfect())]),
        (perfect(), [{**BALL, "center": [0, 0, "36 um"], "material": ELASTIC}]),
        pytest.param(perfect("6.5 GPa"), [layer(perfect(), "24 um")], marks=pytest.mark.slow),
    ],
    ids=["coating alone", "coating and ground", "elastic ball below", "coating on a ground that never gets there"],
)
def test_regions_of_the_same_material_are_the_whole_body(plain, law, inclusions):
    """Coatings by cells on an elastic and on a yielding ground; the constants of a law in a region are the body's."""
    assert_alike(run(law, inclusions=inclusions), plain)


def test_only_what_lies_below_a_layer_yields():
    """EP-9: the ground below 20 um yields; the layer, as an elastic region of a body that yields, says the same."""
    below = run(by_depth(ELASTIC, perfect("5 GPa")))
    covered = run(perfect("5 GPa"), inclusions=[layer(ELASTIC)])
    for found in (below, covered):
        strain = found["equivalent_plastic_strain_1"].max(["history_step", "cells_1_y", "cells_1_x"])
        z = strain["cells_1_z"].values
        assert float(strain[z < A].max()) == 0.0
        assert 0.003 < float(strain.max()) < 0.02
        assert A < z[int(np.argmax(strain.values))] < 1.3 * A
    assert_alike(covered, below)


@pytest.mark.slow
def test_a_hard_coating_that_yields_on_a_ground_that_yields():
    """Constants and yield stress of its own: the coating carries more; both flow, each by its own limit."""
    coating = layer(perfect("9 GPa", **HARD), "8 um")
    found = run(perfect("4 GPa"), inclusions=[coating], stress=CENTRES)
    z = found["cells_1_z"].values
    strain = found["equivalent_plastic_strain_1"].max(["history_step", "cells_1_y", "cells_1_x"]).values
    assert strain[z < 8e-6].max() > 1e-3
    assert strain[z > 8e-6].max() > 1e-3
    limits = np.where(found["cut_z"].values < 8e-6, 9e9, 4e9)
    parts = found["cut_von_mises"][0].values / limits
    assert np.all(parts < 1.1)
    assert np.all(parts[1:8] > 0.9)


@pytest.mark.slow
@pytest.mark.parametrize("law", [None, perfect("6 GPa")], ids=["elastic around", "yields around"])
def test_an_inclusion_that_yields(law):
    """Soft limit in a ball: it flows and stays at its limit; around it the stress goes beyond that."""
    ball = {**BALL, "material": perfect("2 GPa", **HARD)}
    found = run(law, inclusions=[ball], stress=CENTRES)
    elastic = run(None, inclusions=[{**BALL, "material": HARD}], stress=CENTRES)
    inside = abs(found["cut_z"].values - 16e-6) < 7e-6
    whole = abs(found["cut_z"].values - 16e-6) < 3e-6  # the cells above and below are partly of the matrix
    before, after = (data["cut_von_mises"][0].values for data in (elastic, found))
    assert before[inside].min() > 5e9
    assert after[whole].max() < 2.7e9
    assert after[inside].max() < before[inside].min()
    assert after[~inside].max() > 5e9
    strain = found["equivalent_plastic_strain_1"][0]
    r = np.sqrt(strain["cells_1_x"] ** 2 + strain["cells_1_y"] ** 2 + (strain["cells_1_z"] - 16e-6) ** 2)
    assert float(strain.where(r < 6e-6).min()) > 1e-3
    assert (float(strain.where(r > 11e-6).max()) > 0.0) == (law is not None)


def test_a_body_that_yields_beside_an_inclusion_alone():
    """Elastic, the contact reaches .62 p0 = 9.1 GPa: a body that yields later has no cells. A hard ball raises it."""
    law = perfect("10.5 GPa")
    found = run(law, inclusions=[{**BALL, "material": {**HARD, "young-modulus": "1000 GPa"}}])
    assert float(found["equivalent_plastic_strain_1"].max()) > 1e-3
    assert "equivalent_plastic_strain_1" not in run(law)


@pytest.mark.slow
def test_two_like_bodies_with_like_inclusions_that_yield():
    """EP-19 with a hard ball in each: twice the depth of one body under the gap r²/4R, and the same strain."""
    balls = [{**BALL, "body": body, "material": HARD} for body in (1, 2)]
    pair = run(perfect("5 GPa"), law2=perfect("5 GPa"), inclusions=balls)
    one = run(perfect("5 GPa"), inclusions=balls[:1], geometry={"type": "sphere", "radius": "400 um"})
    assert float(pair["approach"][0]) == close(2.0 * float(one["approach"][0]), rel=1e-5)
    strains = [pair[f"equivalent_plastic_strain_{body}"].values for body in (1, 2)]
    assert strains[0].max() > 1e-3
    np.testing.assert_allclose(strains[0], strains[1], atol=1e-5 * strains[0].max())
    np.testing.assert_allclose(strains[0], one["equivalent_plastic_strain_1"], atol=1e-3 * strains[0].max())


def test_prior_strain_that_causes_no_shear_stress_changes_nothing(plain):
    """A wide layer that swells freely along z alone has no stress: only the surface stands higher."""
    wide = {"type": "cuboid", "center": [0, 0, "10 um"], "edges": [1.0, 1.0, "20 um"], "eigenstrain": [0, 0, 1e-3]}
    found = run(perfect(), inclusions=[wide])
    np.testing.assert_allclose(found["pressure"], plain["pressure"], rtol=0, atol=2e-5 * P0)
    assert float(found["approach"][0] - plain["approach"][0]) == close(-20e-9, rel=1e-3)


def test_a_yielding_body_of_layers_is_refused_by_name():
    layers = {"type": "bonded-layers", "layers": [{"thickness": "5 um", **STEEL}], "substrate": STEEL}
    with pytest.raises(ec.EigencontactError, match=r'body1 must be a medium alone: .*"by-depth"'):
        ec.Scene(body1={"medium": layers, "law": perfect()}, geometry=SPHERE, steps=[PRESS])


def test_a_law_whose_constants_are_others_at_depth_is_refused():
    with pytest.raises(ec.EigencontactError, match=r"with the elastic constants of body 1: .* at a depth of"):
        ec.explain(scene(by_depth(perfect(), perfect(**HARD))))


#: Wide enough for the stress of an endless layer, -300 MPa; what it lifts is told by a run without contact.
PRIOR = {
    "type": "cuboid",
    "center": [0, 0, "10 um"],
    "edges": ["8 mm", "8 mm", "20 um"],
    "eigenstrain": [1e-3] * 2 + [0],
}
BENEATH = {"type": "sphere", "radius": "6.6 um", "center": [0, 0, "15 um"], "material": HARD}
REFERENCES = {
    "EP-9": ({"law": by_depth(ELASTIC, perfect("5000 MPa"))}, 2006.3e-9, 16.7e-9, 14.485e9),
    "EP-12": ({"law": perfect(), "inclusions": [BENEATH]}, 1997.1e-9, 109.4e-9, 13.261e9),
    "EP-15": ({"law": perfect(), "inclusions": [PRIOR]}, 2006.2e-9, 57.3e-9, None),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", REFERENCES)
def test_references_of_finite_elements(name):
    """Depth, print and pressure on the axis of cases.md: within some percent, and nearer on finer cells."""
    tables, depth, left, middle = REFERENCES[name]
    prior = 0.0
    if name == "EP-15":
        still = {"cells": [3, 3], "size": ["6 um", "6 um"]}
        lifted = ec.run(ec.Scene(body1=STEEL, inclusions=[PRIOR], grid=still, output={"pictures": False})).dataset
        prior = -float(lifted["residual_displacement_z"][0, 1, 1])
    errors = []
    for cells, pitch in ((8, "2 um"), (16, "1 um")):
        grid = {"cells_per_contact_radius": cells, "margin": 1.5}
        steps = [{**PRESS, "increments": 8}, {**FREE, "increments": 2}]
        found = run(**tables, steps=steps, grid=grid, numerics={"inclusion_pitch": pitch})
        assert float(found["approach"].max()) + prior == close(depth, rel=1e-3 if cells == 16 else 2e-3)
        at = {"x": 0.0, "y": 0.0, "method": "nearest"}
        sunk = float(found["residual_displacement_z"][-1].sel(**at)) + prior
        pressed = 0.0 if middle is None else float(found["pressure"][7].sel(**at)) / middle - 1.0
        errors.append((sunk / left - 1.0, pressed))
    assert -0.15 < errors[1][0] < 0.03
    assert abs(errors[1][0]) < 0.6 * abs(errors[0][0])
    assert abs(errors[1][1]) < 0.02
