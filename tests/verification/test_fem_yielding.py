"""Elastic-plastic finite elements under a rigid sphere: Hertz, patches, cycles, and references of cases.md."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

import eigencontact as ec
from bodies import STEEL
from close import close
from eigencontact_verification.fem.axisymmetric_mesh import Fit, build
from eigencontact_verification.fem.yielding import Indentation, YieldingRegion, solve_indentation
from eigencontact_verification.fem.yielding_body import YieldingBody
from eigencontact_verification.fem.yielding_law import YieldingLaw, fading_damage, linear, perfect, swift, voce

R, LOAD = 105e-6, 0.65
A = (3 * LOAD * R * (1 - 0.09) / (4 * 210e9)) ** (1 / 3)
P0 = 1.5 * LOAD / (np.pi * A**2)


def pressed(law=None, cells=6, **more):
    given = {"radius": R, "fine": A / cells, "extent": 1.5 * A, "reach": 20 * A, "law": law, **STEEL, **more}
    return Indentation(**given)


def layer(**rest):
    """Two contact radii of another material, as wide as the mesh."""
    bounds = ((0.0, 0.0), (20 * A, 2 * A))
    return YieldingRegion(contains=lambda r, z: (r >= 0) & (z < 2 * A), bounds=bounds, **rest)


def ring_mesh():
    """Elements that are curved, those of a ball, among straight ones."""
    ball = Fit(contains=lambda r, z: r * r + (z - 2) ** 2 < 1, low=(0.0, 1.0), high=(1.0, 3.0), mark=0)
    lines = np.array([0.0, 0.5, *np.linspace(*ball.box[0][1:], 2), *ball.box[1], 4.0])
    return build(np.unique([0.0, ball.box[1][0], 3.0]), np.unique(np.clip(lines, 0, 4)), [ball], 0.6, 1)


PATCHES = {
    "elastic": {"poisson_ratio": 0.3},
    "perfect": {"poisson_ratio": 0.3, "hardening": perfect(0.01)},
    "near-incompressible": {"poisson_ratio": 0.4999, "hardening": linear(0.01, 0.1), "back_stresses": ((0.1, 20.0),)},
    "damage": {"poisson_ratio": 0.3, "hardening": voce(0.01, 0.02, 50.0), "damage": fading_damage(0.6, 0.02)},
}


@pytest.mark.parametrize("name", PATCHES)
def test_a_uniform_strain_is_in_balance(name):
    """Patch, forth and back and forth: curved elements have the stress of one point and no force inside."""
    law = YieldingLaw(young_modulus=1.0, **PATCHES[name])
    grid = ring_mesh()
    shape = YieldingBody.points_of(grid).shape[1:]
    body = YieldingBody(grid=grid, laws=[law], material=np.zeros(shape, dtype=int), prestrain=np.zeros((4, *shape)))
    basis = body.basis
    r, z = basis.doflocs
    radial = np.zeros(basis.N, dtype=bool)
    for dofs in (basis.nodal_dofs, basis.facet_dofs, basis.interior_dofs):
        radial[dofs[0]] = True
    inside = ~((radial & (r == 0)) | (r == r.max()) | (z == 0) | (z == z.max()))
    states, alone = body.state_at_rest(), law.state_at_rest(4, 1)
    for e_r, e_z in ((0.01, -0.03), (-0.005, 0.02), (0.008, -0.03)):
        u = np.where(radial, e_r * r, e_z * z)
        force, _, after, stress = body.forces(u, states)
        wanted, _, now = law.answer(np.array([[e_r], [e_r], [e_z], [0.0]]), alone)
        assert np.abs(force[inside]).max() < 1e-12 * np.abs(force).max()
        np.testing.assert_allclose(stress.reshape(4, -1), np.broadcast_to(wanted, (4, stress[0].size)), atol=1e-12)
        if name != "perfect":  # its flow under these boundary values may be of other forms too
            u[inside] += 1e-5 * np.random.default_rng(1).normal(size=inside.sum())
            for _ in range(4):
                force, matrix, _, _ = body.forces(u, states)
                u[inside] -= spsolve(matrix[inside][:, inside], force[inside])
            np.testing.assert_allclose(u, np.where(radial, e_r * r, e_z * z), atol=1e-12)
        states, alone = after, now


@pytest.mark.parametrize("outer", ["fixed", "free"])
def test_without_yield_it_is_hertz(outer):
    """Coarse: six elements a radius; depth, radius, pressure, and the stress where it is largest."""
    found = solve_indentation(pressed(outer=outer), [LOAD])
    end = found.moments[0]
    assert end.depth == close(A * A / R, rel=1e-3)
    assert end.contact_radius == close(A, rel=1e-2)
    assert end.pressure.max() == close(P0, rel=1e-2)
    inside = found.surface.r < 0.9 * A
    hertz = P0 * np.sqrt(1 - (found.surface.r[inside] / A) ** 2)
    np.testing.assert_allclose(end.pressure[inside], hertz, atol=0.01 * P0)
    s_r, s_t, s_z, _ = found.stress([[0.0, 0.48 * A]])[:, 0]
    assert s_r == close(s_t, rel=1e-6)
    assert s_r - s_z == close(0.6200 * P0, rel=0.005)


@pytest.mark.parametrize("cells", [3, 4.5, 7.3, 12])
def test_depth_converges_to_hertz(cells):
    """Of order 3/2, and not evenly: it matters where in an element the contact ends."""
    depth = solve_indentation(pressed(cells=cells), [LOAD]).moments[0].depth
    assert depth == close(A * A / R, rel=0.05 * cells**-1.5)


def test_a_body_that_keeps_its_volume_does_not_lock():
    model = pressed(poisson_ratio=0.4999)
    a = (3 * LOAD * R * (1 - 0.4999**2) / (4 * 210e9)) ** (1 / 3)
    assert solve_indentation(model, [LOAD]).moments[0].depth == close(a * a / R, rel=2e-3)


def test_yield_begins_where_hertz_says():
    """At p0 = 1.6128 Y, under the surface, and nowhere below that."""
    limit = YieldingLaw(**STEEL, hardening=perfect(P0 / 1.6128))
    found = solve_indentation(pressed(limit, cells=12), [0.96 * LOAD, 1.06 * LOAD])
    assert found.peak_plastic_strain(0)[0] == 0.0
    size, r, z = found.peak_plastic_strain(1)
    assert size > 1e-5
    assert r < 0.1 * A
    assert z == close(0.48 * A, rel=0.15)


@pytest.fixture(scope="module")
def cycled():
    law = YieldingLaw(**STEEL, hardening=perfect(3e9))
    return solve_indentation(pressed(law), [0.3, LOAD, 0.3, 0.0, 0.3, LOAD, 0.0])


def test_further_cycles_to_the_same_load_are_elastic(cycled):
    """EP-16."""
    depth = [moment.depth for moment in cycled.moments]
    assert depth[5] == close(depth[1], rel=1e-7)
    assert depth[6] == close(depth[3], rel=1e-7)
    assert cycled.peak_plastic_strain(6)[0] == close(cycled.peak_plastic_strain(1)[0], rel=1e-7)


def test_what_stays_balances_itself_and_its_profile_is_a_print(cycled):
    """Without load the normal stress over any level has no resultant; the surface is deepest on the axis."""
    end = cycled.moments[-1]
    assert not np.any(end.pressure)
    print_depth = cycled.surface_displacement([0.0])[0]
    assert print_depth == close(end.depth, rel=1e-6)
    assert print_depth > cycled.surface_displacement([0.3 * A])[0] > 0 > cycled.surface_displacement([1.3 * A])[0]
    r = np.linspace(0.0, 19 * A, 4000)
    level = cycled.stress(np.stack((r, 0 * r + 0.2 * A), axis=1))[2]
    forces = [np.trapezoid(x * r, r) for x in (level, np.abs(level))]
    assert abs(forces[0]) < 0.02 * forces[1]


def test_forces_balance_at_every_load(cycled):
    for moment in cycled.moments:
        force = 2 * np.pi * float(moment.pressure @ cycled.surface.weight)
        assert force == close(moment.load, rel=1e-8, abs=1e-8 * LOAD)


def test_a_layer_of_the_same_law_changes_nothing_where_the_zone_stays_in_it():
    """EP-8: identity."""
    law = YieldingLaw(**STEEL, hardening=perfect(4e9))
    models = (pressed(law, extent=2 * A), pressed(extent=2 * A, regions=(layer(law=law),)))
    depths = [[moment.depth for moment in solve_indentation(x, [0.5 * LOAD, LOAD]).moments] for x in models]
    np.testing.assert_allclose(depths[1], depths[0], rtol=1e-9)


def test_a_prestrained_layer_lifts_and_is_pressed_before_any_load():
    """EP-15: -E ε / (1 - ν) in the plane; the depth counts from the surface that it has made."""
    found = solve_indentation(pressed(extent=2 * A, regions=(layer(eigenstrain=(1e-3, 0.0)),)), [0.0, LOAD])
    s_r, s_t, s_z, _ = found.stress([[0.0, A]], 0)[:, 0]
    assert s_r == close(-300e6, rel=0.01)
    assert s_t == close(s_r, rel=1e-6)
    assert abs(s_z) < 1e6
    assert found.moments[1].depth == close(A * A / R, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [({"fine": 2 * A}, "fine, extent, reach must rise"), ({"outer": "loose"}, "outer must be 'fixed' or 'free'")],
)
def test_models_that_make_no_sense_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        pressed(**change)


SWIFT = YieldingLaw(**STEEL, hardening=swift(1240e6, 30, 0.085))


@pytest.mark.slow
def test_indentation_of_the_reference():
    """EP-1 of cases.md, found by other elements: depth 372.15 nm, print 81.6, 5517 MPa, 1.707 % at .594 a."""
    loads = [*(LOAD * (k / 40) ** 2 for k in range(1, 41)), 0.4, 0.2, 0.05, 0.0]
    found = solve_indentation(pressed(SWIFT, cells=10, reach=30 * A), loads)
    peak = found.moments[39]
    assert peak.depth == close(372.15e-9, rel=5e-4)
    assert peak.pressure.max() == close(5517e6, rel=5e-3)
    assert peak.contact_radius == close(1.105 * A, rel=5e-3)
    assert found.surface_displacement([0.0])[0] == close(81.6e-9, rel=5e-3)
    size, r, z = found.peak_plastic_strain(39)
    assert size == close(0.01707, rel=5e-3)
    assert r < 0.02 * A
    assert z == close(0.594 * A, rel=0.03)


@pytest.mark.slow
def test_the_half_space_that_yields_agrees():
    """The same ten equal load steps by both: depth, pressure on the axis, peak strain, and the print."""
    found = solve_indentation(
        pressed(SWIFT, cells=10, reach=30 * A), [*(LOAD * k / 10 for k in range(1, 11)), 0.3, 0.0]
    )
    law = {"type": "j2", "hardening": {"type": "swift", "B": "1240 MPa", "C": 30, "n": 0.085}}
    scene = ec.Scene(
        body1={"young_modulus": "210 GPa", "poisson_ratio": 0.3, "law": law},
        geometry={"type": "sphere", "radius": "105 um"},
        grid={"cells_per_contact_radius": 8, "margin": 1.6},
        steps=[{"normal_load": "0.65 N", "increments": 10}, {"normal_load": "0 N", "increments": 2}],
        output={"pictures": False},
    )
    judged = ec.run(scene).dataset
    peak = found.moments[9]
    assert float(judged["approach"].max()) == close(peak.depth, rel=2e-3)
    assert float(judged["pressure"].max()) == close(peak.pressure.max(), rel=0.02)
    assert float(judged["equivalent_plastic_strain_1"].max()) == close(found.peak_plastic_strain(9)[0], rel=0.03)
    assert float(judged["max_sink"][-1]) == close(found.surface_displacement([0.0])[0], rel=0.05)
