"""Laws by exposed material: layers and inclusions at the surface, by their names; what is refused."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close
from eigencontact.errors import SceneError
from eigencontact.execution.run.driver import drive

COATED = {
    "medium": {
        "type": "bonded-layers",
        "layers": [{"name": "coating", "thickness": "20 um", **STEEL}, {"thickness": "2 um", **STEEL}],
        "substrate": STEEL,
    }
}
#: A bar of the body's own constants whose edge runs along x = 0.
BAR = {
    "name": "bar", "type": "cuboid", "center": ["15 um", 0, "1.25 um"], "edges": ["30 um", "60 um", "2.5 um"],
    "material": STEEL,
}  # fmt: skip
COULOMB = {"type": "by-material", "coefficients": {"bar": 0.1, "substrate": 0.4}}


def scene(**changes):
    return ec.Scene(
        **{
            "body1": STEEL, "body2": {"rigid": True}, "geometry": {"type": "sphere", "radius": "200 um"},
            "grid": {"cells": 24, "size": ["60 um", "60 um"]}, "numerics": {"coupling": "none", "threads": 1},
            "steps": [{"normal-load": "12.307 N"}, {"tangential-load-x": "1 N"}], **changes,
        }
    )  # fmt: skip


def last(made):
    *_, record = drive(ec.plan(made))
    return record


def test_each_half_of_the_contact_has_the_coefficient_of_its_material():
    """The bar has the constants of the body: the pressure is Hertz's, the bound alone knows it."""
    found = last(scene(friction=COULOMB, inclusions=BAR))
    pressure, bound, x = found.fields["pressure"], found.fields["shear_bound"], (np.arange(24) - 11.5) * 2.5e-6
    loaded = pressure > 0
    expected = np.where(x > 0, 0.1, 0.4) * pressure
    np.testing.assert_allclose(bound[loaded], expected[loaded], rtol=1e-12)
    assert set(np.unique(found.fields["exposed_material"])) == {0.0, 1.0}
    shear = np.hypot(found.fields["shear_x"], found.fields["shear_y"])
    assert np.all(shear <= bound * (1 + 1e-9))
    slips = found.fields["contact_zone"] == 1
    assert slips[:, 12:].sum() > 2 * slips[:, :12].sum() > 0


def test_one_law_for_all_is_the_law():
    """One coefficient under every name gives what Coulomb's law gives, to the bit."""
    steel = {
        "type": "by-material",
        "coefficients": {"bar": 0.3},
        "laws": {"substrate": {"type": "coulomb", "coefficient": 0.3}},
    }
    one, other = (last(scene(friction=law, inclusions=BAR)) for law in (steel, {"type": "coulomb", "coefficient": 0.3}))
    for name in ("pressure", "shear_x", "slip_x"):
        np.testing.assert_array_equal(one.fields[name], other.fields[name])


def test_layers_have_names_or_numbers():
    made = ec.plan(scene(body1=COATED, friction={"type": "by-material", "coefficients": {"coating": 0.2}}))
    assert made.model.exposed.names == ("substrate", "coating", "layer 2")
    depth = np.full(made.grid.shape, 19e-6)
    depth[0, :4] = 20e-6, 21e-6, 22e-6, 30e-6
    assert made.model.exposed.at(depth)[0, :5].tolist() == [2, 2, 0, 0, 1]


SLIDES = [{"normal-load": "12.307 N"}, {"normal-load": "12.307 N", "sliding-distance": "10 um"}]
ARCHARD = {name: {"type": "archard", "coefficient": f"{k} 1/Pa"} for name, k in (("bar", 1e-16), ("substrate", 3e-16))}


def test_the_halves_wear_by_their_own_laws():
    """Frictionless, on a path so short that the pressure hardly changes: depth is K p s by its mean."""
    exact = {"coupling": "none", "threads": 1, "tolerance": 1e-10}
    law = {"type": "by-material", "laws": ARCHARD, "jump-error": 1e-6}
    before, after = drive(ec.plan(scene(wear=law, inclusions=BAR, steps=SLIDES, numerics=exact)))
    pressure = 0.5 * (before.fields["pressure"] + after.fields["pressure"])
    expected = np.where((np.arange(24) - 11.5) > 0, 1e-16, 3e-16) * 1e-5 * pressure
    off = np.abs(after.fields["worn_depth"] - expected).max() / expected.max()
    assert off < 1e-6
    assert after.scalars["max_worn_depth"] > 1e-11


REFUSED = {
    "a name that there is not": (
        {"friction": {"type": "by-material", "coefficients": {"baar": 0.1, "substrate": 0.4}}, "inclusions": BAR},
        r"friction \(by-material\) must name materials of body 1: 'substrate', 'bar' \(got 'baar'\); .* 'bar'",
    ),
    "a law of wear for a name that there is not": (
        {"wear": {"type": "by-material", "laws": {"coatng": ARCHARD["bar"]}}, "body1": COATED, "steps": SLIDES},
        r"wear \(by-material\) must name .*'coating', 'layer 2' \(got 'coatng'\); did you mean 'coating'",
    ),
    "two laws for one material": (
        {"friction": COULOMB | {"laws": {"bar": {"type": "coulomb", "coefficient": 1}}}, "inclusions": BAR},
        "must have one law for 'bar'",
    ),
    "no law": ({"friction": {"type": "by-material"}}, "must have coefficients, laws or both"),
    "a coefficient below zero": (
        {"friction": {"type": "by-material", "coefficients": {"substrate": -1}}},
        r"friction.coefficients.substrate must be zero or positive",
    ),
    "a law that is not installed": (
        {"friction": {"type": "by-material", "laws": {"substrate": {"type": "coulom"}}}},
        "friction.laws.substrate.*coulomb",
    ),
    "materials in both bodies": (
        {"friction": COULOMB, "inclusions": [BAR, BAR | {"body": 2, "name": "beam"}], "body2": STEEL},
        "friction.type must be a law without names of materials if both bodies have several",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("changes", "words"), REFUSED.values(), ids=REFUSED)
def test_refusals(changes, words):
    with pytest.raises(ec.EigencontactError, match=words):
        ec.plan(scene(**changes))


def test_a_material_without_numbers_is_refused_where_it_is_touched():
    with pytest.raises(SceneError, match=r"must know every material in contact \(got 'bar', and 'substrate' at x = "):
        last(scene(friction={"type": "by-material", "coefficients": {"bar": 0.1}}, inclusions=BAR))


def through(steps, wear=None):
    """Slide through 1 um of a coating of the body's own constants that wears ten times less than the substrate."""
    laws = {name: {"type": "archard", "coefficient": k} for name, k in (("coating", 2e-20), ("substrate", 2e-19))}
    layers = [{"name": "coating", "thickness": "1 um", **STEEL}]
    return last(
        scene(
            body1={"medium": {"type": "bonded-layers", "layers": layers, "substrate": STEEL}},
            wear={"type": "by-material", "laws": laws, **(wear or {})}, steps=[{"normal-load": "12.307 N"}, *steps],
            grid={"cells": 16, "size": ["80 um", "80 um"]},
        )
    )  # fmt: skip


WAY = {"normal-load": "12.307 N", "sliding-distance": 1e4}
MANY = {**WAY, "sliding-distance": 1e4 / 200}


@pytest.mark.parametrize(
    "steps",
    [
        pytest.param([WAY], id="one increment", marks=pytest.mark.slow),
        pytest.param([{"cycle": [MANY], "repeat": 200}], id="jumps over cycles", marks=pytest.mark.slow),
    ],
)
def test_a_layer_that_opens_on_the_way_is_seen(steps):
    """Against 40 increments. The coating alone would lose 2461 um^3 on this way, by load and path."""
    found, fine = through(steps).scalars, through([{**WAY, "increments": 40}]).scalars
    assert fine["worn_volume"] > 1.3 * 2461e-18
    assert found["worn_volume"] == close(fine["worn_volume"], rel=0.02)
    assert found["max_worn_depth"] == close(fine["max_worn_depth"], rel=0.02)


def test_what_lies_below_what_is_exposed():
    """Half of the columns lose a depth of which a quarter lies below the coating, the others none of it."""
    exposed = ec.plan(
        scene(body1=COATED, friction={"type": "by-material", "coefficients": {"coating": 0.2}})
    ).model.exposed
    worn = np.full(exposed.grid.shape, 17e-6)
    worn[:, ::2] = 10e-6
    found = exposed.share_below(worn, np.full(worn.shape, 4e-6))
    assert 0.125 <= found < 0.125 + 2.0**-10  # ten halvings
