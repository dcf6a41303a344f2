"""Axisymmetric finite elements against closed forms; their own orders of convergence, two-sided."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from close import close
from eigencontact_verification.fem.axisymmetric import (
    AxisymmetricLayer,
    AxisymmetricModel,
    AxisymmetricRegion,
    Disc,
    point_force_stress,
    solve_axisymmetric,
    surface_load,
)
from eigencontact_verification.fem.axisymmetric_mesh import graded_lines
from eigencontact_verification.oracles import boussinesq, eshelby, hertz

NU = 0.3


def ball(depth, radius=1.0, **rest):
    def contains(r, z):
        return r * r + (z - depth) ** 2 <= radius * radius

    bounds = ((0.0, depth - radius), (radius, depth + radius))
    return AxisymmetricRegion(contains=contains, bounds=bounds, **rest)


def rod(radius, low, high, **rest):
    return AxisymmetricRegion(
        contains=lambda r, z: (r <= radius) & (z >= low) & (z <= high), bounds=((0.0, low), (radius, high)), **rest
    )


def body(**rest):
    return AxisymmetricModel(**({"young_modulus": 1.0, "poisson_ratio": NU, "reach": 8.0, "fine": 0.5} | rest))


def slope(errors, divisions=(1, 2, 4)):
    """Least-squares order of errors on a family of meshes."""
    return -np.polyfit(np.log(divisions), np.log(errors), 1)[0]


def stiffness(young, nu):
    lame, mu, I = young * nu / (1 + nu) / (1 - 2 * nu), young / 2 / (1 + nu), np.eye(3)
    shear = np.einsum("ik,jl->ijkl", I, I) + np.einsum("il,jk->ijkl", I, I)
    return lame * np.einsum("ij,kl->ijkl", I, I) + mu * shear


def stress_in_sphere(young, remote):
    """Uniform stress in a sphere of another Young's modulus under a remote stress (Eshelby's equivalent inclusion)."""
    S, C0, C1 = eshelby.sphere_tensor(NU), stiffness(1.0, NU), stiffness(young, NU)
    e0 = ((1 + NU) * remote - NU * np.trace(remote) * np.eye(3)).ravel()
    gap, full = (C1 - C0).reshape(9, 9), S.reshape(9, 9)
    symmetric = np.einsum("ik,jl->ijkl", np.eye(3), np.eye(3)).reshape(9, 9)
    extra = np.linalg.lstsq(gap @ full + C0.reshape(9, 9), -gap @ e0, rcond=None)[0]
    return (C1.reshape(9, 9) @ (e0 + full @ (symmetric @ extra))).reshape(3, 3)


POINTS = np.random.default_rng(1).uniform((-3, -3, 0), (3, 3, 8), (200, 3))


@pytest.mark.parametrize("fitted", [True, False])
@pytest.mark.parametrize("divisions", [1, 2])
def test_patch(fitted, divisions):
    """Linear displacement is exact to round-off, on curved and on cut elements too."""
    model = body(regions=(ball(3.0, fitted=fitted, young_modulus=1.0),), divisions=divisions)
    solution = solve_axisymmetric(model, prescribed=lambda r, z: (0.3 * r, 0.2 - 0.7 * z))
    exact = POINTS * (0.3, 0.3, -0.7) + (0, 0, 0.2)
    np.testing.assert_allclose(solution.displacement(POINTS), exact, atol=2e-13)
    strain = np.diag((0.3, 0.3, -0.7))
    stress = np.einsum("ijkl,kl->ij", stiffness(1.0, NU), strain)
    np.testing.assert_allclose(solution.stress(POINTS), np.broadcast_to(stress, (len(POINTS), 3, 3)), atol=2e-12)


def spheroid(depth, radius, half_height, ring=0.0):
    def contains(r, z):
        return ((r - ring) / radius) ** 2 + ((z - depth) / half_height) ** 2 <= 1

    bounds = ((max(0.0, ring - radius), depth - half_height), (ring + radius, depth + half_height))
    return AxisymmetricRegion(contains=contains, bounds=bounds, fitted=True)


SHAPES = {
    "shallow ball": spheroid(1.05, 1.0, 1.0),
    "ball that touches the surface": spheroid(1.000001, 1.0, 1.0),
    "disc": spheroid(1.0, 1.5, 0.3),
    "needle": spheroid(3.0, 0.3, 1.5),
    "torus": spheroid(2.0, 0.5, 0.7, ring=2.0),
    "torus at the axis": spheroid(2.0, 0.5, 0.5, ring=0.55),
}


@pytest.mark.parametrize("name", SHAPES)
def test_patch_on_the_meshes_of_shapes(name):
    """Linear displacement is exact, elements are not folded, and are inside or outside as a whole."""
    region = SHAPES[name]
    solution = solve_axisymmetric(body(regions=(region,)), prescribed=lambda r, z: (r, z))
    np.testing.assert_allclose(solution.displacement(POINTS), POINTS, atol=1e-11)
    grid = solution.grid
    jacobian = grid.mesh.mapping().detDF(np.array([[0.0, 1.0, 1.0, 0.0, 0.5], [0.0, 0.0, 1.0, 1.0, 0.5]]))
    assert jacobian.min() > 0
    r, z = grid.nodes[:, :4].mean(axis=1)
    assert np.array_equal(grid.marks == 0, region.contains(r, z))


@pytest.mark.parametrize("fitted", [True, False])
def test_uniform_eigenstrain_is_free_of_stress(fitted):
    """A whole free body that expands uniformly: its parts, one fitted, one not, have the same eigenstrain."""
    e = (0.01, -0.02)
    inner = ball(3.0, eigenstrain=(0.0, 0.0), young_modulus=1.0, fitted=fitted)
    everything = AxisymmetricRegion(
        contains=lambda r, z: np.ones_like(r + z, dtype=bool), bounds=((0.0, 0.0), (7.0, 7.0)), eigenstrain=e
    )
    model = body(regions=(inner, everything), outer="free")
    solution = solve_axisymmetric(model)
    assert np.abs(solution.stress(POINTS)).max() < 1e-14
    shift = solution.displacement(POINTS) - POINTS * (e[0], e[0], e[1])
    assert np.ptp(shift, axis=0).max() < 1e-13


def manufactured(r, z):
    """u = (r (1 - r^2) cos z, (1 + r^2) sin z) and its body force for E = 1, nu = 0.3."""
    lame, mu = NU / (1 + NU) / (1 - 2 * NU), 1 / 2 / (1 + NU)
    c, s = np.cos(z), np.sin(z)
    # Navier: f_r = -[(lame + 2 mu) d(div)/dr - mu d(curl)/dz], f_z = -[(lame + 2 mu) d(div)/dz + mu (1/r) d(r curl)/dr]
    # with div = (3 - 3 r^2) c and curl = u_z,r - u_r,z taken with the sign of e_t: u_r,z - u_z,r
    curl_z = -r * (1 - r * r) * c - 2 * r * c
    over_r = -2 * (1 - 2 * r * r) * s - 4 * s  # (1/r) d(r curl)/dr
    f_r = -((lame + 2 * mu) * -6 * r * c + mu * curl_z)
    f_z = -((lame + 2 * mu) * -(3 - 3 * r * r) * s - mu * over_r)
    return (r * (1 - r * r) * c, (1 + r * r) * s), (f_r, f_z)


@pytest.mark.parametrize("fitted", [True, False])
def test_manufactured_solution_has_the_full_order(fitted):
    errors = []
    points = POINTS / 8 * (1.8, 1.8, 1.9)
    for divisions in (1, 2, 4):
        region = ball(1.0, radius=0.4, young_modulus=1.0, fitted=fitted)
        model = body(reach=2.0, fine=0.25, regions=(region,), divisions=divisions)
        solution = solve_axisymmetric(
            model, body_force=lambda r, z: manufactured(r, z)[1], prescribed=lambda r, z: manufactured(r, z)[0]
        )
        r = np.hypot(points[:, 0], points[:, 1])
        (u_r, u_z), _ = manufactured(r, points[:, 2])
        exact = np.stack((u_r * points[:, 0] / r, u_r * points[:, 1] / r, u_z), axis=1)
        errors.append(np.sqrt(np.mean((solution.displacement(points) - exact) ** 2)))
    assert abs(slope(errors) - 3) < 0.25
    assert errors[-1] < 1e-5


SURFACE = np.array([[0, 0, 0], [0.5, 0, 0], [1.0, 1.0, 0]])
DEEP = np.array([[0, 0, 1.5], [0.3, 0.2, 2.4], [0.1, -0.6, 2.2], [1.3, 0.4, 2.2], [0, 0, 4.0]])


def hot_ball(divisions, fitted, outer="fixed", reach=40.0):
    region = ball(2.0, eigenstrain=(1.0, 1.0), fitted=fitted)
    solution = solve_axisymmetric(body(reach=reach, fine=0.4, regions=(region,), divisions=divisions, outer=outer))
    points = np.concatenate((SURFACE, DEEP))
    u = eshelby.dilatational_ball_displacement(points, (0, 0, 2), 1.0, 1.0, NU)
    s = eshelby.dilatational_ball_stress(points, (0, 0, 2), 1.0, 1.0, NU, 0.5 / (1 + NU))
    return (solution.displacement(points) - u) / np.abs(u).max(), (solution.stress(points) - s) / np.abs(s).max()


@pytest.mark.slow
def test_dilatational_ball_on_a_fitted_mesh():
    errors = np.array([np.abs(hot_ball(d, fitted=True)[1]).max() for d in (1, 2, 4)])
    assert abs(slope(errors) - 2) < 0.35
    assert errors[-1] < 2.5e-3


def test_dilatational_ball_on_cut_elements():
    """The stress beside the boundary is worse than on the fitted mesh; displacement and far stress are not."""
    u, s = hot_ball(2, fitted=False)
    assert np.abs(u).max() < 6e-3
    assert np.abs(s[:3]).max() < 0.03


@pytest.mark.slow
def test_fixed_and_free_bracket_the_half_space():
    """Uplift of a hot ball: the two conditions err in opposite senses, and less with reach."""
    parts = {
        (o, R): hot_ball(1, fitted=True, outer=o, reach=R)[0] for o in ("fixed", "free") for R in (10.0, 20.0, 40.0)
    }
    for R in (10.0, 20.0, 40.0):
        assert np.all(parts["fixed", R][:3, 2] > 0)
        assert np.all(parts["free", R][:3, 2] < 0)
    for outer in ("fixed", "free"):
        errors = [np.abs(parts[outer, R][:3, 2]).max() for R in (10.0, 20.0, 40.0)]
        assert errors[1] < 0.6 * errors[0]
        assert errors[2] < 0.4 * errors[1]


@pytest.mark.slow
@pytest.mark.parametrize("nu", [0.0, 0.45])
def test_eshelby_sphere_with_uniaxial_eigenstrain(nu):
    """Deep in a large body: uniform strain inside; rms error over the ball."""
    e = np.diag((0.0, 0.0, 1.0))
    strain = eshelby.apply(eshelby.sphere_tensor(nu), e)
    exact = np.einsum("ijkl,kl->ij", stiffness(1.0, nu), strain - e)
    rng = np.random.default_rng(2)
    points = rng.normal(size=(100, 3))
    points *= (0.97 * np.cbrt(rng.random(100)) / np.linalg.norm(points, axis=1))[:, None]
    points[:, 2] += 20
    errors = []
    for divisions in (1, 2, 3):
        region = ball(20.0, eigenstrain=(0.0, 1.0), fitted=True)
        model = body(poisson_ratio=nu, reach=40.0, growth=1.6, regions=(region,), divisions=divisions)
        off = solve_axisymmetric(model).stress(points) - exact
        errors.append(np.sqrt(np.mean(off**2)) / np.abs(exact).max())
    # the displacement inside is linear: what is wrong comes from outside, a little faster than the stress there
    assert abs(slope(errors, (1, 2, 3)) - 2.6) < 0.35
    assert errors[-1] < 2e-3


@pytest.mark.parametrize(("profile", "force", "moment"), [("uniform", 1.0, 1 / 2), ("hertz", 2 / 3, 4 / 15)])
def test_load_of_a_disc_is_exact(profile, force, moment):
    """Force and work on u_z = r^2: the integrals of p and p r^2 over the disc, in units of p0 pi a^2 and p0 pi a^4."""
    disc = Disc(radius=1.7, pressure=3.0, profile=profile)
    model = body(fine=0.7, discs=(disc,))
    basis = solve_axisymmetric(model).basis
    load = surface_load(disc, basis) * 2 * np.pi
    assert load.sum() == close(force * 3 * np.pi * 1.7**2, rel=1e-14)
    assert load @ basis.doflocs[0] ** 2 == close(moment * 3 * np.pi * 1.7**4, rel=1e-13)
    assert model.load == close(load.sum(), rel=1e-14)


@pytest.mark.parametrize("outer", ["fixed", "free"])
def test_stiff_ball_that_swells(outer):
    """Moduli and eigenstrain at once, deep in the body: hydrostatic, total strain e 3 K1 / (3 K1 + 4 mu0) (Lame)."""
    young, nu, e = 4.0, 0.2, 0.01
    region = ball(20.0, eigenstrain=(e, e), young_modulus=young, poisson_ratio=nu, fitted=True)
    model = body(reach=40.0, growth=1.6, fine=0.25, regions=(region,), divisions=2, outer=outer)
    bulk, mu = young / 3 / (1 - 2 * nu), 0.5 / (1 + NU)
    strain = e * 3 * bulk / (3 * bulk + 4 * mu)
    solution = solve_axisymmetric(model)
    inside = solution.stress([[0, 0, 20.0], [0.3, 0.4, 20.3], [-0.6, 0.1, 19.5]])
    pressure = 3 * bulk * (e - strain)
    np.testing.assert_allclose(inside, np.broadcast_to(-pressure * np.eye(3), inside.shape), atol=2e-3 * pressure)
    outward = solution.displacement([[1.0, 0, 20.0], [2.0, 0, 20.0]])[:, 0]
    np.testing.assert_allclose(outward, [strain, strain / 4], rtol=2e-3)


def hertz_displacement(r, nu):
    """u_z of the surface for p0 = a = E = 1 (Johnson 1985, eqs. 3.41a and 3.42a)."""
    outside = np.maximum(r, 1.0)
    far = ((2 - outside**2) * np.arcsin(1 / outside) + np.sqrt(outside**2 - 1)) / 2
    return (1 - nu**2) * np.where(r <= 1, np.pi / 4 * (2 - r * r), far)


@pytest.mark.parametrize(("nu", "outer"), [(0.0, "free"), (0.3, "fixed"), (0.45, "free")])
def test_hertz_pressure(nu, outer):
    disc = Disc(radius=1.0, pressure=1.0, profile="hertz")
    model = body(poisson_ratio=nu, reach=20.0, fine=0.1, growth=1.15, divisions=2, discs=(disc,), outer=outer)
    model = replace(model, far_field=True)
    solution = solve_axisymmetric(model)
    surface = np.array([[0, 0, 0], [0.3, 0.4, 0], [0, 0.95, 0], [1.5, 0, 0], [3, 0, 0]])
    exact = hertz_displacement(np.hypot(surface[:, 0], surface[:, 1]), nu)
    np.testing.assert_allclose(solution.displacement(surface)[:, 2], exact, atol=1e-4 * exact[0])
    z = np.array([0.2, 0.5, 1.0, 3.0])
    sigma_z, sigma_r = hertz.axis_stress(z, nu)
    stress = solution.stress(np.stack((0 * z, 0 * z, z), axis=1))
    np.testing.assert_allclose(stress[:, 2, 2], sigma_z, atol=3e-3)
    np.testing.assert_allclose(stress[:, 0, 0], sigma_r, atol=3e-3)
    np.testing.assert_allclose(stress[:, 1, 1], sigma_r, atol=3e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("far_field", "rate"), [(False, 1.0), (True, 3.0)])
def test_truncation_under_a_load(far_field, rate):
    """u_z under a uniform disc, 2 (1 - nu^2) p a / E, is wrong like 1 / reach; with the far field like 1 / reach^3."""
    exact = 2 * (1 - NU**2)
    errors = []
    for reach in (5.0, 10.0, 20.0):
        disc = Disc(radius=1.0, pressure=1.0)
        model = body(reach=reach, fine=0.1, divisions=2, discs=(disc,), far_field=far_field)
        errors.append(abs(solve_axisymmetric(model).displacement([[0, 0, 0]])[0, 2] / exact - 1))
    assert abs(slope(errors) - rate) < 0.25
    assert errors[-1] < (2e-5 if far_field else 0.05)


def test_point_force_agrees_with_the_oracle():
    x, z = np.array([0.0, 1.0, 3.0]), np.array([2.0, 1.5, 0.5])
    oracle = boussinesq.point_force("p", x, 0 * x, z, NU)
    ours = point_force_stress(1.0, NU, x, z)
    for name, value in zip((3, 5, 7), ours, strict=True):
        np.testing.assert_allclose(value, oracle[name], rtol=1e-12, err_msg=str(name))


@pytest.mark.parametrize("young", [0.0, 2.0, 1e4])
def test_sphere_in_a_remote_field(young):
    """Uniform stress inside, by Eshelby's equivalent inclusion; a void has none."""
    remote = np.diag((0.5, 0.5, 1.0))
    region = ball(20.0, young_modulus=young, fitted=True)
    solution = solve_axisymmetric(
        body(reach=40.0, growth=1.6, fine=0.25, regions=(region,), divisions=2, remote_stress=(0.5, 1.0))
    )
    exact = stress_in_sphere(young, remote) if young else np.zeros((3, 3))
    inside = solution.stress([[0, 0, 20.0], [0.3, 0.4, 20.3], [-0.6, 0.1, 19.5]])
    np.testing.assert_allclose(inside, np.broadcast_to(exact, inside.shape), atol=3e-3)
    far = solution.stress([[20.0, 20.0, 5.0]])[0]
    np.testing.assert_allclose(far, remote, atol=1e-3)


@pytest.mark.slow
def test_stress_concentration_at_a_void():
    """Goodier 1933: s_zz at the equator of a void under uniaxial tension is 3 (9 - 5 nu) / (2 (7 - 5 nu))."""
    exact = (27 - 15 * NU) / (2 * (7 - 5 * NU))
    errors = []
    for divisions in (1, 2, 3):
        region = ball(20.0, young_modulus=0.0, fitted=True)
        model = body(
            reach=40.0, growth=1.6, fine=0.25, regions=(region,), divisions=divisions, remote_stress=(0.0, 1.0)
        )
        errors.append(solve_axisymmetric(model).stress([[1 + 1e-9, 0, 20.0]])[0, 2, 2] / exact - 1)
    assert abs(slope(np.abs(errors), (1, 2, 3)) - 1.8) < 0.3
    assert abs(errors[-1]) < 4e-3


def test_void_under_a_pressure_gives_way():
    """A void below a loaded disc raises the displacement above it, a stiff sphere lowers it."""
    disc = Disc(radius=1.0, pressure=1.0)
    middle = []
    for young in (0.0, 1.0, 1e4):
        model = body(reach=20.0, fine=0.3, discs=(disc,), regions=(ball(2.0, young_modulus=young, fitted=True),))
        middle.append(solve_axisymmetric(model).displacement([[0, 0, 0]])[0, 2])
    assert middle[0] > 1.1 * middle[1] > 1.1 * 1.02 * middle[2]


def test_layers_of_the_body_itself_change_nothing():
    disc = Disc(radius=1.0, pressure=1.0, profile="hertz")
    plain = body(discs=(disc,), lines=((), (0.4, 1.1)))
    layers = tuple(AxisymmetricLayer(thickness=t, young_modulus=1.0, poisson_ratio=NU) for t in (0.4, 0.7))
    one, two = (solve_axisymmetric(m) for m in (plain, replace(plain, layers=layers)))
    np.testing.assert_allclose(two.stress(POINTS), one.stress(POINTS), atol=1e-12)
    np.testing.assert_allclose(two.displacement(POINTS), one.displacement(POINTS), atol=1e-12)


def test_layer_in_uniaxial_strain():
    """u_z prescribed at base and top of a confined stack: one stress through both layers."""
    layer = AxisymmetricLayer(thickness=2.0, young_modulus=3.0, poisson_ratio=0.2)
    c = [young * (1 - nu) / (1 + nu) / (1 - 2 * nu) for young, nu in ((3.0, 0.2), (1.0, NU))]

    def column(r, z):
        return 0 * r, np.minimum(z, 2.0) / c[0] + np.maximum(z - 2.0, 0) / c[1]

    solution = solve_axisymmetric(body(layers=(layer,)), prescribed=column)
    np.testing.assert_allclose(solution.stress(POINTS)[:, 2, 2], 1.0, atol=1e-12)


def test_interface_belongs_to_the_side_below():
    """Stress on the lower face of a rod with a lateral eigenstrain jumps; on the line the far side counts."""
    solution = solve_axisymmetric(body(regions=(rod(1.0, 1.0, 3.0, eigenstrain=(1.0, 0.0)),), divisions=2))
    above, on, below = solution.stress([[0.2, 0, 3 - 1e-7], [0.2, 0, 3.0], [0.2, 0, 3 + 1e-7]])[:, 0, 0]
    assert abs(on - below) < 1e-5
    assert abs(above - on) > 0.5


def test_cartesian_components_turn_with_the_point():
    solution = solve_axisymmetric(body(regions=(rod(1.0, 1.0, 3.0, eigenstrain=(1.0, -0.5)),)))
    angle = 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    here = np.array([[0.4, 0.0, 0.7], [1.7, 0.0, 2.1], [0.0, 0.0, 2.0]])
    np.testing.assert_allclose(solution.displacement(here @ turn.T), solution.displacement(here) @ turn.T, atol=1e-13)
    np.testing.assert_allclose(solution.stress(here @ turn.T), turn @ solution.stress(here) @ turn.T, atol=1e-12)


def test_normal_stresses_are_continuous_towards_the_axis():
    """u_r / r is noise very near r = 0, where its limit takes over."""
    solution = solve_axisymmetric(body(regions=(rod(1.0, 1.0, 3.0, eigenstrain=(1.0, -0.5)),)))
    stress = solution.stress([[0.0, 0, 0.7], [1e-17, 0, 0.7], [1e-11, 0, 0.7], [1e-6, 0, 0.7]])
    normal = np.diagonal(stress, axis1=1, axis2=2)
    np.testing.assert_allclose(normal[1:], np.broadcast_to(normal[0], (3, 3)), atol=1e-6)
    assert normal[0, 0] == normal[0, 1]


def test_graded_lines_keep_bounds_size_and_growth():
    lines = graded_lines([0, 1, 3, 40], [(1, 3)], 0.25, 1.3)
    assert {0.0, 1.0, 3.0, 40.0} <= set(lines)
    steps = np.diff(lines)
    assert steps.min() > 0.1
    assert steps[(lines[:-1] >= 1) & (lines[1:] <= 3)].max() <= 0.25 + 1e-12
    ratio = steps[1:] / steps[:-1]
    assert np.all((ratio < 1.35) & (ratio > 1 / 1.35))


def test_vtu_file(tmp_path):
    import meshio

    solution = solve_axisymmetric(body(regions=(ball(3.0, eigenstrain=(1.0, 1.0), fitted=True),)))
    solution.write_vtu(tmp_path / "ball.vtu")
    mesh = meshio.read(tmp_path / "ball.vtu")
    np.testing.assert_allclose(mesh.point_data["displacement"], solution.displacement(mesh.points), atol=1e-12)
    assert mesh.cell_data["stress"][0].shape == (len(mesh.cells[0].data), 9)
    assert set(mesh.cell_data["region"][0]) == {-1, 0}


BAD = [
    ({"outer": "open"}, "model outer must be 'fixed' or 'free'"),
    ({"poisson_ratio": 0.5}, "poisson_ratio must be above -1 and below 0.5"),
    ({"reach": 3.0, "regions": (ball(3.0),)}, "model reach must be beyond all regions"),
    ({"growth": 1.0}, "model growth must be above 1"),
]


@pytest.mark.parametrize(("rest", "message"), BAD)
def test_bad_models_are_refused(rest, message):
    with pytest.raises(ValueError, match=message):
        body(**rest)


def test_bad_parts_are_refused():
    with pytest.raises(ValueError, match="fitted region bounds must be below the surface"):
        ball(1.0, fitted=True)
    with pytest.raises(ValueError, match="disc profile must be"):
        Disc(radius=1.0, pressure=1.0, profile="flat")
    with pytest.raises(ValueError, match="points must be in the body"):
        solve_axisymmetric(body()).displacement([[0, 0, -1.0]])
    both = body(regions=(ball(2.0, fitted=True), ball(4.2, fitted=True)))
    with pytest.raises(ValueError, match="fitted regions must be apart"):
        solve_axisymmetric(both)
