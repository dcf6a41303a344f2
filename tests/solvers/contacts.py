"""Model contacts that the solver tests share."""

import numpy as np

from eigencontact.core.grid import Grid
from eigencontact.core.material import Material
from eigencontact.model.kernels import PairCoefficients
from eigencontact.solvers.control import Control
from eigencontact.solvers.normal import NormalOptions, NormalSolver
from eigencontact_plugins.surface_loads import PressureLoad

STEEL = Material(young_modulus=210e9, poisson_ratio=0.3)
#: Unit contact modulus against a rigid body.
UNIT = Material(young_modulus=1.0 - 0.3**2, poisson_ratio=0.3)


def halfspace(body=UNIT, other=None):
    """Influence coefficients of two bodies; None is rigid."""
    return PairCoefficients(PressureLoad(), (body, other), "z")


def paraboloid(grid, radius_x=1.0, radius_y=None):
    y, x = grid.axes()
    return x**2 / (2 * radius_x) + y**2 / (2 * (radius_y or radius_x))


def rounded_punch(grid, flat=0.5, radius=1.0):
    """Flat disk whose rim turns up as a paraboloid: (r - flat)²/(2 radius) outside."""
    y, x = grid.axes()
    return np.maximum(0.0, np.hypot(x, y) - flat) ** 2 / (2 * radius)


def solve(grid, separation, coefficients=None, *, start=None, tolerance=1e-9, options=None, **control):
    """Solve with the control given by name."""
    chosen = NormalOptions(tolerance=tolerance, **(options or {}))
    return NormalSolver(grid, coefficients or halfspace(), chosen).solve(separation, Control(**control), start=start)


def square_grid(cells, half_width=1.3, offset=(0.0, 0.0)):
    """Square cells, `cells` per unit length, the window moved by a fraction of a cell."""
    n = 2 * round(half_width * cells)
    return Grid(nx=n, ny=n, dx=1.0 / cells, dy=1.0 / cells, center=(offset[0] / cells, offset[1] / cells))
