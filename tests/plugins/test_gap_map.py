"""A separation given as numbers, from a file or from memory, and regions of voxels."""

import gc

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.core.held_arrays import arrays_of, hold

X, Y = np.linspace(-8e-6, 8e-6, 33), np.linspace(-9e-6, 9e-6, 37)
GAP = (X**2 + Y[:, None] ** 2) / (2 * 105e-6) + 1e-7


def scene(file):
    return {
        "body1": {"young-modulus": 210e9, "poisson-ratio": 0.3},
        "geometry": {"type": "gap-map", "file": str(file)},
        "steps": {"normal-load": 0.65},
    }


def test_a_gap_of_a_file_or_of_memory_is_the_sphere_it_was_made_of(tmp_path):
    np.savez(tmp_path / "gap.npz", x=X, y=Y, gap=GAP)
    in_memory = hold(x=X, y=Y, gap=GAP)
    one, other = (ec.run(scene(file)).dataset for file in (tmp_path / "gap.npz", in_memory.name))
    np.testing.assert_array_equal(one.pressure, other.pressure)
    grid = {"grid": {"cells": [33, 37], "spacing": 0.5e-6}}
    ball = ec.run(scene("") | grid | {"geometry": {"type": "sphere", "radius": 105e-6}}).dataset
    np.testing.assert_allclose(one.pressure, ball.pressure, atol=1e-9 * float(ball.pressure.max()))
    assert float(one.approach[-1] - ball.approach[-1]) == close(1e-7, abs=1e-15)  # it counts from a separation of 0


def test_between_the_points_it_is_bilinear_and_beyond_them_that_of_the_border():
    gap = ec.make("gap-map", file=(kept := hold(x=[0.0, 1.0], y=[0.0, 2.0], gap=[[1.0, 2.0], [3.0, 5.0]])).name)
    found = gap.separation(np.array([0.5, -4.0, 1.0]), np.array([1.0, 0.0, 9.0]))
    np.testing.assert_allclose(found, [2.75, 1.0, 5.0], rtol=1e-12)
    assert len(kept) == 3


def test_uneven_points_are_refused():
    uneven = hold(x=[0.0, 1.0, 3.0], y=[0.0, 1.0], gap=np.zeros((2, 3)))
    with pytest.raises(ec.EigencontactError, match=r"gap-map\.file must be a raster of equal steps along x"):
        ec.make("gap-map", file=uneven.name)


def test_arrays_are_held_as_long_as_somebody_keeps_them():
    kept = hold(values=np.arange(3))
    assert hold(values=np.arange(3)) is kept
    assert hold(values=np.arange(3.0)).name != kept.name
    assert not kept["values"].flags.writeable
    name = kept.name
    del kept
    gc.collect()
    assert arrays_of(name) is None
    with pytest.raises(ec.EigencontactError, match=r"gap-map\.file must be arrays that are held in memory \(got"):
        ec.make("gap-map", file=name)


LABELS = np.zeros((4, 5, 6), dtype=np.int16)
LABELS[1:3, 2:4, 1:5], LABELS[1, 2, 1] = 7, 3


def test_shares_of_cells_that_voxels_fill():
    image = hold(labels=LABELS)
    grain = ec.make("voxels", file=image.name, value=7, spacing=(2.0, 3.0, 4.0), origin=(-1.0, 0.0, 2.0))
    assert grain.bounds == ((1.0, 6.0, 6.0), (9.0, 12.0, 14.0))
    whole = grain.volume_fractions((-1.0, 0.0, 2.0), (2.0, 3.0, 4.0), (4, 5, 6))
    np.testing.assert_array_equal(whole, LABELS == 7)
    low, edges, shape = (-1.3, 0.7, 3.0), (1.7, 2.9, 3.1), (5, 6, 7)
    shares = grain.volume_fractions(low, edges, shape)
    drawn = np.random.default_rng(3).uniform(0, 1, (4000, 3))
    for cell in [(1, 2, 2), (2, 3, 4), (0, 0, 0), (1, 1, 1)]:
        x, y, z = (low[a] + (cell[2 - a] + drawn[:, a]) * edges[a] for a in range(3))
        assert shares[cell] == close(grain.contains(x, y, z).mean(), abs=0.03)
    assert shares.sum() * np.prod(edges) == close((LABELS == 7).sum() * 24.0, rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"value": 4}, r"voxels\.value must be the number of at least one voxel, 0, 3, 7 \(got 4\)"),
        ({"spacing": (1.0, 0.0, 1.0)}, r"voxels\.spacing must be three positive, finite lengths"),
    ],
)
def test_voxels_refuse(changes, words):
    image = hold(labels=LABELS)
    with pytest.raises(ec.EigencontactError, match=words):
        ec.make("voxels", **({"file": image.name, "value": 7, "spacing": (1.0, 1.0, 1.0)} | changes))
