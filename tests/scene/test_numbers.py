"""Numbers in tables: booleans, texts and complex numbers are none, in scenes and in fields of plugins."""

import numpy as np
import pytest

import eigencontact as ec

NOT_NUMBERS = {
    "body1.young-modulus=true": "body1.young-modulus must be a number (got True)",
    "body1.poisson-ratio=false": "body1.poisson-ratio must be a number (got False)",
    "body1.poisson-ratio='0,3'": "body1.poisson-ratio must be a number (got '0,3')",
    "body1.poisson-ratio='00.3'": "body1.poisson-ratio must be a number (got '00.3')",
    "body1.poisson-ratio='0_1'": "body1.poisson-ratio must be a number (got '0_1')",
    "body1.poisson-ratio='nan'": "body1.poisson-ratio must be a number (got 'nan')",
    "steps.normal-load=true": "steps.normal-load must be a number (got True)",
    "steps.increments=true": "steps.increments must be a number (got True)",
    "steps.increments='010'": "steps.increments must be a number (got '010')",
    "grid={cells=[true, 8], size=[1.0, 1.0]}": "grid.cells must be a number (got [True, 8])",
    "grid={cells=true, size=[1.0, 1.0]}": "grid.cells must be a number",
    "numerics.tolerance=true": "numerics.tolerance must be a number (got True)",
    "numerics.threads=true": "numerics.threads must be a number (got True)",
    "stress.0.body=true": "body of stress 'section' (first) must be a number (got True)",
    "stress.0.depth-cells=true": "depth-cells of stress 'section' (first) must be a number (got True)",
    "geometry.radius=true": "geometry.radius must be a number (got True)",
    "geometry.center=[0.0, true]": "geometry.center must be a number (got [0.0, True])",
    "observers=[{type='probe', points=[[0.0, true]]}]": "observers.points must be a number (got [[0.0, True]])",
    "friction={type='coulomb', coefficient=true}": "friction.coefficient must be a number (got True)",
    "friction={type='coulomb', coefficient='0,3'}": "friction.coefficient must be a number (got '0,3')",
    (
        "friction={type='coulomb-map', coefficient=0.1, regions=[{coefficient=true, radius=1.0}]}"
    ): "friction.regions.0.coefficient must be a number (got True)",
    (
        "body1={medium={type='bonded-layers', layers={thickness=true, young-modulus=1.0, poisson-ratio=0.3}, "
        "substrate={young-modulus=1.0, poisson-ratio=0.3}}}"
    ): "body1.medium.layers.thickness must be a number (got True)",
    "inclusions={type='sphere', center=[0, 0, 1], radius=true, eigenstrain=1e-3}": "inclusions.radius must be a number",
    "inclusions={type='sphere', center=[0, 0, 1], radius=0.1, eigenstrain=true}": "inclusions.eigenstrain must be a ",
    (
        "inclusions={type='sphere', center=[0, 0, 1], radius=0.1, eigenstrain={type='uniform', value=true}}"
    ): "inclusions.eigenstrain.value must be a number (got True)",
    (
        "inclusions={type='sphere', center=[0, 0, 1], radius=0.1, material={young-modulus=true, poisson-ratio=0.3}}"
    ): "inclusions.material.young-modulus must be a number (got True)",
    (
        "eigenstrain={type='thermal', depth=1.0, expansion=true, temperature=1.0}"
    ): "eigenstrain.expansion must be a number (got True)",
}


@pytest.mark.parametrize("change", NOT_NUMBERS)
def test_what_is_no_number_is_refused(change):
    with pytest.raises(ec.EigencontactError) as caught:
        ec.plan(ec.load_scene("hertz", [change]))
    assert str(caught.value).startswith(NOT_NUMBERS[change])


@pytest.mark.parametrize(
    "value", [True, np.True_, 1 + 0j, np.complex128(1), np.array(1j), np.ma.masked, np.ma.array([1.0], mask=[1]), "1,0"]
)
@pytest.mark.parametrize("key", ["coulomb", "dissipated-energy"])
def test_components_take_numbers_only(key, value):
    name = {"coulomb": "coefficient", "dissipated-energy": "threshold"}[key]
    rule = "given without masked values" if np.ma.is_masked(value) else "a number"
    with pytest.raises(ec.EigencontactError, match=rf"^{key}\.{name} must be {rule} \(got "):
        ec.make(key, **{name: value})


def test_numbers_of_numpy_and_text_that_is_a_number_are_taken():
    for value in (np.float32(0.5), np.float64(0.5), np.array(0.5), "0.5", "5e-1"):
        assert ec.make("coulomb", coefficient=value).coefficient == 0.5
    scene = ec.load_scene("hertz", ["body1.poisson-ratio='0.25'"])
    assert scene.body1.poisson_ratio == 0.25
    assert ec.make("depth-profile", depths=[0, 1], values=[1, 0], direction="isotropic").direction == "isotropic"
    assert ec.make("peened-layer", peak=1e-3, peak_depth=0, width=1, incompressible=True).incompressible is True


@pytest.mark.parametrize("value", ["1e308", "1e31", "1e-31", "1e-308"])
@pytest.mark.parametrize("key", ["body1.young-modulus", "steps.normal-load"])
def test_sizes_that_cannot_be_reckoned_with_are_refused(key, value):
    with pytest.raises(ec.EigencontactError, match=rf"^{key} must be of a size .* 1e\+30 \[(Pa|N)\] \(got {value[:2]}"):
        ec.load_scene("hertz", [f"{key}={value}"])


@pytest.mark.parametrize("value", ["1e-30", "1e30"])
@pytest.mark.parametrize("key", ["body1.young-modulus", "steps.normal-load", "geometry.radius"])
def test_the_largest_and_smallest_sizes_run_without_overflow(key, value):
    """Warnings are errors here."""
    scene = ec.load_scene("hertz", [f"{key}={value}", "stress=[]", "grid.cells-per-contact-radius=6"])
    assert ec.run(scene).summary["max_pressure"] > 0


def test_one_key_in_two_spellings_is_refused():
    with pytest.raises(ec.EigencontactError, match=r"geometry must give each key once .*'-' and '_' are one"):
        ec.plan(
            ec.load_scene(
                "hertz", ["geometry={type='rounded-punch', flat-radius=1.0, flat_radius=2.0, edge-radius=1.0}"]
            )
        )
