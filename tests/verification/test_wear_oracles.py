"""The oracles of wear against closed forms, against each other and against the catalogue (WR-9 to WR-17)."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from close import close
from eigencontact_verification.oracles import cattaneo, hertz, wear_springs
from eigencontact_verification.oracles.coated_contact import coated_contact
from eigencontact_verification.oracles.wear_rings import Rings, fret, slide
from worn_ball import SLIDING

#: Sphere of the catalogue, HZ-2, pressed by a steel half-space's load: a, R, P, E*, p0.
A, RADIUS, LOAD = 20e-6, 200e-6, 12.307
MODULUS = 0.75 * LOAD * RADIUS / A**3
P0 = 1.5 * LOAD / (np.pi * A * A)
#: Volume of WR-9 and of the table of the catalogue.
REFERENCE = np.pi * A**4 / (4.0 * RADIUS)
FRICTION, AMPLITUDE, COEFFICIENT, NU = 0.5, 0.025 * A, 0.002723e-9, 0.3
RATIO = (2.0 - NU) / (2.0 * (1.0 - NU))
SLIPPING = wear_springs.slipping_approach(AMPLITUDE, FRICTION, RATIO)
UM3, NM, NJ = 1e-18, 1e-9, 1e-9


@cache
def sphere(number: float, reach: float) -> tuple[Rings, np.ndarray]:
    """So many rings a radius."""
    rings = Rings(edges=A / number * np.arange(round(reach * number) + 1), contact_modulus=MODULUS)
    return rings, rings.middles**2 / (2.0 * RADIUS)


def fretted(number, updates, sweeps=3, coefficient=COEFFICIENT, amplitude=AMPLITUDE, **kept):
    rings, gap = sphere(number, 1.3)
    states = fret(
        rings, gap, updates, amplitude=amplitude, friction=FRICTION, coefficient=coefficient, modulus_ratio=RATIO,
        sweeps=sweeps, **kept,
    )  # fmt: skip
    return rings, list(states)


def outer(rings, where):
    """Outer radius over a of the rings that are told."""
    return float(rings.edges[1:][where].max() / A)


@pytest.mark.parametrize("r", [0.0, 0.3, 0.7, 1.5, 40.0])
def test_a_ring_is_the_integral_of_point_loads(r):
    rings = Rings(edges=np.array([0.0, 0.5, 1.0]), contact_modulus=2.0)
    edges = np.array([r - 0.05 if r else 0.0, r + 0.05])
    found = Rings(edges=np.unique(np.concatenate([rings.edges, edges])), contact_modulus=2.0)
    row = int(np.argmin(np.abs(found.middles - (r or found.edges[1] / 2))))
    place = found.middles[row]
    inside = (found.edges[:-1] >= 0.5) & (found.edges[1:] <= 1.0)

    def along(angle):  # ∫ s ds/(π E* |r - s|) from the point itself outwards: the length of the chord in the ring
        return (chord(place, angle, 1.0) - chord(place, angle, 0.5)) / (np.pi * 2.0)

    total = quad(along, 0.0, np.pi, points=kinks(place), limit=400, epsabs=1e-12, epsrel=1e-10)[0]
    assert float(found.compliance[row] @ inside) == close(2.0 * total, rel=1e-7)


def chord(r, angle, b):
    """Length within the circle b of the ray from a point at r."""
    root = b * b - (r * np.sin(angle)) ** 2
    if root <= 0.0:
        return 0.0
    near, far = -r * np.cos(angle) - np.sqrt(root), -r * np.cos(angle) + np.sqrt(root)
    return max(far, 0.0) - max(near, 0.0)


def kinks(r):
    return [angle for b in (0.5, 1.0) if r > b for angle in (np.pi - np.arcsin(b / r),)] or None


def test_hertz_at_second_order():
    numbers, errors = (25, 50, 100), []
    for number in numbers:
        rings, gap = sphere(number, 1.3)
        found = rings.press(gap, load=LOAD)
        exact = hertz.pressure(rings.middles, 0.0, A, A, P0)
        errors.append([abs(found.approach * RADIUS / A**2 - 1.0), np.abs(found.pressure - exact)[: number // 2].max()])
        assert abs(outer(rings, found.touching) - 1.0) <= 1.0 / number
    slopes = np.polyfit(np.log(numbers), np.log(errors), 1)[0]
    assert slopes == close([-1.9, -1.9], abs=0.3)
    assert errors[-1][0] < 3e-5
    assert errors[-1][1] < 1e-4 * P0


def test_layers_of_rings_are_the_coated_contact():
    layer, substrate = (1.0, 2.0, NU), (1.0, NU)
    wanted = coated_contact(1.0, 10.0, [layer], substrate)
    edges = np.linspace(0.0, 1.2 * wanted.radius, 97)
    rings = Rings(edges=edges, contact_modulus=wanted.modulus, layers=(layer,), substrate=substrate)
    found = rings.press(rings.middles**2 / 20.0, load=1.0)
    assert [found.approach, found.pressure[0]] == close(
        [wanted.approach, float(wanted.pressure(edges[1] / 2))], rel=3e-4
    )


def sliding_history(number, steps):
    rings, gap = sphere(number, 4.0)
    volumes = REFERENCE * np.geomspace(1e-3, 100.0, 5 * steps + 1)
    return rings, list(slide(rings, gap, LOAD, volumes))[steps::steps]


def test_sphere_that_slides_follows_the_catalogue():
    """WR-9. Backward Euler is of first order in the step: two runs are extrapolated."""
    rings, coarse = sliding_history(50, 20)
    _, fine = sliding_history(50, 40)
    for one, two, (share, wanted) in zip(coarse, fine, SLIDING.items(), strict=True):
        assert two.volume == close(share * REFERENCE, rel=1e-12)
        assert float(rings.areas @ two.depth) == close(two.volume, rel=1e-12)
        pressure = 2.0 * two.contact.pressure.max() - one.contact.pressure.max()
        depth = 2.0 * two.depth.max() - one.depth.max()
        assert [pressure / P0, depth * RADIUS / A**2] == close(wanted[:2], rel=5e-3)
        assert abs(outer(rings, two.contact.touching) - wanted[2]) < 1.5 / 50


def test_sliding_tends_to_a_flat_cap_under_even_pressure():
    _, states = sliding_history(50, 40)
    last = states[-1]
    radius, pressure, depth = wear_springs.sliding_limit(last.volume, LOAD, RADIUS)
    assert [last.contact.pressure[:150].mean() / pressure, last.depth[0] / depth] == close([1.0, 1.0], rel=0.03)
    assert radius / A == close(3.162, rel=1e-3)


@cache
def punch(number=160):
    """Rings that end at the rim and crowd there."""
    edges = np.sin(np.linspace(0.0, 0.5 * np.pi, number + 1))
    return Rings(edges=edges, contact_modulus=1.0)


def test_flat_punch_that_slides():
    """WR-14: pressure in the middle over the mean, from the elastic one."""
    times = {0.05: 0.5441, 0.1: 0.5782, 0.2: 0.6367, 0.5: 0.7701, 1.0: 0.9013, 2.0: 0.9854}
    rings, ends, volumes = punch(), [0.0, *times], []
    for begin, end in pairwise(ends):
        volumes += list(np.pi * np.linspace(begin, end, 61)[1:])
    states = list(slide(rings, np.zeros_like(rings.middles), np.pi, volumes))
    found = [state.contact.pressure[0] for state in states[59::60]]
    assert rings.press(np.zeros_like(rings.middles), load=np.pi).pressure[0] == close(0.5, rel=1e-3)
    assert found == close(list(times.values()), rel=2e-3)


def test_modes_of_the_flat_punch():
    """p - mean falls like exp(-E* k t/(λ a)): λ are the eigenvalues of the compliance without its mean."""
    rings = punch()
    mean = rings.areas @ rings.compliance / rings.areas.sum()
    values = np.sort(np.linalg.eigvals(rings.compliance - mean).real)[::-1]
    assert values[:4] == close([0.48528, 0.27240, 0.19017, 0.14623], rel=1e-3)


@pytest.mark.parametrize(("share", "wanted"), [(0.1, (1.3663, 0.05325, 0.880)), (10.0, (0.2139, 1.51853, 1.820))])
def test_sphere_that_slides_on_a_coating(share, wanted):
    """WR-17: E1/E2 = 2, as thick as the contact; radii and pressures of the bare substrate."""
    modulus, R = 1.0 / (1.0 - NU**2), 10.0
    load, number, results = 4.0 / 3.0 * modulus / R, 50, []
    layer, substrate = (1.0, 2.0, NU), (1.0, NU)
    rings = Rings(
        edges=np.linspace(0.0, 2.4, round(2.4 * number) + 1), contact_modulus=2.0 * modulus, layers=(layer,),
        substrate=substrate,
    )  # fmt: skip
    for steps in (30, 60):
        volumes = np.pi / (4.0 * R) * np.geomspace(1e-3, share, steps + 1)
        for state in slide(rings, rings.middles**2 / (2.0 * R), load, volumes):
            last = state
        results.append([last.contact.pressure.max() / (1.5 * load / np.pi), last.depth.max() * R])
    assert 2.0 * np.array(results[1]) - results[0] == close(wanted[:2], rel=1e-2)
    assert abs(rings.edges[1:][last.contact.touching].max() - wanted[2]) < 1.0 / number


@pytest.mark.parametrize("share", [0.3, 0.9, 1.0, 1.7])
def test_first_cycle_is_that_of_cattaneo_and_mindlin(share):
    """Shifts below and above that of sliding; energy of the closed loop."""
    compliance = 4.0 * RATIO / MODULUS  # G* = 4/C
    sliding = cattaneo.shift_of_sliding(FRICTION, LOAD, A, compliance)
    rings, (first,) = fretted(100, [], amplitude=share * sliding, load=LOAD)
    if share > 1.0:
        energy = cattaneo.cycle_energy_sliding(share * sliding, FRICTION, LOAD, A, compliance)
    else:
        ratio = float(cattaneo.load_of_shift(share))
        energy = cattaneo.cycle_energy(ratio, FRICTION, LOAD, A, compliance)
        slipping = wear_springs.slipping_approach(share * sliding, FRICTION, RATIO)
        springs = wear_springs.first_energy(A, RADIUS, slipping, share * sliding, FRICTION, MODULUS)
        assert springs == close(energy, rel=1e-9)
        assert abs(outer(rings, first.sticking | (rings.middles < 0.01 * A)) - cattaneo.stick_ratio(ratio)) < 0.015
    assert first.energy == close(energy, rel=2e-3)


#: WR-12: cycles, deepest [nm], volume [um³], energy per cycle [nJ], stick radius/a.
FRETTING = {
    1: (2.47, 0.802, 295.9, 0.770),
    10: (23.02, 8.223, 309.7, 0.770),
    20: (43.34, 16.80, 319.8, 0.770),
    50: (94.36, 43.42, 326.6, 0.775),
}


def test_fretting_follows_the_catalogue():
    rings, states = fretted(120, np.concatenate([np.full(10, 0.1), np.ones(49)]), load=LOAD)
    for cycles, wanted in FRETTING.items():
        number = 9 + cycles
        state = states[number]
        assert state.cycles == close(cycles, rel=1e-12)
        found = [state.depth.max() / NM, float(rings.areas @ state.depth) / UM3, state.energy / NJ]
        assert found == close(wanted[:3], rel=5e-3)
        assert abs(outer(rings, state.sticking) - wanted[3]) < 1.0 / 120
        work = sum(state.energy * (state.cycles - last.cycles) for last, state in pairwise(states[: number + 1]))
        assert float(rings.areas @ state.depth) == close(COEFFICIENT * work, rel=1e-3)


def test_jumps_that_keep_the_slip_of_their_begin_wear_too_little():
    """WR-16, and what sweeps over the slip mend: first order in the jump either way."""

    def volume(jump, sweeps):
        rings, states = fretted(60, np.full(50 // jump, float(jump)), sweeps=sweeps, load=LOAD)
        return float(rings.areas @ states[-1].depth)

    exact = 2.0 * volume(1, 4) - volume(2, 4)
    errors = [volume(jump, 1) / exact - 1.0 for jump in (1, 5, 10)]
    assert errors == close([-0.01, -0.055, -0.10], rel=0.2)
    assert abs(volume(5, 4) / exact - 1.0) < 0.01


def limit(number, **kept):
    updates = np.diff(np.concatenate([[0.0], np.geomspace(1.0, 3e5, 60)]))
    rings, states = fretted(number, updates, **kept)
    return rings, states[-1]


def test_limit_of_fretting_with_the_approach_kept():
    """WR-10: the springs' closed form, the catalogue and the rings."""
    wanted = wear_springs.limit_of_approach(A**2 / RADIUS, RADIUS, SLIPPING)
    deepest, where = wanted.deepest
    numbers = [wanted.stick_radius / A, wanted.outer_radius / A, wanted.load(MODULUS) / LOAD, wanted.volume / UM3]
    assert [*numbers, deepest / NM, where / A] == close([0.76696, 1.11228, 0.92487, 103.83, 189.16, 0.8806], rel=1e-4)
    rings, last = limit(92 / numbers[0], approach=A**2 / RADIUS)  # an edge of the rings on that of the stick disk
    r = rings.middles
    assert last.energy < 1e-6 * fretted(120, [], load=LOAD)[1][0].energy
    assert outer(rings, last.sticking) == close(numbers[0], rel=1e-12)
    assert float(rings.areas @ last.contact.pressure) == close(wanted.load(MODULUS), rel=2e-3)
    assert float(rings.areas @ last.depth) == close(wanted.volume, rel=0.02)
    away = np.abs(r / wanted.stick_radius - 1.0) > 0.05  # the pressure has a pole at c: rings beside it err most
    assert last.depth[away] == close(wanted.depth(r[away]), abs=0.02 * deepest)  # the tolerance of WR-10
    inside = r < 0.9 * wanted.stick_radius
    assert last.contact.pressure[inside] == close(wanted.pressure(r[inside], MODULUS), rel=0.01)


def test_limit_of_fretting_with_the_load_kept():
    """WR-11, between the brackets of the springs."""
    lower, upper = wear_springs.limits_of_load(A, RADIUS, SLIPPING)
    assert [lower.load(MODULUS), upper.load(MODULUS)] == close([LOAD, LOAD], rel=1e-12)
    rings, last = limit(240, load=LOAD)
    assert lower.approach < last.contact.approach < upper.approach
    assert lower.volume < rings.areas @ last.depth < upper.volume
    c = outer(rings, last.sticking)
    assert [last.contact.approach * 1e6, c] == close([2.120, 0.777], rel=5e-3)
    # whatever the history, the limit follows from its stick radius: here dV/V = -12 dc/c
    own = wear_springs.FrettingLimit(
        approach=(2.0 + c**3) / (3.0 * c) * A**2 / RADIUS, sphere_radius=RADIUS, stick_radius=c * A
    )
    assert own.load(MODULUS) == close(LOAD, rel=1e-12)
    assert float(rings.areas @ last.depth) == close(own.volume, rel=2e-2)
    assert [last.contact.approach, last.depth.max()] == close([own.approach, own.deepest[0]], rel=1e-2)


def test_pressure_of_the_limit_carries_its_load():
    wanted = wear_springs.limit_of_approach(A**2 / RADIUS, RADIUS, SLIPPING)
    c = wanted.stick_radius
    # r = c sin t: r dr = c² sin t cos t dt takes off the root at c
    nodes, weights = np.polynomial.legendre.leggauss(40)
    t = 0.25 * np.pi * (nodes + 1.0)
    r = c * np.sin(t)
    total = 0.25 * np.pi * np.sum(weights * 2.0 * np.pi * r * wanted.pressure(r, MODULUS) * c * np.cos(t))
    assert float(total) == close(wanted.load(MODULUS), rel=1e-10)
