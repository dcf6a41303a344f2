"""Layers, inhomogeneities and eigenstrain in the elements of line contacts: closed forms, Betti's theorem, limits.

Lengths in the half width of a Hertz contact with R = E* = 1, P = π/4 and p0 = 1/2 (per unit length).
"""

from __future__ import annotations

import numpy as np
import pytest

from close import close
from eigencontact_verification.fem.line_contact import LineBody, LineContact, LineStep, PlaneRegion, solve_line_contact
from eigencontact_verification.oracles.line_contact import flamant

NU, P, P0 = 0.3, np.pi / 4, 0.5
E = 1 - NU**2


def solved(*steps, regions=(), reach=60.0, fine=0.25, **rest):
    body = LineBody(young_modulus=E, poisson_ratio=NU, regions=regions)
    base = {"gap": lambda x: x**2 / 2, "window": (-1.5, 1.5), "growth": 2.0, "deep": 0.5}
    return solve_line_contact(LineContact(bodies=(body,), fine=fine, reach=reach, **{**base, **rest}), steps)


def layer(bottom, **rest):
    return PlaneRegion(low=(-np.inf, 0.0), high=(np.inf, bottom), **rest)


def ball(x, depth, radius, **rest):
    def inside(s, t):
        return (s - x) ** 2 + (t - depth) ** 2 < radius**2

    return PlaneRegion(low=(x - radius, depth - radius), high=(x + radius, depth + radius), contains=inside, **rest)


@pytest.fixture(scope="module")
def graded():
    """Settings of a graded mesh, and the contact without regions on it."""
    settings = {"edges": (-1.0, 1.0), "sharp": 1 / 64, "divisions": 2}
    return settings, solved(LineStep(normal=P), **settings)


@pytest.mark.slow
@pytest.mark.parametrize(
    "region",
    [
        layer(0.3, young_modulus=E),
        ball(0.2, 0.8, 0.4, poisson_ratio=NU),
        PlaneRegion(low=(-0.3, 0.2), high=(0.6, 0.9), young_modulus=E),
    ],
    ids=["layer", "ball", "rectangle"],
)
def test_regions_of_the_same_material_change_nothing(region, graded):
    """Another mesh, and the same contact: to the error of both meshes."""
    settings, bare = graded
    same = solved(LineStep(normal=P), regions=(region,), **settings)
    assert len(same.bodies[0].laws) == 2
    at = np.linspace(-0.8, 0.8, 9)
    found, expected = (np.interp(at, s.x, s.moments[0].pressure) for s in (same, bare))
    assert found == close(expected, abs=0.004 * P0)
    points = np.array([[0.1, 0.5], [0.3, 0.7], [0.2, 1.0], [-0.9, 0.55], [0.4, 1.7]])
    assert same.stress(points) == close(bare.stress(points), abs=0.004 * P0)


@pytest.mark.parametrize(("thickness", "share"), [(8.0, 1.0), (0.005, 0.02)])
def test_a_layer_between_its_own_material_and_that_of_the_substrate(thickness, share):
    """Of four times the modulus the largest pressure doubles; a thin one is not felt."""
    coated = solved(LineStep(normal=P), regions=(layer(thickness, young_modulus=4 * E),), deep=0.2)
    bare = solved(LineStep(normal=P), deep=0.2)
    rise = coated.moments[0].pressure.max() / bare.moments[0].pressure.max() - 1.0
    assert rise == close(share, abs=0.02)


def test_a_strained_layer_is_in_biaxial_stress():
    """-E ε/(1 - ν) of the layer's own constants in xx and yy, none below, far from the sides."""
    strained = layer(0.7, young_modulus=3.0, poisson_ratio=0.2, eigenstrain=(1e-2, 1e-2, 1e-2, 0.0))
    s = solved(LineStep(normal=0.0), regions=(strained,), reach=200.0)
    points = np.array([[-0.4, 0.1], [0.2, 0.6], [5.0, 0.3], [0.0, 0.8], [1.0, 20.0]])
    expected = np.zeros((4, 5))
    expected[:2, :3] = -3.0 * 1e-2 / 0.8
    assert s.stress(points) == close(expected, abs=2e-3 * 0.0375)


@pytest.mark.parametrize(("stiffer", "nu"), [(4.0, 0.2), (0.25, 0.4), (0.0, None)])
def test_a_round_inhomogeneity_under_remote_stress(stiffer, nu):
    """Goodier's uniform stress in it, 40 radii below the surface; beside a void three times the remote stress."""
    kappa, pull = 3 - 4 * NU, 0.1
    s = solved(
        LineStep(normal=0.0, bulk=(pull, 0.0)),
        regions=(ball(0.0, 10.0, 0.25, young_modulus=stiffer * E, poisson_ratio=nu),), window=(-0.25, 0.25), deep=0.1,
        divisions=2,
    )  # fmt: skip
    own = NU if nu is None else nu
    m, kappa_in = stiffer * (1 + NU) / (1 + own), 3 - 4 * own
    mean, shear = (1 + kappa) * m / (kappa_in - 1 + 2 * m), (1 + kappa) * m / (1 + kappa * m)
    xx, _, zz, xz = s.stress(np.array([[0.0, 10.0], [0.1, 9.9], [-0.05, 10.15]]), 0)
    assert xx == close(np.full(3, pull * (mean + shear) / 2), abs=2e-3 * pull)
    assert zz == close(np.full(3, pull * (mean - shear) / 2), abs=2e-3 * pull)
    assert xz == close(np.zeros(3), abs=2e-3 * pull)
    if stiffer == 0.0:
        r, t = 0.4, 0.25**2 / 0.4**2  # Kirsch, above the void
        assert s.stress([[0.0, 10.0 - r]])[0] == close([pull * (1 + t / 2 + 3 * t * t / 2)], rel=2e-3)


STRAIN = {"xx": 0, "yy": 1, "zz": 2, "xz": 3}


@pytest.mark.parametrize("name", STRAIN)
def test_surface_displacement_of_a_strained_rectangle(name):
    """By Betti's theorem: the work of the stress of a line force on it, up to a rigid motion."""
    eigenstrain = np.zeros(4)
    eigenstrain[STRAIN[name]] = 0.01
    region = PlaneRegion(low=(-0.2, 0.3), high=(0.5, 0.8), eigenstrain=tuple(eigenstrain))
    s = solved(LineStep(normal=0.0), regions=(region,), fine=0.125, reach=100.0)
    half, at = s.halves[0], np.arange(0, len(s.x), 5)
    x = s.x[at]
    nodes, weights = np.polynomial.legendre.leggauss(40)
    at_x, at_z = np.meshgrid(0.15 + 0.35 * nodes, 0.55 + 0.25 * nodes, indexing="ij")
    area = 0.35 * 0.25 * np.outer(weights, weights)
    for which in (0, 1):  # by a force along z, along x
        u = s.moments[0].displacement[half.surface[which][at]]
        expected = []
        for place in x:
            xx, zz, xz = flamant(at_x - place, at_z)[which]
            stress = {"xx": xx, "yy": NU * (xx + zz), "zz": zz, "xz": 2 * xz}[name]
            expected.append(0.01 * float(np.sum(area * stress)))
        expected = np.array(expected)
        if which == 0:  # a remote rotation and shift are held by the far boundary, and left by the free body
            assert u - u.mean() == close(expected - expected.mean(), abs=2e-3 * np.ptp(expected) + 1e-6)
        else:
            assert u - u.mean() == close(expected - expected.mean(), abs=4e-3 * np.abs(expected).max())


def test_refusals():
    with pytest.raises(ValueError, match="must rise"):
        PlaneRegion(low=(0.0, 1.0), high=(1.0, 0.5))
    with pytest.raises(ValueError, match="below z = 0"):
        ball(0.0, 0.5, 0.5)


@pytest.mark.parametrize(("outer", "error"), [("free", 1e-9), ("fixed", 1e-4)])
def test_layers_share_the_strain_of_the_substrate(outer, error):
    """Bulk stress of the substrate: that of the layer is larger by the ratio of E / (1 - nu²)."""
    stretched = solved(
        LineStep(normal=0.0, bulk=(0.1, 0.0)), regions=(layer(0.3, young_modulus=2.0, poisson_ratio=0.2),), outer=outer
    )
    xx, yy, zz, xz = stretched.stress(np.array([[0.0, 0.1], [0.5, 0.2], [0.0, 0.5], [0.7, 1.5]]))
    inside = 0.1 * 2.0 / (1 - 0.2**2)
    assert xx == close([inside, inside, 0.1, 0.1], rel=error)
    assert yy == close([0.2 * inside, 0.2 * inside, NU * 0.1, NU * 0.1], rel=error)
    assert np.abs([zz, xz]).max() < error * 0.1
