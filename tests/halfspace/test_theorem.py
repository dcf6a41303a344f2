"""The half-space theorem as linear forms: counts of kernels, the volume strain, the incompressible limit."""

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.halfspace.forms import Form, reduced
from eigencontact.halfspace.points import field_at_points
from eigencontact.halfspace.theorem import response

RNG = np.random.default_rng(3)
KERNELS = {"stress": 58, "strain": 58, "displacement": 57}


@pytest.mark.parametrize("quantity", KERNELS)
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_grids_need_few_kernels(quantity, nu):
    forms = [form.replaced(reduced) for row in response(quantity, nu, "half") for form in row]
    kernels = {kernel for form in forms for _, kernel, _ in form if kernel[0] != "inside"}
    assert len(kernels) <= KERNELS[quantity]
    assert {power for form in forms for power, _, _ in form} == {0, 1, 2}
    full = [form.replaced(reduced) for row in response(quantity, nu, "full") for form in row]
    assert len({k for form in full for _, k, _ in form if k[0] != "inside"}) == (
        10 if quantity == "displacement" else 15
    )


def test_surface_displacement_needs_no_power_of_depth():
    forms = [form.on_surface().replaced(reduced) for row in response("displacement", 0.3, "half") for form in row]
    assert {(power, kernel[0]) for form in forms for power, kernel, _ in form} == {(0, "image")}


def test_forms_differentiate_products_with_depth():
    form = Form.potential("image", "phi").d(0).times_z(2).d(2)
    assert dict(form.terms) == {(1, ("image", "phi", (1, 0, 0))): 2.0, (2, ("image", "phi", (1, 0, 1))): 1.0}


def _points(n=60):
    points = RNG.normal(size=(3, n)) * 2
    points[2] = np.abs(points[2])
    points[2, :10] = 0.0
    return tuple(points)


SHAPES = {
    "flush cuboid": ("cuboid", {"center": (0.1, -0.2, 0.5), "edges": (1.0, 2.0, 1.0)}),
    "buried cuboid": ("cuboid", {"center": (0.0, 0.0, 2.0), "edges": (1.0, 0.3, 0.8)}),
    "sphere": ("sphere", {"center": (0.0, 0.3, 1.2), "radius": 1.0}),
    "ellipsoid": ("ellipsoid", {"center": (0.0, 0.3, 1.2), "semi_axes": (1.0, 0.6, 0.4)}),
}


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("space", ["half", "full"])
def test_stress_is_hooke_of_strain(name, space):
    """The volume strain that stress takes in closed form is that of the strain, and Hooke's law holds inside too."""
    key, parameters = SHAPES[name]
    shape, points, nu = ec.make(key, **parameters), _points(), 0.3
    if space == "full":  # where a face in z = 0 is like any other and takes the mean, which `contains` cannot say
        points = (*points[:2], points[2] + 0.01)
    inside = shape.contains(*points)
    for m in range(6):
        e = np.eye(6)[m]
        strain = field_at_points(shape, e, points, poisson_ratio=nu, quantity="strain", space=space)
        stress = field_at_points(shape, e, points, poisson_ratio=nu, quantity="stress", space=space)
        elastic = strain - e[:, None] * inside
        expected = 2.0 * elastic
        expected[:3] += 2.0 * nu / (1.0 - 2.0 * nu) * elastic[:3].sum(axis=0)
        assert np.abs(stress - expected).max() < 2e-13 * np.abs(stress).max()


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49, 0.4999999, 0.5])
def test_the_surface_is_free_of_traction(name, nu):
    key, parameters = SHAPES[name]
    shape = ec.make(key, **parameters)
    x, y, z = _points(200)
    for m in range(6):
        given = {"poisson_ratio": nu, "quantity": "stress"}
        everywhere = field_at_points(shape, np.eye(6)[m], (x, y, z), **given)
        surface = field_at_points(shape, np.eye(6)[m], (x, y, 0.0 * z), **given)
        assert np.abs(surface[2:5]).max() < 1e-12 * np.abs(everywhere).max()


@pytest.mark.parametrize("name", SHAPES)
def test_the_incompressible_limit_is_smooth(name):
    key, parameters = SHAPES[name]
    shape, points, e = ec.make(key, **parameters), _points(), np.array([1.0, 0.4, 0.7, 0.2, -0.3, 0.5])
    for quantity in ("displacement", "strain", "stress"):
        near, at = (field_at_points(shape, e, points, poisson_ratio=nu, quantity=quantity) for nu in (0.5 - 1e-9, 0.5))
        assert 1e-12 < np.abs(near - at).max() / np.abs(at).max() < 1e-7
