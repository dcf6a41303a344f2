"""The ladder of grids and the growing box: a bed of springs in closed form, the same answer from any start."""

import numpy as np
import pytest
from scipy.optimize import brentq

from close import close
from eigencontact.core.grid import Box, Grid
from eigencontact.errors import DomainTooSmall, NotConverged, SceneError
from eigencontact.solvers.coarse_to_fine import margin, refuse_edge
from eigencontact.solvers.control import Control
from eigencontact.solvers.normal import NormalOptions, NormalSolver
from solvers.contacts import halfspace, paraboloid

GRID = Grid(nx=80, ny=70, dx=0.04, dy=0.04)
H = paraboloid(GRID, 1.0, 2.0)


class Bed:
    """Springs that give way each by itself, 2 m/Pa."""

    def table(self, x, y, half_widths):  # noqa: ARG002
        return np.where((x[None] == 0) & (y[:, None] == 0), 2.0, 0.0)


def solver(coefficients=None, **options):
    return NormalSolver(GRID, coefficients or halfspace(), NormalOptions(**({"tolerance": 1e-9} | options)))


def levels(solution):
    """Cells of the grids in the order in which they were solved on."""
    return list(dict.fromkeys(cells for cells, _ in solution.report.history))


@pytest.mark.parametrize("control", [{"approach": 0.3}, {"normal_load": 0.2}])
def test_a_bed_of_springs(control):
    """Pressure (approach - h) / k where positive; under a load the approach follows from their sum."""
    approach = control.get("approach") or brentq(
        lambda d: np.maximum(d - H, 0).sum() / 2.0 * GRID.cell_area - control["normal_load"], 0.0, 1.0, xtol=1e-14
    )
    solution = solver(Bed()).solve(H, Control(**control))
    assert solution.approach == close(approach, rel=1e-8)
    np.testing.assert_allclose(solution.pressure, np.maximum(approach - H, 0) / 2.0, rtol=0, atol=1e-8)
    np.testing.assert_allclose(solution.gap, np.maximum(H - approach, 0), rtol=0, atol=1e-8)


def test_grids_are_climbed_from_the_coarsest_and_a_start_skips_them():
    coarse = solver().solve(H, Control(normal_load=0.2))
    assert levels(coarse) == [20 * 17, 40 * 35, 80 * 70]
    again = solver().solve(H, Control(normal_load=0.2), start=coarse.pressure)
    assert levels(again) == [80 * 70]
    assert again.report.iterations < coarse.report.iterations
    np.testing.assert_allclose(again.pressure, coarse.pressure, rtol=0, atol=1e-7 * coarse.pressure.max())


@pytest.mark.parametrize("cell", [(35, 40), (3, 3)], ids=["in the middle", "in a corner"])
def test_the_box_grows_from_a_start_on_one_cell(cell):
    """Also from a cell that stays open in the end."""
    start = np.zeros(GRID.shape)
    start[cell] = 1.0
    expected = solver().solve(H, Control(normal_load=0.2))
    solution = solver().solve(H, Control(normal_load=0.2), start=start)
    assert solution.report.certificate.holds
    np.testing.assert_allclose(solution.pressure, expected.pressure, rtol=0, atol=1e-7 * expected.pressure.max())


@pytest.mark.parametrize(("control", "approach"), [({"normal_load": 0.0}, 0.5), ({"approach": 0.4}, 0.4)])
def test_without_contact_the_gap_is_that_of_rigid_bodies(control, approach):
    """Under no load the bodies just touch."""
    lifted = H - H.min() + 0.5
    solution = solver().solve(lifted, Control(**control))
    assert solution.approach == close(approach, rel=1e-14)
    assert not solution.pressure.any()
    np.testing.assert_allclose(solution.gap, lifted - approach, atol=1e-15)


def test_a_moment_without_contact_is_refused():
    with pytest.raises(SceneError, match="a moment must be carried by contact"):
        solver().solve(H + 1.0, Control(approach=0.5, moment_x=1e-3))


def test_too_few_iterations_are_told_with_the_report():
    with pytest.raises(NotConverged, match="did not converge in") as told:
        solver(max_iterations=2).solve(H, Control(normal_load=0.2))
    assert told.value.report.history


@pytest.mark.parametrize(("cell", "sides"), [((0, 3), ["y"]), ((3, 4), ["x"]), ((5, 4), ["x", "y"]), ((2, 2), [])])
def test_contact_at_the_edge_is_refused_by_its_sides(cell, sides):
    grid = Grid(nx=5, ny=6, dx=1.0, dy=1.0)
    pressure = np.zeros(grid.shape)
    pressure[cell] = 1.0
    if not sides:
        return refuse_edge(pressure, grid)
    with pytest.raises(DomainTooSmall, match=f"along {' and '.join(sides)};"):
        return refuse_edge(pressure, grid)


def test_the_margin_is_two_cells_or_a_128th():
    assert margin(Box(0, 10, 0, 1000)) == (2, 8)
