"""The benchmark of rough contact: its surface, its judge against closed forms, and what it says."""

import numpy as np
import pytest

from close import close
from eigencontact_verification.benchmarks.rough import CASES, METHODS, ratios
from eigencontact_verification.benchmarks.roughness import RoughProblem, displacement, residual

N = 64


def problem(case, n=N):
    periodic, share = CASES[case]
    return RoughProblem(n=n, periodic=periodic, share=share)


def test_the_surface_is_what_it_is_said_to_be():
    one = RoughProblem(n=256, periodic=True, share=0.1)
    h = one.separation()
    power = np.abs(np.fft.fft2(h)) ** 2
    waves = np.hypot(*np.meshgrid(np.fft.fftfreq(256, 1 / 256), np.fft.fftfreq(256, 1 / 256)))
    assert h.min() == 0.0
    assert power[waves > 32].max() < 1e-20 * power[waves > 0].max()
    assert np.sqrt(np.sum((2 * np.pi * waves) ** 2 * power)) / 256**2 == close(1.0, rel=1e-10)
    inside, outside = (power[(waves > low) & (waves < high)].mean() for low, high in ((8, 12), (20, 30)))
    middle = [np.mean(waves[(waves > low) & (waves < high)] ** -3.6) for low, high in ((8, 12), (20, 30))]
    assert inside / outside == close(middle[0] / middle[1], rel=0.15)
    flat = [power[(waves > low) & (waves < high)].mean() for low, high in ((0, 4), (4, 8))]
    assert flat[0] == close(flat[1], rel=0.5)
    assert np.array_equal(h, one.separation())


def test_a_wave_of_pressure_deflects_as_johnson_says():
    x = (np.arange(N) + 0.5) / N
    wave = np.broadcast_to(1.0 + np.cos(6 * np.pi * x), (N, N))
    expected = 2.0 / (6.0 * np.pi) * np.cos(6 * np.pi * x)
    assert displacement(problem("periodic 1 %"), wave)[5] == close(expected, abs=1e-12)


def test_a_square_deflects_as_love_says():
    one = problem("open 1 %")
    pressure = np.zeros((N, N))
    pressure[24:40, 24:40] = (
        1.0  # side 1/4; the middle of a uniform square deflects 4 ln(1 + √2) / π times its side / E*
    )
    middle = displacement(one, pressure)[31:33, 31:33].mean()
    assert middle == close(4 * np.log(1 + np.sqrt(2)) / np.pi * 0.25, rel=2e-3)


@pytest.mark.parametrize("case", ["periodic 6 %", "open 6 %"])
def test_the_judge_accepts_an_answer_and_no_other(case):
    one = problem(case)
    h = one.separation()
    pressure, iterations = METHODS["eigencontact"].press(one, h, 1)
    assert iterations > 5
    assert pressure.mean() == close(one.mean_pressure, rel=1e-12)
    assert residual(one, h, pressure) <= 1.1e-6
    assert residual(one, h, 1.001 * pressure) > 1e-4
    assert residual(one, h, np.roll(pressure, 1, 0)) > 1e-2
    with pytest.raises(ValueError, match="positive somewhere"):
        residual(one, h, 0 * pressure)


def test_the_best_peer_is_named():
    rows = [
        {"case": "open 1 %", "n": 8, "code": code, "first_cpu_s": seconds}
        for code, seconds in (("eigencontact", 2.0), ("tamaas", 12.0), ("contactmechanics", 11.0))
    ]
    assert ratios(rows) == ["open 1 %, N = 8: contactmechanics, the best peer, takes 5.5 times the processor time"]
    assert ratios(rows[:1]) == []
