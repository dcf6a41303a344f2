"""Model contacts with friction that the solver tests share: a sphere of radius 1 that touches a disk of radius 1."""

import numpy as np

from eigencontact.core.grid import Grid
from eigencontact.core.material import Material, contact_modulus
from eigencontact.model.kernels import PairCoefficients
from eigencontact.solvers.control import Control
from eigencontact.solvers.normal import NormalOptions
from eigencontact.solvers.tangential.contact import FrictionalContact
from eigencontact.solvers.tangential.control import TangentialControl
from eigencontact.solvers.tangential.solver import TangentialOptions
from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY

LOADS = {"x": ShearLoadX(), "y": ShearLoadY(), "z": PressureLoad()}
PAIRS = {
    "none": ("xx", "yy", "zz"),
    "partial": ("xx", "yy", "zz", "xy", "yx"),
    "one-way": ("xx", "yy", "zz", "xy", "yx", "xz", "yz"),
    "full": ("xx", "yy", "zz", "xy", "yx", "xz", "yz", "zx", "zy"),
}


def elastic(nu=0.3):
    """Body of unit contact modulus against a rigid one."""
    return Material(young_modulus=1.0 - nu**2, poisson_ratio=nu)


def shear_compliance(*bodies):
    """C = Σ (2-ν)/G."""
    return sum(2 * (2 - body.poisson_ratio) * (1 + body.poisson_ratio) / body.young_modulus for body in bodies if body)


def coefficients(bodies, coupling="full", along="xy"):
    """Influence coefficients between the directions that take part."""
    return {
        (i, j): PairCoefficients(LOADS[j], bodies, i)
        for i, j in PAIRS[coupling]
        if i in along + "z" and j in along + "z"
    }


def square(n, size=2.6, centre=(0.0, 0.0)):
    return Grid(nx=n, ny=n, dx=size / n, dy=size / n, center=centre)


class Sphere:
    """A sphere on a plane, P = 4/3 E* R² for a = R = 1, with Coulomb friction, step by step."""

    def __init__(
        self, n=64, *, nu=0.3, other=None, friction=0.5, coupling="none", along="xy", size=2.6, centre=(0.0, 0.0),
        tolerance=1e-8, separation=None, grid=None, bodies=None,
    ):  # fmt: skip
        self.bodies = bodies or (elastic(nu), other)
        self.grid, self.friction = grid or square(n, size, centre), friction
        y, x = self.grid.axes()
        self.separation = 0.5 * (x * x + y * y) if separation is None else separation
        self.modulus = contact_modulus(*self.bodies)
        self.load = 4 / 3 * self.modulus
        self.pressure = 2 / np.pi * self.modulus
        self.compliance = shear_compliance(*self.bodies)
        self.contact = FrictionalContact(
            self.grid, coefficients(self.bodies, coupling, along), lambda p, _: friction * p,
            NormalOptions(tolerance=tolerance, threads=1), TangentialOptions(tolerance=tolerance, threads=1),
        )  # fmt: skip
        self.sliding, self.last = None, None

    def to(self, load=1.0, *, approach=None, **tangential):
        """Go to a load over that of a = 1 (or an approach) and to tangential loads or displacements."""
        control = Control(approach=approach) if approach is not None else Control(normal_load=load * self.load)
        self.last = self.contact.step(self.separation, control, TangentialControl(**tangential), self.sliding)
        self.sliding = self.last.sliding
        return self.last

    @property
    def radii(self):
        """Distance of the cells from the axis."""
        y, x = self.grid.axes()
        return np.hypot(x, y)

    def stick_ratio(self):
        """Area-equivalent stick radius over that of the loaded cells."""
        tangential = self.last.tangential
        return float(np.sqrt(tangential.stick.sum() / np.count_nonzero(self.last.normal.pressure)))

    def forces(self):
        return self.last.tangential.forces
