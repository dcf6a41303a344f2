"""Contact along a line by finite elements of its own: closed forms of pressure, shear, stress, yield; patch; orders.

Lengths in the half width of a Hertz contact with R = E* = 1, P = π/4 and p0 = 1/2 (per unit length).
"""

from __future__ import annotations

import numpy as np
import pytest

from close import close
from eigencontact_verification.fem import line_contact, line_half_plane
from eigencontact_verification.fem.axisymmetric_mesh import build
from eigencontact_verification.fem.line_contact import LineBody, LineContact, LineStep, solve_line_contact
from eigencontact_verification.fem.plane_strain import (
    PlaneBody,
    line_force_displacement,
    line_force_stress,
    stretched_displacement,
)
from eigencontact_verification.fem.yielding_law import YieldingLaw, linear

NU, MU, P, P0 = 0.3, 0.5, np.pi / 4, 0.5
ONE = LineBody(young_modulus=1 - NU**2, poisson_ratio=NU)
HALF = LineBody(young_modulus=2 * (1 - NU**2), poisson_ratio=NU)


def hertz(x, a=1.0):
    return P0 * np.sqrt(np.maximum(0.0, a * a - x * x))


def pressed(*steps, bodies=(ONE,), fine=0.25, reach=100.0, window=1.5, gap=lambda x: x**2 / 2, **rest):
    model = LineContact(bodies=bodies, gap=gap, window=(-window, window), fine=fine, reach=reach, **rest)
    return solve_line_contact(model, steps)


def norm(solution, difference):
    return float(np.sqrt(solution.weight @ difference**2))


def order(sizes, errors):
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def strain_of(displacement, x, z, h=1e-5):
    """Strain xx, zz, xz of a displacement (2, n), by central differences."""
    by_x = (displacement(x + h, z) - displacement(x - h, z)) / (2 * h)
    by_z = (displacement(x, z + h) - displacement(x, z - h)) / (2 * h)
    return np.stack((by_x[0], by_z[1], (by_x[1] + by_z[0]) / 2))


@pytest.mark.parametrize(("normal", "shear"), [(1.0, 0.0), (0.0, 1.0)])
def test_far_field_has_the_stress_of_a_line_force(normal, shear):
    """Hooke's law in plane strain between both, and the surface falls with the logarithm of the distance."""
    E = 2.5
    x, z = np.array([-1.5, -0.2, 0.4, 3.0]), np.array([0.3, 1.0, 2.0, 0.1])
    s_xx, s_zz, s_xz = line_force_stress(normal, shear, x, z)
    expected = (1 + NU) / E * np.stack((s_xx - NU * (s_xx + s_zz), s_zz - NU * (s_xx + s_zz), s_xz))
    found = strain_of(lambda a, b: line_force_displacement(normal, shear, E, NU, a, b), x, z)
    assert found == close(expected, rel=1e-8, abs=1e-9)
    u = line_force_displacement(normal, shear, E, NU, np.array([1.0, np.e]), np.zeros(2))
    assert u[0 if shear else 1] @ [1, -1] == close(2 * (1 - NU**2) / (np.pi * E))


def test_patch_of_plane_strain():
    """A uniform stress xx on skew, unequal elements: to round-off, with stress yy = nu xx and no inner force inside."""
    law = YieldingLaw(young_modulus=2.0, poisson_ratio=NU)
    grid = build(np.array([-1.0, -0.7, 0.1, 1.0]), np.array([0.0, 0.2, 1.0]), (), 0.1, 1)
    shape = PlaneBody.points_of(grid).shape[1:]
    body = PlaneBody(grid=grid, laws=[law], material=np.zeros(shape, dtype=np.int64), prestrain=np.zeros((4, *shape)))
    x, z = body.basis.doflocs
    kinds = (body.basis.nodal_dofs, body.basis.facet_dofs, body.basis.interior_dofs)
    along = np.isin(np.arange(body.basis.N), np.concatenate([dofs[0] for dofs in kinds]))
    u = np.where(along, *stretched_displacement(3.0, 2.0, NU, x, z))
    force, _, _, stress = body.forces(u, body.state_at_rest())
    expected = np.broadcast_to(np.array([3.0, 3.0 * NU, 0.0, 0.0])[:, None, None], stress.shape)
    assert stress == close(expected, abs=1e-13)
    inner = (np.abs(x) < 1) & (z > 0) & (z < 1)
    assert np.abs(force[inner]).max() < 1e-14
    assert force[along & (x == 1)].sum() == close(3.0, rel=1e-13)


def test_hertz():
    """Pressure in the mean with order 1 and its maximum with 3/2, because it ends as a root; the load to round-off."""
    sizes = np.array([0.25, 0.125, 0.0625])
    found = [pressed(LineStep(normal=P), fine=fine, growth=1.8) for fine in sizes]
    errors = [norm(s, s.moments[0].pressure - hertz(s.x)) for s in found]
    peaks = [abs(s.moments[0].pressure.max() - P0) for s in found]
    assert 0.85 < order(sizes, errors) < 1.15
    assert 1.25 < order(sizes, peaks) < 1.75
    assert peaks[-1] < 5e-4 * P0
    assert found[-1].contact() == close([-1.0, 1.0], abs=1e-3)
    assert found[-1].weight @ found[-1].moments[0].pressure == close(P, rel=1e-8)


def test_stress_on_the_axis():
    """Largest von Mises stress .55752 p0 at .704 a, with stress yy = nu (xx + zz)."""
    z = np.linspace(0.4, 1.0, 61)
    hertzian = pressed(LineStep(normal=P), fine=0.125, deep=1.0)
    xx, yy, zz, xz = hertzian.stress(np.stack((0 * z, z), axis=1))
    root = np.sqrt(1 + z * z)
    assert xx == close(-P0 * ((1 + 2 * z * z) / root - 2 * z), rel=0, abs=2e-3 * P0)
    assert zz == close(-P0 / root, abs=2e-3 * P0)
    assert yy == close(NU * (xx + zz), abs=2e-3 * P0)
    mises = np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xz**2)
    assert mises.max() == close(0.55752 * P0, rel=2e-3)
    assert z[mises.argmax()] == close(0.704, abs=0.04)


def fixed_and_free(reach):
    """Largest difference of pressure between both outer boundaries."""
    both = [pressed(LineStep(normal=P), reach=reach, outer=outer, growth=2.0) for outer in ("fixed", "free")]
    return float(np.abs(both[0].moments[0].pressure - both[1].moments[0].pressure).max())


def test_truncation():
    """The far field lacks the width of the contact: displacement of the order reach^-2, its gap's bend reach^-4."""
    differences = [fixed_and_free(reach) for reach in (6.0, 12.0, 24.0)]
    assert -4.4 < order([6.0, 12.0, 24.0], differences) < -3.3
    assert differences[-1] < 5e-5 * P0


@pytest.fixture(scope="module")
def fretted():
    """Two like bodies: Q to .6 mu P, back to 0, on to -.6 mu P."""
    loads = [0.0, 0.6 * MU * P, 0.0, -0.6 * MU * P]
    steps = [LineStep(normal=P, shear=Q) for Q in loads]
    return pressed(*steps, bodies=(HALF, HALF), friction=MU, fine=0.125, growth=2.0)


def test_cattaneo(fretted):
    """Shear of the first load (0.025 in the mean, of first order), the stick zone; the pressure stays."""
    s, (before, now, *_) = fretted, fretted.moments
    c = np.sqrt(1 - 0.6)
    assert norm(s, now.shear - MU * (hertz(s.x) - hertz(s.x, c))) < 0.03 * MU * P0
    assert s.stick(1) == close([-c, c], abs=5e-3)
    assert now.pressure == close(before.pressure, abs=1e-8 * P0)
    assert s.weight @ now.shear == close(0.6 * MU * P, rel=1e-8)
    assert now.slip == close(now.slip[::-1], abs=1e-9)
    slid = (np.abs(s.x) < 0.95) & (np.abs(s.x) > c + 0.1)
    assert np.all(now.slip[slid] > 0)
    assert np.all(now.slip[now.stick] == 0)


def test_unloading_and_reversal(fretted):
    """Mindlin and Deresiewicz: each reversal slips with twice the friction; a full reversal mirrors the first load."""
    s, (_, first, back, last) = fretted, fretted.moments
    c, b = np.sqrt(1 - 0.6), np.sqrt(1 - 0.3)
    expected = MU * (hertz(s.x) - hertz(s.x, c)) - 2 * MU * (hertz(s.x) - hertz(s.x, b))
    assert norm(s, back.shear - expected) < 0.05 * MU * P0
    assert np.abs(back.shear).max() > 0.2 * MU * P0  # locked in, without a force
    assert norm(s, last.shear + first.shear) < 0.01 * MU * P0


def test_small_steps_after_a_turn():
    """A small step back, where each sliding node has to stick: many steps end where one does (no history between)."""
    loads = [0.0, 0.6, 0.55, 0.5, 0.0]
    coarse = {"bodies": (HALF, HALF), "friction": MU, "growth": 2.5}
    many = pressed(*(LineStep(normal=P, shear=share * MU * P) for share in loads), **coarse)
    few = pressed(*(LineStep(normal=P, shear=share * MU * P) for share in (0.0, 0.6, 0.0)), **coarse)
    assert many.moments[-1].shear == close(few.moments[-1].shear, abs=1e-6 * MU * P0)
    turned = many.moments[2]
    assert np.count_nonzero(turned.stick) > np.count_nonzero(many.moments[1].stick)
    assert many.weight @ turned.shear == close(0.55 * MU * P, rel=1e-8)


def test_surface_stress_in_partial_slip(fretted):
    """xx by the shear is zero where it sticks and 2 mu sqrt(x² - c²) outside, tension behind: p0 = a/2."""
    x = np.array([-0.85, -0.75, -0.4, 0.1, 0.4, 0.75, 0.85])
    points = np.stack((x, 0 * x), axis=1)
    by_shear = fretted.stress(points, 1)[0] - fretted.stress(points, 0)[0]
    expected = -2 * MU * P0 * np.sign(x) * np.sqrt(np.maximum(x * x - 0.4, 0.0))
    assert by_shear == close(expected, abs=0.05 * MU * P0)
    assert fretted.stress(points, 1, body=2)[0] - fretted.stress(points, 0, body=2)[0] == close(-by_shear, abs=1e-8)


def test_bulk_stress_moves_the_stick_zone():
    """By a s_B / (4 mu p0) in phase with the shear (like pair, body 1 pulled), and not its width.

    A pull of body 1 alone is half a difference of the strains of both, s_B (1 - nu²)/E = s_B / 2 here.
    """
    bulk = 0.15 * MU * P0
    loads = (LineStep(normal=P), LineStep(normal=P, shear=0.4 * MU * P, bulk=(bulk, 0.0)))
    pulled = pressed(*loads, bodies=(HALF, HALF), friction=MU, fine=0.125, growth=2.0)
    low, high = pulled.stick(1)
    assert abs(low + high) / 2 == close(bulk / (4 * MU * P0), abs=4e-3)
    assert (high - low) / 2 == close(np.sqrt(0.6), abs=8e-3)  # an eighth of the distance of nodes
    far = pulled.stress([[0.0, 60.0]], 1)[0, 0] - pulled.stress([[0.0, 60.0]], 0)[0, 0]
    assert far == close(bulk, rel=0.05)


def shear_error(**rest):
    """Error of Cattaneo's shear, in the mean, by full friction."""
    loads = (LineStep(normal=P), LineStep(normal=P, shear=0.4 * MU * P))
    s = pressed(*loads, **{"bodies": (HALF, HALF), "friction": MU, "fine": 0.25, "growth": 2.0, **rest})
    return norm(s, s.moments[1].shear - MU * (hertz(s.x) - hertz(s.x, np.sqrt(0.6)))) / (MU * P0)


def test_planted_faults(monkeypatch):
    """Half of the friction, a body that is dragged the wrong way, a far boundary that does not move."""
    right = shear_error()
    assert right < 0.06
    assert shear_error(friction=0.8 * MU) > 1.5 * right
    solver, truncation = line_contact._Solver, fixed_and_free(6.0)
    honest = solver._relative
    with monkeypatch.context() as patch:  # both bodies are dragged along x: no shift is left between like ones
        patch.setattr(solver, "_relative", lambda self, n, _, rigid: honest(self, n, (-1.0, -1.0), rigid))
        assert shear_error() > 2 * right
    monkeypatch.setattr(line_half_plane, "line_force_displacement", lambda *a: 0 * np.stack(a[-2:]))
    assert fixed_and_free(6.0) > 10 * truncation


def test_onset_of_yield():
    """p0 / k = 3.1067 for von Mises, nu = .3: nothing below, plastic strain near z = .704 a above."""
    limit = P0 / 3.1067 * np.sqrt(3.0)
    for factor, yields in ((1.02, False), (0.98, True)):
        law = YieldingLaw(young_modulus=1 - NU**2, poisson_ratio=NU, hardening=linear(factor * limit, 0.05))
        body = LineBody(young_modulus=1 - NU**2, poisson_ratio=NU, law=law)
        solved = pressed(LineStep(normal=P), bodies=(body,), fine=0.3, deep=0.9, growth=2.5, reach=30.0, window=1.2)
        mesh = solved.bodies[0]
        p = mesh.of_state(solved.moments[0].states[0])
        assert bool(p.max() > 0) is yields
        if yields:
            x, z = (c[np.unravel_index(p.argmax(), p.shape)] for c in PlaneBody.points_of(mesh.grid))
            assert [abs(x), z] == close([0.0, 0.704], abs=0.15)


def test_an_iteration_that_diverges_ends_at_once(monkeypatch):
    """Three times the load that starts to yield, in one increment: the laws see no strain of more than a thousand."""
    law = YieldingLaw(young_modulus=1 - NU**2, poisson_ratio=NU, hardening=linear(0.2, 0.0))
    body, strains = LineBody(young_modulus=law.young_modulus, poisson_ratio=NU, law=law), []
    honest = YieldingLaw.answer

    def watched(self, strain, state):
        strains.append(np.abs(strain).max())
        return honest(self, strain, state)

    def indented():
        strains.clear()
        mesh = {"fine": 0.5, "deep": 1.0, "growth": 4.0, "reach": 60.0, "window": 3.5}
        solved = pressed(LineStep(normal=1.5), bodies=(body,), **mesh)
        return solved.moments[0].pressure, max(strains)

    monkeypatch.setattr(YieldingLaw, "answer", watched)
    pressure, largest = indented()
    assert largest < 1e3
    monkeypatch.setattr(line_contact, "_DIVERGES", np.inf)
    monkeypatch.setattr(line_contact, "_PATIENCE", line_contact._ITERATIONS)
    as_before, largest = indented()
    assert largest > 1e6
    assert pressure == close(as_before, abs=1e-6 * P0)


@pytest.mark.slow
def test_plastic_contact_with_friction():
    """Two bodies, one yields: equilibrium of every step, friction's bound, symmetry of what is symmetric, residuals."""
    limit = P0 / 3.1067 * np.sqrt(3.0) / 2
    law = YieldingLaw(young_modulus=2 * (1 - NU**2), poisson_ratio=NU, hardening=linear(limit, 0.1))
    soft = LineBody(young_modulus=2 * (1 - NU**2), poisson_ratio=NU, law=law)
    Q = 0.5 * MU * P
    steps = [LineStep(normal=P / 2), LineStep(normal=P), LineStep(normal=P, shear=Q), LineStep(normal=P, shear=-Q)]
    steps.append(LineStep(normal=0.0))
    s = pressed(*steps, bodies=(soft, HALF), friction=MU, growth=2.0, window=2.0, reach=50.0)
    for step, now in zip(steps, s.moments, strict=True):
        assert s.weight @ now.pressure == close(step.normal, rel=1e-7, abs=1e-9)
        assert s.weight @ now.shear == close(step.shear, rel=1e-7, abs=1e-9)
        assert np.all(np.abs(now.shear) <= MU * now.pressure * (1 + 1e-12))
    straight = s.moments[1]
    assert straight.pressure == close(straight.pressure[::-1], abs=1e-7 * P0)
    assert straight.shear == close(-straight.shear[::-1], abs=1e-7 * P0)
    assert straight.pressure.max() < 0.95 * P0
    assert s.moments[-1].pressure.max() == 0.0
    assert np.abs(s.stress([[0.0, 0.7]])[:3]).max() > 0.01 * P0
    assert np.abs(s.stress([[0.0, 0.7]], body=2)).max() < 1e-7 * P0  # elastic, and nothing touches it


def slip_of_partial_slip(x, c):
    """Slip by Cattaneo's shear, from its gradient 2 mu p0 sqrt(x² - c²) / E* between stick and the contact's edge."""
    x = np.clip(np.abs(x), c, 1.0)
    return MU * P0 * (x * np.sqrt(x * x - c * c) - c * c * np.arccosh(x / c))


def partial_slip_errors(**mesh):
    """Largest error of shear and of slip within .8 of the half width, by the largest of each; smallest element."""
    c = np.sqrt(0.4)
    loads = (LineStep(normal=P), LineStep(normal=P, shear=0.6 * MU * P))
    s = pressed(*loads, bodies=(HALF, HALF), friction=MU, window=1.25, reach=60.0, deep=0.5, **mesh)
    x, now = np.linspace(-0.8, 0.8, 401), s.moments[1]
    shear = MU * (hertz(x) - hertz(x, c))
    slip = slip_of_partial_slip(x, c)
    errors = (np.interp(x, s.x, now.shear) - shear, np.interp(x, s.x, now.slip) - slip)
    sizes = (shear.max(), slip_of_partial_slip(1.0, c))
    return [float(np.abs(e).max() / size) for e, size in zip(errors, sizes, strict=True)]


EDGES = np.sqrt(0.4) * np.array([-1.0, 1.0])
GRADED = {"fine": 0.5, "growth": 4.0, "edges": (-1.0, *EDGES, 1.0), "sharp": 1 / 64}


def test_elements_that_are_small_at_the_edges_have_the_shear():
    """196 of them against 260 elements of an eighth: 3 % instead of 15 %."""
    even, graded = partial_slip_errors(fine=0.25, growth=2.0, divisions=1), partial_slip_errors(**GRADED)
    assert graded[0] < 0.04
    assert graded[0] < even[0] / 3
    assert graded[1] < even[1] / 2


@pytest.mark.slow
def test_order_with_elements_that_are_small_at_the_edges():
    """The meshes of the quick audit: .29 % of shear and .074 % of slip on the finest, orders 1.7 and 2.1."""
    sizes = np.array([1.0, 0.5, 0.25])
    shear, slip = np.transpose([partial_slip_errors(divisions=d, **GRADED) for d in (1, 2, 4)])
    assert 1.4 < order(sizes, shear) < 2.0
    assert 1.9 < order(sizes, slip) < 2.4
    assert shear[-1] < 0.004
    assert slip[-1] < 0.001


def test_a_gap_that_travels():
    """Hertz's contact where the gap is, in few iterations each; symmetric meshes give the mirrored pressure."""
    places = (-1.0, -0.8, 0.0, 0.9, 1.0)
    s = pressed(*(LineStep(normal=P, place=x) for x in places), bodies=(HALF, HALF), window=2.5, fine=0.125)
    for place, moment in zip(places, s.moments, strict=True):
        assert norm(s, moment.pressure - hertz(s.x - place)) < 0.025 * P0
        assert moment.iterations < 5
    assert s.moments[-1].pressure == close(s.moments[0].pressure[::-1], abs=1e-8 * P0)
    assert s.contact(3) == close([-0.1, 1.9], abs=2e-3)


def test_the_far_field_travels_with_the_gap():
    """Both outer faces agree as they do for a centred contact: within the fourth power of the reach, not the first."""
    loads = LineStep(normal=P), LineStep(normal=P, place=2.0)
    fixed, free = (pressed(*loads, reach=12.0, window=3.5, growth=2.0, outer=outer) for outer in ("fixed", "free"))
    centred, away = (np.abs(fixed.moments[k].pressure - free.moments[k].pressure).max() for k in (0, 1))
    assert centred < 3e-4 * P0
    assert away < 1e-3 * P0


def test_refusals():
    with pytest.raises(ValueError, match=r"\|shear\| must be below"):
        pressed(LineStep(normal=P, shear=MU * P), friction=MU)
    with pytest.raises(ValueError, match=r"bulk\[1\] must be 0"):
        pressed(LineStep(normal=P, bulk=(0.0, 1.0)))
    with pytest.raises(ValueError, match="window must hold the contact"):
        pressed(LineStep(normal=P), window=0.5)
    with pytest.raises(ValueError, match="must rise around 0"):
        pressed(LineStep(normal=P), reach=1.0)
    with pytest.raises(ValueError, match="place must be 0 with friction"):
        pressed(LineStep(normal=P, place=0.1), friction=MU)
    with pytest.raises(ValueError, match=r"place must be in \(-1.5, 1.5\)"):
        pressed(LineStep(normal=P, place=2.0))
