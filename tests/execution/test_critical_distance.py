"""Values near a hot spot against closed forms: a line, a half ball, a ball cut by the surface."""

import numpy as np
import pytest

from eigencontact.errors import SceneError
from eigencontact.execution.fields.critical_distance import mean_of_ball, value_near
from eigencontact.execution.fields.stress_cycle import CycleOfRegion
from eigencontact.plugin import StressCycle


def grid(cells, size=2.0):
    """Depths 0 to `size`, and places about the middle."""
    return np.linspace(0.0, size, cells + 1), np.linspace(-size, size, 2 * cells + 1)


@pytest.mark.parametrize("depth", [0.0, 0.3, 0.5, 0.9, 1.1])
def test_centroid_of_the_part_of_a_ball_in_the_body(depth):
    """Linear values: exact; z of the part below the surface, 3 (R - d)^2 / (4 (2 R - d)) below the centre for d < R."""
    z, line = grid(10)
    field = np.broadcast_to(z[:, None, None] + 0.25 * line, (11, 21, 21))
    radius = 0.8
    below = 0.75 * (radius - depth) ** 2 / (2 * radius - depth) if depth < radius else 0.0
    mean = mean_of_ball([z, line, line], field, np.array([depth, 0.2, 0.4]), radius)
    assert abs(mean - (depth + below + 0.1)) < 1e-12


def test_second_order_with_the_distance_of_points():
    """Mean of r^2 over a half ball is 3/5 R^2; linear interpolation misses it by the square of the pitch."""
    errors = []
    for cells in (10, 20, 40):
        z, line = grid(cells)
        field = z[:, None, None] ** 2 + line[:, None] ** 2 + line**2
        errors.append(mean_of_ball([z, line, line], field, np.zeros(3), 1.0) - 0.6)
    rates = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(np.abs(rates - 2.0) < 0.3)
    assert 0 < errors[-1] < 2e-3


def region(dims, *axes):
    """Region of points with these axes; its stress plays no role."""
    places = np.zeros((3, *(axis.size for axis in axes)))
    for name, values in zip(dims, np.meshgrid(*axes, indexing="ij"), strict=True):
        places["xyz".index(name)] = values
    shape = places.shape[1:]
    return CycleOfRegion(
        region="r", body=1, dims=tuple(f"r_{name}" for name in dims), shape=shape, places=places.reshape(3, -1),
        steps=(1, 2), at=StressCycle(stress=np.zeros((2, 6, places[0].size))).at,
    )  # fmt: skip


def test_point_and_line():
    """exp(-z): the value at L/2, and the mean down to 2 L."""
    z, line = np.linspace(0.0, 2.0, 401), np.linspace(-1.0, 1.0, 5)
    value = (np.exp(-z)[:, None] * np.exp(-(line**2))).ravel()
    section = region("zx", z, line)
    assert abs(value_near(section, value, 0.5, "point") - np.exp(-0.25)) < 1e-5
    assert abs(value_near(section, value, 0.5, "line") - (1 - np.exp(-1.0))) < 1e-5


def test_what_a_region_does_not_hold_is_refused():
    z, line = grid(10)
    value = np.zeros((11, 21, 21))
    value[0, 10, 19] = 1.0
    with pytest.raises(SceneError, match="must be such that region 'r' holds the ball"):
        value_near(region("zyx", z, line, line), value.ravel(), 0.5, "volume")
    with pytest.raises(SceneError, match="holds 3 m below the hot spot"):
        value_near(region("zx", z, line), value[:, 10].ravel(), 1.5, "line")
    with pytest.raises(SceneError, match="no volume"):
        value_near(region("zx", z, line), value[:, 10].ravel(), 0.5, "volume")
    with pytest.raises(SceneError, match="which has no depths"):
        value_near(region("yx", line, line), value[0].ravel(), 0.5, "point")
