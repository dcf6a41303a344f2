"""The observer of the surface that eigenstrain leaves."""

import numpy as np
import pytest

from close import close
from eigencontact.core.grid import Grid
from eigencontact.errors import SceneError
from eigencontact.plugin import StepView
from eigencontact_plugins.observers.roughness import Roughness


def view(**fields):
    return StepView(
        index=1, grid=Grid(nx=32, ny=16, dx=1e-6, dy=1e-6), fields=fields, scalars={}, regions={}, history={}
    )


def test_heights_of_a_wave():
    """A cosine of amplitude A over whole periods: sa = 2A/pi, sq = A/sqrt 2, and its mean is the uplift."""
    grid = view().grid
    y, x = grid.axes()
    u_z = 3e-9 - 5e-9 * np.cos(2 * np.pi * x / 32e-6) + 0 * y
    found = Roughness().observe(view(residual_displacement_z=u_z))
    assert found["mean"] == close(-3e-9, rel=1e-9)
    assert found["sa"] == close(2 / np.pi * 5e-9, rel=5e-3)
    assert found["sq"] == close(5e-9 / np.sqrt(2), rel=1e-9)
    assert found["sz"] == close(2 * 5e-9 * np.cos(np.pi / 32), rel=1e-9)


def test_only_the_rectangle_counts():
    u_z = np.zeros((16, 32))
    u_z[0, 0] = 1e-6
    found = Roughness(start=(-4e-6, -4e-6), end=(4e-6, 4e-6)).observe(view(residual_displacement_z=u_z))
    assert set(found.values()) == {0.0}
    assert set(found) == set(Roughness().units)


def test_refusals():
    with pytest.raises(SceneError, match="start must be given together with end"):
        Roughness(start=(0.0, 0.0))
    with pytest.raises(SceneError, match="end must be beyond start"):
        Roughness(start=(0.0, 0.0), end=(1e-6, 0.0))
    with pytest.raises(SceneError, match="a body with eigenstrain or one that yields"):
        Roughness().observe(view())
    with pytest.raises(SceneError, match="must contain cells of the window"):
        Roughness(start=(1.0, 1.0), end=(2.0, 2.0)).observe(view(residual_displacement_z=np.zeros((16, 32))))
