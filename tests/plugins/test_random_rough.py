"""Random rough surfaces: their spectrum measured back, one surface on all grids, refusals.

Spectra are measured by transforms of heights at the points of a grid; the surface sums its waves and has no transform.
"""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.plugin import Grid, HasNativeGrid
from eigencontact_plugins.geometries.random_rough import RandomRough

L, LONG, SHORT = 80e-6, 20e-6, 2e-6
SURFACE = RandomRough(size=(L, L), rms_height=50e-9, hurst=0.7, roll_off=LONG, short_cutoff=SHORT, seed=3)


def heights(surface, cells=None, size=None):
    """Heights at the middles of so many cells over a period, less their mean."""
    grid = surface.native_grid()
    if cells is not None:
        grid = Grid(nx=cells, ny=cells, dx=size / cells, dy=size / cells)
    y, x = grid.axes()
    h = -surface.separation(x, y)
    return h - h.mean(), grid


def spectrum(h, grid):
    """C(q) = A |mean of h exp(-iqx)|^2, wavenumbers q, and the mean square of h as the sum of C/A."""
    qx, qy = (2 * np.pi * np.fft.fftfreq(n, d) for n, d in ((grid.nx, grid.dx), (grid.ny, grid.dy)))
    power = np.abs(np.fft.fft2(h) / h.size) ** 2 * grid.size[0] * grid.size[1]
    return power.ravel(), np.hypot(qx[None, :], qy[:, None]).ravel()


def test_heights_have_the_stated_root_mean_square():
    h, grid = heights(SURFACE)
    assert isinstance(SURFACE, HasNativeGrid)
    assert grid.size == close((L, L), rel=1e-12)
    assert grid.dx == close(SHORT / 8, rel=1e-12)
    assert np.sqrt(np.mean(h**2)) == close(50e-9, rel=1e-12)


@pytest.mark.parametrize("hurst", [0.3, 0.8, 1.0])
def test_slopes_have_the_stated_root_mean_square(hurst):
    """By differences over 0.05 cells, whose error is (q d)^2 / 24 of a wave, and by the sum of the spectrum."""
    surface = RandomRough(size=(L, L), rms_slope=0.2, hurst=hurst, roll_off=LONG, short_cutoff=4e-6)
    h, grid = heights(surface)
    power, q = spectrum(h, grid)
    assert np.sqrt(np.sum(q**2 * power)) / L == close(0.2, rel=1e-12)
    y, x = grid.axes()
    step = 0.05 * grid.dx
    along = (surface.separation(x + step / 2, y) - surface.separation(x - step / 2, y)) / step
    across = (surface.separation(x, y + step / 2) - surface.separation(x, y - step / 2)) / step
    assert np.sqrt(np.mean(along**2 + across**2)) == close(0.2, rel=5e-5)


@pytest.mark.parametrize("hurst", [0.3, 0.8, 1.0])
def test_the_spectrum_is_flat_then_falls_as_the_power_of_the_hurst_exponent(hurst):
    """Ring by ring: slope -2(1 + H) of the logarithms, and the plateau; nothing beyond the cutoff."""
    surface = RandomRough(size=(L, L), rms_height=50e-9, hurst=hurst, roll_off=LONG, short_cutoff=SHORT)
    power, q = spectrum(*heights(surface))
    rings = np.rint(q * L / (2 * np.pi)).astype(int)
    mean = np.bincount(rings, power) / np.bincount(rings)
    wave = np.bincount(rings, q) / np.bincount(rings)
    falling = slice(6, 39)  # whole rings between roll-off, 4, and cutoff, 40
    assert np.polyfit(np.log(wave[falling]), np.log(mean[falling]), 1)[0] == close(-2 * (1 + hurst), abs=0.01)
    assert mean[1:4] == close(np.full(3, mean[1]), rel=1e-9)
    assert mean[42:].max() < 1e-24 * mean[1]
    # The mean square by Jacobs, Junge and Pastewka's integral over the plane; the sum over waves misses 2 % of it.
    q_r, q_s = 2 * np.pi / LONG, 2 * np.pi / SHORT
    falls = (1 - (q_s / q_r) ** (-2 * hurst)) / (2 * hurst)
    expected = mean[1] * q_r**2 / (2 * np.pi) * (0.5 + falls)
    assert expected == close(50e-9**2, rel=0.03)


def test_without_a_roll_off_the_power_law_reaches_the_period():
    power, q = spectrum(*heights(RandomRough(size=(L, L), rms_height=1e-7, hurst=0.5, short_cutoff=8e-6)))
    here = (q > 0) & (q < 2 * np.pi / 8.01e-6)
    assert power[here] * q[here] ** 3 == close(np.full(here.sum(), (power * q**3)[here][0]), rel=1e-9)


def test_long_waves_end_at_the_long_cutoff():
    surface = RandomRough(size=(L, L), rms_height=1e-7, short_cutoff=8e-6, long_cutoff=30e-6, roll_off=20e-6)
    power, q = spectrum(*heights(surface))
    long = q < 2 * np.pi / 30.1e-6
    assert power[long].max() < 1e-24 * power.max()
    assert power[~long & (q < 2 * np.pi / 20.1e-6)] == close(power.max(), rel=1e-9)


def test_oblong_windows_have_the_same_spectrum_along_both_axes():
    surface = RandomRough(size=(L, 0.5 * L), rms_slope=0.1, short_cutoff=8e-6, hurst=0.6)
    power, q = spectrum(*heights(surface))
    here = (q > 0) & (q < 2 * np.pi / 8.01e-6)
    assert here.sum() > 100
    assert power[here] * q[here] ** 3.2 == close(np.full(here.sum(), (power * q**3.2)[here][0]), rel=1e-9)


def test_any_points_sample_the_same_surface():
    """On finer cells, off any grid, a period further, turned into full arrays."""
    coarse, grid = heights(SURFACE, cells=160, size=L)
    fine, _ = heights(SURFACE, cells=480, size=L)
    assert fine[1::3, 1::3] == close(coarse, abs=1e-20)
    y, x = grid.axes()
    rows, columns = np.array([3, 77, 120]), np.array([150, 5, 41])
    places = x[0, columns] + 3 * L, y[rows, 0] - 7 * L
    assert SURFACE.separation(*places) == close(SURFACE.separation(x, y)[rows, columns], abs=1e-19)
    moved = RandomRough(**{**vars_of(SURFACE), "center": (1e-6, -2e-6)})
    assert moved.separation(x + 1e-6, y - 2e-6) == close(SURFACE.separation(x, y), abs=1e-19)


def vars_of(surface):
    import dataclasses

    return {field.name: getattr(surface, field.name) for field in dataclasses.fields(surface)}


def test_a_smaller_cutoff_adds_short_waves_and_leaves_the_long_ones():
    """Amplitudes of the common waves are in one proportion, that of the plateaus, and their phases are the same."""
    other = RandomRough(**{**vars_of(SURFACE), "short_cutoff": SHORT / 2})
    (few, _), (many, _) = (heights(one, cells=320, size=L) for one in (SURFACE, other))
    waves = L * np.hypot(np.fft.fftfreq(320, L / 320)[:, None], np.fft.fftfreq(320, L / 320)[None, :])
    common = (waves > 0) & (waves < 39.9)
    ratio = np.fft.fft2(many)[common] / np.fft.fft2(few)[common]
    assert ratio.real == close(np.full(common.sum(), ratio[0].real), rel=1e-6)
    assert 0.9 < ratio[0].real < 1.0
    assert np.abs(ratio.imag).max() < 1e-6


def test_a_seed_makes_one_surface_and_another_seed_another():
    again = RandomRough(**vars_of(SURFACE))
    other = RandomRough(**{**vars_of(SURFACE), "seed": 4})
    y, x = SURFACE.native_grid().axes()
    h = SURFACE.separation(x, y)
    assert np.array_equal(h, again.separation(x, y))
    assert abs(np.corrcoef(h.ravel(), other.separation(x, y).ravel())[0, 1]) < 0.3
    # Raw bits of PCG64 are the same in every version of NumPy: this one number holds for all of them.
    assert float(SURFACE.separation(np.zeros(1), np.zeros(1))[0]) == close(1.965684149070223e-07, rel=1e-9)


def test_heights_are_normally_distributed():
    """Skewness 0 and kurtosis 3, within what 1250 independent waves of half a period leave."""
    h = np.concatenate([heights(RandomRough(**{**vars_of(SURFACE), "seed": seed}))[0].ravel() for seed in range(4)])
    h = h / h.std()
    assert np.mean(h**3) == close(0.0, abs=0.2)
    assert np.mean(h**4) == close(3.0, abs=0.3)


def test_the_datum_is_the_highest_point_of_its_own_grid():
    y, x = SURFACE.native_grid().axes()
    assert SURFACE.separation(x, y).min() == 0.0


GOOD = {"size": (64e-6, 64e-6), "short_cutoff": 4e-6, "rms_slope": 0.1}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"size": (1.0, -1.0)}, "size must be two positive and finite lengths (x, y) (got (1.0, -1.0))"),
        ({"rms_height": 1e-7}, "rms_height must be given where rms_slope is not, one of the two (got 1e-07)"),
        ({"rms_slope": None}, "rms_height must be given where rms_slope is not, one of the two (got None)"),
        ({"rms_slope": -0.1}, "rms_slope must be positive and finite (got -0.1)"),
        ({"hurst": 0.0}, "hurst must be above 0 and up to 1 [-] (got 0.0)"),
        ({"hurst": 1.1}, "hurst must be above 0 and up to 1 [-] (got 1.1)"),
        (
            {"short_cutoff": 1e-9},
            "short_cutoff must be from 6.4e-08 m, a 1000th of the period, to 6.4e-05 m, the period (got 1e-09)",
        ),
        (
            {"short_cutoff": 1e-4},
            "short_cutoff must be from 6.4e-08 m, a 1000th of the period, to 6.4e-05 m, the period (got 0.0001)",
        ),
        (
            {"roll_off": 1e-3},
            "roll_off must be from 4e-06 m, the short cutoff, to 6.4e-05 m, the period (got 0.001)",
        ),
        (
            {"short_cutoff": 31e-6, "long_cutoff": 31.9e-6},
            "long_cutoff must be longer: no wave of the period lies between it and the short cutoff (got 3.19e-05)",
        ),
        ({"seed": -1}, "seed must be 0 or a positive whole number (got -1)"),
        ({"center": (0.0, np.nan)}, "center must be two finite lengths (x, y) (got (0.0, nan))"),
    ],
)
def test_wrong_tables_are_refused(change, message):
    with pytest.raises(ec.EigencontactError) as caught:
        RandomRough(**{**GOOD, **change})
    assert str(caught.value) == f"random-rough.{message}"


def test_one_size_stands_for_both():
    made = ec.make("random-rough", size="64 um", short_cutoff="4 um", rms_slope=0.1)
    assert made == RandomRough(**GOOD)
