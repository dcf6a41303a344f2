"""Finite elements of revolution of loaded bodies: Hertz, coatings, spheres, stored cells, damage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import j0

from eigencontact_verification.fem.loaded_body import Cells, LoadedBody, Tractions
from eigencontact_verification.fem.loaded_revolution import solve_loaded
from eigencontact_verification.fem.model import Layer, Region
from eigencontact_verification.fem.revolution import of_revolution
from eigencontact_verification.fem.uncertainty import estimate
from eigencontact_verification.oracles import cuboid_quadrature, eshelby, eshelby_sphere, hertz, layered_dense, mindlin

NU = 0.3


def hertz_cells(count=60, centre=(0.0, 0.0), stretch=1.0, ratio=1.25):
    """Hertz's pressure of radius 1 averaged over square cells."""
    edges = np.linspace(-ratio, ratio, count + 1)
    fine = np.linspace(-ratio, ratio, 8 * count + 1)
    middles = (fine[1:] + fine[:-1]) / 2
    square = 1 - (middles / stretch) ** 2 - (middles[:, None]) ** 2
    pressure = np.sqrt(np.maximum(0, square)).reshape(count, 8, count, 8).mean(axis=(1, 3))
    return Tractions(x=edges + centre[0], y=edges + centre[1], values=np.stack([0 * pressure, 0 * pressure, pressure]))


def loaded(**rest):
    return LoadedBody(**({"young_modulus": 1.0, "poisson_ratio": NU, "tractions": hertz_cells()} | rest))


def ball(centre, radius=1.0, **rest):
    def contains(x, y, z):
        return (x - centre[0]) ** 2 + (y - centre[1]) ** 2 + (z - centre[2]) ** 2 <= radius**2

    bounds = tuple(tuple(float(x + sign * radius) for x in centre) for sign in (-1, 1))
    return Region(contains=contains, bounds=bounds, **rest)


def box(low, high, **rest):
    def contains(x, y, z):
        return np.all([(p >= a) & (p <= b) for p, a, b in zip((x, y, z), low, high, strict=True)], axis=0)

    return Region(contains=contains, bounds=(low, high), **rest)


def expected(body, points, *reads):
    """Value and uncertainty of what is read, by three meshes and both outer boundaries."""
    solved = [solve_loaded(body, level=k, outer="fixed", watched=points) for k in (0, 1, 2)]
    solved.append(solve_loaded(body, level=1, outer="free", watched=points))
    found = []
    for read in reads:
        *fields, other = map(read, solved)
        found.append(estimate(*fields, ratio=2.0, formal_order=2.0, other_outer=other, other_level=1))
    return found if len(found) > 1 else found[0]


def axis_points(depths):
    return np.stack([0 * depths, 0 * depths, depths], axis=1)


def test_what_is_of_revolution():
    assert of_revolution(loaded()).axis == (0.0, 0.0)
    assert of_revolution(loaded(layers=(Layer(thickness=0.5, young_modulus=2.0, poisson_ratio=0.2),))) is not None
    moved = hertz_cells(centre=(3.0, -2.0))
    both = loaded(tractions=moved, regions=(ball((3.0, -2.0, 2.0), eigenstrain=0.01 * np.eye(3)),))
    assert np.allclose(of_revolution(both).axis, (3.0, -2.0), rtol=1e-12, atol=0)
    assert of_revolution(loaded()).scatter < 0.03


SLIDING = replace(hertz_cells(), values=hertz_cells().values[[2, 1, 2]] * np.array([0.3, 1.0, 1.0])[:, None, None])


@pytest.mark.parametrize(
    "change",
    [
        {"tractions": hertz_cells(stretch=1.1)},
        {"tractions": SLIDING},
        {"regions": (ball((0.1, 0.0, 2.0), eigenstrain=0.01 * np.eye(3)),)},
        {"regions": (ball((-1.5, 0.0, 2.0), young_modulus=2.0), ball((1.5, 0.0, 2.0), young_modulus=2.0))},
        {"regions": (box((-1.0, -1.0, 1.0), (1.0, 1.0, 2.0), young_modulus=2.0),)},
        {"regions": (ball((0.0, 0.0, 2.0), eigenstrain=np.diag([0.01, 0.0, 0.0])),)},
    ],
    ids=["ellipse", "sliding", "off the axis", "two balls", "cuboid", "eigenstrain along x"],
)
def test_what_is_not(change):
    body = loaded(**change)
    assert of_revolution(body) is None
    with pytest.raises(ValueError, match="of revolution"):
        solve_loaded(body, level=0, outer="fixed", watched=[[0.0, 0.0, 1.0]])


@pytest.mark.slow
def test_hertz_pressure_on_cells_gives_the_displacement_and_stress_of_hertz():
    depths = np.linspace(0.15, 3.0, 15)
    points = axis_points(depths)
    along, across = hertz.axis_stress(depths, NU)
    body = loaded(tractions=hertz_cells(100))
    found = expected(body, points, lambda s: s.stress(points)[:, (0, 2), (0, 2)])
    truth = np.stack([across, along], axis=1)
    assert np.all(np.abs(found.value - truth) <= found.uncertainty + 2e-4)  # 2e-4: the cells are not the ellipsoid
    assert np.abs(found.value - truth).max() < 3e-4
    assert found.uncertainty.max() < 3e-3
    r = np.linspace(0.0, 0.9, 10)
    surface = np.stack([r, 0 * r, 0 * r], axis=1)
    truth = (1 - NU**2) * np.pi / 4 * (2 - r**2)
    found = expected(body, surface, lambda s: s.displacement(surface)[:, 2])
    assert np.all(np.abs(found.value - truth) <= found.uncertainty + 2e-4 * truth[0])
    assert np.abs(found.value - truth).max() < 4e-4 * truth[0]
    assert found.uncertainty.max() < 3e-3 * truth[0]


@pytest.mark.slow
def test_an_expanding_ball_below_a_free_surface():
    depth, strain = 1.6, 0.01
    body = loaded(tractions=None, regions=(ball((0.0, 0.0, depth), eigenstrain=strain * np.eye(3)),))
    r = np.linspace(0.0, 4.0, 17)
    points = np.stack([r, 0 * r, 0 * r], axis=1)
    found = expected(body, points, lambda s: s.displacement(points))
    truth = eshelby.dilatational_ball_displacement(points, (0.0, 0.0, depth), 1.0, strain, NU)
    assert np.all(np.abs(found.value - truth) <= found.uncertainty)
    assert found.uncertainty.max() < 5e-3 * np.abs(truth).max()


LAYERS = {
    "stiff": (Layer(thickness=0.5, young_modulus=3.0, poisson_ratio=0.25),),
    "soft on stiff": (
        Layer(thickness=0.3, young_modulus=0.4, poisson_ratio=0.35),
        Layer(thickness=0.6, young_modulus=2.5, poisson_ratio=0.2),
    ),
}


def layered_hertz(layers, k_last, z, read):
    """Hankel integral of Hertz's pressure √(1 - r²) on layers; ``read(k, u, s)`` of plane waves, z in the body."""
    x, w = np.polynomial.legendre.leggauss(8)
    width = k_last / np.ceil(k_last)
    k = (np.arange(0.0, k_last, width)[:, None] + width * (x + 1) / 2).ravel()
    weight = width / 2 * np.tile(w, k.size // x.size) * (np.sin(k) - k * np.cos(k)) / k**2
    moduli = [(one.thickness, one.young_modulus / 2 / (1 + one.poisson_ratio), one.poisson_ratio) for one in layers]
    base = (1 / 2 / (1 + NU), NU)
    waves = [layered_dense.traction_wave(moduli, base, (1.0, 0.0, 0.0), one, 0.0, z) for one in k]
    return np.tensordot(weight, np.array([read(one, u.real, s.real) for one, (u, s) in zip(k, waves, strict=True)]), 1)


@pytest.mark.slow
@pytest.mark.parametrize("name", LAYERS)
def test_layers_under_hertz_pressure_are_those_of_the_hankel_integral(name):
    body = loaded(tractions=hertz_cells(100), layers=LAYERS[name])
    depths = np.array([0.15, 0.25, 0.45, 0.7, 1.1, 1.6])
    r = np.array([0.0, 0.3, 0.6, 0.8, 1.2, 1.5])  # not at the edge of the load, which cells make a stair of
    axis, surface = axis_points(depths), np.stack([r, 0 * r, 0 * r], axis=1)
    watched = np.concatenate([axis, surface])

    def stress_on_axis(_k, _u, s):  # the mean over the directions of the wave
        return np.array([(s[0] + s[1]) / 2, s[2]])

    truths = (
        np.array([layered_hertz(LAYERS[name], 40 / z, z, stress_on_axis) for z in depths]),
        layered_hertz(LAYERS[name], 300.0, 0.0, lambda k, u, _: u[2] * j0(k * r)),
    )
    both = expected(body, watched, lambda s: s.stress(axis)[:, (0, 2), (0, 2)], lambda s: s.displacement(surface)[:, 2])
    for truth, found in zip(truths, both, strict=True):
        scale = np.abs(truth).max()
        assert np.all(np.abs(found.value - truth) <= found.uncertainty + 3e-4 * scale)  # 3e-4: the cells
        assert found.uncertainty.max() < 0.01 * scale


@pytest.mark.slow
def test_a_deep_stiffer_ball_with_prestrain_has_the_stress_of_eshelby():
    depth, own = 15.0, np.diag([0.01, 0.01, -0.005])  # the surface is felt by (1/15)^3
    centre = (0.0, 0.0, depth)
    body = loaded(tractions=None, regions=(ball(centre, young_modulus=3.0, poisson_ratio=0.2, eigenstrain=own),))
    points = np.array([[0.0, 0.0, depth], [0.5, 0.0, depth], [0.3, 0.4, depth + 0.5], [0.0, 0.0, depth - 0.8]])
    stiffness = eshelby_sphere.isotropic_stiffness(3.0, 0.2)
    truth, _ = eshelby_sphere.sphere_in_body(stiffness, 1.0, NU, np.zeros((3, 3)), own)
    found = expected(body, points, lambda s: s.stress(points).reshape(len(points), 9))
    scale = np.abs(truth).max()
    assert np.abs(found.value - truth.ravel()).max() < found.uncertainty.max() + 1e-3 * scale
    assert found.uncertainty.max() < 0.01 * scale


def strained_cells(kept=None):
    """Cells of an eigenstrain that is of revolution within their steps, e_rr = e_tt = -e_zz / 2, radius 1."""
    edges, depths = np.linspace(-1.2, 1.2, 13), np.array([0.2, 0.5, 0.9])
    middles = (edges[1:] + edges[:-1]) / 2
    amount = np.maximum(0.0, 1.0 - (middles**2 + middles[:, None] ** 2) / 1.2**2) * np.ones((2, 1, 1))
    tensor = np.diag([0.01, 0.01, -0.02])[:, :, None, None, None] * amount
    return Cells(x=edges, y=edges, z=depths, eigenstrain=tensor, stiffness_factor=kept)


@pytest.mark.slow
def test_stored_cells_give_what_their_cuboids_give_on_the_axis():
    # on the axis a displacement along it is its own mean over the angle: no error of revolution is left
    cells = strained_cells()
    body = loaded(tractions=None, cells=(cells,))
    point = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.6]])
    truth = 0.0
    for k, row, column in zip(*np.nonzero(cells.eigenstrain[2, 2]), strict=True):
        corner = np.array([cells.x[column], cells.y[row], cells.z[k]])
        edges = np.array([cells.x[column + 1], cells.y[row + 1], cells.z[k + 1]]) - corner
        moments = cuboid_quadrature.moments(point, corner + edges / 2, edges, gauss=8)
        truth = truth + mindlin.displacement(moments, cells.eigenstrain[:, :, k, row, column], NU)[:, 2]
    found = expected(body, point, lambda s: s.displacement(point)[:, 2])
    assert np.all(np.abs(found.value - truth) <= found.uncertainty)
    assert found.uncertainty.max() < 0.01 * np.abs(truth).max()


@pytest.mark.slow
def test_cells_that_keep_a_part_of_the_stiffness_are_a_softer_body():
    edges, depths = np.linspace(-1.0, 1.0, 41), np.array([0.5, 1.0, 1.5])
    samples = np.hypot(*np.meshgrid(*2 * [np.linspace(-1, 1, 401)[:-1] + 0.0025])).reshape(40, 10, 40, 10)
    lost = 0.4 * np.mean(samples <= 0.8, axis=(1, 3)) * np.ones((2, 1, 1))
    cells = Cells(x=edges, y=edges, z=depths, eigenstrain=np.zeros((3, 3, *lost.shape)), stiffness_factor=1 - lost)

    def rod(x, y, z):
        return (x**2 + y**2 <= 0.64) & (z >= 0.5) & (z <= 1.5)

    region = Region(contains=rod, bounds=((-0.8, -0.8, 0.5), (0.8, 0.8, 1.5)), young_modulus=0.6, poisson_ratio=NU)
    points = np.array([[0.0, 0.0, 0.0], [0.3, 0.2, 0.75], [0.0, 0.3, 1.2], [0.0, 0.0, 2.0]])
    solid = solve_loaded(loaded(), level=1, outer="fixed", watched=points)
    one, other = (
        solve_loaded(loaded(**part), level=1, outer="fixed", watched=points)
        for part in ({"cells": (cells,)}, {"regions": (region,)})
    )
    effect = np.abs(other.displacement(points) - solid.displacement(points)).max()
    assert effect > 0.01
    assert np.abs(one.displacement(points) - other.displacement(points)).max() < 0.03 * effect
    assert np.abs(one.stress(points) - other.stress(points)).max() < 0.01


@pytest.mark.slow
def test_a_thinner_layer_is_told_from_a_layer():
    depths = np.array([0.1, 0.3, 0.7, 1.0, 1.5])
    points = axis_points(depths)
    bodies = [loaded(layers=(Layer(thickness=t, young_modulus=3.0, poisson_ratio=NU),)) for t in (0.5, 0.475)]
    thick, thin = (expected(body, points, lambda s: s.stress(points)[:, (0, 2), (0, 2)]) for body in bodies)
    far = np.abs(thick.value - thin.value) > thick.uncertainty + thin.uncertainty
    assert np.any(far)
