"""Tables of influence coefficients grow as they are asked for, and are handed out in the size asked for."""

import numpy as np
import pytest

from eigencontact.core.grid import Box, Grid
from eigencontact.solvers.operator import Compliance
from eigencontact.solvers.solution import SolverOptions
from eigencontact.solvers.tangential.compliance import MatrixOperator
from solvers.contacts import halfspace, paraboloid, solve

GRID = Grid(nx=12, ny=12, dx=1.0, dy=1.0)
BOXES = [Box(0, 10, 0, 3), Box(0, 3, 0, 10), Box(2, 7, 2, 7)]


@pytest.mark.parametrize(("first", "second"), [((9, 3), (3, 9)), ((3, 9), (9, 3)), ((8, 8), (2, 9))])
def test_a_table_has_the_size_asked_for_whatever_was_asked_before(first, second):
    compliance = Compliance(GRID, halfspace(), SolverOptions(threads=1))
    whole = Compliance(GRID, halfspace(), SolverOptions(threads=1)).table(12, 12)
    for shape in (first, second):
        np.testing.assert_array_equal(compliance.table(*shape), whole[: shape[0], : shape[1]])


@pytest.mark.parametrize("order", [(0, 1, 2), (1, 0, 2), (2, 1, 0)])
def test_shear_operators_of_boxes_do_not_depend_on_their_order(order):
    def operator():
        return MatrixOperator(GRID, {("x", "x"): halfspace()}, "x", "x", SolverOptions(threads=1))

    used = operator()
    for number in order:
        box = BOXES[number]
        traction = np.ones((1, *box.shape))
        np.testing.assert_allclose(used.apply(traction, box, box), operator().apply(traction, box, box), rtol=1e-13)


def test_slender_contact_after_another_one_of_other_proportions():
    """A start along x, an answer along y: the table grows in one direction only."""
    grid = Grid(nx=64, ny=64, dx=0.05, dy=0.05)
    along = solve(grid, paraboloid(grid, 8.0, 0.3), normal_load=0.1, tolerance=1e-6)
    across = solve(grid, paraboloid(grid, 0.3, 8.0), normal_load=0.1, tolerance=1e-6, start=along.pressure)
    np.testing.assert_allclose(across.pressure, along.pressure.T, atol=1e-5 * along.pressure.max())
