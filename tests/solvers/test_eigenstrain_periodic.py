"""Periodic half-space: the boundary-value problem itself, the half-space theorem, closed forms of uniform layers."""

from __future__ import annotations

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.core.grid import Grid
from eigencontact.core.tensors import SQRT2, to_mandel
from eigencontact.errors import SceneError
from eigencontact.halfspace.points import field_at_points
from eigencontact.solvers.eigenstrain_periodic import PeriodicHalfSpace

GENERAL = to_mandel([0.3, -1.0, 0.7, 0.4, -0.6, 0.5])
QUANTITIES = ("displacement", "strain", "stress")
RNG = np.random.default_rng(7)


def space(ny, nx, interfaces, nu=0.3, dy=1.0, dx=1.0, **options):
    grid = Grid(nx=nx, ny=ny, dx=dx, dy=dy)
    return PeriodicHalfSpace(grid=grid, interfaces=np.array(interfaces), poisson_ratio=nu, **options)


def smooth(ny, nx, layers, waves=2):
    """Eigenstrain without waves shorter than ``n / waves`` cells."""
    spectrum = np.zeros((6, layers, ny, nx), complex)
    rows = np.r_[0 : waves + 1, -waves:0]
    spectrum[:, :, rows[:, None], rows] = RNG.normal(size=(6, layers, rows.size, rows.size)) * (1 + 0.5j)
    return np.fft.ifft2(spectrum).real * nx * ny


def slope_z(evaluate, z, step=2e-3):
    """Derivative along depth by an eighth-order difference."""
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    return np.einsum("k,ikyx->iyx", weights / step, evaluate(z + step * np.arange(-4, 5)))


def slope(values, length, axis):
    n = values.shape[axis]
    k = 2j * np.pi * np.fft.fftfreq(n, length / n)
    shape = [1] * values.ndim
    shape[axis] = n
    return np.fft.ifft(np.fft.fft(values, axis=axis) * k.reshape(shape), axis=axis).real


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
@pytest.mark.parametrize("z", [0.1, 0.55, 1.1, 2.0])
def test_compatibility_hookes_law_and_equilibrium(nu, z):
    """With continuity and the free surface, tested next, these make the answer the only one."""
    e = smooth(12, 10, 2)
    problem = space(12, 10, [0.3, 0.8, 1.4], nu, dy=0.25, dx=0.4)
    length_y, length_x = 3.0, 4.0

    def field(quantity, depths):
        return problem.apply(e, quantity, depths=np.atleast_1d(depths))

    u, strain, stress = (field(quantity, z)[:, 0] for quantity in QUANTITIES)
    gradient = np.array([slope(u, length_x, 2), slope(u, length_y, 1), slope_z(lambda d: field("displacement", d), z)])
    symmetric = [gradient[0, 0], gradient[1, 1], gradient[2, 2]]
    symmetric += [(gradient[j, k] + gradient[k, j]) / SQRT2 for j, k in ((1, 2), (0, 2), (0, 1))]
    scale = np.abs(strain).max()
    assert np.abs(strain - symmetric).max() <= 1e-10 * scale
    inside = e[:, 0] if 0.3 < z < 0.8 else e[:, 1] if 0.8 < z < 1.4 else np.zeros_like(e[:, 0])
    elastic = strain - inside
    hooke = 2.0 * elastic
    hooke[:3] += 2.0 * nu / (1.0 - 2.0 * nu) * elastic[:3].sum(axis=0)
    assert np.abs(stress - hooke).max() <= 1e-12 / (1.0 - 2.0 * nu) * np.abs(stress).max()
    in_x, in_y, in_z = (
        (slope(stress, length_x, 2), slope(stress, length_y, 1), slope_z(lambda d: field("stress", d), z))
    )  # fmt: skip
    forces = [
        in_x[0] + (in_y[5] + in_z[4]) / SQRT2,
        in_y[1] + (in_x[5] + in_z[3]) / SQRT2,
        in_z[2] + (in_x[4] + in_y[3]) / SQRT2,
    ]
    assert np.abs(forces).max() <= 1e-9 * np.abs(in_z).max()


@pytest.mark.parametrize("options", [{}, {"aliases": 1}, {"padding": 2.0, "aliases": 2}])
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_free_surface_and_continuity(nu, options):
    e = RNG.normal(size=(6, 3, 7, 10))
    interfaces = np.array([0.0, 0.5, 0.7, 2.0])
    problem = space(7, 10, interfaces, nu, **options)
    around = np.sort(np.concatenate([interfaces, interfaces[1:] - 1e-9, interfaces[1:] + 1e-9]))
    stress = problem.apply(e, "stress", depths=around)
    largest = np.abs(stress).max()
    assert np.abs(stress[2:5, 0]).max() <= 1e-14 * largest
    displacement, strain = (problem.apply(e, quantity, depths=around) for quantity in ("displacement", "strain"))
    for below, middle, above in ((1, 2, 3), (4, 5, 6), (7, 8, 9)):  # slopes times 1e-9 are left
        for continuous in (stress[2:5], displacement, strain[[0, 1, 5]]):
            assert np.abs(continuous[:, above] - continuous[:, below]).max() <= 1e-7 * np.abs(continuous).max()
        for any_values in (stress, displacement, strain):  # those that jump take the mean
            mean = 0.5 * (any_values[:, above] + any_values[:, below])
            assert np.abs(any_values[:, middle] - mean).max() <= 1e-7 * np.abs(any_values).max()


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_uniform_layer_is_the_closed_form(nu):
    e = to_mandel([2.0, 3.0, -1.0, 0.5, 0.25, -0.75])
    field = np.broadcast_to(e[:, None, None, None], (6, 1, 4, 6))
    problem = space(4, 6, [1.0, 3.0], nu)
    depths = np.array([0.0, 1.0, 2.0, 3.0, 5.0])
    stretch = -1.0 + nu / (1 - nu) * 5.0
    found = problem.apply(field, "displacement", depths=depths)[:, :, 2, 3]
    below = np.array([2.0, 2.0, 1.0, 0.0, 0.0])  # thickness of the layer below each depth
    assert found == close(-np.outer([2 * 0.25, 2 * 0.5, stretch], below), abs=1e-14)
    share = np.array([0.0, 0.5, 1.0, 0.5, 0.0])
    strain = problem.apply(field, "strain", depths=depths)[:, :, 0, 0]
    assert strain == close(np.outer(to_mandel([0, 0, stretch, 0.5, 0.25, 0]), share), abs=1e-14)
    stress = problem.apply(field, "stress", depths=depths)[:, :, 0, 0]
    plane = -2.0 / (1 - nu)
    expected = to_mandel([plane * (2 + nu * 3), plane * (3 + nu * 2), 0, 0, 0, 1.5])
    assert stress == close(np.outer(expected, share), abs=1e-14)


def test_uplift_of_a_heated_film():
    film = np.zeros((6, 2, 3, 3))
    film[:3] = 1e-3
    u = space(3, 3, [0.0, 0.25, 1.0], 0.3).apply(film, "displacement", depths=np.zeros(1))
    assert u[2] == close(-1.3 / 0.7 * 1e-3, rel=1e-14)


def exact(centre, quantity, grid, depths, shifts=(0.0,), nu=0.3):
    """Field of a unit cube in a half-space and of its copies moved by all pairs of `shifts`."""
    shape = ec.make("cuboid", center=tuple(map(float, centre)), edges=(1.0, 1.0, 1.0))
    z, y, sy, x, sx = (a.ravel() for a in np.meshgrid(depths, grid.y, shifts, grid.x, shifts, indexing="ij"))
    field = field_at_points(shape, GENERAL, (x - sx, y - sy, z), poisson_ratio=nu, quantity=quantity)
    return field.reshape(len(field), len(depths), grid.ny, len(shifts), grid.nx, len(shifts)).sum(axis=(3, 5))


@pytest.mark.slow
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_copies_fade_with_the_third_power_of_the_period(quantity):
    problem = space(16, 16, [1.0, 2.0])
    grid, depths = problem.grid, np.array([0.0, 4.0])
    wanted = exact((grid.x[7], grid.y[9], 1.5), quantity, grid, depths)
    e = np.zeros((6, 1, 16, 16))
    e[:, 0, 9, 7] = GENERAL
    paddings, errors = np.array([2.0, 4.0, 8.0]), []
    for padding in paddings:
        found = space(16, 16, [1.0, 2.0], padding=padding, aliases=3).apply(e, quantity, depths=depths)
        difference = found - wanted
        if quantity == "displacement":  # but for a constant, see the class
            difference = difference - difference.mean(axis=(2, 3), keepdims=True)
        errors.append(np.abs(difference).max() / np.abs(wanted).max())
    assert np.polyfit(np.log(paddings), np.log(errors), 1)[0] == close(-3.0, abs=0.35)
    assert errors[-1] < 1e-3


@pytest.mark.slow
def test_sum_over_many_copies():
    """A source and its negative half a period away: their copies add up fast enough to be summed one by one."""
    problem = space(8, 8, [1.0, 2.0], aliases=4)
    grid, depths = problem.grid, np.array([0.0])
    e = np.zeros((6, 1, 8, 8))
    e[:, 0, 2, 3], e[:, 0, 6, 7] = GENERAL, -GENERAL
    found = problem.apply(e, "stress", depths=depths)
    errors = []
    for reach in (1, 2, 4):
        shifts = 8.0 * np.arange(-reach, reach + 1)
        wanted = exact((grid.x[3], grid.y[2], 1.5), "stress", grid, depths, shifts)
        wanted = wanted - exact((grid.x[7], grid.y[6], 1.5), "stress", grid, depths, shifts)
        errors.append(np.abs(found - wanted).max() / np.abs(wanted).max())
    assert -np.polyfit(np.log([1, 2, 4]), np.log(errors), 1)[0] == close(2.4, abs=0.4)
    assert errors[2] < 2.5e-4


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_smooth_eigenstrain_does_not_depend_on_the_grid(quantity):
    """Samples of a field without short waves determine it: a finer grid gives the same numbers."""
    fine = smooth(16, 12, 1)
    interfaces, depths = [0.25, 0.75], np.array([0.0, 0.5, 1.5])
    wanted = space(16, 12, interfaces, dy=0.25, dx=0.5).apply(fine, quantity, depths=depths)
    coarse = space(8, 6, interfaces, dy=0.5, dx=1.0)
    assert coarse.apply(fine[:, :, ::2, ::2], quantity, depths=depths) == close(
        wanted[:, :, ::2, ::2], abs=1e-12 * np.abs(wanted).max()
    )
    between = coarse.apply(fine[:, :, ::2, ::2], quantity, depths=depths, target=(8, 6), origin=(0.5, -0.5))
    assert between == close(np.roll(wanted, 1, axis=3)[:, :, 1::2, ::2], abs=1e-12 * np.abs(wanted).max())


@pytest.mark.parametrize("aliases", [0, 1])
def test_mirror_and_quarter_turn(aliases):
    e = RNG.normal(size=(6, 2, 6, 6))
    problem = space(6, 6, [0.0, 0.5, 1.0], aliases=aliases)
    depths = np.array([0.0, 0.75])
    stress = problem.apply(e, "stress", depths=depths)
    signs = np.array([1, 1, 1, 1, -1, -1])[:, None, None, None]  # x to -x
    mirrored = problem.apply(signs * e[..., ::-1], "stress", depths=depths)
    assert mirrored == close(signs * stress[..., ::-1], abs=1e-13 * np.abs(stress).max())
    swap = [1, 0, 2, 4, 3, 5]  # x and y change places
    swapped = problem.apply(e.swapaxes(2, 3)[swap], "stress", depths=depths)
    assert swapped == close(stress.swapaxes(2, 3)[swap], abs=1e-13 * np.abs(stress).max())


def test_great_depths_and_thin_layers_stay_finite():
    e = RNG.normal(size=(6, 3, 8, 8))
    for quantity in QUANTITIES:
        problem = space(8, 8, [1e-9, 2e-9, 1e4, 2e4])
        values = problem.apply(e, quantity, depths=np.array([0.0, 1.5e-9, 1e3, 1.5e4, 1e6]))
        assert np.isfinite(values).all()
        assert quantity == "displacement" or np.abs(values).max() < 50.0


BAD = [
    ({"interfaces": [1.0]}, {}, "interfaces must be two or more ascending depths"),
    ({"interfaces": [0.0, 2.0, 1.0]}, {}, "interfaces must be two or more ascending depths"),
    ({"interfaces": [-1.0, 2.0]}, {}, "interfaces must be two or more ascending depths"),
    ({"padding": 0.5}, {}, r"padding must be 1 or more \(got 0.5\)"),
    ({"aliases": -1}, {}, "aliases must be 0 or more"),
    ({"nu": 0.6}, {}, "poisson_ratio must be in"),
    ({}, {"quantity": "heat"}, "quantity must be one of 'displacement', 'strain', 'stress'"),
    ({}, {"depths": np.array([-1.0])}, "depths must be 0 or more"),
    ({}, {"eigenstrain": np.zeros((6, 2, 4, 4))}, r"eigenstrain must be of shape \(6, 1, 4, 4\)"),
]


@pytest.mark.parametrize(("options", "call", "message"), BAD)
def test_bad_values_are_refused(options, call, message):
    call = {"eigenstrain": np.zeros((6, 1, 4, 4)), "quantity": "stress", "depths": np.zeros(1)} | call
    with pytest.raises(SceneError, match=message):
        space(4, 4, **({"interfaces": [0.0, 1.0]} | options)).apply(**call)
