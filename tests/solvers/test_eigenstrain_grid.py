"""Fields of eigenstrain on lattices by FFT against the sum of the cells' closed forms at the same points.

Relative to the largest value the worst measured on these tables is 2e-15 for stress and strain, 1.3e-13 for
displacement, and 4e-7 in single precision.
"""

import numpy as np
import pytest

from close import close
from direct_sums import sum_of_cells
from eigencontact.core.tensors import SQRT2
from eigencontact.errors import SceneError
from eigencontact.solvers.cells import Cells, offset_in_cells
from eigencontact.solvers.eigenstrain import VolumeField
from eigencontact.solvers.eigenstrain_planes import PlaneFields
from eigencontact_plugins.shapes.cuboid import Cuboid

CELL = Cuboid(center=(0.0, 0.0, 1.0), edges=(1.0, 1.0, 1.0))
BOUND = 1e-11
EDGES = (0.4, 0.5, 0.3)


def box(first, shape, pitch=EDGES):
    """Cells whose first one is at `first`, in cells (x, y, layer)."""
    x, y, layer = first
    return Cells(first=(x * pitch[0], y * pitch[1], (layer + 0.5) * pitch[2]), pitch=pitch, shape=shape)


# source cells, target points
BOXES = {
    "one cell": (box((0, 0, 0), (1, 1, 1)), box((0, 0, 0), (1, 1, 1))),
    "its neighbour": (box((0, 0, 0), (1, 1, 1)), box((0, 1, 0), (1, 1, 1))),
    "flush": (box((0, 0, 0), (3, 2, 4)), box((0, 0, 0), (3, 2, 4))),
    "prime": (box((0, 0, 2), (2, 3, 5)), box((0, 0, 2), (2, 3, 5))),
    "larger box of targets": (box((0, 0, 1), (2, 2, 1)), box((-2, -1, 0), (5, 4, 6))),
    "smaller box of targets": (box((-2, -1, 0), (4, 3, 4)), box((0, 0, 1), (2, 1, 1))),
    "deeper": (box((0, 0, 0), (2, 2, 2)), box((0, 0, 6), (3, 2, 2))),
    "beside": (box((0, 0, 0), (2, 2, 2)), box((9, -8, 0), (2, 2, 3))),
    "on faces between layers": (box((0, 0, 1), (3, 2, 2)), box((0, 0, 0.5), (4, 2, 2))),
    "x and y alike": (box((0, 0, 0), (2, 3, 3), (0.5, 0.5, 0.3)), box((0, 0, 0), (2, 3, 3), (0.5, 0.5, 0.3))),
    "alike and deeper": (box((0, 0, 0), (2, 2, 2), (0.4, 0.4, 0.3)), box((-1, -1, 3), (3, 4, 4), (0.4, 0.4, 0.3))),
    "off the centres": (box((0, 0, 0), (2, 2, 3)), box((0.25, -0.4, 0.3), (3, 2, 2))),
}


def random_strain(source, seed=0):
    return np.random.default_rng(seed).standard_normal((6, *source.shape))


def lattice(cells):
    z, y, x = np.meshgrid(cells.centres(2), cells.centres(1), cells.centres(0), indexing="ij")
    return x.ravel(), y.ravel(), z.ravel()


def error(found, expected):
    # The displacement in the middle of a single cell is zero by symmetry: a hundredth of a cell is the least scale.
    return np.abs(found - expected.reshape(found.shape)).max() / max(np.abs(expected).max(), 1e-2 * min(EDGES))


@pytest.mark.parametrize("space", ["half", "full"])
@pytest.mark.parametrize("quantity", ["stress", "strain", "displacement"])
@pytest.mark.parametrize("boxes", BOXES.values(), ids=BOXES)
def test_volume_equals_the_sum_of_cells(boxes, quantity, space):
    source, target = boxes
    strain = random_strain(source)
    found = VolumeField(CELL, source, target, poisson_ratio=0.3, quantity=quantity, space=space).apply(strain)
    expected = sum_of_cells(source, lattice(target), strain, poisson_ratio=0.3, quantity=quantity, space=space)
    assert error(found, expected) < BOUND


@pytest.mark.parametrize("quantity", ["stress", "strain", "displacement"])
@pytest.mark.parametrize("nu", [0.0, 0.49, 0.4999999, 0.5, -0.5])
def test_every_poisson_ratio(nu, quantity):
    source, target = BOXES["larger box of targets"]
    strain = random_strain(source)
    expected = sum_of_cells(source, lattice(target), strain, poisson_ratio=nu, quantity=quantity)
    found = VolumeField(CELL, source, target, poisson_ratio=nu, quantity=quantity).apply(strain)
    assert error(found, expected) < BOUND


@pytest.mark.parametrize("component", range(6))
def test_each_component_of_eigenstrain_alone(component):
    source, target = BOXES["flush"]
    strain = np.zeros((6, *source.shape))
    strain[component] = random_strain(source)[component]
    found = VolumeField(CELL, source, target, poisson_ratio=0.3).apply(strain)
    assert error(found, sum_of_cells(source, lattice(target), strain, poisson_ratio=0.3, quantity="stress")) < BOUND


@pytest.mark.parametrize(
    "pitch",
    [(1e-3, 1.0, 1.0), (1.0, 1.0, 1e-3), (1.0, 1e3, 1.0), (1.0, 1.0, 1e3), (2e-9, 2e-9, 2e-9), (3.0, 4.0, 5.0)],
    ids=str,
)
@pytest.mark.parametrize("quantity", ["stress", "displacement"])
def test_flat_and_slender_cells_of_any_size(pitch, quantity):
    source = box((0, 0, 0), (2, 2, 2), pitch)
    strain = random_strain(source)
    expected = sum_of_cells(source, lattice(source), strain, poisson_ratio=0.3, quantity=quantity)
    found = VolumeField(CELL, source, source, poisson_ratio=0.3, quantity=quantity).apply(strain)
    assert np.abs(found.ravel() - expected.ravel()).max() < BOUND * np.abs(expected).max()


@pytest.mark.parametrize("quantity", ["stress", "strain", "displacement"])
@pytest.mark.parametrize("boxes", ["flush", "larger box of targets", "off the centres"])
def test_single_precision(boxes, quantity):
    source, target = BOXES[boxes]
    strain = random_strain(source)
    double, single = (
        VolumeField(CELL, source, target, poisson_ratio=0.3, quantity=quantity, shear_modulus=8e10, precision=p)
        for p in ("double", "single")
    )
    assert single.nbytes < 0.6 * double.nbytes
    found, expected = single.apply(strain), double.apply(strain)
    assert found.dtype == np.float32
    assert 1e-9 < error(found, expected) < 2e-6


@pytest.mark.parametrize("space", ["half", "full"])
@pytest.mark.parametrize("quantity", ["stress", "strain", "displacement"])
@pytest.mark.parametrize("boxes", ["its neighbour", "flush", "off the centres"])
def test_planes_equal_the_sum_of_cells(boxes, quantity, space):
    source, target = BOXES[boxes]
    strain, (_, y, x) = random_strain(source), offset_in_cells(source, target)
    depths = np.array([0.0, 0.1, 0.3, 0.45, 0.6, 2.0])
    planes = PlaneFields(
        CELL, source, target=target.shape[1:], origin=(y, x), depths=depths,
        poisson_ratio=0.3, quantity=quantity, space=space,
    )  # fmt: skip
    found = planes.apply(strain)
    points = [lattice(Cells(first=(*target.first[:2], z), pitch=EDGES, shape=(1, *target.shape[1:]))) for z in depths]
    at = np.concatenate(points, axis=1)
    expected = sum_of_cells(source, at, strain, poisson_ratio=0.3, quantity=quantity, space=space)
    assert error(found, expected) < BOUND


@pytest.mark.parametrize("quantity", ["stress", "displacement"])
def test_planes_that_are_asked_together_equal_each_alone(quantity):
    """Points on edges of the cells, in the surface, on two faces between layers, between faces, and far below."""
    source, depths = box((0, 0, 0), (3, 4, 4)), [0.0, 0.3, 0.6, 0.7, 4.0, 0.9]
    options = {"target": (3, 3), "origin": (0.5, 0.5), "poisson_ratio": 0.3, "quantity": quantity}
    strain = random_strain(source)
    together = PlaneFields(CELL, source, depths=depths, **options).apply(strain)
    for number, depth in enumerate(depths):
        alone = PlaneFields(CELL, source, depths=[depth], **options).apply(strain)
        assert error(together[:, [number]], alone) < 1e-13


@pytest.mark.parametrize("quantity", ["stress", "displacement"])
def test_planes_equal_the_volume(quantity):
    source = box((0, 0, 0), (11, 6, 9))
    strain = random_strain(source)
    volume = VolumeField(CELL, source, source, poisson_ratio=0.28, quantity=quantity).apply(strain)
    planes = PlaneFields(
        CELL, source, target=(6, 9), depths=source.centres(2)[[0, 4, 10]], poisson_ratio=0.28, quantity=quantity
    )
    assert error(planes.apply(strain), volume[:, [0, 4, 10]]) < BOUND


def on_surface(source, target, origin=(0.0, 0.0), **options):
    """Displacement of the free surface."""
    return PlaneFields(
        CELL, source, target=target, origin=origin, depths=[0.0], poisson_ratio=0.3, quantity="displacement", **options
    )


@pytest.mark.parametrize("components", ["xyz", "z", "yx"])
def test_displacement_of_the_surface(components):
    source = box((0, 0, 0), (9, 3, 4))
    strain = random_strain(source)
    strain[1] = strain[:, 5] = 0.0
    numbers = ["xyz".index(name) for name in components]
    surface = on_surface(source, (5, 6), (-1, -1), components=numbers)
    assert surface.kernels <= 9 * 6 * len(components)
    plane = Cells(first=(-EDGES[0], -EDGES[1], 0.0), pitch=EDGES, shape=(1, 5, 6))
    expected = sum_of_cells(source, lattice(plane), strain, poisson_ratio=0.3, quantity="displacement").reshape(3, 5, 6)
    assert error(surface.apply(strain)[:, 0], expected[numbers]) < BOUND
    assert not surface.apply(np.zeros_like(strain)).any()


def test_many_layers_in_single_precision():
    source = box((0, 0, 0), (40, 16, 16))
    strain = random_strain(source)
    double, single = (on_surface(source, (16, 16), precision=precision) for precision in ("double", "single"))
    assert 1e-9 < error(single.apply(strain), double.apply(strain)) < 2e-6


@pytest.mark.parametrize("depth", [3, 16, 64])
def test_cells_far_from_all_points_keep_their_digits(depth):
    """Sums over corners lose the third power of the distance in cells: 6e-11 at 16, 2e-9 at 64 in double precision."""
    source = box((0, 0, depth), (2, 1, 1), (1.0, 1.0, 1.0))
    strain = random_strain(source)
    surface = on_surface(source, (3, 40), (-1, -20))
    plane = Cells(first=(-20.0, -1.0, 0.0), pitch=source.pitch, shape=(1, 3, 40))
    expected = sum_of_cells(source, lattice(plane), strain, poisson_ratio=0.3, quantity="displacement")
    expected = expected.reshape(3, 3, 40)
    assert np.abs(surface.apply(strain)[:, 0] - expected).max() < BOUND * np.abs(expected).max()
    target = box((-20, -1, 0), (1, 3, 40), source.pitch)
    expected = sum_of_cells(source, lattice(target), strain, poisson_ratio=0.3, quantity="stress").reshape(6, 1, 3, 40)
    stress = VolumeField(CELL, source, target, poisson_ratio=0.3).apply(strain)
    assert np.abs(stress - expected).max() < BOUND * np.abs(expected).max()


def test_superposition():
    source, target = BOXES["smaller box of targets"]
    operator = VolumeField(CELL, source, target, poisson_ratio=0.3)
    one, two = random_strain(source, 1), random_strain(source, 2)
    both = operator.apply(2.0 * one - 3.0 * two)
    assert error(2.0 * operator.apply(one) - 3.0 * operator.apply(two), both) < 1e-14


def test_uniform_swelling_of_everything_rises_and_is_squeezed():
    """The signs: a swollen box flush with the surface lifts it (u_z < 0) and stands under pressure along x and y."""
    source = box((-4, -4, 0), (4, 9, 9), (1.0, 1.0, 1.0))
    strain = np.zeros((6, *source.shape))
    strain[:3] = 1e-3
    u = on_surface(source, (9, 9)).apply(strain)[:, 0]
    assert (u[2] < 0).all()
    assert u[2].argmin() == 40
    stress = VolumeField(CELL, source, source, poisson_ratio=0.3, shear_modulus=8e10).apply(strain)
    assert (stress[:2] < 0).all()
    assert np.abs(stress[2:, 0, 4, 4]).max() < 0.5 * np.abs(stress[:2, 0, 4, 4]).min()


def test_traction_on_the_surface_vanishes():
    source = box((0, 0, 0), (5, 4, 4))
    planes = PlaneFields(CELL, source, target=(4, 4), depths=[0.0], poisson_ratio=0.3)
    stress = planes.apply(random_strain(source))[:, 0]
    assert np.abs(stress[[2, 3, 4]]).max() < 1e-12 * np.abs(stress).max()


def test_shear_strain_is_mandel():
    """A simple shear far below the surface: inside a cube its stress is -2 mu e (1 - 2 S_1212) per tensor component."""
    source = box((0, 0, 400), (1, 1, 1), (1.0, 1.0, 1.0))
    strain = np.zeros((6, 1, 1, 1))
    strain[5] = SQRT2 * 1e-3
    stress = VolumeField(CELL, source, source, poisson_ratio=0.3).apply(strain)[5, 0, 0, 0]
    alone = VolumeField(CELL, source, source, poisson_ratio=0.3, space="full").apply(strain)[5, 0, 0, 0]
    assert stress == close(alone, rel=1e-7)
    assert -2e-3 * SQRT2 < stress < -0.5e-3 * SQRT2


def test_refusals():
    source, target = BOXES["flush"]
    with pytest.raises(SceneError, match=r"volume\.quantity must be one of"):
        VolumeField(CELL, source, target, poisson_ratio=0.3, quantity="energy")
    with pytest.raises(SceneError, match=r"volume\.space must be"):
        VolumeField(CELL, source, target, poisson_ratio=0.3, space="quarter")
    with pytest.raises(SceneError, match=r"volume\.source must be in z >= 0"):
        VolumeField(CELL, box((0, 0, -1), (2, 2, 2)), target, poisson_ratio=0.3)
    with pytest.raises(SceneError, match=r"cells\.pitch of targets must be that of the sources"):
        VolumeField(CELL, source, box((0, 0, 0), (2, 2, 2), (1.0, 1.0, 1.0)), poisson_ratio=0.3)
    with pytest.raises(SceneError, match=r"volume\.eigenstrain must be of shape \(6, 3, 2, 4\)"):
        VolumeField(CELL, source, target, poisson_ratio=0.3).apply(np.zeros((6, 2, 2, 2)))
    at_surface = box((0, 0, -0.5), (3, 2, 4))
    with pytest.raises(SceneError, match="first target depth must be below the surface"):
        VolumeField(CELL, source, at_surface, poisson_ratio=0.3)
    with pytest.raises(SceneError, match=r"planes\.components must be indices below 3"):
        on_surface(source, (1, 1), components=[3])
    with pytest.raises(SceneError, match=r"planes\.components must be indices below 6"):
        PlaneFields(CELL, source, target=(1, 1), depths=[0.0], poisson_ratio=0.3, components=[6])
