"""Stress regions around an inclusion against sums over all cells at the same points, and against coarser regions."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL
from close import close
from eigencontact.errors import SceneError

UM = 1e-6
BALL = {
    "name": "ball",
    "type": "sphere",
    "center": [0.5 * UM, 0.0, 2.5 * UM],
    "radius": 1.3 * UM,
    "material": {"young-modulus": 420e9, "poisson-ratio": 0.3},
}
#: Prescribed: with a closed form, and cut into cells whose height is not that of the ball's.
SWOLLEN = {"name": "swollen", "type": "sphere", "center": [-4 * UM, 0.0, 2 * UM], "radius": UM, "eigenstrain": 2e-3}
WARM = {
    "name": "warm", "type": "cylinder", "center": [3.5 * UM, 0.0, 4 * UM], "radius": UM, "length": 2 * UM, "axis": "z",
    "eigenstrain": 1e-3,
}  # fmt: skip
CONTACT = {
    "geometry": {"type": "sphere", "radius": 105 * UM},
    "steps": {"normal-load": 0.3},
    "grid": {"cells": [24, 20], "spacing": [0.6 * UM, 0.6 * UM]},
    "output": {"pictures": False},
}


def run(*regions, inclusions=(BALL,), **changes):
    return ec.run(
        {"body1": STEEL, "inclusions": list(inclusions), **CONTACT, "stress": list(regions), **changes}
    ).dataset


def stress_at(data, name):
    """Stress ``(6, n)`` of a region, and its points ``(n, 3)``."""
    stress = data[f"{name}_stress"].isel(step=-1)
    axes = [np.atleast_1d(data[f"{name}_{axis}"].values) for axis in "zyx"]
    z, y, x = np.meshgrid(*axes, indexing="ij")
    return stress.values.reshape(6, -1), np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)


@pytest.mark.parametrize(
    ("region", "inclusions"),
    [
        ({"shape": "plane", "normal": "y", "refinement": 4, "room": 0.0}, (BALL,)),
        pytest.param(
            {"shape": "plane", "normal": "z", "refinement": 3, "position": 1.1 * UM, "room": 0.1},
            (BALL, SWOLLEN, WARM),
            marks=pytest.mark.slow,
        ),
        pytest.param({"shape": "volume", "refinement": 2, "room": 0.0}, (BALL,), marks=pytest.mark.slow),
    ],
    ids=["section", "level, with prescribed eigenstrain", "volume"],
)
def test_against_the_same_points_one_by_one(region, inclusions):
    wanted = {"name": "close", "around": "ball", **region}
    stress, points = stress_at(run(wanted, inclusions=inclusions), "close")
    some = np.linspace(0, len(points) - 1, 5).astype(int)
    listed = {"name": "listed", "shape": "points", "points": points[some].tolist()}
    expected = run(listed, inclusions=inclusions)["listed_stress"].isel(step=-1).values
    np.testing.assert_allclose(stress[:, some], expected, rtol=0, atol=2e-6 * np.abs(expected).max())


def test_agrees_with_the_region_on_the_cells_at_common_points():
    coarse = {"name": "coarse", "shape": "plane", "normal": "y", "position": 0.1 * UM, "depths": [2.1 * UM, 2.7 * UM]}
    wanted = {
        "name": "close", "shape": "plane", "normal": "y", "position": 0.1 * UM, "around": "ball", "refinement": 3,
        "room": 0.2,
    }  # fmt: skip
    data = run(coarse, wanted, numerics={"inclusion-pitch": 0.6 * UM})
    fine = data.close_von_mises.isel(step=-1)
    common = [x for x in data.coarse_x.values if np.abs(data.close_x.values - x).min() < 1e-12]
    assert len(common) >= 5
    picked = fine.sel(close_x=common, close_z=data.coarse_z.values, method="nearest").values
    expected = data.coarse_von_mises.isel(step=-1).sel(coarse_x=common, method="nearest").values
    np.testing.assert_allclose(picked, expected, rtol=2e-6)
    assert float(np.diff(data.close_x).max()) == close(0.2 * UM)
    assert float(np.diff(data.close_z).max()) == close(0.2 * UM)


@pytest.mark.slow
def test_default_plane_and_outline():
    small = {**BALL, "center": [0.5 * UM, 0.0, 1.3 * UM], "radius": 0.65 * UM}
    data = run({"name": "close", "shape": "plane", "around": "ball"}, inclusions=[small])
    assert float(data.close_y) == 0.0
    low, high = float(data.close_x[0]), float(data.close_x[-1])
    pitch = 0.6 * UM / 8
    assert low == close((0.5 - 1.3) * UM, abs=pitch)
    assert high == close((0.5 + 1.3) * UM, abs=pitch)
    assert 0 < float(data.close_z[0]) < 0.6 * UM
    assert "close_outline" in data
    assert np.isfinite(data.close_von_mises).all()


def test_window_of_a_plane_without_an_inclusion():
    """Limits alone: with and without contact, refined or not."""
    limits = {"shape": "plane", "normal": "z", "position": UM, "start": [-2 * UM, -UM, 0], "end": [2 * UM, UM, 0]}
    data = run({"name": "fine", **limits, "refinement": 3}, {"name": "plain", **limits})
    assert float(data.fine_x.min()) >= -2 * UM
    assert float(data.fine_x.max()) <= 2 * UM
    both = data.fine_stress.isel(step=-1).sel(fine_x=data.plain_x.values, fine_y=data.plain_y.values, method="nearest")
    expected = data.plain_stress.isel(step=-1).values
    np.testing.assert_allclose(both.values, expected, rtol=0, atol=2e-6 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("region", "message"),
    [
        ({"around": "bal"}, r"around an inclusion of body1 \(got 'bal'\); there are 'ball'; did you mean 'ball'"),
        ({"around": "ball", "position": 9e-6}, r"must cut the box around 'ball'"),
        ({"around": "ball", "depth-max": 1e-6}, "given around alone: leave out depth-max"),
        ({"around": "ball", "shape": "line"}, "a plane or volume with around"),
        ({"around": "ball", "shape": "volume", "refinement": 200}, "must have at most 4000000 points"),
    ],
)  # fmt: skip
def test_refused(region, message):
    with pytest.raises(SceneError, match=message):
        run({"name": "close", "shape": "plane", **region})


def test_refused_without_inclusions_and_in_a_periodic_space():
    plane = {"name": "close", "shape": "plane", "around": "ball"}
    with pytest.raises(SceneError, match="in a scene without any"):
        ec.run({"body1": STEEL, **CONTACT, "stress": [plane]})
    swollen = [{**SWOLLEN, "name": "ball"}]
    with pytest.raises(SceneError, match="half-space = 'exact' or 'full-space' for regions finer than cells"):
        run(plane, inclusions=swollen, numerics={"half-space": "image-pressure"})
