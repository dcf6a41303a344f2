"""Rectangles that repeat along y: sums of images, the strip as the mean, and waves along y."""

import numpy as np
import pytest
from scipy.special import k0

from eigencontact.core.material import Material
from eigencontact.halfspace.images import image_weights
from eigencontact.model.kernels import PairCoefficients, StressCoefficients
from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY

STEEL = Material(young_modulus=1.0, poisson_ratio=0.3)
PERIOD, DATUM = 1.0, 3.0
X = np.array([0.0, 0.04, 0.08])


def images_summed_one_by_one(influence, quantity, component, x, y, z, half_widths, count):
    """Sum of 2 count + 1 images and of a load spread evenly beyond them; errors fall as 1 / count^2 and are removed."""
    evaluate = influence.displacement if quantity == "displacement" else influence.stress

    def at(shift, widths):
        return evaluate([component], x[None, :], y[:, None] + shift, z, widths, STEEL)[0]

    strip = at(0.0, (half_widths[0], np.inf))
    if quantity == "displacement":
        strip = strip - evaluate([component], np.zeros(1), np.zeros(1), DATUM, (half_widths[0], np.inf), STEEL)[0]
    share, sums, total, first = 2 * half_widths[1] / PERIOD, [], at(0.0, half_widths), 1
    for last in (count, 2 * count):
        shifts = PERIOD * np.arange(first, last + 1)[:, None, None]
        total = total + (at(shifts, half_widths) + at(-shifts, half_widths)).sum(axis=0)
        first = last + 1
        sums.append(total + share * (strip - at(0.0, (half_widths[0], (last + 0.5) * PERIOD))))
    return sums[1] + (sums[1] - sums[0]) / (((2 * count + 0.5) / (count + 0.5)) ** 2 - 1)


KERNELS = [
    (PressureLoad(), "displacement", "z", 0.0),
    (PressureLoad(), "displacement", "x", 0.0),
    (PressureLoad(), "displacement", "y", 0.0),
    (ShearLoadX(), "displacement", "x", 0.0),
    (ShearLoadX(), "displacement", "y", 0.0),
    (ShearLoadX(), "displacement", "z", 0.3),
    (ShearLoadY(), "displacement", "y", 0.0),
    (ShearLoadY(), "displacement", "z", 0.0),
    (PressureLoad(), "stress", "xx", 0.1),
    (ShearLoadX(), "stress", "xz", 0.2),
    (ShearLoadY(), "stress", "yz", 0.05),
]


@pytest.mark.parametrize(("influence", "quantity", "component", "z"), KERNELS)
def test_images_are_those_summed_one_by_one(influence, quantity, component, z):
    half_widths, y = (0.02, 0.0625), np.arange(-1, 4) * 0.125
    kernel = StressCoefficients(influence, STEEL, quantity, DATUM, PERIOD)
    table = kernel.table([component], X, y, z, half_widths)[0]
    images = images_summed_one_by_one(influence, quantity, component, X, y, z, half_widths, 300)
    assert np.abs(table - images).max() < 1e-9 * np.abs(images).max()


@pytest.mark.parametrize("count", [1, 2, 8])
@pytest.mark.parametrize(
    ("influence", "component"), [(PressureLoad(), "z"), (ShearLoadX(), "x"), (PressureLoad(), "x")]
)
def test_cells_alike_along_y_are_a_strip(influence, component, count):
    half_widths = (0.02, 0.5 * PERIOD / count)
    y = np.arange(count) * (PERIOD / count)
    repeating = PairCoefficients(influence, (STEEL, None), component, DATUM, PERIOD).table(X, y, half_widths)
    strip = PairCoefficients(influence, (STEEL, None), component, DATUM).table(X, np.zeros(1), (0.02, np.inf))
    assert np.abs(repeating.sum(axis=0) - strip[0]).max() < 2e-12 * np.abs(strip).max()
    assert count > 1 or np.array_equal(repeating, strip)


@pytest.mark.parametrize("waves", [1, 2])
def test_a_wave_along_y_moves_the_surface_as_its_bessel_function(waves):
    """Far beside a line of pressure cos(ky): u = 2 K0(k |x|) cos(ky) / (pi E'), the mean over narrow cells."""
    count, k, a = 64, 2 * np.pi * waves / PERIOD, 1e-4
    y = np.arange(count) * (PERIOD / count)
    kernel = PairCoefficients(PressureLoad(), (STEEL, None), "z", DATUM, PERIOD)
    middle = kernel.table(np.zeros(1), np.zeros(1), (a, 0.5 * PERIOD / count))[0, 0]
    for x in (0.3, 0.6, 1.2):
        table = kernel.table(np.array([x]), y, (a, 0.5 * PERIOD / count))[:, 0]
        # a pressure that is constant on cells has sinc times the amplitude of its first wave
        amplitude = float(table @ np.cos(k * y)) / np.sinc(waves / count)
        expected = 2 * a * 2 * k0(k * x) / (np.pi * STEEL.plane_strain_modulus)
        assert abs(amplitude - expected) < 1e-5 * expected + 5e-12 * float(middle)


def test_the_field_repeats():
    kernel = PairCoefficients(PressureLoad(), (STEEL, None), "z", DATUM, PERIOD)
    y = np.array([-0.5, 0.5, 1.5])[:, None]
    once, twice, thrice = (kernel.table(X, row, (0.02, 0.1)) for row in y)
    assert np.abs(once - twice).max() < 1e-12 * np.abs(once).max()
    assert np.abs(once - thrice).max() < 1e-11 * np.abs(once).max()


def test_weights_of_images():
    assert np.array_equal(image_weights(1.0)[:15], np.ones(15))
    few = image_weights(0.1)
    assert np.array_equal(few[:5], np.ones(5))
    assert abs(few[14] - 1) > 0.01
