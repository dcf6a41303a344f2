"""Oracles of friction against quadratures of their own and against the catalogue (CM, TO, SP, HM, CMC-3)."""

from itertools import pairwise

import numpy as np
import pytest

from close import close
from eigencontact_verification.oracles import cattaneo, hertz, mindlin_paths, sliding_stress, spence, torsion

SHEAR_MODULUS = 210e9 / 2.6
#: Sphere of the catalogue, HZ-2: load, friction, radius, compliance of steel against a rigid body.
LOAD, FRICTION, RADIUS, COMPLIANCE = 12.307, 0.5, 20e-6, 1.7 / SHEAR_MODULUS


def gathered(function, start, stop):
    """Gauss rule with nodes gathered at both ends, where tractions have roots and logarithms."""
    nodes, weights = np.polynomial.legendre.leggauss(80)
    v = 0.5 * (nodes + 1)
    both = v**4 + (1 - v) ** 4
    r, slope = start + (stop - start) * v**4 / both, 4 * (v * (1 - v)) ** 3 / both**2
    return float(np.sum(0.5 * weights * (stop - start) * slope * function(r)))


@pytest.mark.parametrize("load", [0.05, 0.3, 0.5, 0.9, 1.0])
def test_cattaneo_shear_carries_the_load_and_gives_the_shift(load):
    """The displacement of the centre by an axisymmetric q_x is C/2 ∫ q dr: Cerruti's solution, angles averaged."""
    c = float(cattaneo.stick_ratio(load))
    traction = 1.5 / np.pi  # of P = a = mu = 1
    parts = ((0, c), (c, 1))
    carried = sum(gathered(lambda r: 2 * np.pi * r * cattaneo.shear(r, load, 1.0, traction), *part) for part in parts)
    shift = sum(gathered(lambda r: 0.5 * cattaneo.shear(r, load, 1.0, traction), *part) for part in parts)
    assert carried == close(load, rel=1e-9)
    expected = cattaneo.shift_of_sliding(1.0, 1.0, 1.0, 1.0) * float(cattaneo.shift_of_load(load))
    assert shift == close(expected, rel=1e-9)
    assert float(cattaneo.load_of_shift(cattaneo.shift_of_load(load))) == close(load, rel=1e-12)


def test_first_stiffness_is_the_slope_of_the_first_loading():
    slope = float(cattaneo.shift_of_load(1e-6)) * cattaneo.shift_of_sliding(1, 1, 1, 1) / 1e-6
    assert slope * cattaneo.initial_stiffness(1.0, 1.0) == close(1.0, rel=1e-6)


@pytest.mark.parametrize("load", [0.5, 0.8, 1.0])
def test_cycle_energy_is_the_area_of_the_loop(load):
    unit = cattaneo.shift_of_sliding(FRICTION, 1.0, 1.0, 1.0)
    # both branches are alike: the area is the integral of shift over the fall of Q, twice
    area = 2 * FRICTION * unit * gathered(lambda t: cattaneo.shift_on_loop(t, load), -load, load)
    assert cattaneo.cycle_energy(load, FRICTION, 1, 1, 1) == close(area, rel=1e-9)


@pytest.mark.parametrize(("load", "energy"), [(0.25, 1.32064e-3), (0.4, 8.31094e-3), (0.5, 0.0375)])
def test_catalogue_cm_4(load, energy):
    assert cattaneo.cycle_energy(load / 0.5, 0.5, 1, 1, 1) == close(energy, rel=1e-5)


def test_catalogue_cm_2_and_cm_3():
    sliding = cattaneo.shift_of_sliding(FRICTION, LOAD, RADIUS, COMPLIANCE)
    assert sliding / RADIUS == close(0.06071, rel=1e-4)
    assert cattaneo.initial_stiffness(RADIUS, COMPLIANCE) == close(7.602e6, rel=2e-4)
    load = float(cattaneo.load_of_shift(0.025 * RADIUS / sliding))
    assert (load, float(cattaneo.stick_ratio(load))) == close((0.5489, 0.7670), rel=2e-4)
    assert cattaneo.cycle_energy(load, FRICTION, LOAD, RADIUS, COMPLIANCE) == close(2.942e-7, rel=2e-4)
    beyond = cattaneo.cycle_energy_sliding(0.125 * RADIUS, FRICTION, LOAD, RADIUS, COMPLIANCE)
    assert beyond == close(3.762e-5, rel=2e-4)


@pytest.mark.parametrize("peak", [0.3, 1.0, 2.06])
def test_the_two_forms_of_a_loop_agree_and_close(peak):
    turn = float(cattaneo.load_of_shift(peak))
    loads = np.linspace(turn, -turn, 9)[:-1]
    if peak <= 1:
        np.testing.assert_allclose(cattaneo.load_on_loop(cattaneo.shift_on_loop(loads, turn), peak), loads, atol=1e-12)
    assert float(cattaneo.load_on_loop(-peak, peak)) == close(-turn)


# --- loads that vary together ------------------------------------------------------------------------------------


def begin(friction=0.5):
    """Contact with a = P = C = 1 at P = 1."""
    return mindlin_paths.SphereOnPath(friction=friction, stretch=1.0, compliance=1.0)


PATHS = {
    "shear at constant load": [(1.0, 0.0), (1.0, 0.3)],
    "shear there and back": [(1.0, 0.0), (1.0, 0.4), (1.0, -0.1), (1.0, 0.2)],
    "both rise, no slip": [(0.5, 0.0), (1.0, 0.2)],
    "both rise, slip": [(0.5, 0.0), (1.0, 0.45)],
    "load rises on a sheared contact": [(0.5, 0.0), (0.5, 0.2), (1.0, 0.2), (1.0, 0.35)],
    "load falls under constant shear": [(1.0, 0.0), (1.0, 0.2), (0.6, 0.2)],
    "load falls after sticking growth": [(0.2, 0.0), (1.0, 0.2), (0.7, 0.2)],
    "back the way it came": [(0.2, 0.0), (1.0, 0.2), (0.5, 0.075)],
    "both fall, slip backward": [(0.2, 0.0), (1.0, 0.2), (0.5, 0.0)],
    "all the way": [(1.0, 0.1), (1.0, 0.4), (0.9, 0.1), (1.2, 0.0), (1.2, -0.5), (0.95, -0.4), (1.1, 0.1)],
}


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS)
def test_path_states_carry_their_loads_within_the_bound(path):
    state = begin()
    for load, shear in path:
        state = state.to(load, shear)
        assert (state.load, state.tangential_load) == close((load, shear), abs=1e-12)
        edges = sorted({end ** (1 / 3) for end, _ in state.pieces})[:-1]
        parts = [*pairwise([0, *edges, state.radius])]
        carried = sum(gathered(lambda r, s=state: 2 * np.pi * r * s.shear(r), *part) for part in parts)
        shift = sum(gathered(lambda r, s=state: 0.5 * s.shear(r), *part) for part in parts)
        assert (carried, shift) == close((shear, state.shift), abs=1e-9)
        r = np.linspace(0, 0.9999 * state.radius, 201)
        bound = state.friction * hertz.pressure(
            r, 0 * r, state.radius, state.radius, 1.5 * load / np.pi / state.radius**2
        )
        assert float(np.max(np.abs(state.shear(r)) - bound)) <= 1e-12


def along(path, pieces=200):
    """States on a path in small parts, and the work of Q."""
    state, work, states = begin(), 0.0, []
    for load, shear in path:
        start = (state.load, state.tangential_load)
        for share in np.arange(1, pieces + 1) / pieces:
            found = state.to(start[0] + share * (load - start[0]), start[1] + share * (shear - start[1]))
            work += 0.5 * (found.tangential_load + state.tangential_load) * (found.shift - state.shift)
            state = found
            states.append((state, work))
    return states


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS)
def test_one_large_change_equals_many_small_ones(path):
    whole = begin()
    for point in path:
        whole = whole.to(*point)
    parts = along(path, 50)[-1][0]
    r = np.linspace(0, 1.1, 101)
    np.testing.assert_allclose(parts.shear(r), whole.shear(r), atol=1e-9)
    assert parts.shift == close(whole.shift, abs=1e-10)


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS)
def test_friction_only_takes_energy(path):
    states = along(path)
    taken = np.array([work - state.stored_energy for state, work in states])
    assert np.all(np.diff(taken) > -1e-6)  # what the trapezoidal rule leaves of the work
    if "no slip" in path:
        assert np.abs(taken).max() < 1e-6


@pytest.mark.parametrize("slope", [-0.2, 0.5])
def test_nothing_is_lost_where_the_load_rises_faster_than_the_shear(slope):
    states = along([(1.0, slope)], 400)
    assert states[-1][1] == close(states[-1][0].stored_energy, rel=1e-4)


@pytest.mark.parametrize("load", [0.2, 0.4])
def test_paths_at_constant_load_are_cattaneos(load):
    state = begin().to(1.0, 0.0).to(1.0, load)
    unit = cattaneo.shift_of_sliding(0.5, 1, 1, 1)
    assert state.shift == close(unit * float(cattaneo.shift_of_load(2 * load)))
    assert state.stick_radius == close(float(cattaneo.stick_ratio(2 * load)))
    back = state.to(1.0, -0.3 * load)
    assert back.shift == close(unit * float(cattaneo.shift_on_loop(-0.6 * load, 2 * load)))
    taken = along([(1.0, 0.0), (1.0, load)], 1000)[-1]
    first = taken[1] - taken[0].stored_energy
    assert first == close(0.25 * cattaneo.cycle_energy(2 * load, 0.5, 1, 1, 1), rel=1e-3)


def test_a_load_that_friction_cannot_carry_is_refused():
    state = begin().to(1.0, 0.0).to(1.0, 0.4)
    with pytest.raises(ValueError, match=r"at most 0\.35"):
        state.to(0.7, 0.4)


# --- torsion ------------------------------------------------------------------------------------------------------

LUBKIN = [
    (0.9, 0.17635, 0.03851),
    (0.7, 0.40974, 0.12344),
    (0.5, 0.52858, 0.22571),
    (0.3, 0.57687, 0.36557),
    (0.1, 0.58862, 0.63972),
]


@pytest.mark.parametrize(("stick", "moment", "angle"), LUBKIN)
def test_catalogue_to_1(stick, moment, angle):
    assert (torsion.moment(stick), float(torsion.twist(stick))) == close((moment, angle), abs=6e-6)
    assert torsion.stick_ratio(float(torsion.twist(stick))) == close(stick, rel=1e-12)


@pytest.mark.parametrize("stick", [0.9, 0.5, 0.1])
def test_torsional_shear_carries_the_moment_and_turns_the_centre(stick):
    """Rotation of the centre by q(r) is ∫ q/r dr/(2G): the curl of Cerruti's solution."""

    def q(r):
        return 1.5 / np.pi * torsion.shear(r, stick)

    parts = ((0, stick), (stick, 1))
    carried = sum(gathered(lambda r: 2 * np.pi * r * r * q(r), *part) for part in parts)
    turned = sum(gathered(lambda r: 0.5 * q(r) / r, *part) for part in parts)
    assert carried == close(torsion.moment(stick), rel=1e-8)
    assert turned == close(float(torsion.twist(stick)), rel=1e-8)


def test_torsional_shear_is_continuous_where_slip_begins():
    below, above = torsion.shear([0.6 - 1e-9, 0.6 + 1e-9], 0.6)
    assert below == close(above, rel=1e-4)
    assert np.all(torsion.shear(np.linspace(0, 0.59, 20), 0.6) < np.sqrt(1 - np.linspace(0, 0.59, 20) ** 2))


def test_catalogue_to_2():
    assert torsion.sliding_moment(1, 1, 1) == close(0.58905, abs=5e-6)
    assert torsion.moment(1e-6) == close(torsion.sliding_moment(1, 1, 1), rel=1e-9)
    small = 1 - 1e-6
    assert torsion.moment(small) / float(torsion.twist(small)) == close(torsion.initial_stiffness(1, 1), rel=1e-5)
    # no finite angle slides: three more powers of ten of c take the same additional angle each
    angles = torsion.twist([1e-3, 1e-6, 1e-9])
    np.testing.assert_allclose(np.diff(angles), 0.75 / np.pi * np.log(1e3), rtol=1e-4)


def test_torsional_cycle_energy_is_the_area_of_the_loop():
    sticks = np.linspace(1, 0.4, 401)
    angles, moments = torsion.twist(sticks), np.array([torsion.moment(s) for s in sticks])
    work = np.sum(0.5 * (moments[1:] + moments[:-1]) * np.diff(angles))
    assert torsion.cycle_energy(0.4) == close(8 * work - 4 * moments[-1] * angles[-1], rel=1e-3)


# --- pressed with friction ----------------------------------------------------------------------------------------

SPENCE = [
    (0.2, 0.0269), (0.3, 0.1412), (0.4, 0.3133), (0.5, 0.4851), (0.6, 0.6268), (0.7, 0.7334), (0.8, 0.8104),
    (0.9, 0.8651), (1.0, 0.9038), (1.25, 0.9581), (1.5, 0.9814), (1.75, 0.9917), (2.0, 0.9962),
]  # fmt: skip


@pytest.mark.parametrize(("ratio", "stick"), SPENCE)
def test_catalogue_sp_1(ratio, stick):
    assert spence.stick_ratio(ratio) == close(stick, abs=6e-5)


@pytest.mark.parametrize("ratio", [0.3, 0.5, 1.0, 1.5])
def test_the_radial_shear_undoes_the_strain_of_the_pressure_at_the_centre(ratio):
    """The centre sticks from the first touch: (1-ν)/(2G) ∫ q/r dr equals (1-2ν) p0/(4G), so ∫ q/(β p0) dr/r is one."""
    k = spence.stick_ratio(ratio)
    total = sum(gathered(lambda r: spence.radial_shear(r, ratio) / r, *part) for part in ((0, k), (k, 1)))
    assert total == close(1.0, rel=1e-9)


@pytest.mark.parametrize("ratio", [0.5, 1.0])
def test_the_radial_shear_stays_below_the_bound_and_meets_it(ratio):
    k = spence.stick_ratio(ratio)
    r = np.linspace(0, 0.999, 301)
    assert np.all(spence.radial_shear(r, ratio) <= ratio * np.sqrt(1 - r * r) + 1e-9)
    below, above = spence.radial_shear([k * (1 - 1e-7), k * (1 + 1e-7)], ratio)
    assert below == close(above, rel=1e-5)


# --- stress under sliding -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("z", [0.05, 0.2, 0.5, 1.0, 3.0])
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_stress_on_the_axis_by_quadrature(z, nu):
    np.testing.assert_allclose(
        sliding_stress.by_quadrature((0, 0, z), 0.5, nu), sliding_stress.axis(z, 0.5, nu), atol=1e-12
    )


@pytest.mark.parametrize("point", [(0.0, 0.0), (0.3, -0.4), (-0.6, 0.0), (0.0, 0.7)])
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_stress_on_the_surface_by_quadrature(point, nu):
    """Quadrature just below the surface, extrapolated to it: its error falls with the square of the depth."""
    depths = (4e-3, 2e-3, 1e-3)
    values = [sliding_stress.by_quadrature((*point, z), 0.5, nu) for z in depths]
    first = [2 * fine - coarse for coarse, fine in pairwise(values)]
    limit = (4 * first[1] - first[0]) / 3
    np.testing.assert_allclose(limit, sliding_stress.surface_inside(*point, 0.5, nu), atol=1e-6)


def test_quadrature_is_smooth_across_the_rim_of_the_disk():
    inside, outside = (sliding_stress.by_quadrature((x, 0.0, 0.3), 0.5, 0.3) for x in (1 - 1e-6, 1 + 1e-6))
    np.testing.assert_allclose(inside, outside, atol=1e-5)


@pytest.mark.parametrize(("z", "shear"), [(0.2, -0.60721), (0.5, -0.26964), (1.0, -0.07190)])
def test_catalogue_hm_2(z, shear):
    assert sliding_stress.axis(z, 1.0, 0.3)[4] == close(shear, abs=6e-6)


@pytest.mark.parametrize(("mu", "tension", "centre"), [(0, 0.1333, 0.2), (0.25, 0.5555, 0.4770), (0.5, 0.9776, 0.8888)])
def test_catalogue_hm_1_and_hm_5(mu, tension, centre):
    edge, middle = (sliding_stress.surface_inside(x, 0.0, mu, 0.3) for x in (-1.0, 0.0))
    assert edge[0] == close(tension, abs=6e-5)
    assert edge[0] == close(hertz.trailing_edge_tension(mu, 0.3), rel=1e-12)
    assert float(sliding_stress.von_mises(middle)) == close(centre, abs=6e-5)


def test_catalogue_cmc_3():
    x = np.linspace(-1, 0.9, 1901)
    stress = sliding_stress.von_mises(sliding_stress.surface_inside(x, 0.0, 0.5, 0.3))
    inner = np.flatnonzero((stress[1:-1] > stress[:-2]) & (stress[1:-1] > stress[2:])) + 1
    assert stress[inner] == close([0.9189], abs=6e-5)
    assert x[inner] == close([-0.55], abs=0.005)
    assert (stress[0], stress.max()) == close((0.9567, 0.9567), abs=6e-5)
