"""One inhomogeneity deep below the surface: Eshelby's eigenstrain, and the surface above it in closed form."""

from dataclasses import replace

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.core.tensors import to_mandel
from eigencontact.execution.blocks.increment import Increment
from eigencontact.execution.blocks.surface import Surface
from eigencontact.execution.interiors.polynomial_wholes import PolynomialWholes
from eigencontact.execution.routes.subsurface import Subsurface
from eigencontact.model.model import build_model
from eigencontact.scene.installed import installed_plugins
from eigencontact_verification.oracles.eshelby_sphere import isotropic_stiffness, sphere_in_body

E, NU, RADIUS, DEPTH, RATIO = 210e9, 0.3, 1e-6, 20e-6, 3.0
VOLUME = 4 / 3 * np.pi * RADIUS**3
PAIRS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
AT_REST = Increment(
    times=(0.0, 1.0), begin={}, control=None, tangential=None, surface=Surface(), progress=None,
)  # fmt: skip


def interior(tensor, body=1, **ball):
    """A stiff ball under this uniform stress; the half-space disturbs it by (radius / depth)^3."""

    class Loaded(PolynomialWholes):
        def applied(self, tractions):  # noqa: ARG002
            points = self.system.points
            return self.system.moments(np.repeat(tensor[:, None], points.shape[1], axis=1))

    steel = {"young_modulus": E, "poisson_ratio": NU}
    scene = ec.Scene(
        body1=steel,
        body2=steel,
        geometry={"type": "sphere", "radius": 1e-3},
        grid={"cells": 9, "size": [40e-6, 40e-6]},
        steps={"normal_load": 0.15},
        inclusions=[
            {"type": "sphere", "center": [0, 0, DEPTH], "radius": RADIUS, "body": body, **ball,
             "material": {"young_modulus": RATIO * E, "poisson_ratio": NU}}
        ],
        numerics={"inclusion_resolution": "whole", "tolerance": 1e-10, "threads": 1},
    )  # fmt: skip
    model = build_model(scene, installed_plugins())
    subsurface = Subsurface.of(model, body)
    assert subsurface.coords == {}
    block = Loaded(subsurface, "xyz")
    block.start()
    return block, model.grid


def mandel(tensor):
    return to_mandel([tensor[pair] for pair in PAIRS])


@pytest.mark.parametrize("prestrain", [None, 1e-3])
def test_the_eigenstrain_is_that_of_eshelby(prestrain):
    """Of any stress; that of the last increment is taken up by the next, and its work counted anew."""
    stress = np.array([[3.0, -1.0, 0.5], [-1.0, 2.0, 0.7], [0.5, 0.7, -4.0]]) * 1e8
    ball = {} if prestrain is None else {"eigenstrain": prestrain}
    block, _ = interior(mandel(stress), **ball)
    block.begin(AT_REST, {})
    np.testing.assert_array_equal(block.eigenstrain[:, 0, 0], [*[prestrain or 0.0] * 3, 0, 0, 0])
    block.image({}, 1e-10)
    own = None if prestrain is None else prestrain * np.eye(3)
    _, expected = sphere_in_body(isotropic_stiffness(RATIO * E, NU), E, NU, stress, own)
    np.testing.assert_allclose(block.eigenstrain[:, 0, 0], mandel(expected), rtol=0, atol=5e-4 * np.abs(expected).max())
    numbers = block.scalars()
    assert numbers["inclusion_iterations"] > 0
    assert numbers["inclusion_residual"] <= 1e-10
    stored = block.state_records()
    block.begin(replace(AT_REST, times=(1.0, 2.0)), stored)
    np.testing.assert_array_equal(block.eigenstrain, stored["equivalent_eigenstrain_1"].values)
    assert block.scalars()["inclusion_iterations"] == 0


@pytest.mark.parametrize("body", [1, 2])
def test_the_surface_above_a_ball_that_swells(body):
    """u = (1 + nu) V e / pi times (x, y, -z) / R^3, outwards; along x of body 2 less, along z of either inwards."""
    hydrostatic = 1e9 * np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    block, grid = interior(hydrostatic, body)
    block.begin(AT_REST, {})
    block.image({}, 1e-10)
    swelling = block.eigenstrain[:3, 0, 0].mean()
    moved = block.displacement("xz")
    y, x = grid.axes()
    strength = (1 + NU) * VOLUME * swelling / np.pi
    sign = 1 if body == 1 else -1
    expected = sign * strength * x / np.sqrt(x**2 + y**2 + DEPTH**2) ** 3
    np.testing.assert_allclose(moved["x"], expected, rtol=0, atol=5e-4 * expected.max())
    # Along z, where a traction acts, it is the mean over each cell.
    nodes, weights = 0.5 * np.polynomial.legendre.leggauss(4)[0], 0.5 * np.polynomial.legendre.leggauss(4)[1]
    u, v = x[..., None, None] + grid.dx * nodes, y[..., None, None] + grid.dy * nodes[:, None]
    expected = (-strength * DEPTH / np.sqrt(u**2 + v**2 + DEPTH**2) ** 3 * weights * weights[:, None]).sum((2, 3))
    np.testing.assert_allclose(moved["z"], expected, rtol=0, atol=5e-4 * np.abs(expected).max())
    assert block.displacement("z")["z"] == close(moved["z"], rel=1e-12)
