"""What `eigencontact.plugin` lends to authors: bases of geometries and fields, rotations, potentials of points."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from scipy.spatial.transform import Rotation as Reference

import eigencontact as ec
from close import close
from eigencontact.plugin import (
    HasPotentials,
    HasReferencePressure,
    InclusionShape,
    Length,
    Place,
    PointKernels,
    Revolution,
    Rotation,
    SceneError,
    Strain,
    TimedField,
    as_tuple,
    mandel_strain,
    rotation_matrix,
    turned_derivatives,
)
from eigencontact.plugin.revolution import RevolutionSum


@dataclass(frozen=True, kw_only=True)
class Quartic(Revolution):
    """h = r⁴ / c³, so that the approach of a contact radius t is (8/3) t⁴ / c³."""

    key: ClassVar[str] = "quartic"
    scale: Length
    center: tuple[Length, Length] = (0.0, 0.0)

    def height(self, r):
        return r**4 / self.scale**3

    def rate(self, t):
        return 32 / 3 * t**3 / self.scale**3


def test_coaxial_geometries_of_revolution_add_up():
    x, y = np.array([0.5, 0.9]), np.array([-0.5, -0.2])
    parts = [Quartic(scale=2.0, center=(0.5, -0.5)), Quartic(scale=3.0, center=(0.5, -0.5))]
    together = RevolutionSum.of(parts)
    equal = Quartic(scale=(1 / 8 + 1 / 27) ** (-1 / 3), center=(0.5, -0.5))
    assert together.separation(x, y) == close(equal.separation(x, y), rel=1e-14)
    assert together.reference_pressure(x, y, 2.0, 3.0) == close(equal.reference_pressure(x, y, 2.0, 3.0), rel=1e-12)
    assert RevolutionSum.of([*parts, Quartic(scale=1.0)]) is None


def test_a_geometry_of_revolution_is_a_profile_and_its_approach():
    shape = Quartic(scale=2.0, center=(0.5, -0.5))
    assert isinstance(shape, HasReferencePressure)
    x, y = np.array([[0.5, 1.5]]), np.array([[-0.5], [0.5]])
    assert shape.separation(x, y) == close(np.array([[0, 1], [1, 4]]) / 8.0, rel=1e-14)
    radius = 0.7  # of the contact under P = 2 E* (32/15) a⁵/c³
    load = 2 * 3.0 * 32 / 15 * radius**5 / 8
    r = 0.7 * np.sqrt(1 - ((np.arange(400) + 0.5) / 400) ** 2)  # midpoints in √(1 - r²/a²)
    p = shape.reference_pressure(0.5 + r, np.full(400, -0.5), load, 3.0)
    height = np.sqrt(1 - (r / radius) ** 2)
    assert 2 * np.pi * radius**2 * np.mean(p * height) == close(load, rel=1e-5)
    assert p == close(3.0 / np.pi * 32 / 3 / 8 * (radius**2 - r**2) ** 0.5 * (radius**2 + 2 * r**2) / 3, rel=1e-9)
    assert shape.reference_pressure(x + 9.0, y, load, 3.0).tolist() == [[0, 0], [0, 0]]
    assert not shape.reference_pressure(x, y, 0.0, 3.0).any()


@dataclass(frozen=True, kw_only=True)
class Swelling(TimedField):
    """A strain that fades with depth."""

    key: ClassVar[str] = "swelling"
    value: Strain
    depth: Length

    def at(self, x, y, z):  # noqa: ARG002
        return mandel_strain(self.key, "value", self.value)[:, None] * np.exp(-z / self.depth)


def test_a_field_with_a_history_is_its_value_in_space():
    field = Swelling(value=(1e-3, 2e-3, 0.0), depth=2.0, times=(1.0, 3.0), factors=(0.0, 1.0))
    z = np.array([0.0, 2.0])
    assert field.varies
    assert field.eigenstrain(0 * z, 0 * z, z, 2.0) == close(
        0.5 * np.outer([1e-3, 2e-3, 0, 0, 0, 0], [1, np.exp(-1)]), rel=1e-14
    )
    with pytest.raises(SceneError, match=r"swelling.factors must be 1 finite numbers"):
        Swelling(value=1.0, depth=1.0, times=(1.0,))


@dataclass(frozen=True, kw_only=True)
class Dumbbell(InclusionShape):
    """Two small balls on a turned bar: points to its own potentials."""

    key: ClassVar[str] = "dumbbell"
    middle: Place
    length: Length
    radius: Length
    rotation: Rotation | None = None

    def __post_init__(self):
        object.__setattr__(self, "rotation", as_tuple(self.rotation))

    @property
    def ends(self):
        arm = 0.5 * self.length * rotation_matrix(self.key, self.rotation)[:, 0]
        return [np.array(self.middle) + sign * arm for sign in (-1, 1)]

    @property
    def bounds(self):
        ends = np.array(self.ends)
        return tuple((ends.min(axis=0) - self.radius).tolist()), tuple((ends.max(axis=0) + self.radius).tolist())

    def contains(self, x, y, z):
        return sum((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2 <= self.radius**2 for a, b, c in self.ends) > 0

    def _sum(self, orders, x, y, z, spread, name):
        out = np.zeros((len(orders), *np.shape(x)))
        for a, b, c in self.ends:
            point = PointKernels(x - a, y - b, z - c)
            for row, order in enumerate(orders):
                out[row] += point.derivative(name, order) + (spread * point.derivative("phi", order) if spread else 0.0)
        return 4 / 3 * np.pi * self.radius**3 * out

    def phi(self, orders, x, y, z):
        return self._sum(orders, x, y, z, 0.0, "phi")

    def psi(self, orders, x, y, z):
        return self._sum(orders, x, y, z, self.radius**2 / 5, "psi")


def test_points_and_rotations_make_a_shape_of_their_own():
    """Outside, two balls are two points with a spread: the field is that of two bundled spheres."""
    shape = Dumbbell(middle=(0.1, 0.2, 2.0), length=2.0, radius=0.3, rotation=(0.4, 0.5, 0.0))
    assert isinstance(shape, HasPotentials)
    spheres = [ec.make("sphere", center=tuple(end.tolist()), radius=0.3) for end in shape.ends]
    at, strain = np.array([(0, 0, 0), (1.5, 0.2, 0.3), (0.1, 0.2, 2.0)]), np.diag([1e-3, -2e-3, 5e-4])
    given = {"young_modulus": 1.0, "poisson_ratio": 0.3, "quantity": "stress"}
    found, expected = (ec.inclusion_field(item, strain, at, **given) for item in (shape, spheres))
    assert np.abs(found - expected).max() < 1e-10 * np.abs(expected).max()
    assert hash(Dumbbell(middle=(0, 0, 1), length=1.0, radius=0.1, rotation=np.eye(3)))


@pytest.mark.parametrize("angles", [(0.3, 0.0, 0.0), (0.0, 0.5, 0.0), (0.0, 0.0, 0.7), (0.3, -0.5, 2.0)])
def test_rotations_are_yaw_pitch_and_roll(angles):
    expected = Reference.from_euler("ZYX", angles).as_matrix()
    assert rotation_matrix("x", angles) == close(expected, abs=1e-15)
    assert rotation_matrix("x", expected) == close(expected, abs=1e-15)
    own, matrix = turned_derivatives(expected, [(1, 0, 0), (0, 1, 1)])
    gradient = matrix[0, [own.index(order) for order in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]]
    assert gradient == close(expected[0], abs=1e-15)
    assert matrix[1, own.index((1, 1, 0))] == close(
        expected[1, 0] * expected[2, 1] + expected[1, 1] * expected[2, 0], abs=1e-15
    )
