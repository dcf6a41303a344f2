"""Eigenstrain and laws below line contacts: rectangles by Betti's theorem, Hooke's law, wide layers, onset of yield."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.core.tensors import COMPONENTS, SQRT2
from eigencontact.errors import SceneError
from eigencontact.halfspace.endless import EndlessCell
from eigencontact.solvers.cells import Cells
from eigencontact.solvers.eigenstrain import VolumeField
from eigencontact.solvers.eigenstrain_planes import PlaneFields
from eigencontact.solvers.mean_stress import MeanVolumeField
from eigencontact.solvers.potential_tables import cell_kernels, reduced_response, sample_tables
from eigencontact_plugins.shapes.cuboid import Cuboid
from eigencontact_verification.oracles.line_contact import flamant

NU = 0.3
CUBE = Cuboid(center=(0.0, 0.0, 0.5), edges=(1.0, 1.0, 1.0))
ENDLESS = EndlessCell(CUBE)
#: One rectangle of 0.5 x 0.5 with its middle 0.75 below the surface.
RECTANGLE = Cells(first=(0.0, 0.0, 0.75), pitch=(0.5, 1.0, 0.5), shape=(1, 1, 1))


def planes(depths, quantity, shift=0.0):
    return PlaneFields(
        ENDLESS, RECTANGLE, target=(1, 9), origin=(0.0, -4.0 + shift / 0.5), depths=depths, poisson_ratio=NU,
        quantity=quantity,
    )  # fmt: skip


def unit(component):
    out = np.zeros((6, 1, 1, 1))
    out[component] = 1.0
    return out


def work_of_line_forces(name, x):
    """Displacement x and z of surface points by a unit eigenstrain in the rectangle, by Betti's theorem."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    at_x, at_z = np.meshgrid(0.25 * nodes, 0.75 + 0.25 * nodes, indexing="ij")
    area = 0.25**2 * np.outer(weights, weights)
    out = []
    for place in x:
        along_z, along_x = flamant(at_x - place, at_z)
        for xx, zz, xz in (along_x, along_z):
            stress = {"xx": xx, "yy": NU * (xx + zz), "zz": zz, "xz": SQRT2 * xz}[name]
            out.append(float(np.sum(area * stress)))
    return np.reshape(out, (-1, 2)).T


@pytest.mark.parametrize("name", ["xx", "yy", "zz", "xz"])
def test_surface_displacement_of_a_rectangle(name):
    u = planes([0.0], "displacement").apply(unit(COMPONENTS.index(name)))[:, 0, 0]
    expected = work_of_line_forces(name, 0.5 * (np.arange(9) - 4.0))
    np.testing.assert_allclose(u[[0, 2]], expected, rtol=0, atol=1e-14)
    assert not u[1].any()


@pytest.mark.parametrize("component", range(6))
def test_stress_of_a_rectangle_obeys_hooke_and_leaves_the_surface_free(component):
    strain, h, z = unit(component), 1e-3, 0.3
    d_x = (planes([z], "displacement", h).apply(strain) - planes([z], "displacement", -h).apply(strain)) / (2 * h)
    d_z = (planes([z + h], "displacement").apply(strain) - planes([z - h], "displacement").apply(strain)) / (2 * h)
    (ux_x, uy_x, uz_x), (ux_z, uy_z, uz_z) = d_x[:, 0, 0], d_z[:, 0, 0]
    wave = 2 * NU / (1 - 2 * NU) * (ux_x + uz_z)
    parts = [wave + 2 * ux_x, wave, wave + 2 * uz_z, SQRT2 * uy_z, SQRT2 * (ux_z + uz_x), SQRT2 * uy_x]
    stress = planes([0.0, z], "stress").apply(strain)
    np.testing.assert_allclose(stress[:, 1, 0], parts, rtol=0, atol=1e-5)
    np.testing.assert_allclose(stress[2:5, 0], 0.0, rtol=0, atol=1e-15)


def test_kernels_are_the_limit_of_long_cells():
    """All kernels of stress and displacement, against cells of 2e4 along y; the rest falls with their length."""
    x, z = np.arange(-2.4, 2.7), np.array([0.3, 1.3, 2.3])
    for quantity in ("stress", "displacement"):
        for kernel in cell_kernels(reduced_response(quantity, NU, "half")):
            long = sample_tables(CUBE, [kernel], (x, np.array([-1e4, 1e4]), z), threads=1, extended=True)
            endless = sample_tables(ENDLESS, [kernel], (x, np.array([-0.5, 0.5]), z), threads=1)
            np.testing.assert_allclose(endless, long, rtol=0, atol=3e-4)
            assert endless.any() == (kernel[2][1] == 0)


def test_volumes_and_means_agree_with_planes():
    rng = np.random.default_rng(1)
    box = Cells(first=(0.0, 0.0, 0.25), pitch=(0.5, 1.0, 0.5), shape=(4, 1, 6))
    strain = rng.standard_normal((6, 4, 1, 6))
    volume = VolumeField(ENDLESS, box, box, poisson_ratio=NU).apply(strain)
    depths = box.centres(2)
    planar = PlaneFields(ENDLESS, box, target=(1, 6), depths=depths, poisson_ratio=NU).apply(strain)
    np.testing.assert_allclose(volume, planar, rtol=0, atol=1e-12)
    means = MeanVolumeField(ENDLESS, box, box, poisson_ratio=NU)
    other = rng.standard_normal((6, 4, 1, 6))
    works = np.vdot(other, means.apply(strain)), np.vdot(strain, means.apply(other))
    assert works[0] == close(works[1], rel=0.02)  # reciprocal up to the Gauss points of the means
    assert np.vdot(strain, means.apply(strain)) < 0.0  # eigenstrain never releases energy


def plane_strain(**tables):
    """A cylinder of radius 1 on a body with E* = 1000; stress in units of one."""
    grid = {"length": "infinite"} | tables.pop("grid", {})
    base = {"body1": {"young-modulus": 1000 * (1 - NU**2), "poisson-ratio": NU}, "output": {"pictures": False}}
    return base | {"geometry": {"type": "cylinder", "radius": 1.0}, "grid": grid} | tables


def test_a_wide_strained_layer_is_in_biaxial_stress():
    """Below first touch: xx and yy of -E ε/(1 - ν) in a layer 40 times as wide as deep, in the middle of it."""
    layer = {"type": "uniform", "value": 1e-3, "depth": 0.05, "size": [4.0, 1.0]}
    tables = plane_strain(
        grid={"cells": 320, "size": 4.0},
        eigenstrain=layer,
        steps=[{"normal-load": 0.0}],
        stress=[{"shape": "points", "name": "middle", "points": [[0.006, 0.0, 0.0242]]}],
    )
    xx, yy, zz = ec.run(tables).dataset.middle_stress.values[-1, :3, 0]
    expected = -1000 * (1 - NU**2) * 1e-3 / (1 - NU)
    assert xx == close(expected, rel=0.05)  # the ends of the layer, at 40 depths, release some of it
    assert yy == close(NU * xx + (1 - NU) * expected, rel=0.01)
    assert abs(zz) < 0.01 * abs(expected)


def pressed(ratio, **tables):
    """Run at Hertz's largest pressure by the shear yield stress, which is 1."""
    half = 2.0 * ratio / 1000
    law = {"type": "j2", "hardening": {"type": "perfect", "yield-stress": np.sqrt(3.0)}}
    base = plane_strain(
        grid={"cells-per-contact-radius": 12},
        steps=[{"normal-load": 0.5 * np.pi * half * ratio, "increments": 2}],
        **tables,
    )
    base["body1"] = base["body1"] | {"law": law}
    return ec.run(base), half


def test_yield_begins_at_3_107_times_the_shear_strength_on_the_axis():
    elastic, _ = pressed(3.05)
    assert elastic.summary.get("max_plastic_strain", 0.0) == 0.0
    plastic, half = pressed(3.2)
    data = plastic.dataset
    assert plastic.summary["max_plastic_strain"] > 0.0
    assert plastic.summary["units"]["plastic_volume"] == "m2"
    strain = data.equivalent_plastic_strain_1.values[-1].reshape(-1, data.equivalent_plastic_strain_1.shape[-1])
    layer, column = np.unravel_index(int(strain.argmax()), strain.shape)
    axes = [data[name].values for name in data.equivalent_plastic_strain_1.dims[-3:]]
    assert axes[0][layer] == close(0.704 * half, abs=0.1 * half)
    assert axes[2][column] == close(0.0, abs=0.05 * half)
    assert strain == close(strain[:, ::-1], abs=1e-3 * strain.max())  # mirror symmetry


def test_bodies_that_yield_stay_in_plane_strain():
    """Total strain along y is zero, where the plastic strain is not."""
    points = [[0.0, 0.0, 0.0046], [0.002, 0.0, 0.0055]]
    region = {"shape": "points", "name": "zone", "points": points, "fields": ["stress", "strain"]}
    result, _ = pressed(4.0, stress=[region])
    strain = result.dataset.zone_strain.values[-1]
    np.testing.assert_allclose(strain[[1, 3, 5]], 0.0, rtol=0, atol=1e-12)
    assert np.abs(strain[[0, 2]]).min() > 5e-4
    assert np.abs(result.dataset.plastic_strain_1.values[-1, 1]).max() > 1e-4


def inside_a_rod(**inclusion):
    """Stress in the middle of a rod of radius 0.1, 20 radii deep, that expands by 1e-3."""
    rod = {"type": "sphere", "center": [0, 0, 2.0], "radius": 0.1, "eigenstrain": {"type": "uniform", "value": 1e-3}}
    region = {"shape": "points", "name": "middle", "points": [[0.0, 0.3, 2.0], [0.03, 0.0, 2.0]]}
    tables = plane_strain(grid={"cells": 64, "size": 1.28}, inclusions=rod | inclusion, steps=[{}], stress=[region])
    del tables["geometry"]
    return ec.run(tables).dataset.middle_stress.values[-1]


@pytest.mark.parametrize("stiffness", [1.0, 0.1, 4.0])
def test_stress_in_an_expanding_rod(stiffness):
    """Pressure p on a rod in an infinite body, (1+ν₁)(1-2ν₁) p/E₁ + (1+ν) p/E = (1+ν₁) ε, and no strain along it."""
    E = 1000 * (1 - NU**2)
    constants = {"type": "isotropic", "young-modulus": stiffness * E, "poisson-ratio": NU}
    xx, yy, zz, *shear = inside_a_rod(**({} if stiffness == 1.0 else {"material": constants}))
    p = 1e-3 / ((1 - 2 * NU) / (stiffness * E) + 1 / E)
    # Cells of a fifth of the radius; the surface, at 20 radii, and the few cells each leave a part of the difference.
    np.testing.assert_allclose([xx, zz], -p, rtol=0.02)
    np.testing.assert_allclose(yy, -2 * NU * p - stiffness * E * 1e-3, rtol=0.02)
    np.testing.assert_allclose(shear, 0.0, rtol=0, atol=2e-3 * p)


def test_refusals_of_regions():
    ball = {"type": "sphere", "center": [0, 0.5, 0.05], "radius": 0.01}
    strained = ball | {"eigenstrain": {"type": "uniform", "value": 1e-3}}
    loaded = plane_strain(grid={"cells": 64, "size": 0.2}, steps=[{"normal-load": 1.0}])
    with pytest.raises(SceneError, match="cut by the plane y = 0"):
        ec.plan(ec.load_scene(loaded | {"inclusions": strained}))
    whole = {"inclusion-resolution": {"whole": 2}}
    with pytest.raises(SceneError, match="must be 'cells' in a line contact"):
        ec.load_scene(loaded | {"inclusions": strained, "numerics": whole})
    with pytest.raises(SceneError, match="must be 'exact' or 'full-space' for eigenstrain below a line contact"):
        ec.load_scene(loaded | {"inclusions": strained, "numerics": {"half-space": "image-pressure"}})
