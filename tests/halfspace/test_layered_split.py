"""Bands of depths, and the closed kernels that are taken out of their responses."""

from types import SimpleNamespace

import numpy as np
import pytest

from eigencontact.core.material import Material
from eigencontact.errors import PlanError
from eigencontact.halfspace.layered_split import MOST, SPREAD, bands
from eigencontact_plugins.layered.stack import BondedLayers, Layer, Substrate
from eigencontact_plugins.surface_loads import PressureLoad

TOP, DEEP = {"young_modulus": 4.0, "poisson_ratio": 0.2}, {"young_modulus": 1.0, "poisson_ratio": 0.3}
COATED = BondedLayers(layers=(Layer(thickness=0.5, **TOP),), substrate=Substrate(**DEEP))
DEPTHS = np.linspace(0.0, 3.0, 80)


@pytest.mark.parametrize("quantity", ["displacement", "stress"])
def test_every_depth_is_in_one_band_of_similar_scales(quantity):
    split = bands(PressureLoad(), quantity, DEPTHS, 0.05, COATED, "below")
    assert sorted(number for band in split for number in band.numbers) == list(range(DEPTHS.size))
    for band in split:
        z = np.array(band.depths)
        scale = 2 * 0.5 - z if z.max() < 0.5 else z
        assert np.array_equal(z, DEPTHS[list(band.numbers)])
        assert len(z) <= MOST
        assert scale.max() <= SPREAD * scale.min()
        assert band.scale == scale.min()


def test_kernels_are_those_of_the_top_its_image_and_the_substrate():
    near, far = (bands(PressureLoad(), "displacement", np.array([z]), 0.05, COATED, "below")[0] for z in (0.1, 2.0))
    top, deep = Material(**TOP), Material(**DEEP)
    assert [kernel[:2] for kernel in near.kernels[0]] == [(1.0, top), (-1.0, top), (1.0, deep)]
    assert [kernel[2] for kernel in near.kernels[0][:2]] == [0.1, 0.9]
    assert [kernel[:2] for kernel in far.kernels[0]] == [(1.0, deep)]
    stress = bands(PressureLoad(), "stress", np.array([0.1, 2.0]), 0.05, COATED, "below")
    assert [band.kernels for band in stress] == [(((1.0, top, 0.1),),), ((),)]


def test_a_medium_without_interface_is_refused():
    whole = SimpleNamespace(key="graded", surface_material=Material(**TOP), interfaces=())
    with pytest.raises(PlanError, match="must have an interface"):
        bands(PressureLoad(), "stress", DEPTHS, 0.05, whole, "below")
