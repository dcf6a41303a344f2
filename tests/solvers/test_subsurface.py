"""Stress below the surface: the lattice operator, the sum at points, quadrature, plane waves, and Hertz."""

import numpy as np
import pytest

from close import close
from eigencontact.core.grid import Box, Grid
from eigencontact.core.material import Material
from eigencontact.core.tensors import COMPONENTS, from_mandel, von_mises
from eigencontact.model.kernels import StressCoefficients
from eigencontact.solvers.subsurface import SubsurfaceStress, stress_at_points
from eigencontact_plugins.surface_loads import PressureLoad, ShearLoadX, ShearLoadY
from eigencontact_verification.oracles import hertz
from eigencontact_verification.oracles.boussinesq import rectangle
from solvers.contacts import paraboloid, solve, square_grid

LOADS = (PressureLoad(), ShearLoadX(), ShearLoadY())


def stress_kernels(nu=0.3, loads=LOADS):
    body = Material(young_modulus=2.0 * (1 + nu), poisson_ratio=nu)
    return [StressCoefficients(load, body) for load in loads]


def tractions(grid, seed=0, box=None, count=3):
    """Random tractions, zero outside the box."""
    out = np.zeros((count, *grid.shape))
    box = box or Box(0, grid.ny, 0, grid.nx)
    out[(slice(None), *box.slices)] = np.random.default_rng(seed).standard_normal((count, *box.shape))
    return list(out)


def lattice_points(grid, target, origin, depths):
    """Points (x, y, z) of a lattice, in its order (z, y, x)."""
    x = grid.x[0] + (origin[1] + np.arange(target[1])) * grid.dx
    y = grid.y[0] + (origin[0] + np.arange(target[0])) * grid.dy
    z, y, x = np.meshgrid(depths, y, x, indexing="ij")
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)


# grid (ny, nx, dy, dx), loaded box, target, origin in cells
CASES = {
    "window": ((8, 10, 1.0, 1.0), None, (8, 10), (0.0, 0.0)),
    "one cell": ((1, 1, 1.0, 2.0), None, (1, 1), (0.0, 0.0)),
    "prime, slender cells": ((7, 11, 1.0, 0.05), Box(2, 6, 1, 8), (7, 11), (0.0, 0.0)),
    "plane between cells": ((8, 10, 1.0, 0.7), Box(1, 7, 2, 9), (1, 10), (3.5, 0.0)),
    "plane across, between cells": ((8, 10, 1.0, 0.7), Box(1, 7, 2, 9), (8, 1), (0.0, 4.5)),
    "any fraction": ((5, 6, 0.3, 0.4), Box(0, 2, 1, 6), (3, 4), (-0.2, 1.3)),
    "beside the window": ((6, 6, 1.0, 1.0), Box(2, 4, 2, 4), (3, 2), (-9.0, 14.0)),
}


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.499999, 0.5])
@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_lattice_equals_the_sum_at_points(case, nu):
    (ny, nx, dy, dx), box, target, origin = case
    grid = Grid(ny=ny, nx=nx, dy=dy, dx=dx, center=(0.3, -1.0))
    depths = np.array([0.01, 0.5, 2.0, 7.0])
    loads, used = tractions(grid, 1, box), stress_kernels(nu)
    operator = SubsurfaceStress(
        grid, used, source=box or Box(0, ny, 0, nx), target=target, origin=origin, depths=depths
    )
    found = operator.apply(loads)
    assert found.shape == (6, 4, *target)
    points = lattice_points(grid, target, origin, depths)
    expected = stress_at_points(grid, used, loads, points).reshape(found.shape)
    assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_points_equal_quadrature_of_point_forces(nu):
    """The oracle shares nothing with the kernels; five loaded cells, all tractions, Mandel factors undone."""
    grid = Grid(nx=4, ny=3, dx=0.8, dy=0.5, center=(1.0, 2.0))
    rng = np.random.default_rng(2)
    loads = [np.where(rng.random(grid.shape) < 0.4, rng.standard_normal(grid.shape), 0.0) for _ in LOADS]
    points = np.column_stack([rng.uniform(-1, 3, 6), rng.uniform(0, 4, 6), [0.02, 0.1, 0.4, 1.0, 3.0, 20.0]])
    found = from_mandel(stress_at_points(grid, stress_kernels(nu), loads, points))
    expected = np.zeros((6, 6))
    for name, load in zip(("p", "q_x", "q_y"), loads, strict=True):
        for row, column in zip(*np.nonzero(load), strict=True):
            for number, (x, y, z) in enumerate(points):
                offset = (x - grid.x[column], y - grid.y[row], z)
                field = rectangle(name, offset, (0.4, 0.25), nu)
                expected[:, number] += load[row, column] * field[3:]
    scale = np.abs(expected).max(axis=0)
    assert np.all(np.abs(found - expected) < 1e-11 * np.maximum(scale, 1e-3))


def test_no_load_no_stress():
    grid = Grid(nx=4, ny=3, dx=1.0, dy=1.0)
    nothing = [np.zeros(grid.shape)] * 3
    assert np.all(stress_at_points(grid, stress_kernels(), nothing, np.array([[0.0, 0.0, 1.0]])) == 0)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_surface_stress_balances_the_tractions(nu):
    """At z = 0 the limit from inside: σ_zz = -p, τ_xz = -q_x, τ_yz = -q_y at every cell centre."""
    grid = Grid(nx=9, ny=7, dx=0.4, dy=0.3)
    loads = tractions(grid, 3)
    whole = Box(0, grid.ny, 0, grid.nx)
    operator = SubsurfaceStress(grid, stress_kernels(nu), source=whole, target=grid.shape, depths=np.array([0.0]))
    plain = from_mandel(operator.apply(loads))[:, 0]
    for component, load in (("zz", loads[0]), ("xz", loads[1]), ("yz", loads[2])):
        assert np.abs(plain[COMPONENTS.index(component)] + load).max() < 1e-12 * 10


def test_each_body_has_its_own_poisson_ratio():
    """The same pressure, two bodies: σ_zz agrees, σ_xx does not, each equals its oracle under one cell."""
    grid = Grid(nx=1, ny=1, dx=2.0, dy=1.0)
    point = (0.7, 0.2, 0.6)
    stresses = {}
    for nu in (0.2, 0.45):
        stress = stress_at_points(grid, stress_kernels(nu, LOADS[:1]), [np.array([[3.0]])], np.array([point]))
        expected = 3.0 * rectangle("p", point, (1.0, 0.5), nu)[3:]
        assert np.abs(from_mandel(stress)[:, 0] - expected).max() < 1e-12 * 3
        stresses[nu] = stress[:, 0]
    assert stresses[0.2][2] == close(stresses[0.45][2], rel=1e-12)
    assert abs(stresses[0.2][0] - stresses[0.45][0]) > 0.05


def test_kept_spectra_serve_every_load_on_their_box():
    grid = Grid(nx=20, ny=16, dx=0.1, dy=0.1)
    box = Box(3, 12, 5, 15)
    calls = []

    class Counting(StressCoefficients):
        def table(self, components, x, y, z, half_widths):
            calls.append(z)
            return super().table(components, x, y, z, half_widths)

    body = Material(young_modulus=1.0, poisson_ratio=0.3)
    depths = np.array([0.1, 0.4])
    operator = SubsurfaceStress(grid, [Counting(PressureLoad(), body)], source=box, target=grid.shape, depths=depths)
    assert sorted(calls) == [0.1, 0.4]
    assert operator.kernels == 12
    assert operator.nbytes > 0
    first, second = tractions(grid, 4, box, 1), tractions(grid, 5, Box(4, 9, 5, 8), 1)
    a, b = operator.apply(first), operator.apply(second)
    together = operator.apply([2.0 * first[0] - second[0]])
    assert sorted(calls) == [0.1, 0.4]  # sampled once, whatever is applied
    assert np.abs(together - (2.0 * a - b)).max() < 1e-12 * np.abs(a).max()
    assert operator.covers(box)
    assert operator.covers(Box(4, 9, 5, 8))
    assert not operator.covers(Box(2, 9, 5, 8))
    assert not operator.covers(Box(4, 9, 5, 16))


@pytest.mark.parametrize("periodic", [False, True])
def test_kernels_whose_depths_share_work_are_asked_for_all_of_them(periodic):
    """Once for each traction, or some depths at a time; without the ability depth by depth, with the same stress."""
    grid, depths = Grid(nx=12, ny=10, dx=0.1, dy=0.1), np.linspace(0.0, 1.0, 9)
    asked = []

    class Together(StressCoefficients):
        def at_depths(self, components, depths, half_widths, reach):
            asked.append(depths.size)
            return super().at_depths(components, depths, half_widths, reach)

        def responses(self, components, kx, ky, depths):
            asked.append(depths.size)
            return super().responses(components, kx, ky, depths)

    class Alone:
        def __init__(self, kernel):
            self.parity, self.table, self.response = kernel.parity, kernel.table, kernel.response
            self.components = kernel.components

    body = Material(young_modulus=1.0, poisson_ratio=0.3)
    loads, where = tractions(grid, 8), {"source": Box(0, 10, 0, 12), "target": grid.shape, "depths": depths}
    fields = []
    for kernels in ([Together(load, body) for load in LOADS], [Alone(kernel) for kernel in stress_kernels()]):
        fields.append(SubsurfaceStress(grid, kernels, periodic=periodic, threads=2, **where).apply(loads))
        if not periodic:
            points = np.array([[0.03, 0.02, z] for z in (*depths, 0.25, 0.25)])
            fields.append(stress_at_points(grid, kernels, loads, points, threads=1))
    middle = len(fields) // 2
    for one, other in zip(fields[:middle], fields[middle:], strict=True):
        np.testing.assert_allclose(one, other, atol=1e-14 * np.abs(other).max())
    assert sorted(asked) == ([4] * 3 + [5] * 3 if periodic else [9] * 6)


def test_spectra_on_cell_centres_are_a_quarter():
    grid = Grid(nx=32, ny=32, dx=0.1, dy=0.1)
    whole = Box(0, 32, 0, 32)
    sizes = {
        origin: SubsurfaceStress(
            grid, stress_kernels(loads=LOADS[:1]), source=whole, target=(32, 32), origin=origin, depths=np.array([0.2])
        ).nbytes
        for origin in ((0.0, 0.0), (0.5, 0.0), (0.5, 0.5))
    }
    assert sizes[0.0, 0.0] == 6 * 33 * 33 * 8
    assert sizes[0.5, 0.5] > 3.5 * sizes[0.0, 0.0]


@pytest.mark.parametrize(("precision", "bound"), [("single", 5e-7)])
def test_price_of_single_precision(precision, bound):
    """Measured 1.3e-7 of the largest component."""
    grid = Grid(nx=24, ny=20, dx=0.1, dy=0.1)
    whole, depths, loads = Box(0, 20, 0, 24), np.array([0.05, 0.3, 1.0]), tractions(grid, 6)
    exact, found = (
        SubsurfaceStress(grid, stress_kernels(), source=whole, target=grid.shape, depths=depths, precision=kind).apply(
            loads
        )
        for kind in ("double", precision)
    )
    assert 0 < np.abs(found - exact).max() < bound * np.abs(exact).max()


# --- periodic ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("origin", [(0.0, 0.0), (0.0, 0.5), (2.5, -3.25), (-1.0, 30.0)], ids=str)
@pytest.mark.parametrize("shape", [(6, 16), (5, 15)], ids=str)
def test_periodic_wave_of_pressure_in_closed_form(shape, origin):
    """p = p0 + cos kx: σ_zz = -p0 - (1 + kz) e, σ_xx = -(1 - kz) e, σ_yy = -2ν e, each cos kx; τ_xz = -kz e sin kx."""
    nu, mean = 0.3, 2.0
    grid = Grid(ny=shape[0], nx=shape[1], dx=1.0 / shape[1], dy=0.2, center=(0.03, 0.0))
    k = 2 * np.pi
    pressure = mean + np.cos(k * grid.x[None]) + np.zeros((shape[0], 1))
    depths = np.array([0.0, 0.07, 0.4])
    target = (3, 7)
    operator = SubsurfaceStress(
        grid,
        stress_kernels(nu, LOADS[:1]),
        source=Box(0, 1, 0, 1),
        target=target,
        origin=origin,
        depths=depths,
        periodic=True,
    )
    found = from_mandel(operator.apply([pressure])).reshape(6, -1)
    x, _, z = lattice_points(grid, target, origin, depths).T
    decay = np.exp(-k * z)
    expected = np.zeros((6, x.size))
    expected[0] = -(1 - k * z) * decay * np.cos(k * x)
    expected[1] = -2 * nu * decay * np.cos(k * x)
    expected[2] = -mean - (1 + k * z) * decay * np.cos(k * x)
    expected[4] = -k * z * decay * np.sin(k * x)
    assert np.abs(found - expected).max() < 1e-12


@pytest.mark.parametrize("fraction", [0.0, 0.5])
def test_periodic_equals_many_copies_side_by_side(fraction):
    """σ_zz decays so fast that 25 copies are as good as a period; the two discretisations differ at second order."""
    n, copies = 30, 5
    grid = Grid(nx=n, ny=n, dx=1.0 / n, dy=1.0 / n)
    y, x = grid.axes()
    pressure = hertz.pressure(x, y, 0.4, 0.4, 1.0)
    pressure = pressure**3  # smooth at its edge
    depths = np.array([0.1, 0.3])
    used, where = stress_kernels(0.3, LOADS[:1]), {"target": (n, 5), "depths": depths}
    whole = Box(0, n, 0, n)
    period = SubsurfaceStress(grid, used, source=whole, origin=(0, 12 + fraction), periodic=True, **where)
    many = Grid(nx=n * copies, ny=n * copies, dx=1.0 / n, dy=1.0 / n)
    tiled = np.tile(pressure, (copies, copies))
    box = Box(0, n * copies, 0, n * copies)
    first = (n * (copies // 2), n * (copies // 2) + 12 + fraction)
    alone = SubsurfaceStress(many, used, source=box, origin=first, **where)
    difference = period.apply([pressure])[2] - alone.apply([tiled])[2]
    assert np.abs(difference).max() < 3e-3


# --- Hertz -------------------------------------------------------------------------------------------------------


LOAD, RADIUS = 2 * np.pi / 3, 2 / np.pi  # a = p0 = 1 for E* = 1


def hertz_pressure(cells):
    """Pressure solved for, not put in."""
    grid = square_grid(cells, half_width=1.2)
    return grid, solve(grid, paraboloid(grid, RADIUS), normal_load=LOAD).pressure


def test_the_contact_used_below_has_unit_radius_and_pressure():
    a, p0, _ = hertz.hertz_sphere(LOAD, RADIUS, 1.0)
    assert (a, p0) == close((1.0, 1.0), rel=1e-14)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_axis_of_hertz_converges_at_second_order(nu):
    """HM-3: σ_z and σ_r on the axis from 0.1 a to 3 a."""
    depths = np.array([0.1, 0.3, 0.48, 1.0, 3.0])
    points = np.column_stack([np.zeros((5, 2)), depths])
    sizes, worst = np.array([8, 16, 32, 64]), []
    for cells in sizes:
        grid, pressure = hertz_pressure(cells)
        stress = stress_at_points(grid, stress_kernels(nu, LOADS[:1]), [pressure], points)
        sigma_z, sigma_r = hertz.axis_stress(depths, nu)
        worst.append(max(np.abs(stress[2] - sigma_z).max(), np.abs(stress[0] - sigma_r).max()))
    slope = -np.polyfit(np.log(sizes), np.log(worst), 1)[0]
    assert abs(slope - 2) < 0.3, worst
    assert worst[-1] < 2.5e-5


@pytest.mark.parametrize(("cells", "bound"), [(10, 3e-3), (20, 1.5e-3), (40, 5e-4)])
def test_largest_von_mises_stress_gives_hz3(cells, bound):
    """0.62004 p0 at 0.4809 a to one cell and 1 % (measured -0.20, -0.10, -0.02 %), on a plane between cells."""
    grid, pressure = hertz_pressure(cells)
    depths = np.arange(0, 1.0, 1.0 / cells)
    box = Box.around(pressure > 0)
    operator = SubsurfaceStress(
        grid,
        stress_kernels(0.3, LOADS[:1]),
        source=box,
        target=(1, grid.nx),
        origin=(0.5 * (grid.ny - 1), 0.0),
        depths=depths,
    )
    values = von_mises(operator.apply([pressure]))[:, 0]
    depth, column = np.unravel_index(np.argmax(values), values.shape)
    expected, where = hertz.max_von_mises(0.3)
    assert (expected, where) == close((0.62004, 0.4809), abs=5e-5)
    assert values.max() == close(expected, rel=bound)
    assert depths[depth] == close(where, abs=1.0 / cells)
    assert abs(grid.x[column]) <= 0.51 * grid.dx


def test_axis_and_centre_under_sliding():
    """HM-2 on the axis to 0.5 %, HM-5 at the centre of the surface to 2 %, μ = 0.5, ν = 0.3."""
    grid, pressure = hertz_pressure(32)
    used = stress_kernels(0.3, LOADS[:2])
    depths = np.array([0.2, 0.5, 1.0])
    points = np.column_stack([np.zeros((3, 2)), depths])
    shear = from_mandel(stress_at_points(grid, used, [0 * pressure, pressure], points))[4]
    assert shear == close(hertz.axis_shear_sliding(depths), rel=5e-3)
    assert shear == close([-0.60721, -0.26964, -0.07190], rel=5e-3)
    for mu, expected in ((0.0, 0.2), (0.25, 0.4770), (0.5, 0.8888)):
        centre = stress_at_points(grid, used, [pressure, mu * pressure], np.array([[0.25 / 32, 0.25 / 32, 0.0]]))
        assert float(von_mises(centre)[0]) == close(expected, rel=2e-2)


@pytest.mark.parametrize("mu", [0.25, 0.5])
def test_trailing_edge_tension(mu):
    """HM-1, the largest at cell centres: order 1/2 (a square-root peak), 8 % low at 128 cells, right in the limit."""
    sizes, largest = np.array([32, 64, 128]), []
    for cells in sizes:
        grid, pressure = hertz_pressure(cells)
        row = np.array([[x, 0.5 * grid.dy, 0.0] for x in grid.x if -1.03 < x < -0.9])
        stress = stress_at_points(grid, stress_kernels(0.3, LOADS[:2]), [pressure, mu * pressure], row)
        largest.append(stress[0].max() / hertz.trailing_edge_tension(mu, 0.3))
    short = 1.0 - np.array(largest)
    slope = -np.polyfit(np.log(sizes), np.log(short), 1)[0]
    assert abs(slope - 0.5) < 0.05, largest
    assert 0 < short[-1] < 0.1
    assert np.polyfit(sizes**-0.5, largest, 1)[1] == close(1.0, abs=0.01)
