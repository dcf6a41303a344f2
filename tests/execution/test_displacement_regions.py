"""Displacement of the points of a region under a contact, against point loads and against other ways to the same."""

import numpy as np
import pytest

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from close import close

E, NU, R = 210e9, 0.3, 105e-6
BALL = {
    "body1": STEEL,
    "geometry": {"type": "sphere", "radius": R},
    "grid": {"cells": 31, "size": 16e-6},
    "steps": {"normal-load": 0.65},
}
POINTS = [[0.0, 0.0, 0.0], [0.0, 0.0, 9e-6], [4e-6, -3e-6, 12e-6], [30e-6, 5e-6, 10e-6]]


def region(**changes):
    return {"name": "deep", "shape": "points", "points": POINTS, "fields": ["displacement"], **changes}


def point_loads(data, at, shears=("shear_x", "shear_y"), nu=NU):
    """Boussinesq's and Cerruti's point loads (Johnson 1985, sections 3.2 and 3.6) in the middles of the cells."""
    y, x = np.meshgrid(data.y.values, data.x.values, indexing="ij")
    area = (data.x[1] - data.x[0]).item() * (data.y[1] - data.y[0]).item()
    G = E / (2 * (1 + nu))
    X, Y, z = at[0] - x, at[1] - y, at[2]
    d = np.sqrt(X**2 + Y**2 + z**2)
    P = area * data.pressure[-1].values / (4 * np.pi * G)
    u = np.array([
        np.sum(P * X * (z / d**3 - (1 - 2 * nu) / (d * (d + z)))),
        np.sum(P * Y * (z / d**3 - (1 - 2 * nu) / (d * (d + z)))),
        np.sum(P * (z**2 / d**3 + 2 * (1 - nu) / d)),
    ])  # fmt: skip
    if shears[0] in data:
        Q = area * data[shears[0]][-1].values / (4 * np.pi * G)
        w = 1 - 2 * nu
        u += [
            np.sum(Q * (1 / d + X**2 / d**3 + w * (1 / (d + z) - X**2 / (d * (d + z) ** 2)))),
            np.sum(Q * X * Y * (1 / d**3 - w / (d * (d + z) ** 2))),
            np.sum(Q * X * (z / d**3 + w / (d * (d + z)))),
        ]
    return u


def test_displacement_is_that_of_point_loads_and_meets_the_ball():
    result = ec.run(BALL | {"stress": region()})
    data = result.dataset
    found = data.deep_displacement[-1].transpose("deep_point", "axis").values
    assert data.deep_displacement.attrs["units"] == "m"
    scale = result.summary["approach"]
    assert found[0, 2] == close(scale, rel=1e-5)  # where the ball touches first, the surface follows it
    assert np.abs(found[0, :2]).max() < 1e-9 * scale
    for at, u in zip(POINTS[1:], found[1:], strict=True):
        assert np.abs(u - point_loads(data, at)).max() < 2e-3 * scale


def test_displacement_by_shear_and_of_both_bodies():
    """Body 2 is loaded by the opposite shear; along its own z axis, its displacement is that of body 1 so loaded."""
    scene = BALL | {
        "body2": STEEL,
        "friction": {"type": "coulomb", "coefficient": 0.5},
        "steps": {"normal-load": 0.65, "tangential-load-x": 0.2},
        "stress": [region(), region(name="upper", body=2)],
    }
    data = ec.run(scene).dataset
    scale = float(data.approach[-1])
    own, other = (data[f"{name}_displacement"][-1].transpose(..., "axis").values for name in ("deep", "upper"))
    for at, u, v in zip(POINTS[1:], own[1:], other[1:], strict=True):
        assert np.abs(u - point_loads(data, at)).max() < 2e-3 * scale
        opposite = data.assign(shear_x=-data.shear_x)
        assert np.abs(v - point_loads(opposite, at)).max() < 2e-3 * scale


@pytest.mark.parametrize("normal", ["y", "z"])
def test_planes_have_the_displacement_of_their_points(normal):
    plane = {"name": "plane", "shape": "plane", "normal": normal, "fields": ["stress", "displacement"]}
    plane |= {"depths": [0.0, 2e-6]} if normal == "y" else {"position": 2e-6}
    data = ec.run(BALL | {"stress": plane}).dataset
    x = data.plane_x.values[[3, 9]]
    points = [[float(a), 0.0 if normal == "y" else float(data.plane_y[4]), 2e-6] for a in x]
    on_points = ec.run(BALL | {"stress": region(points=points)}).dataset.deep_displacement[-1].values
    chosen = data.plane_displacement[-1].sel(plane_x=x)
    on_plane = chosen.sel(plane_z=2e-6) if normal == "y" else chosen.isel(plane_y=4)
    assert np.abs(on_plane.values - on_points).max() < 1e-9 * np.abs(on_points).max()


def test_layers_of_one_material_are_that_material():
    layered = {"type": "bonded-layers", "layers": [{"thickness": 3e-6, **STEEL}], "substrate": STEEL}
    one, other = (
        ec.run(BALL | {"body1": body, "stress": region()}).dataset.deep_displacement[-1].values
        for body in (STEEL, {"medium": layered})
    )
    assert np.abs(one - other).max() < 1e-5 * np.abs(one).max()
    stiff = {**layered, "layers": [{"thickness": 3e-6, "young-modulus": 2 * E, "poisson-ratio": NU}]}
    result = ec.run(BALL | {"body1": {"medium": stiff}, "stress": region()})
    assert result.dataset.deep_displacement[-1, 2, 0].item() == close(result.summary["approach"], rel=1e-5)
    assert result.summary["approach"] < 0.95 * one[2, 0]


def test_the_surface_of_a_periodic_window_follows_the_ball():
    """Its displacement is against its own mean, as the approach of a periodic scene is."""
    plane = {"name": "top", "shape": "plane", "normal": "z", "position": 0.0, "fields": ["displacement"]}
    data = ec.run(BALL | {"numerics": {"boundary": "periodic"}, "stress": plane}).dataset
    sinks = data.top_displacement[-1].sel(axis="z").values
    y, x = np.meshgrid(data.y, data.x, indexing="ij")
    touches = data.pressure[-1].values > 0
    followed = data.approach[-1].item() - (x**2 + y**2) / (2 * R)
    assert np.abs(sinks - followed)[touches].max() < 2e-5 * np.ptp(sinks)
    assert abs(sinks.mean()) < 1e-9 * np.ptp(sinks)
